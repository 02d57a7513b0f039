"""A contact sheet of hits: their thumbnails, each with its name, gloss and ratio."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.reading import printable
from relgloss_view.catalogue.query.found import Found, Hit
from relgloss_view.catalogue.query.terms import GlossRatio
from relgloss_view.catalogue.query.vocabulary import label_of
from relgloss_view.catalogue.thumbnail import opened_thumbnail
from relgloss_view.picture.output.contact_sheet import (
    INK_GRAY,
    PAPER_GRAY,
    contact_sheet,
    gap_px,
    text_px,
)
from relgloss_view.picture.output.lettering import Lettering

MOST = 400  #: pictures on a sheet
LEAST_COLUMNS, COLUMNS = 4, 8  #: a title has room above four places
WIDE = 1.5  #: width of a hit's place over its picture's, so that names have room
DOTS = "..."


def hits_sheet(found: Found, thumbnails: Mapping[str, bytes], size_px: int) -> Bytes:
    """The first MOST hits on one sheet (H, W, 3), 8 bits, for sRGB.

    thumbnails: PNG by path; a hit without one keeps an empty place. size_px: of a thumbnail.
    """
    hits = found.hits[:MOST]
    across = min(COLUMNS, max(LEAST_COLUMNS, math.ceil(math.sqrt(1.5 * len(hits)))))
    pictures = [_place(hit, thumbnails.get(hit.path), size_px) for hit in hits]
    captions = [_numbers(hit) for hit in hits]
    if not hits:
        pictures, captions = [_place(None, None, size_px)], [""]
    while len(pictures) < LEAST_COLUMNS:
        pictures.append(np.full_like(pictures[0], PAPER_GRAY))
        captions.append("")
    width = pictures[0].shape[1]
    letters = Lettering(text_px(width))
    room = across * (width + gap_px(width))
    title = f"{len(hits)} of {found.total} hits: {printable(found.query.text, 200) or 'all'}"
    return contact_sheet(
        _rows(pictures, across),
        _rows([_fitted(text, letters, width) for text in captions], across),
        _fitted(title, Lettering(round(1.4 * letters.size)), room),
        _fitted(_note(hits, found), letters, room),
    )


def _rows(values: Sequence[Any], across: int) -> list[list[Any]]:
    return [list(values[k : k + across]) for k in range(0, len(values), across)]


def _place(hit: Hit | None, png: bytes | None, size_px: int) -> Bytes:
    """A hit's picture in the middle of its place, its name below; words where there is none."""
    from PIL import Image, ImageDraw

    width = round(WIDE * size_px)
    letters = Lettering(text_px(width))
    line = round(1.5 * letters.size)
    place = Image.new("RGB", (width, size_px + line), (PAPER_GRAY,) * 3)
    picture = opened_thumbnail(png)
    if picture is not None:
        place.paste(picture, ((width - picture.width) // 2, 0))
    pen = ImageDraw.Draw(place)
    ink = (INK_GRAY,) * 3
    if picture is None:
        words = "no hits" if hit is None else "no picture"
        letters.draw(pen, (width / 2, size_px / 2), words, ink, "mm")
    if hit is not None:
        name = _fitted(f"{hit.rank}. {printable(hit.name, 80)}", letters, width)
        letters.draw(pen, (width / 2, size_px + 0.6 * line), name, ink, "mm")
    return np.asarray(place)


def _numbers(hit: Hit) -> str:
    """Gloss at 60 degrees, ratio and difference of a hit, as far as it has them."""
    parts = []
    gloss = hit.row.get("gloss_60")
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
    return ", ".join(parts) if parts else str(hit.row.get("status") or "")


def _note(hits: Sequence[Hit], found: Found) -> str:
    """What the captions mean."""
    ratios = [leaf for leaf in found.query.leaves if isinstance(leaf, GlossRatio)]
    own = found.references.get(ratios[0].reference.text) if ratios else None
    reference = own or "the catalogue's reference"
    words = f"GU: {label_of('gloss_60')}. x: gloss over that of {printable(reference, 80)}."
    if any(hit.row.get("is_ratio_kept") is False for hit in hits):
        words += " cut: shown at c_max, with less gloss than the ratio asks for."
    return f"{words} Order: {printable(found.order, 200)}."


def _fitted(text: str, letters: Lettering, width: float) -> str:
    """A text that is cut where it is wider than its place, pixels."""
    if letters.length(text) <= width:
        return text
    low, high = 0, len(text)
    while low < high:
        middle = (low + high + 1) // 2
        if letters.length(text[:middle] + DOTS) <= width:
            low = middle
        else:
            high = middle - 1
    return text[:low].rstrip() + DOTS
