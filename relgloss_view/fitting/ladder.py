"""The ladder of models and the choice of the smallest that is enough.

Each rung is cross-validated by leaving out whole groups (incidence planes). A rung is enough when
it is no worse than the best by more than one standard error of the paired difference over groups,
or by no more than what matters: where noise is correlated between bands and geometries, larger
models go on winning by amounts that nobody could see.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from relgloss_view.base.errors import FitCancelled
from relgloss_view.fitting.model import (
    Rung,
    Solution,
    State,
    error_size,
    log_residual,
    mean_error,
    predict,
)
from relgloss_view.fitting.samples import Samples
from relgloss_view.fitting.search import solve
from relgloss_view.fitting.shapes import Geometry
from relgloss_view.fitting.solver import Problem

Array = NDArray[np.float64]
Progress = Callable[[float, str], bool | None]

LADDER = (
    Rung("lambert", rough=False),
    Rung("rough"),
    Rung("lobe", lobes=1),
    Rung("spectral-lobe", lobes=1, spectral=True),
    Rung("two-lobes", lobes=2),
    Rung("two-spectral-lobes", lobes=2, spectral=True),
)
MODELS = ("auto", *(rung.name for rung in LADDER))
FOLD_ROUNDS = 4
#: Differences in the held-out logarithmic error that do not matter: what a misfit of about 0.6 %
#: of the reflectance adds to noise, or 3 % of the error that is there anyway.
RELEVANT = 0.0005
RELEVANT_SHARE = 0.03
#: The refractive index hides behind the strength, so freeing it must pay ten times its cost.
RELEVANT_SHARE_INDEX = 0.10


@dataclass(frozen=True)
class Fold:
    """Samples with one group left out, and that group."""

    kept_geometry: Geometry
    kept: Samples
    left_geometry: Geometry
    left: Samples


@dataclass(frozen=True)
class Candidate:
    """A fitted rung and its evidence."""

    rung: Rung
    solution: Solution
    held_out: Array  #: (G,), mean logarithmic error in each group by the fit without it
    fold_states: tuple[State, ...]
    error: float  #: on all samples
    cv_mean: float
    cv_se: float

    @property
    def name(self) -> str:
        """The rung's name; a freed refractive index is named too."""
        return self.rung.name + (", n free" if self.rung.free_index else "")


def make_folds(g: Geometry, samples: Samples) -> list[Fold]:
    """One fold a group."""
    folds = []
    for number in range(samples.groups):
        left = samples.group == number
        if np.any(samples.weight[left] > 0.0) and np.any(samples.weight[~left] > 0.0):
            folds.append(
                Fold(g.subset(~left), samples.subset(~left), g.subset(left), samples.subset(left))
            )
    return folds


def evaluate(
    g: Geometry, samples: Samples, folds: list[Fold], rung: Rung, solution: Solution
) -> Candidate:
    """Cross-validate a solution: short refinements from it on each fold."""
    held_out, states = [], []
    for fold in folds:
        problem = Problem(fold.kept_geometry, fold.kept, rung)
        state = problem.refine(solution.state, FOLD_ROUNDS).state
        held_out.append(mean_error(fold.left, predict(fold.left_geometry, state)))
        states.append(state)
    errors = np.array(held_out)
    return Candidate(
        rung,
        solution,
        errors,
        tuple(states),
        mean_error(samples, predict(g, solution.state)),
        float(np.mean(errors)),
        float(np.std(errors, ddof=1) / np.sqrt(len(errors))),
    )


def climb(
    g: Geometry,
    samples: Samples,
    rungs: tuple[Rung, ...],
    n: float,
    progress: Progress | None = None,
    start_s_deg: float | None = None,
) -> tuple[list[Candidate], list[Fold]]:
    """Fit and cross-validate the rungs in order; each starts also from what the last one found."""
    folds = make_folds(g, samples)
    found: list[Candidate] = []
    for k, rung in enumerate(rungs):
        report(progress, k / (len(rungs) + 1), f"fitting {rung.name}")
        warm = tuple(c.solution.state for c in found if c.rung.lobes == rung.lobes)
        if warm and rung.spectral:
            # The lobes found for a neutral strength are where spectral ones begin.
            solution = Problem(g, samples, rung).refine(warm[-1])
            if rung.lobes == 1:
                again = solve(g, samples, rung, n, start_s_deg=start_s_deg)
                solution = min(solution, again, key=lambda s: s.loss)
        else:
            solution = solve(g, samples, rung, n, start_s_deg=start_s_deg, warm=warm)
        report(progress, (k + 0.5) / (len(rungs) + 1), f"cross-validating {rung.name}")
        found.append(evaluate(g, samples, folds, rung, solution))
    return found, folds


def choose(candidates: list[Candidate]) -> int:
    """Index of the smallest candidate that is enough. Candidates come in order of size."""
    best = min(candidates, key=lambda c: c.cv_mean)
    for k, candidate in enumerate(candidates):
        if candidate is best or enough(candidate, best, RELEVANT_SHARE):
            return k
    raise AssertionError("the best candidate is enough")


def enough(small: Candidate, large: Candidate, share: float) -> bool:
    """Whether the larger candidate gains nothing that is both certain and relevant."""
    mean, se = gain(small, large)
    return mean <= se or mean <= max(RELEVANT, share * small.cv_mean)


def gain(small: Candidate, large: Candidate) -> tuple[float, float]:
    """Mean and standard error over groups of what the larger candidate gains, held out."""
    difference = small.held_out - large.held_out
    return float(np.mean(difference)), float(np.std(difference, ddof=1) / len(difference) ** 0.5)


def free_index(
    g: Geometry, samples: Samples, folds: list[Fold], candidate: Candidate
) -> Candidate | None:
    """The same rung with its refractive indices free; None where it has no lobe."""
    if candidate.rung.lobes == 0:
        return None
    rung = replace(candidate.rung, free_index=True)
    problem = Problem(g, samples, rung)
    start = candidate.solution.state
    starts = [
        replace(start, n=np.full(rung.lobes, n), ks=start.ks * scale)
        for n, scale in ((float(start.n[0]), 1.0), (3.5, 0.13))
    ]
    solution = min((problem.refine(s) for s in starts), key=lambda s: s.loss)
    return evaluate(g, samples, folds, rung, solution)


def report(progress: Progress | None, fraction: float, text: str) -> None:
    """Tell the caller; raises FitCancelled when the callback answers False."""
    if progress is not None and progress(fraction, text) is False:
        raise FitCancelled("the fit was cancelled")


def rms_log_error(samples: Samples, model: Array) -> float:
    """Root of the weighted mean square of the logarithmic residual."""
    residual = log_residual(samples, model)
    return float(np.sqrt(np.sum(samples.weight * residual**2) / np.sum(samples.weight)))


def group_errors(samples: Samples, model: Array) -> Array:
    """(G,), mean logarithmic error in each group that has samples."""
    size = samples.weight * error_size(log_residual(samples, model))
    total = np.bincount(samples.group, np.sum(size, axis=1), samples.groups)
    weight = np.bincount(samples.group, np.sum(samples.weight, axis=1), samples.groups)
    seen = weight > 0.0
    return np.asarray(total[seen] / weight[seen])
