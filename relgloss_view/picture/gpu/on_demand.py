"""What is drawn and read of a frame only when asked for: float light, geometry, counts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from relgloss_view.picture.gpu.context import make_current
from relgloss_view.picture.gpu.request import Request
from relgloss_view.picture.gpu.targets import GEOMETRY, LIGHT, PARTS
from relgloss_view.picture.gpu.uniforms import grain_uniforms, view_uniforms
from relgloss_view.picture.gpu.variant import Plan
from relgloss_view.picture.model.pixel_sampling import sample_count
from relgloss_view.picture.model.view import View

if TYPE_CHECKING:
    from relgloss_view.picture.gpu.passes import Renderer


def fetch(renderer: Renderer, request: Request, stage: str) -> NDArray[Any]:
    """One stage of a frame; draws again what has been drawn over since."""
    make_current(renderer.ctx)
    renderer.bring_up_to_date(request)
    if stage == "counts":
        return np.array(_counts(renderer, request))
    if stage in PARTS:
        renderer.bring_parts_up_to_date(request)
    if stage in LIGHT:
        bring_light_up_to_date(renderer, request)
    if stage in GEOMETRY:
        bring_geometry_up_to_date(renderer, request)
    return renderer.targets.read(stage)


def bring_light_up_to_date(renderer: Renderer, request: Request) -> None:
    """Draw the tone pass's float numbers too; the rest is up to date."""
    scaling, _ = renderer.bring_up_to_date(request)
    with renderer.all_or_nothing():
        renderer.draw_tone("light", request, scaling, LIGHT, None)


def bring_geometry_up_to_date(renderer: Renderer, request: Request) -> None:
    """Draw normals and points too; the rest is up to date."""
    if not renderer.held.stale("geometry"):
        return
    scene, look, size = request.scene, request.look, request.size
    defines = Plan.of(scene, look, chosen=request.method).geometry_defines()
    uniforms = {
        **view_uniforms(scene, View.of(scene, size)),
        **grain_uniforms(look),
        "samples": sample_count(scene, look, size),
    }
    with renderer.all_or_nothing():
        renderer.draw("geometry", "geometry.frag", defines, uniforms, GEOMETRY, None)


def _counts(renderer: Renderer, request: Request) -> tuple[int, int]:
    if renderer.held.stale("counts"):
        bounds = View.of(request.scene, request.size).bounds
        with renderer.all_or_nothing():
            renderer.counts = renderer.reduction.counts(renderer.texture("display"), bounds)
        renderer.draws["counts"] += 1
    return renderer.counts
