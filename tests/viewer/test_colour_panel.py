"""The colour of a sample in the window, driven by labels: fields, refusals, undo, the way back."""

from __future__ import annotations

import driven
import numpy as np
import pytest

from relgloss_view.material.recolour import Colour, colour_of
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.viewer.state.state import State
from relgloss_view.viewer.state.state_file import load_state, save_state

# --- scripts, run in the window's process ---------------------------------------------------------


def take(hand, lab):
    """What the panel does with a colour of its fields, which are parts without a label."""
    from relgloss_view.viewer.panels import colour_fields

    memory = colour_fields._memory.of(hand.model)["test"]
    hand.do(lambda: colour_fields._take(hand.model, "test", memory, lab))


def colours_change_the_picture(hand, found):
    from relgloss_view.viewer.panels import colour_fields
    from relgloss_view.viewer.state import matching
    from relgloss_view.viewer.state.command_line import snapshot_command

    model = hand.model
    hand.app.layout.focus("Sample")
    hand.frames(4)
    own = model.state.test.sample
    fields = colour_fields._memory.of(model)
    found["own"] = list(fields["test"].lab)
    hand.until(lambda: not model.dragging)
    hand.until(lambda: not hand.app.hold.rest_awaited)
    hand.frames(20)
    compiled = hand.app.pair_renderer.compiled
    for lightness in (30.0, 35.0, 40.0):
        model.hold()
        state = matching.with_colour(model.state, "test", Colour((lightness, 20.0, 10.0)))
        model.change(state, gesture="test colour")
        hand.frames(2)
    found["compiled"] = hand.app.pair_renderer.compiled - compiled
    found["undone at once"] = model.history.undo() and model.state.test.sample == own
    hand.frames(2)
    take(hand, (62.0, *found["own"][1:]))
    hand.frames(3)
    found["typed"] = list(model.state.test.sample.colour.lab)
    found["command"] = snapshot_command(model.state, "test", (64, 64), "a.png")
    take(hand, (99.0, *found["own"][1:]))
    hand.frames(3)
    found["refused"], found["kept"] = fields["test"].fault, list(fields["test"].lab)
    hand.click("//Sample/Original colour")
    hand.frames(3)
    found["back"] = model.state.test.sample == own
    found["no fault"] = fields["test"].fault == ""


SCRIPTS = (colours_change_the_picture,)


# --- what they found ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("colour")
    return driven.drive(__name__, folder, panels=True, size=(1280, 800))


def test_fields_show_and_change_the_colour(found):
    got = found["colours_change_the_picture"]
    own = colour_of(load_sample("matte-coated"))
    np.testing.assert_allclose(got["own"], own, atol=1e-6)
    np.testing.assert_allclose(got["typed"], [62.0, *own[1:]], atol=1e-6)
    assert f"--lab {got['typed'][0]!r}," in got["command"]
    assert "L can be at most" in got["refused"]
    np.testing.assert_allclose(got["kept"], got["typed"])
    assert got["back"]
    assert got["no fault"]


def test_a_drag_compiles_nothing_and_is_one_step(found):
    got = found["colours_change_the_picture"]
    assert got["compiled"] == 0
    assert got["undone at once"]


def test_the_session_keeps_the_colour(tmp_path):
    state = State.initial()
    coloured = state.with_sample("test", state.test.sample.in_colour(Colour((50, 60, 20))))
    save_state(tmp_path / "s.toml", coloured)
    assert load_state(tmp_path / "s.toml") == coloured
    assert load_state(tmp_path / "s.toml") != state
