"""Studies and percepts that the tests of the experiment share."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np

from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.design.study import Procedure, Screen, Study, StudySample
from relgloss_view.experiment.observers.percept import Percepts
from relgloss_view.experiment.session.flow import Flow, Phase
from relgloss_view.picture.scene.sample import Sample, load_sample
from relgloss_view.picture.scene.setting import Setting


def built_in(name):
    return Sample(load_sample(name), name=name)


def study(samples=("matte-coated",), grid=None, size_px=96, **procedure):
    """A study of built-in papers with small pictures and no adaptation, but for what is asked."""
    made = {"adaptation_min": 0.0, "gap_s": 0.0, **procedure}
    return Study(
        tuple(StudySample(name, built_in(name)) for name in samples),
        built_in("cast-coated"),
        grid=grid or Grid(),
        procedure=Procedure(**made),
        screen=Screen(width_px=size_px, height_px=size_px),
    )


def percepts(made, truths):
    """Percepts by formula, for tests that need no pictures: gloss by log c, grain by sigma_N.

    Grain saturates as it does in pictures: no axis of an analysis is right by construction.
    """

    def seen(setting):
        return np.log(setting.c_fraction), 0.09 * np.tanh(setting.sigma_n_deg / 2.5)

    stimuli = np.array([[seen(s) for s in made.grid.settings] for _ in made.samples])
    return Percepts(stimuli, tuple(truths), np.array([seen(t) for t in truths]), (0.0,))


class Clock:
    def __init__(self):
        self.now_s = 100.0

    def __call__(self):
        return self.now_s


def started(store, clock=None, name=None):
    """A flow of the store's next observer, at its first trial."""
    observer = store.observer(name)
    flow = Flow(store, observer, store.begin_run(observer, "device", {}), clock or Clock())
    to_trial(flow)
    return flow


def to_trial(flow, limit=10):
    for _ in range(limit):
        if flow.phase in (Phase.TRIAL, Phase.FINISHED):
            return
        if flow.phase in (Phase.GAP, Phase.ADAPTATION):
            flow._clock.now_s += flow.left_s()
            flow.tick()
        else:
            flow.confirm()
    raise AssertionError(flow.phase)


def answer(flow, category=0, after_s=1.0):
    """Answer the present trial and go on to the next."""
    flow.shown()
    flow._clock.now_s += after_s
    assert flow.answer(category)
    to_trial(flow)


def answer_all(flow, categories=(0, 1, 2, 3, 4)):
    for category in itertools.cycle(categories):
        if flow.phase is Phase.FINISHED:
            return
        answer(flow, category)


def standing(store):
    """Standing answers without what depends on the time."""
    return [(a.observer, a.trial, a.question, a.category) for a in store.answers()]


def replaced(made, **changes):
    return dataclasses.replace(made, **changes)


MIDDLE = Setting(1.5, 0.5)


def index_of(grid, setting):
    """Which setting of a grid this is, but for rounding; None where the grid does not have it."""
    for k, other in enumerate(grid.settings):
        apart = (other.sigma_n_deg - setting.sigma_n_deg, other.c_fraction - setting.c_fraction)
        if np.max(np.abs(apart)) < 1e-9:
            return k
    return None
