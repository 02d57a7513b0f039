"""Undo and redo: whole states, one step for each gesture."""

from __future__ import annotations

from collections.abc import Callable

from relgloss_view.viewer.state.state import State

LONGEST = 500  #: steps; states share what they have in common


class History:
    """The present state, and those before and after it."""

    def __init__(self, state: State) -> None:
        self.state = state
        self._past: list[State] = []
        self._future: list[State] = []
        self._gesture: object = None

    def change(self, state: State, gesture: object = None) -> None:
        """Make a state the present one.

        Changes of one gesture (an object that is equal for all of them, such as the slider that is
        being dragged) make one step together; None is always a step of its own.
        """
        if state == self.state:
            return
        if gesture is None or gesture != self._gesture:
            self._past.append(self.state)
            del self._past[:-LONGEST]
        self._future.clear()
        self._gesture = gesture
        if self._past[-1] == state:  # the hand has come back to where it began: no step
            state = self._past.pop()
            self._gesture = None
        self.state = state

    def amend(self, state: State) -> None:
        """Replace the present state without a step: another form of it that draws the same."""
        self.state = state

    def amend_all(self, change: Callable[[State], State]) -> None:
        """Replace the present state and those before and after it, as where a file has changed.

        An undo then never brings back what is in no file any more.
        """
        self._past = [change(state) for state in self._past]
        self._future = [change(state) for state in self._future]
        self.state = change(self.state)

    def end_gesture(self) -> None:
        """Let the next change be a step of its own."""
        self._gesture = None

    @property
    def can_undo(self) -> bool:
        """Whether there is a state before this one."""
        return bool(self._past)

    @property
    def can_redo(self) -> bool:
        """Whether there is a state that was undone."""
        return bool(self._future)

    def undo(self) -> bool:
        """Go back one step; returns whether there was one."""
        return self._step(self._past, self._future)

    def redo(self) -> bool:
        """Go forward one step; returns whether there was one."""
        return self._step(self._future, self._past)

    def _step(self, source: list[State], other: list[State]) -> bool:
        self._gesture = None
        if not source:
            return False
        other.append(self.state)
        self.state = source.pop()
        return True
