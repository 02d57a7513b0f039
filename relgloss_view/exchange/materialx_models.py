"""Shading models of MaterialX's standard library as OpenPBR surfaces, with what is not carried.

Sources: OpenPBR 1.1; Autodesk Standard Surface 1.0.1; glTF 2.0 with KHR_materials_specular, _ior
and _clearcoat; UsdPreviewSurface 2.6, each as in MaterialX 1.39.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from relgloss_view.base.reading import printable
from relgloss_view.exchange import ggx
from relgloss_view.exchange.gltf_brdf import GLTF_LOBES, gltf_starting_points
from relgloss_view.exchange.materialx_nodes import connected, input_of, numbers_of
from relgloss_view.exchange.materialx_values import Values
from relgloss_view.exchange.mirrors import drawable
from relgloss_view.exchange.openpbr import WHITE, OpenPbr
from relgloss_view.exchange.schlick_layers import SchlickLayers
from relgloss_view.exchange.standard_surface import StandardSurface

INDEX = (1.0, 100.0)  #: others write 50 for a metal
MIRROR_INDEX = 1e6  #: of a lobe whose F0 is its strength
MOSTLY = 0.5  #: metalness above which a body does not count
MOST_TINT = 1e3  #: of glTF's specular_color, as KHR_materials_specular allows more than 1
#: Beginnings of inputs that only shape what a model's `absent` names, and say nothing alone.
SHAPING = (
    *("transmission_", "subsurface_", "fuzz_", "thin_", "emission_", "geometry_", "sheen_"),
    *("iridescence_", "emissive_", "anisotropy_", "attenuation_", "alpha_", "opacityMode"),
    *("specular_rotation", "coat_rotation", "thickness", "dispersion", "tangent"),
    *("sheenTint", "subsurfaceDistance"),
    "opacityThreshold",
)
MOST_NAMED = 12  #: unknown inputs that are named
MOST_PICTURES = 3  #: that one line names
#: Inputs that a gloss meter sees, of all models.
OF_GLOSS = frozenset(
    (
        *("specular", "specular_weight", "specular_roughness", "specular_ior", "specular_IOR"),
        *("roughness", "ior", "metallic", "metalness", "base_metalness", "useSpecularWorkflow"),
        *("coat", "coat_weight", "coat_roughness", "coat_ior", "coat_IOR", "specularColor"),
        *("clearcoat", "clearcoat_roughness", "clearcoatRoughness"),
    )
)


Described = OpenPbr | SchlickLayers


class Model(NamedTuple):
    """A shading model."""

    name: str
    make: Callable[[Values], Described]
    #: Inputs that are not carried, with their value that changes nothing, and the word for them
    absent: tuple[tuple[str, float, str], ...]

    #: The share of light that passes through the body, and of what is scattered below the surface
    through: str
    below: tuple[str, str]  #: with the input of its colour

    def body(self, v: Values, surface: Described) -> Described:
        """The surface with the body that transmission and scattering below the surface leave it.

        What passes through is lost, as in front of black. What is scattered below the surface
        comes back where it went in, in its colour, weighted as both models mix them.
        """
        is_metal = surface.base_metalness if isinstance(surface, OpenPbr) else surface.metallic
        if is_metal > MOSTLY:
            return surface
        weight, colour = self.below
        base = np.asarray(surface.base_color)
        if isinstance(surface, OpenPbr):
            base = surface.base_weight * base
        share = v.number(weight, 0.0, 0.0, 1.0) if weight else 0.0
        if share > 0.0 and colour:
            base = base + share * (np.asarray(v.colour(colour, WHITE)) - base)
        through = v.number(self.through, 0.0, 0.0, 1.0) if self.through else 0.0
        if share <= 0.0 and through <= 0.0:
            return surface
        red, green, blue = (float(c) for c in (1.0 - through) * base)
        changed: dict[str, Any] = {"base_color": (red, green, blue)}
        if isinstance(surface, OpenPbr):
            changed["base_weight"] = 1.0
        return dataclasses.replace(surface, **changed)

    def surface(self, values: Values) -> tuple[Described, tuple[str, ...]]:
        """The surface, and a line for each thing that it does not hold."""
        surface = self.body(values, self.make(values))
        surface, lines = drawable(surface, _lobes(surface))
        own = set(values.asked)
        for name, nothing, word in self.absent:
            before = set(values.unread)
            number = _first(values, name, nothing)
            if number != nothing or set(values.unread) - before:
                values.unread.pop(name, None)
                lines.append(f"{word} ({name})")
        lines += [_unread(name, what) for name, what in values.unread.items()]
        lines += [
            f"{name}: the mean of {_listed(pictures)} stands for it"
            for name, pictures in values.means.items()
            if name in own
        ]
        lines += [f"{name}: {how}" for name, how in values.cut.items() if name in own]
        lines += [
            f"the colour space {printable(name, 40)}, read as linear sRGB"
            for name in sorted(values.nodes.spaces)
        ]
        unknown = [name for name in values.not_asked() if not name.startswith(SHAPING)]
        lines += [
            f"{printable(name, 40)}: no input of {self.name}" for name in unknown[:MOST_NAMED]
        ]
        if len(unknown) > MOST_NAMED:
            lines.append(f"{len(unknown) - MOST_NAMED} more unknown inputs")
        return surface, tuple(dict.fromkeys(lines))


def _unread(name: str, what: str) -> str:
    line = f"{name}: comes from {what}; the default of {name} counts"
    return f"{line}, so that the gloss is a guess" if name in OF_GLOSS else line


def _listed(pictures: tuple[str, ...]) -> str:
    more = f" and {len(pictures) - MOST_PICTURES} more" if len(pictures) > MOST_PICTURES else ""
    return ", ".join(pictures[:MOST_PICTURES]) + more


def _lobes(surface: Described) -> tuple[str, ...]:
    """The names of the roughnesses that count."""
    if isinstance(surface, OpenPbr):
        names, coat = ("specular_roughness", "coat_roughness"), surface.coat_weight
    else:
        names, coat = GLTF_LOBES, surface.clearcoat
    return names if coat > 0.0 else names[:1]


def _first(values: Values, name: str, nothing: float) -> float:
    """The largest number of an input that counts where it differs from `nothing`."""
    if not values.has(name):
        return nothing
    colour = values.numbers(name, (nothing,) * 3, -1e6, 1e6)
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
        specular_ior=_index(v, "specular_ior", default.specular_ior),
        coat_weight=v.number("coat_weight", 0.0, 0.0, 1.0),
        coat_color=v.colour("coat_color", WHITE),
        coat_roughness=v.number("coat_roughness", 0.0, 0.0, 1.0),
        coat_ior=_index(v, "coat_ior", default.coat_ior),
        coat_darkening=v.number("coat_darkening", 1.0, 0.0, 1.0),
    )


def standard_surface(v: Values) -> StandardSurface:
    """Autodesk's standard surface."""
    default = StandardSurface()
    return StandardSurface(
        base_weight=v.number("base", 1.0, 0.0, 1.0),
        base_color=v.colour("base_color", default.base_color),
        base_diffuse_roughness=v.number("diffuse_roughness", 0.0, 0.0, 1.0),
        base_metalness=v.number("metalness", 0.0, 0.0, 1.0),
        specular_weight=v.number("specular", 1.0, 0.0, 1.0),
        specular_color=v.colour("specular_color", WHITE),
        specular_roughness=v.number("specular_roughness", default.specular_roughness, 0.0, 1.0),
        specular_ior=_index(v, "specular_IOR", default.specular_ior),
        coat_weight=v.number("coat", 0.0, 0.0, 1.0),
        coat_color=v.colour("coat_color", WHITE),
        coat_roughness=v.number("coat_roughness", default.coat_roughness, 0.0, 1.0),
        coat_ior=_index(v, "coat_IOR", default.coat_ior),
    )


