"""The nearest pictures: thumbnails first, the best of them drawn anew and compared exactly.

Two pictures are compared pixel by pixel with CIEDE2000 (Sharma et al. 2005), as the screen shows
them: in the paper's geometry, at the c that keeps their gloss ratio, cut at c_max. Their difference
is the larger of two 95th percentiles: over the object, and over the highlight, which may be narrow
and is what gloss shows. A picture's highlight is where L_s* is at least half its largest; of both
pictures' highlights the one that differs more counts, or a broad one would hide a narrow one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array, Bytes, Ints, Mask
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.catalogue.query.found import Measure, Searched
from relgloss_view.catalogue.query.pictures import Colours, Drawer
from relgloss_view.catalogue.query.references import Resolved
from relgloss_view.catalogue.thumbnail import opened_thumbnail
from relgloss_view.material import brdf
from relgloss_view.material.cielab import srgb_to_lab
from relgloss_view.material.difference import delta_e_2000
from relgloss_view.picture.model import shape
from relgloss_view.picture.model.view import view_of
from relgloss_view.picture.scene.setup import Setup
from relgloss_view.quality.backends import FrameRenderer

PAPER = Setup()
EXACT_MOST = 50  #: pictures that are drawn anew
EXACT_PX = 256
LEAST_LSTAR = 1.0  #: L_s* of a pixel of any highlight
HIGHLIGHT_SHARE = 0.5  #: of the largest L_s*, from which a pixel belongs to the highlight
PERCENTILE = 95.0
#: Half-vector angles, degrees, of the nested regions in which thumbnails are compared: they stand
#: for highlights of any width, which a thumbnail does not hold by themselves.
REGIONS_DEG = (2.0, 6.0, 18.0, 180.0)
ROWS = 5  #: of a thumbnail that are compared; a cylinder's picture hardly changes along its axis
AT_ONCE = 250  #: thumbnails compared at once
READ_AT_ONCE = 2000  #: thumbnails in memory
MEASURES = (
    Measure("picture_difference", "picture dE2000", 2),
    Measure("picture_mean", "object mean", 2),
    Measure("picture_p95", "object p95", 2),
    Measure("highlight_mean", "highlight mean", 2),
    Measure("highlight_p95", "highlight p95", 2),
)


@dataclass(frozen=True)
class PictureDifference:
    """CIEDE2000 between two pictures; the highlight's is None where neither shows one."""

    mean: float
    p95: float
    highlight_mean: float | None = None
    highlight_p95: float | None = None

    @property
    def difference(self) -> float:
        """The larger of both 95th percentiles, by which pictures are ranked."""
        return max(self.p95, self.highlight_p95 or 0.0)

    @classmethod
    def of(cls, first: Colours, second: Colours) -> PictureDifference:
        """Between two pictures of one size and geometry."""
        differences = delta_e_2000(first.lab, second.lab)
        on_object = differences[first.on_object & second.on_object]
        means, tops = [], []
        for one in (first, second):
            inside = differences[highlight_of(one)]
            if len(inside):
                means.append(float(np.mean(inside)))
                tops.append(float(np.percentile(inside, PERCENTILE)))
        return cls(
            float(np.mean(on_object)),
            float(np.percentile(on_object, PERCENTILE)),
            max(means, default=None),
            max(tops, default=None),
        )


def highlight_of(picture: Colours) -> Mask:
    """The pixels of a picture's highlight (H, W); none where it shows no gloss."""
    largest = float(np.max(picture.l_s[picture.on_object], initial=0.0))
    return picture.on_object & (picture.l_s >= max(HIGHLIGHT_SHARE * largest, LEAST_LSTAR))


@dataclass(frozen=True)
class Differences:
    """Differences from one picture: all (N,) by thumbnails, NaN without one; exact by row."""

    all: Array
    exact: Mapping[int, PictureDifference] = field(default_factory=dict)

    def of_row(self, k: int) -> dict[str, float]:
        """The numbers of a hit."""
        exact = self.exact.get(k)
        if exact is None:
            return {} if math.isnan(self.all[k]) else {MEASURES[0].key: float(self.all[k])}
        values = (
            exact.difference, exact.mean, exact.p95, exact.highlight_mean, exact.highlight_p95
        )  # fmt: skip
        pairs = zip(MEASURES, values, strict=True)
        return {measure.key: value for measure, value in pairs if value is not None}


