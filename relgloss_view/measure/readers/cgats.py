"""CGATS text: tables of samples with fields by name, as profiling programs and Argyll write them.

Sources: ANSI CGATS.17 and ISO 28178 (fields and keywords); Argyll's .ti3, .cie and .sp are the same
with SPEC_nnn and a scale, SPECTRAL_NORM.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.text_lines import TextLines
from relgloss_view.measure.readers import cells, multi_angle
from relgloss_view.measure.readers.aspecular import Aspecular, split_aspecular
from relgloss_view.measure.readers.options import ReadOptions
from relgloss_view.measure.readers.samples import (
    LONGEST_NAME,
    Sample,
    SampleFile,
    add_sample,
    distinguish,
)
from relgloss_view.measure.readers.spectral_columns import spectral_columns
from relgloss_view.measure.table import Measurement

EXPECTED = "a CGATS file of samples"
MAX_BYTES = 32 * 1024 * 1024
MOST_LINES = 500_000
LONGEST_LINE = 200_000
MOST_FIELDS = 5_000
MOST_FIELDS_IN_ALL = 50_000  #: of all tables
MOST_SETS = 30_000
MOST_KEYWORDS = 2_000
MOST_TABLES = 1_000

_TOKEN = re.compile(r'"([^"]*)"|(\S+)')
_LAMP = re.compile(r"EMISSION|EMISSIVE|AMBIENT|TRANSMI|TRANSPAREN", re.IGNORECASE)
_GEOMETRY_FIELDS = ("MEASUREMENT_GEOMETRY", "GEOMETRY", "ANGLE", "MEASUREMENT_ANGLE", "ASPECULAR")
_NAME_FIELDS = ("SAMPLE_NAME", "NAME", "SAMPLE_ID", "SAMPLEID", "ID", "SAMPLE_LOC")
_SOURCE_WORDS = ("INSTRUMENTATION", "TARGET_INSTRUMENT", "MEASUREMENT_SOURCE", "ORIGINATOR")


@dataclass
class _Table:
    """One BEGIN_DATA_FORMAT ... END_DATA of a file."""

    fields: list[str] = field(default_factory=list)
    keywords: dict[str, str] = field(default_factory=dict)

    def column(self, names: tuple[str, ...]) -> int | None:
        """The column of the first of some fields that is there."""
        upper = {name.upper(): k for k, name in reversed(list(enumerate(self.fields)))}
        return next((upper[name] for name in names if name in upper), None)


def read(path: Path, options: ReadOptions) -> Measurement:
    """The multi-angle readings of one sample. Raises InputError, as multi_angle.measurement."""
    return multi_angle.measurement(path, read_samples(path), options)


def read_samples(path: Path) -> SampleFile:
    """All samples of a CGATS file that have a spectrum. Raises InputError that names the line."""
    result = SampleFile()
    limits = {"most_bytes": MAX_BYTES, "most_lines": MOST_LINES, "longest_line": LONGEST_LINE}
    with TextLines(path, EXPECTED, **limits) as text:
        if text.note:
            result.notes.append(text.note)
        _read_tables(path, enumerate(text.lines(), 1), result)
    distinguish(result)
    if not result.samples and not result.colours:
        raise InputError(
            f"{path}: no sample with a spectrum (fields such as SPECTRAL_NM_400) or a colour "
            "(LAB_L LAB_A LAB_B); export the measured spectra with it"
        )
    return result


def _read_tables(path: Path, lines: Iterator[tuple[int, str]], result: SampleFile) -> None:
    table = _Table()
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
            sets += _read_rows(path, table, lines, result, MOST_SETS - sets)
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
    path: Path, table: _Table, lines: Iterator[tuple[int, str]], result: SampleFile, most: int
) -> int:
    """Take the sets of one table, at most `most`; returns how many there are."""
    reader = _RowReader(path, table, result)
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
            reader.take(begun, pending)
            pending = []
    else:
        if not pending:
            result.notes.append("END_DATA is missing: the file may be cut off")
    if pending:
        raise InputError(
            f"{path}: line {begun}: a set of {len(pending)} values; {width} fields are declared"
        )
    return count


class _RowReader:
    """Makes samples of the sets of one table."""

    def __init__(self, path: Path, table: _Table, result: SampleFile) -> None:
        self._path, self._result, self._table = path, result, table
        keywords = table.keywords
        # Kinds that are no reflectance are passed over once for all.
        kinds = ("MEAS_TYPE", "DEVICE_CLASS", "MEASUREMENT_TYPE")
        kind = " ".join(keywords.get(k, "") for k in kinds)
        self._lamp = bool(_LAMP.search(kind)) or keywords.get("DEVICE_CLASS", "") == "DISPLAY"
        self._spectra = [] if self._lamp else list(spectral_columns(table.fields).spectra)
        if self._lamp:
            result.notes.append("passed over spectra of light that is emitted or transmitted")
        self._pairs = _pairs(table.fields)
        self._name = table.column(_NAME_FIELDS)
        self._id = table.column(("SAMPLE_ID", "SAMPLEID", "ID"))
        self._geometry = table.column(_GEOMETRY_FIELDS)
        self._where = keywords.get("MEASUREMENT_GEOMETRY", "") or keywords.get("GEOMETRY", "")
        lab = [table.column((f"LAB_{axis}",)) for axis in "LAB"]
        self._lab = [k for k in lab if k is not None]
        self._percent = _percent(keywords)
        if not result.source:
            result.source = next((keywords[k] for k in _SOURCE_WORDS if k in keywords), "")

    def take(self, line: int, words: list[str]) -> None:
        """The samples of one set."""
        name = words[self._name] if self._name is not None else ""
        name = name or (words[self._id] if self._id is not None else "")
        name = printable(name, LONGEST_NAME) or f"set {len(self._result.samples) + 1}"
        at = words[self._geometry] if self._geometry is not None else self._where
        angle, _ = split_aspecular(at, whole=True)
        if angle is None:
            angle, rest = split_aspecular(name)
            name = rest if angle is not None and rest else name
        before = len(self._result.samples)
        for column_angle, nm, columns in self._spectra:
            values = self._numbers(line, words, columns)
            if np.any(np.isfinite(values)):
                self._add(name, nm, values, at, column_angle or angle, self._percent)
        if self._pairs is not None:
            nm_columns, value_columns, percent = self._pairs
            nm = self._numbers(line, words, nm_columns)
            if np.all(np.isfinite(nm)):
                self._add(name, nm, self._numbers(line, words, value_columns), at, angle, percent)
        if len(self._result.samples) == before and len(self._lab) == 3 and not self._lamp:
            lab = self._numbers(line, words, tuple(self._lab))
            if np.all(np.isfinite(lab)):
                self._result.colours.setdefault(name, (lab[0], lab[1], lab[2]))

    def _add(
        self,
        name: str,
        nm: Array,
        values: Array,
        at: str,
        angle: Aspecular | None,
        percent: bool | None,
    ) -> None:
        sample = Sample(name, nm, values, at, percent, angle)
        add_sample(self._path, self._result, sample)

    def _numbers(self, line: int, words: list[str], columns: tuple[int, ...]) -> Array:
        values = []
        for k in columns:
            text = words[k].strip()
            try:
                text = text.replace(",", ".") if text.count(",") == 1 else text
                values.append(cells.reading(text))
            except InputError as error:
                raise InputError(
                    f"{self._path}: line {line}, field {self._table.fields[k][:30]}: found "
                    f"{printable(words[k], 30)!r}, expected a number; {error}"
                ) from None
        return np.array(values)


def _pairs(fields: list[str]) -> tuple[tuple[int, ...], tuple[int, ...], bool] | None:
    """Columns of wavelengths and of values where a table has SPECTRAL_NM beside each value."""
    upper = [name.upper() for name in fields]
    for word, percent in (("SPECTRAL_PCT", True), ("SPECTRAL_DEC", False)):
        nm = [k for k, name in enumerate(upper) if name == "SPECTRAL_NM"]
        values = [k for k, name in enumerate(upper) if name == word]
        if len(nm) > 3 and len(nm) == len(values):
            return tuple(nm), tuple(values), percent
    return None


def _percent(keywords: dict[str, str]) -> bool | None:
    """Whether a scale is declared: Argyll writes SPECTRAL_NORM."""
    norm = keywords.get("SPECTRAL_NORM", "")
    if cells.is_number(norm):
        scale = float(norm.replace(",", "."))
        if scale in (1.0, 100.0):
            return scale == 100.0
    # Argyll's charts have no scale of their own, and are percent.
    return True if "SPECTRAL_START_NM" in keywords and "SPECTRAL_BANDS" in keywords else None
