"""Plates that finishes of a pack name: they print no colour in its artwork.

A spot colour whose name nobody knows ("VP7", "Sonderfarbe 2") is read as an ink. Where a varnish, a
foil or a stock lies where that plate prints, the plate is no ink, and the artwork is read without
its colour.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.artwork.plate_names import finishing_plates
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.masks import CHANNEL, PLATE
from relgloss_view.pack.pack import Pack


def named_plates(finishes: Iterable[Finish]) -> tuple[str, ...]:
    """Names of the plates where varnishes, foils and stocks lie, as their masks give them."""
    masks = [one.mask for one in finishes if one.kind != "ink"]
    return tuple(
        dict.fromkeys(m.partition(":")[2] for m in masks if m.startswith((PLATE, CHANNEL)))
    )


def has_right_plates(artwork: Artwork | None, names: Iterable[str]) -> bool:
    """Whether an artwork was read with these plates, and no others, as finishes."""
    if artwork is None:
        return True
    return _meant(artwork, names) == artwork.finish_plates


def plates_of_finishes(artwork: Artwork, finishes: Iterable[Finish]) -> frozenset[str]:
    """The plates that would be inks by their names and must print no colour under these finishes.

    Only those of PDFs: further channels of pictures are in no colour.
    """
    return _meant(artwork, named_plates(finishes))


def _meant(artwork: Artwork, names: Iterable[str]) -> frozenset[str]:
    meant = frozenset(finishing_plates(artwork.plates, names))
    return meant & (artwork.coloured | artwork.finish_plates)


def with_right_plates(pack: Pack, progress: ProgressReport = no_progress) -> Pack:
    """The pack with its artwork read again where its finishes name other plates than before.

    The same pack where there is nothing to do, as with every artwork but a PDF. Raises InputError
    where the artwork can't be read any more.
    """
    from relgloss_view.pack.pack_file import open_artwork

    artwork, names = pack.artwork, named_plates(pack.finishes)
    if artwork is None or not artwork.file or has_right_plates(artwork, names):
        return pack
    read = open_artwork(Path(artwork.file), how_read(pack), Path(), progress)
    return dataclasses.replace(pack, artwork=read)


def how_read(pack: Pack) -> dict[str, Any]:
    """How a pack's artwork is to be read again, wherever its entries were written."""
    given = {**dict(pack.artwork_entries), "finish_plates": named_plates(pack.finishes)}
    if pack.artwork is not None and pack.artwork.profile_file:
        given["profile"] = pack.artwork.profile_file
    return given
