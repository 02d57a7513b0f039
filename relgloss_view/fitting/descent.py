"""Damped Gauss-Newton descents of a problem, with the unknowns of each band eliminated."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.fitting.model import Solution, State, States
from relgloss_view.fitting.problem import Equations, Misfit, Problem
from relgloss_view.fitting.unknowns import SharedUnknowns

AT_ONCE = 1 << 18  #: columns of 2 MB each
TRIALS = 6  #: of one step, each damped ten times more, before a descent ends
TOLERANCE = 1e-5  #: a descent ends when t, ln s and n together move by less


def refine(
    problem: Problem,
    starts: Sequence[State],
    rounds: int = 30,
    tolerance: float = TOLERANCE,
) -> list[Solution]:
    """Descend from each start to the nearest optimum, in at most `rounds` steps; a few at once."""
    size = max(AT_ONCE // max(problem.samples, 1), 1)
    solutions: list[Solution] = []
    for first in range(0, len(starts), size):
        some = np.zeros(len(starts), dtype=bool)
        some[first : first + size] = True
        part = problem if len(starts) <= size else problem.part(some)
        solutions += _refine(part, starts[first : first + size], rounds, tolerance)
    return solutions


def _refine(
    problem: Problem, starts: Sequence[State], rounds: int, tolerance: float
) -> list[Solution]:
    """All descents side by side."""
    states = States.of(starts)
    columns = problem.columns_of(states)
    states, misfit = problem.reweighted(columns, states)
    place = np.arange(len(states))
    damping = np.full(len(states), 1e-4)
    steps, trials = np.zeros(len(states), dtype=int), np.zeros(len(states), dtype=int)
    solutions: dict[int, Solution] = {}
    while len(place):
        checkpoint()
        equations = problem.equations(columns, misfit, states)
        trial = gauss_newton_step(problem.unknowns, states, equations, damping)
        trial_columns = problem.columns_of(trial)
        trial, trial_misfit = problem.reweighted(trial_columns, trial)
        accepted = trial_misfit.loss <= misfit.loss
        moved = np.abs(trial.t - states.t) + np.sum(np.abs(trial.log_s - states.log_s), axis=1)
        moved = moved + np.sum(np.abs(trial.n - states.n), axis=1)
        moved = moved + np.sum(np.abs(trial.errors - states.errors), axis=1)
        gained = misfit.loss - trial_misfit.loss
        small = (moved < tolerance) | (gained < 1e-3 * tolerance * trial_misfit.loss)
        converged = np.where(accepted, small, trials == TRIALS - 1)
        steps, trials = steps + accepted, np.where(accepted, 0, trials + 1)
        less, more = np.maximum(damping * 0.1, 1e-9), np.maximum(damping * 10.0, 1e-3)
        damping = np.where(accepted, less, more)
        if np.all(accepted):
            states, columns, misfit = trial, trial_columns, trial_misfit
        elif np.any(accepted):
            states = states.updated(accepted, trial)
            columns[accepted] = trial_columns[accepted]
            for part, new in zip(misfit, trial_misfit, strict=True):
                part[accepted] = new[accepted]
        done = converged | (steps == rounds)
        if not np.any(done):
            continue
        for k in np.flatnonzero(done).tolist():
            loss = float(misfit.loss[k])
            solutions[int(place[k])] = Solution(states[k], loss, bool(converged[k]))
        rest = ~done
        problem, states, columns = problem.part(rest), states.subset(rest), columns[rest]
        misfit = Misfit(*(part[rest] for part in misfit))
        place, damping, steps, trials = place[rest], damping[rest], steps[rest], trials[rest]
    return [solutions[k] for k in range(len(solutions))]


def gauss_newton_step(
    unknowns: SharedUnknowns, states: States, equations: Equations, damping: Array
) -> States:
    """One step within the bounds, with Levenberg and Marquardt's damping (P,) of the diagonal.

    The own unknowns of each band are eliminated first. An own unknown that is zero and would become
    negative is held, as is a shared one at a bound.
    """
    problems, bands, k = equations.own_gradient.shape
    current = np.concatenate([states.kd[:, None], states.ks[:, : k - 1]], axis=1)
    current = np.swapaxes(current, 1, 2)
    keep = ~((current <= 0.0) & (equations.own_gradient > 0.0))
    a = equations.own * (keep[..., None] & keep[..., None, :])
    diagonal = np.einsum("pbkk->pbk", a)  # a view that can be written to
    diagonal += damping[:, None, None] * diagonal + np.where(diagonal > 0.0, 0.0, 1.0)
    value = unknowns.values(states)
    shared_gradient = equations.shared_gradient
    curvature = np.einsum("pss->ps", equations.shared)
    free = ~((value <= unknowns.low) & (shared_gradient > 0.0))
    free &= ~((value >= unknowns.high) & (shared_gradient < 0.0))
    free &= curvature > 0.0
    b = equations.cross * (keep[..., None] & free[:, None, None])
    right = -equations.own_gradient * keep
    both = np.concatenate([b, right[..., None]], axis=3)
    solved = both / a if k == 1 else np.linalg.solve(a, both)
    step = np.zeros_like(value)
    if np.any(free):
        across = np.swapaxes(b.reshape(problems, bands * k, -1), 1, 2)
        reduced = across @ solved.reshape(problems, bands * k, -1)
        size = np.sqrt(np.where(free, curvature, 1.0))
        schur = equations.shared - reduced[:, :, :-1]
        schur = schur / (size[:, :, None] * size[:, None])
        schur = np.where(free[:, :, None] & free[:, None], schur, 0.0)
        # Unknowns that are not free get the identity; the damping is relative to the diagonal.
        np.einsum("pss->ps", schur)[...] += np.where(free, damping[:, None] + 1e-12, 1.0)
        aim = np.where(free, (-shared_gradient - reduced[:, :, -1]) / size, 0.0)
        step = np.linalg.solve(schur, aim[..., None])[..., 0] / size
    step = np.clip(step, -unknowns.limit, unknowns.limit)
    own = solved[..., -1] - (solved[..., :-1] @ step[:, None, :, None])[..., 0]
    current = np.maximum(current + own, 0.0)
    value = np.clip(value + step, unknowns.low, unknowns.high)
    own_ks = np.swapaxes(current[:, :, 1:], 1, 2)
    return unknowns.replaced(states, value, current[:, :, 0], own_ks)
