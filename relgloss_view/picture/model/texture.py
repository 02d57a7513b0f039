"""Artwork filtered where a pixel sees it. The twin of shaders/artwork.glsl, in float64 over arrays.

A picture is held at several levels, each half as large as the one before and each covering the
whole picture (Williams 1983), as numbers linear in light. The footprint of a pixel is an ellipse,
whose axes follow from the derivatives of the texel coordinates (Heckbert 1989). Probes along its
major axis, each as wide as its minor axis, fill it, as EXT_texture_filter_anisotropic describes:

    L, l      the axes of the footprint, texels of level 0
    radius    max(l, L / MOST_PROBES, 1)
    probes    ceil(L / radius - PROBE_SLACK), 1 to MOST_PROBES, evenly along the major axis
    level     log2(radius), at most the last

Each probe is trilinear; beside the picture its edge goes on. How much of a pixel the picture covers
follows from the place and the footprint: beside the picture it fades out within one pixel.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import AnyArray, Array, Ints

MOST_PROBES = 8
#: A footprint that is round but for rounding keeps one probe.
PROBE_SLACK = 0.05
LEAST_REACH = 1e-6  #: texels


class Footprint(NamedTuple):
    """How a pixel reads a picture; fields are (...), vectors (..., 2)."""

    axis: Array  #: unit vector along the major axis, texels of level 0
    length: Array  #: of the major axis, texels
    probes: Ints
    level: Array
    reach: Array  #: (..., 2), extent across columns and rows, texels


def footprint(right: Array, down: Array, levels: int) -> Footprint:
    """The footprint of a pixel.

    right, down: (..., 2), change of the texel's column and row to the next pixel. levels: how many
    there are.

    >>> seen = footprint(np.array([4.0, 0.0]), np.array([0.0, 1.0]), 9)
    >>> seen.axis.tolist(), float(seen.length), int(seen.probes), float(seen.level)
    ([1.0, 0.0], 4.0, 4, 0.0)
    """
    xx = right[..., 0] ** 2 + down[..., 0] ** 2
    yy = right[..., 1] ** 2 + down[..., 1] ** 2
    xy = right[..., 0] * right[..., 1] + down[..., 0] * down[..., 1]
    half = 0.5 * (xx - yy)
    root = np.sqrt(half * half + xy * xy)
    mean = 0.5 * (xx + yy)
    longest, shortest = np.sqrt(mean + root), np.sqrt(np.maximum(mean - root, 0.0))
    wide = half >= 0.0
    axis = np.stack([np.where(wide, root + half, xy), np.where(wide, xy, root - half)], axis=-1)
    size = np.linalg.norm(axis, axis=-1, keepdims=True)
    axis = np.where(size > 0.0, axis / np.where(size > 0.0, size, 1.0), (1.0, 0.0))
    radius = np.maximum(np.maximum(shortest, longest / MOST_PROBES), 1.0)
    probes = np.clip(np.ceil(longest / radius - PROBE_SLACK), 1, MOST_PROBES).astype(np.int64)
    level = np.minimum(np.log2(radius), levels - 1.0)
    return Footprint(axis, longest, probes, level, np.sqrt(np.stack([xx, yy], axis=-1)))


def filtered(
    levels: Sequence[tuple[AnyArray, ...]],
    share: Array,
    seen: Footprint,
    *,
    repeats: bool = False,
) -> tuple[list[Array], Array]:
    """Values (N, C) of pictures of one size where pixels see them, and what lies on them, (N,).

    levels: the pictures (H_k, W_k, C) at each level, level 0 first, row 0 the top. share: (N, 2),
    place in the picture, 0 to 1 from its left and its top. seen: of N pixels. repeats: whether the
    left edge meets the right one. The second result is 1 on the pictures and falls to 0 within a
    pixel beside them; the values are multiplied by it.

    >>> ramp = np.array([[[0.0], [1.0]]])
    >>> one = footprint(np.zeros((1, 2)), np.zeros((1, 2)), 1)
    >>> [values], on = filtered([(ramp,)], np.array([[0.5, 0.5]]), one)
    >>> values.tolist(), on.tolist()
    ([[0.5]], [1.0])
    """
    size = np.array([levels[0][0].shape[1], levels[0][0].shape[0]], dtype=np.float64)
    along = seen.axis * seen.length[:, None] / size
    lower = np.floor(seen.level).astype(np.int64)
    fraction = seen.level - lower
    totals = [np.zeros((len(share), picture.shape[2])) for picture in levels[0]]
    for k in range(MOST_PROBES):
        at = np.nonzero(seen.probes > k)[0]
        if len(at) == 0:
            break
        offset = (k + 0.5) / seen.probes[at] - 0.5
        place = share[at] + along[at] * offset[:, None]
        for step in (0, 1):
            level = np.minimum(lower[at] + step, len(levels) - 1)
            weight = (fraction[at] if step else 1.0 - fraction[at]) / seen.probes[at]
            for number in np.unique(level[weight > 0.0]):
                some = (level == number) & (weight > 0.0)
                pictures = levels[number]
                for texels, tap in _taps(pictures[0].shape[:2], place[some], repeats):
                    tap = tap * weight[some]
                    for total, picture in zip(totals, pictures, strict=True):
                        total[at[some]] += tap[:, None] * picture[texels].astype(np.float64)
    on = _covered(share[:, 1], size[1], seen.reach[:, 1])
    if not repeats:
        on = on * _covered(share[:, 0], size[0], seen.reach[:, 0])
    return [on[:, None] * total for total in totals], on


def _covered(share: Array, texels: float, reach: Array) -> Array:
    """1 where a place is between 0 and 1, and beside it less by what part of a pixel it is away."""
    inside = np.minimum(share, 1.0 - share) * texels
    return np.asarray(np.clip(1.0 + inside / np.maximum(reach, LEAST_REACH), 0.0, 1.0))


def _taps(
    size: tuple[int, ...], share: Array, repeats: bool
) -> Iterator[tuple[tuple[Ints, Ints], Array]]:
    """The four texels about each place (rows, columns), and their weights."""
    height, width = size
    # Far beside the picture nothing is shown; numbers beyond integers don't get there.
    column = np.clip(share[:, 0], -1e6, 1e6) * width - 0.5
    row = np.clip(share[:, 1], -1e6, 1e6) * height - 0.5
    left, top = np.floor(column).astype(np.int64), np.floor(row).astype(np.int64)
    across, down = column - left, row - top
    for y in (0, 1):
        for x in (0, 1):
            weight = (across if x else 1.0 - across) * (down if y else 1.0 - down)
            at_x, at_y = left + x, top + y
            at_x = at_x % width if repeats else np.clip(at_x, 0, width - 1)
            yield (np.clip(at_y, 0, height - 1), at_x), weight
