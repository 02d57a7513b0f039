"""The profile of the window's monitor: taken from the system, kept in a file, and reported.

The file lies in state_folder() as monitor-<digest>.icc, so that a picture's display is named as any
other is. A faulty profile costs one line; sRGB, or what the scene declares, is drawn then.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.decoration import fault_line
from relgloss_view.base.errors import RelglossError
from relgloss_view.base.reading import printable
from relgloss_view.base.writing import make_folder, whole_file
from relgloss_view.display.monitor import Monitor
from relgloss_view.display.read import monitor_of
from relgloss_view.display.system.answer import Answer, Place
from relgloss_view.display.system.watch import Watch
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.places import state_folder
from relgloss_view.viewer.state.screens import LONGEST_NAME, Screen, calibration_is_loaded, takes

KEPT = 8  #: files, so that a window on each of several monitors has its own
FRESH_S = 86400.0  #: a file that was taken longer ago is marked as in use again
FIRST_ANSWER_S = 0.4  #: the first picture waits as long, and is then drawn for the right screen


class OnMonitor(Protocol):
    """The window, as far as it knows its monitor. Its methods are called on its thread."""

    headless: bool

    @property
    def system(self) -> str:
        """The window system's name, as display.system has it."""

    def monitor_place(self) -> Place | None:
        """Where the monitor lies that the window is on."""

    def gamma_ramp(self) -> Array | None:
        """The graphics card's curves of that monitor, 0 to 1, (3, n); None where it has none."""


def watched_monitor(
    model: Model, window: OnMonitor, wake: Callable[[], None]
) -> MonitorProfile | None:
    """The watched monitor of a window, after a first answer; None without a display."""
    if window.headless:
        return None
    monitor = MonitorProfile(model, window, wake)
    monitor.await_first()
    return monitor


class MonitorProfile:
    """Keeps model.screen up to date."""

    def __init__(self, model: Model, window: OnMonitor, wake: Callable[[], None]) -> None:
        self._model, self._window = model, window
        self._watch: Watch[Screen] = Watch(window.system, screen_of, wake)
        self._first = True

    def await_first(self) -> None:
        """Wait for the first answer, but not for long."""
        self._watch.look_at(self._window.monitor_place())
        self._watch.wait(FIRST_ANSWER_S)

    def each_frame(self) -> None:
        """Take another profile, and that of another monitor where the window has moved there."""
        self._watch.look_at(self._window.monitor_place())
        screen = self._watch.take()
        if screen is None:
            return
        before, self._model.screen = self._model.screen, screen
        self._report(before, screen)
        self._first = False

    def close(self) -> None:
        """End the thread."""
        self._watch.close()

    def _report(self, before: Screen, screen: Screen) -> None:
        model = self._model
        if screen.fault:
            model.report(
                f"{screen.reason}; sRGB is assumed unless the scene declares more", fault=True
            )
            return
        if not takes(model.state, screen):
            if before.file and not self._first and takes(model.state, before):
                model.report(f"{screen.reason}: pictures are drawn for what the scene declares")
            return
        if not self._first:
            model.report(f"pictures are drawn for this monitor, {screen.name} ({screen.source})")
        wanted = screen.calibration
        ramp = None if wanted is None else self._window.gamma_ramp()
        if wanted is not None and ramp is not None and not calibration_is_loaded(wanted, ramp):
            model.report(
                f"the calibration of {screen.name} is not in the graphics card, or a program that "
                "warms colours at night has changed it: load it, for example with dispwin -L, or "
                "the monitor shows something else than its profile",
                fault=True,
            )


def screen_of(answer: Answer) -> Screen:
    """What the window draws for, of a system's answer. Raises nothing."""
    profile = answer.profile
    if profile is None:
        return Screen(reason=answer.reason, fault=answer.fault)
    try:
        file = kept(profile.data, state_folder())
        monitor = monitor_of(str(file))
        prepare(monitor)
    except RelglossError as error:
        reason = f"the profile of this monitor ({profile.source}) can't be used: {error}"
        return Screen(reason=printable(reason, 300), fault=True)
    except Exception as error:  # a mistake of the program on this profile
        reason = f"the profile of this monitor can't be used: {fault_line(error)}"
        return Screen(reason=printable(reason, 300), fault=True)
    name = monitor.name if monitor.name != file.name else profile.name or profile.source
    return Screen(
        str(file),
        printable(name, LONGEST_NAME),
        profile.source,
        monitor.luminance_cd_m2,
        notes=monitor.notes,
        calibration=monitor.calibration,
    )


def prepare(monitor: Monitor) -> None:
    """Make what a monitor's way back needs, which takes a while for a table."""
    monitor.emission.digital(np.full((1, 3), 0.5))


def kept(data: bytes, folder: Path) -> Path:
    """The file that holds a profile's bytes, written where it is not there. Raises InputError."""
    file = folder / f"monitor-{hashlib.sha256(data).hexdigest()[:16]}.icc"
    try:
        state: Any = os.stat(file)
    except OSError:
        state = None
    if state is None or state.st_size != len(data):
        make_folder(folder)
        with whole_file(file, private=True) as staged:
            staged.write_bytes(data)
    elif time.time() - state.st_mtime > FRESH_S:
        with contextlib.suppress(OSError):
            os.utime(file)
    tidy(folder, file)
    return file


def tidy(folder: Path, present: Path) -> None:
    """Remove profiles of monitors beyond the last KEPT; the present one stays."""
    with contextlib.suppress(OSError):
        others = [file for file in folder.glob("monitor-*.icc") if file != present]
        others.sort(key=lambda file: file.stat().st_mtime, reverse=True)
        for file in others[KEPT - 1 :]:
            file.unlink()
