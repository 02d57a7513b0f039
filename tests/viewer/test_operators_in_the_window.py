"""Operators in the window: worked out at rest, shown, exported and copied as commands alike."""

from __future__ import annotations

import json
import os
import shlex
import time

import driven
import numpy as np
import pytest
from pictures import assert_same_pixels
from PIL import Image

from relgloss_view import cli
from relgloss_view.viewer.state.state import State

LOOK = "//Look"


# --- scripts, run in the window's process ---------------------------------------------------------


def settled(hand, side="test"):
    """Wait for an operator's picture."""

    def there():
        time.sleep(0.01)
        return hand.model.displayed(side) is not None

    return hand.until(there)


def pane(hand, side="test"):
    """What the pane shows of a side, (H, W, 3)."""
    taken = []
    hand.model.take_view = taken.append
    assert hand.until(lambda: bool(taken))
    rects = hand.app.drawn_pane.arrangement.rects
    left, top, width, height = rects[side]
    return taken[0][top : top + height, left : left + width]


def shows_an_operator(hand, found):
    hand.frames(4)
    found["told at first"] = dict(hand.model.operator_pictures)
    np.save(hand.folder / "split.npy", pane(hand))
    hand.choose(f"{LOOK}/##Tone mapping (operator)", "clip")
    found["chosen"] = hand.model.state.presentation.test_operator
    assert settled(hand)
    hand.frames(2)
    np.save(hand.folder / "clip.npy", pane(hand))
    np.save(hand.folder / "clip-digital.npy", hand.model.displayed("test").digital)
    found["reference"] = hand.model.displayed("reference") is None
    found["size"] = hand.model.picture_size
    hand.app.files.copy_command()
    from imgui_bundle import imgui

    found["copied"] = imgui.get_clipboard_text()
    before = sum(hand.app.pair_renderer.drawn["test"].values())
    hand.frames(10)
    found["drawn at rest"] = sum(hand.app.pair_renderer.drawn["test"].values()) - before


def is_exported(hand, found):
    from relgloss_view.viewer.files.picture_export import ExportRequest, write

    model = hand.model

    def save(picture, kind, name, size=None):
        return hand.do(
            lambda: write(model, ExportRequest(picture, kind, str(hand.folder / name), size))
        )

    found["told"] = save("test", "PNG, 8 bits", "test.png")
    save("test", "OpenEXR", "test.exr")
    save("test", "PNG, 16 bits", "other.png", (90, 70))
    save("both", "PNG, 8 bits", "both.png")


def stays_while_c_moves_and_waits_for_the_hand(hand, found):
    model = hand.model
    shown = model.displayed("test")
    model.set_look("test", c=None, c_fraction=0.1)
    hand.frames(3)
    found["same while c changes"] = model.displayed("test") is shown
    model.set_look("test", sigma_n_deg=0.3)
    model.hold()
    hand.frames(2)
    found["while dragging"] = model.operator_pictures["test"].reason
    pictures = {}
    for k in range(3):  # as a hand would, longer than the work takes
        model.hold()
        hand.frames(2)
        pictures[k] = model.displayed("test")
    found["none while dragging"] = all(p is None for p in pictures.values())
    assert settled(hand)
    found["again at rest"] = model.displayed("test").operator
    model.set_part("presentation", overlay="clipped")
    hand.frames(2)
    found["overlay"] = model.operator_pictures["test"].reason
    model.set_part("presentation", overlay="none", compare="difference")
    hand.frames(2)
    found["difference"] = model.operator_pictures["test"].reason
    model.set_part("presentation", compare="side by side")


def swaps_with_the_sides_and_is_undone(hand, found):
    from relgloss_view.viewer.shell.actions import ACTIONS

    next(action for action in ACTIONS if action.text == "Swap sides").run(hand.app)
    hand.frames(2)
    presentation = hand.model.state.presentation
    found["swapped"] = [presentation.reference_operator, presentation.test_operator]
    assert settled(hand, "reference")
    hand.model.history.undo()
    hand.frames(2)
    presentation = hand.model.state.presentation
    found["undone"] = [presentation.reference_operator, presentation.test_operator]


def a_lost_device_changes_nothing(hand, found):
    assert settled(hand)
    hand.frames(2)
    before = pane(hand)
    hand.do(hand.app.rebuild)
    hand.frames(3)
    assert settled(hand)
    hand.frames(2)
    found["same after loss"] = bool(np.array_equal(pane(hand), before))


