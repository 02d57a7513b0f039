"""One thread for linear algebra: sums of several threads differ in their last digits.

A fit amplifies such digits, so a catalogue's results would depend on the machine's processors. The
libraries read their variables once, when they are loaded; a process that is at work already has to
be asked. The wheels of numpy and scipy bring OpenBLAS, one each. Other builds have to be started
with cluster_worker.ONE_THREAD.
"""

from __future__ import annotations

import contextlib
import ctypes
from collections.abc import Callable, Iterator
from functools import lru_cache
from pathlib import Path

#: How OpenBLAS's functions are called in the wheels of numpy, of scipy, and elsewhere.
NAMES = (
    "scipy_openblas_{}_num_threads64_",
    "scipy_openblas_{}_num_threads",
    "openblas_{}_num_threads64_",
    "openblas_{}_num_threads",
)


@contextlib.contextmanager
def one_thread() -> Iterator[None]:
    """A block in which the OpenBLAS of this process has one thread; as before at its end."""
    with contextlib.ExitStack() as stack:
        for read, write in _libraries():
            stack.callback(write, read())
            write(1)
        yield


def thread_counts() -> list[int]:
    """Threads of each OpenBLAS that this process has loaded."""
    return [read() for read, _ in _libraries()]


@lru_cache(maxsize=1)
def _libraries() -> tuple[tuple[Callable[[], int], Callable[[int], object]], ...]:
    """How to read and how to set the number of threads of each."""
    import numpy  # noqa: F401 - brings its library
    import scipy.linalg  # noqa: F401 - brings another one

    pairs = []
    for path in _loaded():
        try:
            library = ctypes.CDLL(path)
        except OSError:
            continue
        for name in NAMES:
            with contextlib.suppress(AttributeError):
                read, write = (library[name.format(verb)] for verb in ("get", "set"))
                pairs.append((read, write))
                break
    return tuple(pairs)


def _loaded() -> list[str]:
    """Files of the OpenBLAS libraries that this process has loaded, where /proc shows them."""
    try:
        maps = Path("/proc/self/maps").read_text(encoding="utf-8", errors="surrogateescape")
    except OSError:
        return []
    paths = (line.split(maxsplit=5)[-1] for line in maps.splitlines() if "openblas" in line)
    return sorted(set(paths))
