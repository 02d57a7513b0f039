"""The rows below a table's header: numbers, and what is no row of the table and passed over."""

from __future__ import annotations

import csv
import re
from array import array
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from relgloss_view.base import cells
from relgloss_view.base.arrays import Array, Ints
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.measure.readers import quick_rows
from relgloss_view.measure.readers.headings import (
    RADIANS,
    angle_heading,
    has_percent,
    is_wavelength,
    unit_of,
)
from relgloss_view.measure.readers.quick_rows import Header

MOST_ODD_LINES = 500  #: in a row, before the first of them is reported
LONGEST_NOTED = 100  #: characters of a text that is kept for a note
MOST_NOTED = 1_000_000  #: lines of one kind whose numbers are kept
_SUMMARY = re.compile(
    r"\W*(mean|average|avg|std|stdev|sd|sigma|variance|min|minimum|max|maximum|median|sum|total|"
    r"count|mittelwert|standardabweichung|moyenne|media)\b.*",
    re.IGNORECASE,
)
_WITH_COMMA = re.compile(r"['=\"]*[+-]?\d*,\d+([eEdD][+-]?\d+)?\"?\s*%?")
_WITH_POINT = re.compile(r"['=\"]*[+-]?(\d+\.\d*|\.\d+)([eEdD][+-]?\d+)?\"?\s*%?")
_RULER = re.compile(r"[=_*~+|\u2500-\u257f-]{3,}")  #: a line drawn with signs
_DATA = re.compile(r"[\s;,='\"+\u2010-\u2014\u2212\uff0d.-]*\d")
FEWEST_NUMBERS = 3  #: in a row
LOOKED_AT = 20  #: fields of a line that may be another header
MOST_UNITS = 5  #: rows of units, long names and remarks between header and numbers
MOST_SAMPLES = 1000  #: names of samples that are kept


@dataclass
class Noted:
    """Lines of one kind that were passed over, with the text of the first."""

    text: str = ""
    lines: array[int] = field(default_factory=lambda: array("q"))  #: from 1, at most MOST_NOTED
    count: int = 0

    def add(self, line: int, text: str) -> None:
        """Count a line, or one more place in it."""
        if not self.count:
            self.text = text
        self.count += 1
        if len(self.lines) < MOST_NOTED:
            self.lines.append(line)


@dataclass
class Rows:
    """What was read below the header, and what was not."""

    values: Array  #: (N, width), NaN where a field says nothing
    lines: Ints  #: (N,), from 1
    empty: array[int] = field(default_factory=lambda: array("q"))  #: lines of separators alone
    repeated: array[int] = field(default_factory=lambda: array("q"))  #: the header again
    units: list[int] = field(default_factory=list)  #: lines of units below the header
    radians: frozenset[int] = frozenset()  #: columns that these lines declare
    percent: bool = False  #: whether those lines or all cells have percent
    #: Name of the sample -> its number, and that of each row, where a column names samples.
    samples: dict[str, int] = field(default_factory=dict)
    sample_of: array[int] = field(default_factory=lambda: array("q"))
    summaries: Noted = field(default_factory=Noted)  #: averages and the like
    below: Noted = field(default_factory=Noted)  #: after the last row
    signs: Noted = field(default_factory=Noted)  #: 'n/a' and the like, for empty
    remarks: set[int] = field(default_factory=set)  #: columns without a name that hold text


def split(line: str, delimiter: str | None, most: int = -1) -> list[str]:
    """The fields of a line; quotes around a field protect the delimiters inside it.

    most: fields that are wanted from the beginning; -1 for all.
    """
    if '"' in line and (delimiter is not None or "\t" not in line):
        try:
            mark, text = (delimiter, line) if delimiter else (" ", line.strip())
            fields = next(csv.reader([text], delimiter=mark, skipinitialspace=True))
            return fields if most < 0 else fields[:most]
        except (csv.Error, StopIteration):
            pass
    fields = line.split(delimiter, most)
    return fields if most < 0 else fields[:most]


