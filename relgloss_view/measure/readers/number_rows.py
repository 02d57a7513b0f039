"""Rows of numbers below a header of words, as the text formats of other programs have them."""

from __future__ import annotations

from array import array
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from relgloss_view.base import cells
from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.text_lines import TextLines

MAX_BYTES = 400_000_000
MAX_LINES = 2_000_000
MAX_ROWS = 1_000_000
LONGEST_LINE = 200_000  #: characters
MAX_VALUES = 12_000_000  #: numbers of a table: 96 MB, and a measurement takes that a few times


def opened(path: Path, expected: str) -> TextLines:
    """A text file of rows of numbers, to be read line by line within the limits above."""
    return TextLines(
        path, expected, most_bytes=MAX_BYTES, most_lines=MAX_LINES, longest_line=LONGEST_LINE
    )


class NumberRows:
    """Collects rows of a fixed number of fields; faults name the line.

    path: for messages. width: number of fields that are kept. extra: whether a row may have more
    fields than that, which are passed over.
    """

    def __init__(self, path: Path, width: int, *, extra: bool = False) -> None:
        self.path, self.width, self.extra = path, width, extra
        self.passed_over = 0  #: rows with more fields than are kept
        self._values = array("d")
        self._below = False

    def read(self, lines: Iterable[tuple[int, str]]) -> Array:
        """The rows as (N, width), NaN where a field is empty. Blank lines and '#' are passed over.

        lines: number and text of each. Raises InputError for a field that is no number, a row of
        another length, and more than MAX_ROWS rows or MAX_VALUES numbers.
        """
        for line, text in lines:
            if text and not text.isspace() and not text.lstrip().startswith("#"):
                self._take(line, text)
        table = np.frombuffer(self._values, dtype=np.float64).reshape(-1, self.width)
        # Comparisons by blocks: a mask of the whole table would take an eighth of it again.
        for top in range(0, len(table), 100_000):
            huge = np.abs(table[top : top + 100_000]) > cells.MAX_MAGNITUDE
            if huge.any():
                raise InputError(
                    f"{self.path}: row {top + int(np.argwhere(huge)[0][0]) + 1} of the numbers: "
                    f"a value beyond {cells.MAX_MAGNITUDE:g}; the file is damaged"
                )
        return table

    def _take(self, line: int, text: str) -> None:
        fields = self._fields(text)
        if len(fields) != self.width or self._below:
            # Words below the rows, such as END; rows that follow them are none of this table.
            if self._values and not any(map(cells.is_number, fields)):
                self._below = True
                return
            if self._below:
                raise InputError(
                    f"{self.path}: line {line}: numbers below a line of words; remove the line, or "
                    "give each table a file of its own"
                )
            if len(fields) < self.width or not self.extra:
                raise InputError(
                    f"{self.path}: line {line}: {len(fields)} fields, expected {self.width}; "
                    "the file is damaged or cut off"
                )
            self.passed_over += 1
            fields = fields[: self.width]
        have = len(self._values)
        if have + self.width > min(MAX_VALUES, MAX_ROWS * self.width):
            raise InputError(
                f"{self.path}: more than {MAX_ROWS} rows or {MAX_VALUES} numbers; split the table "
                "or thin it out"
            )
        try:
            # float() takes '1_000' and 'inf' too; no instrument writes the first, and the second is
            # found in the whole table.
            if "_" in text:
                raise ValueError
            self._values.extend(map(float, fields))
        except ValueError:
            del self._values[have:]
            self._values.extend(self._number(line, k, field) for k, field in enumerate(fields))

    def _fields(self, text: str) -> list[str]:
        if ";" in text and "." not in text:
            return text.replace(",", ".").split(";")  # decimal commas
        if "," in text:
            fields = text.split(",")
            if len(fields) > self.width and not fields[-1].strip():  # a comma ends the line
                fields.pop()
            return fields
        return text.replace(";", " ").split()

    def _number(self, line: int, column: int, field: str) -> float:
        try:
            value = cells.number(field)
        except InputError as error:
            raise InputError(
                f"{self.path}: line {line}, column {column + 1}: {printable(field.strip(), 40)!r} "
                f"is not a number; {error}"
            ) from None
        return np.nan if value is None else value
