"""Rows of a wavelength and a value, as spectrometers and spreadsheets save them."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable

VALUE_MAX = 1e100  #: sums of values must stay finite
MOST_TITLES = 200  #: lines of words above the numbers
LONGEST_LINE = 4000  #: characters
MOST_ROWS = 100_000  #: wavelengths; from 200 to 1200 nm in steps of 0.01
MOST_LINES = 1_000_000

NUMBER = re.compile(r"[+-]?(\d+[.,]?\d*|[.,]\d+)([eEdD][+-]?\d+)?", re.ASCII)
_NOTHING = frozenset(
    ("", "-", "--", "nan", "n/a", "na", "#n/a", "#value!", "#div/0!", "null", "none", "missing")
)


@dataclass(frozen=True)
class Words:
    """What the rows are of, for messages."""

    subject: str  #: with its article, such as 'a lamp'
    value: str  #: such as 'power'

    @property
    def values(self) -> str:
        """Several of them."""
        return f"{self.value}s"

    @property
    def columns(self) -> str:
        """Both columns."""
        return f"wavelength (nm) and {self.value}"


@dataclass
class Row:
    """A line that begins with a number."""

    line: int  #: from 1
    nm: float
    value: float  #: NaN where the cell says nothing


def read_rows(
    path: Path,
    lines: Iterable[str],
    words: Words,
    chosen: Callable[[list[str]], list[str]] | None = None,
) -> list[Row]:
    """The rows of the lines of a file, in its order; words above and below them are passed over.

    chosen: of the cells of a row, the two that are read. Raises InputError, which names the line.
    """
    rows: list[Row] = []
    titles = 0
    ended: tuple[int, str] | None = None
    for number, line in enumerate(lines, 1):
        fields = fields_of(line) if len(line) <= LONGEST_LINE else [line[:40]]
        if not any(fields) or fields[0].startswith("#"):
            continue
        row = _row(path, number, line, fields, words, chosen, not rows)
        if row is None:
            if rows:
                ended = ended or (number, line)
                continue
            titles += 1
            if titles > MOST_TITLES:
                break
            continue
        if ended is not None:
            raise _wrong(path, *ended, words)
        if len(rows) == MOST_ROWS:
            raise InputError(
                f"{path}: more than {MOST_ROWS} wavelengths; {words.subject} needs no finer steps "
                "than 0.01 nm, so thin it out"
            )
        rows.append(row)
    if ended is not None and NUMBER.fullmatch(fields_of(ended[1])[0]):
        raise _wrong(path, *ended, words)
    return rows


def fields_of(line: str) -> list[str]:
    """The cells of a line, without the empty ones that a spreadsheet appends."""
    text = line.strip().replace("\u2212", "-")
    delimiter = next((d for d in ";\t" if d in text), None)
    if '"' in text:
        text = re.sub(r'"?=""?([^"=]*)""?"?', r"\1", text)  # ="0.25"
    if delimiter is None and '"' in text:  # "450,5","0,25" or "450" 0.25
        text = ";".join(_quoted_cells(text))
        delimiter = ";" if ";" in text else None
    if delimiter is None and "," in text:
        delimiter = ","
        if re.fullmatch(r"\d+,\d+\s+[+-]?\d*,\d+([eE][+-]?\d+)?", text):
            delimiter = None  # spaces, and decimal commas
    fields = [_as_number(f.strip(' "\t')) for f in text.split(delimiter)]
    if delimiter == "," and len(fields) == 1:
        fields = text.split()
    if not fields:  # white space that only Unicode knows
        return [""]
    while len(fields) > 2 and not fields[-1]:
        fields.pop()
    if len(fields) == 1 and delimiter is not None:
        fields.append("")
    return fields


def _quoted_cells(text: str) -> list[str]:
    mark = "," if re.search(r'"\s*,|,\s*"', text) else " "
    try:
        return next(csv.reader([text], delimiter=mark, skipinitialspace=True))
    except (csv.Error, StopIteration):
        return [text]


def _as_number(cell: str) -> str:
    """A cell without what spreadsheets mark a text with, '0.5 or ="0.5", and without nm."""
    return re.sub(r"""^['=]["']?(?=[\d.,+-])|(?<=[\d.,])\s*nm$""", "", cell)


