"""Text tables as instruments and spreadsheets save them: comments, a header, rows of numbers.

The header is looked for: lines above it, empty rows, blank columns, averages below the data and
remarks are passed over and reported once. What could be a faulty row is refused with its place.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.base.cells import MAX_MAGNITUDE
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.text_lines import TextLines
from relgloss_view.base.two_columns import MARK_RATIO, MARKS
from relgloss_view.measure.readers.header import (
    PADDING,
    SEPARATOR_LINE,
    check_columns,
    find_header,
    read_header,
    uncommented,
)
from relgloss_view.measure.readers.headings import angle_heading, has_percent, is_wavelength
from relgloss_view.measure.readers.joined import refuse_contradiction
from relgloss_view.measure.readers.quick_rows import Header
from relgloss_view.measure.readers.rows import RowReader, Rows, has_decimal_commas

#: Beyond these a table is not a gonio scan, and reading it would exhaust the memory.
MAX_BYTES = 400_000_000
MAX_ROWS = 1_000_000
MAX_LINES = 1_500_000  #: with comments and blank lines
MAX_VALUES = 16_000_000  #: rows times columns: 128 MB, and a measurement takes that a few times
MOST_COMMENTS = 10_000  #: keys of comments that are kept
VALUES_AT_ONCE = 1 << 20
EXPECTED = "a measured table"

#: What a table declares: `# key: value` or, above the header, `key,value`.
DECLARATIONS = (
    "name", "source", "quantity", "gamma_s_deg", "aperture_sd_deg", "saturation", "angle_unit",
)  # fmt: skip
_ONCE = DECLARATIONS[2:]
_NAMES = ("name", "sample", "specimen")
#: What other programs begin a comment with.
_MARKS = re.compile(r"^(?:[%!*;']+|//+)\s*")
_EMPTY_CELLS = re.compile(r'(?:[,;\t|]\s*"")+$')
_OPEN_QUOTE = re.compile(r'(?:^|[,;\t|])\s*"[^"]*$')
_CLOSED_QUOTE = re.compile(r'[^"]*"\s*(?:$|[,;\t|])')
MOST_LINES_OF_CELL = 8


@dataclass(frozen=True)
class TextTable:
    """A parsed table. Empty fields are NaN; every other value is finite."""

    path: Path
    comments: dict[str, tuple[int, str]]  #: lower-case key -> (line, value)
    columns: tuple[str, ...]
    header_line: int
    values: Array  #: (N, C)
    lines: Ints  #: (N,), line number of each row in the file, from 1
    numbers: tuple[int, ...] = ()  #: (C,), number of each column in the file, from 1
    radians: frozenset[str] = frozenset()  #: angle columns whose heading or row of units says so
    decimal_comma: bool = False
    percent: bool = False  #: whether headings, row of units or cells have percent
    heading: str = ""  #: of a column of single readings
    samples: tuple[str, ...] = ()  #: names in a column that names the sample of each row
    sample_of: Ints | None = None  #: (N,), which of them, where there are several
    notes: tuple[str, ...] = ()  #: what was passed over

    def at(self, row: int, column: int) -> str:
        """The place of a value, for messages: 'FILE: line 7, column 3 (gamma_deg)'."""
        return (
            f"{self.path}: line {self.lines[row]}, column {self.numbers[column]} "
            f"({self.columns[column]})"
        )


def parse(path: Path, layouts: Sequence[Collection[str]] = ()) -> TextTable:
    """Read a delimited text table (comma, semicolon, tab or spaces; any usual encoding).

    layouts: the angle columns of each kind of table that is looked for. The header is the first
    line that holds all of one, in any spelling; else the one that holds most; else the first line.
    Raises InputError that names file, line, column and remedy.

    The file is read line by line, so that memory is taken for its numbers and not for its text.
    """
    with TextLines(path, EXPECTED, most_bytes=MAX_BYTES, most_lines=MAX_LINES) as text:
        if text.empty:
            raise InputError(f"{path}: the file is empty; a table needs a header line and rows")
        start, delimiter = find_header(path, _lines(text), layouts)
        lines = _lines(text)
        comments, titles = _above(path, itertools.islice(lines, start))
        head = uncommented(next(lines), layouts)
        following = list(itertools.islice((ln for ln in lines if ln.strip(PADDING)), 2))
        header, units, renamed = read_header(path, start + 1, head, delimiter, following)
        if layouts:
            check_columns(path, header, layouts)
        comma = delimiter != "," or text.has_quotes
        if comma:
            comma = has_decimal_commas(itertools.islice(_lines(text), start + 1, None), delimiter)
        lines = itertools.islice(_lines(text), start + 1, None)
        below = _declared_once(path, lines, start + 2, comments)
        rows = RowReader(path, header, comma, MAX_ROWS, MAX_VALUES).read(below)
        note = text.note
    columns, values, numbers, unnamed = _named_columns(path, header, rows)
    _check_rows(path, columns, numbers, values, rows)
    readings = [k for k, name in enumerate(columns) if angle_heading(name) is None]
    marks = _without_marks(values, readings)
    if rows.repeated:
        angles = np.delete(values, readings, axis=1)
        refuse_contradiction(path, rows.repeated, rows.lines, angles, values[:, readings])
    radians = {header.columns[k] for k in rows.radians} | units
    headings = [
        word for k, word in enumerate(header.words)
        if header.columns[k] and k not in header.keys and k not in header.beside
        and not is_wavelength(word)
    ]  # fmt: skip
    percent = rows.percent or (bool(headings) and all(map(has_percent, headings)))
    beside = [header.columns[k] for k in sorted(header.beside)]
    notes = [*([note] if note else []), *renamed, *_passed_over(titles, rows, unnamed, beside)]
    if marks is not None:
        row, mark = marks
        notes.append(f"read {mark} in line {rows.lines[row]} as empty: a mark, and no reading")
    # One name for each row is the name of a reading, not of a sample.
    several = 1 < len(rows.samples) < len(values)
    return TextTable(
        path, comments, columns, start + 1, values, rows.lines, numbers, frozenset(radians), comma,
        percent, "", tuple(rows.samples), np.array(rows.sample_of) if several else None,
        tuple(notes),
    )  # fmt: skip


def _lines(text: TextLines) -> Iterator[str]:
    """The lines of a file; those that a spreadsheet wrote as one quoted cell without its quotes.

    A quoted cell may go over several lines: they come as one, and empty ones for the others.
    """
    if not text.has_quotes:
        return text.lines()
    return (_unquoted(line) if '"' in line else line for line in whole_lines(text.lines()))


def whole_lines(lines: Iterable[str]) -> Iterator[str]:
    """Lines in which a quoted cell goes over no line end; the lines that it took come as empty."""
    pending: list[str] = []
    for line in lines:
        if not pending:
            if line.count('"') % 2 and _OPEN_QUOTE.search(line):
                pending = [line]
            else:
                yield line
            continue
        pending.append(line)
        if line.count('"') % 2 == 0 and len(pending) <= MOST_LINES_OF_CELL:
            continue
        if line.count('"') % 2 and _CLOSED_QUOTE.match(line):
            yield " ".join(pending)
            yield from [""] * (len(pending) - 1)
        else:
            yield from pending
        pending = []
    yield from pending


def _unquoted(line: str) -> str:
    """A line that a spreadsheet wrote as one quoted cell, without its quotes."""
    cell = line.strip(PADDING)
    if cell[:1] != '"':
        return line
    cell = _EMPTY_CELLS.sub("", cell)
    if len(cell) > 1 and cell[0] == cell[-1] == '"':
        inner = cell[1:-1].replace('""', "\0")
        if '"' not in inner:
            return inner.replace("\0", '"')
    return line


def _above(path: Path, lines: Iterable[str]) -> tuple[dict[str, tuple[int, str]], list[int]]:
    """The declarations above the header, and the lines there that are neither they nor empty."""
    comments: dict[str, tuple[int, str]] = {}
    titles = []
    for index, line in enumerate(lines):
        text = line.strip().strip(PADDING)
        if not text or (index < 2 and SEPARATOR_LINE.fullmatch(text)):
            continue
        if not text.startswith("#"):
            key, value = _title(_MARKS.sub("", text.replace('"', "")))
            if key not in DECLARATIONS or not value:
                titles.append(index + 1)
                continue
        else:
            key, value = _comment(text)
            if not key:
                continue
        _declare(path, comments, key, index + 1, value)
    return comments, titles


def _comment(text: str) -> tuple[str, str]:
    """Key and value of a # comment; '' where it holds none."""
    text = text.lstrip("#")
    key, colon, value = text.partition(":")
    if not colon or key.strip().lower() not in DECLARATIONS:
        # '# quantity = brdf' and '#,quantity,brdf'; of other keys the colon alone counts.
        name, named = _title(text.strip(PADDING))
        if name in DECLARATIONS:
            return name, named
    return (key.strip().lower(), value.strip().strip(PADDING)) if colon else ("", "")


