"""What pictures are drawn for: this monitor, the scene's display, or as another one shows it."""

from __future__ import annotations

import dataclasses
import os
from types import SimpleNamespace

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.commands import view
from relgloss_view.display.display import Display
from relgloss_view.display.icc_writing import profile_of
from relgloss_view.display.system.answer import Answer, SystemProfile
from relgloss_view.viewer.files import monitor_profile
from relgloss_view.viewer.files.display_files import (
    PROFILE,
    check_display,
    is_display_file,
    with_display,
)
from relgloss_view.viewer.files.monitor_profile import KEPT, kept, screen_of
from relgloss_view.viewer.files.open_job import OpenJob
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.screens import (
    Screen,
    calibration_is_loaded,
    for_screen,
    screen_words,
)
from relgloss_view.viewer.state.state import AS_DECLARED, THIS_MONITOR, State
from relgloss_view.viewer.state.state_file import load_state, save_state

OTHER = profile_of(Display(transfer="gain-offset-gamma", gamma=1.8))
STATE = State.initial()


@pytest.fixture(autouse=True)
def _home(tmp_path, monkeypatch):
    monkeypatch.setenv("RELGLOSS_HOME", str(tmp_path / "home"))


@pytest.fixture
def profile(tmp_path):
    file = tmp_path / "other.icc"
    file.write_bytes(OTHER)
    return str(file)


def on_monitor(data=OTHER):
    return screen_of(Answer(SystemProfile(data, "", "the X property _ICC_PROFILE")))


def test_without_a_profile_the_scenes_own_display_is_drawn():
    assert for_screen(STATE, Screen()) is STATE
    assert Model(STATE).on_screen is STATE
    assert screen_words(STATE, Screen())[0] == "sRGB assumed: the system names no profile"


def test_the_systems_profile_is_drawn_for_unless_the_scenes_is_chosen():
    screen = on_monitor()
    shown = for_screen(STATE, screen)
    assert shown.setup.display == dataclasses.replace(STATE.setup.display, profile=screen.file)
    assert shown.with_part("display", profile="") == STATE  # and nothing else is another
    assert "assumed" not in screen_words(STATE, screen)[0]
    declared = STATE.with_part("presentation", screen=AS_DECLARED)
    assert for_screen(declared, screen) is declared
    assert "as the scene declares" in screen_words(declared, screen)[0]


def test_the_state_of_files_and_of_undo_never_has_the_systems_profile(tmp_path):
    model = Model(STATE)
    model.screen = on_monitor()
    assert model.on_screen.setup.display.profile
    assert model.on_screen is model.on_screen
    model.set_part("display", luminance_cd_m2=160.0)
    assert model.on_screen.setup.display.luminance_cd_m2 == 160.0
    save_state(tmp_path / "scene.toml", model.state)
    assert "monitor-" not in (tmp_path / "scene.toml").read_text()
    assert "screen" not in (tmp_path / "scene.toml").read_text()  # old versions open it


@pytest.mark.parametrize("data", [b"", b"x" * 500, OTHER[:150], OTHER[:400], b"\0" * 100_000])
def test_a_broken_profile_is_a_reason_and_no_more(data):
    screen = on_monitor(data)
    assert screen.file == ""
    assert screen.fault
    assert "\n" not in screen.reason
    assert for_screen(STATE, screen) is STATE


def test_profiles_are_kept_whole_and_old_ones_go(tmp_path):
    files = [kept(bytes([k]) * 200, tmp_path) for k in range(KEPT + 3)]
    for age, file in enumerate(reversed(files)):
        if file.exists():
            os.utime(file, (1e9 - age, 1e9 - age))
    last = kept(b"new" * 100, tmp_path)
    left = set(tmp_path.glob("*"))
    assert last in left
    assert len(left) == KEPT
    assert last.read_bytes() == b"new" * 100
    assert kept(b"new" * 100, tmp_path) == last
    last.write_bytes(b"cut")  # as a full disk leaves it
    assert kept(b"new" * 100, tmp_path).read_bytes() == b"new" * 100


def test_without_a_state_folder_there_is_a_reason(monkeypatch):
    def nowhere():
        raise InputError("there is no home folder for settings")

    monkeypatch.setattr(monitor_profile, "state_folder", nowhere)
    screen = on_monitor()
    assert screen.fault
    assert "no home folder" in screen.reason


