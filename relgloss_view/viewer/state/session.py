"""The session: the last state of the window, kept while it is open and restored after any end.

It is a scene file in state_folder(), replaced whole each time, so that a program killed at any
moment leaves the one before. Of two windows the last to write wins.
"""

from __future__ import annotations

import os
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import read_beginning
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.base.writing import make_folder
from relgloss_view.viewer.state.places import state_folder
from relgloss_view.viewer.state.state import State
from relgloss_view.viewer.state.state_file import load_state, save_state

WAIT_S = 0.5  #: from a change until it is written
WAIT_AFTER_FAULT_S = 30.0
MOST_DAMAGED = 99
MOST_BLANK_BYTES = 4096


def session_file() -> Path:
    """Where the session is kept."""
    return state_folder() / "session.toml"


class Autosave:
    """Writes the state soon after it changes.

    The loop calls `note` in every frame, `save` when it is `due` and when the window closes. A
    state that was restored is given as `written`: until it changes, the file that it came from
    stays, with the names of materials that could not be had today.
    """

    def __init__(self, path: str | os.PathLike[str], written: State | None = None) -> None:
        self.path = Path(path)
        self._noted: State | None = written
        self._written: State | None = written
        self._due_s: float | None = None  #: None until `due` has seen the change
        self._fault = ""

    def note(self, state: State) -> None:
        """Remember the present state; costs nothing while it is the same object."""
        self._noted = state

    def note_written(self, state: State) -> None:
        """Remember a state as what the file holds."""
        self._noted = self._written = state

    @property
    def changed(self) -> bool:
        """Whether the noted state is not yet in the file."""
        return self._noted is not self._written and self._noted != self._written

    def due_in(self, now_s: float) -> float | None:
        """Seconds until a save is due, 0 when it is; None where nothing has changed."""
        if not self.changed:
            self._written = self._noted  # equal: from now on the same object, too
            self._due_s = None
            return None
        if self._due_s is None:
            self._due_s = now_s + WAIT_S
        return max(self._due_s - now_s, 0.0)

    def due(self, now_s: float) -> bool:
        """Whether it is time to save, by a clock such as time.monotonic()."""
        return self.due_in(now_s) == 0.0

    def save(self, now_s: float | None = None) -> None:
        """Write the noted state, if it has changed.

        InputError where that fails, each reason once; it is tried again half a minute later.
        """
        if not self.changed or self._noted is None:
            return
        state = self._noted
        try:
            make_folder(self.path.parent)
            save_state(self.path, state, forgiving=True)
        except InputError as error:
            now_s = time.monotonic() if now_s is None else now_s
            self._due_s = now_s + WAIT_AFTER_FAULT_S
            if str(error) == self._fault:
                return
            self._fault = str(error)
            raise InputError(f"the session is not kept: {error}") from error
        self._written, self._due_s, self._fault = state, None, ""


@dataclass(frozen=True)
class Restored:
    """A session that was restored, and messages about it."""

    state: State | None = None
    messages: tuple[str, ...] = ()
    #: Names of packs by side that are still to be read: samples of the initial state stand there.
    coming: Mapping[str, str] = field(default_factory=dict)


def read_whole(
    path: str | os.PathLike[str], progress: ProgressReport = no_progress
) -> tuple[State, tuple[str, ...]]:
    """The session with its packs, which may take a while, and messages; InputError."""
    stood_in: list[str] = []
    return load_state(path, stood_in, progress=progress), tuple(stood_in)


def restore(path: str | os.PathLike[str]) -> Restored:
    """The session of a file; no state where there is none or it is damaged. Raises nothing.

    Packs are left for `read_whole`. A material or lamp that is gone is replaced by the initial
    state's, with a message. A damaged file is moved aside beside itself, so that nothing of it is
    lost.
    """
    path = Path(path)
    if not os.path.lexists(path):
        return Restored()
    try:
        if not read_beginning(path, MOST_BLANK_BYTES, "a session").strip(b"\0 \r\n"):
            return Restored()  # what some file systems leave when the power goes
    except InputError as error:
        return Restored(None, (str(error),))
    stood_in: list[str] = []
    coming: dict[str, str] = {}
    try:
        state = load_state(path, stood_in, later=coming)
        return Restored(state, tuple(stood_in), coming)
    except InputError as error:
        return Restored(None, (f"{error}; {_move_aside(path)}",))


def _move_aside(path: Path) -> str:
    """Move a damaged session out of the way of the next one; returns what became of it."""
    for number in range(1, MOST_DAMAGED + 1):
        name = f"{path.stem}-damaged{f'-{number}' if number > 1 else ''}{path.suffix}"
        aside = path.with_name(name)
        if os.path.lexists(aside) and number < MOST_DAMAGED:
            continue
        try:
            os.replace(path, aside)
        except OSError as error:
            return f"it can't be moved aside ({error.strerror}); starting afresh"
        return f"it is kept as {name}; starting afresh"
    raise AssertionError("the last name is always taken")
