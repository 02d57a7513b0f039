"""Correlated colour temperature of a white, by its definition.

It is the temperature of the Planckian radiator whose chromaticity is nearest in the CIE 1960 uv
diagram, whose axes are u' and 2/3 v' (CIE 15:2004, 9.5).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.material.spectra import observer

SECOND_RADIATION_M_K = 1.4388e-2  #: c2 of Planck's law (CIE 15:2004, 3.1)
LOWEST_K, HIGHEST_K = 1500.0, 40000.0
FARTHEST = 0.05  #: from the locus; beyond it there is no such temperature (CIE 15:2004, 9.5)
_STEPS = 4001


def correlated_temperature(xy: tuple[float, float]) -> tuple[float, float] | None:
    """Temperature in K, and the distance from the locus, positive above it (towards green).

    None where the chromaticity is too far from the locus, or its temperature out of range.

    >>> temperature, distance = correlated_temperature((0.3127, 0.3290))
    >>> round(temperature), round(distance, 4)
    (6504, 0.0032)
    """
    kelvin, locus = _locus()
    x, y = xy
    if y <= 0.0:
        return None
    below = -2.0 * x + 12.0 * y + 3.0
    point = np.array([4.0 * x, 6.0 * y]) / below
    along = np.hypot(*(locus - point).T)
    k = int(np.argmin(along))
    if along[k] > FARTHEST or k in (0, _STEPS - 1):
        return None
    side = 1.0 if point[1] > locus[k, 1] else -1.0
    # The least of the parabola through three squared distances, in steps of the logarithm.
    before, at, after = along[k - 1 : k + 2] ** 2
    shift = 0.5 * (before - after) / (before - 2.0 * at + after)
    least = max(at - 0.25 * (before - after) * shift, 0.0)
    return float(kelvin[k] * (kelvin[k + 1] / kelvin[k]) ** shift), side * float(np.sqrt(least))


@lru_cache(maxsize=1)
def _locus() -> tuple[Array, Array]:
    """Temperatures in even steps of their inverse, and u, v of 1960 (N, 2) of each."""
    kelvin = 1.0 / np.linspace(1.0 / LOWEST_K, 1.0 / HIGHEST_K, _STEPS)
    table = observer()
    metres = 1e-9 * table[:, 0]
    power = metres**-5.0 / np.expm1(SECOND_RADIATION_M_K / (metres * kelvin[:, None]))
    xyz = power @ table[:, 1:]
    below = xyz @ np.array([1.0, 15.0, 3.0])
    uv = np.stack([4.0 * xyz[:, 0] / below, 6.0 * xyz[:, 1] / below], axis=1)
    return kelvin, uv
