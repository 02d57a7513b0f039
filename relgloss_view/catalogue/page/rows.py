"""What a page holds of each row: its values by column, its links, its command, its picture.

Every text of a file is made harmless here (printable), and cut, before it goes anywhere.
"""

from __future__ import annotations

import io
import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from relgloss_view.base.reading import printable
from relgloss_view.base.shell import command_line, operand
from relgloss_view.catalogue.columns import BY_NAME, FLAG, NUMBER, WHOLE
from relgloss_view.catalogue.places import parts_within
from relgloss_view.catalogue.query.found import Found, Hit
from relgloss_view.catalogue.thumbnail import opened_thumbnail

LONGEST = 160  #: characters of a text
LONGEST_WARNING, MOST_WARNINGS = 400, 12
#: Columns of the page, in the order of its table; those of SHOWN are in the table.
SHOWN = (
    "name", "kind", "quality", "gloss_20", "gloss_60", "gloss_75", "gloss_85", "haze", "s_deg_1",
    "L_star", "a_star", "b_star", "gloss_ratio", "marks",
)  # fmt: skip
FURTHER = (
    "path", "source", "model", "diffuse_model", "sigma_deg", "lobes", "s_deg_2", "doi",
    "contrast_gloss", "distinctness", "sigma_n_deg", "c", "c_max", "is_ratio_kept", "geometries",
    "bands",
)  # fmt: skip
DECIMALS = {"GU": 1, "degrees": 2}
OF_COLUMN = {"L_star": 1, "a_star": 1, "b_star": 1, "haze": 1, "doi": 1, "gloss_ratio": 2}


def columns_of(found: Found) -> list[dict[str, Any]]:
    """The page's columns as its script reads them: the rank, what was computed, the table's."""
    rank = _column("rank", "as found", "number", 0, shown=False)
    computed = [
        _column(f"found_{m.key}", printable(m.label, 60), "number", m.decimals, m.unit)
        for m in found.measures
    ]
    own = []
    for name in SHOWN + FURTHER:
        column = BY_NAME[name]
        kind = "number" if column.kind in (NUMBER, WHOLE) else "text"
        decimals = 0 if column.kind == WHOLE else OF_COLUMN.get(name, DECIMALS.get(column.unit, 3))
        own.append(_column(name, column.label, kind, decimals, column.unit, name in SHOWN))
    return [rank, own[0], *computed, *own[1:]]


def _column(
    name: str, label: str, kind: str, decimals: int, unit: str = "", shown: bool = True
) -> dict[str, Any]:
    return {"name": name, "label": label, "unit": unit, "kind": kind, "decimals": decimals,
            "shown": shown, "sorted": shown or name in ("rank", "path", "doi")}  # fmt: skip


def values_of(
    hits: Sequence[Hit], columns: Sequence[Mapping[str, Any]]
) -> dict[str, list[Any] | None]:
    """Values by column, None where one is missing; None for a column without any."""
    return {column["name"]: _column_of([_value(hit, column["name"]) for hit in hits])
            for column in columns}  # fmt: skip


def errors_of(
    hits: Sequence[Hit], columns: Sequence[Mapping[str, Any]]
) -> dict[str, list[Any] | None]:
    """Standard errors by column, of the columns that have some."""
    return {
        name: _column_of([number(hit.row.get(f"{name}_se")) for hit in hits])
        for name in (column["name"] for column in columns)
        if f"{name}_se" in BY_NAME
    }


def _column_of(values: list[Any]) -> list[Any] | None:
    return values if any(value is not None for value in values) else None


def _value(hit: Hit, name: str) -> Any:
    if name == "rank":
        return hit.rank
    if name.startswith("found_"):
        return number(hit.numbers.get(name.removeprefix("found_")))
    if name == "name":
        return printable(hit.name, LONGEST)
    value = hit.row.get(name)
    kind = BY_NAME[name].kind
    if kind in (NUMBER, WHOLE):
        return number(value)
    if kind == FLAG:
        return None if value is None else "yes" if value else "no"
    return printable(value, LONGEST) if value else None


def number(value: object) -> float | int | None:
    """A finite number with six significant digits, or None.

    >>> number(45.123456789), number(float("nan")), number(None)
    (45.1235, None, None)
    """
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return None
    return value if isinstance(value, int) else float(f"{value:.6g}")


def warnings_of(hit: Hit) -> list[str]:
    """The warnings of an item, each on a line."""
    lines = str(hit.row.get("warnings") or "").splitlines()[: MOST_WARNINGS + 1]
    texts = [printable(line, LONGEST_WARNING) for line in lines if line.strip()]
    return texts[:MOST_WARNINGS] + (["..."] if len(texts) > MOST_WARNINGS else [])


def material_place(hit: Hit, catalogue: Path, page: Path) -> str:
    """The item's material file from the page's folder; '' where there is none in the catalogue."""
    parts = parts_within(str(hit.row.get("material") or ""))
    return beside(catalogue.joinpath(*parts), page) if parts else ""


def beside(file: Path, page: Path) -> str:
    """A file's path from the folder of the page; '' where no relative path leads there."""
    try:
        return os.path.relpath(file.absolute(), page.absolute().parent)
    except ValueError:  # another drive
        return ""


def address(place: str) -> str:
    """A relative path as an address: no name in it is ever a scheme, a query or a fragment.

    >>> address("lot 1/100% #2?.json"), address("javascript:x.json")
    ('./lot%201/100%25%20%232%3F.json', './javascript%3Ax.json')
    """
    if not place:
        return ""
    forward = place.replace(os.sep, "/")
    return "./" + quote(os.fsencode(forward), safe="/~")


def command(place: str) -> str:
    """The command that opens a material in the window; '' without one.

    >>> command("lot 1/a'b.json")
    'relgloss view \\'lot 1/a\\'"\\'"\\'b.json\\''
    """
    return command_line(["relgloss", "view", operand(place)]) if place else ""


def small_picture(png: bytes, is_small_page: bool = True) -> bytes:
    """A thumbnail as WebP without loss: the same pixels; b'' for no PNG.

    is_small_page: in about 0.4 of the bytes in 2 to 3 ms; otherwise in 0.8 of them in 0.3 ms.
    """
    picture = opened_thumbnail(png)
    if picture is None:
        return b""
    method, effort = (2, 40) if is_small_page else (0, 0)
    out = io.BytesIO()
    picture.save(out, "WEBP", lossless=True, quality=effort, method=method)
    return out.getvalue()


def plain_number(value: float | None, decimals: int) -> str:
    """A number for the table without scripts."""
    return "\u2013" if value is None else f"{value:z.{decimals}f}"
