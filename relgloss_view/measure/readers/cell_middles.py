"""What a tensor tree has at the middles of its cells, whose means its leaves hold.

A mean is no value: on the flank of a highlight a cell may hold three times what its middle has. The
neighbours of a cell show how steep the light is there. Along each dimension the logarithm is taken
as a parabola through the means of three cells of one size, which a Gaussian's is, and what its mean
is above its middle is taken off. Where the logarithm is bent upwards, as at the foot of a
highlight, three cells do not show where within them the bend lies: the flatter side counts, and
what the parabola would have taken off more is the uncertainty.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.measure.readers.tensor_tree import Tree

#: A correction is as uncertain as this share of it: a parabola is fitted to means, not to values.
SHARE = 0.15
#: Gauss-Legendre nodes across a cell, from -1/2 to 1/2, and their weights.
_NODES, _WEIGHTS = (0.5 * part for part in np.polynomial.legendre.leggauss(8))
_LARGEST_LOG = 50.0
_LEAST = 1e-12  #: 1/sr; nothing reflects less
_LEAST_STEP = 0.25  #: between middles of cells, in sides of the cell


class Middles(NamedTuple):
    """Leaves at their middles, (M,) each."""

    values: Array
    correction: Array  #: ln of the mean over the value
    uncertainty: Array  #: of that logarithm


def middles_of(tree: Tree, leaves: Ints) -> Middles:
    """The values of a tree at the middles of leaves (M,)."""
    middle: Array = tree.middles(leaves)
    side: Array = np.ldexp(1.0, -tree.levels[leaves])
    own = np.log(np.maximum(tree.values[leaves], _LEAST))
    taken, most = np.zeros(len(leaves)), np.zeros(len(leaves))
    for d in range(tree.rank):
        step = side[:, None] * np.eye(tree.rank)[d]
        up, up_slope = _slope(tree, middle, step, side, own, d)
        down, down_slope = _slope(tree, middle, -step, side, own, d)
        # At the edge of the cube one side alone is there.
        up_slope, down_slope = (
            np.where(up > 0.0, up_slope, down_slope),
            np.where(down > 0.0, down_slope, up_slope),
        )
        far = np.maximum(up + down, _LEAST_STEP)
        bend = 2.0 * (up_slope - down_slope) / far
        slope = (down * up_slope + up * down_slope) / far
        flatter = np.where(
            up_slope * down_slope > 0.0,
            np.where(np.abs(up_slope) < np.abs(down_slope), up_slope, down_slope),
            0.0,
        )
        plain = _mean_over_middle(slope, bend)
        limited = np.where(bend > 0.0, _mean_over_middle(flatter, 0.0 * bend), plain)
        taken += limited
        most += np.abs(plain - limited)
    value = np.where(tree.values[leaves] > _LEAST, np.exp(own - taken), tree.values[leaves])
    return Middles(np.asarray(value), taken, most + SHARE * np.abs(taken))


def _slope(
    tree: Tree, middle: Array, step: Array, side: Array, own: Array, d: int
) -> tuple[Array, Array]:
    """Distance (M,), in sides, of the neighbours' middle along d, and the slope of ln to there.

    The distance is 0 where the neighbour lies beyond the edge.
    """
    corners = np.stack(np.meshgrid(*[(-0.25, 0.25)] * tree.rank, indexing="ij"), axis=-1)
    offsets = corners.reshape(-1, tree.rank)
    places = (middle + step)[:, None, :] + side[:, None, None] * offsets
    outside = np.any((middle + step < 0.0) | (middle + step > 1.0), axis=-1)
    turned = np.zeros(places.shape[:2], dtype=np.bool_)
    if tree.rank == 3:
        # Beyond incidence along the normal the lamp comes from the other side.
        turned = places[..., 0] > 0.5
        places = np.where(turned[..., None], 1.0 - places, places)
    leaves = tree.leaf_at(np.clip(places, 0.0, 1.0 - 1e-9).reshape(-1, tree.rank))
    value = tree.values[leaves].reshape(turned.shape).mean(axis=1)
    centre = tree.middles(leaves)[:, d].reshape(turned.shape)
    centre = np.where(turned, 1.0 - centre, centre).mean(axis=1)
    distance = np.abs(centre - middle[:, d]) / side
    distance = np.where(outside, 0.0, np.maximum(distance, _LEAST_STEP))
    rise = np.log(np.maximum(value, _LEAST)) - own
    sign = np.sign(np.sum(step, axis=-1))
    return distance, np.where(outside, 0.0, sign * rise / np.maximum(distance, _LEAST_STEP))


def _mean_over_middle(slope: Array, bend: Array) -> Array:
    """ln of the mean of exp(slope u + bend u^2 / 2) over a side, u from -1/2 to 1/2."""
    power = slope[:, None] * _NODES + 0.5 * bend[:, None] * _NODES**2
    return np.asarray(np.log(np.exp(np.clip(power, -_LARGEST_LOG, _LARGEST_LOG)) @ _WEIGHTS))
