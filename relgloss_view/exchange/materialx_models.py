"""Shading models of MaterialX's standard library as OpenPBR surfaces, with what is not carried.

Sources: OpenPBR 1.1; Autodesk Standard Surface 1.0.1; glTF 2.0 with KHR_materials_specular, _ior
and _clearcoat; UsdPreviewSurface 2.6, each as in MaterialX 1.39.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from relgloss_view.exchange import ggx
from relgloss_view.exchange.materialx_values import Values
from relgloss_view.exchange.openpbr import WHITE, OpenPbr

INDEX = (1.0, 10.0)
#: Its facets are about as wide as the narrowest lobe that is drawn here (S_DEG_DRAWN).
LEAST_ROUGHNESS = 0.0324


class Model(NamedTuple):
    """A shading model."""

    name: str
    make: Callable[[Values], OpenPbr]
    #: Inputs that are not carried, with their value that changes nothing, and the word for them
    absent: tuple[tuple[str, float, str], ...]

    def surface(self, values: Values) -> tuple[OpenPbr, tuple[str, ...]]:
        """The surface, and a line for each thing that it does not hold."""
        surface, lines = _drawable(self.make(values))
        for name, nothing, word in self.absent:
            before = set(values.unread)
            number = _first(values, name, nothing)
            if number != nothing or set(values.unread) - before:
                values.unread.pop(name, None)
                lines.append(f"{word} ({name})")
        lines += [f"{name}: comes from {what}" for name, what in values.unread.items()]
        return surface, tuple(dict.fromkeys(lines))


def _drawable(surface: OpenPbr) -> tuple[OpenPbr, list[str]]:
    """The surface with lobes that can be drawn: a point lamp in a mirror has no limit image."""
    lines: list[str] = []
    changed: dict[str, Any] = {}
    for name in ("specular_roughness", "coat_roughness"):
        value = getattr(surface, name)
        used = name.startswith("specular") or surface.coat_weight > 0.0
        if used and value < LEAST_ROUGHNESS:
            changed[name] = LEAST_ROUGHNESS
            lines.append(f"{name} {value:g}: a mirror, drawn with {LEAST_ROUGHNESS:.3g}")
    return dataclasses.replace(surface, **changed), lines


def _first(values: Values, name: str, nothing: float) -> float:
    """The largest number of an input that counts where it differs from `nothing`."""
    if not values.has(name):
        return nothing
    colour = values.numbers(name, (nothing,) * 3, 3, -1e6, 1e6)
    return max(colour, key=lambda v: abs(v - nothing))


def open_pbr(v: Values) -> OpenPbr:
    """OpenPBR surface 1.1."""
    default = OpenPbr()
    return OpenPbr(
        base_weight=v.number("base_weight", default.base_weight, 0.0, 1.0),
        base_color=v.colour("base_color", default.base_color),
        base_diffuse_roughness=v.number("base_diffuse_roughness", 0.0, 0.0, 1.0),
        base_metalness=v.number("base_metalness", 0.0, 0.0, 1.0),
        specular_weight=v.number("specular_weight", 1.0, 0.0, 100.0),
        specular_color=v.colour("specular_color", WHITE),
        specular_roughness=v.number("specular_roughness", default.specular_roughness, 0.0, 1.0),
        specular_ior=v.number("specular_ior", default.specular_ior, *INDEX),
        coat_weight=v.number("coat_weight", 0.0, 0.0, 1.0),
        coat_color=v.colour("coat_color", WHITE),
        coat_roughness=v.number("coat_roughness", 0.0, 0.0, 1.0),
        coat_ior=v.number("coat_ior", default.coat_ior, *INDEX),
        coat_darkening=v.number("coat_darkening", 1.0, 0.0, 1.0),
    )


def standard_surface(v: Values) -> OpenPbr:
    """Autodesk's standard surface: the lobe's weight goes on F0, as OpenPBR has it."""
    return OpenPbr(
        base_weight=v.number("base", 1.0, 0.0, 1.0),
        base_color=v.colour("base_color", (0.8, 0.8, 0.8)),
        base_diffuse_roughness=v.number("diffuse_roughness", 0.0, 0.0, 1.0),
        base_metalness=v.number("metalness", 0.0, 0.0, 1.0),
        specular_weight=v.number("specular", 1.0, 0.0, 1.0),
        specular_color=v.colour("specular_color", WHITE),
        specular_roughness=v.number("specular_roughness", 0.2, 0.0, 1.0),
        specular_ior=v.number("specular_IOR", 1.5, *INDEX),
        coat_weight=v.number("coat", 0.0, 0.0, 1.0),
        coat_color=v.colour("coat_color", WHITE),
        coat_roughness=v.number("coat_roughness", 0.1, 0.0, 1.0),
        coat_ior=v.number("coat_IOR", 1.5, *INDEX),
        coat_darkening=0.0,
    )


def gltf_pbr(v: Values) -> OpenPbr:
    """glTF's metallic-roughness with its extensions for lobe and coat."""
    surface = OpenPbr(
        base_color=v.colour("base_color", WHITE),
        base_metalness=v.number("metallic", 1.0, 0.0, 1.0),
        specular_weight=v.number("specular", 1.0, 0.0, 1.0),
        specular_color=v.colour("specular_color", WHITE),
        specular_roughness=v.number("roughness", 1.0, 0.0, 1.0),
        specular_ior=v.number("ior", 1.5, *INDEX),
        coat_weight=v.number("clearcoat", 0.0, 0.0, 1.0),
        coat_roughness=v.number("clearcoat_roughness", 0.0, 0.0, 1.0),
        coat_ior=1.5,
        coat_darkening=0.0,
    )
    # A coat of the same index would take the lobe below away, which glTF's does not.
    return _below_coat(surface)


