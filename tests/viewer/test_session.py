"""The session survives any end: killed, damaged, on a full disk, beside a second window."""

from __future__ import annotations

import itertools
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import states

from relgloss_view.base.errors import InputError
from relgloss_view.viewer.state import places, session
from relgloss_view.viewer.state.session import Autosave, Restored, restore
from relgloss_view.viewer.state.state import State
from relgloss_view.viewer.state.state_file import load_state

LIMIT_S = 60.0


def seeded(seed):
    return State.initial().with_look("test", seed=seed)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "state" / "session.toml"


def names(folder):
    return sorted(p.name for p in folder.iterdir())


class TestAutosave:
    def test_it_writes_soon_after_a_change_and_no_more_often(self, path):
        autosave = Autosave(path)
        assert autosave.due_in(0.0) is None
        autosave.save()
        assert not path.parent.exists()
        writes = []
        for frame in range(60):  # 3 s of dragging at 20 frames a second
            autosave.note(seeded(min(frame, 50)))
            now_s = 10.0 + 0.05 * frame
            if autosave.due(now_s):
                autosave.save(now_s)
                writes.append(now_s)
                assert load_state(path).test.look.seed == min(frame, 50)
        assert len(writes) == 5
        assert all(b - a >= 0.5 - 1e-9 for a, b in itertools.pairwise(writes))
        assert not autosave.changed
        assert autosave.due_in(1e9) is None

    def test_leaving_writes_what_is_not_yet_written(self, path):
        autosave = Autosave(path)
        autosave.note(seeded(1))
        assert autosave.due_in(5.0) == 0.5
        assert autosave.due_in(5.2) == pytest.approx(0.3)
        assert not autosave.due(5.2)
        autosave.save()
        assert restore(path) == Restored(seeded(1))

    def test_what_is_undone_in_time_is_not_written(self, path):
        autosave = Autosave(path, written=seeded(1))
        autosave.note(seeded(2))
        assert autosave.due_in(0.0) == 0.5
        autosave.note(seeded(1))
        assert autosave.due_in(0.6) is None
        autosave.save()
        assert not path.exists()
        autosave.note(seeded(3))
        assert autosave.due_in(0.7) == 0.5  # a new change begins anew

    def test_faults_are_told_once_and_tried_again(self, path, tmp_path):
        (tmp_path / "state").write_text("in the way")
        autosave = Autosave(path)
        autosave.note(seeded(1))
        autosave.due(0.0)
        with pytest.raises(InputError, match=r"session is not kept: .*state"):
            autosave.save(0.5)
        assert not autosave.due(0.6)
        autosave.note(seeded(2))
        assert not autosave.due(30.0)
        assert autosave.due(30.5)
        autosave.save(30.5)  # the same fault is not told again
        assert autosave.changed
        (tmp_path / "state").unlink()
        assert autosave.due(61.0)
        autosave.save(61.0)
        assert load_state(path) == seeded(2)

    def test_a_full_disk_keeps_what_was_there(self, path, monkeypatch):
        autosave = Autosave(path)
        autosave.note(seeded(1))
        autosave.save()

        def full(self, data):
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(Path, "write_bytes", full)
        autosave.note(seeded(2))
        with pytest.raises(InputError, match="No space left"):
            autosave.save()
        assert names(path.parent) == ["session.toml"]
        assert restore(path).state == seeded(1)


class TestRestore:
    def test_there_is_none(self, path):
        assert restore(path) == Restored()
        path.parent.mkdir()
        path.write_text("\n")  # what some file systems leave when the power goes
        assert restore(path) == Restored()

    @pytest.mark.parametrize(
        "content", [b"[look", b"\xff\xfe", b"[look]\nseed = -1\n", b"x = 1\n", b"a" * 2**21]
    )
    def test_damaged_files_are_kept_aside(self, path, content):
        path.parent.mkdir()
        path.write_bytes(content)
        found = restore(path)
        assert found.state is None
        (message,) = found.messages
        assert "\n" not in message
        assert "kept as session-damaged.toml" in message
        assert (path.parent / "session-damaged.toml").read_bytes() == content
        assert not path.exists()
        path.write_bytes(content + b"2")
        assert "session-damaged-2.toml" in restore(path).messages[0]
        assert (path.parent / "session-damaged.toml").read_bytes() == content

    def test_one_that_can_not_be_moved(self, path, monkeypatch):
        path.parent.mkdir()
        path.write_text("[look")

        def refuse(*args):
            raise OSError(30, "Read-only file system")

        monkeypatch.setattr(os, "replace", refuse)
        assert "Read-only" in restore(path).messages[0]
        assert path.read_text() == "[look"

    def test_damaged_files_do_not_pile_up_for_ever(self, path, monkeypatch):
        monkeypatch.setattr(session, "MOST_DAMAGED", 3)
        path.parent.mkdir()
        for k in range(6):
            path.write_text(f"[{k}")
            restore(path)
        assert len(names(path.parent)) == 3
        assert (path.parent / "session-damaged-3.toml").read_text() == "[5"

    def test_what_is_no_file_is_said_and_left(self, path):
        path.mkdir(parents=True)
        assert "a folder" in restore(path).messages[0]
        path.rmdir()
        os.mkfifo(path)
        assert "not a regular file" in restore(path).messages[0]
        assert names(path.parent) == ["session.toml"]

    def test_a_material_that_is_gone_takes_nothing_with_it(self, path, tmp_path):
        first, *_ = states.write_materials(tmp_path / "papers")
        state = seeded(7).with_sample("reference", first).with_part("presentation", wipe=0.1)
        autosave = Autosave(path)
        autosave.note(state)
        autosave.save()
        assert restore(path) == Restored(state)
        Path(first.file).rename(tmp_path / "away")
        found = restore(path)
        assert found.state == state.with_sample("reference", State.initial().reference.sample)
        (message,) = found.messages
        assert "plain.json" in message
        # Until something is changed the file stays as it is, and the material may come back.
        autosave = Autosave(path, written=found.state)
        autosave.note(found.state)
        autosave.save()
        (tmp_path / "away").rename(first.file)
        assert restore(path) == Restored(state)


