"""Artwork filtered where a pixel sees it. The twin of shaders/texture.glsl, in float64 over arrays.

A picture is held at several levels, each half as large as the one before and each covering the
whole picture (Williams 1983), as numbers linear in light. The footprint of a pixel is an ellipse,
whose axes follow from the derivatives of the texel coordinates (Heckbert 1989). Probes along its
major axis, each as wide as its minor axis, fill it, as EXT_texture_filter_anisotropic describes:

    L, l      the axes of the footprint, texels of level 0
    radius    max(l, L / MOST_PROBES, 1)
    probes    ceil(L / radius - PROBE_SLACK), 1 to MOST_PROBES, evenly along the major axis
    level     log2(radius), at most the last

Each probe is trilinear. A tap beside the picture reads the value that lies outside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import AnyArray, Array, Ints, Mask

MOST_PROBES = 8
#: A footprint that is round but for rounding keeps one probe.
PROBE_SLACK = 0.05


class Footprint(NamedTuple):
    """How a pixel reads a picture; (...), the axis (..., 2)."""

    axis: Array  #: unit vector along the major axis, texels of level 0
    length: Array  #: of the major axis, texels
    probes: Ints
    level: Array


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
    return Footprint(axis, longest, probes, np.minimum(np.log2(radius), levels - 1.0))


def filtered(
    levels: Sequence[AnyArray],
    share: Array,
    seen: Footprint,
    *,
    repeats: bool = False,
    outside: ArrayLike = 0.0,
) -> Array:
    """Values (N, C) of a picture where pixels see it.

    levels: (H_k, W_k, C) each, level 0 first, row 0 the top. share: (N, 2), place in the picture,
    0 to 1 from its left and its top. seen: of N pixels. repeats: whether the left edge meets the
    right one. outside: (C,) or one number, the value beside the picture.

    >>> ramp = np.array([[[0.0], [1.0]]])
    >>> one = footprint(np.zeros((1, 2)), np.zeros((1, 2)), 1)
    >>> filtered([ramp], np.array([[0.5, 0.5]]), one).tolist()
    [[0.5]]
    """
    count = share.shape[0]
    channels = levels[0].shape[-1]
    beside = np.broadcast_to(np.asarray(outside, dtype=np.float64), (channels,))
    size = np.array([levels[0].shape[1], levels[0].shape[0]], dtype=np.float64)
    along = seen.axis * seen.length[:, None] / size
    lower = np.floor(seen.level).astype(np.int64)
    upper_weight = seen.level - lower
    total = np.zeros((count, channels))
    for k in range(MOST_PROBES):
        at = np.nonzero(seen.probes > k)[0]
        if len(at) == 0:
            break
        offset = (k + 0.5) / seen.probes[at] - 0.5
        place = share[at] + along[at] * offset[:, None]
        for step in (0, 1):
            level = np.minimum(lower[at] + step, len(levels) - 1)
            weight = upper_weight[at] if step else 1.0 - upper_weight[at]
            for number in np.unique(level[weight > 0.0]):
                some = (level == number) & (weight > 0.0)
                read = _bilinear(levels[number], place[some], repeats, beside)
                total[at[some]] += weight[some, None] * read
    return np.asarray(total / seen.probes[:, None])


def _bilinear(picture: AnyArray, share: Array, repeats: bool, beside: Array) -> Array:
    """(N, C) at places of a picture, 0 to 1 from its left and its top."""
    height, width = picture.shape[:2]
    # Far beside the picture every place reads the same; numbers beyond integers don't get there.
    column = np.clip(share[:, 0], -1e6, 1e6) * width - 0.5
    row = np.clip(share[:, 1], -1e6, 1e6) * height - 0.5
    left, top = np.floor(column).astype(np.int64), np.floor(row).astype(np.int64)
    across, down = column - left, row - top
    total = np.zeros((len(share), picture.shape[2]))
    for y in (0, 1):
        for x in (0, 1):
            weight = (across if x else 1.0 - across) * (down if y else 1.0 - down)
            total += weight[:, None] * _tap(picture, left + x, top + y, repeats, beside)
    return total


def _tap(picture: AnyArray, column: Ints, row: Ints, repeats: bool, beside: Array) -> Array:
    height, width = picture.shape[:2]
    inside: Mask = (row >= 0) & (row < height)
    if repeats:
        column = column % width
    else:
        inside = inside & (column >= 0) & (column < width)
    held = np.where(inside, row, 0), np.where(inside, column, 0)
    return np.where(inside[:, None], picture[held].astype(np.float64), beside)
