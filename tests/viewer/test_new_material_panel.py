"""The window "New material", driven by keys and labels: the picture follows, undo, cancel, keep."""

from __future__ import annotations

import driven
import pytest

WINDOW = "//New material"

# --- scripts, run in the window's process ---------------------------------------------------------


def readings_are_typed(hand, found):
    from imgui_bundle import imgui

    app, model = hand.app, hand.model
    making = app.files.new_material
    before = model.state
    hand.key(imgui.Key.mod_ctrl.value + imgui.Key.n.value)
    hand.until(lambda: making.active)
    hand.until(lambda: not app.hold.rest_awaited)
    hand.frames(30)
    compiled = app.pair_renderer.compiled
    hand.ctx.key_chars("12")  # the first field has the keyboard
    found["first field"] = hand.until(lambda: making.complete)
    hand.type(f"{WINDOW}/##gloss 60", "45")
    hand.until(lambda: making.complete)
    hand.frames(3)
    found["readings"] = list(making.typed.gloss)
    found["drawn"] = model.frames["test"].scene.material.marks
    found["ghosts"] = {name: ghost.texture for name, ghost in model.ghosts.items()}
    found["peaks"] = [float(g.lightness.y_specular.max()) for g in model.ghosts.values()]
    found["compiled"] = app.pair_renderer.compiled - compiled
    model.history.undo()
    hand.frames(3)
    found["undone"] = model.state == before
    found["ghosts of none"] = len(model.ghosts)
    hand.click(f"{WINDOW}/x##clear 20")
    hand.until(lambda: making.complete)
    found["cleared"] = list(making.typed.gloss)
    hand.ctx.item_click(f"{WINDOW}/##Measured at")
    hand.key(imgui.Key.escape)  # closes the list alone
    found["open after a list"] = making.active
    hand.click(f"{WINDOW}/Cancel")
    found["cancelled"] = [model.state == before, making.active, model.history.can_undo]
    (hand.folder / "gray.csv").write_text(
        "nm,reflectance\n" + "\n".join(f"{w},0.3" for w in range(400, 701, 10)), encoding="utf-8"
    )
    app.files.make_material()
    hand.frames(3)
    app.dropped([str(hand.folder / "gray.csv")])
    hand.type(f"{WINDOW}/##gloss 60", "45")
    found["with spectrum"] = hand.until(
        lambda: making.complete and making.typed.spectrum is not None
    )
    hand.click(f"{WINDOW}/Keep")
    hand.frames(3)
    sample = model.state.test.sample
    found["kept"] = [sample.file is not None, making.active, sample.material.source]
    found["said"] = hand.said()


SCRIPTS = (readings_are_typed,)


# --- what they found ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def got(tmp_path_factory):
    return driven.drive(__name__, tmp_path_factory.mktemp("new"))["readings_are_typed"]


def test_the_picture_follows_and_undo_restores_it(got):
    assert got["first field"]
    assert got["readings"] == ["12", "45", "", ""]
    assert got["drawn"] == "estimated"
    assert got["undone"]
    assert got["cleared"] == ["", "45", "", ""]
    assert got["open after a list"]
    assert got["cancelled"] == [True, False, False]
    assert [fault for _, fault in got["said"]] == [False] * len(got["said"])


def test_ghosts_are_drawn_and_nothing_is_compiled(got):
    assert list(got["ghosts"]) == ["dullest", "glossiest"]
    assert len(set(got["ghosts"].values())) == 2
    assert got["peaks"][0] < got["peaks"][1]
    assert got["ghosts of none"] == 0
    assert got["compiled"] == 0


def test_a_dropped_spectrum_is_the_colour_and_keep_writes_a_file(got):
    assert got["with spectrum"]
    assert got["kept"][:2] == [True, False]
    assert "the spectrum gray" in got["kept"][2]
