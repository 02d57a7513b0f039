"""Minima of many similar losses at once, with parameters between limits.

A quasi-Newton search for each, all of them in step: the curvature begins as the expected one
(Fisher's scoring) and is then updated by the slopes along each step (Broyden, Fletcher, Goldfarb
and Shanno 1970), damped as Powell does (1978). Every few steps it is the expected one again: where
a loss has kinks in its slopes, updates grow without end.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.interruptions import checkpoint

PRECISION = 1e-6  #: of the loss, where a search ends: a standard error changes it by a half
MOST_STEPS = 100
MOST_HALVINGS = 30
DECREASE = 1e-4  #: of what a step promises, at least (Armijo 1966)
ROUNDING = 1e-12  #: of the loss: smaller differences are rounding
SCORED_EVERY = 8  #: steps
SOLVABLE = 1e-10  #: added to the diagonal of a curvature, of it
SWEEPS = 3  #: over the parameters of a step that has reached a limit
#: Of the curvature that the search expects along a step: one that is less is raised to it.
LEAST_UPDATE = 0.2
LEAST_CURVATURE = 0.3  #: that of the widest prior; directions that the answers leave open get it


class Losses(Protocol):
    """B losses of parameters (B, n)."""

    @property
    def limits(self) -> list[tuple[float, float]]:
        """The least and the largest value of each parameter, the same for all losses."""

    def __call__(self, p: Array, /) -> tuple[Array, Array]:
        """Values (B,) and slopes (B, n)."""

    def scoring(self, p: Array, /) -> tuple[Array, Array, Array]:
        """Values, slopes, and expected second derivatives (B, n, n)."""

    def of(self, rows: Mask, /) -> Losses:
        """Some of the losses."""


def minima_within(losses: Losses, first: Array) -> tuple[Array, Array]:
    """The parameters (B, n) that searches from `first` end at, and their losses (B,)."""
    low, high = np.array(losses.limits).T
    p = np.clip(first, low, high)
    values, slope, curvature = losses.scoring(p)
    curvature = _floored(curvature)
    searched = np.arange(len(p))  # the searches that have not ended
    for number in range(1, MOST_STEPS + 1):
        checkpoint()
        here, value = p[searched], values[searched]
        step = steps_within(slope, curvature, low - here, high - here)
        promise = -np.sum(slope * step, axis=1)
        share = np.ones(len(searched))
        for _ in range(MOST_HALVINGS):
            ahead = np.clip(here + share[:, None] * step, low, high)
            value_ahead, slope_ahead = losses(ahead)
            least = DECREASE * share * promise - ROUNDING * np.abs(value)
            falls = value_ahead <= value - least
            if np.all(falls):
                break
            share = np.where(falls, share, 0.5 * share)
        p[searched], values[searched] = ahead, value_ahead
        more = promise > PRECISION
        if not np.any(more):
            break
        step, change = ahead - here, slope_ahead - slope
        searched, losses, slope = searched[more], losses.of(more), slope_ahead[more]
        if number % SCORED_EVERY:
            curvature = _updated(curvature[more], step[more], change[more])
        else:
            curvature = _floored(losses.scoring(p[searched])[2])
    return p, values


def _floored(curvature: Array) -> Array:
    """Curvatures (B, n, n) with no direction in which they are less than the least one."""
    curvatures, directions = np.linalg.eigh(curvature)
    scaled = directions * np.maximum(curvatures, LEAST_CURVATURE)[:, None, :]
    return np.asarray(scaled @ directions.swapaxes(1, 2))


def steps_within(slope: Array, curvature: Array, low: Array, high: Array) -> Array:
    """Steps (B, n) that lower slope @ step + step @ curvature @ step / 2 the most between limits.

    Limits (B, n) hold zero. A parameter beyond its limit is put there and the others are solved
    again; sweeps over single parameters then move back what should not have been put there. Where
    a limit is reached the step may be a little less than the best one.
    """
    held = ((low >= 0.0) & (slope >= 0.0)) | ((high <= 0.0) & (slope <= 0.0))
    step = np.zeros(slope.shape)
    k = np.arange(slope.shape[1])
    for _ in k:
        free = np.where(held[:, :, None] | held[:, None, :], 0.0, curvature)
        free[:, k, k] += held + SOLVABLE * np.abs(free[:, k, k])
        right = -slope - (curvature @ np.where(held, step, 0.0)[..., None])[..., 0]
        solved = np.linalg.solve(free, np.where(held, 0.0, right)[..., None])[..., 0]
        step = np.where(held, step, solved)
        beyond = (step < low) | (step > high)
        if not np.any(beyond):
            break
        step = np.clip(step, low, high)
        held = held | beyond
    change = np.sum(step * (slope + 0.5 * (curvature @ step[..., None])[..., 0]), axis=1)
    step[change >= 0.0] = 0.0
    limited = np.any(held, axis=1)
    if np.any(limited):
        parts = (step, slope, curvature, low, high)
        step[limited] = _swept(*(part[limited] for part in parts))
    return step


def _swept(step: Array, slope: Array, curvature: Array, low: Array, high: Array) -> Array:
    """Steps after each parameter in turn took its best value between its limits."""
    step = step.copy()
    for k in [*range(step.shape[1])] * SWEEPS:
        tilt = slope[:, k] + np.sum(curvature[:, k] * step, axis=1)
        step[:, k] = np.clip(step[:, k] - tilt / curvature[:, k, k], low[:, k], high[:, k])
    return step


def _updated(curvature: Array, step: Array, change: Array) -> Array:
    """Curvatures (B, n, n) by the change (B, n) of slopes along steps (B, n)."""
    expected = (curvature @ step[..., None])[..., 0]
    along = np.sum(step * expected, axis=1)
    measured = np.sum(step * change, axis=1)
    raised = measured < LEAST_UPDATE * along
    gap = np.where(raised, along - measured, 1.0)
    blend = np.where(raised, (1.0 - LEAST_UPDATE) * along / gap, 1.0)[:, None]
    change = blend * change + (1.0 - blend) * expected
    measured = np.sum(step * change, axis=1)
    moved = (along > 0.0) & (measured > 0.0)
    gained = change[:, :, None] * change[:, None, :] / np.where(moved, measured, 1.0)[:, None, None]
    lost = expected[:, :, None] * expected[:, None, :] / np.where(moved, along, 1.0)[:, None, None]
    return curvature + np.where(moved[:, None, None], gained - lost, 0.0)
