"""The terminal: tables in columns, warnings, and a progress bar where someone watches.

These few lines stand in for the library rich. Measured on two cores with CPython 3.11, importing
rich.console and rich.table takes 0.19 s of processor time, where the interpreter with argparse
takes 0.09 s and `relgloss --help` as a whole 0.17 s. Every command that prints a table would pay
for it, and `relgloss --help` has to stay below 0.25 s.
"""

from __future__ import annotations

import contextlib
import io
import os
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Any, TextIO

from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.reading import printable
from relgloss_view.base.visible import visible

BAR_WIDTH = 24
GAP = "  "  #: between two columns of a table
WARNING_LENGTH = 300  #: characters of a warning that are printed

#: Receives the share that is done, 0 to 1, and what is being done.
ProgressReport = Callable[[float, str], object]


def no_progress(share: float, text: str) -> None:
    """A ProgressReport that shows nothing: the default where nobody watches."""


@dataclass(frozen=True)
class Column:
    """A column of a table: its heading, its smallest width, and where its cells align."""

    heading: str = ""  #: a line break in it makes a second line of headings
    width: int = 0  #: in characters; a longer cell or heading widens the column
    left: bool = False  #: words align to the left, numbers to the right

    def fit(self, text: str, width: int) -> str:
        """The text, padded to the column."""
        return text.ljust(width) if self.left else text.rjust(width)


def table(columns: Sequence[Column], rows: Iterable[Sequence[str]], *, indent: str = "") -> str:
    """Rows of cells as lines of aligned columns under their headings.

    A cell is one line: its control characters are shown. Every row has a cell for each column;
    ValueError otherwise. Without any heading there is no line of headings.
    """
    cells = [tuple(map(visible, row)) for row in rows]
    parts = [column.heading.split("\n") for column in columns]
    depth = max(len(part) for part in parts)
    headings = list(zip(*(part + [""] * (depth - len(part)) for part in parts), strict=True))
    lines = [*headings, *cells] if any(column.heading for column in columns) else cells
    if not lines:
        return ""
    by_column = zip(columns, zip(*lines, strict=True), strict=True)
    widths = [max(column.width, *map(len, texts)) for column, texts in by_column]
    fitted = (
        GAP.join(column.fit(*cell) for column, *cell in zip(columns, line, widths, strict=True))
        for line in lines
    )
    return "\n".join((indent + line).rstrip() for line in fitted)


class SafeStream:
    """A text stream that shows control characters of what is printed, and never fails.

    Whatever a name in a file holds, it can't colour, clear or retitle the terminal. Everything that
    the command prints goes through it: results, warnings, errors, usage. From the first error of
    the stream on nothing more is printed, while the work goes on: `fault` keeps the error.
    """

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream
        self.fault: OSError | None = None  #: ConnectionError where the reader has closed the pipe

    def write(self, text: str) -> int:
        """Print text; lines may end in it."""
        self.write_raw(visible(text, keep="\n"))
        return len(text)

    def write_raw(self, text: str) -> None:
        """Send text as it is; for the progress bar."""
        self._attempt(lambda: self.stream.write(text))

    def writelines(self, lines: Iterable[str]) -> None:
        """Print texts."""
        for line in lines:
            self.write(line)

    def flush(self) -> None:
        """Send what is still in memory."""
        self._attempt(self.stream.flush)

    def _attempt(self, action: Callable[[], object]) -> None:
        if self.fault is not None:
            return
        try:
            action()
        except OSError as error:
            self.fault = error
            self._drop()

    def _drop(self) -> None:
        """Send what is still in memory to the null device, or Python's end would fail on it."""
        with contextlib.suppress(OSError, ValueError):
            null = os.open(os.devnull, os.O_WRONLY)
            try:
                os.dup2(null, self.stream.fileno())
                self.stream.flush()
            finally:
                os.close(null)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)


def make_streams_safe() -> None:
    """Let standard output and standard error print any name and obey none."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # whatever the terminal's encoding
        if not isinstance(stream, SafeStream):
            setattr(sys, name, SafeStream(stream))


def warn(text: str, limit: int = WARNING_LENGTH) -> None:
    """Print a warning on standard error, made fit to print in at most so many characters."""
    print(f"warning: {printable(text, limit)}", file=sys.stderr)


class Progress:
    """A ProgressReport that draws a bar on standard error, and clears it when its block ends.

    The text it is given may come from outside. Each report is a checkpoint. logged_s: where nobody
    watches (standard error is a file), a line after each so many seconds; no line without it.
    """

    def __init__(self, label: str, logged_s: float | None = None) -> None:
        self.label, self.logged_s = visible(label), logged_s
        self._logged_at = time.monotonic()
        stream = sys.stderr
        self._stream = stream if isinstance(stream, SafeStream) else SafeStream(stream)
        self._watched = self._stream.isatty()
        self._longest = 0

    def __call__(self, share: float, text: str = "") -> bool:
        """Show the state; True asks the caller to continue."""
        checkpoint()
        if self._watched:
            filled = round(BAR_WIDTH * min(max(share, 0.0), 1.0))
            line = f"{self.label} [{'=' * filled}{' ' * (BAR_WIDTH - filled)}] {visible(text)}"[
                :100
            ]
            self._longest = max(self._longest, len(line))
            self._send("\r" + line.ljust(self._longest))
        elif self.logged_s is not None and time.monotonic() - self._logged_at >= self.logged_s:
            self._logged_at = time.monotonic()
            self._send(f"{self.label}: {visible(text)}\n")
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
            self._send("\r" + " " * self._longest + "\r")

    def _send(self, text: str) -> None:
        self._stream.write_raw(text)  # its own "\r" is meant
        self._stream.flush()
