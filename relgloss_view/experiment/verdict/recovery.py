"""Many simulated studies with known truths: how often the evaluation finds them.

Every study goes the whole way: observers answer through the store, the file is read and analysed.
"""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.temporaries import scratch_folder
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.experiment.design.coordinates import grid_steps
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.design.study import Study
from relgloss_view.experiment.observers.kinds import PICTURE
from relgloss_view.experiment.observers.percept import Percepts, see_study, see_truths, unseen
from relgloss_view.experiment.observers.population import Population
from relgloss_view.experiment.observers.simulation import run_observers
from relgloss_view.experiment.observers.truth import right_settings, truths_of
from relgloss_view.experiment.scaling.fine_grid import Optimum
from relgloss_view.experiment.session.pool import read_pool
from relgloss_view.experiment.session.posterior import Estimate
from relgloss_view.experiment.session.store import Store
from relgloss_view.experiment.verdict.analysis import Options, SampleResult, analyse
from relgloss_view.experiment.verdict.full_grid import BEST
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.quality.backends import FrameRenderer

NEIGHBOUR_STEPS = 1.0  #: along each axis: the truth lies in the chosen cell or one beside it
EXACT_STEPS = 0.5


@dataclass(frozen=True)
class Recovery:
    """What one study told of one sample, against the truth."""

    study: int
    sample: str
    truth: Setting
    leading: Setting
    status: str
    answers: int
    exact: bool  #: the leading cell is the truth's
    near: bool  #: or one beside it, corners too
    in_set: bool  #: whether all that is right is among the settings not worse than the leading one
    error_steps: float  #: of the optimum between grid points
    sigma_n_inside: bool | None  #: whether the 95 % interval holds the truth; None without one
    c_inside: bool | None


def run_studies(
    renderer: FrameRenderer,
    study: Study,
    studies: int,
    observers: int,
    population: Population,
    *,
    truth: str,
    stated: Mapping[str, Setting],
    grain_weights: Sequence[float],
    draws: int,
    seed: int = 0,
    progress: ProgressReport = no_progress,
) -> list[Recovery]:
    """Run so many studies, each with its own observers, order and truth.

    `stated` holds truths by label that are the same in all of them; grain_weights is that of
    Percepts. Nothing is drawn for observers who see no picture.
    """
    first = truths_of(study, truth, stated, seed)
    pictures = population.of_kind.depends_on == PICTURE
    if pictures:
        percepts = see_study(
            renderer, study, first, grain_weights, lambda share, text: progress(0.0, text)
        )
    recoveries: list[Recovery] = []
    for number in range(studies):
        progress(number / studies, f"study {number + 1} of {studies}")
        truths = truths_of(study, truth, stated, seed + number)
        if pictures:
            targets = see_truths(renderer, study, truths)
            seen = dataclasses.replace(percepts, truths=truths, targets=targets)
        else:
            seen = unseen(study, truths)
        own = study.with_procedure(seed=(study.procedure.seed + number) % 2**31)
        recoveries += _one(own, seen, observers, population, draws, seed + number, number)
    return recoveries


def _one(
    study: Study,
    percepts: Percepts,
    observers: int,
    population: Population,
    draws: int,
    seed: int,
    number: int,
) -> list[Recovery]:
    with scratch_folder() as folder:
        file = folder / "study.sqlite"
        with Store(file, study) as store:
            run_observers(store, percepts, population, observers, seed)
        results = analyse(read_pool([file], folder), Options(draws, seed)).samples
    count = population.of_kind.right_settings
    truths = {
        s.label: right_settings(study.grid, t, count)
        for s, t in zip(study.samples, percepts.truths, strict=True)
    }
    return [_found(study.grid, number, result, truths[result.label]) for result in results]


