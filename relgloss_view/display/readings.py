"""Readings of a display: what it showed for digital values, as an instrument read it.

`read_readings` recognises the format by content: CGATS (.ti3 of Argyll's dispread and fakeread,
and other programs' tables with RGB and XYZ), or a table of text.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.foreign import HEAD_BYTES, foreign_format
from relgloss_view.base.reading import read_beginning

EXPECTED = "readings of a display: a .ti3 file, or a table (CSV) with columns R,G,B,X,Y,Z"
CD_M2_OF_FOOT_LAMBERT = 10.7639104167 / np.pi  #: (1 / pi) candela per square foot


@dataclass(frozen=True, eq=False)
class Readings:
    """Patches of a display and their readings, in the order of the file.

    rgb: (N, 3), digital values from 0 to 1. xyz: (N, 3), CIE 1931, in cd/m2 where `absolute`;
    otherwise in an unknown unit, which only ratios come from. unit_declared: whether the file names
    the unit. places: of each patch, for messages, such as "line 12". source: the file or program.
    notes: what was taken for granted in reading. instrument: "" where nothing names it.
    """

    rgb: Array
    xyz: Array
    absolute: bool
    unit_declared: bool
    places: tuple[str, ...]
    source: str
    notes: tuple[str, ...] = ()
    instrument: str = ""

    @property
    def count(self) -> int:
        """How many patches were read."""
        return len(self.rgb)


def is_readings(data: bytes) -> bool:
    """Whether the beginning of a file looks like readings of a display.

    >>> is_readings(b"R,G,B,X,Y,Z\\n255,255,255,95,100,108\\n"), is_readings(b"[display]\\nx = 1")
    (True, False)
    """
    from relgloss_view.display.readings_cgats import is_cgats_of_display
    from relgloss_view.display.readings_table import is_table_of_display

    return is_cgats_of_display(data) or is_table_of_display(data)


def read_readings(path: str | Path) -> Readings:
    """The readings of a file. Raises InputError: one line with the place and the remedy."""
    from relgloss_view.display.readings_cgats import read_cgats
    from relgloss_view.display.readings_table import read_table

    path = Path(path)
    head = read_beginning(path, HEAD_BYTES, EXPECTED)
    foreign = foreign_format(head)
    if foreign is not None and foreign.key != "cgats":
        raise InputError(f"{path}: this looks like {foreign.name}; give {EXPECTED}")
    return read_cgats(path) if foreign is not None else read_table(path)


#: Full scales of digital values, the largest that each has.
FULL_SCALES = (1.0, 100.0, 255.0, 1023.0, 4095.0, 65535.0)
#: A white that is as near to these is a white of unknown luminance, set to 100 or 1.
NEAR_NORMALISED = 0.03


def digital_of(path: Path, rgb: Array, notes: list[str], declared: float | None) -> Array:
    """Digital values from 0 to 1 of a file's numbers (N, 3). Raises InputError.

    declared: the full scale that the file names; by the largest number otherwise, with a note.
    """
    low, high = float(rgb.min()), float(rgb.max())
    if low < 0.0:
        raise InputError(f"{path}: a digital value of {low:g}; expected R, G and B of 0 or more")
    scale = declared
    if scale is not None and high > scale * (1.0 + 1e-9):
        notes.append(
            f"R, G and B go up to {high:g} where {scale:g} is the largest; their scale is taken "
            "from their range instead"
        )
        scale = None
    if scale is None:
        if high > FULL_SCALES[-1]:
            raise InputError(f"{path}: a digital value of {high:g}; expected at most 65535")
        scale = next(s for s in FULL_SCALES if high <= s)
        if scale == FULL_SCALES[-1] and high == 65280.0 and not np.any(rgb % 256.0):
            scale = 65280.0  # 8 bits, shifted
        elif high == 0.0:
            raise InputError(f"{path}: every digital value is 0; expected patches of R, G and B")
        notes.append(f"R, G and B are taken as 0 to {scale:g}: the largest is {high:g}")
    return rgb / scale


def luminance_unit(xyz: Array, rgb: Array, declared: str | None, notes: list[str]) -> bool:
    """Whether XYZ (N, 3) of digital values (N, 3) are cd/m2. declared: "cd/m2", "relative", None.

    Where nothing is declared, a white at 100 or at 1 is taken for one that was set so.
    """
    if declared is not None:
        return declared == "cd/m2"
    white = white_of(xyz, rgb)
    for usual in (1.0, 100.0):
        if abs(white / usual - 1.0) <= NEAR_NORMALISED:
            notes.append(
                f"white reads Y = {white:.4g} and the file names no unit, so the readings are "
                f"taken as relative to white at {usual:g}: the luminance is unknown. If they are "
                "cd/m2, write cd/m2 into the heading of Y; otherwise give the luminance of white"
            )
            return False
    notes.append(f"XYZ are taken as cd/m2: white reads {white:.4g}, and the file names no unit")
    return True


def white_of(xyz: Array, rgb: Array) -> float:
    """Y of white: of the patches with the largest R, G and B, or the brightest where none is."""
    brightest = np.all(rgb >= rgb.max() - 1e-9, axis=1)
    y = xyz[brightest, 1] if np.any(brightest) else xyz[:, 1].max(keepdims=True)
    return float(np.median(y))


def xyz_of_xyy(path: Path, xyy: Array, places: tuple[str, ...]) -> Array:
    """XYZ of x, y, Y (CIE 15:2004); a patch without light may have any chromaticity."""
    dark = xyy[:, 2] <= 0.0
    wrong = ~dark & ((xyy[:, 1] <= 0.0) | (xyy[:, 0] < 0.0) | (xyy[:, 0] + xyy[:, 1] > 1.001))
    if np.any(wrong):
        k = int(np.argmax(wrong))
        raise InputError(
            f"{path}: {places[k]}: x = {xyy[k, 0]:g}, y = {xyy[k, 1]:g} is no chromaticity; "
            "expected 0 to 1, and no more than 1 together"
        )
    y = np.where(dark, 1.0, xyy[:, 1])
    x_y = np.stack([xyy[:, 0] / y, np.ones_like(y), (1.0 - xyy[:, 0] - y) / y], axis=1)
    return np.asarray(np.where(dark[:, None], 0.0, x_y * xyy[:, 2:]))
