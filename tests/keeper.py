"""Runs a program, and ends it and all that it started when whoever asked for it is gone.

    python keeper.py FOLDER PROGRAM ARGUMENT...

A browser is a tree of processes that outlives the one that started it. The keeper holds the whole
tree: it ends it when its standard input ends (which happens however its parent ends, a SIGKILL
included), when its parent is another process, when a signal asks it to, and when the program
leaves by itself. FOLDER, unless it is empty, is removed then.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import select
import shutil
import signal
import subprocess
import sys
import time

SUBREAPER = 36  #: of prctl: orphans below this process become its own children
LOOK_S = 0.5  #: between two looks at the parent and the program
AFTER_S = 10.0  #: that killed processes get to go away


def children() -> list[int]:
    """Processes that this one is the parent of."""
    with open(f"/proc/self/task/{os.getpid()}/children") as file:
        return [int(word) for word in file.read().split()]


def end_all() -> None:
    """End what lies below this process, level by level: orphans come up as their parents go."""
    end = time.monotonic() + AFTER_S
    while time.monotonic() < end:
        for child in children():
            with contextlib.suppress(ProcessLookupError):
                os.kill(child, signal.SIGKILL)
        try:
            os.waitpid(-1, 0)
        except ChildProcessError:
            return


def leave(number: int, frame: object) -> None:
    raise SystemExit(0)


def main() -> int:
    ctypes.CDLL(None).prctl(SUBREAPER, 1, 0, 0, 0)
    signal.signal(signal.SIGTERM, leave)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is the parent's to answer
    signal.signal(signal.SIGHUP, leave)
    parent = os.getppid()
    try:
        program = subprocess.Popen(sys.argv[2:], stdin=subprocess.DEVNULL)
        while program.poll() is None and os.getppid() == parent:
            if select.select([0], [], [], LOOK_S)[0] and not os.read(0, 4096):
                return 0
        return program.returncode or 0
    finally:
        end_all()
        if sys.argv[1]:
            shutil.rmtree(sys.argv[1], ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