def _row(
    path: Path,
    number: int,
    line: str,
    fields: list[str],
    words: Words,
    chosen: Callable[[list[str]], list[str]] | None,
    above: bool,
) -> Row | None:
    """The row of a line, or None where it does not begin with a number."""
    first = fields[0].removesuffix("nm").strip()
    if len(line) > LONGEST_LINE:
        raise _wrong(path, number, line, words)
    if not NUMBER.fullmatch(first):
        return None
    if len(fields) == 1 and first.isdecimal() and above:
        return None  # how many rows follow
    if chosen is not None:
        fields = chosen(fields)
    if len(fields) != 2:
        # "450,0.5 W" and three columns alike: which is meant is not for a program to guess.
        raise InputError(
            f"{path}: line {number}: expected {words.columns}, found {len(fields)} "
            f"field{'s' if len(fields) > 1 else ''}, {printable(line, 40)!r}; keep two columns"
        )
    second = fields[1].removesuffix("%").strip()
    if second.lower() in _NOTHING:
        return Row(number, _float(first), float("nan"))
    if not NUMBER.fullmatch(second):
        raise _wrong(path, number, line, words)
    nm, value = _float(first), _float(second)
    if not (0.0 < nm < np.inf and abs(value) <= VALUE_MAX):
        raise InputError(
            f"{path}: line {number}: expected a wavelength above 0 and a {words.value} from 0 "
            f"to {VALUE_MAX:g}, found {nm:g} and {value:g}"
        )
    return Row(number, nm, value)


def _float(text: str) -> float:
    return float(text.replace(",", ".").lower().replace("d", "e"))


def in_order(path: Path, rows: list[Row], words: Words, notes: list[str]) -> tuple[Array, Array]:
    """Wavelengths and values in increasing order, each wavelength once, as `rows` is afterwards.

    Raises InputError where two lines give one wavelength two values.
    """
    nm = np.array([row.nm for row in rows])
    value = np.array([row.value for row in rows])
    steps = np.diff(nm)
    if np.any(steps <= 0.0):
        order = np.argsort(nm, kind="stable")
        if np.any(steps < 0.0) and not np.all(steps <= 0.0):
            line = rows[int(np.argmax(steps < 0.0)) + 1].line
            notes.append(f"the wavelengths do not increase at line {line}; they are sorted")
        rows[:] = [rows[k] for k in order]
        nm, value = nm[order], value[order]
    same = np.flatnonzero(np.diff(nm) == 0.0)
    for k in same:
        if value[k] != value[k + 1] and not np.isnan(value[k : k + 2]).all():
            first, second = sorted((rows[k].line, rows[k + 1].line))
            raise InputError(
                f"{path}: lines {first} and {second} give two {words.values} of {nm[k]:g} nm; "
                "wavelengths must increase, each once"
            )
    once = np.r_[True, np.diff(nm) != 0.0]
    rows[:] = [row for row, kept in zip(rows, once, strict=True) if kept]
    return nm[once], value[once]


def check_unit(path: Path, nm: Array) -> None:
    """InputError where the wavelengths are in another unit than nanometres."""
    low, high = float(nm[0]), float(nm[-1])
    for name, size in (("micrometres", 1e-3), ("ångströms", 10.0), ("metres", 1e-9)):
        begins = 180 * size <= low <= 400.001 * size
        if len(nm) > 1 and begins and 699.999 * size <= high <= 3000 * size:
            if name == "ångströms" and low <= 800.0:
                continue
            raise InputError(
                f"{path}: the wavelengths, {low:g} to {high:g}, look like {name}; give nanometres"
            )


def _wrong(path: Path, number: int, line: str, words: Words) -> InputError:
    return InputError(
        f"{path}: line {number}: expected {words.columns}, found {printable(line, 40)!r}"
    )
