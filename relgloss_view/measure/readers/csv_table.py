"""Text tables of any subject: comments, a header of column names, rows of numbers."""

from __future__ import annotations

import re
from array import array
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.base.errors import InputError

#: Beyond these a table is not a gonio scan, and reading it would exhaust the memory.
MAX_BYTES = 1_000_000_000
MAX_ROWS = 5_000_000
MAX_LINES = 6_000_000  #: with comments and blank lines
MAX_COLUMNS = 10_000
#: No reading comes near: a mirror-like lobe of 0.1 degrees at grazing incidence reaches 1e5.
MAX_MAGNITUDE = 1e12

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_DELIMITERS = (",", ";", "\t")


@dataclass(frozen=True)
class TextTable:
    """A parsed table. Empty fields are NaN; every other value is finite."""

    path: Path
    comments: dict[str, tuple[int, str]]  #: lower-case key -> (line, value)
    columns: tuple[str, ...]
    header_line: int
    values: Array  #: (N, C)
    lines: Ints  #: (N,), line number of each row in the file, from 1

    def at(self, row: int, column: int) -> str:
        """The place of a value, for messages: 'FILE: line 7, column 3 (gamma_deg)'."""
        return f"{self.path}: line {self.lines[row]}, column {column + 1} ({self.columns[column]})"


def parse(path: Path) -> TextTable:
    """Read a delimited text table (comma, semicolon or tab; UTF-8).

    Raises InputError that names file, line, column and remedy.
    """
    text = _text(path)
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    comments: dict[str, tuple[int, str]] = {}
    start = _read_comments(path, lines, comments)
    header = lines[start].strip()
    delimiter = max(_DELIMITERS, key=header.count)
    columns = _columns(path, start + 1, header, delimiter)
    values, numbers = _rows(path, lines, start + 1, columns, delimiter)
    return TextTable(path, comments, columns, start + 1, values, numbers)


def _text(path: Path) -> str:
    """The whole file as text, after its size has been checked."""
    size = path.stat().st_size
    if size > MAX_BYTES:
        raise InputError(
            f"{path}: {size} bytes, but a text table may have at most {MAX_BYTES}; "
            "split it or thin it out"
        )
    data = path.read_bytes()
    if not data.strip():
        raise InputError(f"{path}: the file is empty; a table needs a header line and rows")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise InputError(
            f"{path}: line {line}: byte 0x{data[error.start]:02x} is not UTF-8; "
            "save the table as UTF-8 text"
        ) from None
    if max(text.count("\n"), text.count("\r")) > MAX_LINES:
        raise InputError(f"{path}: more than {MAX_LINES} lines; split the table or thin it out")
    return text


def _read_comments(path: Path, lines: list[str], comments: dict[str, tuple[int, str]]) -> int:
    """Collect the `# key: value` lines on top; returns the index of the header line."""
    for index, line in enumerate(lines):
        stripped = line.strip()
        if not stripped:
            continue
        if not stripped.startswith("#"):
            return index
        key, colon, value = stripped.lstrip("#").partition(":")
        key = key.strip().lower()
        if colon and key:
            comments.setdefault(key, (index + 1, value.strip()))
    raise InputError(f"{path}: only comments; a table needs a header line and rows")


def _columns(path: Path, line: int, header: str, delimiter: str) -> tuple[str, ...]:
    """The column names; each must be there and be unlike the others."""
    columns = tuple(name.strip().strip('"').strip()[:40] for name in header.split(delimiter))
    if len(columns) > MAX_COLUMNS:
        raise InputError(
            f"{path}: line {line}: {len(columns)} columns, at most {MAX_COLUMNS} are read; "
            "is this the header of a table?"
        )
    if all(_NUMBER.fullmatch(name) for name in columns):
        raise InputError(
            f"{path}: line {line}: numbers where the header should be; "
            "name the columns in the first line that is not a # comment"
        )
    first: dict[str, int] = {}
    for k, name in enumerate(columns, start=1):
        if not name:
            raise InputError(f"{path}: line {line}, column {k}: no name; name it or remove it")
        if first.setdefault(name.lower(), k) != k:
            raise InputError(
                f"{path}: line {line}, column {k}: {name!r} is already column "
                f"{first[name.lower()]}; rename or remove one"
            )
    return columns


def _rows(
    path: Path, lines: list[str], start: int, columns: tuple[str, ...], delimiter: str
) -> tuple[Array, Ints]:
    """The numbers below the header, (N, C), and their line numbers."""
    width = len(columns)
    flat = array("d")
    numbers = array("q")
    for index in range(start, len(lines)):
        line = lines[index]
        if not line or line.isspace() or line.lstrip().startswith("#"):
            continue
        fields = line.split(delimiter)
        if len(fields) != width:
            raise InputError(
                f"{path}: line {index + 1}: {len(fields)} fields, the header has {width}; "
                "complete the row, leaving a field empty where nothing was read"
            )
        # float() also takes 1_000, nan, infinity and digits of other scripts: such lines, and
        # those with empty fields, are parsed field by field.
        plain = line.isascii() and "_" not in line and "n" not in line and "N" not in line
        try:
            if not plain:
                raise ValueError
            flat.extend([float(field) for field in fields])
        except ValueError:
            flat.extend(_careful(path, index + 1, columns, fields))
        numbers.append(index + 1)
    if not numbers:
        raise InputError(f"{path}: no row follows the header; add rows of numbers below it")
    if len(numbers) > MAX_ROWS:
        raise InputError(f"{path}: more than {MAX_ROWS} rows; split the table or thin it out")
    values = np.frombuffer(flat, dtype=np.float64).reshape(-1, width)
    huge = np.argwhere(np.abs(values) > MAX_MAGNITUDE)
    if len(huge):
        row, column = huge[0]
        raise InputError(
            f"{path}: line {numbers[row]}, column {column + 1} ({columns[column]}): "
            f"{values[row, column]:g} is beyond any reading; correct it or leave the field empty"
        )
    return values, np.frombuffer(numbers, dtype=np.int64)


def _careful(path: Path, line: int, columns: tuple[str, ...], fields: list[str]) -> list[float]:
    """Parse one row field by field: NaN for an empty one, InputError for anything odd."""
    row = []
    for k, field in enumerate(fields):
        stripped = field.strip()
        if not stripped:
            row.append(float("nan"))
        elif _NUMBER.fullmatch(stripped):
            row.append(float(stripped))
        else:
            remedy = "leave the field empty where nothing was read"
            if stripped.lower().lstrip("+-") not in ("nan", "inf", "infinity"):
                remedy = "write a number with a decimal point, or leave the field empty"
            raise InputError(
                f"{path}: line {line}, column {k + 1} ({columns[k]}): "
                f"found {stripped[:30]!a}, expected a finite number; {remedy}"
            )
    return row