def _title(text: str) -> tuple[str, str]:
    """Key and value of a line above the header without #, as 'quantity: brdf' or 'name;x'."""
    found = re.match(r"([\w ]{1,40}?)\s*[:=,;\t|]\s*(.*)", text)
    return (found[1].strip().lower(), found[2].strip(PADDING)) if found else ("", "")


def _declare(
    path: Path, comments: dict[str, tuple[int, str]], key: str, line: int, value: str
) -> None:
    if key not in comments and key not in DECLARATIONS and len(comments) >= MOST_COMMENTS:
        return
    earlier = comments.setdefault(key, (line, value))
    if key in _ONCE and earlier[1].lower().split() != value.lower().split():
        raise InputError(
            f"{path}: line {line}: '# {key}: {printable(value, 40)}' contradicts line "
            f"{earlier[0]}, '{printable(earlier[1], 40)}'; keep one of them, or split the file"
        )


def _declared_once(
    path: Path, lines: Iterable[str], first: int, comments: dict[str, tuple[int, str]]
) -> Iterator[tuple[int, str]]:
    """The numbers, from `first`, and texts of lines that are no comments.

    InputError where a comment among them contradicts one above, as in joined files.
    """
    seen = dict(comments)
    for number, line in enumerate(lines, first):
        if "#" in line and line.lstrip().startswith("#"):
            key, value = _comment(line.strip())
            if key in _ONCE and key in seen:
                _declare(path, seen, key, number, value)
            elif key in _NAMES and seen.get(key, (0, value))[1] != value:
                raise InputError(
                    f"{path}: line {number}: another sample begins ({printable(value, 40)!r}); "
                    "save each as a file of its own"
                )
            continue
        yield number, line


