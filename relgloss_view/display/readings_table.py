"""Readings of a display from a table of text: R,G,B and X,Y,Z or x,y,Y, as spreadsheets save it.

Commas, semicolons, tabs or spaces between cells; decimal commas where no comma lies between cells.
"""

from __future__ import annotations

import csv
import io
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from relgloss_view.base import cells
from relgloss_view.base.arrays import Array
from relgloss_view.base.decoding import decoded, decoded_beginning
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable, read_bytes
from relgloss_view.display.readings import (
    CD_M2_OF_FOOT_LAMBERT,
    EXPECTED,
    FULL_SCALES,
    Readings,
    digital_of,
    luminance_unit,
    xyz_of_xyy,
)

MOST_BYTES = 16 * 1024 * 1024
MOST_ROWS = 30_000
MOST_COLUMNS = 500
LONGEST_LINE = 20_000
LONGEST_HEADING = 200  #: characters; the time of the patterns grows with its square
MOST_TITLES = 60  #: lines above the headings

#: Headings, without units and signs, in lower case; X, Y, Z and x, y are told apart by their case.
_DIGITAL = {
    "r": ("r", "red", "rgbr", "rin", "rd", "rdigital", "r8", "r10", "r16", "rvalue", "inputr"),
    "g": ("g", "green", "rgbg", "gin", "gd", "gdigital", "g8", "g10", "g16", "gvalue", "inputg"),
    "b": ("b", "blue", "rgbb", "bin", "bd", "bdigital", "b8", "b10", "b16", "bvalue", "inputb"),
}
_XYZ = {
    "X": ("xyzx", "ciex", "tristimulusx", "xmeas", "xmeasured"),
    "Y": ("xyzy", "ciey", "tristimulusy", "ymeas", "ymeasured"),
    "Z": ("z", "xyzz", "ciez", "tristimulusz", "zmeas", "zmeasured"),
}
_LUMINANCE = ("lv", "luminance", "lum", "bigy", "xyybigy", "xyyy", "cdm2", "nits", "leuchtdichte")
_UNIT = re.compile(r"\(([^)]*)\)|\[([^\]]*)\]")
_CD_M2 = re.compile(r"cd\s*[/*.·]?\s*(m\^?2|m²|sqm|m-2|m\^-2)|\bnits?\b|candela", re.IGNORECASE)
_FOOT_LAMBERT = re.compile(r"\bfl\b|ft-?l|foot-?\s?lambert", re.IGNORECASE)
_RELATIVE = re.compile(r"%|percent|relative|normali[sz]ed", re.IGNORECASE)
_SCALE = re.compile(r"0\s*(?:-|to|\.\.+|…|–|bis)\s*(\d+)|(\d+)\s*-?\s*bits?", re.IGNORECASE)


@dataclass(frozen=True)
class _Heads:
    """Where the columns are, and what the headings declare."""

    digital: tuple[int, int, int]
    colour: tuple[int, int, int]
    xyy: bool
    unit: str | None  #: "cd/m2", "fL", "relative"
    scale: float | None


def is_table_of_display(data: bytes) -> bool:
    """Whether the beginning of a file has headings of RGB and XYZ, or six columns of numbers."""
    text = decoded_beginning(data[:16384])
    lines = text.splitlines()[:MOST_TITLES]
    return any(_heads(_cells(line, _delimiter(line))) is not None for line in lines)


