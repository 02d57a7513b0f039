"""The lamp turned to the highlight in the window: by form, key, button; edges while it turns."""

from __future__ import annotations

import driven
import pytest

SCENE = "//Scene"
BUTTON = "//##status/Turn the lamp to the highlight"


# --- scripts, run in the window's process ---------------------------------------------------------


def lacks_gloss(hand):
    hand.frames(2)
    return [hand.model.frames[side].lacks_gloss for side in ("reference", "test")]


def another_form_is_lit(hand, found):
    hand.app.layout.focus("Scene")
    hand.frames(4)
    before = hand.model.state
    hand.choose(f"{SCENE}/##Form", "box")
    hand.frames(3)
    found["form"] = hand.model.state.setup.shape.kind
    found["turned"] = hand.model.state.setup.lamp != before.setup.lamp
    found["lacks"] = lacks_gloss(hand)
    hand.model.history.undo()
    found["undone"] = hand.model.state == before


def the_button_mends_a_view(hand, found):
    found["before"] = hand.there(BUTTON)
    hand.model.set_part("lamp", azimuth_deg=175.0)
    hand.frames(3)
    found["lacks"] = lacks_gloss(hand)
    found["there"] = hand.there(BUTTON)
    dark = hand.model.state
    hand.click(BUTTON)
    found["mended"] = lacks_gloss(hand)
    found["after"] = hand.there(BUTTON)
    hand.model.history.undo()
    found["one step"] = hand.model.state == dark


def a_key_does_too(hand, found):
    from imgui_bundle import imgui

    hand.model.set_part("lamp", azimuth_deg=-170.0)
    hand.frames(2)
    hand.key(imgui.Key.g)
    found["lacks"] = lacks_gloss(hand)
    hand.key(imgui.Key.g)
    found["said"] = hand.said()[-1][0]


def edges_wait_while_the_view_turns(hand, found):
    import dataclasses

    from relgloss_view.viewer.drawing.arrangement import arranged

    pair, model = hand.app.pair_renderer, hand.model
    arrangement = arranged((300, 200), model.state.presentation, largest=pair.largest)

    def draw(state, *, moving):
        pictures = pair.draw(state, arrangement, 1.0, None, moving=moving).pictures
        return pictures["test"].frame.scene.display.edges

    def run():
        eye = dataclasses.replace(model.state.setup.eye, azimuth_deg=10.0)
        turned = model.state.placed(eye=eye)
        return [
            draw(model.state, moving=False),
            draw(model.state.with_look("test", c=0.1, c_fraction=None), moving=True),
            draw(turned, moving=True),
            draw(turned, moving=False),
        ]

    found["edges"] = hand.do(run)


SCRIPTS = [
    another_form_is_lit,
    the_button_mends_a_view,
    a_key_does_too,
    edges_wait_while_the_view_turns,
]


# --- tests ----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("highlight")
    return driven.drive("test_highlight_in_the_window", folder, panels=True, size=(1280, 800))


def test_another_form_shows_its_highlight_in_one_step(found):
    assert found["another_form_is_lit"] == {
        "form": "box",
        "turned": True,
        "lacks": [False, False],
        "undone": True,
    }


def test_a_view_without_gloss_has_a_button(found):
    """And a view with gloss has none."""
    assert found["the_button_mends_a_view"] == {
        "before": False,
        "lacks": [True, True],
        "there": True,
        "mended": [False, False],
        "after": False,
        "one step": True,
    }


def test_the_key_turns_the_lamp_once(found):
    keyed = found["a_key_does_too"]
    assert keyed["lacks"] == [False, False]
    assert "lies well" in keyed["said"]


def test_edges_are_smooth_at_rest_and_under_a_slider(found):
    edges = found["edges_wait_while_the_view_turns"]["edges"]
    assert edges == ["smooth", "smooth", "sampled", "smooth"]
