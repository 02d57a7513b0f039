"""Tables in another order: long ones, single readings, falling wavelengths, several samples.

Each becomes a table of one row a geometry and one column a band, with a note of what was done.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.measure.readers.assemble import one_channel
from relgloss_view.measure.readers.csv_table import MAX_VALUES, TextTable
from relgloss_view.measure.readers.header import MAX_COLUMNS
from relgloss_view.measure.readers.headings import (
    angle_heading,
    band_nm,
    is_wavelength,
    value_quantity,
)
from relgloss_view.measure.readers.options import ReadOptions
from relgloss_view.measure.readers.parts import chosen_part

#: Readings of one geometry and wavelength that stand in for one each at least, on average; fewer
#: mean that the geometries do not share their wavelengths.
LEAST_FILLED = 0.2


def arranged(table: TextTable, options: ReadOptions) -> tuple[TextTable, ReadOptions]:
    """The table by rows of geometries and columns of bands in increasing order.

    options: their part is the sample that is wanted, by name or number from 1, where a column names
    several; the options that remain to be used come back. Raises InputError where that or a
    wavelength is not clear.
    """
    if table.sample_of is not None:
        table = _one_sample(table, table.sample_of, options.part)
        options = replace(options, part=None)
    return _by_columns(table), options


def _by_columns(table: TextTable) -> TextTable:
    angles = [k for k, name in enumerate(table.columns) if angle_heading(name) is not None]
    rest = [k for k in range(len(table.columns)) if k not in angles]
    waves = [k for k in rest if is_wavelength(table.columns[k])]
    values = [k for k in rest if value_quantity(table.columns[k]) is not None]
    if len(rest) == 2 and len(waves) == len(values) == 1:
        return _widened(table, angles, waves[0], values[0])
    if len(rest) == 1:
        return _gray(table, rest[0])
    return _sorted(table, angles, rest)


def _one_sample(table: TextTable, sample_of: Ints, part: str | None) -> TextTable:
    number = chosen_part(table.path, table.samples, part)
    rows = sample_of == number
    name = printable(table.samples[number], 60)
    comments = {"name": (0, name), **table.comments}
    notes = (*table.notes, f"read the {int(np.sum(rows))} rows of sample {name!r}")
    return replace(
        table, comments=comments, values=table.values[rows], lines=table.lines[rows], notes=notes
    )


def _widened(table: TextTable, angles: list[int], wave: int, value: int) -> TextTable:
    """One row a geometry from one row a reading; repeated readings make further rows."""
    nm = table.values[:, wave]
    if np.any(np.isnan(nm)):
        row = int(np.argmax(np.isnan(nm)))
        raise InputError(f"{table.at(row, wave)}: the wavelength is empty; complete it")
    bands, band = np.unique(nm, return_inverse=True)
    geometry = _groups(table.values[:, angles])
    # How often the pair came before: a scan that is repeated makes rows of its own.
    pair = geometry * len(bands) + band
    order = np.argsort(pair, kind="stable")
    first = np.r_[True, np.diff(pair[order]) != 0]
    position = np.arange(len(pair))
    repeat = np.empty(len(pair), dtype=np.int64)
    repeat[order] = position - np.maximum.accumulate(np.where(first, position, 0))
    key = geometry * (int(np.max(repeat)) + 1) + repeat
    _, at, row = np.unique(key, return_index=True, return_inverse=True)
    by_line = np.argsort(at, kind="stable")
    place = np.empty_like(by_line)
    place[by_line] = np.arange(len(by_line))
    size = len(at) * len(bands)
    if len(bands) > MAX_COLUMNS or size > MAX_VALUES or len(pair) < LEAST_FILLED * size:
        raise InputError(
            f"{table.path}: line {table.header_line}: {len(pair)} readings of {len(at)} geometries "
            f"at {len(bands)} wavelengths; give each geometry at the same wavelengths"
        )
    readings = np.full((len(at), len(bands)), np.nan)
    readings[place[row.reshape(-1)], band] = table.values[:, value]
    rows = at[by_line]
    note = f"read {len(pair)} rows of one wavelength each as {len(at)} geometries"
    wide = replace(
        table,
        columns=(*(table.columns[k] for k in angles), *(f"{x:.10g}" for x in bands)),
        values=np.column_stack([table.values[np.ix_(rows, angles)], readings]),
        lines=table.lines[rows],
        numbers=(*(table.numbers[k] for k in angles), *[table.numbers[value]] * len(bands)),
        heading=table.columns[value],
        notes=(*table.notes, note),
    )
    return _gray(wide, len(angles)) if len(bands) == 1 else wide


def _groups(rows: Array) -> Ints:
    """(N,), a number for each row (N, A) that equal ones share.

    As np.unique does by axis, in a fifth of the time.
    """
    order = np.lexsort(rows.T)
    different = np.zeros(len(rows), dtype=np.int64)
    for column in rows.T:
        different[1:] |= column[order[1:]] != column[order[:-1]]
    groups = np.empty_like(different)
    groups[order] = np.cumsum(different)
    return groups


def _gray(table: TextTable, column: int) -> TextTable:
    """Three equal channels of a single one."""
    name = table.columns[column]
    nm = band_nm(name)
    label = f"{nm:g} nm" if nm is not None else printable(name, 30)
    _, readings, warning = one_channel(table.values[:, [column]], label)
    others = [k for k in range(len(table.columns)) if k != column]
    return replace(
        table,
        columns=(*(table.columns[k] for k in others), "R", "G", "B"),
        values=np.column_stack([table.values[:, others], readings]),
        numbers=(*(table.numbers[k] for k in others), *[table.numbers[column]] * 3),
        heading=table.heading if nm is not None else name,
        notes=(*table.notes, warning),
    )


def _sorted(table: TextTable, angles: list[int], rest: list[int]) -> TextTable:
    """Wavelengths that fall from column to column in increasing order."""
    found = [band_nm(table.columns[k]) for k in rest]
    nm: Array = np.array([np.nan if x is None else x for x in found])
    if len(nm) < 2 or not np.all(
        np.diff(nm) < 0.0
    ):  # False for NaN: what is no wavelength is refused later
        return table
    order = [*angles, *rest[::-1]]
    return replace(
        table,
        columns=tuple(table.columns[k] for k in order),
        values=table.values[:, order],
        numbers=tuple(table.numbers[k] for k in order),
        notes=(*table.notes, f"sorted the wavelengths, {nm[0]:g} to {nm[-1]:g} nm"),
    )
