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
FEWEST_WAVES = 5

NUMBER = re.compile(r"[+-]?(\d+[.,]?\d*|[.,]\d+)([eEdD][+-]?\d+)?", re.ASCII)
#: How programs write that nothing was read.
_NOTHING = frozenset(
    ("", "-", "\u2013", "\u2014", "nan", "+nan", "-nan", "1.#qnan", "-1.#ind", "n/a", "na", "n.a.",
     "null", "none", "nil", "missing", "void", "n.d.", "nd", ".")
)  # fmt: skip
#: Errors of spreadsheets in any language (#N/A, #NV, #DIV/0!, #¡VALOR!), and a line for a value.
_NO_VALUE = re.compile(r"#¡?[^\W\d_]{1,12}(/(0|[^\W\d_]{1,3}))?[!?]?|[-\u2013\u2014]{2,40}")
#: Numbers that mark what an instrument could not read, where no other number comes near.
MARKS, MARK_RATIO = (999.0, 9999.0, 99999.0, 999999.0), 20.0


def says_nothing(cell: str) -> bool:
    """Whether a cell is empty or holds a sign for it, such as 'n/a', '#DIV/0!' or a dash."""
    text = cell.strip()
    return text.lower() in _NOTHING or _NO_VALUE.fullmatch(text) is not None


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
    percent: bool = False  #: whether the value has a % sign


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
    _check_alike(path, rows, words)
    _check_exchanged(path, rows, words)
    return rows


def _check_alike(path: Path, rows: list[Row], words: Words) -> None:
    """InputError where some values have a % sign and others have none."""
    signs = {row.percent for row in rows if not np.isnan(row.value)}
    if len(signs) > 1:
        line = next(row.line for row in rows if row.percent)
        raise InputError(
            f"{path}: line {line}: this {words.value} has a % sign and others have none; write all "
            "of them alike"
        )


def _check_exchanged(path: Path, rows: list[Row], words: Words) -> None:
    """InputError where the second column can be the wavelengths, and the first one can't."""
    if len(rows) < FEWEST_WAVES:
        return
    first, second = (np.array([getattr(row, name) for row in rows]) for name in ("nm", "value"))
    if _like_wavelengths(second) and not _like_wavelengths(first):
        raise InputError(
            f"{path}: the wavelengths are in the second column; put them first: {words.columns}"
        )


def _like_wavelengths(numbers: Array) -> bool:
    steps = np.diff(numbers)
    visible = np.min(numbers) <= 430.0 and np.max(numbers) >= 670.0 and np.min(numbers) >= 100.0
    return bool(visible and (np.all(steps > 0.0) or np.all(steps < 0.0)))


def fields_of(line: str) -> list[str]:
    """The cells of a line, without the empty ones that a spreadsheet appends."""
    text = line.strip().replace("\u2212", "-")
    delimiter = next((d for d in ";\t|" if d in text), None)
    if '"' in text:
        text = re.sub(r'"?=""?([^"=]*)""?"?', r"\1", text)  # ="0.25"
    if delimiter is None and '"' in text:  # "450,5","0,25" or "450" 0.25
        text = ";".join(_quoted_cells(text))
        delimiter = ";" if ";" in text else None
    if delimiter is None and "," in text:
        delimiter = ","
        if re.fullmatch(r"\d+(,\d+)?\s+[+-]?\d*,\d+([eE][+-]?\d+)?", text):
            delimiter = None  # spaces, and decimal commas
    fields = [_as_number(f.strip(' "\t')) for f in text.split(delimiter)]
    if delimiter == "," and len(fields) == 1:
        fields = text.split()
    if not fields:  # white space that only Unicode knows
        return [""]
    while len(fields) > 2 and not fields[-1]:
        fields.pop()
    while len(fields) > 2 and not fields[0] and NUMBER.fullmatch(fields[1].removesuffix("nm")):
        del fields[0]  # a blank column before the wavelengths
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
        first = fields[0].removesuffix("nm").strip()
        if not NUMBER.fullmatch(first):
            raise _wrong(path, number, line, words)
    if 3 <= len(fields) <= 4 and ";" not in line and all(f.isdecimal() for f in fields):
        raise InputError(
            f"{path}: line {number}: expected {words.columns}, found {len(fields)} fields, "
            f"{printable(line, 40)!r}; if the numbers have decimal commas, separate the columns by "
            "semicolons or tabs, else keep two columns"
        )
    if len(fields) != 2:
        # "450,0.5 W" and three columns alike: which is meant is not for a program to guess.
        raise InputError(
            f"{path}: line {number}: expected {words.columns}, found {len(fields)} "
            f"field{'s' if len(fields) > 1 else ''}, {printable(line, 40)!r}; keep two columns"
        )
    second = fields[1].removesuffix("%").strip()
    if says_nothing(second):
        return Row(number, _float(first), float("nan"))
    if not NUMBER.fullmatch(second):
        raise InputError(
            f"{_wrong(path, number, line, words)}; leave the cell empty where nothing was read"
        )
    nm, value = _float(first), _float(second)
    if not (0.0 < nm < np.inf and abs(value) <= VALUE_MAX):
        raise InputError(
            f"{path}: line {number}: expected a wavelength above 0 and a {words.value} from 0 "
            f"to {VALUE_MAX:g}, found {nm:g} and {value:g}"
        )
    return Row(number, nm, value, fields[1].endswith("%"))


def _float(text: str) -> float:
    return float(text.replace(",", ".").lower().replace("d", "e"))


def in_order(path: Path, rows: list[Row], words: Words, notes: list[str]) -> tuple[Array, Array]:
    """Wavelengths and values in increasing order, each wavelength once, as `rows` is afterwards.

    Raises InputError where two lines give one wavelength two values.
    """
    nm = np.array([row.nm for row in rows])
    value = np.array([row.value for row in rows])
    _empty_marks(rows, value, notes)
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


def _empty_marks(rows: list[Row], value: Array, notes: list[str]) -> None:
    """Nines such as 9999, which no other value comes near, as empty."""
    size = np.abs(value)
    marks = np.isin(size, MARKS)
    others = size[~marks & ~np.isnan(size)]
    marks &= size > MARK_RATIO * float(np.max(others, initial=0.0))
    if len(others) and np.any(marks):
        k = int(np.argmax(marks))
        notes.append(f"read {value[k]:g} in line {rows[k].line} as empty: a mark, and no reading")
        value[marks] = np.nan


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
