"""The triangle of a display's primaries, held against those of standard spaces.

Areas are those of the CIE 1976 u'v' diagram, where equal distances look more alike than in xy.
Sources of primaries: IEC 61966-2-1:1999 (sRGB), SMPTE EG 432-1:2010 (Display P3 has its primaries),
Adobe RGB (1998), version 2005-05.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array

#: Primaries of standard spaces, CIE 1931 xy.
STANDARDS = {
    "sRGB": ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06)),
    "Display P3": ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060)),
    "Adobe RGB": ((0.64, 0.33), (0.21, 0.71), (0.15, 0.06)),
}


@dataclass(frozen=True)
class Coverage:
    """covered: share of the standard's triangle that the display shows; size: ratio of areas."""

    covered: float
    size: float


def uv_of_xy(xy: Sequence[Sequence[float]] | Array) -> Array:
    """CIE 1976 u', v' (N, 2) of chromaticities x, y (N, 2); CIE 15:2004, 8.1.

    >>> uv_of_xy([(0.3127, 0.3290)]).round(4).tolist()
    [[0.1978, 0.4683]]
    """
    x, y = np.asarray(xy, dtype=np.float64).T
    below = -2.0 * x + 12.0 * y + 3.0
    return np.stack([4.0 * x / below, 9.0 * y / below], axis=1)


def coverage(primaries_xy: Sequence[Sequence[float]], standard: str) -> Coverage:
    """How much of a standard's gamut three primaries have.

    >>> coverage(STANDARDS["sRGB"], "sRGB").covered
    1.0
    """
    own, other = uv_of_xy(primaries_xy), uv_of_xy(STANDARDS[standard])
    whole = abs(_area(other))
    common = min(abs(_area(_within(own, other))) / whole, 1.0)
    return Coverage(round(common, 9), abs(_area(own)) / whole)


def _area(polygon: Array) -> float:
    """The signed area of a polygon (N, 2), positive where it turns left."""
    if len(polygon) < 3:
        return 0.0
    x, y = polygon.T
    return float(0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def _within(polygon: Array, triangle: Array) -> Array:
    """The part of a convex polygon inside a triangle (Sutherland and Hodgman 1974)."""
    if _area(triangle) < 0.0:
        triangle = triangle[::-1]
    for start, end in zip(triangle, np.roll(triangle, -1, axis=0), strict=True):
        normal = np.array([start[1] - end[1], end[0] - start[0]])  # to the left, inside
        depth = (polygon - start) @ normal
        kept: list[Array] = []
        for k in range(len(polygon)):
            here, before = depth[k], depth[k - 1]
            if (here < 0.0) != (before < 0.0):
                share = before / (before - here)
                kept.append(polygon[k - 1] + share * (polygon[k] - polygon[k - 1]))
            if here >= 0.0:
                kept.append(polygon[k])
        polygon = np.array(kept).reshape(-1, 2)
    return polygon