def read_table(path: Path) -> Readings:
    """The readings of a table. Raises InputError: one line with the place and the remedy."""
    text = decoded(read_bytes(path, MOST_BYTES, EXPECTED), str(path))
    notes = [text.note] if text.note else []
    lines = text.text.splitlines()
    long = next((k for k, line in enumerate(lines) if len(line) > LONGEST_LINE), None)
    if long is not None:
        raise InputError(f"{path}: line {long + 1}: longer than {LONGEST_LINE}; give {EXPECTED}")
    start, delimiter, heads = _beginning(path, lines, notes)
    above = " ".join(lines[: max(start, 0)])[:2000]
    comma = delimiter != "," and any("," in line for line in lines[start + 1 :])
    numbers, places = _rows(path, lines, start + 1, delimiter, heads, comma, notes)
    digital, colour = numbers[:, :3], numbers[:, 3:]
    unit = heads.unit or _unit_of(above)
    rgb = digital_of(path, digital, notes, heads.scale)
    if heads.xyy:
        colour = xyz_of_xyy(path, colour, places)
    if unit == "fL":
        colour = colour * CD_M2_OF_FOOT_LAMBERT
        notes.append("Y is in foot-lamberts; it is taken times 3.426 as cd/m2")
        unit = "cd/m2"
    absolute = luminance_unit(colour, rgb, unit, notes)
    return Readings(rgb, colour, absolute, unit is not None, places, str(path), tuple(notes))


def _beginning(path: Path, lines: list[str], notes: list[str]) -> tuple[int, str | None, _Heads]:
    """The line of the headings, from 0 and -1 for none; the delimiter; where the columns are."""
    if not any(line.strip() for line in lines):
        raise InputError(f"{path}: the file is empty; give {EXPECTED}")
    for k, line in enumerate(lines[:MOST_TITLES]):
        delimiter = _delimiter(line)
        heads = _heads(_cells(line, delimiter))
        if heads is not None:
            return k, delimiter, heads
    first = next((k for k, ln in enumerate(lines[:MOST_TITLES]) if _numeric(ln)), None)
    if first is not None:
        delimiter = _delimiter(lines[first])
        count = len(_cells(lines[first], delimiter))
        if count in (6, 7):
            extra = count - 6
            notes.append(
                "the table has no headings; its columns are taken as "
                + ("a number, " if extra else "")
                + "R, G, B, X, Y, Z"
            )
            digital, colour = (extra, extra + 1, extra + 2), (extra + 3, extra + 4, extra + 5)
            return first - 1, delimiter, _Heads(digital, colour, False, None, None)
    raise InputError(
        f"{path}: no headings R, G, B with X, Y, Z or x, y, Y in the first {MOST_TITLES} lines; "
        f"give {EXPECTED}"
    )


def _delimiter(line: str) -> str | None:
    return next((d for d in ("\t", ";", "|", ",") if d in line), None)


def _cells(line: str, delimiter: str | None) -> list[str]:
    """The cells of a line, at most MOST_COLUMNS."""
    text = line.strip("\r\n").strip(" ")
    if delimiter is None:
        found = text.split()
    elif '"' in text:
        try:
            found = next(csv.reader(io.StringIO(text), delimiter=delimiter), [])
        except csv.Error:
            found = text.split(delimiter)
    else:
        found = text.split(delimiter)
    return [cell.strip().strip('"') for cell in found[:MOST_COLUMNS]]


def _numeric(line: str) -> bool:
    found = [cell for cell in _cells(line, _delimiter(line)) if cell]
    return len(found) >= 6 and all(cells.is_number(cell) for cell in found)


def _plain(heading: str) -> str:
    """A heading without its unit and signs; its case stays."""
    bare = _UNIT.sub("", heading[:LONGEST_HEADING].lstrip("#"))
    for unit in (_CD_M2, _FOOT_LAMBERT, _SCALE, _RELATIVE):
        bare = bare if unit.fullmatch(bare.strip()) else unit.sub("", bare)
    return "".join(c for c in bare if c.isalnum())


