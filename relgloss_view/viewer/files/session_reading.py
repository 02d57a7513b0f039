"""The packs of the last session, read while the window already shows the rest of it.

A large artwork takes seconds. Until it is there, its picture's place stays empty, and the session's
file stays as it is.
"""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Mapping
from typing import Any

from relgloss_view.viewer.files.open_job import Opened
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.session import read_whole
from relgloss_view.viewer.state.state import SIDES, Side, State


class SessionReading:
    """One reading: `read` in a job's thread, then `take` in the window's."""

    def __init__(self, model: Model, path: str | os.PathLike[str], coming: Mapping[str, str]):
        self.path = os.fspath(path)
        self._model = model
        self._began = model.state
        self._messages: tuple[str, ...] = ()
        model.coming = {
            side: (name, self._began.side(side).sample) for side, name in coming.items()
        }

    @property
    def title(self) -> str:
        """What is read, for the progress."""
        return ", ".join(name for name, _ in self._model.coming.values())

    def read(self, report: Callable[[float, str], object]) -> Opened:
        """Read the session with its packs. Raises InputError, or what `report` raises."""
        state, self._messages = read_whole(self.path, report)
        return Opened(self.path, state=state)

    def take(self, opened: Opened | None, fault: str = "") -> State | None:
        """Put the packs in their places, also in what undo brings back; returns the whole session.

        None where it was cancelled or has failed: the initial samples stay in the places.
        """
        model, title = self._model, self.title
        model.coming = {}
        if opened is None or opened.state is None:
            reason = fault or f"{title}: opening was cancelled"
            model.report(f"{reason} (a built-in sample is used)", fault=True)
            return None
        whole = opened.state
        model.history.amend_all(lambda state: arrived(state, self._began, whole))
        for text in self._messages:
            model.report(text, fault=True)
        return whole


def arrived(present: State, began: State, whole: State) -> State:
    """A state in which the whole session takes the place of what the window began with.

    What was changed meanwhile stays.
    """
    parts: dict[str, Any] = {
        name: _kept(present, began, whole, name) for name in ("setup", "presentation", "match")
    }
    for side in SIDES:
        sides = present.side(side), began.side(side), whole.side(side)
        parts[side] = Side(_kept(*sides, "sample"), _kept(*sides, "look"))
    return dataclasses.replace(present, **parts)


def _kept(present: object, began: object, whole: object, name: str) -> Any:
    own = getattr(present, name)
    return getattr(whole, name) if own == getattr(began, name) else own