def usd_preview(v: Values) -> OpenPbr:
    """USD preview surface; its specular workflow gives F0 itself."""
    metal = v.number("metallic", 0.0, 0.0, 1.0)
    index, weight, colour = v.number("ior", 1.5, *INDEX), 1.0, WHITE
    if v.number("useSpecularWorkflow", 0.0, 0.0, 1.0) > 0.5:
        f0 = v.colour("specularColor", (0.0, 0.0, 0.0))
        largest = max(f0)
        metal, weight = 0.0, 1.0 if largest > 0.0 else 0.0
        index = max(ggx.index_of(largest), 1.0) if largest > 0.0 else 1.5
        if largest > 0.0:
            colour = (f0[0] / largest, f0[1] / largest, f0[2] / largest)
    return _below_coat(
        OpenPbr(
            base_color=v.colour("diffuseColor", (0.18, 0.18, 0.18)),
            base_metalness=metal,
            specular_weight=weight,
            specular_color=colour,
            specular_roughness=v.number("roughness", 0.5, 0.0, 1.0),
            specular_ior=index,
            coat_weight=v.number("clearcoat", 0.0, 0.0, 1.0),
            coat_roughness=v.number("clearcoatRoughness", 0.01, 0.0, 1.0),
            coat_ior=1.5,
            coat_darkening=0.0,
        )
    )


def _below_coat(surface: OpenPbr) -> OpenPbr:
    """With the index that reflects below the coat what the model's own does in air."""
    if surface.coat_weight == 0.0:
        return surface
    return dataclasses.replace(surface, specular_ior=surface.specular_ior * surface.coat_ior)


_THIN = "thin film"
MODELS: dict[str, Model] = {
    "open_pbr_surface": Model(
        "OpenPBR surface",
        open_pbr,
        (
            ("transmission_weight", 0.0, "transmission"),
            ("subsurface_weight", 0.0, "subsurface scattering"),
            ("fuzz_weight", 0.0, "fuzz"),
            ("thin_film_weight", 0.0, _THIN),
            ("emission_luminance", 0.0, "emission"),
            ("specular_roughness_anisotropy", 0.0, "anisotropy"),
            ("coat_roughness_anisotropy", 0.0, "anisotropy of the coat"),
            ("geometry_opacity", 1.0, "opacity"),
            ("geometry_normal", 0.0, "normal map"),
            ("geometry_coat_normal", 0.0, "normal map of the coat"),
            ("geometry_tangent", 0.0, "tangents"),
        ),
    ),
    "standard_surface": Model(
        "standard surface",
        standard_surface,
        (
            ("transmission", 0.0, "transmission"),
            ("subsurface", 0.0, "subsurface scattering"),
            ("sheen", 0.0, "sheen"),
            ("thin_film_thickness", 0.0, _THIN),
            ("emission", 0.0, "emission"),
            ("specular_anisotropy", 0.0, "anisotropy"),
            ("coat_anisotropy", 0.0, "anisotropy of the coat"),
            ("coat_affect_color", 0.0, "the coat's effect on the colour"),
            ("coat_affect_roughness", 0.0, "the coat's effect on the roughness"),
            ("opacity", 1.0, "opacity"),
            ("normal", 0.0, "normal map"),
            ("coat_normal", 0.0, "normal map of the coat"),
        ),
    ),
    "gltf_pbr": Model(
        "glTF PBR",
        gltf_pbr,
        (
            ("transmission", 0.0, "transmission"),
            ("sheen_color", 0.0, "sheen"),
            ("iridescence", 0.0, _THIN),
            ("emissive", 0.0, "emission"),
            ("anisotropy_strength", 0.0, "anisotropy"),
            ("occlusion", 1.0, "occlusion"),
            ("alpha", 1.0, "opacity"),
            ("normal", 0.0, "normal map"),
            ("clearcoat_normal", 0.0, "normal map of the coat"),
        ),
    ),
    "UsdPreviewSurface": Model(
        "USD preview surface",
        usd_preview,
        (
            ("emissiveColor", 0.0, "emission"),
            ("occlusion", 1.0, "occlusion"),
            ("opacity", 1.0, "opacity"),
            ("normal", 0.0, "normal map"),
            ("displacement", 0.0, "displacement"),
        ),
    ),
}


def starting_points(surface: OpenPbr) -> dict[str, Any]:
    """What refit_lobes starts from: colour, widths, F0 of a metal, refractive index."""
    alphas = [surface.base_alpha]
    if surface.coat_weight > 0.0:
        alphas.append(max(surface.coat_roughness**2, ggx.LEAST_ALPHA))
        if surface.coat_weight > 0.5:
            alphas.reverse()
    is_metal = surface.base_metalness > 0.5
    body = (1.0 - surface.base_metalness) * surface.base_weight * np.asarray(surface.base_color)
    return {
        "colour": tuple(float(v) for v in 0.93 * body),
        "alphas": alphas,
        "f0": surface.base_color if is_metal else None,
        "index": max(surface.base_index, 1.05),
    }