def test_a_side_is_seen_on_another_display_and_files_keep_that(tmp_path, profile):
    state = with_display(STATE, "test_seen_on", profile)
    assert state.scene("test").display.seen_on == profile
    assert state.scene("reference").display.seen_on == ""
    save_state(tmp_path / "scene.toml", state)
    assert 'test_seen_on = "other.icc"' in (tmp_path / "scene.toml").read_text()
    assert 'seen_on = "other.icc"' in (tmp_path / "scene.toml").read_text()  # of the file's picture
    assert load_state(tmp_path / "scene.toml") == state
    both = with_display(state, "reference_seen_on", profile)
    save_state(tmp_path / "both.toml", both)
    assert load_state(tmp_path / "both.toml") == both


def test_a_scene_file_is_seen_on_its_display_on_both_sides(tmp_path, profile):
    save_state(tmp_path / "scene.toml", STATE.with_part("display", luminance_cd_m2=90.0))
    text = (tmp_path / "scene.toml").read_text()
    changed = text.replace(
        "luminance_cd_m2 = 90.0", 'luminance_cd_m2 = 90.0\nseen_on = "other.icc"'
    )
    assert changed != text
    (tmp_path / "scene.toml").write_text(changed)
    state = load_state(tmp_path / "scene.toml")
    assert {state.scene(side).display.seen_on for side in ("test", "reference")} == {profile}
    (tmp_path / "other.icc").write_bytes(b"no longer a profile")
    messages = []
    assert load_state(tmp_path / "scene.toml", messages).scene("test").display.seen_on == ""
    assert len(messages) == 1


def test_a_file_that_is_damaged_later_is_drawn_without(tmp_path, profile):
    state = with_display(with_display(STATE, PROFILE, profile), "test_seen_on", profile)
    model = Model(state)
    model.check_displays()
    assert model.on_screen is state
    (tmp_path / "other.icc").write_bytes(b"no longer a profile")
    for _ in range(3):
        model.check_displays()
    assert model.on_screen.setup.display.profile == ""
    assert model.display_of("test").seen_on == ""
    assert model.state is state
    assert len(model.notes) == 1
    (tmp_path / "other.icc").write_bytes(OTHER)
    model.check_displays()
    assert model.on_screen is state


def test_a_profile_opens_as_the_scenes_display(tmp_path, profile):
    (tmp_path / "scene.toml").write_text("[look]\n")
    assert is_display_file(profile)
    assert not is_display_file(tmp_path / "scene.toml")
    assert not is_display_file(tmp_path / "none")
    check_display(profile)
    job = OpenJob(profile, lambda: None)
    assert job.wait(60.0)
    opened = job.result.applied(STATE, "test")
    assert opened.setup.display.profile == profile
    assert opened.presentation.screen == AS_DECLARED
    assert with_display(opened, PROFILE, "").setup.display.profile == ""
    assert STATE.presentation.screen == THIS_MONITOR


def test_the_command_opens_a_display_beside_a_scene(tmp_path, profile):
    save_state(tmp_path / "scene.toml", STATE)
    opened = view._opened([profile, str(tmp_path / "scene.toml")])
    app = SimpleNamespace(model=Model(STATE), files=SimpleNamespace(scene_path=None))
    view._show(app, opened, None, {})
    assert app.model.state == with_display(STATE, PROFILE, profile)
    with pytest.raises(InputError, match="2 displays given"):
        view._opened([profile, profile])


def test_a_calibration_that_is_not_loaded_is_noticed():
    """A card of 1024 entries of 10 bits holds a table of 256; a straight line does not."""
    wanted = np.linspace(0.0, 1.0, 256) ** np.array([[0.9], [1.0], [1.2]])
    fine = np.linspace(0.0, 1.0, 1024) ** np.array([[0.9], [1.0], [1.2]])
    loaded = np.round(fine * 1023.0) / 1023.0
    assert calibration_is_loaded(wanted, loaded)
    assert not calibration_is_loaded(wanted, np.tile(np.linspace(0.0, 1.0, 1024), (3, 1)))
