"""Killed at any moment, a session loses no acknowledged answer and goes on where it was."""

from __future__ import annotations

import contextlib
import random
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import killed
import pytest

from relgloss_view.experiment.design.trial_order import planned_trials
from relgloss_view.experiment.observers.simulation import BATCH
from relgloss_view.experiment.session.records import read_record
from relgloss_view.experiment.session.store import Store

OBSERVERS = 3
LONGEST_S = 60.0


class Running:
    """The program killed.py, and what it has acknowledged."""

    def __init__(self, file, design):
        words = [sys.executable, killed.__file__, str(file), design, str(OBSERVERS)]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
        self.lines = []

    def read(self, count):
        """Read so many lines more, or all there are."""
        while count > 0 and (line := self.process.stdout.readline()):
            self.lines.append(line.split())
            count -= 1
        return count == 0

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.rest()

    def rest(self):
        self.lines += [line.split() for line in self.process.stdout if line.endswith("\n")]
        self.process.stdout.close()
        self.process.wait(LONGEST_S)

    @property
    def acknowledged(self):
        return [line for line in self.lines if len(line) == 7]


def stored(file, folder):
    """What a session file holds, as killed.py prints it."""
    record = read_record(file, folder)
    names = {o.number: o.name for o in record.observers}
    return [
        [
            names[a.observer], str(a.trial.position), str(a.trial.sample), str(a.trial.setting),
            str(a.trial.repeat), a.question, str(a.category),
        ]
        for a in record.answers
    ]  # fmt: skip


def as_left(file):
    """What is stored, read from a copy: the next program finds the files as the kill left them."""
    with tempfile.TemporaryDirectory() as name:
        for part in file.parent.glob(f"{file.name}*"):
            shutil.copy(part, name)
        return stored(Path(name) / file.name, Path(name))


def trials_of(file, folder):
    record = read_record(file, folder)
    with Store(file) as store:
        return {o.number: store.trials(o) for o in record.observers}


def killed_often(folder, design, kills, seed):
    """Kill the program at random moments, `kills` times, then let it end; check after each."""
    hand = random.Random(seed)
    file = folder / "session.sqlite"
    acknowledged, stored_before = [], []
    done = 0
    while done < kills:
        running = Running(file, design)
        # Sometimes before the first answer, sometimes within the writing of a later one.
        running.read(hand.choice((0, 1, 2, 2 + hand.randrange(8))))
        time.sleep(hand.random() * 0.004)
        running.kill()
        first = next(iter(running.acknowledged), None)
        assert first not in stored_before, "an answer that was stored is asked for again"
        acknowledged += running.acknowledged
        stored_before = as_left(file) if file.exists() else []
        for answer in acknowledged:
            assert answer in stored_before, "an acknowledged answer is lost"
        # At most a batch more than was acknowledged: stored, and killed before it was told.
        assert len(stored_before) - len(acknowledged) <= BATCH * (done + 1)
        done += 1
        if running.lines and running.lines[-1] == ["done"]:
            break
    last = Running(file, design)
    last.rest()
    assert last.lines[-1] == ["done"]
    assert last.process.returncode == 0
    return file, done


def uninterrupted(folder, design):
    file = folder / "whole.sqlite"
    running = Running(file, design)
    running.rest()
    assert running.lines[-1] == ["done"]
    assert stored(file, folder) == running.acknowledged
    return file


def check(folder, design, kills, seed):
    file, done = killed_often(folder, design, kills, seed)
    whole = uninterrupted(folder, design)
    assert stored(file, folder) == stored(whole, folder)
    assert trials_of(file, folder) == trials_of(whole, folder)
    if design == "full":
        for number, trials in trials_of(file, folder).items():
            assert trials == list(planned_trials(killed.made(design), number))
    assert {p.name for p in folder.iterdir()} == {"session.sqlite", "whole.sqlite"}
    return done


@pytest.mark.parametrize("design", ["full", pytest.param("adaptive", marks=pytest.mark.slow)])
def test_nothing_is_lost(tmp_path, design):
    assert check(tmp_path, design, 8, seed=1) == 8


@pytest.mark.slow
@pytest.mark.parametrize("part", range(8))
def test_200_kills(tmp_path, part):
    """A program that came to its end is begun again on a new file, so that 25 kills are 25."""
    done = 0
    while done < 25:
        folder = tmp_path / str(done)
        folder.mkdir()
        done += check(folder, "full", 25 - done, seed=100 + 10 * part + done)


def test_a_loss_is_seen(tmp_path):
    """The control: a file that lacks what was acknowledged does not pass these tests."""
    file = tmp_path / "session.sqlite"
    running = Running(file, "full")
    running.read(8)
    running.kill()
    with contextlib.closing(sqlite3.connect(file)) as connection, connection:
        connection.execute("DELETE FROM answer WHERE id = 3")
    kept = stored(file, tmp_path)
    assert not all(answer in kept for answer in running.acknowledged)
