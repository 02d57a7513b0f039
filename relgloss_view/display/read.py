"""The monitor of a file: an ICC profile or a display file, by its content."""

from __future__ import annotations

import os
from collections import OrderedDict

from relgloss_view.base.errors import InputError
from relgloss_view.base.icc.profile import MOST_BYTES
from relgloss_view.base.reading import read_bytes
from relgloss_view.display.icc_monitor import monitor_of_profile
from relgloss_view.display.monitor import Monitor

EXPECTED = "an ICC profile or a display file"
KEPT = 16
_READ: OrderedDict[str, tuple[tuple[int, int], Monitor]] = OrderedDict()


def monitor_of(path: str) -> Monitor:
    """The monitor of a file. An edited file is read again; one that is gone stays as it was read.

    The same object is returned while the file is the same. Raises InputError where it is neither.
    """
    try:
        state = os.stat(path)
        stamp = state.st_mtime_ns, state.st_size
    except (OSError, ValueError):
        if path in _READ:
            return _READ[path][1]
        stamp = (0, 0)
    if path in _READ and _READ[path][0] == stamp:
        _READ.move_to_end(path)
        return _READ[path][1]
    monitor = _read(path)
    while len(_READ) >= KEPT:
        _READ.popitem(last=False)
    _READ[path] = stamp, monitor
    return monitor


def _read(path: str) -> Monitor:
    data = read_bytes(path, MOST_BYTES, EXPECTED)
    try:
        return monitor_of_profile(data, os.path.basename(path))
    except ValueError as error:
        raise InputError(f"{path}: {error}") from None
