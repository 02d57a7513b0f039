"""Least squares within bounds, for a few unknowns and thousands of cheap residuals.

Levenberg 1944, Marquardt 1963: steps of the damped normal equations, unknowns at a bound held while
the slope pushes them outwards. The normal equations have ten rows or so, so nothing here starts
threads, which cost more than they save beside other work.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.interruptions import checkpoint

MOST_STEPS = 50
MOST_TRIES = 8  #: of the damping of a step
STEP = 2e-4  #: for slopes, in units of an unknown's size
LEAST_SIZE = 0.05  #: of an unknown
ENOUGH = 1e-4  #: share of the sum of squares; two steps that take less end the search
DAMPING, EASED, RAISED = 1e-2, 0.2, 4.0


def least_squares(
    residuals: Callable[[Array], Array], start: Array, low: Array, high: Array
) -> Array:
    """The unknowns (N,) within low and high whose residuals have the least sum of squares nearby.

    residuals: (R,) of unknowns (N,). start, low, high: (N,).

    >>> least_squares(lambda x: x - 3.0, np.array([0.5]), np.array([0.0]), np.array([2.0])).tolist()
    [2.0]
    """
    size = np.maximum(np.abs(start), LEAST_SIZE)
    x = np.clip(start, low, high)
    at = residuals(x)
    cost, damping = float(np.sum(at * at)), DAMPING
    idle = 0
    for _ in range(MOST_STEPS):
        slopes = _slopes(residuals, x, at, size, high)
        gradient = np.einsum("rn,r->n", slopes, at)
        curvature = np.einsum("rn,rm->nm", slopes, slopes)
        free = ~(((x <= low) & (gradient > 0.0)) | ((x >= high) & (gradient < 0.0)))
        if not np.any(free):
            break
        before = cost
        for _ in range(MOST_TRIES):
            checkpoint()
            room = ((low - x) / size, (high - x) / size)
            move = _move(curvature, gradient, free, damping, room)
            trial = np.clip(x + size * move, low, high)
            there = residuals(trial)
            square = float(np.sum(there * there))
            if square < cost:
                x, at, cost, damping = trial, there, square, max(damping * EASED, 1e-9)
                break
            damping *= RAISED
        idle = idle + 1 if before - cost <= ENOUGH * before else 0
        if idle > 1 or cost == before:
            break
    return np.asarray(x)


def _move(
    curvature: Array, gradient: Array, free: Mask, damping: float, room: tuple[Array, Array]
) -> Array:
    """The damped step of the free unknowns, in units of their sizes.

    room: how far each may go down and up. One that would go further goes as far, and the others are
    solved for again.
    """
    move, free = np.zeros(len(gradient)), free.copy()
    damped = curvature + np.diag(damping * np.diag(curvature))
    floor = 1e-12 + 1e-9 * float(np.max(np.diag(curvature)))
    damped += floor * np.eye(len(gradient))
    while np.any(free):
        own = damped[np.ix_(free, free)]
        pull = gradient[free] + damped[np.ix_(free, ~free)] @ move[~free]
        move[free] = np.linalg.solve(own, -pull)
        beyond = free & ((move < room[0]) | (move > room[1]))
        if not np.any(beyond):
            break
        move[beyond] = np.clip(move[beyond], room[0][beyond], room[1][beyond])
        free &= ~beyond
    return move


def _slopes(
    residuals: Callable[[Array], Array], x: Array, at: Array, size: Array, high: Array
) -> Array:
    """(R, N), slopes in units of the unknowns' sizes, by differences within the bounds."""
    columns = []
    for k in range(len(x)):
        checkpoint()
        step = STEP if x[k] + STEP * size[k] <= high[k] else -STEP
        moved = x.copy()
        moved[k] += step * size[k]
        columns.append((residuals(moved) - at) / step)
    return np.stack(columns, axis=-1)
