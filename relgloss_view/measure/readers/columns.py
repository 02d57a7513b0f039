"""Which columns of a text table are angles and which are bands."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.measure.bands import FINEST_STEP_NM, RGB, WAVELENGTH_RANGE_NM, Bands
from relgloss_view.measure.readers.csv_table import TextTable


def split_columns(
    table: TextTable, angle_limits_deg: dict[str, float]
) -> tuple[Array, Bands, Array]:
    """Split a table into angles (N, A), bands and readings (N, B).

    angle_limits_deg: name of each angle column, in any place, and its largest magnitude, degrees.
    The other columns must be wavelengths in nm, or R, G, B. Raises InputError, which names the
    column.
    """
    where = f"{table.path}: line {table.header_line}"
    names = [column.lower() for column in table.columns]
    absent = [name for name in angle_limits_deg if name not in names]
    if absent:
        raise InputError(
            f"{where}: column {absent[0]} is missing; the header should begin "
            f"{','.join(angle_limits_deg)}"
        )
    angle_columns = [names.index(name) for name in angle_limits_deg]
    rest = [k for k in range(len(names)) if k not in angle_columns]
    bands = _bands(where, [(k, table.columns[k]) for k in rest])

    angles = table.values[:, angle_columns]
    limits = np.array(list(angle_limits_deg.values()))
    wrong = np.argwhere(~(np.abs(angles) <= limits))
    if len(wrong):
        row, which = wrong[0]
        place = table.at(row, angle_columns[which])
        if np.isnan(angles[row, which]):
            raise InputError(f"{place}: the angle is empty; complete it or remove the row")
        raise InputError(
            f"{place}: {angles[row, which]:g} deg is not between "
            f"-{limits[which]:g} and {limits[which]:g}; angles are in degrees"
        )
    return angles, bands, table.values[:, rest]


def _bands(where: str, columns: Sequence[tuple[int, str]]) -> Bands:
    """The bands of the columns (index, name)."""
    if not columns:
        raise InputError(f"{where}: no column of readings; add wavelengths in nm, or R,G,B")
    labels = [name.upper() for _, name in columns]
    if set(labels) & {"R", "G", "B"}:
        if labels != ["R", "G", "B"]:
            raise InputError(
                f"{where}: columns {','.join(labels)[:60]} after the angles; "
                "expected R,G,B or wavelengths in nm"
            )
        return RGB
    wavelengths: list[float] = []
    low, high = WAVELENGTH_RANGE_NM
    for k, name in columns:
        place = f"{where}, column {k + 1}"
        try:
            nm = float(name.lower().removesuffix("nm"))
        except ValueError:
            raise InputError(
                f"{place}: {name!a} is neither an angle, a wavelength in nm, nor R, G, B; "
                "rename or remove it"
            ) from None
        if not low <= nm <= high:
            raise InputError(
                f"{place}: wavelength {name} is not between {low:g} and {high:g} nm; correct it"
            )
        if wavelengths and nm <= wavelengths[-1]:
            raise InputError(
                f"{place}: {nm:g} nm follows {wavelengths[-1]:g} nm; "
                "put the wavelengths in increasing order, each once"
            )
        if wavelengths and nm - wavelengths[-1] < FINEST_STEP_NM:
            raise InputError(
                f"{place}: {nm:g} nm follows {wavelengths[-1]:g} nm; "
                f"leave at least {FINEST_STEP_NM:g} nm between wavelengths"
            )
        wavelengths.append(nm)
    if len(wavelengths) < 2:
        raise InputError(
            f"{where}, column {columns[0][0] + 1}: {columns[0][1]} is the only wavelength; "
            "a spectral table needs two or more (or R,G,B)"
        )
    return Bands(tuple(wavelengths))
