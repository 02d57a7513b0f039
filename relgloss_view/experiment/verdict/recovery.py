"""Many simulated studies with known truths: how often the evaluation finds them.

Every study goes the whole way: observers answer through the store, the file is read and analysed.
"""

from __future__ import annotations

import dataclasses
import tempfile
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from relgloss_view.experiment.design.coordinates import grid_steps
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.design.study import Study
from relgloss_view.experiment.observers.percept import Percepts, see_study, see_truths
from relgloss_view.experiment.observers.population import Population
from relgloss_view.experiment.observers.simulation import run_observers
from relgloss_view.experiment.observers.truth import truths_of
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
class Found:
    """What one study told of one sample, against the truth."""

    study: int
    sample: str
    truth: Setting
    leading: Setting
    status: str
    answers: int
    exact: bool  #: the leading cell is the truth's
    near: bool  #: or one beside it, corners too
    error_steps: float  #: of the optimum between grid points
    sigma_n_inside: bool | None  #: whether the 95 % interval holds the truth; None without one
    c_inside: bool | None


def prove(
    renderer: FrameRenderer,
    study: Study,
    studies: int,
    observers: int,
    population: Population,
    *,
    truth: str,
    given: Mapping[str, Setting],
    draws: int,
    seed: int = 0,
    progress: Callable[[float, str], object] = lambda share, text: None,
) -> list[Found]:
    """Run so many studies, each with its own observers, order and, unless given, truth."""
    first = truths_of(study, truth, given, seed)
    percepts = see_study(renderer, study, first, lambda share, text: progress(0.0, text))
    found: list[Found] = []
    for number in range(studies):
        progress(number / studies, f"study {number + 1} of {studies}")
        truths = truths_of(study, truth, given, seed + number)
        targets = see_truths(renderer, study, truths)
        seen = dataclasses.replace(percepts, truths=truths, targets=targets)
        own = study.with_procedure(seed=(study.procedure.seed + number) % 2**31)
        found += _one(own, seen, observers, population, draws, seed + number, number)
    return found


def _one(
    study: Study,
    percepts: Percepts,
    observers: int,
    population: Population,
    draws: int,
    seed: int,
    number: int,
) -> list[Found]:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        file = folder / "study.sqlite"
        with Store(file, study) as store:
            run_observers(store, percepts, population, observers, seed)
        results = analyse(read_pool([file], folder), Options(draws, seed)).samples
    truths = {s.label: t for s, t in zip(study.samples, percepts.truths, strict=True)}
    return [_found(study.grid, number, result, truths[result.label]) for result in results]


def _found(grid: Grid, number: int, result: SampleResult, truth: Setting) -> Found:
    if result.adaptive is not None:
        verdict = result.adaptive
        status, leading = verdict.status, grid.settings[verdict.leading]
        optimum: Estimate | Optimum = verdict.estimate
    else:
        full = result.verdict
        status, leading = full.status, grid.settings[full.leading]
        optimum = full.optimum
    at = Setting(optimum.sigma_n_deg, optimum.c_fraction)
    apart = np.abs(np.subtract(_steps(grid, leading), _steps(grid, truth)))
    error = float(np.hypot(*np.subtract(_steps(grid, at), _steps(grid, truth))))
    return Found(
        number,
        result.label,
        truth,
        leading,
        status,
        result.answers,
        bool(np.all(apart <= EXACT_STEPS + 1e-9)),
        bool(np.all(apart <= NEIGHBOUR_STEPS + 1e-9)),
        error,
        _inside(truth.sigma_n_deg, optimum.sigma_n_interval_deg),
        _inside(truth.c_fraction, optimum.c_interval),
    )


def _steps(grid: Grid, setting: Setting) -> tuple[float, float]:
    return grid_steps(grid, setting.sigma_n_deg, setting.c_fraction)


def _inside(value: float, interval: tuple[float, float] | None) -> bool | None:
    return None if interval is None else interval[0] - 1e-9 <= value <= interval[1] + 1e-9


def summary(found: Sequence[Found]) -> dict[str, Any]:
    """Shares over all samples of all studies, and over those of each sample."""
    samples = list(dict.fromkeys(f.sample for f in found))
    return {
        "all": _shares(found),
        "samples": {name: _shares([f for f in found if f.sample == name]) for name in samples},
        "studies": [dataclasses.asdict(f) for f in found],
    }


def _shares(found: Sequence[Found]) -> dict[str, Any]:
    by_study: dict[int, bool] = {}
    for f in found:
        by_study[f.study] = by_study.get(f.study, False) or f.status == BEST
    sigma = [f.sigma_n_inside for f in found if f.sigma_n_inside is not None]
    c = [f.c_inside for f in found if f.c_inside is not None]
    return {
        "cases": len(found),
        "answers": float(np.mean([f.answers for f in found])),
        "exact": float(np.mean([f.exact for f in found])),
        "near": float(np.mean([f.near for f in found])),
        "median_error_steps": float(np.median([f.error_steps for f in found])),
        "sigma_n_inside": float(np.mean(sigma)) if sigma else None,
        "c_inside": float(np.mean(c)) if c else None,
        "inside": float(np.mean(sigma + c)) if sigma or c else None,
        "nothing_declared": 1.0 - float(np.mean(list(by_study.values()))),
        "status": dict(Counter(f.status for f in found)),
    }
