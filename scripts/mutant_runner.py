"""Runs pytest again and again for scripts/mutants.py, each time in a fork of one process.

The libraries that the tests need are imported once; the package under test is imported in the fork.
Each line of standard input is a JSON object: `words` for pytest, `folder`, `limit_s`, `log`. Each
line of output is an exit status, or 124 where the time was up.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import time

import colour  # noqa: F401
import moderngl  # noqa: F401
import numpy as np  # noqa: F401
import pytest
import scipy.optimize
import scipy.special
import scipy.stats  # noqa: F401

TIMED_OUT = 124


def main() -> None:
    for line in sys.stdin:
        request = json.loads(line)
        child = os.fork()
        if child == 0:
            os.setsid()
            os.chdir(request["folder"])
            log = os.open(request["log"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(log, 1)
            os.dup2(log, 2)
            sys.dont_write_bytecode = request["keep_bytecode"]
            status = int(pytest.main(request["words"]))
            sys.stdout.flush()
            os._exit(status)
        print(waited(child, request["limit_s"]), flush=True)


def waited(child: int, limit_s: float) -> int:
    """The exit status of a process group's leader, ended when its time is up."""
    until = time.monotonic() + limit_s
    while True:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status)
        if time.monotonic() > until:
            os.killpg(child, signal.SIGKILL)
            os.waitpid(child, 0)
            return TIMED_OUT
        time.sleep(0.02)


if __name__ == "__main__":
    main()
