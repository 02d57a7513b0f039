"""Rows of a table that are read at once: numbers, with texts and empty cells where they may be.

What a row holds beyond that is looked at field by field (rows), which takes ten times as long and
finds the same numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from relgloss_view.base import cells


@dataclass(frozen=True)
class Header:
    """The header of a table."""

    line: int  #: from 1
    columns: tuple[str, ...]  #: '' where a column has no name
    words: tuple[str, ...]  #: as the file has them, lower case
    keys: tuple[int, ...]  #: columns of angles, which every row must hold
    delimiter: str | None  #: None: any run of spaces
    beside: frozenset[int] = frozenset()  #: columns that may hold text, as they are passed over
    sample: int | None = None  #: the one of them that names the sample

    @cached_property
    def width(self) -> int:
        """Number of columns up to the last one with a name."""
        return max((k + 1 for k, name in enumerate(self.columns) if name), default=0)


@dataclass(frozen=True)
class QuickRow:
    """The numbers of a row."""

    numbers: list[float]  #: (width,), NaN where a cell says nothing or holds a text beside
    signs: list[str]  #: 'n/a' and the like
    sample: str | None  #: its name, where a column names samples


def row(line: str, header: Header, decimal_comma: bool) -> QuickRow | None:
    """The row of a line; None where it is anything but a row whose every angle is a number."""
    commas = decimal_comma and header.delimiter != ","
    fields = line.split(header.delimiter)
    if len(fields) != header.width:
        return None
    if '"' in line:
        # A quoted cell that holds a delimiter is in two parts here, with one quote each.
        if header.delimiter is None or any(f.count('"') not in (0, 2) for f in fields):
            return None
        fields = [f.strip() for f in fields]
        if any('"' in f and not f[0] == f[-1] == '"' for f in fields):
            return None
        fields = [f.strip('"') for f in fields]
    sample = None if header.sample is None else fields[header.sample].strip()
    for k in header.beside:
        fields[k] = ""
    numbers: list[float] = []
    signs: list[str] = []
    for text in fields:
        try:
            value = float(text.replace(",", ".") if commas else text)
        except ValueError:
            if not cells.says_nothing(text):
                return None
            value = float("nan")
            if text.strip():
                signs.append(text.strip())
        else:
            # Of what float() takes beyond digits the careful way knows the remedy.
            if "_" in text or abs(value) > cells.MAX_MAGNITUDE or not text.isascii():
                return None
            if value != value:
                signs.append(text.strip())
        numbers.append(value)
    if any(numbers[k] != numbers[k] for k in header.keys):
        return None
    return QuickRow(numbers, signs, sample)


def quoted(line: str, delimiter: str | None, decimal_comma: bool) -> list[str]:
    """The fields of a line of which each is quoted, with decimal points; else none."""
    line = line.rstrip()
    if not delimiter or len(line) < 2 or line[0] != '"' or line[-1] != '"':
        return []
    fields = line[1:-1].split(f'"{delimiter}"')
    return [field.replace(",", ".") for field in fields] if decimal_comma else fields
