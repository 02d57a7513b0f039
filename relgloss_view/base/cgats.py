"""CGATS text: keywords, fields by name, sets of values; several tables in a file.

Sources: ANSI CGATS.17 and ISO 28178. Argyll's .ti3, .cie and .sp are the same. What the fields mean
is the reader's: measure/readers/cgats.py of samples, display/readings_cgats.py of a display.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from relgloss_view.base import cells
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.text_lines import TextLines

MAX_BYTES = 32 * 1024 * 1024
MOST_LINES = 500_000
LONGEST_LINE = 200_000
MOST_FIELDS = 5_000
MOST_FIELDS_IN_ALL = 50_000  #: of all tables
MOST_SETS = 30_000
MOST_KEYWORDS = 2_000
MOST_TABLES = 1_000

_TOKEN = re.compile(r'"([^"]*)"|(\S+)')

Take = Callable[[int, list[str]], None]  #: of a set: its first line, its values


@dataclass
class Table:
    """One BEGIN_DATA_FORMAT ... END_DATA of a file; keywords of the tables above it count too."""

    fields: list[str] = field(default_factory=list)
    keywords: dict[str, str] = field(default_factory=dict)

    def column(self, names: tuple[str, ...]) -> int | None:
        """The column of the first of some fields that is there."""
        upper = {name.upper(): k for k, name in reversed(list(enumerate(self.fields)))}
        return next((upper[name] for name in names if name in upper), None)

    def numbers(
        self, path: Path, line: int, words: list[str], columns: tuple[int, ...]
    ) -> list[float]:
        """The numbers of a set in some columns, NaN where a cell says nothing. InputError."""
        values = []
        for k in columns:
            text = words[k].strip()
            try:
                text = text.replace(",", ".") if text.count(",") == 1 else text
                values.append(cells.reading(text))
            except InputError as error:
                raise InputError(
                    f"{path}: line {line}, field {self.fields[k][:30]}: found "
                    f"{printable(words[k], 30)!r}, expected a number; {error}"
                ) from None
        return values


def read_tables(path: Path, expected: str, begin: Callable[[Table], Take]) -> list[str]:
    """Read a file set by set; returns notes on what is missing or only likely.

    begin: called at the data of each table, returns what takes its sets. Raises InputError that
    names the line.
    """
    limits = {"most_bytes": MAX_BYTES, "most_lines": MOST_LINES, "longest_line": LONGEST_LINE}
    notes: list[str] = []
    with TextLines(path, expected, **limits) as text:
        if text.note:
            notes.append(text.note)
        _read(path, enumerate(text.lines(), 1), begin, notes)
    return notes


def _read(
    path: Path, lines: Iterator[tuple[int, str]], begin: Callable[[Table], Take], notes: list[str]
) -> None:
    table = Table()
    tables = fields = sets = 0
    for number, line in lines:
        words = _words(line)
        if not words:
            continue
        first = words[0].upper()
        if first == "BEGIN_DATA_FORMAT":
            table.fields = _format(path, number, words[1:], lines)
            fields += len(table.fields)
            if fields > MOST_FIELDS_IN_ALL:
                raise InputError(
                    f"{path}: line {number}: more than {MOST_FIELDS_IN_ALL} fields; split it"
                )
        elif first == "BEGIN_DATA":
            tables += 1
            if tables > MOST_TABLES:
                raise InputError(f"{path}: line {number}: more than {MOST_TABLES} tables; split it")
            if not table.fields:
                raise InputError(
                    f"{path}: line {number}: data without fields; a BEGIN_DATA_FORMAT must stand "
                    "above it"
                )
            sets += _read_rows(path, table, lines, begin(table), MOST_SETS - sets, notes)
        elif len(words) > 1 and len(table.keywords) < MOST_KEYWORDS:
            table.keywords[first] = " ".join(words[1:])[:200]


def _words(line: str) -> list[str]:
    """The tokens of a line, quotes removed; none of a comment."""
    if line.lstrip().startswith("#"):
        return []
    return [quoted or plain for quoted, plain in _TOKEN.findall(line)]


def _format(
    path: Path, start: int, words: list[str], lines: Iterator[tuple[int, str]]
) -> list[str]:
    fields: list[str] = []
    while True:
        for k, word in enumerate(words):
            if word.upper() == "END_DATA_FORMAT":
                return fields + words[:k]
        fields += words
        if len(fields) > MOST_FIELDS:
            raise InputError(f"{path}: line {start}: more than {MOST_FIELDS} fields")
        following = next(lines, None)
        if following is None:
            raise InputError(
                f"{path}: line {start}: the file ends before END_DATA_FORMAT; it is cut off"
            )
        words = _words(following[1])


def _read_rows(
    path: Path,
    table: Table,
    lines: Iterator[tuple[int, str]],
    take: Take,
    most: int,
    notes: list[str],
) -> int:
    """Take the sets of one table, at most `most`; returns how many there are."""
    width = len(table.fields)
    pending: list[str] = []
    begun = count = 0
    for number, line in lines:
        words = _words(line)
        if not words:
            continue
        if words[0].upper() == "END_DATA":
            break
        if "\t" in line and len(words) != width:
            # Names with spaces, and empty cells, stand between tabs.
            cells_of_line = [cell.strip().strip('"') for cell in line.strip("\r\n").split("\t")]
            while len(cells_of_line) > width and not cells_of_line[-1]:
                cells_of_line.pop()
            if len(cells_of_line) == width:
                words = cells_of_line
        if not pending:
            begun = number
        pending += words
        if len(pending) > width:
            raise InputError(
                f"{path}: line {number}: {len(pending)} values of a set of {width} fields; put "
                "names with spaces in quotes"
            )
        if len(pending) == width:
            count += 1
            if count > most:
                raise InputError(f"{path}: more than {MOST_SETS} sets; split the file")
            take(begun, pending)
            pending = []
    else:
        if not pending:
            notes.append("END_DATA is missing: the file may be cut off")
    if pending:
        raise InputError(
            f"{path}: line {begun}: a set of {len(pending)} values; {width} fields are declared"
        )
    return count
