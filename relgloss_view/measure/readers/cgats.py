"""CGATS text: tables of samples with fields by name, as profiling programs and Argyll write them.

Sources: ANSI CGATS.17 and ISO 28178 (fields and keywords); Argyll's .ti3, .cie and .sp are the same
with SPEC_nnn and a scale, SPECTRAL_NORM.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from relgloss_view.base import cells
from relgloss_view.base.arrays import Array
from relgloss_view.base.cgats import Table, Take, read_tables
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.measure.readers import multi_angle
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

_LAMP = re.compile(r"EMISSION|EMISSIVE|AMBIENT|TRANSMI|TRANSPAREN", re.IGNORECASE)
_GEOMETRY_FIELDS = ("MEASUREMENT_GEOMETRY", "GEOMETRY", "ANGLE", "MEASUREMENT_ANGLE", "ASPECULAR")
_NAME_FIELDS = ("SAMPLE_NAME", "NAME", "SAMPLE_ID", "SAMPLEID", "ID", "SAMPLE_LOC")
_SOURCE_WORDS = ("INSTRUMENTATION", "TARGET_INSTRUMENT", "MEASUREMENT_SOURCE", "ORIGINATOR")


def read(path: Path, options: ReadOptions) -> Measurement:
    """The multi-angle readings of one sample. Raises InputError, as multi_angle.measurement."""
    return multi_angle.measurement(path, read_samples(path), options)


def read_samples(path: Path) -> SampleFile:
    """All samples of a CGATS file that have a spectrum. Raises InputError that names the line."""
    result = SampleFile()

    def begin(table: Table) -> Take:
        return _RowReader(path, table, result).take

    result.notes += read_tables(path, EXPECTED, begin)
    distinguish(result)
    if not result.samples and not result.colours:
        raise InputError(
            f"{path}: no sample with a spectrum (fields such as SPECTRAL_NM_400) or a colour "
            "(LAB_L LAB_A LAB_B); export the measured spectra with it"
        )
    return result


class _RowReader:
    """Makes samples of the sets of one table."""

    def __init__(self, path: Path, table: Table, result: SampleFile) -> None:
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
        return np.array(self._table.numbers(self._path, line, words, columns))


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
