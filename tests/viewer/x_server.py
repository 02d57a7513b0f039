"""An X server without a monitor, our own, on whatever number is free, and a user's hand on it."""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
import time
from pathlib import Path

import pytest

from relgloss_view import cli

ROOT = Path(cli.__file__).parents[1]
LONGEST_S = 60.0
SCREEN = "1400x900x24"
TITLE = "^relgloss$"
LOOKS = 20  #: at a program that should be at rest, in half a second
TICKS_S = os.sysconf("SC_CLK_TCK")

needs_server = pytest.mark.skipif(
    not (shutil.which("Xvfb") and shutil.which("xdotool")),
    reason="needs Xvfb and xdotool: scripts/system-packages test",
)


@contextlib.contextmanager
def running(*more):
    """The name of a display whose server runs as long as the block; more: its further options."""
    reading, writing = os.pipe()
    words = ["Xvfb", "-displayfd", str(writing), "-screen", "0", SCREEN, "-nolisten", "tcp", *more]
    words.append("-noreset")  # else the pointer comes back to the middle with each last client
    server = subprocess.Popen(words, pass_fds=[writing], stderr=subprocess.DEVNULL)
    os.close(writing)
    try:
        with os.fdopen(reading) as pipe:
            number = pipe.readline().strip()  # nothing, should the server end
        assert number, "Xvfb did not start"
        yield f":{number}"
    finally:
        server.terminate()
        server.wait(LONGEST_S)


def environment(folder, display=None):
    names = ("DISPLAY", "WAYLAND_DISPLAY")
    kept = {k: v for k, v in os.environ.items() if k not in names}
    if display is not None:
        kept["DISPLAY"] = display
    return kept | {"RELGLOSS_HOME": str(folder / "kept"), "PYTHONPATH": str(ROOT)}


def hand(display, *words):
    """What a user does, by xdotool."""
    done = subprocess.run(
        ["xdotool", *words],
        env={**os.environ, "DISPLAY": display},
        capture_output=True,
        text=True,
        timeout=LONGEST_S,
    )
    assert done.returncode == 0, done.stderr


def ticks(process):
    """Processor time that a process and its threads have taken, clock ticks."""
    fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[11]) + int(fields[12])


def asleep(process):
    """Whether each thread waits for something; one that waits for a processor does not count."""
    for task in Path(f"/proc/{process.pid}/task").glob("*/stat"):
        with contextlib.suppress(FileNotFoundError, ProcessLookupError):  # it has just ended
            if task.read_text().rpartition(")")[2].split()[0] in "RD":
                return False
    return True


def rest(process):
    """Wait until the program does next to nothing for a while; it must within the time.

    On a busy machine a program that is starting gets hardly any time too, but waits for it: so
    it also has to be found asleep.
    """
    end = time.monotonic() + LONGEST_S
    quiet = 0
    while quiet < 2:
        assert process.poll() is None
        assert time.monotonic() < end, "the window does not come to rest"
        before, found = ticks(process), 0
        for _ in range(LOOKS):
            time.sleep(0.5 / LOOKS)
            found += asleep(process)
        idle = ticks(process) - before <= 0.1 * 0.5 * TICKS_S
        quiet = quiet + 1 if idle and found >= 0.9 * LOOKS else 0


def until(condition):
    end = time.monotonic() + LONGEST_S
    while not condition():
        assert time.monotonic() < end, "it does not come"
        time.sleep(0.05)
