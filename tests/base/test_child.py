"""Children end with the program, however it ends, and no Ctrl-C of a terminal reaches them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import pytest

from relgloss_view.base import child, interruptions
from relgloss_view.base.child import Child

ROOT = child.PACKAGE_FOLDER
LIMIT_S = 30.0
pytestmark = pytest.mark.skipif(os.name != "posix", reason="process groups")

WATCHING = "from relgloss_view.base.followed import follow; follow(); import time; time.sleep(60)"
PARENT = f"""
import subprocess, sys, time
from relgloss_view.base.child import Child
followed = sys.argv[1] == "followed"
child = Child([sys.executable, "-c", {WATCHING!r}], followed=followed, stdout=subprocess.DEVNULL)
print(child.process.pid, flush=True)
time.sleep(60)
"""


def gone(pid):
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return True


@pytest.mark.parametrize("how", ["followed", "left alone"])
def test_a_child_leaves_when_its_program_is_killed(how):
    """Without the pipe it stays: that is what the test looks for."""
    program = subprocess.Popen(
        [sys.executable, "-c", PARENT, how], cwd=ROOT, stdin=subprocess.PIPE,
        stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    pid = int(program.stdout.readline())
    os.kill(pid, 0)
    # The kept end of the test's own pipe stands for a terminal, which stays when the program goes.
    program.kill()
    program.wait(LIMIT_S)
    program.stdout.close()
    end_s = time.monotonic() + (LIMIT_S if how == "followed" else 0.5)
    while not gone(pid) and time.monotonic() < end_s:
        time.sleep(0.01)
    ended = gone(pid)
    if not ended:
        os.kill(pid, signal.SIGKILL)
    program.stdin.close()
    assert ended == (how == "followed")


def test_a_child_is_in_a_group_of_its_own():
    one = Child([sys.executable, "-c", WATCHING], followed=True)
    assert os.getpgid(one.process.pid) == one.process.pid != os.getpgrp()
    child.end_all()  # as the program does when it leaves
    assert one.process.wait(LIMIT_S) == -signal.SIGKILL
    one.close()
    one.kill()  # what has ended may be ended


def test_a_wait_for_a_child_is_interrupted(monkeypatch):
    signals = interruptions.Signals()
    monkeypatch.setattr(interruptions, "SIGNALS", signals)
    one = Child([sys.executable, "-c", WATCHING], followed=True, stdout=subprocess.PIPE)
    signals._note(signal.SIGINT, None)
    with pytest.raises(interruptions.Interrupted):
        one.outcome(LIMIT_S)
    assert one.process.poll() is not None


def test_what_a_program_of_the_system_prints():
    done = child.run([sys.executable, "-c", "print('a'); import sys; sys.exit(3)"], LIMIT_S)
    assert (done.status, done.out.strip(), done.crash) == (3, "a", "")
    slow = child.run([sys.executable, "-c", WATCHING], 0.0)
    assert slow.status is None
    with pytest.raises(OSError, match="No such file"):
        child.run(["/no/program"], LIMIT_S)
