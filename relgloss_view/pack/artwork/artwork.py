"""Artwork: the colours of a print as they are approved, and its plates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from relgloss_view.base.arrays import Bytes

Halves = npt.NDArray[np.float16]
#: The note of a file of which parts may be missing.
REPAIRED = "The PDF is damaged and was repaired: parts may be missing, so check it."


@dataclass(frozen=True, eq=False)
class Artwork:
    """A picture of what is printed; two artworks are equal where they are the same object.

    xyz: (H, W, 3), float16, row 0 the top: XYZ of the colour under D50, Y = 1 the perfect diffuser,
    linear in light, times `alpha`. alpha: (H, W), float16, 0 where nothing is printed and the stock
    shows; None where all of it is printed.
    width_mm, height_mm: printed size. plates: spot plates and further channels by name, (H, W)
    uint8, 255 where all of the plate prints; the process plates are not among them.
    coloured: the plates that are inks, whose colour `xyz` holds already. finish_plates: the plates
    that would be inks by their names and print no colour, as the options name them.
    file: it was read from. profile_file: of the options that it was read with, or ''.
    stamp: of the file when it was read, to notice that it was edited.
    notes: of reading, one sentence each: profile, resampling, what was left out.

    >>> Artwork(np.ones((20, 40, 3), np.float16), width_mm=80.0, height_mm=40.0).size_px
    (40, 20)
    """

    xyz: Halves
    width_mm: float
    height_mm: float
    alpha: Halves | None = None
    plates: Mapping[str, Bytes] = field(default_factory=dict)
    file: str = ""
    profile_file: str = ""
    coloured: frozenset[str] = frozenset()
    finish_plates: frozenset[str] = frozenset()
    stamp: tuple[int, int] = (0, 0)  #: time of its last change, ns, and bytes
    notes: tuple[str, ...] = ()

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height, pixels."""
        height, width = self.xyz.shape[:2]
        return width, height
