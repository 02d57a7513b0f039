"""Work in a process of its own, for libraries that may end the process they are in."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

PACKAGE_FOLDER = Path(__file__).resolve().parents[2]
LONGEST_S = 120.0


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


def run_module(module: str, *words: str) -> Outcome:
    """Run a module of this package as `python -m` does, with the same interpreter and variables."""
    path = os.pathsep.join(filter(None, (str(PACKAGE_FOLDER), os.environ.get("PYTHONPATH"))))
    try:
        done = subprocess.run(
            [sys.executable, "-m", module, *words],
            env={**os.environ, "PYTHONPATH": path},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=LONGEST_S,
        )
    except subprocess.TimeoutExpired:
        return Outcome(None, "", "")
    out, err = (printed.decode("utf-8", "replace") for printed in (done.stdout, done.stderr))
    return Outcome(done.returncode, out, err)
