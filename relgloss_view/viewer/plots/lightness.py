"""L* along a row of pixels and its distribution over the object."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from relgloss_view.base.arrays import AnyArray, Array, Mask
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model import tone
from relgloss_view.picture.stages import parts_of

BINS = 100  #: of 1 L* each, from 0 to 100
#: Least Y of the brightest specular pixel that makes a highlight: L_s* of 0.01 on black.
FAINTEST_HIGHLIGHT_Y = 1e-5


@dataclass(frozen=True)
class Line:
    """L* along a row of pixels, each (W,)."""

    row: int  #: from the top
    l_d: Array  #: of the diffuse reflection
    l_s: Array  #: what the specular reflection adds, before scaling
    on_object: Mask

    def scaled(self, c: float) -> Array:
        """L_d + c L_s: what the picture shows, before it is cut at 100."""
        return self.l_d + c * self.l_s

    @property
    def plain(self) -> Array:
        """L_d + L_s: the lightness that colorimetry asks for (c = 1)."""
        return self.l_d + self.l_s


@dataclass(frozen=True)
class Histogram:
    """How the object's pixels are spread over L*."""

    share: Array  #: (BINS,), share of the object's pixels in [k, k + 1); the last bin takes 100 too
    clipped: float  #: share above 100
    pixels: int  #: that were counted


@dataclass(frozen=True)
class Lightness:
    """The two lightnesses of a frame, from which lines and histograms are cheap for every c."""

    y_diffuse: AnyArray  #: (H, W), relative to Y_n
    y_specular: AnyArray  #: (H, W)
    on_object: Mask  #: (H, W)
    object_l_d: NDArray[np.float32]  #: (N,), the object's pixels
    object_l_s: NDArray[np.float32]  #: (N,)
    highlight_row: int | None  #: of the brightest specular pixel; None where nothing is specular

    @classmethod
    def of(cls, frame: Frame) -> Lightness:
        """Fetch a frame's stages, of which only Y is kept."""
        kept = [
            (
                part.diffuse[part.own, :, 1].copy(),
                part.specular[part.own, :, 1].copy(),
                part.on_object[part.own].copy(),
            )
            for part in parts_of(frame)
        ]
        y_d, y_s, seen = (np.concatenate(rows) for rows in zip(*kept, strict=True))
        # Single precision is good to 1e-5 L*, and four times as fast.
        pair = y_d[seen].astype(np.float32), y_s[seen].astype(np.float32)
        l_d, l_s = (np.asarray(v, dtype=np.float32) for v in _split(*pair))
        brightest = int(np.argmax(y_s))
        row = brightest // y_s.shape[1] if y_s.flat[brightest] > FAINTEST_HIGHLIGHT_Y else None
        return cls(y_d, y_s, seen, l_d, l_s, row)

    @property
    def default_row(self) -> int:
        """The row of the highlight, or the middle one."""
        middle: int = self.y_diffuse.shape[0] // 2
        return middle if self.highlight_row is None else self.highlight_row

    def line(self, row: int) -> Line:
        """L* along a row, counted from the top; a row beyond the picture is its last."""
        row = min(max(row, 0), self.y_diffuse.shape[0] - 1)
        l_d, l_s = tone.split_lightness(
            self.y_diffuse[row].astype(np.float64), self.y_specular[row].astype(np.float64)
        )
        return Line(row, l_d, l_s, self.on_object[row])

    def histogram(self, c: float, most_pixels: int | None = None) -> Histogram:
        """Distribution of L_d + c L_s over the object, of every n-th pixel beyond `most_pixels`."""
        count = len(self.object_l_d)
        step = 1 if most_pixels is None else max(1, -(-count // most_pixels))
        total = self.object_l_d[::step] + np.float32(c) * self.object_l_s[::step]
        if not len(total):
            return Histogram(np.zeros(BINS), 0.0, 0)
        above = total > 100.0 + tone.CLIP_TOLERANCE
        place = np.clip(total[~above], 0.0, BINS - 1).astype(np.int64)
        share = np.bincount(place, minlength=BINS) / len(total)
        return Histogram(share, float(np.mean(above)), len(total))


def _split(y_diffuse: AnyArray, y_specular: AnyArray) -> tuple[AnyArray, AnyArray]:
    return tone.split_lightness(y_diffuse, y_specular)
