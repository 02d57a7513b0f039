"""How far a metal's reflectance by Schlick's form is from that of its optical constants.

A lobe of kind `metal` has F = (1 - w) F0 + w (Schlick 1994), which folds into three channels. The
reflectance of a conductor follows from its complex refractive index (Born and Wolf 1999, 14.2).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array
from relgloss_view.material.brdf import schlick_weight
from relgloss_view.material.conductor import fresnel_conductor

#: (nm, n, k). Gold and copper: Johnson and Christy 1972; aluminium: Rakic 1995.
METALS: Mapping[str, tuple[tuple[float, float, float], ...]] = {
    "gold": (
        (450.9, 1.38, 1.914),
        (495.9, 1.04, 1.833),
        (548.6, 0.43, 2.455),
        (582.1, 0.29, 2.863),
        (659.5, 0.14, 3.697),
    ),
    "copper": (
        (450.9, 1.24, 2.397),
        (495.9, 1.22, 2.564),
        (548.6, 1.02, 2.577),
        (582.1, 0.70, 2.704),
        (659.5, 0.22, 3.747),
    ),
    "aluminium": (
        (442.80, 0.60790, 5.3676),
        (476.87, 0.72780, 5.7781),
        (563.57, 1.0728, 6.7839),
        (652.25, 1.5724, 7.7354),
    ),
}


class SchlickError(NamedTuple):
    """Reflectance by Schlick's form minus the exact one, over angles (A,) and wavelengths (W,)."""

    angle_deg: Array
    exact: Array  #: (W, A)
    difference: Array  #: (W, A)

    def largest(self, up_to_deg: float = 90.0) -> float:
        """The largest difference up to an angle, in units of reflectance."""
        return float(np.max(np.abs(self.difference[:, self.angle_deg <= up_to_deg])))


def schlick_error(metal: str, angle_deg: ArrayLike = tuple(range(91))) -> SchlickError:
    """The error of a metal of METALS at angles between light and facet, degrees.

    >>> round(schlick_error("gold").largest(60.0), 3)
    0.023
    """
    angles = np.atleast_1d(np.asarray(angle_deg, dtype=np.float64))
    cosine = np.cos(np.radians(angles))
    _, n, k = (np.array(column)[:, None] for column in zip(*METALS[metal], strict=True))
    exact = fresnel_conductor(cosine, n, k)
    f0, weight = fresnel_conductor(1.0, n, k), schlick_weight(cosine)
    return SchlickError(angles, exact, (1.0 - weight) * f0 + weight - exact)
