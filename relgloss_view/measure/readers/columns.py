"""Which columns of a text table are angles and which are bands."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.measure.bands import FINEST_STEP_NM, RGB, WAVELENGTH_RANGE_NM, Bands
from relgloss_view.measure.readers.csv_table import TextTable
from relgloss_view.measure.readers.headings import DEGREES, RADIANS, band_nm, colour_name

#: A table of a few degrees around the normal has no larger angle than this, and is believed.
MOST_NEAR_MIRROR = 0.6
#: Radians are rounded, and 1.5708 lies a little beyond a right angle.
ROUNDING_DEG = 0.01


def split_columns(
    table: TextTable, angle_limits_deg: dict[str, float], unit: str | None = None
) -> tuple[Array, Bands, Array]:
    """Split a table into angles (N, A), degrees, bands and readings (N, B).

    angle_limits_deg: name of each angle column, in any place, and its largest magnitude, degrees.
    unit: of all angles, RADIANS or DEGREES; None: that of each heading, degrees where it has none.
    The other columns must be wavelengths in nm, or R, G, B. Raises InputError, which names the
    column; also where angles of no declared unit look like radians.
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
    bands = _bands(where, [(table.numbers[k], table.columns[k]) for k in rest])

    angles = table.values[:, angle_columns]
    limits = np.array(list(angle_limits_deg.values()))
    declared = [unit or (RADIANS if name in table.radians else None) for name in angle_limits_deg]
    if unit is None and not table.radians:
        doubt = radians_doubt(angles, limits)
        if doubt is not None:
            raise InputError(f"{table.path}: {doubt}")
    in_radians = np.array([d == RADIANS for d in declared])
    in_degrees = np.where(in_radians, np.degrees(angles), angles)
    wrong = np.argwhere(~(np.abs(in_degrees) <= limits + ROUNDING_DEG * in_radians))
    if len(wrong):
        row, which = wrong[0]
        place = table.at(row, angle_columns[which])
        if np.isnan(angles[row, which]):
            raise InputError(f"{place}: the angle is empty; complete it or remove the row")
        name = "rad" if in_radians[which] else "deg"
        limit = np.radians(limits[which]) if in_radians[which] else limits[which]
        raise InputError(
            f"{place}: {angles[row, which]:g} {name} is not between {-limit:g} and {limit:g}; "
            f"angles are in {'radians' if in_radians[which] else 'degrees'}"
        )
    return np.clip(in_degrees, -limits, limits), bands, table.values[:, rest]


def radians_doubt(angles: Array, limits_deg: Array) -> str | None:
    """The question and its remedy where angles (N, A) may be radians, else None.

    limits_deg: (A,), largest magnitude of each angle, degrees. No goniophotometer stays within 1.6
    degrees of the normal with lamp, receiver and azimuths at once; angles in radians all do.

    >>> radians_doubt(np.array([[0.0, 0.0, 0.7854, 3.1416]]), np.array([90, 360, 90, 360]))
    "all angles lie below 1.6 (azimuths below 6.3): are they radians? ..."
    >>> radians_doubt(np.array([[0.0, 0.0, 1.0, 180.0]]), np.array([90, 360, 90, 360])) is None
    True
    """
    sizes = np.abs(angles[np.isfinite(angles).all(axis=1)])
    remedy = (
        f"are they {RADIANS}? Add the line '# angle_unit: {RADIANS}' (or '# angle_unit: {DEGREES}' "
        f"if they are right) on top, or pass --angle-unit"
    )
    if not sizes.size or not np.any(sizes % 1.0):
        return None
    azimuth = limits_deg > 180.0
    polar_small = bool(np.all(sizes[:, ~azimuth] <= np.pi / 2 + 1e-2))
    azimuth_small = bool(np.all(sizes[:, azimuth] <= 2 * np.pi + 1e-2))
    if polar_small and azimuth_small and float(np.max(sizes)) > MOST_NEAR_MIRROR:
        below = " (azimuths below 6.3)" if np.any(azimuth) else ""
        return f"all angles lie below 1.6{below}: {remedy}"
    if not np.any(azimuth) or polar_small == azimuth_small:
        return None
    # One kind alone: azimuths are mostly quarters and halves of a turn, which radians give away.
    some = sizes[:, azimuth if azimuth_small else ~azimuth]
    if azimuth_small:
        eighths = some / (np.pi / 4)
        turned = (some > 0.1) & (np.abs(eighths - np.rint(eighths)) < 2e-3)
        most = np.sum(turned) > 0.5 * np.sum(some > 0.1)
        return f"the azimuths lie below 6.3: {remedy}" if most else None
    if len(np.unique(some)) > 2 and float(np.max(some)) > MOST_NEAR_MIRROR:
        return f"the polar angles lie below 1.6: {remedy}"
    return None


def _bands(where: str, columns: Sequence[tuple[int, str]]) -> Bands:
    """The bands of the columns (number in the file, name)."""
    if not columns:
        raise InputError(f"{where}: no column of readings; add wavelengths in nm, or R,G,B")
    colours = [colour_name(name) for _, name in columns]
    if any(colours):
        if colours != ["R", "G", "B"]:
            found = ",".join(name for _, name in columns)
            raise InputError(
                f"{where}: columns {printable(found, 60)} after the angles; "
                "expected R,G,B or wavelengths in nm"
            )
        return RGB
    wavelengths: list[float] = []
    low, high = WAVELENGTH_RANGE_NM
    for k, name in columns:
        place = f"{where}, column {k}"
        nm = band_nm(name) or 0.0  # another number, such as -400, is no wavelength either
        if not low <= nm <= high:
            raise InputError(
                f"{place}: wavelength {name} is not between {low:g} and {high:g} nm; "
                f"correct it{' to nanometres' if low <= 1000.0 * nm <= high else ''}"
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
            f"{where}, column {columns[0][0]}: {columns[0][1]} is the only wavelength; "
            "a spectral table needs two or more (or R,G,B)"
        )
    return Bands(tuple(wavelengths))
