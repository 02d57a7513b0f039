"""The monitor of a file: an ICC profile or a display file, by its content."""

from __future__ import annotations

import os
import threading
from collections import OrderedDict

from relgloss_view.base.errors import InputError
from relgloss_view.base.icc.profile import MOST_BYTES
from relgloss_view.base.reading import read_bytes
from relgloss_view.base.shell import command_line, operand
from relgloss_view.display.monitor import Monitor

EXPECTED = "an ICC profile or a display file"
KEPT = 16
_READ: OrderedDict[str, tuple[tuple[tuple[int, int] | None, ...], Monitor]] = OrderedDict()
_LOCK = threading.Lock()  #: the window's thread that watches the monitor reads, too


def monitor_of(path: str) -> Monitor:
    """The monitor of a file. An edited file is read again; one that is gone stays as it was read.

    The same object is returned while the file is the same. Raises InputError where it is neither.
    """
    stamp = _stamp(path)
    with _LOCK:
        if path in _READ:
            before, monitor = _READ[path]
            if stamp is None or before == (stamp, *(_stamp(p) for p in monitor.beside)):
                _READ.move_to_end(path)
                return monitor
        monitor = _read(path)
        while len(_READ) >= KEPT:
            _READ.popitem(last=False)
        _READ[path] = (stamp, *(_stamp(p) for p in monitor.beside)), monitor
        return monitor


def _stamp(path: str) -> tuple[int, int] | None:
    """Time and size of a file; None where it is gone."""
    try:
        state = os.stat(path)
    except (OSError, ValueError):
        return None
    return state.st_mtime_ns, state.st_size


def _read(path: str) -> Monitor:
    # Imported where a file is read: a command without one starts sooner.
    from relgloss_view.display.display_file import is_display_file, read_display
    from relgloss_view.display.icc_monitor import monitor_of_profile
    from relgloss_view.display.readings import is_readings

    data = read_bytes(path, MOST_BYTES, EXPECTED)
    if is_display_file(data):
        return read_display(path)
    if data[36:40] != b"acsp" and is_readings(data):
        words = ["relgloss", "display", operand(path), "-o", "monitor.toml"]
        raise InputError(
            f"{path}: these are readings of a display; fit a model to them, and give its file: "
            f"{command_line(words)}"
        )
    try:
        return monitor_of_profile(data, os.path.basename(path))
    except ValueError as error:
        raise InputError(f"{path}: {error}") from None