def _named_columns(
    path: Path, header: Header, rows: Rows
) -> tuple[tuple[str, ...], Array, tuple[int, ...], list[int]]:
    """Names, values and file numbers of the columns that have a name; the numbers of the others.

    A column without a name may be empty, hold remarks or count the rows; anything else is refused.
    """
    unnamed = [k for k, name in enumerate(header.columns) if not name]
    for k in unnamed:
        if k >= header.width or not len(rows.values):
            continue
        column = rows.values[:, k]
        filled = column[np.isfinite(column)]
        counts = len(filled) == len(column) and (
            k == 0 and len(column) > 1 and bool(np.all(np.diff(column) == 1.0))
        )
        if len(filled) and not counts and k not in rows.remarks:
            raise InputError(
                f"{path}: line {header.line}, column {k + 1}: no name; name it or remove it"
            )
    kept = [k for k, name in enumerate(header.columns) if name and k not in header.beside]
    names = tuple(header.columns[k] for k in kept)
    values = rows.values if len(kept) == header.width else rows.values[:, kept]
    return names, values, tuple(k + 1 for k in kept), [k + 1 for k in unnamed]


def _check_rows(
    path: Path, columns: tuple[str, ...], numbers: tuple[int, ...], values: Array, rows: Rows
) -> None:
    """InputError where there is no row, or a number beyond any reading."""
    if not len(values):
        raise InputError(f"{path}: no row follows the header; add rows of numbers below it")
    at_once = max(VALUES_AT_ONCE // values.shape[1], 1)
    for top in range(0, len(values), at_once):
        huge = np.abs(values[top : top + at_once]) > MAX_MAGNITUDE
        if not huge.any():
            continue
        row, column = np.unravel_index(int(np.argmax(huge)), huge.shape)
        row += top
        raise InputError(
            f"{path}: line {rows.lines[row]}, column {numbers[column]} ({columns[column]}): "
            f"{values[row, column]:g} is beyond any reading; correct it or leave the field empty"
        )


def _without_marks(values: Array, readings: list[int]) -> tuple[int, str] | None:
    """Empty the readings that are a row of nines, as instruments mark what they can't read.

    values: (N, C), changed in place. Returns the row and the text of the first, with the count of
    the others. Nines that another reading comes near are readings.
    """
    at_once = max(VALUES_AT_ONCE // values.shape[1], 1)
    most, count, tops = 0.0, 0, []
    for top in range(0, len(values), at_once):  # by parts, as a table may fill the memory
        some = np.abs(values[top : top + at_once, readings])
        marks = np.isin(some, MARKS)
        if np.any(marks):
            tops.append(top)
        most = max(most, float(np.max(some, initial=0.0, where=~marks & np.isfinite(some))))
    first = None
    for top in tops:
        some = values[top : top + at_once, readings]
        marks = np.isin(np.abs(some), MARKS) & (np.abs(some) > MARK_RATIO * most)
        if not np.any(marks):
            continue
        if first is None:
            row, column = np.unravel_index(int(np.argmax(marks)), marks.shape)
            first = top + int(row), f"{some[row, column]:g}"
        count += int(np.sum(marks))
        some[marks] = np.nan
        values[top : top + at_once, readings] = some
    if first is None:
        return None
    return first[0], first[1] + (f" and {count - 1} more like it" if count > 1 else "")


def _passed_over(titles: list[int], rows: Rows, unnamed: list[int], beside: list[str]) -> list[str]:
    """What was passed over, as at most two sentences."""
    parts = []
    if titles:
        parts.append(f"{_numbered('line', titles)} above the header")
    if rows.units:
        parts.append(f"the units in {_numbered('line', rows.units)}")
    if rows.empty:
        parts.append(f"{_numbered('line', rows.empty)} without values")
    if rows.repeated:
        parts.append(f"the header again in {_numbered('line', rows.repeated)}")
    if rows.summaries.lines:
        word = printable(rows.summaries.text, 30)
        parts.append(f"{_numbered('line', rows.summaries.lines)} ({word!r})")
    if rows.below.lines:
        word = printable(rows.below.text, 30)
        where = f"{_numbered('line', rows.below.lines)} below the data"
        parts.append(f"{where} ({word!r})" if word else where)
    if unnamed:
        parts.append(f"{_numbered('column', unnamed)} without a name")
    if beside:
        more = f" and {len(beside) - 3} more" if len(beside) > 3 else ""
        names = ", ".join(repr(printable(name, 30)) for name in beside[:3])
        parts.append(f"the column{'s' if len(beside) > 1 else ''} {names}{more}")
    notes = [f"passed over: {'; '.join(parts)}"] if parts else []
    if rows.signs.count:
        more = f" and {rows.signs.count - 1} more like it" if rows.signs.count > 1 else ""
        text = printable(rows.signs.text, 20)
        notes.append(f"read {text!r} in line {rows.signs.lines[0]}{more} as empty")
    return notes


def _numbered(word: str, numbers: Iterable[int]) -> str:
    """Numbers as a reader lists them: 'line 3', 'lines 1 to 4 and 9'."""
    ordered = sorted(numbers)
    spans: list[str] = []
    for _, group in itertools.groupby(enumerate(ordered), lambda pair: pair[1] - pair[0]):
        members = [number for _, number in group]
        spans += [f"{members[0]} to {members[-1]}"] if len(members) > 2 else map(str, members)
    if len(spans) > 4:
        spans = [*spans[:3], f"{len(spans) - 3} more"]
    plural = "s" if len(ordered) > 1 else ""
    listed = spans[0] if len(spans) == 1 else f"{', '.join(spans[:-1])} and {spans[-1]}"
    return f"{word}{plural} {listed}"
