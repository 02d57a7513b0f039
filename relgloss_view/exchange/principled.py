"""Mitsuba's `principled` in numpy, and the parameters with which it shows a material's picture.

The lobe is GGX with Smith's separable shadowing, the exact Fresnel for dielectrics and Schlick's
for metals; the diffuse part is Burley's 2012, which the lobe does not dim. Source: Mitsuba 3.9,
src/bsdfs/principled.cpp (Burley 2012, 2015). Tint, sheen, clearcoat, flatness and transmission are
not drawn.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.exchange import ggx
from relgloss_view.exchange.refit import (
    Refit,
    as_colour,
    body_colour,
    refit_with,
    roughness_of,
    spread_f0,
)
from relgloss_view.exchange.ways import Family, Unknown
from relgloss_view.gloss.meter.meter import main_lobe
from relgloss_view.material import brdf
from relgloss_view.material.material import Material

LEAST_ALPHA = 1e-3  #: Mitsuba draws no narrower lobe


@dataclass(frozen=True)
class Principled:
    """Parameters by the names of the plugin.

    >>> up = np.array([0.0, 0.0, 1.0])
    >>> diffuse, specular = Principled((0.5, 0.5, 0.5), roughness=1.0).evaluate(up, up)
    >>> specular.round(6).tolist()  # 0.04 / (4 pi), as GGX of alpha 1 has it
    [0.003183, 0.003183, 0.003183]
    """

    base_color: tuple[float, float, float] = (0.5, 0.5, 0.5)
    roughness: float = 0.5
    eta: float = 1.5
    metallic: float = 0.0

    def evaluate(self, i: Array, o: Array) -> tuple[Array, Array]:
        """See Surface: linear sRGB, (..., 3) each."""
        t = ggx.turn(i, o)
        alpha = max(LEAST_ALPHA, self.roughness**2)
        colour = np.asarray(self.base_color)
        weight = brdf.schlick_weight(np.minimum(t.cos_d, 1.0))[..., None]
        plain = brdf.fresnel_dielectric(np.minimum(t.cos_d, 1.0), self.eta)[..., None]
        metal = colour + (1.0 - colour) * weight
        fresnel = plain + self.metallic * (metal - plain)
        shape = ggx.density(t.cos_h, alpha) * ggx.separable_shadowing(t, alpha)
        f_i, f_o = brdf.schlick_weight(t.mu_i), brdf.schlick_weight(t.mu_o)
        retro = 2.0 * self.roughness * t.cos_d**2
        body = (1.0 - 0.5 * f_i) * (1.0 - 0.5 * f_o)
        body = body + retro * (f_o + f_i + f_o * f_i * (retro - 1.0))
        diffuse = (1.0 - self.metallic) / np.pi * body[..., None] * colour
        above = t.above[..., None]
        return np.where(above, diffuse, 0.0), np.where(above, shape[..., None] * fresnel, 0.0)


def refit_principled(material: Material) -> Refit:
    """The principled BSDF that shows a material's picture.

    >>> from relgloss_view import load_sample
    >>> refit_principled(load_sample("uncoated")).loss.de2000_p95 < 3.0
    True
    """
    return refit_with(material, families(material))


def families(material: Material) -> tuple[Family, ...]:
    """The one way of the plugin that is used: one lobe, of a dielectric or of a metal."""
    main = main_lobe(material)
    lobe = material.specular[main] if main is not None else None
    rough = 0.7 if lobe is None else roughness_of(lobe)
    if lobe is not None and lobe.is_metal:
        f0 = np.clip(spread_f0(lobe, material) * lobe.strength[0], 0.01, 0.99)
        unknowns = (
            *(Unknown(float(v), 0.0, 1.0) for v in f0),
            Unknown(rough, 0.03, 1.0),
            Unknown(0.95, 0.0, 1.0),
        )
        return (
            Family(
                "one metal lobe", unknowns, lambda x: Principled(as_colour(x), x[3], metallic=x[4])
            ),
        )
    unknowns = (
        *body_colour(material),
        Unknown(rough, 0.03, 1.0),
        Unknown(1.5, 1.01, 3.0),
    )
    return (
        Family("one lobe", unknowns, lambda x: Principled(as_colour(x), float(x[3]), float(x[4]))),
    )
