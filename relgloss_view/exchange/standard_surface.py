"""Autodesk's standard surface 1.0.1 in numpy, as MaterialX 1.39 draws it.

It has the layers of OpenPBR (openpbr.py) with three differences: the specular weight is on the
whole lobe, a coat changes neither the index nor the width of the lobe below, and metals are
conductors whose index follows from the colours of face and edge (Gulbrandsen 2014).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.exchange import ggx
from relgloss_view.exchange.openpbr import OpenPbr, albedo

MOST_REFLECTED = 0.99  #: by a metal head on, where MaterialX cuts it


@dataclass(frozen=True)
class StandardSurface(OpenPbr):
    """Parameters by the names of OpenPBR.

    >>> coated = StandardSurface(coat_weight=1.0, coat_ior=1.5)
    >>> coated.base_index  # OpenPBR's would be 1: nothing below a coat of the same index
    1.5
    """

    specular_roughness: float = 0.2
    coat_roughness: float = 0.1
    coat_ior: float = 1.5
    coat_darkening: float = 0.0

    @property
    def base_alpha(self) -> float:
        """Width of the base's lobe."""
        return max(self.specular_roughness**2, ggx.LEAST_ALPHA)

    @property
    def base_index(self) -> float:
        """Refractive index of the base."""
        return self.specular_ior

    @property
    def lobe_weight(self) -> float:
        """Of the base's dielectric lobe."""
        return self.specular_weight

    def _metal(self, t: ggx.Turn, alpha: float) -> Array:
        f0 = self.base_weight * np.asarray(self.base_color)
        edge = self.specular_weight * np.asarray(self.specular_color)
        fresnel = conductor(np.minimum(t.cos_d, 1.0)[..., None], *artistic_index(f0, edge))
        single = ggx.density(t.cos_h, alpha) * ggx.shadowing(t, alpha)
        whole = albedo(t.mu_o, alpha, 1.0)
        more = 1.0 + fresnel * ((1.0 - whole) / whole)[..., None]
        return np.asarray(single[..., None] * fresnel * more)


def artistic_index(f0: Array, edge: Array) -> tuple[Array, Array]:
    """Index and extinction of a metal of a reflectance head on and an edge tint (Gulbrandsen 2014).

    >>> n, k = artistic_index(np.array([0.9]), np.array([1.0]))
    >>> float(conductor(np.array([1.0]), n, k).round(6)[0])
    0.9
    """
    r = np.clip(f0, 0.0, MOST_REFLECTED)
    least = (1.0 - r) / (1.0 + r)
    most = (1.0 + np.sqrt(r)) / (1.0 - np.sqrt(r))
    n = most + edge * (least - most)
    k2 = ((n + 1.0) ** 2 * r - (n - 1.0) ** 2) / (1.0 - r)
    return n, np.sqrt(np.maximum(k2, 0.0))


def conductor(cos_d: Array, n: Array, k: Array) -> Array:
    """Fresnel's reflectance of a metal for unpolarised light (Born and Wolf 1999, 14.2)."""
    cos2 = cos_d * cos_d
    sin2 = 1.0 - cos2
    n2, k2 = n * n, k * k
    t0 = n2 - k2 - sin2
    a2b2 = np.sqrt(t0 * t0 + 4.0 * n2 * k2)
    a = np.sqrt(np.maximum(0.5 * (a2b2 + t0), 0.0))
    t1, t2 = a2b2 + cos2, 2.0 * cos_d * a
    perpendicular = (t1 - t2) / (t1 + t2)
    t3, t4 = cos2 * a2b2 + sin2 * sin2, t2 * sin2
    parallel = perpendicular * (t3 - t4) / (t3 + t4)
    return np.asarray(0.5 * (perpendicular + parallel))
