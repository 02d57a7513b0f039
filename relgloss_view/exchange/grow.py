"""Growing a tensor tree from a material: cells are halved where the BRDF changes within them."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.measure.readers.shirley_chiu import directions
from relgloss_view.measure.readers.tensor_tree import DEEPEST, Tree

RANK = 3
CHILDREN = 2**RANK
FIRST_LEVEL = 4  #: the whole cube is cut so often before anything is looked at
#: A cell is halved where its values differ by more than these shares of their mean and of the
#: highest value at that incidence. A lobe is then cut in cells of about a third of its standard
#: deviation, which widens it by about 1 %.
OF_MEAN, OF_PEAK = 0.25, 0.06
#: Places in a cell, in each dimension, of its mean: Gauss-Legendre of two points.
GAUSS = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)
NEAREST = (0.1, 0.5, 0.9)  #: places of incidence in a cell at which the lobe is looked for
AT_ONCE = 1 << 16  #: cells that are looked at together

#: BRDF (M, C) in 1/sr of unit vectors to the lamp and to the eye.
Function = Callable[[Array, Array], Array]


class Grown(NamedTuple):
    """Levels (L,) and values (L, C) of the leaves, in Morton order."""

    levels: Ints
    values: Array

    def tree(self, channel: int) -> Tree:
        """The tree of a channel."""
        return Tree(RANK, self.levels, self.values[:, channel])


def grow(brdf: Function, deepest: int, most_leaves: int) -> Grown:
    """The tree of an isotropic BRDF with at most `most_leaves` leaves.

    The first channel decides what is halved. deepest: halvings of the smallest cell. The half of
    the cube that no direction has is 0. Where the leaves do not suffice, all is cut more coarsely.
    """
    coarser = 1.0
    while (grown := _grown(brdf, deepest, most_leaves, coarser)) is None:
        coarser *= 1.5
    return grown


def collapsed(levels: Ints, values: Array, weights: Array, within: float) -> tuple[Ints, Array]:
    """Leaves (L,) joined where the eight of a parent differ by at most `within`: their weighted
    mean. Levels and values are in Morton order; weights (L,) above 0.
    """
    levels, values, weights = levels.copy(), values.copy(), weights.copy()
    for level in range(int(levels.max()), 0, -1):
        spans = np.left_shift(1, RANK * (DEEPEST[RANK] - levels))
        starts = np.concatenate([[0], np.cumsum(spans)[:-1]])
        parent = RANK * (DEEPEST[RANK] - level + 1)
        first = np.flatnonzero((levels == level) & (starts & ((1 << parent) - 1) == 0))
        first = first[first + CHILDREN <= len(levels)]
        eight = first[:, None] + np.arange(CHILDREN)
        # Eight leaves of a level that begin where their parent does fill it.
        whole = np.all(levels[eight] == level, axis=1)
        whole &= np.ptp(values[eight], axis=1) <= within
        eight = eight[whole]
        mean = np.sum(values[eight] * weights[eight], axis=1) / np.sum(weights[eight], axis=1)
        values[eight[:, 0]], levels[eight[:, 0]] = mean, level - 1
        weights[eight[:, 0]] = np.mean(weights[eight], axis=1)
        kept = np.ones(len(levels), dtype=np.bool_)
        kept[eight[:, 1:].ravel()] = False
        levels, values, weights = levels[kept], values[kept], weights[kept]
    return levels, values


def _grown(brdf: Function, deepest: int, most_leaves: int, coarser: float) -> Grown | None:
    codes = np.arange(CHILDREN**FIRST_LEVEL)
    places = _corners(codes, FIRST_LEVEL)
    # Upper halves of the first dimension have no incidence.
    dead = places[:, 0] >= 0.5
    kept: list[tuple[Ints, int, Array | None]]
    kept = [(codes[dead] << (RANK * (DEEPEST[RANK] - FIRST_LEVEL)), FIRST_LEVEL, None)]
    codes = codes[~dead]
    level, count = FIRST_LEVEL, int(np.sum(dead))
    peaks = _peaks(brdf, deepest)
    while len(codes):
        means, coarse = _looked_at(brdf, codes, level, peaks * coarser)
        if level >= deepest:
            coarse = np.zeros(len(codes), dtype=np.bool_)
        if count + len(codes) + (CHILDREN - 1) * int(np.sum(coarse)) > most_leaves:
            return None
        fine = ~coarse
        kept.append((codes[fine] << (RANK * (DEEPEST[RANK] - level)), level, means[fine]))
        count += int(np.sum(fine))
        codes = (codes[coarse, None] * CHILDREN + np.arange(CHILDREN)).ravel()
        level += 1
    channels = next(values for _, _, values in kept if values is not None).shape[1]
    starts = np.concatenate([each for each, _, _ in kept])
    levels = np.concatenate([np.full(len(each), own) for each, own, _ in kept])
    values = np.concatenate(
        [np.zeros((len(each), channels)) if v is None else v for each, _, v in kept]
    )
    order = np.argsort(starts)
    return Grown(levels[order], values[order])


def _peaks(brdf: Function, deepest: int) -> Array:
    """The highest value near the mirror direction for each finest step of incidence, (2^d / 2,)."""
    side = 2 ** min(deepest, 11)
    sine = 1.0 - 2.0 * (np.arange(side // 2) + 0.5) / side
    cos = np.sqrt(1.0 - sine * sine)
    zero = np.zeros_like(sine)
    value = brdf(np.stack([-sine, zero, cos], axis=-1), np.stack([sine, zero, cos], axis=-1))
    return np.asarray(value[:, 0])


def _looked_at(brdf: Function, codes: Ints, level: int, peaks: Array) -> tuple[Array, Mask]:
    """Means (M, C) of cells, and which of them are too coarse."""
    each = [
        _part(brdf, codes[k : k + AT_ONCE], level, peaks) for k in range(0, len(codes), AT_ONCE)
    ]
    return np.concatenate([m for m, _ in each]), np.concatenate([c for _, c in each])


def _part(brdf: Function, codes: Ints, level: int, peaks: Array) -> tuple[Array, Mask]:
    corners, side = _corners(codes, level), 0.5**level
    offsets = np.stack(np.meshgrid(*[GAUSS] * RANK, indexing="ij"), axis=-1).reshape(-1, RANK)
    places = (corners[:, None, :] + side * offsets).reshape(-1, RANK)
    values = brdf(*directions(places)).reshape(len(codes), len(offsets), -1)
    means = values.mean(axis=1)
    # Two Gauss points span 1 / sqrt(3) of a side.
    swing = np.sqrt(3.0) * np.ptp(values[..., 0], axis=1)
    # A narrow lobe may lie between them, but not beside the place nearest to the mirror direction.
    for part in NEAREST:
        incidence = corners[:, 0] + part * side
        square = np.stack([1.0 - incidence, np.full_like(incidence, 0.5)], axis=-1)
        nearest = np.clip(square, corners[:, 1:], corners[:, 1:] + side)
        nearest = np.concatenate([incidence[:, None], nearest], axis=1)
        value = brdf(*directions(np.clip(nearest, 0.0, 1.0)))[:, 0]
        swing = np.maximum(swing, np.abs(value - means[:, 0]))
    incidence = ((corners[:, 0] + 0.5 * side) * 2 * len(peaks)).astype(np.intp)
    peak = peaks[np.clip(incidence, 0, len(peaks) - 1)]
    return means, (swing > OF_MEAN * means[:, 0]) & (swing > OF_PEAK * peak)


def _corners(codes: Ints, level: int) -> Array:
    """(M, 3), the lower corners of cells of Morton codes at a level."""
    corners = np.zeros((len(codes), RANK))
    for d in range(RANK):
        for bit in range(level):
            corners[:, d] += ((codes >> (RANK * bit + d)) & 1) * 2.0 ** (bit - level)
    return corners
