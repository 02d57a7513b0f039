"""Memory that was freed, given back to the system.

The C library keeps what is freed for what comes next, and a page that one small block still lies on
stays the process's: after 500 shader programs were freed, 1.1 GB of 1.4 GB stayed so.
"""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Callable

LARGE = 1 << 20  #: bytes
M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3  #: of glibc's malloc.h


def give_back() -> bool:
    """Have the C library return its free pages to the system; whether it could return any.

    Only glibc is known to need it and to offer it (malloc_trim); elsewhere nothing is done. It
    takes some milliseconds for each hundred MB in use, so call it after much was freed.
    """
    trim = _trim()
    return trim is not None and trim(0) == 1


def keep_large_apart() -> bool:
    """Have the C library keep large blocks apart for good; whether it could be asked to.

    By default a large block that is freed makes the next ones of its size share the heap with
    small ones (glibc's threshold moves up to 32 MB). What lies above them then stays: an hour of
    pictures of all sizes leaves a heap full of holes. For a program that runs long; blocks of
    LARGE bytes and more then take a page fault for each page when they are first written.
    """
    try:
        option = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError, TypeError):
        return False
    return all(option(which, LARGE) == 1 for which in (M_MMAP_THRESHOLD, M_TRIM_THRESHOLD))


@functools.cache
def _trim() -> Callable[[int], int] | None:
    try:
        trim = ctypes.CDLL(None).malloc_trim
    except (OSError, AttributeError, TypeError):  # Windows has no library of no name
        return None
    trim.argtypes, trim.restype = [ctypes.c_size_t], ctypes.c_int
    return trim
