"""What is shown over or instead of a picture, and the difference of two pictures."""

from __future__ import annotations

import moderngl

from relgloss_view.base.errors import RelglossError
from relgloss_view.display.model import DisplayModel
from relgloss_view.picture.gpu.constants import code
from relgloss_view.picture.gpu.context import make_current
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.gpu.request import Request
from relgloss_view.picture.gpu.targets import GEOMETRY, LIGHT, OVERLAY, SPLIT, TONE, XYZ
from relgloss_view.picture.gpu.uniforms import display_uniforms, white_uniform
from relgloss_view.picture.gpu.variant import tone_defines
from relgloss_view.picture.method import Method
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene


def draw_overlay(
    renderer: Renderer,
    scene: Scene,
    look: Look,
    size: Size,
    overlay: str,
    method: Method | None = None,
) -> moderngl.Texture:
    """Draw one of OVERLAYS for a picture; the texture holds 8-bit display values."""
    make_current(renderer.ctx)
    request = renderer.request(scene, look, size, method)
    passes = renderer.passes
    drawn = passes.bring_up_to_date(request)
    if passes.held.is_drawn_from("overlay", overlay):
        return renderer.texture("overlay")
    passes.bring(request, *XYZ)
    names: tuple[str, ...] = (*XYZ, *SPLIT, *TONE)
    if overlay == "normals":
        passes.bring(request, *GEOMETRY)
        names = (*names, *GEOMETRY)
    if passes.held.renew("overlay", overlay):
        defines = tone_defines(scene.display, "overlay.frag")
        defines["OVERLAY"] = code("OVERLAY", overlay)
        uniforms = {
            **display_uniforms(scene, renderer.programs.uploads),
            **white_uniform(scene),
            **passes.images(names),
            "c": drawn.scaling.c,
        }
        with passes.all_or_nothing():
            passes.draw("overlay", "overlay.frag", defines, uniforms, OVERLAY, None)
    return renderer.texture("overlay")


def draw_difference(
    first: Renderer, second: Renderer, requests: tuple[Request, Request], top: float
) -> moderngl.Texture:
    """Draw CIEDE2000 between two pictures of one size into the second's overlay; white is `top`."""
    make_current(second.ctx)
    if requests[0].size != requests[1].size:
        raise RelglossError("a difference needs two pictures of one size")
    for renderer, request in zip((first, second), requests, strict=True):
        renderer.passes.bring_up_to_date(request)
    # Pictures of the first renderer count by how often it has drawn what shows.
    seen = "difference", id(first), first.draws["tone"], top
    if second.passes.held.is_drawn_from("overlay", *seen):
        return second.texture("overlay")
    for renderer, request in zip((first, second), requests, strict=True):
        renderer.passes.bring(request, *LIGHT)
    display = DisplayModel.of(requests[1].scene.display)
    if second.passes.held.renew("overlay", *seen):
        uniforms = {
            "first_image": first.texture(LIGHT[0]),
            "second_image": second.texture(LIGHT[0]),
            "xyz_from_rgb": display.xyz_from_rgb.T,  # columns first
            "display_white": display.white,
            "top": top,
            "surround": tone.surround_digital(display),
        }
        with second.passes.all_or_nothing():
            second.passes.draw("overlay", "difference.frag", {}, uniforms, OVERLAY, None)
    return second.texture("overlay")
