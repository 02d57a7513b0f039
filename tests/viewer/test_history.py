"""Undo, redo, gestures and what the model says: no window anywhere."""

from __future__ import annotations

import dataclasses

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from relgloss_view.base.errors import InputError
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, Sample
from relgloss_view.viewer.state import history
from relgloss_view.viewer.state.history import History
from relgloss_view.viewer.state.model import LONGEST_NOTE, NOTES_KEPT, Model
from relgloss_view.viewer.state.state import SIDES, State

INITIAL = State.initial()


def seeded(seed):
    return INITIAL.with_look("test", seed=seed)


def seeds(made):
    """The seeds from the present state back to the first."""
    found = [made.state.test.look.seed]
    while made.undo():
        found.append(made.state.test.look.seed)
    return found


class TestState:
    def test_the_initial_one_is_the_papers(self):
        assert INITIAL.reference.sample.name == "cast-coated"
        assert INITIAL.test.sample.name == "matte-coated"
        for side in SIDES:
            look, setting = INITIAL.side(side).look, SAMPLES[INITIAL.side(side).sample.name]
            assert (look.sigma_n_deg, look.c_fraction) == (setting.sigma_n_deg, None)
        assert INITIAL.reference.look.c == INITIAL.match.reference_c
        assert INITIAL.test.look.c == INITIAL.match.test_c

    def test_only_the_window_draws_by_quality_auto(self):
        assert {INITIAL.side(side).look.quality for side in SIDES} == {"auto"}
        assert Look().quality == "exact"

    def test_changes_touch_one_thing(self):
        other = Sample.built_in("uncoated")
        for side, left in (("test", "reference"), ("reference", "test")):
            changed = INITIAL.with_sample(side, other).with_look(side, seed=4)
            assert changed.side(left) == INITIAL.side(left)
            assert changed.side(side).sample == other
            assert changed.side(side).look == dataclasses.replace(INITIAL.side(side).look, seed=4)
            assert changed.scene(side).material == other.material
        moved = INITIAL.with_part("lamp", azimuth_deg=10.0)
        assert moved.setup.lamp.azimuth_deg == 10.0
        assert moved.placed(lamp=INITIAL.setup.lamp) == INITIAL

    def test_ranges_hold(self):
        with pytest.raises(InputError, match=r"presentation\.wipe"):
            INITIAL.with_part("presentation", wipe=1.5)
        with pytest.raises(InputError, match=r"look\.seed"):
            INITIAL.with_look("test", seed=-1)


class TestHistory:
    def test_back_and_forth(self):
        made = History(seeded(0))
        assert (made.can_undo, made.can_redo) == (False, False)
        assert not made.undo()
        assert not made.redo()
        for seed in (1, 2, 3):
            made.change(seeded(seed))
        assert made.undo()
        assert made.undo()
        assert made.state == seeded(1)
        assert (made.can_undo, made.can_redo) == (True, True)
        assert made.redo()
        assert made.state == seeded(2)
        made.change(seeded(9))  # what was undone is gone
        assert not made.can_redo
        assert seeds(made) == [9, 2, 1, 0]

    def test_a_gesture_is_one_step(self):
        made = History(seeded(0))
        for seed in (1, 2, 3):
            made.change(seeded(seed), ("slider", "seed"))
        for seed in (4, 5):
            made.change(seeded(seed), ("slider", "other"))
        assert seeds(made) == [5, 3, 0]

    def test_the_same_slider_twice_is_two_steps(self):
        made = History(seeded(0))
        made.change(seeded(1), "slider")
        made.end_gesture()
        made.change(seeded(2), "slider")
        assert seeds(made) == [2, 1, 0]

    def test_undo_ends_a_gesture(self):
        made = History(seeded(0))
        made.change(seeded(1), "slider")
        made.undo()
        made.change(seeded(2), "slider")
        assert seeds(made) == [2, 0]

    def test_changes_without_a_gesture_are_steps_each(self):
        made = History(seeded(0))
        made.change(seeded(1), "slider")
        made.change(seeded(2))
        made.change(seeded(3))
        made.change(seeded(4), "slider")
        assert seeds(made) == [4, 3, 2, 1, 0]

    def test_no_change_is_no_step(self):
        made = History(seeded(0))
        made.change(seeded(1))
        made.undo()
        made.change(seeded(0))
        assert (made.can_undo, made.can_redo) == (False, True)

    def test_it_has_an_end(self, monkeypatch):
        monkeypatch.setattr(history, "LONGEST", 10)
        made = History(seeded(0))
        for seed in range(1, 30):
            made.change(seeded(seed))
        assert seeds(made) == list(range(29, 18, -1))
        for _ in range(40):
            made.redo()
        assert made.state == seeded(29)

    @settings(max_examples=100, deadline=None)
    @given(
        st.lists(
            st.sampled_from(["undo", "redo", "end"])
            | st.tuples(st.integers(0, 3), st.sampled_from([None, "a", "b"])),
            max_size=40,
        )
    )
    def test_undo_and_redo_are_inverse(self, steps):
        made = History(seeded(0))
        for step in steps:
            if isinstance(step, tuple):
                made.change(seeded(step[0]), step[1])
            elif step == "end":
                made.end_gesture()
            else:
                before = made.state
                back = made.redo if step == "undo" else made.undo
                if (made.undo if step == "undo" else made.redo)():
                    assert made.state != before
                    assert back()
                    assert made.state == before
        present = made.state
        count = len(seeds(made)) - 1
        assert made.state == seeded(0)
        assert not made.can_undo
        for _ in range(count):
            assert made.redo()
        assert made.state == present


class TestModel:
    def test_changes_go_through_the_history(self):
        model = Model(INITIAL)
        model.set_part("lamp", azimuth_deg=10.0)
        model.set_look("reference", "drag", sigma_n_deg=1.0)
        model.set_look("reference", "drag", sigma_n_deg=2.0)
        model.set_sample("test", Sample.built_in("uncoated"))
        assert model.state.test.sample.name == "uncoated"
        assert model.history.undo()
        assert model.state.reference.look.sigma_n_deg == 2.0
        assert model.history.undo()
        assert model.state == INITIAL.with_part("lamp", azimuth_deg=10.0)

    def test_failures_are_said_and_change_nothing(self):
        model = Model(INITIAL)
        assert not model.attempt(lambda: model.set_part("lamp", azimuth_deg=1e9))
        assert model.state == INITIAL
        assert not model.history.can_undo
        (note,) = model.notes
        assert note.fault
        assert "lamp.azimuth_deg" in note.text
        assert model.attempt(lambda: model.set_part("lamp", azimuth_deg=1.0))
        assert len(model.notes) == 1
        with pytest.raises(ZeroDivisionError):  # a mistake of the program is not the user's fault
            model.attempt(lambda: 1 / 0)

    def test_notes_are_short_lines_and_not_too_many(self):
        model = Model(INITIAL)
        model.report("two\nlines\x1b[31m" + "x" * 5000)
        (note,) = model.notes
        assert note.text.isprintable()
        assert len(note.text) <= LONGEST_NOTE
        assert not note.fault
        for k in range(200):
            model.report(str(k))
        assert [n.text for n in model.notes] == [str(k) for k in range(200 - NOTES_KEPT, 200)]
