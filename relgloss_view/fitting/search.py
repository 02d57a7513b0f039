"""The global search over lobe widths: no start value is asked of the user."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from relgloss_view.fitting.model import LOG_S_RANGE, Rung, Solution, State, mean_error
from relgloss_view.fitting.samples import Samples
from relgloss_view.fitting.shapes import Geometry
from relgloss_view.fitting.solver import Problem

Array = NDArray[np.float64]

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
    g: Geometry,
    samples: Samples,
    rung: Rung,
    n: float,
    *,
    start_s_deg: float | None = None,
    warm: tuple[State, ...] = (),
) -> Solution:
    """The best optimum of a rung: scan the widths, refine the best few and the warm starts."""
    problem = Problem(g, samples, rung)
    if rung.lobes == 0:
        roughness = (FIRST_T, 0.15) if rung.rough else (0.0,)
        best = [_begin(problem, t, np.empty(0), n)[1] for t in roughness]
    else:
        steps = ONE_LOBE_STEPS if rung.lobes == 1 else TWO_LOBE_STEPS
        grid = widths(steps, start_s_deg)
        starts = [
            _begin(problem, FIRST_T, np.array(chosen), n)
            for chosen in combinations(grid, rung.lobes)
        ]
        # Starts beside one another lead to the same optimum: take each valley's best.
        pitch = 1.1 * (grid[1] - grid[0])
        best = []
        for _, state in sorted(starts, key=lambda item: item[0]):
            if all(np.max(np.abs(state.log_s - other.log_s)) > pitch for other in best):
                best.append(state)
            if len(best) == REFINED:
                break
    solutions = [problem.refine(state) for state in (*best, *warm)]
    return min(solutions, key=lambda s: s.loss)


def _begin(problem: Problem, t: float, log_s: Array, n: float) -> tuple[float, State]:
    index = np.full(len(log_s), n)
    columns, _ = problem.columns(t, log_s, index)
    kd, ks = problem.first_guess(columns, _SCAN_ROUNDS)
    loss = mean_error(problem.samples, problem.model(columns, kd, ks))
    return loss, State(t, log_s, index, kd, ks)
