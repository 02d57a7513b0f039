"""Memory that was freed, given back to the system.

The C library keeps what is freed for what comes next, and a page that one small block still lies on
stays the process's: after 500 shader programs were freed, 1.1 GB of 1.4 GB stayed so.
"""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Callable


def give_back() -> bool:
    """Have the C library return its free pages to the system; whether it could return any.

    Only glibc is known to need it and to offer it (malloc_trim); elsewhere nothing is done. It
    takes some milliseconds for each hundred MB in use, so call it after much was freed.
    """
    trim = _trim()
    return trim is not None and trim(0) == 1


@functools.cache
def _trim() -> Callable[[int], int] | None:
    try:
        trim = ctypes.CDLL(None).malloc_trim
    except (OSError, AttributeError, TypeError):  # Windows has no library of no name
        return None
    trim.argtypes, trim.restype = [ctypes.c_size_t], ctypes.c_int
    return trim
