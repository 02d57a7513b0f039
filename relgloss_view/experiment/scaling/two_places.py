"""Whether the answers have two separate right places where the unfolding has one.

A second ideal place shares all else with the first: a setting is judged from the nearer one (the
several ideals of an observer in Coombs's 1964 unfolding). Observers are the independent units: the
second place counts where it makes the answers of the observers likelier by more than their
differences explain (the test of Vuong 1989 for models that may both be wrong), and where settings
between the places are clearly worse than both.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.experiment.design.coordinates import coordinates
from relgloss_view.experiment.scaling.bounded_minima import minima_within
from relgloss_view.experiment.scaling.unfolding import (
    Distance,
    Unfolding,
    UnfoldingLoss,
)

TRIED = 4  #: settings at which the search for the second place begins
APART_STEPS = 2.0  #: of the grid: places nearer than this are one
VALLEY = 0.7  #: noises that the worst setting between the places lies behind both, at least
LEAST_Z = 2.4  #: of the mean gain of an observer in standard errors: one-sided 0.8 %
LEAST_GAIN = 10.0  #: of the log-likelihood: the second place has two parameters
BETWEEN = 21  #: points on the line between two places


@dataclass(frozen=True)
class TwoPlaces:
    """Two right places: in steps of the grid, and how surely they are two."""

    first: tuple[float, float]
    second: tuple[float, float]
    z: float  #: of the gain of an observer's log-likelihood


def two_places(one: Unfolding, counts: Array) -> TwoPlaces | None:
    """Two places that explain counts (observers, settings, categories) where one does not.

    `one` is the fit of one place to all of them. None where one place is enough.
    """
    grid, pooled = one.grid, counts.sum(axis=0)
    present = np.flatnonzero(counts.sum(axis=(1, 2)) > 0.0)
    if len(present) < 2 or len(grid) < 3:
        return None
    single = UnfoldingLoss(grid, pooled)
    starts = _starts(one, pooled)
    if not len(starts):
        return None
    double = UnfoldingLoss(grid, np.broadcast_to(pooled, (len(starts), *pooled.shape)), places=2)
    ends, losses = minima_within(double, starts)
    end = ends[int(np.argmin(losses))]
    gain = _log_likelihoods(UnfoldingLoss(grid, pooled, places=2), end, counts[present])
    gain -= _log_likelihoods(single, one.parameters, counts[present])
    error = float(np.std(gain, ddof=1)) * np.sqrt(len(gain))
    total = float(np.sum(gain))
    z = total / max(error, 1e-9)
    first, second = end[:2], end[-2:]
    if total < LEAST_GAIN or z < LEAST_Z or not _separate(one, end):
        return None
    inside = [np.clip(place, 0.0, coordinates(grid)[-1]) for place in (first, second)]
    (x, y), (other_x, other_y) = (place.tolist() for place in inside)
    return TwoPlaces((x, y), (other_x, other_y), z)


def _starts(one: Unfolding, pooled: Array) -> Array:
    """Parameters with a second place at the settings where it helps most at once, (n, m)."""
    judged = np.flatnonzero(pooled.sum(axis=1) > 0.0)
    places = coordinates(one.grid)[judged]
    far = np.hypot(*(places - one.parameters[:2]).T) >= 1.0
    places = places[far]
    if not len(places):
        return np.zeros((0, 0))
    tried = np.hstack([np.tile(one.parameters, (len(places), 1)), places])
    loss = UnfoldingLoss(one.grid, np.broadcast_to(pooled, (len(tried), *pooled.shape)), places=2)
    values, _ = loss(tried)
    chosen = tried[np.argsort(values, kind="stable")[:TRIED]]
    # The first place may have settled between both: it begins where answers are closest too.
    mean = pooled[judged] @ np.arange(pooled.shape[1]) / pooled[judged].sum(axis=1)
    closest = coordinates(one.grid)[judged[int(np.argmin(mean))]]
    moved = chosen.copy()
    moved[:, :2] = closest
    return np.vstack([chosen, moved])


def _log_likelihoods(loss: UnfoldingLoss, parameters: Array, counts: Array) -> Array:
    """Of each observer's counts (O, settings, categories), (O,)."""
    return np.asarray(np.sum(counts * np.log(loss.shares(parameters)), axis=(1, 2)))


def _separate(one: Unfolding, end: Array) -> bool:
    """Whether two places are apart, with worse settings between them."""
    first, second = end[:2], end[-2:]
    if float(np.hypot(*(first - second))) < APART_STEPS:
        return False
    line = first + np.linspace(0.0, 1.0, BETWEEN)[:, None] * (second - first)
    along = Distance(line, coordinates(one.grid)[-1], places=2).at(end)
    return bool(np.max(along) - max(along[0], along[-1]) >= VALLEY)
