"""The legends of overlays: each has words, and those of the marks have what the shader draws."""

from __future__ import annotations

import re
from types import SimpleNamespace

import pytest

from relgloss_view.base.resources import data_root
from relgloss_view.picture.gpu import constants
from relgloss_view.viewer.panels import overlay_legend
from relgloss_view.viewer.panels.overlay_legend import MEANINGS, words

FRAME = SimpleNamespace(clip_count=0, out_of_gamut_count=1)


def test_every_overlay_has_words_the_longest_first():
    assert set(MEANINGS) == set(constants.OVERLAYS)
    for texts in MEANINGS.values():
        assert [len(text) for text in texts] == sorted((len(t) for t in texts), reverse=True)
    assert len({texts[0] for texts in MEANINGS.values()}) == len(MEANINGS)


@pytest.mark.parametrize("name", ["STRIPE_PX", "DOT_STEP_PX", "DOT_PX", "LINE_STEP_PX", "LINE_PX"])
def test_patterns_are_the_shaders(name):
    text = (data_root() / "shaders" / "overlay.frag").read_text(encoding="utf-8")
    (value,) = re.findall(rf"const int {name} = (\d+);", text)
    assert getattr(overlay_legend, name) == int(value)


def test_marks_are_counted_and_others_are_not():
    assert words("clipped", FRAME)[0].endswith("cut there; no pixel")
    assert words("out of gamut", FRAME)[0].endswith("can't show; 1 pixel")
    assert words("out of gamut", FRAME)[-1] == "Out of gamut"  # where there is no room
    assert words("normals", FRAME) == MEANINGS["normals"]
    assert words("clipped", None) == MEANINGS["clipped"]
