"""Whether a sample's observers fall into two groups that answer differently.

What an observer's answers have in common with nobody's is the deviation from the mean answer to
each setting. Along the direction in which observers deviate most from each other, one population
has one hump: personal truths and personal categories differ without gaps. Two groups leave a gap.
The largest ratio of the sum of squares between two groups to that of all is the likelihood ratio
test of two normal populations against one (Engelman and Hartigan 1969). Its law under one
population is simulated, as McLachlan (1987) does for mixtures: from normal places of the observers
along the direction, and from normal answers in which nothing but chance makes the direction. The
larger p counts.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.experiment.design.coordinates import from_steps
from relgloss_view.experiment.scaling.fine_grid import POINT_LIKE, FineGrid
from relgloss_view.experiment.scaling.unfolding import (
    closeness_at,
    fit_unfolding,
    unfolding_draws,
)
from relgloss_view.experiment.session.pool import Answers

FEWEST_TO_SPLIT = 6  #: observers
LEAST_GROUP = 0.2  #: share of the observers: one or two strange ones are no group
SAMPLES, TOGETHER = 2000, 200  #: of one population; that are made at once
LEVEL = 0.02  #: of the test; groups that agree on a setting are passed over besides
DRAWS = 100  #: of each group's observers


@dataclass(frozen=True)
class Groups:
    """The most different two groups of observers of a pool, and how likely chance makes them."""

    first: tuple[int, ...]  #: observers of the pool, ascending; holds the first of all
    second: tuple[int, ...]
    p: float  #: of so wide a gap where all are of one population


def most_different(answers: Answers) -> Groups | None:
    """The groups; None with few observers, or where their answers do not differ."""
    ratings = answers.ratings()
    present = np.flatnonzero(np.any(np.isfinite(ratings), axis=1))
    number = len(present)
    if number < FEWEST_TO_SPLIT:
        return None
    table = ratings[present]
    table = table[:, np.all(np.isfinite(table), axis=0)]
    if table.shape[1] < 2:
        return None
    if np.all(np.ptp(table, axis=0) < 1e-9):
        return None
    (scores,) = _scores(table[None])
    ((ratio,), (cut,)) = _best_split(scores[None])
    order = np.argsort(scores, kind="stable")
    low, high = (tuple(sorted(present[part].tolist())) for part in (order[:cut], order[cut:]))
    first, second = (low, high) if low[0] < high[0] else (high, low)
    nulls = _of_places(number), _of_answers(number, table.shape[1])
    p = max((1.0 + np.sum(null >= ratio - 1e-12)) / (1.0 + len(null)) for null in nulls)
    return Groups(first, second, float(p))


def _scores(tables: Array) -> Array:
    """Where observers lie along the direction in which they deviate most, (B, O).

    Tables are (B, O, settings). Each observer's answers count relative to their own mean and
    spread, as categories are personal.
    """
    apart = tables - tables.mean(axis=-1, keepdims=True)
    size = np.sqrt(np.mean(apart**2, axis=-1, keepdims=True))
    apart = apart / np.where(size > 0.0, size, 1.0)
    apart = apart - apart.mean(axis=-2, keepdims=True)
    return np.asarray(np.linalg.svd(apart, full_matrices=False)[0][..., 0])


def _best_split(scores: Array) -> tuple[Array, Array]:
    """Of samples (B, n): the largest share of the sum of squares between two groups, (B,).

    And how many of the lowest scores the first group has, (B,).
    """
    ordered = np.sort(scores - scores.mean(axis=1, keepdims=True), axis=1)
    n = ordered.shape[1]
    least = max(2, int(np.ceil(LEAST_GROUP * n)))
    cuts = np.arange(least, n - least + 1)
    low = np.cumsum(ordered, axis=1)[:, cuts - 1]
    between = low**2 * (1.0 / cuts + 1.0 / (n - cuts)) / np.sum(ordered**2, axis=1, keepdims=True)
    best = np.argmax(between, axis=1)
    return between[np.arange(len(scores)), best], cuts[best]


@functools.cache
def _of_places(number: int) -> Array:
    """Ratios of so many normal places, (SAMPLES,)."""
    random = np.random.default_rng(number)
    return _best_split(random.standard_normal((SAMPLES, number)))[0]


@functools.cache
def _of_answers(number: int, settings: int) -> Array:
    """Ratios of so many observers with normal answers to settings, (SAMPLES,)."""
    random = np.random.default_rng([number, settings])
    ratios = []
    for _ in range(SAMPLES // TOGETHER):
        checkpoint()
        tables = random.standard_normal((TOGETHER, number, settings))
        ratios.append(_best_split(_scores(tables))[0])
    return np.concatenate(ratios)


@dataclass(frozen=True)
class Camp:
    """One of two groups, and what it alone finds right."""

    observers: tuple[int, ...]  #: of the pool
    sigma_n_deg: float  #: where its fit is closest
    c_fraction: float
    kind: str  #: of what it finds as good: "point", "ridge" or "broad"


@dataclass(frozen=True)
class MixedGroups:
    """Two groups of observers who do not agree on what is right."""

    p: float  #: as in Groups
    camps: tuple[Camp, Camp]


def mixed_groups(fine: FineGrid, answers: Answers, seed: int) -> MixedGroups | None:
    """Two groups that answer differently and agree on no one setting; None where there are none.

    Groups that use the categories differently but find the same place right are none. Each is
    fitted by itself, its observers drawn again DRAWS times: they disagree where either has a curve
    or much of the grid as good as its best, or where nothing is as good for both.
    """
    found = most_different(answers)
    if found is None or found.p > LEVEL:
        return None
    counts = answers.counts()
    random = np.random.default_rng(seed)
    camps, regions = [], []
    for members in (found.first, found.second):
        own = counts[list(members)]
        fit = fit_unfolding(fine.grid, own.sum(axis=0))
        number = len(members)
        weights = random.multinomial(number, np.full(number, 1.0 / number), size=DRAWS)
        drawn = unfolding_draws(fine.grid, np.einsum("bo,ojk->bjk", weights, own), fit)
        closeness = fit.closeness(fine.points)
        surfaces = closeness_at(fine.grid, drawn, fine.points)
        shape, region = fine.region_of_best(closeness, surfaces)
        ((sigma_n, c),) = from_steps(fine.grid, fine.points[[int(np.argmax(closeness))]])
        camps.append(Camp(members, float(sigma_n), float(c), shape.kind))
        regions.append(region)
    alike = all(camp.kind == POINT_LIKE for camp in camps) and bool(np.any(regions[0] & regions[1]))
    return None if alike else MixedGroups(found.p, (camps[0], camps[1]))