WRITER = """
import sys
from relgloss_view.viewer.state.session import Autosave
from relgloss_view.viewer.state.state import State
autosave, seed = Autosave(sys.argv[1]), int(sys.argv[2])
initial = State.initial()
print("ready", flush=True)
while True:
    seed += 2
    autosave.note(initial.with_look("test", seed=seed))
    autosave.save()
"""


def writer(path, seed):
    process = subprocess.Popen(
        [sys.executable, "-c", WRITER, str(path), str(seed)], stdout=subprocess.PIPE
    )
    assert process.stdout.readline() == b"ready\n"
    return process


def kill(process):
    process.send_signal(signal.SIGKILL)
    process.wait(LIMIT_S)
    process.stdout.close()


def wait_for(condition):
    end = time.monotonic() + LIMIT_S
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.002)


def test_killed_while_writing(path):
    """However it ends, the next start finds a whole session, no older than the last one seen."""
    seen = 0
    for k in range(5):
        process = writer(path, seen)
        wait_for(lambda: path.exists() and load_state(path).test.look.seed > seen)  # noqa: B023
        time.sleep(0.003 * k)
        seen = load_state(path).test.look.seed
        kill(process)
        found = restore(path)
        assert found.messages == ()
        assert found.state.test.look.seed >= seen
        seen = found.state.test.look.seed


def test_two_windows_write_whole_files(path):
    both = [writer(path, 0), writer(path, 1)]
    found = set()
    try:
        wait_for(path.exists)
        wait_for(lambda: found.add(restore(path).state.test.look.seed % 2) or len(found) == 2)
        for _ in range(100):
            assert restore(path).messages == ()
    finally:
        for process in both:
            kill(process)
    assert "session-damaged.toml" not in names(path.parent)


class TestPlaces:
    def test_one_variable_moves_all_and_nothing_is_made(self, tmp_path, monkeypatch):
        monkeypatch.setenv("RELGLOSS_HOME", str(tmp_path / "h"))
        made = [places.config_folder(), places.state_folder(), places.data_folder()]
        assert made == [tmp_path / "h" / name for name in ("config", "state", "data")]
        assert session.session_file() == tmp_path / "h" / "state" / "session.toml"
        monkeypatch.chdir(tmp_path)
        monkeypatch.setenv("RELGLOSS_HOME", "h")
        assert places.config_folder() == made[0]
        assert list(tmp_path.iterdir()) == []

    def test_without_it_they_are_the_systems(self, tmp_path, monkeypatch):
        monkeypatch.setenv("RELGLOSS_HOME", "")
        monkeypatch.setenv("HOME", str(tmp_path))
        for name in ("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_DATA_HOME"):
            monkeypatch.delenv(name, raising=False)
        made = [places.config_folder(), places.state_folder(), places.data_folder()]
        assert len(set(made)) == 3
        assert all(folder.is_relative_to(tmp_path) and "relgloss" in str(folder) for folder in made)
        assert list(tmp_path.iterdir()) == []

    def test_without_a_home_nothing_goes_into_the_present_folder(self, monkeypatch):
        import platformdirs

        monkeypatch.delenv("RELGLOSS_HOME", raising=False)
        for kind in ("config", "state", "data"):
            monkeypatch.setattr(platformdirs, f"user_{kind}_path", lambda *a, **k: Path("~/x"))
        for folder in (places.config_folder, places.state_folder, places.data_folder):
            with pytest.raises(InputError, match="RELGLOSS_HOME"):
                folder()
