"""glTF PBR, USD preview surface and Disney's principled surface as MaterialX 1.39 draws them.

All three are lobes of Schlick's Fresnel above a Lambertian body, each with the energy compensation
of Turquin 2019, dimming what lies below by its albedo towards the eye (their node graphs in
MaterialX 1.39.5, libraries/bxdf, and mx_generalized_schlick_bsdf.glsl). Burley's diffuse part of
Disney's surface counts as Lambert's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.exchange import ggx
from relgloss_view.exchange.gltf_brdf import GltfSurface
from relgloss_view.exchange.openpbr import albedo, dielectric
from relgloss_view.exchange.standard_surface import artistic_index, conductor

COAT_INDEX = 1.5


@dataclass(frozen=True)
class SchlickLayers(GltfSurface):
    """Factors by the names of glTF, and what differs between the models.

    lobe_weight: of the whole dielectric lobe. coat_f0: of Schlick's Fresnel of the coat; None for
    the exact one of index 1.5. is_conductor: whether metals have Fresnel's reflectance.

    >>> surface = SchlickLayers(base_color=(0.5, 0.5, 0.5), metallic=0.0, specular=0.0)
    >>> up = np.array([0.0, 0.0, 1.0])
    >>> surface.evaluate(up, up)[0].round(4).tolist()  # 0.5 / pi
    [0.1592, 0.1592, 0.1592]
    """

    lobe_weight: float = 1.0
    coat_f0: float | None = None
    is_conductor: bool = False

    def evaluate(self, i: Array, o: Array) -> tuple[Array, Array]:
        """See Surface: linear sRGB, (..., 3) each."""
        t = ggx.turn(i, o)
        base, metal = np.asarray(self.base_color), self.metallic
        alpha = max(self.roughness**2, ggx.LEAST_ALPHA)
        top, passed = _schlick(t, alpha, self.f0, self.specular, self.lobe_weight)
        diffuse = (1.0 - metal) * passed * base / np.pi
        specular = (1.0 - metal) * top
        if metal > 0.0 and self.is_conductor:
            fresnel = conductor(np.minimum(t.cos_d, 1.0)[..., None], *artistic_index(base, base))
            specular = specular + metal * _lobe(t, alpha, fresnel)
        elif metal > 0.0:
            specular = specular + metal * _schlick(t, alpha, base, 1.0, 1.0)[0]
        if self.clearcoat > 0.0:
            coat_alpha = max(self.clearcoat_roughness**2, ggx.LEAST_ALPHA)
            if self.coat_f0 is None:
                top, passed = (
                    part[..., None]
                    for part in dielectric(t, coat_alpha, COAT_INDEX, self.clearcoat)
                )
            else:
                f0 = np.full(3, self.coat_f0)
                top, passed = _schlick(t, coat_alpha, f0, 1.0, self.clearcoat)
            diffuse, specular = diffuse * passed, specular * passed + top
        above = t.above[..., None]
        return np.where(above, diffuse, 0.0), np.where(above, specular, 0.0)


def _lobe(t: ggx.Turn, alpha: float, fresnel: Array) -> Array:
    return fresnel * _more(t, alpha, fresnel) * _single(t, alpha)


def _single(t: ggx.Turn, alpha: float) -> Array:
    return np.asarray(ggx.density(t.cos_h, alpha) * ggx.shadowing(t, alpha))[..., None]


def _more(t: ggx.Turn, alpha: float, fresnel: Array) -> Array:
    whole = albedo(t.mu_o, alpha, 1.0)
    return np.asarray(1.0 + fresnel * ((1.0 - whole) / whole)[..., None])


def _schlick(
    t: ggx.Turn, alpha: float, f0: Array, f90: float, weight: float
) -> tuple[Array, Array]:
    """A lobe, 1/sr, and the share of light (..., 1) that it leaves to what is below."""
    w = ((1.0 - np.minimum(t.cos_d, 1.0)) ** 5)[..., None]
    fresnel = f0 + (f90 - f0) * w
    more = _more(t, alpha, fresnel)
    towards_eye = [albedo(t.mu_o, alpha, float(v), f90) for v in f0]
    whole = np.stack(towards_eye, axis=-1) * more
    passed = 1.0 - weight * np.mean(whole, axis=-1, keepdims=True)
    return weight * fresnel * more * _single(t, alpha), passed
