"""The panel of presets, driven by labels in a window without a display."""

from __future__ import annotations

import driven
import pytest

PANEL = "//Sample"


def names(memory):
    return [preset.name for preset in memory.own]


def presets(hand, found):
    from relgloss_view.viewer.panels import presets as panel
    from relgloss_view.viewer.state.presets import presets_file

    memory, file = panel.memory, presets_file()
    for shown in hand.app.layout.panels:
        shown.visible = shown.title == "Sample"
    hand.app.layout.hidden = False
    hand.frames(3)
    hand.app.layout.focus("Sample")
    hand.frames(4)
    found["unwritten"] = not file.exists()

    hand.model.set_look("test", seed=9, c=0.5, c_fraction=None)
    hand.click(f"{PANEL}/##Published: uncoated")
    look = hand.model.state.test.look
    found["built in"] = [look.sigma_n_deg, look.c, look.c_fraction, look.seed]
    hand.click("//Sample/Reference", f"{PANEL}/##Published: matte-coated")
    found["other side"] = hand.model.state.reference.look.sigma_n_deg
    hand.click("//Sample/Test")

    hand.model.set_look("test", sigma_n_deg=0.7, noise_law="tangent")
    kept = hand.model.state.test.look
    hand.click(f"{PANEL}/Save as preset...")
    hand.type(f"{PANEL}/##name", "art-coated", enter=True)
    found["taken"] = memory.fault
    hand.type(f"{PANEL}/##name", "mine ## 1", enter=True)
    found["added"] = names(memory)
    hand.click(f"{PANEL}/Save as preset...")
    hand.type(f"{PANEL}/##name", "other")
    hand.click(f"{PANEL}/Save")
    hand.model.set_look("test", sigma_n_deg=1.3, noise_law="paper", seed=1)
    hand.click(f"{PANEL}/other/##apply")
    found["applied"] = hand.model.state.test.look == kept
    hand.model.history.undo()
    found["undone"] = hand.model.state.test.look.seed

    hand.click(f"{PANEL}/other/Rename")
    hand.type(f"{PANEL}/other/##name", "third", enter=True)
    found["renamed"] = names(memory)
    hand.click(f"{PANEL}/third/Delete", f"{PANEL}/third/Keep")
    found["kept"] = names(memory)
    hand.click(f"{PANEL}/third/Delete", f"{PANEL}/third/Delete")
    found["deleted"] = names(memory)
    hand.click(f"{PANEL}/Save as preset...", f"{PANEL}/Cancel")
    found["file"] = file.read_text(encoding="utf-8")

    file.write_text("[broken", encoding="utf-8")
    hand.click(f"{PANEL}/Save as preset...")
    hand.type(f"{PANEL}/##name", "lost", enter=True)
    found["damaged"] = memory.fault
    found["held"] = file.read_text(encoding="utf-8")
    found["still"] = names(memory)
    panel.memory = panel.Memory()  # as at the next start
    hand.frames(3)
    found["at the start"] = [panel.memory.fault, names(panel.memory)]


SCRIPTS = (presets,)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return driven.drive("test_presets_panel", tmp_path_factory.mktemp("p"), size=[760, 620])[
        "presets"
    ]


def test_published_optima_set_two_entries_of_the_active_side(found):
    assert found["unwritten"]
    assert found["built in"] == [2.0, None, pytest.approx(1 / 6), 9]
    assert found["other side"] == 2.0


def test_a_preset_is_the_whole_look(found):
    assert found["added"] == ["mine ## 1"]
    assert found["applied"]
    assert found["undone"] == 1  # one step


def test_presets_are_renamed_and_deleted_when_confirmed(found):
    assert found["renamed"] == ["mine ## 1", "third"]
    assert found["kept"] == found["renamed"]
    assert found["deleted"] == ["mine ## 1"]
    assert "mine ## 1" in found["file"]
    assert "tangent" in found["file"]
    assert "third" not in found["file"]


def test_a_name_that_is_taken_is_told(found):
    assert "built-in" in found["taken"]
    assert "\n" not in found["taken"]


def test_a_damaged_file_is_told_and_stays(found):
    assert "presets.toml" in found["damaged"]
    assert found["held"] == "[broken"
    assert found["still"] == ["mine ## 1"]
    fault, own = found["at the start"]
    assert "presets.toml" in fault
    assert own == []