def every_operator(hand, found):
    for name in ("multiscale", "neutral", "tumblin-rushmeier", "ward", "schlick", "ward-histogram"):
        hand.model.set_part("presentation", test_operator=name, reference_operator="neutral")
        hand.frames(1)
        assert hand.until(
            lambda name=name: (
                time.sleep(0.01) or getattr(hand.model.displayed("test"), "operator", None) == name
            )
        )
        found[name] = hand.model.displayed("test").operator
    hand.model.set_part("presentation", test_operator="multiscale", reference_operator="clip")
    hand.frames(1)
    assert settled(hand)
    assert settled(hand, "reference")
    hand.frames(4)


SCRIPTS = (
    shows_an_operator,
    is_exported,
    stays_while_c_moves_and_waits_for_the_hand,
    swaps_with_the_sides_and_is_undone,
    a_lost_device_changes_nothing,
    every_operator,
)


# --- what they found ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def window(tmp_path_factory):
    folder = tmp_path_factory.mktemp("operators")
    return driven.drive(__name__, folder, panels=True, size=(1000, 700)), folder


def drawn_again(command, folder, name):
    """The pixels that a command draws."""
    words = shlex.split(command)
    words[words.index("-o") + 1] = os.fspath(folder / name)
    assert cli.main(words[1:]) == 0
    with Image.open(folder / name) as picture:
        return np.asarray(picture)


def test_the_pane_shows_its_picture_pixel_by_pixel(window):
    found, folder = window
    shown = found["shows_an_operator"]
    assert shown["told at first"] == {}
    assert shown["chosen"] == "clip"
    assert shown["reference"]
    pane, split = np.load(folder / "clip.npy"), np.load(folder / "split.npy")
    digital = np.load(folder / "clip-digital.npy")
    rows = slice(pane.shape[0] // 4, pane.shape[0])  # above stand the captions
    assert_same_pixels(pane[rows], digital[rows])
    assert not np.array_equal(pane[rows], split[rows])
    assert shown["drawn at rest"] == 0


def test_the_copied_command_draws_it(window):
    found, folder = window
    command = found["shows_an_operator"]["copied"]
    assert "--operator clip" in command
    digital = np.load(folder / "clip-digital.npy")
    assert_same_pixels(drawn_again(command, folder, "copied.png"), digital)


def test_exports_are_of_the_operator(window):
    _, folder = window
    digital = np.load(folder / "clip-digital.npy")
    with Image.open(folder / "test.png") as picture:
        assert_same_pixels(np.asarray(picture), digital)
        numbers = json.loads(picture.info["Parameters"])
        command = picture.info["Command"]
    assert numbers["operator"] == "clip"
    assert_same_pixels(drawn_again(command, folder, "again.png"), digital)
    with Image.open(folder / "both.png") as picture:
        both = json.loads(picture.info["Parameters"])
        right = np.asarray(picture)[:, -digital.shape[1] :]
    assert (both["reference"]["operator"], both["test"]["operator"]) == ("split", "clip")
    assert_same_pixels(right, digital)
    OpenEXR = pytest.importorskip("OpenEXR")
    with OpenEXR.File(str(folder / "test.exr"), separate_channels=True) as file:
        assert dict(file.header())["operator"] == "clip"


def test_at_another_size_too(window):
    _, folder = window
    with Image.open(folder / "other.png") as picture:
        assert picture.size == (90, 70)
        assert json.loads(picture.info["Parameters"])["operator"] == "clip"


def test_it_waits_for_the_hand_and_says_what_shows(window):
    found, _ = window
    told = found["stays_while_c_moves_and_waits_for_the_hand"]
    assert told["same while c changes"]
    assert told["while dragging"] == "follows when you let go"
    assert told["none while dragging"]
    assert told["again at rest"] == "clip"
    assert "overlays" in told["overlay"]
    assert "overlays" in told["difference"]


def test_it_goes_with_its_side(window):
    found, _ = window
    assert found["swaps_with_the_sides_and_is_undone"] == {
        "swapped": ["clip", "split"],
        "undone": ["split", "clip"],
    }
    assert found["a_lost_device_changes_nothing"]["same after loss"]
    assert set(found["every_operator"]) == {
        "multiscale", "neutral", "tumblin-rushmeier", "ward", "schlick", "ward-histogram",
    }  # fmt: skip


def test_it_is_kept_with_the_session(tmp_path):
    from relgloss_view.viewer.state.state_file import load_state, save_state

    state = State.initial().with_part("presentation", reference_operator="ward")
    save_state(tmp_path / "s.toml", state)
    assert load_state(tmp_path / "s.toml").presentation == state.presentation
