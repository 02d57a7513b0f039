"""Home: the thread and the process that an OpenGL context belongs to.

Elsewhere a driver crashes, refuses, or waits for ever for threads of its own that a fork leaves
behind. So whoever uses a context from there gets an error that names the remedy.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
from functools import lru_cache
from threading import get_ident

from relgloss_view.base.errors import RelglossError

FORKED = (
    "OpenGL was in use before this process was forked, and does not work after a fork; start "
    'processes by multiprocessing.get_context("spawn"), and open a renderer in each'
)
OTHER_THREAD = (
    "this renderer was opened in another thread; open a renderer in each thread, and fetch a "
    "frame's stages in the thread that drew it"
)

_first_process: int | None = None  #: that opened a context; a fork of it inherits the number


class Home:
    """The thread and the process in which it was made."""

    def __init__(self) -> None:
        """Raise RelglossError where a context can't be opened, after a fork."""
        check_process()
        _part_from_forks()
        self._thread, self._process = get_ident(), os.getpid()

    @property
    def forked(self) -> bool:
        """Whether this process was forked from the one it was made in."""
        return self._process != os.getpid()

    def check(self) -> None:
        """Raise RelglossError in another thread or process."""
        if self.forked:
            raise RelglossError(FORKED)
        if self._thread != get_ident():
            raise RelglossError(OTHER_THREAD)


def check_process() -> None:
    """Raise RelglossError in a process that was forked after a context was opened."""
    global _first_process
    process = os.getpid()
    if _first_process is None:
        _first_process = process
    if _first_process != process:
        raise RelglossError(FORKED)


@lru_cache(maxsize=1)
def _part_from_forks() -> None:
    """Let processes that are forked from this one end without the driver.

    OSMesa's last act is to wait for its threads, which a fork leaves behind: it crashes.
    """
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(after_in_child=_leave_first)


def _leave_first() -> None:
    """End this process, once Python is done, before the libraries' own last acts."""
    with contextlib.suppress(OSError, AttributeError):  # a C library without on_exit
        c = ctypes.CDLL(None)
        c.on_exit(c._exit, None)