def _heads(headings: list[str]) -> _Heads | None:
    plain = [_plain(h) for h in headings]
    low = [p.lower() for p in plain]
    digital = [next((k for k, h in enumerate(low) if h in _DIGITAL[c]), None) for c in "rgb"]
    if None in digital:
        return None
    lightness = {h.lower() for h in plain} & {"l", "lstar", "labl", "cielabl"}
    upper = [
        next((k for k, p in enumerate(plain) if p == c or p.lower() in _XYZ[c]), None)
        for c in "XYZ"
    ]
    small = [next((k for k, p in enumerate(plain) if p in (c, f"cie{c}", f"xyy{c}")), None)
             for c in "xy"]  # fmt: skip
    luminance = next((k for k, p in enumerate(plain) if p in ("Y", "L") and small[0] is not None),
                     None)  # fmt: skip
    if luminance is None:
        luminance = next((k for k, p in enumerate(low) if p in _LUMINANCE), None)
    if None in upper and low.count("x") == low.count("y") == low.count("z") == 1:
        upper = [low.index(c) for c in "xyz"]  # r,g,b,x,y,z
    colour, xyy = upper, False
    if None in upper:
        colour, xyy = [*small, luminance], True
    if None in colour or (lightness and None in colour):
        return None
    named = [headings[k] for k in (*digital, *colour) if k is not None]
    return _Heads(
        _three(digital), _three(colour), xyy, _unit_of(" ".join(named[3:])), _scale_of(named[:3])
    )


def _three(columns: list[int | None]) -> tuple[int, int, int]:
    r, g, b = (c for c in columns if c is not None)
    return r, g, b


def _unit_of(text: str) -> str | None:
    for unit, pattern in (("cd/m2", _CD_M2), ("fL", _FOOT_LAMBERT), ("relative", _RELATIVE)):
        if pattern.search(text):
            return unit
    return None


def _scale_of(headings: list[str]) -> float | None:
    """The full scale that the headings of R, G, B name, such as "R (0-255)" or "R 10 bit"."""
    scales = set()
    for heading in headings:
        match = _SCALE.search(heading)
        if match:
            scales.add(float(match[1]) if match[1] else float(2 ** min(int(match[2]), 16) - 1))
        elif "%" in heading:
            scales.add(100.0)
        elif _plain(heading).lower()[1:] in ("8", "10", "16"):
            scales.add(float(2 ** int(_plain(heading)[1:]) - 1))
    return scales.pop() if len(scales) == 1 and scales <= set(FULL_SCALES) else None


def _rows(
    path: Path,
    lines: list[str],
    start: int,
    delimiter: str | None,
    heads: _Heads,
    comma: bool,
    notes: list[str],
) -> tuple[Array, tuple[str, ...]]:
    """The numbers (N, 6) of the rows, and their places."""
    wanted = (*heads.digital, *heads.colour)
    width = len(_cells(lines[start - 1] if start else lines[0], delimiter))
    numbers: list[list[float]] = []
    places: list[str] = []
    for k in range(start, len(lines)):
        found = _cells(lines[k], delimiter)
        if not any(found) or lines[k].lstrip().startswith("#"):
            continue
        if len(found) <= max(wanted) or not any(cells.is_number(found[c]) for c in wanted):
            if any(cells.is_number(c) for c in found) or not numbers:
                raise InputError(
                    f"{path}: line {k + 1}: {len(found)} cells without the numbers of a patch; "
                    "correct the row or delete it"
                )
            notes.append(f"line {k + 1} and what follows it is no row of numbers: passed over")
            break
        if len(found) > width and any(found[width:]):
            raise InputError(
                f"{path}: line {k + 1}: {len(found)} cells, and {width} in the line of the "
                "headings; write numbers without thousands separators"
            )
        if len(numbers) == MOST_ROWS:
            raise InputError(f"{path}: more than {MOST_ROWS} patches; split the file")
        numbers.append([_number(path, k, found[c], comma) for c in wanted])
        places.append(f"line {k + 1}")
    if not numbers:
        raise InputError(f"{path}: headings without a row of numbers; give {EXPECTED}")
    return np.array(numbers), tuple(places)


def _number(path: Path, line: int, cell: str, comma: bool) -> float:
    try:
        value = cells.reading(cell, comma)
    except InputError as error:
        raise InputError(
            f"{path}: line {line + 1}: found {printable(cell, 30)!r}, expected a number; {error}"
        ) from None
    if not np.isfinite(value):
        raise InputError(
            f"{path}: line {line + 1}: a patch without a number; measure it again, or delete the "
            "row"
        )
    return value
