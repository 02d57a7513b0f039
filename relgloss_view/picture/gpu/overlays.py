"""What is shown over or instead of a picture, and the difference of two pictures."""

from __future__ import annotations

import moderngl
import numpy as np

from relgloss_view.base.errors import RelglossError
from relgloss_view.picture.gpu.context import make_current
from relgloss_view.picture.gpu.on_demand import bring_geometry_up_to_date, bring_light_up_to_date
from relgloss_view.picture.gpu.passes import Renderer
from relgloss_view.picture.gpu.request import Request
from relgloss_view.picture.gpu.targets import GEOMETRY, LIGHT, OVERLAY, SHADE, TONE
from relgloss_view.picture.gpu.uniforms import display_uniforms, white_uniform
from relgloss_view.picture.gpu.variant import tone_defines
from relgloss_view.picture.method import Method
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.tone import DisplayModel
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene

OVERLAY_CODES = {
    "clipped": 1,
    "out of gamut": 2,
    "lightness": 3,
    "diffuse only": 4,
    "specular only": 5,
    "normals": 6,
}


def draw_overlay(
    renderer: Renderer,
    scene: Scene,
    look: Look,
    size: Size,
    overlay: str,
    method: Method | None = None,
) -> moderngl.Texture:
    """Draw one of OVERLAY_CODES for a picture; the texture holds 8-bit display values."""
    make_current(renderer.ctx)
    request = renderer.request(scene, look, size, method)
    scaling, _ = renderer.bring_up_to_date(request)
    renderer.bring_parts_up_to_date(request)
    names: tuple[str, ...] = (*SHADE, *TONE)
    if overlay == "normals":
        bring_geometry_up_to_date(renderer, request)
        names = (*names, *GEOMETRY)
    if renderer.held.stale("overlay", overlay):
        defines = {**tone_defines(scene.display, "overlay.frag"), "OVERLAY": OVERLAY_CODES[overlay]}
        uniforms = {
            **display_uniforms(scene),
            **white_uniform(scene),
            **renderer.images(names),
            "c": scaling.c,
        }
        with renderer.all_or_nothing():
            renderer.draw("overlay", "overlay.frag", defines, uniforms, OVERLAY, None)
    return renderer.texture("overlay")


def draw_difference(
    first: Renderer, second: Renderer, requests: tuple[Request, Request], top: float
) -> moderngl.Texture:
    """Draw CIEDE2000 between two pictures of one size into the second's overlay; white is `top`."""
    make_current(second.ctx)
    if requests[0].size != requests[1].size:
        raise RelglossError("a difference needs two pictures of one size")
    for renderer, request in zip((first, second), requests, strict=True):
        renderer.bring_up_to_date(request)
        bring_light_up_to_date(renderer, request)
    display = DisplayModel.of(requests[1].scene.display)
    # Pictures of the first renderer count by how often it has drawn them.
    if second.held.stale("overlay", "difference", id(first), first.draws["light"], top):
        uniforms = {
            "first_image": first.texture(LIGHT[0]),
            "second_image": second.texture(LIGHT[0]),
            "xyz_from_rgb": display.xyz_from_rgb.T,  # columns first
            "display_white": display.white,
            "top": top,
            "surround": float(tone.encode(np.array(display.background_light), display)),
        }
        with second.all_or_nothing():
            second.draw("overlay", "difference.frag", {}, uniforms, OVERLAY, None)
    return second.texture("overlay")
