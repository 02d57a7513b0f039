"""The surface of a glTF 2.0 material in numpy: metallic-roughness, specular, ior and clearcoat.

The formulas are those of appendix B of the specification (Khronos 2021) and of the extensions
KHR_materials_specular, KHR_materials_ior and KHR_materials_clearcoat: GGX with Smith's correlated
shadowing, Fresnel by Schlick 1994, a Lambertian body that loses what the specular part reflects,
and a clear coat of F0 0.04. Its Fresnel is by the half-vector in both places, as Filament draws it;
the extension takes the angle of the normal, and three.js does for what is left to the layers below,
which differs where the lamp grazes the surface.
Programs of the web leave out the light that facets reflect more than once, and so does this.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.exchange import ggx

Colour = tuple[float, float, float]
WHITE: Colour = (1.0, 1.0, 1.0)
MODEL = "glTF 2.0"
#: Extensions that the surface holds.
SPECULAR, IOR, COAT = "KHR_materials_specular", "KHR_materials_ior", "KHR_materials_clearcoat"
GLTF_LOBES = ("roughness", "clearcoat_roughness")  #: of the base, and of the coat
COAT_F0 = 0.04  #: of KHR_materials_clearcoat, whose index is 1.5
#: In files: no more digits than a float32 has.
DIGITS = 6


@dataclass(frozen=True)
class GltfSurface:
    """Factors of a material, each of glTF's default where it is left out; colours in linear sRGB.

    base_color: 0 to 1. metallic, roughness: 0 to 1, alpha is roughness squared. ior: 1 or more.
    specular: 0 to 1, of the whole dielectric reflection. specular_color: 0 or more, of F0 alone.
    clearcoat, clearcoat_roughness: 0 to 1.

    >>> surface = GltfSurface(base_color=(0.5, 0.5, 0.5), metallic=0.0, specular=0.0)
    >>> up = np.array([0.0, 0.0, 1.0])
    >>> diffuse, specular = surface.evaluate(up, up)
    >>> diffuse.round(4).tolist(), specular.tolist()  # 0.5 / pi
    ([0.1592, 0.1592, 0.1592], [0.0, 0.0, 0.0])
    """

    base_color: Colour = WHITE
    metallic: float = 1.0
    roughness: float = 1.0
    ior: float = 1.5
    specular: float = 1.0
    specular_color: Colour = WHITE
    clearcoat: float = 0.0
    clearcoat_roughness: float = 0.0

    def evaluate(self, i: Array, o: Array) -> tuple[Array, Array]:
        """See Surface: linear sRGB, (..., 3) each."""
        t = ggx.turn(i, o)
        base = np.asarray(self.base_color)
        lobe = _lobe(t, self.roughness)[..., None]
        w = ((1.0 - np.minimum(t.cos_d, 1.0)) ** 5)[..., None]
        f0, f90 = self.f0, self.specular
        fresnel = f0 + (f90 - f0) * w
        body = (1.0 - np.max(fresnel, axis=-1, keepdims=True)) * base / np.pi
        diffuse = (1.0 - self.metallic) * body
        metal = base + (1.0 - base) * w
        specular = lobe * ((1.0 - self.metallic) * fresnel + self.metallic * metal)
        if self.clearcoat > 0.0:
            coat = self.clearcoat * (COAT_F0 + (1.0 - COAT_F0) * w)
            diffuse = diffuse * (1.0 - coat)
            specular = specular * (1.0 - coat)
            specular = specular + coat * _lobe(t, self.clearcoat_roughness)[..., None]
        above = t.above[..., None]
        return np.where(above, diffuse, 0.0), np.where(above, specular, 0.0)

    @property
    def f0(self) -> Array:
        """(3,), what the dielectric reflects head on (KHR_materials_specular and _ior)."""
        head_on = ggx.head_on(self.ior) * np.asarray(self.specular_color)
        return np.minimum(head_on, 1.0) * self.specular

    def as_json(self) -> dict[str, Any]:
        """The factors in the words of a glTF file, defaults left out; DIGITS decimals."""
        core: dict[str, Any] = {}
        if self.base_color != WHITE:
            core["baseColorFactor"] = [*_rounded(self.base_color), 1.0]
        for name, value in (("metallicFactor", self.metallic), ("roughnessFactor", self.roughness)):
            if value != 1.0:
                core[name] = round(value, DIGITS)
        extensions: dict[str, Any] = {}
        specular: dict[str, Any] = {}
        if self.specular != 1.0:
            specular["specularFactor"] = round(self.specular, DIGITS)
        if self.specular_color != WHITE:
            specular["specularColorFactor"] = _rounded(self.specular_color)
        if self.clearcoat > 0.0:
            extensions[COAT] = {
                "clearcoatFactor": round(self.clearcoat, DIGITS),
                "clearcoatRoughnessFactor": round(self.clearcoat_roughness, DIGITS),
            }
        if self.ior != 1.5:
            extensions[IOR] = {"ior": round(self.ior, DIGITS)}
        if specular:
            extensions[SPECULAR] = specular
        made: dict[str, Any] = {"pbrMetallicRoughness": core}
        if extensions:
            made["extensions"] = extensions
        return made


def gltf_starting_points(surface: GltfSurface) -> dict[str, Any]:
    """What refit_lobes starts from: colour, widths (the stronger lobe first), F0, index."""
    base = max(surface.roughness**2, ggx.LEAST_ALPHA)
    alphas = [base]
    if surface.clearcoat > 0.0:
        coat = max(surface.clearcoat_roughness**2, ggx.LEAST_ALPHA)
        weight = float(np.max(surface.f0)) if surface.metallic < 0.5 else 1.0
        first = weight / base >= COAT_F0 * surface.clearcoat / coat
        alphas = [base, coat] if first else [coat, base]
    return {
        "colour": tuple((1.0 - surface.metallic) * v for v in surface.base_color),
        "alphas": alphas,
        "f0": surface.base_color if surface.metallic > 0.5 else None,
        "index": max(1.01, ggx.index_of(float(np.max(surface.f0)))),
    }


def _lobe(t: ggx.Turn, roughness: float) -> Array:
    """D V of GGX facets, 1/sr; narrower ones than a shader can draw are drawn as LEAST_ALPHA."""
    alpha = max(roughness * roughness, ggx.LEAST_ALPHA)
    return np.asarray(ggx.density(t.cos_h, alpha) * ggx.shadowing(t, alpha))


def _rounded(colour: Colour) -> list[float]:
    return [round(value, DIGITS) for value in colour]
