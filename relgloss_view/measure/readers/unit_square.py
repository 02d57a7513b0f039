"""Bilinear functions and densities on the unit square, in slices along a parameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array, Ints

#: Lower slice, upper slice and weight of the upper one, each (M,).
Slices = tuple[Ints, Ints, Array]


def find_slices(nodes: Array, theta: Array) -> Slices:
    """Between which tabulated incidences each theta lies; clamped at the ends."""
    last = len(nodes) - 1
    low = np.clip(np.searchsorted(nodes, theta, side="right") - 1, 0, max(last - 1, 0))
    high = np.minimum(low + 1, last)
    gap = np.where(high > low, nodes[high] - nodes[low], 1.0)
    return low, high, np.clip((theta - nodes[low]) / gap, 0.0, 1.0)


def _patch(points: Array, rows: int, columns: int) -> tuple[Any, Any, Array, Array]:
    """Row, column and fractions (x, y) of points (M, 2) = (x, y) in the unit square."""
    x = np.clip(points[:, 0], 0.0, 1.0) * (columns - 1)
    y = np.clip(points[:, 1], 0.0, 1.0) * (rows - 1)
    column = np.minimum(x.astype(np.int64), columns - 2)
    row = np.minimum(y.astype(np.int64), rows - 2)
    return row, column, x - column, y - row


def _pick(data: Array, slices: Slices | None, *index: Any) -> Array:
    """data[slice, ..., *index], linear between slices; (M,) or, for channels, (M, C)."""
    if slices is None:
        return np.asarray(data[index])
    low, high, weight = slices
    middle = (slice(None),) * (data.ndim - 1 - len(index))
    below, above = data[(low, *middle, *index)], data[(high, *middle, *index)]
    weight = weight.reshape(weight.shape + (1,) * (below.ndim - 1))
    return np.asarray(below + weight * (above - below))


def bilinear(data: Array, points: Array, slices: Slices | None = None) -> Array:
    """Interpolate (rows, columns), or slices of it, at points (M, 2) of the unit square."""
    row, column, x, y = _patch(points, *data.shape[-2:])
    v00, v01 = _pick(data, slices, row, column), _pick(data, slices, row, column + 1)
    v10, v11 = _pick(data, slices, row + 1, column), _pick(data, slices, row + 1, column + 1)
    if v00.ndim == 2:
        x, y = x[:, None], y[:, None]
    return np.asarray((1 - y) * ((1 - x) * v00 + x * v01) + y * ((1 - x) * v10 + x * v11))


@dataclass(frozen=True)
class Warp:
    """Bilinear densities on the unit square, and the map that makes them uniform."""

    density: Array  #: (T, rows, columns), of mean 1 over the patches of each slice
    conditional: Array  #: (T, rows, columns), cumulative along x
    marginal: Array  #: (T, rows), cumulative along y

    @classmethod
    def of(cls, density: Array) -> Warp:
        """Normalise the densities (T, rows, columns) and accumulate them."""
        along = 0.5 * (density[..., 1:] + density[..., :-1])
        conditional = np.concatenate(
            [np.zeros_like(density[..., :1]), np.cumsum(along, axis=-1)], axis=-1
        )
        ends = conditional[..., -1]
        down = np.cumsum(0.5 * (ends[:, 1:] + ends[:, :-1]), axis=1)
        marginal = np.concatenate([np.zeros_like(ends[:, :1]), down], axis=1)
        # A slice that is zero throughout (a damaged file) stays zero.
        total = np.where(marginal[:, -1:] > 0.0, marginal[:, -1:], 1.0)
        return cls(density / total[..., None], conditional / total[..., None], marginal / total)

    def invert(self, points: Array, slices: Slices) -> Array:
        """From points (M, 2) = (x, y) to the uniform square: the two cumulative functions there.

        Interpolation between slices acts on the densities, as in the authors' evaluation.
        """
        row, column, x, y = _patch(points, *self.density.shape[-2:])
        v00 = _pick(self.density, slices, row, column)
        v01 = _pick(self.density, slices, row, column + 1)
        v10 = _pick(self.density, slices, row + 1, column)
        v11 = _pick(self.density, slices, row + 1, column + 1)
        left, right = v00 + y * (v10 - v00), v01 + y * (v11 - v01)
        along = x * (left + 0.5 * x * (right - left))
        c0 = _pick(self.conditional, slices, row, column)
        c1 = _pick(self.conditional, slices, row + 1, column)
        last = np.full_like(row, self.conditional.shape[-1] - 1)
        end0 = _pick(self.conditional, slices, row, last)
        end1 = _pick(self.conditional, slices, row + 1, last)
        total = end0 + y * (end1 - end0)
        u = (along + c0 + y * (c1 - c0)) / np.where(total > 0.0, total, 1.0)
        v = y * (end0 + 0.5 * y * (end1 - end0)) + _pick(self.marginal, slices, row)
        return np.stack([u, v], axis=1)
