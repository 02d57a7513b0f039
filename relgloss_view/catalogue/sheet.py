"""A contact sheet of hits: their thumbnails, each with its name, gloss and ratio."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.reading import printable
from relgloss_view.catalogue.columns import COLUMNS as TABLE_COLUMNS
from relgloss_view.catalogue.query.found import Found, Hit
from relgloss_view.catalogue.query.terms import GlossRatio
from relgloss_view.catalogue.query.vocabulary import label_of
from relgloss_view.catalogue.thumbnail import opened_thumbnail
from relgloss_view.material.material import Quality
from relgloss_view.picture.output.contact_sheet import (
    INK_GRAY,
    PAPER_GRAY,
    STRIP_PX,
    contact_sheet,
    gap_px,
    plate,
    text_px,
)
from relgloss_view.picture.output.lettering import Lettering

MOST = 400  #: pictures on a sheet
LEAST_COLUMNS, COLUMNS = 4, 8  #: a title has room above four places
NAME_LINES = 2
WIDE = 1.5  #: width of a hit's place over its picture's, so that names have room
DOTS = "..."
GLOSS_COLUMNS = tuple(column.name for column in TABLE_COLUMNS if column.unit == "GU")


def hits_sheet(found: Found, thumbnails: Mapping[str, bytes], size_px: int) -> Bytes:
    """The first MOST hits on one sheet (H, W, 3), 8 bits, for sRGB.

    thumbnails: PNG by path; a hit without one keeps an empty place. size_px: of a thumbnail.
    """
    hits = found.hits[:MOST]
    across = min(COLUMNS, max(LEAST_COLUMNS, math.ceil(math.sqrt(1.5 * len(hits)))))
    gloss = _gloss_column(found)
    width = round(WIDE * size_px)
    letters = Lettering(text_px(width))
    texts = [[*_name_lines(hit, letters, width), _numbers(hit, gloss)] for hit in hits]
    lines = max((len(each) for each in texts), default=1) - 1
    pictures = [
        _place(thumbnails.get(hit.path), size_px, each[:lines], lines)
        for hit, each in zip(hits, texts, strict=True)
    ]
    captions = ["".join(each[lines:]) for each in texts]
    if not hits:
        pictures, captions = [_place(None, size_px, [], 0, "no hits")], [""]
    while len(pictures) < LEAST_COLUMNS:
        pictures.append(np.full_like(pictures[0], PAPER_GRAY))
        captions.append("")
    room = across * (width + gap_px(width))
    title = f"{len(hits)} of {found.total} hits: {printable(found.query.text, 200) or 'all'}"
    return contact_sheet(
        _rows(pictures, across),
        _rows([_fitted(text, letters, width) for text in captions], across),
        _fitted(title, Lettering(round(1.4 * letters.size)), room),
        _fitted(_note(hits, found, gloss), letters, room),
        strip_px=0 if lines else STRIP_PX,
    )


def _rows(values: Sequence[Any], across: int) -> list[list[Any]]:
    return [list(values[k : k + across]) for k in range(0, len(values), across)]


def _name_lines(hit: Hit, letters: Lettering, width: int) -> list[str]:
    return _lines(f"{hit.rank}. {printable(hit.name, 160)}", letters, width)


def _place(
    png: bytes | None, size_px: int, texts: Sequence[str], lines: int, missing: str = "no picture"
) -> Bytes:
    """A picture in the middle of its place, with room for some lines of text below."""
    from PIL import Image, ImageDraw

    width = round(WIDE * size_px)
    letters = Lettering(text_px(width))
    line = round(1.5 * letters.size)
    place = Image.new("RGB", (width, size_px + lines * line), (PAPER_GRAY,) * 3)
    picture = opened_thumbnail(png)
    if picture is not None:
        place.paste(picture, ((width - picture.width) // 2, 0))
    pen = ImageDraw.Draw(place)
    ink = (INK_GRAY,) * 3
    if picture is None:
        half = 0.5 * letters.length(missing) + letters.size
        middle = size_px / 2
        plate(
            pen, (width / 2 - half, middle - letters.size, width / 2 + half, middle + letters.size)
        )
        letters.draw(pen, (width / 2, middle), missing, ink, "mm")
    if lines:
        plate(pen, (0, size_px + STRIP_PX, width, place.height))
    for k, text in enumerate(texts):
        letters.draw(pen, (width / 2, size_px + (0.6 + k) * line), text, ink, "mm")
    return np.asarray(place)


def _gloss_column(found: Found) -> str:
    """The reading that the query asks for first, else gloss at 60 degrees."""
    return next((name for name in found.columns if name in GLOSS_COLUMNS), "gloss_60")


def _numbers(hit: Hit, column: str) -> str:
    """Gloss, ratio and difference of a hit, as far as it has them, and what is wrong with it."""
    parts = []
    gloss = hit.row.get(column)
    if gloss is not None:
        parts.append(f"{gloss:.1f} GU")
    ratio = hit.numbers.get("ratio", hit.row.get("gloss_ratio"))
    if ratio is not None:
        parts.append(f"{ratio:.2f} x")
    for key in ("picture_difference", "colour_difference"):
        if key in hit.numbers:
            parts.append(f"dE {hit.numbers[key]:.1f}")
            break
    if hit.row.get("is_ratio_kept") is False:
        parts.append("cut")
    quality = str(hit.row.get("quality") or Quality.GOOD)
    if quality != Quality.GOOD:
        parts.append(quality)
    return ", ".join(parts) if parts else str(hit.row.get("status") or "")


def _note(hits: Sequence[Hit], found: Found, gloss: str) -> str:
    """What the captions mean."""
    ratios = [leaf for leaf in found.query.leaves if isinstance(leaf, GlossRatio)]
    own = found.references.get(ratios[0].reference.text) if ratios else None
    reference = own or "the catalogue's reference"
    if not any(hit.row.get(gloss) is not None for hit in hits):
        return f"Order: {printable(found.order, 200)}."
    words = f"GU: {label_of(gloss)}. x: gloss over that of {printable(reference, 80)}."
    if any(hit.row.get("is_ratio_kept") is False for hit in hits):
        words += " cut: shown at c_max, below the ratio."
    if any(hit.row.get("quality") == Quality.POOR for hit in hits):
        words += " poor: may be wrong."
    return f"{words} Order: {printable(found.order, 200)}."


def _lines(text: str, letters: Lettering, width: float) -> list[str]:
    """A text in at most NAME_LINES lines of a width; the last one may lack its beginning, for the
    names of one product differ at their end.
    """
    lines: list[str] = []
    rest = text
    while len(lines) < NAME_LINES - 1 and letters.length(rest) > width:
        end = _fitting(rest, letters, width)
        space = rest.rfind(" ", 0, end + 1)
        if space > end // 2:  # else a word is broken: half a line would be empty
            end = space
        lines.append(rest[:end].rstrip())
        rest = rest[end:].lstrip()
    if letters.length(rest) > width:
        end = _fitting(rest[::-1], letters, width - letters.length(DOTS))
        rest = DOTS + rest[len(rest) - end :].lstrip()
    return [*lines, rest]


def _fitting(text: str, letters: Lettering, width: float) -> int:
    """How many first characters of a text are at most as wide as its place, pixels."""
    low, high = 0, len(text)
    while low < high:
        middle = (low + high + 1) // 2
        if letters.length(text[:middle]) <= width:
            low = middle
        else:
            high = middle - 1
    return low


def _fitted(text: str, letters: Lettering, width: float) -> str:
    """A text that is cut at its end where it is wider than its place, pixels."""
    if letters.length(text) <= width:
        return text
    return text[: _fitting(text, letters, width - letters.length(DOTS))].rstrip() + DOTS
