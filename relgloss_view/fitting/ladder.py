"""The ladder of models and the choice of the smallest that is enough.

Each rung is cross-validated by leaving out whole groups (incidence planes). A rung is enough when
it is no worse than the best by more than one standard error of the paired difference over groups,
or by no more than what matters: where noise is correlated between bands and geometries, larger
models keep gaining by amounts that nobody could see.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import FitCancelled
from relgloss_view.base.terminal import ProgressReport
from relgloss_view.fitting.descent import AT_ONCE, refine
from relgloss_view.fitting.limits import at_limits
from relgloss_view.fitting.model import (
    Rung,
    Solution,
    State,
    States,
    error_size,
    log_residual,
    mean_error,
    predict,
)
from relgloss_view.fitting.observations import Observations
from relgloss_view.fitting.problem import Problem
from relgloss_view.fitting.search import solve

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
#: Differences in the held-out logarithmic error that do not matter: a misfit of about 0.6 % of the
#: reflectance adds the first to noise; the second is a share of the smaller model's error.
RELEVANT = 0.0005
RELEVANT_SHARE = 0.03
#: The same for a freed refractive index, and for one that no dielectric has, which stands in for
#: what the model lacks; and how many standard errors the first must gain: coatings have indices of
#: 1.4 to 1.6, so that 1.5 has no better claim than another.
RELEVANT_SHARE_INDEX = 0.02
RELEVANT_SHARE_ODD_INDEX = 0.10
CERTAIN_INDEX = 0.5
#: What a model may lose, of its held-out error, to have no unknown at a limit of its search.
LIMIT_COST = 0.3


@dataclass(frozen=True)
class Folds:
    """The observations, and F pairs of weights: of a fit that leaves a group out, of that group."""

    observations: Observations
    kept: Array  #: (F, B, N)
    left: Array  #: (F, B, N)


@dataclass(frozen=True)
class Held:
    """States that hold one thing elsewhere, and how likely each is against the solution."""

    states: tuple[State, ...]
    likelihoods: tuple[float, ...]


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
    held: tuple[Held, ...] = ()  #: one for each thing that the samples may leave open
    #: Pairs of states on both sides: what one standard deviation of something moves that all
    #: samples share, such as the zero level of the readings
    shared_states: tuple[tuple[State, State], ...] = ()

    @property
    def name(self) -> str:
        """The rung's name; a freed refractive index is named too."""
        return self.rung.name + (", n free" if self.rung.free_index else "")


def make_folds(observations: Observations) -> Folds:
    """One fold a group that has weight and leaves weight."""
    weight = observations.weight.T
    groups = np.arange(observations.groups)[:, None, None] == observations.group
    kept, left = np.where(groups, 0.0, weight), np.where(groups, weight, 0.0)
    fit = np.any(kept > 0.0, axis=(1, 2)) & np.any(left > 0.0, axis=(1, 2))
    return Folds(observations, kept[fit], left[fit])


def evaluate(folds: Folds, rung: Rung, solution: Solution) -> Candidate:
    """Cross-validate a solution: short refinements from it on each fold."""
    observations, count = folds.observations, len(folds.kept)
    problem = Problem(observations, rung, weight=folds.kept)
    refined = refine(problem, [solution.state] * count, FOLD_ROUNDS)
    states = States.of([fold.state for fold in refined])
    errors = _held_out(Problem(observations, rung, weight=folds.left), states)
    return Candidate(
        rung=rung,
        solution=solution,
        held_out=errors,
        fold_states=tuple(fold.state for fold in refined),
        error=mean_error(observations, predict(observations.geometry, solution.state)),
        cv_mean=float(np.mean(errors)),
        cv_se=float(np.std(errors, ddof=1) / np.sqrt(len(errors))),
    )


