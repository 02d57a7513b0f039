"""Entries: the parts of a proof's content that pages and checks use, within bounds.

Sealing is anybody's, so whatever is sealed may be anyone's. A text of a wrong kind would become
markup in a page, a number beyond all bounds would take a machine's memory.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import number, refuse, text
from relgloss_view.proof.settings import SIDES

MOST_FILES, LONGEST_FILE_NAME = 64, 80  #: and characters of each name
MOST_PX, MOST_PIXELS = 16384, 2048 * 2048  #: of a side, and of a picture
MOST_PICTURE = 8_000_000  #: characters of a stored picture's base64
MEDIA = ("image/webp", "image/png")
MOST_POINTS = 64  #: columns and rows of the check grid
MOST_LAB = 1000.0  #: of L*, a*, b*, beyond any picture's
MOST_READINGS, MOST_DECIMALS, MOST_READING = 100, 6, 1e6
MOST_FINISHES = 100
MOST_LINES, MOST_LINE = 100, 20_000  #: texts of a page, and characters of one
LIGHTS = ("luminance_cd_m2", "black_cd_m2", "reflected_cd_m2")
MOST_LIGHT = 1e6
_BASE64 = re.compile(r"[A-Za-z0-9+/]*={0,2}")


def check_entries(content: Mapping[str, Any]) -> None:
    """InputError where pictures, grid, meter or display are not what a page can show."""
    check_size(content.get("size_px"))
    for side, picture in _table(content.get("pictures", {}), "content.pictures").items():
        _check_picture(picture, f"content.pictures.{side[:40]}")
    grid = _table(content.get("grid", {}), "content.grid")
    for name in ("columns", "rows"):
        count = grid.get(name, 1)
        if type(count) is not int or not 0 < count <= MOST_POINTS:
            refuse(f"content.grid.{name}", f"1 to {MOST_POINTS}", count)
    for side, points in _table(grid.get("sides", {}), "content.grid.sides").items():
        most = grid.get("columns", 1) * grid.get("rows", 1)
        _check_points(points, f"content.grid.sides.{side[:40]}", most)
    for side, name in _table(content.get("names", {}), "content.names").items():
        _check_line(name, f"content.names.{side[:40]}")
    _check_meter(content.get("meter"))
    _check_finishes(content.get("meter_finishes"))
    _check_display(content.get("display"))


def check_size(size: object) -> None:
    """InputError for a size in pixels that no proof has."""
    sides = size if isinstance(size, list | tuple) and len(size) == 2 else (0, 0)
    if any(type(n) is not int or not 0 < n <= MOST_PX for n in sides):
        refuse("content.size_px", f"width and height, 1 to {MOST_PX}", size)
    if sides[0] * sides[1] > MOST_PIXELS:
        refuse("content.size_px", f"at most {MOST_PIXELS} pixels together", size)


def _check_picture(picture: object, place: str) -> None:
    """A picture is base64 of WebP, or a table with its media type."""
    table = {"type": MEDIA[0], "base64": picture} if isinstance(picture, str) else picture
    if not isinstance(table, Mapping) or set(table) != {"type", "base64"}:
        refuse(place, "base64 of a WebP", picture)
    kind, coded = table["type"], table["base64"]
    if kind not in MEDIA:
        refuse(f"{place}.type", " or ".join(MEDIA), kind)
    if not isinstance(coded, str) or len(coded) > MOST_PICTURE or not _BASE64.fullmatch(coded):
        refuse(place, f"base64, at most {MOST_PICTURE} characters", coded)


def _check_points(points: object, place: str, most: int) -> None:
    for name, rows in _table(points, place).items():
        where = f"{place}.{name[:40]}"
        if not isinstance(rows, list) or len(rows) > most:
            refuse(where, f"a list of at most {most} points", rows)
        for k, row in enumerate(rows):
            values = (row,) if name != "lab" or row is None else row
            if not isinstance(values, list | tuple) or len(values) not in (1, 3):
                refuse(f"{where}[{k}]", "three numbers or null", row)
            for value in values:
                if value is not None:
                    number(value, f"{where}[{k}]", "L*, a* or b*", -MOST_LAB, MOST_LAB)


def _check_meter(meter: object) -> None:
    if meter is None:
        return
    table = _table(meter, "content.meter")
    if len(table) > MOST_READINGS:
        refuse("content.meter", f"at most {MOST_READINGS} readings", len(table))
    for key, values in table.items():
        place = f"content.meter[{key[:40]!r}]"
        entry = _table(values, place)
        _check_line(entry.get("name"), f"{place}.name")
        decimals = entry.get("decimals", 1)
        if type(decimals) is not int or not 0 <= decimals <= MOST_DECIMALS:
            refuse(f"{place}.decimals", f"0 to {MOST_DECIMALS}", decimals)
        for side in SIDES:
            if entry.get(side) is not None:
                number(entry[side], f"{place}.{side}", "a reading", -MOST_READING, MOST_READING)


def _check_finishes(finishes: object) -> None:
    """The readings of each finish of a pack."""
    if finishes is None:
        return
    if not isinstance(finishes, list) or len(finishes) > MOST_FINISHES:
        refuse("content.meter_finishes", f"at most {MOST_FINISHES} finishes", finishes)
    for k, one in enumerate(finishes):
        place = f"content.meter_finishes[{k}]"
        entry = _table(one, place)
        _check_line(entry.get("finish"), f"{place}.finish")
        readings = _table(entry.get("readings"), f"{place}.readings")
        if len(readings) > MOST_READINGS:
            refuse(f"{place}.readings", f"at most {MOST_READINGS} readings", len(readings))
        for key, value in readings.items():
            if value is not None:
                where = f"{place}.readings[{key[:40]!r}]"
                number(value, where, "a reading", -MOST_READING, MOST_READING)


def _check_display(display: object) -> None:
    if display is None:
        return
    entry = _table(display, "content.display")
    for name in LIGHTS:
        if name in entry:
            number(entry[name], f"content.display.{name}", "cd/m2", 0.0, MOST_LIGHT)
    sentences = entry.get("sentences", [])
    if not isinstance(sentences, list) or len(sentences) > MOST_LINES:
        refuse("content.display.sentences", f"at most {MOST_LINES} texts", sentences)
    for line in (entry.get("name", ""), entry.get("words", ""), *sentences):
        _check_line(line, "content.display")


def _check_line(line: object, place: str) -> None:
    if len(text(line, place)) > MOST_LINE:
        raise InputError(f"{place}: longer than {MOST_LINE} characters; shorten it")


def _table(value: object, place: str) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        refuse(place, "an object", value)
    return value
