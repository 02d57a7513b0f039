"""The rows below a table's header: numbers, and what is no row of the table and passed over."""

from __future__ import annotations

import csv
import re
from array import array
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.measure.readers import cells
from relgloss_view.measure.readers.headings import RADIANS, unit_of

MOST_ODD_LINES = 500  #: in a row, before the first of them is reported
_SUMMARY = re.compile(
    r"\W*(mean|average|avg|std|stdev|sd|sigma|variance|min|minimum|max|maximum|median|sum|total|"
    r"count|mittelwert|standardabweichung|moyenne|media)\b.*",
    re.IGNORECASE,
)
_WITH_COMMA = re.compile(r"[+-]?\d*,\d+([eE][+-]?\d+)?")
_WITH_POINT = re.compile(r"[+-]?(\d+\.\d*|\.\d+)([eE][+-]?\d+)?")
_DATA = re.compile(r"[\s;,\"+\u2212.-]*\d")


@dataclass(frozen=True)
class Header:
    """The header of a table."""

    line: int  #: from 1
    columns: tuple[str, ...]  #: '' where a column has no name
    words: tuple[str, ...]  #: as the file has them, lower case
    keys: tuple[int, ...]  #: columns of angles, which every row must hold
    delimiter: str | None  #: None: any run of spaces

    @property
    def width(self) -> int:
        """Number of columns up to the last one with a name."""
        return max((k + 1 for k, name in enumerate(self.columns) if name), default=0)


@dataclass
class Rows:
    """What was read below the header, and what was not."""

    values: Array  #: (N, width), NaN where a field says nothing
    lines: Ints  #: (N,), from 1
    empty: list[int] = field(default_factory=list)  #: lines of separators alone
    repeated: list[int] = field(default_factory=list)  #: the header again
    units: int | None = None  #: the line of units below the header
    radians: frozenset[int] = frozenset()  #: columns that this line declares
    summaries: list[tuple[int, str]] = field(default_factory=list)  #: line and text
    below: list[tuple[int, str]] = field(default_factory=list)  #: after the last row
    signs: list[tuple[int, str]] = field(
        default_factory=list
    )  #: line and text of 'n/a' and the like
    remarks: set[int] = field(default_factory=set)  #: columns without a name that hold text


def split(line: str, delimiter: str | None) -> list[str]:
    """The fields of a line; quotes around a field protect the delimiters inside it."""
    if delimiter is None:
        return line.split()
    if '"' in line:
        try:
            return next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
        except (csv.Error, StopIteration):
            pass
    return line.split(delimiter)


def has_decimal_commas(lines: Sequence[str], start: int, delimiter: str | None) -> bool:
    """Whether the numbers from a line on have decimal commas and none has a point."""
    if delimiter == "," and not any('"' in line for line in lines):
        return False

    def holds(line: str, mark: str, number: re.Pattern[str]) -> bool:
        if mark not in line or not _DATA.match(line):
            return False
        fields = split(line, delimiter)
        return len(fields) > 2 and any(number.fullmatch(f.strip()) for f in fields)

    if not any(holds(line, ",", _WITH_COMMA) for line in lines[start:]):
        return False
    return not any(holds(line, ".", _WITH_POINT) for line in lines[start:])


