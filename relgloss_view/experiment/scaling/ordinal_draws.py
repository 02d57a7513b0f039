"""Ordinal probit scales of many resamplings of the observers, all at once.

Model, prior and signs are those of `ordinal.ordinal_scale`. The loss curves upward everywhere
(Pratt 1981), so that Newton's method with shortened steps reaches its one minimum from any start.
An answer depends on one stimulus only: the stimuli are eliminated (Schur complement), and a step
solves as many equations as there are bounds and observers with a location of their own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.experiment.scaling.ordinal import (
    LEAST_GAP,
    RIDGE,
    CategoryShares,
    OrdinalScale,
    row_sums,
)
from relgloss_view.experiment.scaling.successive_categories import (
    counted_bounds,
    spread_bounds,
    used_categories,
)

LAST_STEP = 1e-6  #: dispersions; after so short a step of Newton's its square is left
MOST_STEPS = 100
MOST_HALVINGS = 40
DECREASE = 1e-4  #: of what a step promises, at least (Armijo 1966)
ROUNDING = 1e-12  #: of the loss; by less it does not tell one step from another
TO_ORDER = 0.9  #: share of the way to bounds out of order that a step may go


@dataclass(frozen=True)
class OrdinalDraws:
    """Scales of resamplings, as `OrdinalScale` has one; NaN where all answers are the same."""

    scale: Array  #: (B, J), mean 0 in each
    bounds: Array  #: (B, K-1)


def ordinal_draws(counts: Array, start: OrdinalScale, *, observer_effects: bool) -> OrdinalDraws:
    """The most likely scales of counts (B resamplings, O observers, J stimuli, K categories).

    With `observer_effects` each observer has a location of its own; without, they are pooled.
    `start` is the scale of the answers that were resampled, where the searches begin.
    """
    if not observer_effects:
        counts = counts.sum(axis=1, keepdims=True)
    number, _, stimuli, categories = counts.shape
    draws = OrdinalDraws(
        np.full((number, stimuli), np.nan), np.full((number, categories - 1), np.nan)
    )
    used = used_categories(counts.reshape(number, -1, categories))
    for pattern in np.unique(used, axis=0):
        if pattern.sum() < 2:
            continue
        alike = np.flatnonzero(np.all(used == pattern, axis=1))
        _place(draws, alike, counts[alike][..., pattern], pattern, start, observer_effects)
    return draws


def _place(
    draws: OrdinalDraws,
    rows: NDArray[np.intp],
    counts: Array,
    used: Mask,
    start: OrdinalScale,
    observer_effects: bool,
) -> None:
    """Scale some resamplings, all of which have answers in the same categories."""
    losses = _Losses(counts, located=observer_effects)
    counted = counted_bounds(used)
    at = _minimum(losses, _first(losses, counted, start))
    limits, locations, distances = losses.parts(at)
    # The likelihood fixes only differences; at the minimum the prior has made both means 0, but
    # for rounding.
    middle = np.mean(distances, axis=1, keepdims=True)
    bias = np.mean(locations, axis=1, keepdims=True) if observer_effects else 0.0
    placed = np.full((len(rows), len(counted)), np.nan)
    placed[:, counted] = limits - middle - bias
    draws.scale[rows] = middle - distances
    draws.bounds[rows] = spread_bounds(placed, np.broadcast_to(used, (len(rows), len(used))))


class _Losses:
    """Minus the log-likelihood and the log prior of counts (B, O, J, K), for each of B.

    Parameters are (B, n): category bounds, locations of observers if `located`, distances of
    stimuli.
    """

    def __init__(self, counts: Array, *, located: bool) -> None:
        self.counts, self.located = counts, located
        self.limits = counts.shape[-1] - 1
        self._kept = self.limits + (counts.shape[1] if located else 0)

    def of(self, rows: Mask) -> _Losses:
        """Those of some resamplings."""
        return self if rows.all() else _Losses(self.counts[rows], located=self.located)

    def parts(self, x: Array) -> tuple[Array, Array, Array]:
        """Bounds, locations and distances."""
        return x[:, : self.limits], x[:, self.limits : self._kept], x[:, self._kept :]

    def newton(self, x: Array) -> tuple[Array, Array, Array]:
        """At x: the losses (B,), their slopes (B, n), and Newton's steps (B, n)."""
        limits, locations, distances = self.parts(x)
        cells = distances[:, None, :]
        if self.located:
            cells = cells + locations[:, :, None]
        shares = CategoryShares(limits[:, None, None, :] - cells[..., None], "probit")
        effects = x[:, self.limits :]
        likelihood = np.einsum("bojk,bojk->b", self.counts, shares.log_p)
        losses = 0.5 * RIDGE * np.sum(effects * effects, axis=1) - likelihood
        by_u = shares.slopes(self.counts)
        by_cell = by_u.sum(axis=-1)
        slopes = np.concatenate(
            [
                by_u.sum(axis=(1, 2)),
                *([RIDGE * locations - by_cell.sum(axis=2)] if self.located else []),
                RIDGE * distances - by_cell.sum(axis=1),
            ],
            axis=1,
        )
        kept, across, eliminated = self._curvature(shares)
        scaled = across / eliminated[:, None, :]
        of_kept, of_stimuli = slopes[:, : self._kept], slopes[:, self._kept :]
        matrix = kept - scaled @ across.swapaxes(1, 2)
        right = of_kept - np.einsum("bnj,bj->bn", scaled, of_stimuli)
        step = -np.linalg.solve(matrix, right[..., None])[..., 0]
        rest = -of_stimuli / eliminated - np.einsum("bnj,bn->bj", scaled, step)
        return losses, slopes, np.concatenate([step, rest], axis=1)

    def _curvature(self, shares: CategoryShares) -> tuple[Array, Array, Array]:
        """Second derivatives: of bounds and locations, of those by distances, of distances.

        The last is diagonal and given as (B, J).
        """
        own, beside = shares.curvatures(self.counts)
        rows = row_sums(own, beside)
        of_cells = rows.sum(axis=-1)
        size, stimuli = len(rows), rows.shape[2]
        k = np.arange(self.limits)
        kept = np.zeros((size, self._kept, self._kept))
        kept[:, k, k] = own.sum(axis=(1, 2))
        kept[:, k[:-1], k[1:]] = kept[:, k[1:], k[:-1]] = beside.sum(axis=(1, 2))
        across = np.empty((size, self._kept, stimuli))
        across[:, k] = -rows.sum(axis=1).swapaxes(1, 2)
        if self.located:
            o = np.arange(self.limits, self._kept)
            kept[:, o, o] = of_cells.sum(axis=2) + RIDGE
            kept[:, o, : self.limits] = -rows.sum(axis=2)
            kept[:, : self.limits, o] = kept[:, o, : self.limits].swapaxes(1, 2)
            across[:, o] = of_cells
        return kept, across, of_cells.sum(axis=1) + RIDGE