def _found(grid: Grid, number: int, result: SampleResult, right: Sequence[Setting]) -> Recovery:
    """Against the nearest to the leading setting of those that are right."""
    if result.adaptive is not None:
        verdict = result.adaptive
        status, leading, as_good = verdict.status, grid.settings[verdict.leading], verdict.as_good
        optimum: Estimate | Optimum = verdict.estimate
    else:
        full = result.verdict
        status, leading, as_good = full.status, grid.settings[full.leading], full.as_good
        optimum = full.optimum
    at = Setting(optimum.sigma_n_deg, optimum.c_fraction)
    cells = np.array([_steps(grid, setting) for setting in grid.settings])
    apart_all = [np.abs(np.subtract(cells, _steps(grid, truth))) for truth in right]
    in_set = all(bool(np.any(as_good & _is_nearest(apart))) for apart in apart_all)
    place = _steps(grid, leading)
    truth = min(right, key=lambda t: float(np.hypot(*np.subtract(place, _steps(grid, t)))))
    apart = np.abs(np.subtract(place, _steps(grid, truth)))
    error = float(np.hypot(*np.subtract(_steps(grid, at), _steps(grid, truth))))
    return Recovery(
        study=number,
        sample=result.label,
        truth=truth,
        leading=leading,
        status=status,
        answers=result.answers,
        exact=bool(np.all(apart <= EXACT_STEPS + 1e-9)),
        near=bool(np.all(apart <= NEIGHBOUR_STEPS + 1e-9)),
        in_set=in_set,
        error_steps=error,
        sigma_n_inside=_inside(truth.sigma_n_deg, optimum.sigma_n_interval_deg),
        c_inside=_inside(truth.c_fraction, optimum.c_interval),
    )


def _is_nearest(apart: Array) -> Mask:
    """(J,): settings whose cell holds a truth that is (J, 2) steps away."""
    return np.asarray(np.all(apart <= EXACT_STEPS + 1e-9, axis=1))


def _steps(grid: Grid, setting: Setting) -> tuple[float, float]:
    return grid_steps(grid, setting.sigma_n_deg, setting.c_fraction)


def _inside(value: float, interval: tuple[float, float] | None) -> bool | None:
    return None if interval is None else interval[0] - 1e-9 <= value <= interval[1] + 1e-9


@dataclass(frozen=True)
class RecoveryShares:
    """Over some samples of some studies: how often the evaluation found what was right."""

    cases: int
    answers: float  #: about each sample, mean
    exact: float  #: share of cases, as all that follows but the error
    near: float
    in_set: float
    median_error_steps: float
    sigma_n_inside: float | None  #: None where no case has an interval
    c_inside: float | None
    inside: float | None  #: of all intervals along both axes
    nothing_declared: float  #: share of studies in which no sample has a best setting
    status: dict[str, int]  #: cases by the status of their verdict


def recovery_shares(recoveries: Sequence[Recovery]) -> RecoveryShares:
    """Shares over all of some recoveries."""
    declared: dict[int, bool] = {}
    for r in recoveries:
        declared[r.study] = declared.get(r.study, False) or r.status == BEST
    sigma = [r.sigma_n_inside for r in recoveries if r.sigma_n_inside is not None]
    c = [r.c_inside for r in recoveries if r.c_inside is not None]
    return RecoveryShares(
        cases=len(recoveries),
        answers=float(np.mean([r.answers for r in recoveries])),
        exact=float(np.mean([r.exact for r in recoveries])),
        near=float(np.mean([r.near for r in recoveries])),
        in_set=float(np.mean([r.in_set for r in recoveries])),
        median_error_steps=float(np.median([r.error_steps for r in recoveries])),
        sigma_n_inside=float(np.mean(sigma)) if sigma else None,
        c_inside=float(np.mean(c)) if c else None,
        inside=float(np.mean(sigma + c)) if sigma or c else None,
        nothing_declared=1.0 - float(np.mean(list(declared.values()))),
        status=dict(Counter(r.status for r in recoveries)),
    )


def shares_by_sample(recoveries: Sequence[Recovery]) -> dict[str, RecoveryShares]:
    """Shares over the recoveries of each sample, by its label."""
    labels = dict.fromkeys(r.sample for r in recoveries)
    return {
        label: recovery_shares([r for r in recoveries if r.sample == label]) for label in labels
    }
