"""Analyses to report: simulated observers whose percepts are made up, so that nothing is drawn."""

import dataclasses
import functools
import tempfile
from pathlib import Path

import numpy as np

from relgloss_view.experiment.design.coordinates import coordinates, to_steps
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.design.study import CATEGORIES, Study, StudySample
from relgloss_view.experiment.observers.percept import Percepts
from relgloss_view.experiment.observers.population import Population
from relgloss_view.experiment.observers.simulation import run_observers
from relgloss_view.experiment.session.pool import read_pool
from relgloss_view.experiment.session.store import Store
from relgloss_view.experiment.verdict.analysis import Options, analyse
from relgloss_view.picture.scene.sample import Sample, load_sample
from relgloss_view.picture.scene.setting import Setting

SMALL = Grid((0.0, 1.0, 2.0), (1 / 6, 2 / 6, 3 / 6))
PERCEPT_A_STEP = np.array([0.45, 0.06])  #: log gloss, grain


def built_in(name):
    return Sample(load_sample(name), name=name)


def study_of(labels=("matte", "rough"), grid=SMALL, categories=CATEGORIES, **procedure):
    samples = tuple(StudySample(label, built_in("uncoated")) for label in labels)
    made = Study(samples, built_in("cast-coated"), grid=grid, categories=categories)
    return made.with_procedure(**procedure)


def percepts_of(study, truths):
    """Gloss and grain follow the grid's steps; enough for observers to have something to judge."""
    seen = coordinates(study.grid)[:, ::-1] * PERCEPT_A_STEP
    targets = [to_steps(study.grid, t.sigma_n_deg, t.c_fraction)[::-1] for t in truths]
    stimuli = np.stack([seen] * len(study.samples))
    return Percepts(stimuli, tuple(truths), np.array(targets) * PERCEPT_A_STEP, (0.0,))


def pool_of(study, truths=None, count=6, name="study", **population):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"{name}.sqlite"
        middle = study.grid.settings[len(study.grid) // 2]
        seen = percepts_of(study, truths or [middle] * len(study.samples))
        with Store(file, study) as store:
            run_observers(store, seen, Population(**population), count, 1)
        pool = read_pool([file], Path(folder))
    records = [dataclasses.replace(r, path=Path(f"{name}.sqlite")) for r in pool.records]
    return dataclasses.replace(pool, records=tuple(records))


@functools.cache
def usual():
    """Two samples, one right setting each, six observers."""
    return analyse(pool_of(study_of(), [Setting(1.0, 2 / 6), Setting(2.0, 1 / 6)]), Options(20))


@functools.cache
def alone():
    """One observer: nothing to resample."""
    return analyse(pool_of(study_of(("matte",)), count=1), Options(20))


@functools.cache
def with_grain():
    """Both questions."""
    return analyse(pool_of(study_of(("matte",), ask_grain=True)), Options(20))


@functools.cache
def adaptive():
    """An adaptive study."""
    return analyse(pool_of(study_of(("matte",), design="adaptive")), Options(20))


def without_answers(pool, dropped):
    """The pool without answers that a function picks."""
    members = [
        dataclasses.replace(m, answers=tuple(a for a in m.answers if not dropped(a)))
        for m in pool.members
    ]
    return dataclasses.replace(pool, members=tuple(members))


def judged_as(analysis, status, **changes):
    """The analysis with its first sample's verdict changed."""
    first = analysis.samples[0]
    verdict = dataclasses.replace(first.verdict, status=status, **changes)
    verdicts = {**first.verdicts, first.decided_by: verdict}
    changed = dataclasses.replace(first, verdicts=verdicts)
    return dataclasses.replace(analysis, samples=(changed, *analysis.samples[1:]))
