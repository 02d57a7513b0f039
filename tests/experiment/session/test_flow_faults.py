"""Flow where the session file fails half way: nothing is kept twice, and what is missing is made up
for."""

from __future__ import annotations

import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.design.study import Procedure, Study, StudySample
from relgloss_view.experiment.session.flow import Flow, Phase
from relgloss_view.experiment.session.store import Store
from relgloss_view.picture.scene.sample import Sample, load_sample


class Clock:
    def __init__(self):
        self.now_s = 0.0

    def __call__(self):
        return self.now_s


@pytest.fixture
def flow(tmp_path):
    """At the first stimulus of an adaptive study, a second after it came."""
    study = Study(
        samples=(StudySample("uncoated", Sample(load_sample("uncoated"), name="uncoated")),),
        reference=Sample(load_sample("cast-coated"), name="cast-coated"),
        grid=Grid((0.0, 2.0), (0.5, 1.0)),
        procedure=Procedure(adaptation_min=0.0, gap_s=0.5, design="adaptive"),
    )
    with Store(tmp_path / "session.sqlite", study) as store:
        observer = store.observer()
        made = Flow(store, observer, store.begin_run(observer, "none", {}), Clock())
        for _ in range(3):
            assert made.confirm()
        to_stimulus(made)
        yield made


def to_stimulus(flow):
    flow._clock.now_s += 1.0
    flow.tick()
    assert flow.phase is Phase.TRIAL
    flow.shown()
    flow._clock.now_s += 1.0


def refused(*_):
    raise InputError("the disk is full")


def test_an_answer_is_kept_once_where_the_next_trial_can_not_be(flow, monkeypatch):
    with monkeypatch.context() as patched:
        patched.setattr(flow.store, "plan", refused)
        with pytest.raises(InputError, match="full"):
            flow.answer(1)
        assert flow.behind
        assert len(flow.store.answers()) == 1
        assert not flow.answer(2)
        assert not flow.undo()
        with pytest.raises(InputError, match="full"):
            flow.tick()
    flow.tick()
    assert not flow.behind
    assert (flow.phase, flow.trial.position) == (Phase.GAP, 1)
    to_stimulus(flow)
    assert flow.answer(0)
    assert [a.category for a in flow.store.answers()] == [1, 0]


def test_an_answer_that_is_not_kept_leaves_all_as_it_was(flow, monkeypatch):
    with monkeypatch.context() as patched:
        patched.setattr(flow.store, "answer", refused)
        with pytest.raises(InputError, match="full"):
            flow.answer(1)
    assert (flow.phase, flow.trial.position, flow.behind) == (Phase.TRIAL, 0, False)
    assert flow.store.answers() == []


def test_times_count_anew_when_the_stimulus_was_gone(flow):
    flow.hidden()
    assert not flow.answer(1)  # there is nothing to judge
    flow._clock.now_s += 60.0
    flow.shown()
    flow._clock.now_s += 0.5
    assert flow.answer(1)
    assert flow.store.answers()[0].response_s == pytest.approx(0.5)
