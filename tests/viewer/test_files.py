"""The desk where files come in and go out, without a window."""

from __future__ import annotations

import dataclasses
import time

import materials
import pytest
from driven import FakeJob

from relgloss_view.base.resources import asset
from relgloss_view.material.files import load_material, save_material
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.viewer.files.open_job import Opened
from relgloss_view.viewer.shell import file_actions as files
from relgloss_view.viewer.shell.file_actions import FileActions
from relgloss_view.viewer.state.matching import with_sample
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.session import Autosave
from relgloss_view.viewer.state.state import State
from relgloss_view.viewer.state.state_file import load_state, save_state

LIMIT_S = 60.0


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("RELGLOSS_HOME", str(tmp_path / "home"))
    monkeypatch.setenv("RELGLOSS_DIALOG", "own")


@pytest.fixture
def desk():
    made = FileActions(Model(State.initial()), lambda: None)
    yield made
    made.close()


def pump(desk):
    """Frames until nothing is under way."""
    end = time.monotonic() + LIMIT_S
    while True:
        desk.each_frame()
        if desk.due_s() is None:
            return
        assert time.monotonic() < end
        time.sleep(0.005)


def said(desk):
    return [(note.text, note.fault) for note in desk.model.notes]


@pytest.fixture
def fake(monkeypatch):
    monkeypatch.setattr(FakeJob, "made", [])
    monkeypatch.setattr(files, "OpenJob", FakeJob)
    return FakeJob.made


class TestOpening:
    @pytest.mark.parametrize("side", ["test", "reference"])
    def test_a_material_is_one_step_for_the_side_that_was_asked_for(self, desk, tmp_path, side):
        """The test's, whichever side is active: the reference is replaced by name only."""
        save_material(materials.paper("art"), tmp_path / "art.json")
        before = desk.model.state
        if side == "test":
            desk.model.active_side = "reference"
            desk.open_path(str(tmp_path / "art.json"))
        else:
            desk.replace_reference()
            desk.dialogs._own.question.chosen(str(tmp_path / "art.json"))
            desk.dialogs.close()
        pump(desk)
        state = desk.model.state
        other = "reference" if side == "test" else "test"
        assert state.side(side).sample.file == str(tmp_path / "art.json")
        expected = with_sample(before, side, state.side(side).sample)  # matched
        assert state.side(side).look == expected.side(side).look
        assert state.side(other).sample == before.side(other).sample
        assert state.reference.look.c is not None
        assert desk.scene_path is None
        assert said(desk) == [(f"opened art.json; it is the {side} sample now", False)]
        assert desk.model.history.undo()
        assert desk.model.state == before
        assert not desk.model.history.can_undo

    def test_a_scene_takes_the_place_of_everything_and_is_saved_again(self, desk, tmp_path):
        other = State.initial().with_look("test", seed=7).with_part("lamp", azimuth_deg=33.0)
        save_state(tmp_path / "s.toml", other)
        desk.open_path(str(tmp_path / "s.toml"))
        pump(desk)
        assert desk.model.state == other
        assert desk.scene_path == str(tmp_path / "s.toml")
        desk.model.set_look("test", seed=8)
        desk.save()
        assert load_state(tmp_path / "s.toml") == desk.model.state
        assert load_state(tmp_path / "s.toml") != other

    def test_a_scene_is_no_reference(self, desk, tmp_path):
        save_state(tmp_path / "s.toml", State.initial().with_look("test", seed=7))
        before = desk.model.state
        desk.open_path(str(tmp_path / "s.toml"), "reference")
        pump(desk)
        assert desk.model.state is before
        assert said(desk) == [("s.toml is a scene, which holds both pictures: use Open", True)]

    @pytest.mark.slow
    def test_a_table_is_fitted_and_its_points_are_kept(self, desk):
        table = asset("papers", "uncoated.csv")
        desk.open_path(str(table))
        pump(desk)
        sample = desk.model.state.test.sample
        assert sample.table == str(table)
        assert list(desk.model.measurements) == [sample.table]
        assert load_material(sample.file) == sample.material
        assert said(desk)[-1][0].startswith("fitted uncoated.csv: ")
        # What was fitted in the window is in a file: a scene and a command can name it.
        assert desk.model.history.undo()
        assert desk.model.history.redo()

    def test_faults_are_one_line_each_and_change_nothing(self, desk, tmp_path):
        (tmp_path / "bad.toml").write_text("[lamp]\nazimuth_deg = fifty\n")
        save_material(materials.paper("art"), tmp_path / "art.json")
        before = desk.model.state
        for path in (tmp_path / "gone.csv", tmp_path, tmp_path / "bad.toml"):
            desk.open_path(str(path))
        pump(desk)
        assert desk.model.state is before
        assert [fault for _, fault in said(desk)] == [True] * 3
        assert "gone.csv" in said(desk)[0][0]
        desk.open_path(str(tmp_path / "art.json"))  # and the next is opened all the same
        pump(desk)
        assert desk.model.state.test.sample.file is not None

    def test_files_wait_for_each_other(self, desk, fake):
        desk.open_path("/a.csv")
        desk.open_path("/b.csv")
        assert desk.due_s() == 0.1
        desk.each_frame()
        desk.each_frame()
        assert [job.path for job in fake] == ["/a.csv"]
        fake[0].end(fault="/a.csv: no")
        desk.each_frame()
        assert [job.path for job in fake] == ["/a.csv", "/b.csv"]
        art = materials.paper("art")
        fake[1].end(Opened("/b.csv", sample=Sample(art), warning="not kept: disk full"))
        desk.each_frame()
        assert desk.due_s() is None
        assert desk.model.state.test.sample.material is art
        assert said(desk)[-1] == ("not kept: disk full", True)

    def test_cancelled(self, desk, fake):
        before = desk.model.state
        desk.open_path("/a.csv")
        desk.each_frame()
        fake[0].cancel()
        desk.each_frame()
        assert desk.model.state is before
        assert said(desk) == [("cancelled: a.csv", False)]

    def test_closing_ends_what_runs_and_drops_what_waits(self, desk, fake):
        desk.open_path("/a.csv")
        desk.open_path("/b.csv")
        desk.each_frame()
        desk.close()
        desk.each_frame()
        assert [job.cancelled for job in fake] == [True]

    def test_odd_names_are_told_in_one_line(self, desk, fake):
        desk.open_path("/tmp/line\nbreak \udcff.json")
        desk.each_frame()
        fake[0].cancel()
        desk.each_frame()
        assert "\n" not in said(desk)[0][0]
        said(desk)[0][0].encode("utf-8")


