"""What Windows and macOS have in common: they are asked again once in a while."""

from __future__ import annotations

import threading

STEP_S = 0.5  #: between questions, which cost little there


class Asked:
    """The waiting of a source that learns of a change by asking again."""

    def __init__(self) -> None:
        self._roused = threading.Event()

    def wait(self, longest_s: float) -> bool:
        """Sleep for a step, or until `rouse`; another answer may always be right."""
        self._roused.wait(min(longest_s, STEP_S))
        self._roused.clear()
        return True

    def rouse(self) -> None:
        """End a wait now."""
        self._roused.set()

    def close(self) -> None:
        """Nothing is held."""
