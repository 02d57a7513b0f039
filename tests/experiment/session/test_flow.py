"""What is on the screen when, and that an interrupted session goes on where it was."""

from __future__ import annotations

import pytest
from cases import Clock, answer, answer_all, standing, started, study, to_trial

from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.design.trial_order import planned_trials
from relgloss_view.experiment.session.flow import EARLIEST_S, Flow, Phase
from relgloss_view.experiment.session.session_file import open_to_read
from relgloss_view.experiment.session.store import Store

SMALL = Grid((0.0, 2.0), (0.5, 1.0))
TWO = ("matte-coated", "uncoated")


@pytest.fixture
def opened(tmp_path):
    """Opens the session file of a study, again and again."""
    stores = []

    def open_(made=None):
        for store in stores:
            store.close()
        stores.append(Store(tmp_path / "s.sqlite", made))
        return stores[-1]

    yield open_
    for store in stores:
        store.close()


def begun(store, clock):
    observer = store.observer()
    return Flow(store, observer, store.begin_run(observer, "device", {}), clock)


def events(store):
    return [row[0] for row in store._rows("SELECT kind FROM event ORDER BY id")]


def test_the_whole_way(opened):
    store, clock = opened(study(grid=SMALL, adaptation_min=10.0, gap_s=0.5)), Clock()
    flow = begun(store, clock)
    assert flow.phase is Phase.CONSENT
    assert not flow.answer(0)
    flow.confirm()
    assert store.observers()[0].consented
    assert flow.phase is Phase.INSTRUCTIONS
    flow.confirm()
    assert flow.phase is Phase.OBJECT
    flow.confirm()
    assert flow.phase is Phase.ADAPTATION
    assert flow.left_s() == pytest.approx(600.0)  # the paper's ten minutes
    clock.now_s += 599.9
    flow.tick()
    assert flow.phase is Phase.ADAPTATION
    clock.now_s += 0.2
    flow.tick()
    assert flow.phase is Phase.GAP
    clock.now_s += 0.5
    flow.tick()
    assert flow.phase is Phase.TRIAL
    answer_all(flow)
    assert flow.phase is Phase.FINISHED
    assert not store.observers()[0].ended
    flow.end()
    assert store.observers()[0].ended
    assert flow.progress().answered == flow.progress().total == 4
    assert [a.trial for a in store.answers()] == list(planned_trials(store.study, 0))


def test_who_declines_is_asked_nothing_and_does_not_come_back(opened):
    store = opened(study(grid=SMALL))
    flow = begun(store, Clock())
    assert flow.decline()
    assert flow.phase is Phase.DECLINED
    assert not flow.confirm()
    assert store.observers()[0].ended  # before the window closes
    flow.end()
    assert store.answers() == []
    assert store.observer().name == "O02"


def test_response_time_counts_from_the_screen(opened):
    store, clock = opened(study(grid=SMALL)), Clock()
    flow = started(store, clock)
    clock.now_s += 5.0  # drawn, not shown yet
    assert not flow.answer(1)
    flow.shown()
    clock.now_s += 0.5 * EARLIEST_S
    assert not flow.answer(1)  # a key that bounced
    clock.now_s += 1.0
    flow.shown()  # every frame says so; the first one counts
    assert flow.answer(1)
    assert store.answers()[0].response_s == pytest.approx(1.0 + 0.5 * EARLIEST_S, abs=1e-3)


@pytest.mark.parametrize("category", [-1, 5, 99])
def test_no_such_category(opened, category):
    flow = started(opened(study(grid=SMALL)))
    flow.shown()
    flow._clock.now_s += 1.0
    assert not flow.answer(category)
    assert flow.store.answers() == []


def test_pause_shows_the_stimulus_anew(opened):
    store, clock = opened(study(grid=SMALL, gap_s=0.5)), Clock()
    flow = started(store, clock)
    trial = flow.trial
    flow.shown()
    clock.now_s += 60.0
    assert flow.pause()
    assert not flow.answer(0)
    clock.now_s += 600.0
    flow.confirm()
    assert flow.phase is Phase.GAP
    to_trial(flow)
    assert flow.trial == trial
    answer(flow)
    assert store.answers()[0].response_s == pytest.approx(1.0)
    assert events(store)[-2:] == ["paused", "resumed"]


def test_adaptation_cut_short_is_kept(opened):
    store = opened(study(grid=SMALL, adaptation_min=1.0))
    flow = begun(store, Clock())
    for _ in range(3):
        flow.confirm()
    flow._clock.now_s += 20.0
    assert flow.skip_adaptation()
    (detail,) = store._rows("SELECT detail FROM event WHERE kind = 'adaptation cut short'")[0]
    assert detail == "40 s left"


