"""Labels of the window: declared once, a plain word first, one a control; the drawing in words."""

from __future__ import annotations

import dataclasses
import re

import pytest

from relgloss_view.display.display import Display
from relgloss_view.pack.shape import SIZES, Shape
from relgloss_view.picture.method import EXACT, Method
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.setup import Eye, Lamp
from relgloss_view.quality.planner import SAVINGS
from relgloss_view.viewer.panels import display, drawing_words, scene
from relgloss_view.viewer.shell.widgets import label_of
from relgloss_view.viewer.state.state import Presentation

#: A word with a capital, and behind it more words and perhaps a symbol in brackets.
PLAIN = re.compile(r"[A-Z][a-z]{2,}[A-Za-z -]*( \([^()]+\))?")
LOOK = tuple(f.name for f in dataclasses.fields(Look))
SCENE = {
    Lamp: (*scene._LAMP, "illuminant", "y_n"),
    Shape: ("kind", *SIZES["box"], "diameter_m"),
    Eye: tuple(scene._EYE),
    Display: ("profile", *display.OF_DISPLAY, *display.SURROUND, "gamut", "edges", "dither"),
    Presentation: ("screen", *display.SEEN_ON, *display.PRESENTATION),
}


@pytest.mark.parametrize("label", ["σN", "c / c_max", "seed", "dE2000 top", "white Yn", ""])
def test_a_symbol_alone_is_no_label(label):
    assert not PLAIN.fullmatch(label)


def test_every_control_has_a_plain_label():
    owners = {Look: LOOK, **SCENE}
    owners[Presentation] = tuple(f.name for f in dataclasses.fields(Presentation))
    labels = [label_of(owner, name) for owner, names in owners.items() for name in names]
    assert [label for label in labels if not PLAIN.fullmatch(label)] == []
    assert len(labels) > 35


def test_controls_of_a_panel_have_different_labels():
    """A label is the control's id, too."""
    in_the_scene = [label_of(owner, name) for owner, names in SCENE.items() for name in names]
    assert len(set(in_the_scene)) == len(in_the_scene)
    in_the_look = [
        label_of(Look, name) for name in LOOK if name not in ("grain_mm", "grain_arcmin")
    ]
    assert len(set(in_the_look)) == len(in_the_look)  # the grain has one size at a time


def test_all_that_auto_may_choose_has_words():
    exact = dataclasses.asdict(EXACT)
    simpler = {
        (stage, name) for stage, names in SAVINGS.items() for name in names if name != exact[stage]
    }
    assert simpler
    assert simpler - drawing_words._WORDS.keys() == set()


def test_words_of_a_method():
    assert drawing_words.drawing_words(EXACT) == "Drawn with the whole model"
    words = drawing_words.drawing_words(Method(noise="mean", lobes=1))
    assert words == "Drawn simpler: one specular lobe, the mean of the grain"
    assert drawing_words.drawing_words(Method(facets="ggx")) == "Drawn simpler: facets ggx"