class RowReader:
    """Reads the rows below one header.

    path: for messages. most_rows: InputError beyond it.
    """

    def __init__(self, path: Path, header: Header, decimal_comma: bool, most_rows: int) -> None:
        self._path, self._header, self._comma = path, header, decimal_comma
        self._most = most_rows
        self._flat, self._numbers = array("d"), array("q")
        self._rows = Rows(np.empty((0, header.width)), np.empty(0, np.int64))
        self._odd: list[tuple[int, list[str], InputError]] = []

    def read(self, lines: Sequence[str]) -> Rows:
        """All rows of `lines`, which are those of the whole file. Raises InputError."""
        delimiter, width = self._header.delimiter, self._header.width
        plain_commas = self._comma and delimiter != ","
        for index in range(self._header.line, len(lines)):
            line = lines[index]
            if not line or line.isspace() or line.lstrip().startswith("#"):
                continue
            # float() also takes 1_000, nan, infinity and digits of other scripts: such lines, and
            # those with empty or odd fields, are parsed field by field.
            if line.isascii() and "_" not in line and "n" not in line and "N" not in line:
                text = line.replace(",", ".") if plain_commas else line
                fields = text.split(delimiter)
                if len(fields) == width:
                    try:
                        numbers = list(map(float, fields))
                    except ValueError:
                        pass
                    else:
                        self._take(index + 1, numbers)
                        continue
            self._careful(index + 1, split(line, delimiter))
        self._end()
        rows = self._rows
        rows.values = np.frombuffer(self._flat, dtype=np.float64).reshape(-1, width)
        rows.lines = np.frombuffer(self._numbers, dtype=np.int64)
        return rows

    def _take(self, line: int, numbers: list[float]) -> None:
        """Append a row; what lies before it must be something that a table may hold."""
        if self._odd:
            for _, _, error in self._odd:
                raise error
        self._flat.extend(numbers)
        self._numbers.append(line)
        if len(self._numbers) > self._most:
            raise InputError(
                f"{self._path}: more than {self._most} rows; split the table or thin it out"
            )

    def _careful(self, line: int, fields: list[str]) -> None:
        header, rows = self._header, self._rows
        fields = [f.strip().strip('"').strip() for f in fields]
        if not any(fields):
            rows.empty.append(line)
            return
        lower = [f.lower() for f in fields]
        if tuple(lower[: header.width]) == header.words[: header.width]:
            rows.repeated.append(line)
            return
        if not self._numbers and not self._odd and rows.units is None and self._is_units(fields):
            rows.units = line
            rows.radians = frozenset(
                k for k in header.keys if k < len(fields) and unit_of(fields[k]) == RADIANS
            )
            return
        if _SUMMARY.fullmatch(fields[0]) and not self._whole(fields):
            rows.summaries.append((line, fields[0]))
            return
        try:
            numbers = self._numbers_of(line, fields)
        except InputError as error:
            self._odd.append((line, fields, error))
            if len(self._odd) > MOST_ODD_LINES:
                raise self._odd[0][2] from None
        else:
            self._take(line, numbers)

    def _is_units(self, fields: list[str]) -> bool:
        """Whether a first row holds words instead of numbers in each field of angles and more."""
        angles = [fields[k] for k in self._header.keys if k < len(fields)]
        return (
            2 <= len(fields) <= len(self._header.columns)
            and bool(angles)
            and all(f and unit_of(f) is not None for f in angles)
            and not any(cells.is_number(f) for f in fields)
        )

    def _whole(self, fields: list[str]) -> bool:
        """Whether every angle of a row is a number."""
        keys = self._header.keys
        return bool(keys) and all(k < len(fields) and cells.is_number(fields[k]) for k in keys)

    def _numbers_of(self, line: int, fields: list[str]) -> list[float]:
        header = self._header
        where = f"{self._path}: line {line}"
        named, rest = fields[: header.width], fields[header.width :]
        if len(fields) > len(header.columns) and any(fields[len(header.columns) :]):
            raise InputError(f"{where}: {self._wrong_count(fields)}")
        if len(named) < header.width:
            raise InputError(f"{where}: {self._wrong_count(fields)}")
        numbers, signs = [], []
        for k, text in enumerate(named):
            try:
                value = cells.number(text, self._comma)
            except InputError as error:
                if not header.columns[k] and k not in header.keys:
                    self._rows.remarks.add(k)
                    value = None
                else:
                    raise InputError(
                        f"{self._place(line, k)}: found {printable(text, 30)!r}, expected a finite "
                        f"number; {error}"
                    ) from None
            if value is None and text:
                signs.append((line, text))
            numbers.append(float("nan") if value is None else value)
        for k, text in enumerate(rest, start=header.width):
            if cells.is_number(text):
                raise InputError(
                    f"{where}, column {k + 1}: {printable(text, 30)!r} is in a column without a "
                    f"name; name it in line {header.line} or remove it"
                )
            if text:
                self._rows.remarks.add(k)
        if header.keys and all(np.isnan(numbers[k]) for k in header.keys):
            raise InputError(
                f"{self._place(line, header.keys[0])}: the angle is empty; complete it or remove "
                "the row"
            )
        self._rows.signs += signs
        return numbers

    def _place(self, line: int, column: int) -> str:
        name = self._header.columns[column]
        return f"{self._path}: line {line}, column {column + 1}" + (f" ({name})" if name else "")

    def _wrong_count(self, fields: list[str]) -> str:
        """The fault of a row of another length, and its remedy."""
        header = self._header
        count = (
            f"{len(fields)} field{'s' if len(fields) > 1 else ''}, the header has {header.width}; "
        )
        joined = header.delimiter and header.delimiter.join(fields)
        for other, name in ((";", "semicolons"), ("\t", "tabs"), (",", "commas")):
            if len(fields) == 1 and other != header.delimiter and joined and other in joined:
                return f"{count}separate rows and header alike, both by {name}"
        if header.delimiter == "," and len(fields) >= 2 * header.width - len(header.keys):
            return (
                f"{count}if the numbers have decimal commas, separate the fields by semicolons "
                "or tabs"
            )
        return f"{count}complete the row, leaving a field empty where nothing was read"

    def _end(self) -> None:
        """Pass over what lies below the last row, if it is no row with a fault."""
        for line, fields, error in self._odd:
            if not self._numbers or not self._is_footer(fields):
                raise error
            words = (f for f in fields if f and not cells.is_number(f))
            self._rows.below.append((line, next(words, "")))

    def _is_footer(self, fields: list[str]) -> bool:
        """Whether a line is a remark or a row of averages, and no row with a fault in it.

        A remark begins with words, and not all of the angles that follow are numbers; averages have
        no angle at all.
        """
        keys = [fields[k] if k < len(fields) else "" for k in self._header.keys]
        if not keys:
            return False
        if all(cells.says_nothing(f) for f in keys):
            return True
        first = fields[0]
        words = bool(first) and not cells.is_number(first) and not cells.says_nothing(first)
        return words and not (len(keys) > 1 and all(cells.is_number(f) for f in keys[1:]))