def _held_out(problem: Problem, states: States) -> Array:
    """(F,), mean errors of F states on the groups that each has not seen, a few at once."""
    size = max(AT_ONCE // max(problem.samples, 1), 1)
    errors = []
    for first in range(0, len(states), size):
        some = np.zeros(len(states), dtype=bool)
        some[first : first + size] = True
        few = states.subset(some)
        model = problem.model(problem.columns_of(few), few.kd, few.ks)
        errors.append(problem.part(some).mean_errors(model))
    return np.concatenate(errors)


def climb(
    observations: Observations,
    rungs: tuple[Rung, ...],
    n: float,
    progress: ProgressReport | None = None,
    start_s_deg: float | None = None,
    solved: Mapping[str, Solution] | None = None,
) -> tuple[list[Candidate], Folds]:
    """Fit and cross-validate the rungs in order; each starts also from the rung before.

    solved: solutions that are known already, by the rung's name.
    """
    folds = make_folds(observations)
    candidates: list[Candidate] = []
    for k, rung in enumerate(rungs):
        report(progress, k / (len(rungs) + 1), f"fitting {rung.name}")
        warm = tuple(c.solution.state for c in candidates if c.rung.lobes == rung.lobes)
        if solved is not None and rung.name in solved:
            solution = solved[rung.name]
        elif warm and rung.spectral and rung.lobes > 1:
            # The lobes of a neutral strength are where spectral ones begin.
            solution = refine(Problem(observations, rung), warm[-1:])[0]
        else:
            solution = solve(observations, rung, n, start_s_deg=start_s_deg, warm=warm)
        report(progress, (k + 0.5) / (len(rungs) + 1), f"cross-validating {rung.name}")
        candidates.append(evaluate(folds, rung, solution))
    return candidates, folds


def choose(candidates: list[Candidate]) -> int:
    """Index of the smallest candidate that is enough. Candidates come in order of size.

    One that ends at a limit of its search gives way to one that does not and is hardly worse.
    """
    chosen = _smallest(candidates)
    if at_limits(chosen.rung, chosen.solution.state):
        inside = [c for c in candidates if not at_limits(c.rung, c.solution.state)]
        other = _smallest(inside) if inside else chosen
        if other.cv_mean <= (1.0 + LIMIT_COST) * chosen.cv_mean + RELEVANT:
            chosen = other
    return next(k for k, candidate in enumerate(candidates) if candidate is chosen)


def _smallest(candidates: list[Candidate]) -> Candidate:
    best = min(candidates, key=lambda c: c.cv_mean)
    return next(c for c in candidates if c is best or enough(c, best, RELEVANT_SHARE))


def enough(small: Candidate, large: Candidate, share: float) -> bool:
    """Whether the larger candidate gains nothing that is both certain and relevant."""
    mean, se = gain(small, large)
    return mean <= se or mean <= max(RELEVANT, share * small.cv_mean)


def gain(small: Candidate, large: Candidate) -> tuple[float, float]:
    """Mean and standard error over groups of what the larger candidate gains, held out."""
    difference = small.held_out - large.held_out
    return float(np.mean(difference)), float(np.std(difference, ddof=1) / len(difference) ** 0.5)


def free_index(folds: Folds, candidate: Candidate) -> Candidate | None:
    """The same rung with its refractive indices free; None where it has no lobe, or a metal's."""
    if candidate.rung.lobes == 0 or candidate.rung.metals:
        return None
    rung = replace(candidate.rung, free_index=True)
    start = candidate.solution.state
    # From the held index, and from that of a metal, whose strength is as much lower.
    starts = [
        replace(start, n=np.full(rung.lobes, n), ks=start.ks * share)
        for n, share in ((float(start.n[0]), 1.0), (3.5, 0.13))
    ]
    solutions = refine(Problem(folds.observations, rung), starts)
    return evaluate(folds, rung, min(solutions, key=lambda s: s.loss))


def report(progress: ProgressReport | None, share: float, text: str) -> None:
    """Report to the caller; raises FitCancelled when the callback returns False."""
    if progress is not None and progress(share, text) is False:
        raise FitCancelled("the fit was cancelled")


def rms_log_error(observations: Observations, model: Array) -> float:
    """Root of the weighted mean square of the logarithmic residual."""
    residual = log_residual(observations, model)
    return float(np.sqrt(np.sum(observations.weight * residual**2) / np.sum(observations.weight)))


def group_errors(observations: Observations, model: Array) -> Array:
    """(G,), mean logarithmic error in each group that has observations."""
    size = observations.weight * error_size(log_residual(observations, model))
    total = np.bincount(observations.group, np.sum(size, axis=1), observations.groups)
    weight = np.bincount(
        observations.group, np.sum(observations.weight, axis=1), observations.groups
    )
    seen = weight > 0.0
    return np.asarray(total[seen] / weight[seen])
