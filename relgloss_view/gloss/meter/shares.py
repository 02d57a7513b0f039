"""What the parts of materials send into meters' windows, and reflect in all, each computed once.

The standard errors of a reading move one number of a material at a time, so most parts of the moved
materials are parts of the fitted one. A `Shares` holds what it has computed while one material is
read, and goes with it: nothing is kept from one material to the next but the meters' own nodes.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.gloss.meter.compressed import compressed, is_smooth
from relgloss_view.gloss.meter.geometry import (
    DISTINCTNESS,
    HAZE,
    MIRROR_DEG,
    SPECULAR,
    Meter,
    Window,
    diffuse_nodes,
    nodes_of,
)
from relgloss_view.material import brdf
from relgloss_view.material.albedo import level_diffuse_albedo, level_lobe_albedo

#: The windows of all meters, whose diffuse parts are computed together.
WINDOWS = tuple((m, w) for m in (*SPECULAR.values(), HAZE, DISTINCTNESS) for w in m.windows)


class Shares:
    """Shares of the light of one material's parts, and of those of materials near it."""

    def __init__(self) -> None:
        self._fluxes: dict[tuple[Meter, Window, float, brdf.Fresnel], float] = {}
        self._facets: dict[tuple[Meter, Window, float], tuple[Array, Array]] = {}
        self._diffuse: dict[tuple[str, float], dict[tuple[Meter, Window], tuple[float, float]]] = {}
        self._diffuse_albedos: dict[tuple[str, float], tuple[float, float]] = {}
        self._lobe_albedos: dict[tuple[float, brdf.Fresnel], float] = {}

    def lobe_flux(self, meter: Meter, window: Window, s_deg: float, fresnel: brdf.Fresnel) -> float:
        """Share that a lobe of unit strength, or a part of a metal's, sends into a window."""
        key = (meter, window, s_deg, fresnel)
        if key not in self._fluxes:
            self._fluxes[key] = self._lobe_flux(*key)
        return self._fluxes[key]

    def _lobe_flux(
        self, meter: Meter, window: Window, s_deg: float, fresnel: brdf.Fresnel
    ) -> float:
        s = float(np.radians(max(s_deg, MIRROR_DEG)))
        if is_smooth(fresnel):
            few = compressed(meter, window)
            if few.serves(meter, window, s):
                density = brdf.facet_density(few.delta2, s)
                return float(density @ few.weights @ brdf.reflectance(few.cos_d, fresnel))
        key = (meter, window, s)
        if key not in self._facets:
            nodes = nodes_of(meter, window, s)
            weight = nodes.weight * brdf.facet_density(nodes.delta2, s)
            self._facets[key] = weight.ravel(), nodes.cos_d.ravel()
        weight, cos_d = self._facets[key]
        return float(weight @ brdf.reflectance(cos_d, fresnel))

    def diffuse_flux(
        self, meter: Meter, window: Window, model: str, sigma: float
    ) -> tuple[float, float]:
        """Shares that the two shapes of a diffuse model send into a window (see brdf)."""
        if (meter, window) not in WINDOWS:
            return diffuse_flux(meter, window, model, sigma)
        key = (model, sigma)
        if key not in self._diffuse:
            f, weight, starts = _all_diffuse_nodes()
            shapes = brdf.diffuse_shapes(model, f, sigma)
            first, second = (np.add.reduceat(weight * shape, starts).tolist() for shape in shapes)
            pairs = zip(first, second, strict=True)
            self._diffuse[key] = dict(zip(WINDOWS, pairs, strict=True))
        return self._diffuse[key][meter, window]

    def diffuse_albedo(self, model: str, sigma: float) -> tuple[float, float]:
        """Shares of light along the normal that a diffuse model's two shapes reflect."""
        key = (model, sigma)
        if key not in self._diffuse_albedos:
            self._diffuse_albedos[key] = level_diffuse_albedo(model, sigma)
        return self._diffuse_albedos[key]

    def lobe_albedo(self, s: float, fresnel: brdf.Fresnel) -> float:
        """Share of light along the normal that a lobe of unit strength reflects; s in radians."""
        key = (s, fresnel)
        if key not in self._lobe_albedos:
            self._lobe_albedos[key] = level_lobe_albedo(s, fresnel)
        return self._lobe_albedos[key]


@lru_cache(maxsize=1)
def _all_diffuse_nodes() -> tuple[brdf.Facing, Array, Ints]:
    """Orientations and weights of all windows (P,), and where each window's begin (W,)."""
    each = [diffuse_nodes(meter, window) for meter, window in WINDOWS]
    f = brdf.Facing(*(np.concatenate(parts) for parts in zip(*(f for f, _ in each), strict=True)))
    weights = [weight for _, weight in each]
    starts = np.cumsum([0, *(len(weight) for weight in weights[:-1])])
    return f, np.concatenate(weights), starts


def lobe_flux(meter: Meter, window: Window, s_deg: float, fresnel: brdf.Fresnel) -> float:
    """Share that a Torrance-Sparrow lobe of unit strength, or a part of a metal's, sends into a
    window. s_deg: per-axis standard deviation of the facets, degrees.
    """
    return Shares().lobe_flux(meter, window, s_deg, fresnel)


def diffuse_flux(meter: Meter, window: Window, model: str, sigma: float) -> tuple[float, float]:
    """Shares that the two shapes of a diffuse model send into a window (see brdf)."""
    f, weight = diffuse_nodes(meter, window)
    first, second = brdf.diffuse_shapes(model, f, sigma)
    return float(weight @ first), float(weight @ second)
