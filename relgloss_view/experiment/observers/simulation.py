"""Simulated observers, led through a study by the code that leads people."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.experiment.design.trial_order import Trial
from relgloss_view.experiment.observers.percept import Percepts
from relgloss_view.experiment.observers.population import Population, SimulatedObserver
from relgloss_view.experiment.observers.truth import right_settings
from relgloss_view.experiment.session.flow import Flow, Phase
from relgloss_view.experiment.session.records import SIMULATED, Observer
from relgloss_view.experiment.session.sitting import Sitting
from relgloss_view.experiment.session.store import Store

DEVICE = "none: simulated"
BATCH = 20  #: answers that are stored at once: people wait for the disk after each, these need not
#: How observers were made whose files do not state it.
UNSTATED = {"group": 0, "to_middle": 0.0, "sigma_n_jnd": 0.5, "c_jnd": 0.1, "grain_weight": -1.0}


@dataclass(frozen=True)
class StoredAnswer:
    """An answer that is on the disk, or will be with its batch."""

    observer: str
    trial: Trial
    question: str
    category: int


class VirtualClock:
    """A clock that moves only when it is moved."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def __call__(self) -> float:
        """Seconds."""
        return self.now_s


def run_observers(
    store: Store,
    percepts: Percepts,
    population: Population,
    count: int,
    seed: int,
    on_stored: Callable[[StoredAnswer], object] = lambda answer: None,
    progress: ProgressReport = no_progress,
) -> None:
    """Lead observers through the store's study until `count` of them are through.

    Observers who have finished stay; one who was interrupted resumes. `on_stored` receives each
    answer when it is stored.
    """
    while True:
        observers = store.observers()
        if any(o.kind != SIMULATED for o in observers):
            raise InputError(
                f"{store.path}: holds answers of people; give simulated observers a file of their "
                "own"
            )
        ended = sum(o.ended for o in observers)
        if ended >= count:
            return
        number = next((o.number for o in observers if not o.ended), len(observers))
        simulated = SimulatedObserver.of(population, seed, number, len(store.study.categories))
        truths = {
            sample.label: [truth.sigma_n_deg, truth.c_fraction]
            for sample, truth in zip(store.study.samples, percepts.truths, strict=True)
        }
        weight = percepts.grain_weight_of(number)
        details = {
            **simulated.details(),
            "truths": truths,
            "grain_weight": None if np.isnan(weight) else weight,
        }
        begun = {**UNSTATED, **store.details(observers[number])} if number < len(observers) else {}
        if begun and begun != details:
            raise InputError(
                f"{store.path}: {observers[number].name} began with other truths, seed or options; "
                "continue with those, or give another file"
            )
        observer = store.observer(kind=SIMULATED, details=details)
        progress(ended / count, f"observer {observer.name}")
        _run(store, observer, simulated, percepts, on_stored)


def _run(
    store: Store,
    observer: Observer,
    simulated: SimulatedObserver,
    percepts: Percepts,
    on_stored: Callable[[StoredAnswer], object],
) -> None:
    """One observer, from consent to the end."""
    clock = VirtualClock()
    assumed = Sitting.of_study(store.study)  # pictures that nobody displays are drawn for it
    flow = Flow(store, observer, store.begin_run(observer, DEVICE, {}, sitting=assumed), clock)
    answers = _answers(flow, clock, simulated, percepts)
    while flow.phase is not Phase.FINISHED:
        with store.batch():
            stored = list(itertools.islice(answers, BATCH))
        for answer in stored:
            on_stored(answer)
    flow.end()


def _answers(
    flow: Flow, clock: VirtualClock, simulated: SimulatedObserver, percepts: Percepts
) -> Iterator[StoredAnswer]:
    """Lead an observer through all that is asked; each answer when it is given."""
    study = flow.study
    questions, settings = study.questions, study.grid.settings
    stimuli, targets = percepts.seen_by(simulated.number)
    count = simulated.population.of_kind.right_settings
    right = [right_settings(study.grid, truth, count) for truth in percepts.truths]
    while flow.phase is not Phase.FINISHED:
        checkpoint()
        if flow.phase is Phase.TRIAL:
            trial, question = flow.trial, flow.question
            assert trial is not None
            flow.shown()
            clock.now_s += simulated.response_s(trial.position)
            mismatch = simulated.mismatch(
                stimuli[trial.sample, trial.setting],
                targets[trial.sample],
                settings[trial.setting],
                right[trial.sample],
            )
            category = simulated.judge(
                trial.position, questions.index(question), question, mismatch
            )
            stored = flow.answer(category)
            assert stored
            yield StoredAnswer(flow.observer.name, trial, question, category)
        elif flow.phase in (Phase.GAP, Phase.ADAPTATION):
            clock.now_s += flow.left_s()
            flow.tick()
        else:
            flow.confirm()