class TestSaving:
    def test_a_sample_in_no_file_is_saved_beside_the_scene(self, desk, tmp_path):
        desk.model.set_sample("test", Sample(materials.flat(0.5)))
        desk.scene_path = str(tmp_path / "s.toml")
        desk.save()
        (file,) = tmp_path.glob("s-*.json")
        assert said(desk) == [(f"saved s.toml and {file.name} to {tmp_path}", False)]
        assert load_state(tmp_path / "s.toml").test.sample.material == materials.flat(0.5)

    def test_a_place_that_cannot_be_written(self, desk, tmp_path):
        desk.scene_path = str(tmp_path / "gone" / "s.toml")
        desk.save()
        assert said(desk)[-1][1]

    def test_a_scene_without_a_place_is_asked_about(self, desk):
        desk.save()
        assert desk.dialogs.open
        desk.dialogs.close()
        assert not desk.dialogs.open


class TestCopying:
    @pytest.fixture
    def clipboard(self, monkeypatch):
        found = []
        monkeypatch.setattr(files.imgui, "set_clipboard_text", found.append)
        return found

    def test_the_command_has_what_is_shown(self, desk, clipboard):
        desk.model.picture_size = (462, 511)
        desk.model.set_look("test", seed=12)
        desk.copy_command()
        (line,) = clipboard
        assert line.startswith("relgloss snapshot --sample matte-coated ")
        assert "--seed 12" in line
        assert "--size 462x511" in line
        assert "matte-coated" in line.split(" -o ")[1]
        assert said(desk) == [("copied: the command that draws the test picture, 462x511", False)]

    def test_life_size_is_in_it(self, desk, clipboard):
        desk.model.picture_size = (400, 300)
        desk.model.pixel_pitch_m = 2.5e-4
        desk.copy_command()
        desk.model.set_part("presentation", life_size=True)
        desk.copy_command()
        plain, life = clipboard
        assert "field_of_view_deg" not in plain
        assert "field_of_view_deg" in life

    def test_a_sample_in_no_file_is_told(self, desk, clipboard):
        desk.model.set_sample("test", Sample(materials.flat(0.5)))
        desk.copy_command()
        assert clipboard == []
        assert said(desk)[-1][1]


class TestSession:
    def test_without_one_nothing_is_written(self, desk, tmp_path):
        desk.model.set_look("test", seed=3)
        desk.each_frame()
        assert desk.due_s() is None
        desk.close()
        assert list(tmp_path.iterdir()) == []

    def test_a_change_is_written_when_it_is_due(self, desk, tmp_path):
        file = tmp_path / "home" / "session.toml"
        desk.session = Autosave(file, desk.model.state)
        desk.each_frame()
        assert desk.due_s() is None
        desk.model.set_look("test", seed=3)
        desk.each_frame()
        assert 0.0 < desk.due_s() <= 0.5
        assert not file.exists()
        pump(desk)
        assert load_state(file) == desk.model.state

    def test_closing_writes_at_once(self, desk, tmp_path):
        file = tmp_path / "session.toml"
        desk.session = Autosave(file, desk.model.state)
        desk.model.set_look("test", seed=4)
        desk.close()
        assert load_state(file) == desk.model.state

    def test_a_fault_is_told_once_and_the_window_goes_on(self, desk, tmp_path):
        (tmp_path / "file").write_text("")
        desk.session = Autosave(tmp_path / "file" / "session.toml", desk.model.state)
        desk.model.set_look("test", seed=5)
        desk.each_frame()
        desk.session._due_s = 0.0
        desk.each_frame()
        desk.each_frame()
        desk.close()
        assert [fault for _, fault in said(desk)] == [True]


def test_the_window_over_haploscopic_pictures_is_seen(desk):
    desk.model.change(desk.model.state.with_part("presentation", haploscopic=True))
    desk.open()
    assert not desk.model.state.presentation.haploscopic
    assert dataclasses.replace(desk.dialogs._own.question, chosen=None).title == "Open file"
