"""Readings of a display from CGATS text, as Argyll's dispread, fakeread and others write it.

Sources: Argyll CMS 2.3 documentation, "File formats, .ti3" (RGB 0 to 100, XYZ normalised to Y = 100
where NORMALIZED_TO_Y_100 is YES, LUMINANCE_XYZ_CDM2); ANSI CGATS.17 (fields).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from relgloss_view.base import cells
from relgloss_view.base.arrays import Array
from relgloss_view.base.cgats import Table, Take, read_tables
from relgloss_view.base.decoding import decoded_beginning
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.display.readings import (
    EXPECTED,
    NEAR_NORMALISED,
    Readings,
    digital_of,
    luminance_unit,
    white_of,
    xyz_of_xyy,
)

_DIGITAL = tuple((f"RGB_{c}",) for c in "RGB")
_XYZ = tuple((f"XYZ_{c}",) for c in "XYZ")
_LAB = tuple((f"LAB_{c}",) for c in "LAB")
_XYY = (("XYY_X",), ("XYY_Y",), ("XYY_CAPY",))


@dataclass
class _Part:
    """One table with readings."""

    keywords: dict[str, str]
    xyy: bool
    rows: list[list[float]] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)


def is_cgats_of_display(data: bytes) -> bool:
    """Whether the beginning of a file is CGATS with readings of RGB."""
    text = decoded_beginning(data[:16384])
    return bool(re.search(r"^\s*BEGIN_DATA_FORMAT", text, re.M)) and "RGB_R" in text


def read_cgats(path: Path) -> Readings:
    """The readings of a CGATS file; those of all its tables with RGB and XYZ. InputError."""
    parts: list[_Part] = []
    others: set[str] = set()

    def begin(table: Table) -> Take:
        digital = _columns(table, _DIGITAL)
        colour, xyy = _columns(table, _XYZ), False
        if colour is None:
            colour, xyy = _columns(table, _XYY), True
        if table.column(("RGB_I",)) is not None:
            others.add("calibration")
            return lambda line, words: None
        if digital is None or colour is None:
            if digital is not None and _columns(table, _LAB) is not None:
                others.add("CIELAB")
            elif digital is not None:
                others.add("digital values without readings")
            return lambda line, words: None
        part = _Part(dict(table.keywords), xyy)
        parts.append(part)

        def take(line: int, words: list[str]) -> None:
            numbers = table.numbers(path, line, words, digital + colour)
            if not np.all(np.isfinite(numbers)):
                raise InputError(
                    f"{path}: line {line}: a patch without a number; measure it again, or delete "
                    "its line"
                )
            part.rows.append(numbers)
            part.lines.append(line)

        return take

    notes = read_tables(path, EXPECTED, begin)
    parts = [part for part in parts if part.rows]
    if not parts:
        raise _without_readings(path, others)
    if len(parts) > 1:
        notes.append(f"the readings of {len(parts)} tables in the file are taken together")
    return _joined(path, parts, others, notes)


def _columns(table: Table, names: tuple[tuple[str, ...], ...]) -> tuple[int, ...] | None:
    columns = [table.column(name) for name in names]
    return None if None in columns else tuple(c for c in columns if c is not None)


def _without_readings(path: Path, others: set[str]) -> InputError:
    if "CIELAB" in others:
        return InputError(
            f"{path}: the readings are CIELAB, which has no luminance; export XYZ instead "
            "(fakeread: leave out -l)"
        )
    if others:
        return InputError(
            f"{path}: digital values without readings, as .ti1 and calibrations have them; give "
            "the .ti3 that dispread wrote"
        )
    return InputError(
        f"{path}: no table with RGB_R RGB_G RGB_B and XYZ_X XYZ_Y XYZ_Z; give {EXPECTED}"
    )


def _joined(path: Path, parts: list[_Part], others: set[str], notes: list[str]) -> Readings:
    rgb, xyz, units = [], [], []
    for part in parts:
        numbers = np.array(part.rows)
        digital = digital_of(path, numbers[:, :3], notes, _full_scale(part))
        places = tuple(f"line {line}" for line in part.lines)
        colour = xyz_of_xyy(path, numbers[:, 3:], places) if part.xyy else numbers[:, 3:]
        colour, declared = _scaled(path, part.keywords, colour, digital, notes)
        rgb.append(digital)
        xyz.append(colour)
        units.append((luminance_unit(colour, digital, declared, notes), declared is not None))
    if len({absolute for absolute, _ in units}) > 1:
        raise InputError(
            f"{path}: one table is in cd/m2 and another is relative to its white; split the file"
        )
    keywords = parts[0].keywords
    if "calibration" in others:
        notes.append("the readings were made through a calibration, which must be loaded to view")
    return Readings(
        np.vstack(rgb),
        np.vstack(xyz),
        units[0][0],
        all(known for _, known in units),
        tuple(f"line {line}" for part in parts for line in part.lines),
        str(path),
        tuple(dict.fromkeys(notes)),
        printable(keywords.get("TARGET_INSTRUMENT", keywords.get("INSTRUMENTATION", "")), 80),
    )


def _full_scale(part: _Part) -> float | None:
    """100 of Argyll's files; None where the range decides."""
    origin = (part.keywords.get(k, "") for k in ("ORIGINATOR", "DESCRIPTOR"))
    return 100.0 if "argyll" in " ".join(origin).lower() else None


def _scaled(
    path: Path, keywords: dict[str, str], xyz: Array, rgb: Array, notes: list[str]
) -> tuple[Array, str | None]:
    """XYZ and the unit that the keywords declare, "cd/m2" or "relative"; None for neither."""
    normalised = keywords.get("NORMALIZED_TO_Y_100", "").upper()
    written = keywords.get("LUMINANCE_XYZ_CDM2", "")
    if not written:
        if normalised == "NO":
            return xyz, "cd/m2"
        if normalised == "YES":
            notes.append(
                "the file is normalised to Y = 100 and has no LUMINANCE_XYZ_CDM2: the luminance "
                "is unknown"
            )
            return xyz, "relative"
        return xyz, None
    words = written.split()
    if len(words) != 3 or not all(cells.is_number(w) for w in words):
        raise InputError(
            f"{path}: LUMINANCE_XYZ_CDM2 {printable(written, 40)!r}: expected X, Y and Z of white "
            "in cd/m2"
        )
    white = float(words[1].replace(",", "."))
    if not 0.0 < white < 1e6:
        raise InputError(
            f"{path}: LUMINANCE_XYZ_CDM2 has Y = {white:g}; expected the white's cd/m2, above 0"
        )
    shown = white_of(xyz, rgb)
    if normalised == "NO" or (not normalised and abs(shown / white - 1.0) <= NEAR_NORMALISED):
        return xyz, "cd/m2"
    if abs(shown / 100.0 - 1.0) > 0.1:
        notes.append(
            f"LUMINANCE_XYZ_CDM2 is for readings normalised to Y = 100, and white reads {shown:.4g}"
        )
    return xyz * (white / 100.0), "cd/m2"