class TestUndo:
    def test_steps_back_over_samples_and_the_end(self, opened):
        store = opened(study(TWO, grid=SMALL))
        flow = started(store)
        answer_all(flow)
        assert flow.phase is Phase.FINISHED
        for left in (7, 6, 5, 4):
            assert flow.undo()
            assert len(store.answers()) == left
        assert flow.trial.position == 4
        assert flow.undo()  # of the sample before: its object has to be put back
        assert flow.phase is Phase.OBJECT
        to_trial(flow)
        assert flow.trial.position == 3
        answer_all(flow)
        assert len(store.answers()) == 8

    def test_nothing_to_take_back(self, opened):
        flow = started(opened(study(grid=SMALL)))
        assert not flow.undo()

    def test_a_double_press_answers_one_question(self, opened):
        """The second question is a screen of its own: its time counts anew."""
        flow = started(opened(study(grid=SMALL, ask_grain=True)))
        flow.shown()
        flow._clock.now_s += 1.0
        assert flow.answer(2)
        assert flow.question == "grain"
        flow.shown()
        flow._clock.now_s += 0.5 * EARLIEST_S
        assert not flow.answer(2)
        assert len(flow.store.answers()) == 1

    def test_of_one_of_two_questions(self, opened):
        flow = started(opened(study(grid=SMALL, ask_grain=True)))
        answer(flow, 2)
        assert (flow.trial.position, flow.question) == (0, "grain")
        answer(flow, 3)
        assert (flow.trial.position, flow.question) == (1, "ratio")
        flow.undo()
        to_trial(flow)
        assert (flow.trial.position, flow.question) == (0, "grain")

    @pytest.mark.parametrize("design", ["full", "adaptive"])
    def test_an_undone_answer_leaves_no_trace_in_what_follows(self, opened, design):
        store = opened(study(grid=SMALL, design=design))
        flow = started(store)
        for category in (0, 4, 1):
            answer(flow, category)
        following = flow.trial
        flow.undo()
        to_trial(flow)
        answer(flow, 1)
        assert flow.trial == following
        assert [a.category for a in store.answers()] == [0, 4, 1]


class TestResume:
    @pytest.mark.parametrize("design", ["full", "adaptive"])
    def test_goes_on_at_the_same_trial_with_the_same_order(self, opened, design):
        made = study(TWO, grid=SMALL, design=design, ask_grain=True)
        flow = started(opened(made))
        for category in (1, 0, 2):
            answer(flow, category)
        trial, question, kept = flow.trial, flow.question, standing(flow.store)
        trials = flow.store.trials(flow.observer)
        # The program is gone without a word; another one starts.
        flow = started(opened(made))
        assert flow.observer.name == "O01"
        assert (flow.trial, flow.question) == (trial, question)
        assert flow.store.trials(flow.observer)[: len(trials)] == trials
        assert standing(flow.store) == kept
        answer_all(flow)
        flow.end()

    def test_who_has_agreed_is_not_asked_again(self, opened):
        made = study(grid=SMALL)
        flow = begun(opened(made), Clock())
        flow.confirm()
        flow = begun(opened(made), Clock())
        assert flow.phase is Phase.INSTRUCTIONS

    def test_the_order_is_the_files_not_the_programs(self, opened, monkeypatch):
        """A later version that would plan otherwise goes on with what was planned."""
        from relgloss_view.experiment.session import flow as module

        made = study(grid=SMALL)
        first = started(opened(made))
        answer(first)
        expected = first.store.trials(first.observer)
        monkeypatch.setattr(module, "planned_trials", lambda *_: ())
        again = started(opened(made))
        assert again.store.trials(again.observer) == expected
        assert again.trial == expected[1]

    def test_killed_between_the_last_answer_and_the_end(self, opened):
        made = study(grid=SMALL)
        answer_all(started(opened(made)))
        flow = begun(opened(made), Clock())
        assert flow.phase is Phase.FINISHED
        flow.end()
        assert flow.store.observer().name == "O02"

    def test_runs_are_kept(self, opened, tmp_path):
        made = study(grid=SMALL)
        started(opened(made))
        flow = started(opened(made))
        flow.end()
        flow.store.close()
        with open_to_read(tmp_path / "s.sqlite") as opened:
            rows = opened.connection.execute(
                "SELECT ended_utc IS NULL FROM run ORDER BY id"
            ).fetchall()
        assert rows == [(1,), (0,)]


def test_repeats_are_asked_again(opened):
    store = opened(study(grid=SMALL, repeats=3))
    answer_all(started(store))
    assert len(store.answers()) == 12
    settings = [a.trial.setting for a in store.answers()]
    assert all(settings.count(k) == 3 for k in range(4))
