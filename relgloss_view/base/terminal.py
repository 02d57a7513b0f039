"""A progress bar on standard error, drawn only where someone watches."""

from __future__ import annotations

import sys
from types import TracebackType

WIDTH = 24


class Progress:
    """Call it with a share done, 0 to 1, and what is being done; clears its line at the end."""

    def __init__(self, label: str) -> None:
        self.label = label
        self._watched = sys.stderr.isatty()
        self._longest = 0

    def __call__(self, fraction: float, text: str = "") -> bool:
        """Show the state; always asks to go on."""
        if self._watched:
            filled = round(WIDTH * min(max(fraction, 0.0), 1.0))
            line = f"{self.label} [{'=' * filled}{' ' * (WIDTH - filled)}] {text}"[:100]
            self._longest = max(self._longest, len(line))
            sys.stderr.write("\r" + line.ljust(self._longest))
            sys.stderr.flush()
        return True

    def __enter__(self) -> Progress:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._watched and self._longest:
            sys.stderr.write("\r" + " " * self._longest + "\r")
            sys.stderr.flush()
