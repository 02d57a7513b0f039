"""Watch: the profile of the monitor that a window lies on, asked for again when it may be another.

A thread asks and prepares, so that the window waits for no server and no table.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

from relgloss_view.base.decoration import fault_line
from relgloss_view.display.system.answer import Answer, Place, Source, SystemProfile

LONGEST_WAIT_S = 30.0
END_S = 1.0  #: for which the end of the thread is waited for
#: Names of systems as a window library has them, and why there is no source.
X11, WINDOWS, MACOS, WAYLAND = "x11", "win32", "cocoa", "wayland"
ON_WAYLAND = "Wayland names no profile, and not whether the desktop applies one"

T = TypeVar("T")


def source_of(system: str) -> Source:
    """The way to ask a system; OSError with the reason where there is none."""
    if system == X11:
        from relgloss_view.display.system.colord import Colord
        from relgloss_view.display.system.x11 import XScreens

        return XScreens(None if _wayland_below() else Colord())
    if system == WINDOWS:
        from relgloss_view.display.system.windows import WindowsScreens

        return WindowsScreens()
    if system == MACOS:
        from relgloss_view.display.system.macos import MacScreens

        return MacScreens()
    raise OSError(ON_WAYLAND if system == WAYLAND else "no system with monitors")


def system_profile(place: Place | None, system: str = X11) -> SystemProfile | None:
    """The profile of the monitor at a place, by a system's name; None where there is none.

    The first monitor's where the place is None. Raises nothing.
    """
    return answer_once(place, system).profile


def answer_once(place: Place | None, system: str = X11) -> Answer:
    """A system's answer, with the reason where there is no profile."""
    try:
        source = source_of(system)
    except OSError as error:
        return Answer(None, str(error))
    try:
        return source.answer(place)
    finally:
        source.close()


class Watch(Generic[T]):
    """Asks in a thread of its own, from its making until it is closed.

    system: see source_of. prepare: makes of an answer what the window needs; called in the thread,
    and only where the answer is another one. wake: called when there is something to `take`.
    """

    def __init__(
        self, system: str, prepare: Callable[[Answer], T], wake: Callable[[], None]
    ) -> None:
        self._system, self._prepare, self._wake = system, prepare, wake
        self._source: Source | None = None
        self._place: Place | None = None
        self._ready: list[T] = []
        self._answered = threading.Event()
        self._over = False
        self._lock = threading.Lock()
        self._thread = threading.Thread(target=self._run, name="monitor", daemon=True)
        self._thread.start()

    def look_at(self, place: Place | None) -> None:
        """Ask for the monitor at this place from now on; costs nothing while it is the same."""
        if place != self._place:
            self._place = place
            self._rouse()

    def take(self) -> T | None:
        """What was made of the last answer, once; None where there is no new one."""
        with self._lock:
            last = self._ready[-1] if self._ready else None
            self._ready.clear()
            return last

    def wait(self, longest_s: float) -> bool:
        """Wait for the first answer, as long as that; returns whether it has come."""
        return self._answered.wait(longest_s)

    def close(self) -> None:
        """End the thread. One that waits for another program is left to end by itself."""
        self._over = True
        self._rouse()
        self._thread.join(END_S)

    def _rouse(self) -> None:
        with self._lock:
            if self._source is not None:
                self._source.rouse()

    def _run(self) -> None:
        try:
            source = source_of(self._system)
        except OSError as error:
            self._give(Answer(None, str(error)))
            return
        with self._lock:
            self._source = source
        try:
            self._ask(source)
        finally:
            with self._lock:
                self._source = None
            source.close()

    def _ask(self, source: Source) -> None:
        last: Answer | None = None
        asked: Place | None = None
        again = True
        while not self._over:
            place = self._place
            if again or place != asked:
                asked = place
                answer = self._answer(source, place)
                if answer != last:
                    last = answer
                    self._give(answer)
                self._answered.set()
            if getattr(source, "gone", False):
                return
            if self._place == asked and not self._over:
                again = source.wait(LONGEST_WAIT_S)

    def _answer(self, source: Source, place: Place | None) -> Answer:
        try:
            return source.answer(place)
        except Exception as error:  # the window is worth more than its monitor's profile
            return Answer(None, f"the profile of the monitor: {fault_line(error)}", fault=True)

    def _give(self, answer: Answer) -> None:
        try:
            made = self._prepare(answer)
        finally:
            self._answered.set()
        with self._lock:
            self._ready.append(made)
        self._wake()


def _wayland_below() -> bool:
    """Whether the X server is one within Wayland, whose desktop may apply profiles itself."""
    import os

    return bool(os.environ.get("WAYLAND_DISPLAY")) or (
        os.environ.get("XDG_SESSION_TYPE") == "wayland"
    )
