"""In a child process: leave when the program that has started it ends, however it ends.

The child's standard input is the reading end of a pipe that the program never writes to (child.py).
As a program, this module runs another one under that watch: `python -m relgloss_view.base.followed
MODULE WORDS...`.
"""

from __future__ import annotations

import _thread
import os
import stat
import sys

LEFT_ALONE = 1  #: exit status of a child whose program has ended
_INPUT = 0


def follow() -> None:
    """Watch the pipe in a thread, from now on; does nothing where standard input is no pipe."""
    try:
        watched = stat.S_ISFIFO(os.fstat(_INPUT).st_mode)
    except OSError:
        return
    if watched:
        _thread.start_new_thread(_leave_at_the_end, ())


def _leave_at_the_end() -> None:
    while os.read(_INPUT, 1):
        continue
    os._exit(LEFT_ALONE)


if __name__ == "__main__":
    follow()
    import runpy

    del sys.argv[0]
    runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