def has_decimal_commas(lines: Iterable[str], delimiter: str | None) -> bool:
    """Whether numbers of the lines have decimal commas and none has a point."""

    def holds(line: str, mark: str, number: re.Pattern[str]) -> bool:
        if mark not in line:
            return False
        fields = split(line, delimiter)
        if len(fields) < 3 or not any(number.fullmatch(f.strip()) for f in fields):
            return False
        # A line may begin with the name of the sample; one of averages is no row.
        return _DATA.match(line) is not None or (
            _SUMMARY.fullmatch(fields[0].strip('" ')) is None
            and sum(map(cells.is_number, fields)) >= FEWEST_NUMBERS
        )

    commas = False
    for line in lines:
        if holds(line, ".", _WITH_POINT):
            return False
        commas = commas or holds(line, ",", _WITH_COMMA)
    return commas


class RowReader:
    """Reads the rows below one header.

    path: for messages. most_rows, most_values: InputError beyond them.
    """

    def __init__(
        self, path: Path, header: Header, decimal_comma: bool, most_rows: int, most_values: int
    ) -> None:
        self._path, self._header, self._comma = path, header, decimal_comma
        self._most, self._most_values = most_rows, most_values
        self._flat, self._numbers = array("d"), array("q")
        self._rows = Rows(np.empty((0, header.width)), np.empty(0, np.int64))
        #: Line, fault, and the text of a remark where the line is one and no row with a fault.
        self._odd: list[tuple[int, InputError, str | None]] = []
        self._words_first = False  #: whether the first of them holds no number
        self._percents = 0
        self._first_percent: InputError | None = None
        self._bands = {
            k: None for k, name in enumerate(header.columns)
            if name and k not in header.keys and k not in header.beside and not is_wavelength(name)
        }  # fmt: skip

    def read(self, lines: Iterable[tuple[int, str]]) -> Rows:
        """All rows of numbered lines, those below the header. Raises InputError."""
        delimiter, width = self._header.delimiter, self._header.width
        plain_commas = self._comma and delimiter != ","
        plain = self._header.sample is None
        for number, line in lines:
            if not line or line.isspace():
                continue
            # float() also takes 1_000, nan, infinity and digits of other scripts: such lines, and
            # those with empty or odd fields, are parsed field by field.
            if plain and line.isascii() and "_" not in line and "n" not in line and "N" not in line:
                fields = quick_rows.quoted(line, delimiter, self._comma)
                if not fields:
                    text = line.replace(",", ".") if plain_commas else line
                    fields = text.split(delimiter)
                if len(fields) == width:
                    try:
                        numbers = list(map(float, fields))
                    except ValueError:
                        pass
                    else:
                        self._take(number, numbers)
                        continue
            if not self._quick(number, line):
                self._careful(number, split(line, delimiter))
        self._end()
        rows = self._rows
        rows.values = np.frombuffer(self._flat, dtype=np.float64).reshape(-1, width)
        rows.lines = np.frombuffer(self._numbers, dtype=np.int64)
        if self._first_percent is not None:
            if self._percents != np.sum(np.isfinite(rows.values[:, list(self._bands)])):
                raise self._first_percent
            rows.percent = True
        return rows

    def _quick(self, number: int, line: str) -> bool:
        """Take a row by quick_rows; False where it must be read with care."""
        found = quick_rows.row(line, self._header, self._comma) if self._numbers else None
        if found is None:
            return False
        for sign in found.signs:
            self._rows.signs.add(number, sign[:LONGEST_NOTED])
        if found.sample is not None:
            self._of_sample(found.sample[:LONGEST_NOTED])
        self._take(number, found.numbers)
        return True

    def _take(self, line: int, numbers: list[float]) -> None:
        """Append a row; what lies before it must be something that a table may hold."""
        if self._odd:
            raise self._odd[0][1]
        self._flat.extend(numbers)
        self._numbers.append(line)
        if len(self._flat) > self._most_values:
            raise InputError(
                f"{self._path}: more than {self._most_values} values; split the table or thin it "
                "out"
            )
        if len(self._numbers) > self._most:
            raise InputError(
                f"{self._path}: more than {self._most} rows; split the table or thin it out"
            )

    def _careful(self, line: int, fields: list[str]) -> None:
        header, rows = self._header, self._rows
        fields = [f.strip().strip('"').strip() for f in fields]
        if all(cells.says_nothing(f) or _RULER.fullmatch(f) for f in fields):
            rows.empty.append(line)
            return
        lower = [f.lower() for f in fields]
        if tuple(lower[: header.width]) == header.words[: header.width]:
            rows.repeated.append(line)
            return
        above = not self._numbers and not self._odd and len(rows.units) < MOST_UNITS
        if above and self._is_units(fields):
            rows.units.append(line)
            rows.radians |= {
                k for k in header.keys if k < len(fields) and unit_of(fields[k]) == RADIANS
            }
            bands = [fields[k] for k in self._bands if k < len(fields)]
            rows.percent = rows.percent or (bool(bands) and all(map(has_percent, bands)))
            return
        if _SUMMARY.fullmatch(fields[0]) and not self._whole(fields):
            rows.summaries.add(line, fields[0][:LONGEST_NOTED])
            return
        try:
            numbers = self._numbers_of(line, fields)
        except InputError as error:
            words = self._of_words(line, fields)
            self._words_first = self._words_first if self._odd else words is not None
            self._odd.append((line, words or error, self._remark(fields)))
            if len(self._odd) > MOST_ODD_LINES:
                raise self._odd[0][1] from None
        else:
            self._take(line, numbers)

    def _of_words(self, line: int, fields: list[str]) -> InputError | None:
        """The fault of a line without a number: what it is, and not what its first cell lacks."""
        where = f"{self._path}: line {line}"
        if sum(angle_heading(field) is not None for field in fields[:LOOKED_AT]) > 1:
            return InputError(
                f"{where}: another table begins; save each table as a file of its own"
            )
        first = next(field for field in fields if field)
        if not first[:1].isalpha() or any(map(cells.is_number, fields[: 50 * LOOKED_AT])):
            return None
        return InputError(
            f"{where}: words among the rows ({printable(first, 30)!r}); remove the line or begin "
            "it with #, and save readings of another sample as a file of their own"
        )

    def _is_units(self, fields: list[str]) -> bool:
        """Whether a line above the first row holds words alone: units, long names, remarks.

        Beside units of angles, 1 is the unit of a number.
        """
        if not 2 <= len(fields) <= len(self._header.columns):
            return False
        angles = [fields[k] for k in self._header.keys if k < len(fields)]
        if not angles or any(cells.is_number(f) for f in angles):
            return False
        units = [unit_of(f) is not None for f in angles]
        if all(units) or (len(units) > 1 and all(units[1:]) and angles[0].isalpha()):
            return not any(cells.is_number(f) and f != "1" for f in fields)
        return not any(
            re.search(r"\d", f) for f in fields if f not in ("1/sr", "sr-1", "sr^-1")
        ) and not all(cells.says_nothing(f) for f in angles)

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
        numbers: list[float] = []
        signs: list[str] = []
        percents = 0
        for k, text in enumerate(named):
            if k in header.beside:
                numbers.append(float("nan"))
                continue
            if text.endswith("%") and k in self._bands and cells.is_number(text[:-1]):
                percents += 1
                self._first_percent = self._first_percent or InputError(
                    f"{self._place(line, k)}: found {printable(text, 30)!r}, expected a finite "
                    "number; other numbers have no %: write all of them alike, in percent with "
                    f"'# quantity: {cells.PERCENT}' on top, or as fractions"
                )
                text = text[:-1].rstrip()
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
                signs.append(text)
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
        for text in signs:
            self._rows.signs.add(line, text[:LONGEST_NOTED])
        self._percents += percents
        if header.sample is not None:
            self._of_sample(named[header.sample][:LONGEST_NOTED])
        return numbers

    def _of_sample(self, name: str) -> None:
        """Note the sample of a row."""
        names = self._rows.samples
        last = names.get(name, MOST_SAMPLES)
        if last == MOST_SAMPLES and len(names) < MOST_SAMPLES:
            last = names[name] = len(names)
        self._rows.sample_of.append(last)

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
        for line, error, remark in self._odd:
            if not self._numbers or remark is None:
                # What follows words below the data is another table, and no faulty row.
                raise self._odd[0][1] if self._words_first else error
            self._rows.below.add(line, remark)

    def _remark(self, fields: list[str]) -> str | None:
        """The first words of a line below the data; None where it is a row with a fault."""
        if not self._is_footer(fields):
            return None
        words = (f for f in fields if f and not cells.is_number(f))
        return next(words, "")[:LONGEST_NOTED]

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
