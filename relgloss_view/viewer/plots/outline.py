"""Where a highlight ends: lines of one value in a picture."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import AnyArray, Array
from relgloss_view.picture.model import tone

EDGE_SHARE = 0.5  #: of what the highlight adds at most to the displayed L*, at its edge
FAINTEST_LSTAR = 0.5  #: a highlight that adds less has no edge that anyone sees
MOST_SEGMENTS = 600  #: more is grain, and no edge
#: Radii in pixels over which a picture is averaged, one after the other, until it has an edge.
AVERAGED_PX = (0, 3, 6)


def highlight_edge(y_diffuse: AnyArray, y_specular: AnyArray, c: float, *, grainy: bool) -> Array:
    """Segments (N, 2, 2) of a highlight's edge: x, y from the upper left, in shares of the picture.

    y_diffuse, y_specular: (H, W), relative to Y_n. The edge is where half of the highest L* that
    the highlight adds to the displayed picture is left; of a grainy one, averaged over the grain.
    No segments where there is no edge.
    """
    l_d, l_s = tone.split_lightness(y_diffuse.astype(np.float64), y_specular.astype(np.float64))
    added = np.minimum(l_d + c * l_s, 100.0) - np.minimum(l_d, 100.0)
    height, width = added.shape
    for radius in AVERAGED_PX[grainy:]:
        mean = _averaged(_averaged(added, radius).T, radius).T
        highest = float(np.max(mean, initial=0.0))
        if highest < FAINTEST_LSTAR:
            break
        segments = level_lines(mean, EDGE_SHARE * highest)
        if len(segments) <= MOST_SEGMENTS:
            return np.asarray((segments + 0.5) / np.array([width, height]))
    return np.zeros((0, 2, 2))


def _averaged(values: Array, radius: int) -> Array:
    """Means over so many rows above and below, twice; the picture's edge goes on beyond it."""
    for _ in range(2 if radius else 0):
        padded = np.pad(values, ((radius + 1, radius), (0, 0)), mode="edge")
        sums = np.cumsum(padded, axis=0)
        values = (sums[2 * radius + 1 :] - sums[: -2 * radius - 1]) / (2 * radius + 1)
    return values


def level_lines(values: Array, level: float) -> Array:
    """Segments (N, 2, 2) of the lines where values (H, W) cross a level, x and y in pixels.

    Marching squares (Lorensen and Cline 1987, in the plane), linear between the centres of pixels.
    """
    above = values - level
    a, b, c, d = above[:-1, :-1], above[:-1, 1:], above[1:, 1:], above[1:, :-1]
    y, x = np.mgrid[: a.shape[0], : a.shape[1]].astype(np.float64)

    def share(first: Array, second: Array) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(first / (first - second))

    # The sides of a cell in their order around it: above, right, below, left.
    sides = np.stack(
        [(a > 0) != (b > 0), (b > 0) != (c > 0), (d > 0) != (c > 0), (a > 0) != (d > 0)]
    )
    points = np.stack(
        [
            np.stack([x + share(a, b), y], axis=-1),
            np.stack([x + 1.0, y + share(b, c)], axis=-1),
            np.stack([x + share(d, c), y + 1.0], axis=-1),
            np.stack([x, y + share(a, d)], axis=-1),
        ]
    )
    crossed = sides.sum(axis=0)
    found = []
    for first in range(4):
        for second in range(first + 1, 4):
            one = (crossed == 2) & sides[first] & sides[second]
            two = (crossed == 4) & ((first, second) in ((0, 1), (2, 3)))
            cells = one | two
            found.append(np.stack([points[first][cells], points[second][cells]], axis=1))
    return np.concatenate(found)
