"""What a killed program leaves is removed by the next one, and what a living one has is not."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from relgloss_view import cli
from relgloss_view.base import temporaries
from relgloss_view.base.errors import InputError
from relgloss_view.base.temporaries import held_folder, scratch_folder
from relgloss_view.base.writing import whole_file, whole_folder

ROOT = Path(cli.__file__).parents[1]
HOLDING = """
import sys
from relgloss_view.base.writing import whole_folder
with whole_folder(sys.argv[1], "list") as folder:
    (folder / "a").write_text("half")
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture(autouse=True)
def fresh(monkeypatch):
    monkeypatch.setattr(temporaries, "_swept", {})


def holder(folder):
    """A program that is in the middle of writing a folder."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDING, str(folder)],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout.readline() == "held\n"
    return process


def hidden(folder):
    return [p.name for p in folder.iterdir() if temporaries.is_temporary(p.name)]


def test_of_a_killed_program_nothing_stays(tmp_path):
    process = holder(tmp_path / "new")
    (left,) = hidden(tmp_path)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert hidden(tmp_path) == [left]
    temporaries._swept.clear()
    with whole_file(tmp_path / "a.txt") as temporary:
        temporary.write_text("whole")
    assert os.listdir(tmp_path) == ["a.txt"]


def test_of_a_living_program_everything_stays(tmp_path):
    process = holder(tmp_path / "new")
    (held,) = hidden(tmp_path)
    with whole_file(tmp_path / "a.txt") as temporary:
        temporary.write_text("whole")
    assert hidden(tmp_path) == [held]
    process.communicate("")
    assert process.returncode == 0
    assert sorted(p.name for p in tmp_path.rglob("*")) == ["a", "a.txt", "new"]


def test_only_folders_of_these_names_are_removed(tmp_path):
    (tmp_path / f"{temporaries.PREFIX}x{temporaries.SUFFIX}").write_text("a file of somebody")
    (tmp_path / ".relgloss-mine").mkdir()
    (tmp_path / "far").mkdir()
    (tmp_path / "far" / "kept").write_text("kept")
    link = tmp_path / f"{temporaries.PREFIX}y{temporaries.SUFFIX}"
    link.symlink_to(tmp_path / "far")
    before = sorted(os.listdir(tmp_path))
    temporaries.sweep(tmp_path)
    assert sorted(os.listdir(tmp_path)) == before
    assert (tmp_path / "far" / "kept").exists()


def test_no_locks_no_sweeping(tmp_path, monkeypatch):
    """As on Windows, and on network drives without locks: only one's own is removed."""
    monkeypatch.setattr(temporaries, "fcntl", None)
    with held_folder(tmp_path) as folder:
        temporaries.sweep(tmp_path)
        assert folder.is_dir()
    assert os.listdir(tmp_path) == []


def test_a_folder_that_is_taken_for_a_leftover_is_made_anew(tmp_path, monkeypatch):
    """Between its making and its lock another program may have the lock already."""
    real, taken = temporaries._lock, []

    def lock(path):
        if not taken:
            taken.append(path)
            os.rmdir(path)
            return temporaries.TAKEN
        return real(path)

    monkeypatch.setattr(temporaries, "_lock", lock)
    with held_folder(tmp_path) as folder:
        assert folder.is_dir()
        assert str(folder) not in taken
    assert os.listdir(tmp_path) == []


def test_an_end_without_with_blocks(tmp_path):
    with held_folder(tmp_path) as folder:
        (folder / "a").write_text("half")
        temporaries.remove_all()
        assert os.listdir(tmp_path) == []


def test_no_place_for_temporary_files(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "gone"))
    with pytest.raises(InputError, match="set TMPDIR"), scratch_folder():
        pass


def test_a_new_folder_is_whole_while_others_are_swept(tmp_path):
    with whole_folder(tmp_path / "new", "list") as first:
        (first / "a").write_text("1")
        with whole_folder(tmp_path / "other", "list") as second:
            (second / "b").write_text("2")
    assert sorted(p.name for p in tmp_path.rglob("*")) == ["a", "b", "new", "other"]
