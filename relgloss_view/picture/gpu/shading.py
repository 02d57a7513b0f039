"""Shading: the variant and the numbers that pass 1 of a picture is drawn with."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from relgloss_view.picture.gpu.finishes import finish_uniforms
from relgloss_view.picture.gpu.programs import Uniforms
from relgloss_view.picture.gpu.request import Request
from relgloss_view.picture.gpu.uniforms import (
    NO_GRAIN,
    ambient_uniforms,
    colour_uniforms,
    grain_uniforms,
    material_uniforms,
    view_uniforms,
)
from relgloss_view.picture.gpu.variant import Variant
from relgloss_view.picture.model.light import lamps_irradiance
from relgloss_view.picture.model.pixel_sampling import sample_count
from relgloss_view.picture.model.view import View


class Shading(NamedTuple):
    """How pass 1 and the split are drawn, and with what."""

    variant: Variant
    uniforms: Uniforms
    white: float  #: Y_n before the lamp's power


def shading_of(
    request: Request, view: View, white_of: Callable[[Variant, dict[str, Any]], float]
) -> Shading:
    """The shading of a picture; `white_of` measures the perfect diffuser in the object's place."""
    scene, look, size, method = request.scene, request.look, request.size, request.method
    samples = sample_count(scene, look, size)
    variant = Variant.of(scene, look, samples, method)
    seen_from: dict[str, Any] = {
        **view_uniforms(scene, view, afar=variant.afar),
        "samples": samples,
    }
    white = white_of(variant, seen_from)
    if scene.pack is None:
        material = {**material_uniforms(scene, look, method), **colour_uniforms(scene, method)}
    else:
        material = finish_uniforms(scene.pack, look, scene.lamp.illuminant)
    uniforms: dict[str, Any] = {
        **seen_from,
        **(grain_uniforms(scene, look, size) if variant.noise != "none" else NO_GRAIN),
        **material,
        **ambient_uniforms(scene, look, method),
        "irradiance": lamps_irradiance(white, scene.setup),
    }
    return Shading(variant, uniforms, white)
