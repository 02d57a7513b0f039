"""Work in a process of its own, for libraries that may end theirs or would hold others up.

A child has a process group of its own: Ctrl-C in a terminal reaches the program alone, which ends
its children. Should the program be killed, a child that follows it (followed.py) leaves by itself.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from relgloss_view.base import followed
from relgloss_view.base.interruptions import SIGNALS, STEP_S, checkpoint

PACKAGE_FOLDER = Path(__file__).resolve().parents[2]
LONGEST_S = 120.0

_running: set[subprocess.Popen[Any]] = set()


@dataclass(frozen=True)
class Outcome:
    """How a child ended, and what it printed."""

    status: int | None  #: negative where a signal ended it; None where it took too long
    out: str
    err: str

    @property
    def crash(self) -> str:
        """By what it ended before it was done; empty where it ended by itself."""
        if self.status is None:
            return f"no answer within {LONGEST_S:g} s"
        if self.status >= 0:
            return ""
        try:
            name = f" ({signal.Signals(-self.status).name})"
        except ValueError:
            name = ""
        return f"crashed with signal {-self.status}{name}"


class Child:
    """A process that ends with this program. Options as for subprocess.Popen.

    followed: its standard input is the pipe that `followed.follow` watches. Raises OSError or
    ValueError where no process can be made.
    """

    def __init__(self, words: Sequence[str], *, followed: bool = False, **options: Any) -> None:
        SIGNALS.before_leaving(end_all)
        if os.name == "posix":
            options["process_group"] = 0
        self._pipe: int | None = None  #: stays open as long as this program lives
        if followed:
            options["stdin"], self._pipe = os.pipe()
        try:
            self.process: subprocess.Popen[Any] = subprocess.Popen(words, **options)
        except BaseException:
            self._close_pipe()
            raise
        finally:
            if followed:
                os.close(options["stdin"])
        _running.add(self.process)

    def kill(self) -> None:
        """End the process; `close` follows."""
        self.process.kill()

    def close(self) -> None:
        """End the process unless it has ended, and close its pipes."""
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        _running.discard(self.process)
        self._close_pipe()
        for pipe in (self.process.stdin, self.process.stdout, self.process.stderr):
            if pipe is not None:
                try:
                    pipe.close()
                except OSError:  # it holds what the dead process did not read
                    continue

    def outcome(self, longest_s: float, step: Callable[[], object] = bool) -> Outcome:
        """Wait for the end, with checkpoints. A process that takes too long is ended.

        step: called at each of them; where it raises, the process is ended too.
        """
        end_s = time.monotonic() + longest_s
        try:
            while True:
                checkpoint()
                step()
                try:
                    printed = self.process.communicate(timeout=STEP_S)
                except subprocess.TimeoutExpired:
                    if time.monotonic() > end_s:
                        return Outcome(None, "", "")
                    continue
                out, err = (text.decode("utf-8", "replace") for text in printed)
                return Outcome(self.process.returncode, out, err)
        finally:
            self.close()

    def _close_pipe(self) -> None:
        if self._pipe is not None:
            os.close(self._pipe)
            self._pipe = None


def end_all() -> None:
    """End all children now, before an end of the program that closes none."""
    for process in tuple(_running):
        process.kill()


def run(words: Sequence[str], longest_s: float) -> Outcome:
    """Run a program of the system to its end; it gets no input. Raises OSError."""
    pipe, null = subprocess.PIPE, subprocess.DEVNULL
    return Child(words, stdin=null, stdout=pipe, stderr=pipe).outcome(longest_s)


def run_module(module: str, *words: str) -> Outcome:
    """Run a module of this package as `python -m` does, with the same interpreter and variables."""
    path = os.pathsep.join(filter(None, (str(PACKAGE_FOLDER), os.environ.get("PYTHONPATH"))))
    child = Child(
        [sys.executable, "-m", followed.__name__, module, *words],
        followed=True,
        env={**os.environ, "PYTHONPATH": path},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    return child.outcome(LONGEST_S)
