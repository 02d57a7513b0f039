"""The global search over lobe widths, so that a fit needs no start value from its user."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.fitting.descent import AT_ONCE, refine
from relgloss_view.fitting.model import (
    LOG_S_RANGE,
    Rung,
    Solution,
    State,
    States,
)
from relgloss_view.fitting.observations import Observations
from relgloss_view.fitting.problem import Problem

ONE_LOBE_STEPS = 24
TWO_LOBE_STEPS = 11
REFINED = 3
FIRST_T = 0.01  #: sigma = 0.1 rad, a coated paper's
_SCAN_ROUNDS = 3


def widths(steps: int, start_s_deg: float | None = None) -> Array:
    """ln s (radians) of a scan over the whole range, geometric, through start_s_deg if given."""
    low, high = LOG_S_RANGE
    pitch = (high - low) / (steps - 1)
    if start_s_deg is None:
        return np.linspace(low, high, steps)
    anchor = float(np.clip(np.log(np.radians(start_s_deg)), low, high))
    below = int((anchor - low) / pitch)
    grid = anchor + pitch * np.arange(-below, steps)
    return np.asarray(grid[grid <= high + 1e-12])


def solve(
    observations: Observations,
    rung: Rung,
    n: float,
    *,
    start_s_deg: float | None = None,
    warm: tuple[State, ...] = (),
) -> Solution:
    """The best optimum of a rung: scan the widths, refine the best few and the warm starts.

    n: refractive index of all lobes. start_s_deg: anchors the scan.
    """
    problem = Problem(observations, rung)
    if rung.lobes == 0:
        roughness = np.array((FIRST_T, 0.15) if rung.rough else (0.0,))
        starts, _ = _linear_guess(problem, roughness, np.empty((len(roughness), 0)), n)
        best = [starts[k] for k in range(len(starts))]
    else:
        steps = ONE_LOBE_STEPS if rung.lobes == 1 else TWO_LOBE_STEPS
        grid = widths(steps, start_s_deg)
        log_s = np.array(list(combinations(grid, rung.lobes)))
        starts, errors = _linear_guess(problem, np.full(len(log_s), FIRST_T), log_s, n)
        best = lowest_of_valleys(starts, errors, pitch=1.1 * (grid[1] - grid[0]))
    return min(refine(problem, [*best, *warm]), key=lambda s: s.loss)


def lowest_of_valleys(states: States, errors: Array, pitch: float) -> list[State]:
    """The REFINED states of the lowest errors (P,) that differ by more than `pitch` in some ln s.

    Starts beside one another lead to the same optimum.
    """
    best: list[State] = []
    for k in np.argsort(errors, kind="stable").tolist():
        state = states[k]
        if all(np.max(np.abs(state.log_s - other.log_s)) > pitch for other in best):
            best.append(state)
        if len(best) == REFINED:
            break
    return best


def _linear_guess(problem: Problem, t: Array, log_s: Array, n: float) -> tuple[States, Array]:
    """The linear unknowns at P sets of nonlinear ones, and the mean errors (P,); a few at once."""
    index = np.full(log_s.shape, n)
    size = max(AT_ONCE // max(problem.samples, 1), 1)
    parts = []
    for first in range(0, len(t), size):
        some = slice(first, first + size)
        columns = problem.columns(t[some], log_s[some], index[some])
        kd, ks = problem.first_guess(columns, _SCAN_ROUNDS)
        parts.append((kd, ks, problem.mean_errors(problem.model(columns, kd, ks))))
    kd, ks, errors = (np.concatenate(part) for part in zip(*parts, strict=True))
    return States(t, log_s, index, kd, ks, np.zeros((len(t), 0))), errors
