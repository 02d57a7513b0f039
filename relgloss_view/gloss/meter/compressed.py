"""A window's flux integral in few numbers, for lobes that are wider than the window.

Such a lobe is integrated over nodes that do not depend on it, and its integrand D(delta) F(cos_d)
is smooth in both. So the nodes' weights are gathered once at the nodes of two Chebyshev
interpolants, one in the squared facet angle and one in the cosine at the facet, and every flux is
a small bilinear form. It equals the sum over all nodes within 1e-13 of the black glass (tests).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.gloss.meter.geometry import Meter, Nodes, Window, nodes_of, reach_of, spread_of
from relgloss_view.material import brdf

#: Degrees of the interpolants. A density exp(-t x) on an interval of t x <= LARGEST_DECAY and a
#: reflectance of index LEAST_INDEX or more are met to the last digits of a double.
DENSITY_NODES, FRESNEL_NODES = 56, 24
LARGEST_DECAY = 100.0
#: Below it Fresnel's reflectance has a branch point near grazing incidence.
LEAST_INDEX = 1.1


@dataclass(frozen=True)
class Compressed:
    """delta2: (K,), rad^2; cos_d: (J,); weights: (K, J), so that a flux is the sum of weights times
    density at delta2 times reflectance at cos_d.
    """

    delta2: Array
    cos_d: Array
    weights: Array

    def serves(self, meter: Meter, window: Window, s: float) -> bool:
        """Whether a lobe of facet sd s (radians) fills the window and is smooth over it."""
        reach, spread = reach_of(meter, s), spread_of(meter, window)
        fills = reach[0] >= spread[0] and reach[1] >= spread[1]
        return fills and self.delta2[0] <= LARGEST_DECAY * 2.0 * s * s


def is_smooth(fresnel: brdf.Fresnel) -> bool:
    """Whether a reflectance is met by the interpolant."""
    return isinstance(fresnel, brdf.MetalPart) or fresnel >= LEAST_INDEX


@lru_cache(maxsize=32)
def compressed(meter: Meter, window: Window) -> Compressed:
    """The window's integral over the nodes of lobes that fill it."""
    nodes: Nodes = nodes_of(meter, window, None)
    delta2, rows = _gathered(nodes.delta2.ravel(), DENSITY_NODES)
    cos_d, columns = _gathered(nodes.cos_d.ravel(), FRESNEL_NODES)
    weights = (rows * nodes.weight.ravel()) @ columns.T
    return Compressed(delta2, cos_d, weights)


def _gathered(x: Array, count: int) -> tuple[Array, Array]:
    """Chebyshev nodes (C,) over the range of x (P,), falling, and their Lagrange polynomials at x,
    (C, P): those of Chebyshev's first kind (Trefethen 2013, Approximation Theory, chapter 4).
    """
    low, high = float(np.min(x)), float(np.max(x))
    turn = (np.arange(count) + 0.5) * np.pi / count
    middle, half = 0.5 * (low + high), max(0.5 * (high - low), 1e-300)
    places = np.cos(np.outer(np.arange(count), turn))  # T_m at the nodes
    places[0] *= 0.5
    at_x = np.empty((count, len(x)))  # T_m at x, by their recurrence
    at_x[0], at_x[1] = 1.0, np.clip((x - middle) / half, -1.0, 1.0)
    for m in range(2, count):
        at_x[m] = 2.0 * at_x[1] * at_x[m - 1] - at_x[m - 2]
    return middle + half * np.cos(turn), (2.0 / count) * places.T @ at_x
