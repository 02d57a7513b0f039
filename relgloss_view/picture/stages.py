"""Stages: the arrays of a picture by name, of all of its rows or of some.

A Frame has those of a whole picture. A Part has those of some of its rows, so that a picture of
many pixels can be written without all of its stages in memory at once.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from relgloss_view.base.arrays import AnyArray, Array, Bytes, Floats, Mask
from relgloss_view.picture.model import tone

if TYPE_CHECKING:
    from relgloss_view.picture.frame import Frame
    from relgloss_view.picture.scene.scene import Scene

#: Pixels of a part: its stages and what is computed from them take some 60 MB.
PART_PIXELS = 1 << 17
BLOCK_ROWS = 16  #: parts begin at multiples of it: OpenEXR packs so many rows at a time
#: Rows above and below a part that smooth silhouettes take colours from.
NEIGHBOURING_ROWS = 1


class Stages:
    """The arrays (rows, W, ...) of a picture, each fetched on first use and then kept.

    Row 0 is the uppermost. XYZ is relative to Y_n: Y = 1 is the perfect diffuser.
    """

    scene: Scene

    def _stage(self, name: str) -> AnyArray:
        """A stage as the renderer has it; not kept."""
        raise NotImplementedError

    def forget(self) -> None:
        """Free the arrays that were fetched; they are fetched again when they are asked for."""
        for kept in KEPT.values():
            self.__dict__.pop(kept, None)

    @cached_property
    def _diffuse(self) -> Floats:
        return self._stage("diffuse")

    @property
    def _flags(self) -> Bytes:
        return 255 - self._display[..., 3]

    @property
    def diffuse(self) -> Floats:
        """(H, W, 3), XYZ of the diffuse reflection."""
        return self._diffuse[..., :3]

    @property
    def coverage(self) -> Floats:
        """(H, W), share of each pixel that the object covers."""
        return self._diffuse[..., 3]

    @cached_property
    def on_object(self) -> Mask:
        """(H, W), whether the object covers any of the pixel."""
        return np.asarray(self._stage("split")[..., 0] > 0.5 * tone.OFF_OBJECT)

    @cached_property
    def _specular(self) -> Floats:
        return self._stage("specular")

    @property
    def specular(self) -> Floats:
        """(H, W, 3), XYZ of the specular reflection."""
        return self._specular[..., :3]

    @property
    def gloss_factor(self) -> Floats:
        """(H, W), k, the factor of L_s* beside c: the mean of a pack's finishes, else 1."""
        if self.scene.pack is None:
            return self.on_object.astype(np.float64)
        return self._specular[..., 3]

    @cached_property
    def lab(self) -> Floats:
        """(H, W, 3), L~*, a*, b* after the split and scaling, before gamut mapping; 0 off it."""
        return self._stage("lab")[..., :3]

    @property
    def clipped(self) -> Mask:
        """(H, W), where L~* is above 100 and is cut."""
        return np.asarray(self._flags & 1, dtype=bool)

    @property
    def out_of_gamut(self) -> Mask:
        """(H, W), where chroma is reduced because the display can't show the colour."""
        return np.asarray(self._flags & 2, dtype=bool)

    @property
    def cut_by_screen(self) -> Mask:
        """(H, W), where this display can't show what the one of `seen_on` shows."""
        return np.asarray(self._flags & 4, dtype=bool)

    @cached_property
    def light(self) -> Floats:
        """(H, W, 3), linear display RGB over the surround, 0 to 1."""
        return self._stage("light")[..., :3]

    @cached_property
    def _display(self) -> Bytes:
        """Its alpha is 255, less 1 where clipped, 2 where out of gamut, 4 where the screen cuts."""
        return self._stage("display").astype(np.uint8)

    @property
    def display(self) -> Bytes:
        """(H, W, 3), digital values of the display, 8 bits."""
        return self._display[..., :3]

    @cached_property
    def normal(self) -> Floats:
        """(H, W, 3), unit normal at the pixel's centre, world axes; 0 off the object."""
        return self._stage("normal")[..., :3]

    @cached_property
    def tilted_normal(self) -> Floats:
        """(H, W, 3), the normal after the grain's tilt."""
        return self._stage("tilted_normal")[..., :3]

    @cached_property
    def point_m(self) -> Floats:
        """(H, W, 3), point on the object, world axes."""
        return self._stage("point_m")[..., :3]

    @property
    def unscaled_split(self) -> tuple[Floats, Floats]:
        """(H, W) each: L_d*, and L_s* before scaling by c and by a pack's k; 0 off the object."""
        return tone.split_lightness(
            self.diffuse[..., 1].astype(np.float64), self.specular[..., 1].astype(np.float64)
        )

    @cached_property
    def split(self) -> tuple[Floats, Floats]:
        """(H, W) each: L_d*, and L_s* before scaling by c, of a pack times k; 0 off the object."""
        l_d, l_s = self.unscaled_split
        return (l_d, l_s) if self.scene.pack is None else (l_d, l_s * self.gloss_factor)


#: Of Stages: what a frame may have fetched whole, and where it keeps it.
KEPT = {
    "diffuse": "_diffuse",
    "specular": "_specular",
    "split": "on_object",
    "lab": "lab",
    "light": "light",
    "display": "_display",
    "normal": "normal",
    "tilted_normal": "tilted_normal",
    "point_m": "point_m",
}


class Part(Stages):
    """Some rows of a frame, with the neighbouring rows that smooth silhouettes take colours from.

    rows: of the picture, those of the arrays. own: of the arrays, the part without its neighbours.
    What the frame has fetched already is not fetched again.
    """

    def __init__(self, frame: Frame, first: int, last: int) -> None:
        """first, last: the part's own rows of the picture, the last one excluded."""
        height = frame.size[1]
        top, bottom = max(first - NEIGHBOURING_ROWS, 0), min(last + NEIGHBOURING_ROWS, height)
        self.rows = slice(top, bottom)
        self.own = slice(first - top, last - top)
        self.first = first
        self.scene = frame.scene
        self._frame = frame

    @cached_property
    def edges(self) -> Array | None:
        """As Frame.edges, those of the part's rows, counted from its first row."""
        edges = self._frame.edges
        if edges is None:
            return None
        inside = edges[(edges[:, 1] >= self.rows.start) & (edges[:, 1] < self.rows.stop)]
        return inside - (0.0, float(self.rows.start), 0.0)

    @cached_property
    def on_object(self) -> Mask:
        """See Stages."""
        kept = self._frame.__dict__.get("on_object")
        return super().on_object if kept is None else kept[self.rows]

    def _stage(self, name: str) -> AnyArray:
        kept = self._frame.__dict__.get(KEPT[name]) if name != "split" else None
        return self._frame.fetch(name, self.rows) if kept is None else kept[self.rows]


def parts_of(frame: Frame, pixels: int | None = None) -> Iterator[Part]:
    """The parts of a picture from the top, each for a use before the next.

    pixels: of a part, at most about; PART_PIXELS where none are given.

    A part has a multiple of BLOCK_ROWS rows of its own, but for the last one.
    """
    width, height = frame.size
    step = max(BLOCK_ROWS, (pixels or PART_PIXELS) // width // BLOCK_ROWS * BLOCK_ROWS)
    for first in range(0, height, step):
        yield Part(frame, first, min(first + step, height))
