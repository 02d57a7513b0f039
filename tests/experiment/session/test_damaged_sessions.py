"""Damaged session files: a result or one line, for any damage; the tables are exactly ours."""

from __future__ import annotations

import contextlib
import os
import shutil
import sqlite3

import damaged_sessions
import kills
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.experiment.session import file_checks, session_file
from relgloss_view.experiment.session.records import read_record
from relgloss_view.experiment.session.store import Store


@pytest.fixture(scope="module")
def originals(tmp_path_factory):
    folder = tmp_path_factory.mktemp("originals")
    return damaged_sessions.originals(folder)


def test_whole_files_are_used(originals, tmp_path):
    """The control of what follows."""
    for file in originals:
        shutil.copyfile(file, tmp_path / "s.sqlite")
        assert damaged_sessions.judged(tmp_path / "s.sqlite", tmp_path, whole=False) == (None, 0)


def test_a_fault_is_seen(originals, tmp_path, monkeypatch):
    """An exception that nobody has thought of is one line; outside the gate it is seen."""
    shutil.copyfile(originals[0], tmp_path / "s.sqlite")

    def broken(*_):
        raise OSError("of a decoder")

    monkeypatch.setattr("relgloss_view.experiment.session.records._read_runs", broken)
    fault, refused = damaged_sessions.judged(tmp_path / "s.sqlite", tmp_path, whole=False)
    assert (fault, refused) == (None, 1)
    monkeypatch.setattr(damaged_sessions, "read_pool", broken)
    fault, _ = damaged_sessions.judged(tmp_path / "s.sqlite", tmp_path, whole=False)
    assert "of a decoder" in fault


def test_some_damaged_files(originals):
    faults = [damaged_sessions.one(k, originals[0].parent)[1] for k in range(30)]
    assert faults == [None] * 30


@pytest.mark.slow
def test_more_damaged_files():
    assert damaged_sessions.main(["--count", "1500", "--workers", "2", "--seed", "5000"]) == []


@pytest.mark.slow
def test_more_kills():
    sums = kills.main(["--kills", "60", "--workers", "2", "--seed", "100"])
    assert all(silent == wrong == 0 for _, _, silent, wrong, _ in sums.values())
    for fault in ("none", kills.ALONE):
        assert sums[fault] == [0] * 5
    for fault in ("gone", "renamed"):
        assert sums[fault][:2] == [0, 0]


@pytest.mark.slow
def test_the_former_way_loses_answers():
    """The control: with the last answers in a log, a copy of the file alone lacks them."""
    sums = kills.main(["--kills", "10", "--workers", "2", "--former"])
    for fault in ("gone", "renamed", kills.ALONE):
        assert sums[fault][0] == 10
    assert all(silent == 0 for _, _, silent, _, _ in sums.values())


@pytest.mark.parametrize("change", damaged_sessions.SCHEMAS)
def test_other_tables_are_refused_at_once(originals, tmp_path, change):
    """One of them is a view that never ends: who asks it is never answered."""
    file = tmp_path / "s.sqlite"
    shutil.copyfile(originals[0], file)
    with contextlib.closing(sqlite3.connect(file, isolation_level=None)) as connection:
        connection.executescript(change)
    for opener in (lambda: Store(file), lambda: read_record(file, tmp_path)):
        with pytest.raises(InputError) as caught:
            opener()
        assert str(caught.value).startswith(f"{file}: ")
        assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("text", damaged_sessions.TEXTS, ids=range(len(damaged_sessions.TEXTS)))
def test_details_of_any_kind(originals, tmp_path, text):
    file = tmp_path / "s.sqlite"
    shutil.copyfile(originals[0], file)
    with contextlib.closing(sqlite3.connect(file)) as connection, connection:
        connection.execute("UPDATE observer SET details = ?", (text,))
    assert damaged_sessions.judged(file, tmp_path, whole=False)[0] is None
    with contextlib.suppress(InputError):
        for details in read_record(file, tmp_path).details:
            assert len(str(details)) < file_checks.MOST_TEXT_BYTES


def test_reading_has_an_end(originals, tmp_path, monkeypatch):
    """A reading of more steps than a file of its size needs is ended."""
    monkeypatch.setattr(file_checks, "STEPS", 0)
    monkeypatch.setattr(file_checks, "STEPS_A_BYTE", 0)
    monkeypatch.setattr(file_checks, "STEPS_A_CALL", 100)
    with pytest.raises(InputError, match="damaged"), session_file.open_to_read(originals[0]):
        pass


@pytest.mark.parametrize("size", [file_checks.MOST_BYTES + 1, 2**40])
def test_a_file_that_claims_to_be_huge(originals, tmp_path, size):
    file = tmp_path / "s.sqlite"
    shutil.copyfile(originals[0], file)
    os.truncate(file, size)  # a hole: it takes no room
    for opener in (lambda: Store(file), lambda: read_record(file, tmp_path)):
        with pytest.raises(InputError, match="larger than any session"):
            opener()