@dataclass(frozen=True)
class PictureIndex:
    """The compared pixels of all thumbnails: colours (M, P, 3) of the items at `rows` (M,)."""

    count: int  #: items of the catalogue
    rows: Ints
    pixels: Bytes
    size_px: int

    @classmethod
    def of(cls, catalogue: Searched, progress: ProgressReport = no_progress) -> PictureIndex:
        """The thumbnails of a catalogue that have the size of its recipe."""
        size = catalogue.recipe.thumbnail_px
        place, _ = _compared_pixels(size)
        paths = [str(row["path"]) for row in catalogue.rows]
        rows, pixels = [], []
        for start in range(0, len(paths), READ_AT_ONCE):
            progress(start / len(paths), "reading thumbnails")
            some = catalogue.thumbnails(paths[start : start + READ_AT_ONCE])
            for k, path in enumerate(paths[start : start + READ_AT_ONCE], start):
                picture = _decoded(some.get(path), size)
                if picture is not None:
                    rows.append(k)
                    pixels.append(picture.reshape(-1, 3)[place])
        shaped = np.array(pixels, dtype=np.uint8).reshape(len(rows), len(place), 3)
        return cls(len(paths), np.array(rows, dtype=np.int64), shaped, size)

    def differences(
        self, reference: Resolved, catalogue: Searched, renderer: FrameRenderer | None
    ) -> Differences:
        """Differences of all thumbnails from the reference's picture."""
        place, delta_deg = _compared_pixels(self.size_px)
        target = self._picture_of(reference, catalogue, renderer, place)
        differences = np.full(self.count, np.nan)
        regions = [np.flatnonzero(delta_deg <= most) for most in REGIONS_DEG]
        for start in range(0, len(self.rows), AT_ONCE):
            lab = _lab(self.pixels[start : start + AT_ONCE])
            between = delta_e_2000(lab, np.broadcast_to(target, lab.shape))
            worst = np.zeros(len(lab))
            for region in regions:
                if len(region):
                    at = np.percentile(between[:, region], PERCENTILE, axis=1)
                    worst = np.maximum(worst, at)
            differences[self.rows[start : start + AT_ONCE]] = worst
        return Differences(differences)

    def _picture_of(
        self, reference: Resolved, catalogue: Searched, renderer: FrameRenderer | None, place: Ints
    ) -> Array:
        if reference.row is not None:
            at = np.flatnonzero(self.rows == reference.row)
            if len(at):
                return np.asarray(_lab(self.pixels[at[0]]))
        size = (self.size_px, self.size_px)
        drawer = Drawer(catalogue.recipe, renderer)
        frame = drawer.draw(reference.material, size, reference.sigma_n_deg)
        return np.asarray(_lab(frame.display.reshape(-1, 3)[place]))


def redrawn(
    reference: Resolved,
    paths: Sequence[str],
    catalogue: Searched,
    renderer: FrameRenderer,
    progress: ProgressReport = no_progress,
    px: int = EXACT_PX,
) -> dict[str, PictureDifference]:
    """Exact differences of items from a reference, both drawn at px x px."""
    drawer = Drawer(catalogue.recipe, renderer)
    first = drawer.colours(reference.material, (px, px), reference.sigma_n_deg)
    grain = {str(row["path"]): float(row.get("sigma_n_deg") or 0.0) for row in catalogue.rows}
    made = {}
    for count, path in enumerate(paths):
        progress(count / len(paths), f"drawing {path}")
        second = drawer.colours(catalogue.material(path), (px, px), grain.get(path, 0.0))
        made[path] = PictureDifference.of(first, second)
    return made


@lru_cache(maxsize=4)
def _compared_pixels(px: int) -> tuple[Ints, Array]:
    """Pixels of a thumbnail that are compared, as places in its rows, and their half-vector angle.

    All columns of the object in ROWS rows between its ends; angle to the normal in degrees.
    """
    view = view_of(PAPER.shape, PAPER.eye, (px, px))
    left, bottom, right, top = view.bounds
    inner = np.linspace(0.0, 1.0, ROWS + 2)[1:-1]
    y = np.unique(np.floor(bottom + (top - bottom) * inner).astype(int))
    columns, rows = np.meshgrid(np.arange(max(left, 0), min(right, px)), px - 1 - y)
    ray = view.rays_at(columns.astype(np.float64), rows.astype(np.float64))
    hit = shape.meet(PAPER.shape.kind, view.eye_m, ray, PAPER.shape.half_extent_m())
    to_lamp = PAPER.lamp.position_m - hit.point_m
    i = to_lamp / np.linalg.norm(to_lamp, axis=-1, keepdims=True)
    o = -ray / np.linalg.norm(ray, axis=-1, keepdims=True)
    f = brdf.facing(hit.normal, i, o)
    delta = np.degrees(np.sqrt(np.maximum(f.delta2, 0.0)))
    found = hit.found
    place = rows[found] * px + columns[found]
    return place.astype(np.int64), np.asarray(delta[found])


def _lab(pixels: Bytes) -> Array:
    """L*, a*, b* under D65 (..., 3) of sRGB bytes."""
    return np.asarray(srgb_to_lab(pixels / 255.0, "D65"))


def _decoded(png: bytes | None, px: int) -> Bytes | None:
    """A thumbnail's pixels (px, px, 3); None without one of this size."""
    image = opened_thumbnail(png)
    return None if image is None or image.size != (px, px) else np.asarray(image)
