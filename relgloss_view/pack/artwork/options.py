"""ArtworkOptions: what a file of artwork does not hold itself."""

from __future__ import annotations

from dataclasses import dataclass

from relgloss_view.base.parameters import Checked, choice, parameter, whole_number

#: auto: absolute for profiles of a print, whose white is its paper; relative for all others.
INTENTS = ("auto", "absolute", "relative")


@dataclass(frozen=True)
class ArtworkOptions(Checked):
    """How artwork is read, beyond what its file holds.

    profile: file of an ICC profile for colours that come without one. page: of a PDF, from 1.
    dpi: of a PDF's raster (300 where None); of a picture, in place of its own. width_mm: printed
    width of a picture, in place of its resolution. most_px: pixels of the longer side; larger
    artwork is scaled down by area averages in linear light, with a note. intent: one of INTENTS.
    finish_plates: names of spot colours of a PDF that print no colour although their names do not
    show it; case and blanks do not matter, and names of colour systems (PANTONE, HKS) stay inks.

    >>> ArtworkOptions(width_mm=207.3).most_px
    4096

    Raises InputError where a value is out of its range.
    """

    profile: str = ""
    page: int = whole_number(1, 1, 100_000, "", "page of a PDF")
    dpi: float | None = parameter(None, 1.0, 10_000.0, "dpi", "resolution of the artwork")
    width_mm: float | None = parameter(None, 0.1, 1e5, "mm", "printed width of a picture")
    most_px: int = whole_number(4096, 1, 16_384, "px", "longest side that is kept")
    intent: str = choice("auto", INTENTS, "how the profile's white is taken")
    finish_plates: tuple[str, ...] = ()