def gltf_pbr(v: Values) -> SchlickLayers:
    """glTF's metallic-roughness with its extensions for lobe and coat, which MaterialX draws so."""
    return SchlickLayers(
        v.colour("base_color", WHITE),
        v.number("metallic", 1.0, 0.0, 1.0),
        v.number("roughness", 1.0, 0.0, 1.0),
        _index(v, "ior", 1.5),
        v.number("specular", 1.0, 0.0, 1.0),
        v.colour("specular_color", WHITE, MOST_TINT),
        v.number("clearcoat", 0.0, 0.0, 1.0),
        v.number("clearcoat_roughness", 0.0, 0.0, 1.0),
    )


def usd_preview(v: Values) -> SchlickLayers:
    """USD preview surface; its specular workflow gives F0 itself."""
    metal, index, tint = v.number("metallic", 0.0, 0.0, 1.0), _index(v, "ior", 1.5), WHITE
    coat_f0 = ggx.head_on(index)
    v.asked.add("specularColor")  # it counts in one of both workflows alone
    if v.number("useSpecularWorkflow", 0.0, 0.0, 1.0) > 0.5:
        red, green, blue = v.colour("specularColor", (0.0, 0.0, 0.0))
        metal, index, tint = 0.0, 1.5, (red / 0.04, green / 0.04, blue / 0.04)
    return SchlickLayers(
        v.colour("diffuseColor", (0.18, 0.18, 0.18)),
        metal,
        v.number("roughness", 0.5, 0.0, 1.0),
        index,
        specular_color=tint,
        clearcoat=v.number("clearcoat", 0.0, 0.0, 1.0),
        clearcoat_roughness=v.number("clearcoatRoughness", 0.01, 0.0, 1.0),
        coat_f0=coat_f0,
        is_conductor=True,
    )


