"""The panels of the first start, and that a layout that a user has saved stays as it was."""

from __future__ import annotations

import contextlib
from pathlib import Path

import driven
import pytest

FIRST = ["Sample", "Look", "Gloss", "Scene"]
PLOTS = ["Lightness", "Reflection", "Fit", "Pixel"]

#: What a version before this layout kept of a window of 1280 x 800.
BEFORE = """[Window][Look]
Pos=905,21
Size=375,752
Collapsed=0
DockId=0x00000002,0

[Window][Scene]
Pos=905,21
Size=375,752
Collapsed=0
DockId=0x00000002,1

[Window][Sample]
Pos=905,21
Size=375,752
Collapsed=0
DockId=0x00000002,2

[Window][Lightness]
Pos=0,504
Size=540,269
Collapsed=0
DockId=0x00000005,0

[Window][Reflection]
Pos=0,504
Size=540,269
Collapsed=0
DockId=0x00000005,1

[Window][Fit]
Pos=0,504
Size=540,269
Collapsed=0
DockId=0x00000005,2

[Window][Gloss]
Pos=0,504
Size=540,269
Collapsed=0
DockId=0x00000005,3

[Window][Pixel]
Pos=542,504
Size=361,269
Collapsed=0
DockId=0x00000006,0

[Docking][Data]
DockSpace       ID=0x9CE789DB Window=0x94EC4A46 Pos=0,21 Size=1280,752 Split=X
  DockNode      ID=0x00000001 Parent=0x9CE789DB SizeRef=903,752 Split=Y
    DockNode    ID=0x00000003 Parent=0x00000001 SizeRef=903,481 CentralNode=1
    DockNode    ID=0x00000004 Parent=0x00000001 SizeRef=903,269 Split=X
      DockNode  ID=0x00000005 Parent=0x00000004 SizeRef=540,269 Selected=0xE66AC9C4
      DockNode  ID=0x00000006 Parent=0x00000004 SizeRef=361,269 Selected=0x99B41A86
  DockNode      ID=0x00000002 Parent=0x9CE789DB SizeRef=375,752 Selected=0xFDD30C99
"""


@contextlib.contextmanager
def opened(folder, run):
    from relgloss_view.viewer.shell.app import App
    from relgloss_view.viewer.state.layout_file import load_layout
    from relgloss_view.viewer.state.state import State

    app = App(State.initial())
    path = Path(run["layout"])
    app.keep_layout(path, load_layout(path))
    yield app


def places(hand):
    """Where the panels that show are: left, top, width, height; hidden tabs are not."""
    got = {}
    for panel in hand.app.layout.panels:
        window = hand.ctx.window_info(f"//{panel.title}").window if panel.visible else None
        if window is not None and window.active and not window.hidden:
            got[panel.title] = [window.pos.x, window.pos.y, window.size.x, window.size.y]
    return got


def looks(hand, found):
    hand.frames(6)
    found["visible"] = [p.title for p in hand.app.layout.panels if p.visible]
    found["places"] = places(hand)
    found["picture"] = list(hand.model.picture_size)
    hand.app.save_layout()


def opens_a_plot(hand, found):
    hand.frames(4)
    hand.app.layout.focus("Lightness")
    hand.frames(6)
    found["places"] = places(hand)
    hand.app.layout.reset()
    hand.frames(6)
    found["again"] = [p.title for p in hand.app.layout.panels if p.visible]


def opens_a_pack(hand, found):
    hand.frames(4)
    hand.model.wanted_panel = "Pack"
    hand.frames(6)
    found["places"] = places(hand)


SCRIPTS = (looks, opens_a_plot, opens_a_pack)


def run(folder, layout, scripts, size=(1280, 800)):
    folder.mkdir()
    return driven.drive("test_first_layout", folder, size=size, layout=str(layout), scripts=scripts)


@pytest.mark.parametrize("size", [(1280, 800), (1920, 1080)])
def test_sample_above_gloss_above_light_and_no_plots(tmp_path, size):
    got = run(tmp_path / "one", tmp_path / "window.toml", ["looks"], size)["looks"]
    assert got["visible"] == FIRST
    at = got["places"]
    assert at["Sample"][1] < at["Look"][1]
    if size[1] > 1000:  # room for three parts
        assert at["Look"][1] < at["Scene"][1]
    assert all(left > 0.6 * size[0] for left, *_ in at.values())
    assert got["picture"][1] > 0.9 * size[1]  # no strip of plots below


@pytest.mark.slow
def test_what_is_kept_comes_back_and_a_plot_finds_its_place(tmp_path):
    layout = tmp_path / "window.toml"
    first = run(tmp_path / "one", layout, ["looks"])["looks"]
    assert layout.exists()
    got = run(tmp_path / "two", layout, ["looks", "opens_a_plot"])
    assert got["looks"] == first
    left, top, width, _ = got["opens_a_plot"]["places"]["Lightness"]
    assert left == 0.0
    assert top > 400.0
    assert width > 500.0
    assert got["opens_a_plot"]["again"] == FIRST


@pytest.mark.slow
def test_a_layout_from_before_stays_as_it_was(tmp_path):
    from relgloss_view.viewer.state.layout_file import WindowLayout, save_layout

    layout = tmp_path / "window.toml"
    save_layout(layout, WindowLayout(closed=("Fit",), docking=BEFORE))
    got = run(tmp_path / "one", layout, ["looks"])["looks"]
    assert sorted(got["visible"]) == sorted(set(FIRST + PLOTS) - {"Fit"})
    assert got["places"]["Look"] == [905.0, 21.0, 375.0, 752.0]
    assert got["places"]["Lightness"] == [0.0, 504.0, 540.0, 269.0]
    assert got["places"]["Pixel"] == [542.0, 504.0, 361.0, 269.0]


def test_a_panel_newer_than_the_kept_layout_goes_beside_its_neighbours(tmp_path):
    from relgloss_view.viewer.state.layout_file import WindowLayout, save_layout

    layout = tmp_path / "window.toml"
    save_layout(layout, WindowLayout(closed=("Fit",), docking=BEFORE))
    got = run(tmp_path / "one", layout, ["opens_a_pack"])["opens_a_pack"]
    assert got["places"]["Pack"] == [905.0, 21.0, 375.0, 752.0]
    assert "Sample" not in got["places"]  # a tab behind it now
