"""CSV tables whose texts a spreadsheet shows and never runs, and that are read back exactly.

A spreadsheet takes a cell that begins with = + - @ for a formula, which may fetch an address or
start a program (OWASP, "CSV injection"). Such a text is written with an apostrophe before it. So
are one that begins with an apostrophe itself, and one that has characters nobody sees. After such
an apostrophe a backslash begins an escape, as in Python. Numbers are written as they are.
"""

from __future__ import annotations

import codecs
import csv
import io
import numbers
import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import decoding, read_text
from relgloss_view.base.visible import escape, is_seen

MARK = "'"
MOST_BYTES = 64 * 1024 * 1024
EXPECTED = "a table (CSV) that relgloss wrote"
FORMULA_BEGINS = "=+-@＝＋－＠"  # the wide ones are taken for the others in some languages
_ESCAPED = re.compile(r"\\(?:x[0-9a-f]{2}|u[0-9a-f]{4}|U[0-9a-f]{8}|[\\nrt])")


def cell(value: object) -> object:
    """A value as its cell: numbers as they are, a text marked and escaped where it needs that.

    >>> cell("=1+1"), cell("uncoated"), cell(-0.5)
    ("'=1+1", 'uncoated', -0.5)
    """
    if value is None or isinstance(value, numbers.Number):
        return value
    text = str(value)
    if all(map(is_seen, text)) and not text.lstrip().startswith((MARK, *FORMULA_BEGINS)):
        return text
    return MARK + "".join("\\\\" if c == "\\" else c if is_seen(c) else escape(c) for c in text)


def text_of(read: str) -> str:
    """The text that a cell was written from.

    >>> text_of("'=1+1"), text_of("uncoated")
    ('=1+1', 'uncoated')
    """
    if not read.startswith(MARK):
        return read
    return _ESCAPED.sub(lambda match: codecs.decode(match[0], "unicode_escape"), read[1:])


def write_csv(path: Path, heads: Sequence[object], rows: Iterable[Sequence[object]]) -> None:
    """Write a table with its heads (UTF-8, commas); fields are quoted where they need it."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        for row in (heads, *rows):
            writer.writerow([cell(value) for value in row])


def read_csv(path: Path) -> list[list[str]]:
    """The rows of a table that `write_csv` wrote, its heads first, as texts. Raises InputError."""
    text = read_text(path, MOST_BYTES, EXPECTED)
    with decoding(path, EXPECTED):
        rows = csv.reader(io.StringIO(text, newline=""))
        try:
            return [[text_of(read) for read in row] for row in rows]
        except csv.Error as error:
            raise InputError(f"{path}: line {rows.line_num}: {error}; give {EXPECTED}") from error