def disney(v: Values) -> SchlickLayers:
    """Disney's principled surface as MaterialX draws it: the lobe reflects alike at all angles."""
    v.asked.add("ior")  # of light that passes through
    base = v.colour("baseColor", (0.16, 0.16, 0.16))
    share = v.number("specularTint", 0.0, 0.0, 1.0)
    red, green, blue = (1.0 + share * (c - 1.0) for c in base)
    return SchlickLayers(
        base,
        v.number("metallic", 0.0, 0.0, 1.0),
        v.number("roughness", 0.5, 0.0, 1.0),
        MIRROR_INDEX,
        specular_color=(red, green, blue),
        clearcoat=0.04 * v.number("clearcoat", 0.0, 0.0, 1.0),
        clearcoat_roughness=1.0 - v.number("clearcoatGloss", 1.0, 0.0, 1.0),
        lobe_weight=0.08 * v.number("specular", 0.5, 0.0, 1.0),
        coat_f0=1.0,
    )


def _index(v: Values, name: str, default: float) -> float:
    """A refractive index; 0, by which others mean no reflection, counts as 1."""
    element = input_of(v.shader, name)
    stated = "" if element is None or connected(element) else element.get("value", "")
    if numbers_of(stated) == (0.0,):
        v.asked.add(name)
        v.cut[name] = "0, which counts as 1"
        return 1.0
    return v.number(name, default, *INDEX)


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
        "transmission_weight",
        ("subsurface_weight", "subsurface_color"),
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
        "transmission",
        ("subsurface", "subsurface_color"),
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
        "transmission",
        ("", ""),
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
        "",
        ("", ""),
    ),
    "disney_principled": Model(
        "Disney principled",
        disney,
        (
            ("specTrans", 0.0, "transmission"),
            ("subsurface", 0.0, "subsurface scattering"),
            ("sheen", 0.0, "sheen"),
            ("anisotropic", 0.0, "anisotropy"),
        ),
        "specTrans",
        ("", ""),
    ),
}


def starting_points(surface: Described) -> dict[str, Any]:
    """What refit_lobes starts from: colour, widths, F0 of a metal, refractive index."""
    if isinstance(surface, SchlickLayers):
        f0 = surface.lobe_weight * float(np.max(surface.f0))
        return gltf_starting_points(surface) | {"index": max(1.05, ggx.index_of(f0))}
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
