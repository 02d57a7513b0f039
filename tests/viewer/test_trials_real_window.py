"""A session on an X server: real keys answer, what was acknowledged outlives a kill, and the
program rests while an observer looks."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import struct
import subprocess
import sys
import threading
import time

import pytest
from x_server import (
    LONGEST_S,
    TICKS_S,
    environment,
    hand,
    needs_server,
    rest,
    running,
    ticks,
    until,
)

from relgloss_view.display.display import Display
from relgloss_view.display.icc_writing import matrix_profile
from relgloss_view.display.record import SYSTEM
from relgloss_view.display.system.x_connection import Connection
from relgloss_view.experiment.design.trial_order import planned_trials
from relgloss_view.experiment.session.records import read_record

pytestmark = [
    needs_server,
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc"),
]

STUDY = """
[[samples]]
name = "uncoated"
[grid]
sigma_n_deg = [0.0, 2.0]
c_fraction = [0.5, 1.0]
[procedure]
adaptation_min = 0
gap_s = 0.05
[screen]
width_px = 64
height_px = 64
"""
TOTAL = 4
COMMAND = ("-m", "relgloss_view.cli", "experiment", "run")
PRESS_S = 0.25  #: between two keys: longer than the gap and the soonest answer


@pytest.fixture(scope="module")
def display():
    with running() as name:
        yield name


class Session:
    """The running command, and what it tells the operator on a terminal of its own."""

    def __init__(self, process, terminal):
        self.process, self._terminal = process, terminal
        self.told = ""
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        with contextlib.suppress(OSError):  # the other end has gone
            while data := os.read(self._terminal, 4096):
                self.told += data.decode()

    @property
    def acknowledged(self):
        """How many answers the operator was last told of; None before the first word."""
        counts = re.findall(rf"O01: (\d+) of {TOTAL}", self.told)
        return int(counts[-1]) if counts else None

    @property
    def judging(self):
        """Whether the operator was last told of pictures, not of a page before them."""
        lines = re.findall(rf"O01: \d+ of {TOTAL}, (\w+)", self.told)
        return bool(lines) and lines[-1] == "uncoated"


@contextlib.contextmanager
def session(folder, display, given):
    """The command in full screen, once it has told where the observer stands."""
    ours, theirs = os.openpty()
    process = subprocess.Popen(
        [sys.executable, *COMMAND, str(given)],
        cwd=folder,
        env=environment(folder, display),
        stdout=subprocess.PIPE,
        stderr=theirs,
        text=True,
    )
    os.close(theirs)
    try:
        running_ = Session(process, ours)
        until(lambda: running_.acknowledged is not None or process.poll() is not None)
        assert process.poll() is None, running_.told
        yield running_
    finally:
        if process.poll() is None:
            process.kill()
        process.wait(LONGEST_S)
        process.stdout.close()
        os.close(ours)


def press_until(display, key, condition):
    """Press a key again and again: a window that has just come up may not have the keyboard yet."""

    def pressed():
        hand(display, "key", key)
        time.sleep(PRESS_S)
        return condition()

    until(pressed)


def set_profile(display, data):
    """Set the root's _ICC_PROFILE, as a desktop does: ChangeProperty (18) of CARDINAL (6)."""
    connection = Connection(display)
    atom = connection.atom("_ICC_PROFILE")
    head = struct.pack("=3IB3xI", connection.root, atom, 6, 8, len(data))
    connection.send(18, 0, head + data + bytes(-len(data) % 4))
    assert connection.property_of_root(atom, 1 << 20)[0] == data
    connection.close()


@pytest.mark.slow
def test_keys_answer_and_what_was_acknowledged_outlives_a_kill(tmp_path, display):
    study = tmp_path / "mine.toml"
    study.write_text(STUDY)
    file = tmp_path / "mine.sqlite"
    profile = matrix_profile(Display(transfer="gain-offset-gamma", gamma=1.8))
    set_profile(display, profile)
    with session(tmp_path, display, study) as first:
        assert first.acknowledged == 0
        assert not first.judging
        press_until(display, "Return", lambda: first.judging)
        press_until(display, "2", lambda: first.acknowledged >= 2)
        # While somebody looks, nothing is drawn. A tick counts whole for a process that it finds
        # running: as in test_real_window, a tenth of what a window that keeps drawing takes.
        rest(first.process)
        before = ticks(first.process)
        time.sleep(1.0)
        assert ticks(first.process) - before < 0.1 * TICKS_S
        acknowledged = first.acknowledged
        first.process.send_signal(signal.SIGKILL)
        assert first.process.wait(LONGEST_S) == -signal.SIGKILL
    record = read_record(file, tmp_path)
    kept = record.answers
    assert acknowledged <= len(kept) < TOTAL
    planned = planned_trials(record.study, 0)
    assert [a.trial for a in kept] == list(planned[: len(kept)])
    assert {a.category for a in kept} == {1}
    assert record.runs[0].ended_utc is None
    with session(tmp_path, display, file) as second:
        assert second.acknowledged == len(kept)
        assert "consent" not in second.told  # it is kept
        press_until(display, "Return", lambda: second.judging)
        press_until(display, "KP_3", lambda: second.acknowledged == TOTAL)
        second.process.terminate()
        assert second.process.wait(LONGEST_S) == 128 + signal.SIGTERM
        assert second.process.stdout.read() == f"{file}: O01 has judged {TOTAL} of {TOTAL}\n"
    record = read_record(file, tmp_path)
    assert [a.trial for a in record.answers] == list(planned)
    assert [a.category for a in record.answers[len(kept) :]] == [2] * (TOTAL - len(kept))
    assert record.observers[0].ended
    assert record.runs[1].ended_utc is not None
    assert "pictures are drawn for relgloss display, gamma 1.8 (of the system)" in first.told
    assert [run.display.origin for run in record.runs] == [SYSTEM, SYSTEM]
    assert [kept.data for kept in record.display_files] == [profile]
    screen = record.runs[1].screen
    assert screen["full_screen"]
    assert screen["window_px"] == screen["monitor"]["resolution_px"] == [1400, 900]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["mine.sqlite", "mine.toml"]