def _first(losses: _Losses, counted: Mask, start: OrdinalScale) -> Array:
    """Where the searches begin: at `start`, or at bounds of pooled counts where it has others."""
    from scipy.special import ndtri

    share = np.cumsum(losses.counts.sum(axis=(1, 2)), axis=1)
    limits = ndtri(share[:, :-1] / share[:, -1:])
    of_start = start.bounds[counted]
    if np.all(np.isfinite(of_start)) and np.all(np.diff(of_start) > LEAST_GAP):
        limits = np.tile(of_start, (len(limits), 1))
    effects = -start.scale
    if losses.located:
        assert start.observers is not None
        effects = np.concatenate([start.observers, effects])
    return np.concatenate([limits, np.tile(effects, (len(limits), 1))], axis=1)


def _minimum(losses: _Losses, x: Array) -> Array:
    """Where each loss is least, (B, n)."""
    x = x.copy()
    open_ = np.arange(len(x))  # the searches that have not ended
    value, slope, step = losses.newton(x)
    for _ in range(MOST_STEPS):
        checkpoint()
        share = _share_in_order(x[open_, : losses.limits], step[:, : losses.limits])
        promise = np.sum(slope * step, axis=1)
        room = ROUNDING * np.abs(value)
        for _ in range(MOST_HALVINGS):
            ahead = x[open_] + share[:, None] * step
            after = losses.newton(ahead)
            falls = after[0] <= value + DECREASE * share * promise + room
            if np.all(falls):
                break
            share = np.where(falls, share, 0.5 * share)
        x[open_] = ahead
        goes_on = np.max(np.abs(step), axis=1) > LAST_STEP
        if not np.any(goes_on):
            break
        open_, losses = open_[goes_on], losses.of(goes_on)
        value, slope, step = (part[goes_on] for part in after)
    return x


def _share_in_order(limits: Array, step: Array) -> Array:
    """The largest shares of steps, up to 1, that keep bounds in order, (B,)."""
    gap, change = np.diff(limits, axis=1), np.diff(step, axis=1)
    closes = change < 0.0
    most = np.where(closes, TO_ORDER * (gap - LEAST_GAP) / np.where(closes, -change, 1.0), 1.0)
    return np.asarray(np.min(most, axis=1, initial=1.0))
