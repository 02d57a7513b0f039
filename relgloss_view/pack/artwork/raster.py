"""Raster: a picture as its file holds it, and its way to Artwork's XYZ in linear light."""

from __future__ import annotations

import math
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np

from relgloss_view.base.arrays import AnyArray, Array, Bytes, Digital, Floats
from relgloss_view.base.icc.profile import Profile, cell_polynomials
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.artwork.options import ArtworkOptions

AT_ONCE = 1 << 14  #: pixels of one step of the conversion
USUAL_DPI = 300.0  #: of a picture that names no resolution
MM_PER_INCH = 25.4
_THREADS = 2


@dataclass(frozen=True, eq=False)
class Raster:
    """A picture before its colours are converted.

    samples: (H, W, channels of `profile`), 8 or 16 bits, of which the largest value is 1; ink of
    CMYK counts upwards. alpha: (H, W) of 8 or 16 bits. premultiplied: whether the samples, as
    values of the device, are times alpha. plates: (H, W) uint8 by name. width_mm, height_mm: 0
    where the file names no resolution. inks: plates whose colour is not in the samples, each with
    (256, 3) factors of XYZ by its digital value. coloured: plates that are inks. finish_plates:
    plates that are none as the options name them.
    """

    samples: Digital
    profile: Profile
    alpha: Digital | None = None
    premultiplied: bool = False
    plates: Mapping[str, Bytes] = field(default_factory=dict)
    width_mm: float = 0.0
    height_mm: float = 0.0
    inks: Mapping[str, Floats] = field(default_factory=dict)
    coloured: frozenset[str] = frozenset()
    finish_plates: frozenset[str] = frozenset()
    notes: tuple[str, ...] = ()

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height, pixels."""
        height, width = self.samples.shape[:2]
        return width, height


class Conversion:
    """Samples of a profile's device to XYZ under D50, float32, exact but for float32's rounding."""

    def __init__(self, profile: Profile, intent: str, dtype: AnyArray) -> None:
        self._profile = profile
        top = float(np.iinfo(dtype.dtype).max)
        values = np.arange(top + 1.0) / top
        self._scale = profile.scale(intent).astype(np.float32)
        curves = [np.asarray(curve(values), np.float64) for curve in profile.curves]
        grid = profile.grid
        if grid is None:
            self._curves = [c.astype(np.float32) for c in curves]
            return
        self._table = cell_polynomials(grid, np.dtype(np.float32))
        self._cells, self._parts = [], []
        stride = len(self._table)
        for curve, count in zip(curves, grid.nodes.shape, strict=False):
            place = np.clip(curve, 0.0, 1.0) * (count - 1)
            cell = np.minimum(place.astype(np.int64), count - 2)
            stride //= count - 1
            self._cells.append(cell * stride)
            self._parts.append((place - cell).astype(np.float32))

    def __call__(self, samples: Digital) -> Floats:
        """XYZ (N, 3) of samples (N, channels). A run of equal colours is converted once."""
        if len(samples) == 0:
            return np.zeros((0, 3), np.float32)
        begins = np.concatenate([[True], (samples[1:] != samples[:-1]).any(axis=1)])
        starts = np.flatnonzero(begins)
        if 2 * len(starts) > len(samples):
            return self._each(samples)
        lengths = np.diff(np.append(starts, len(samples)))
        return np.repeat(self._each(samples[starts]), lengths, axis=0)

    def _each(self, samples: Digital) -> Floats:
        if self._profile.grid is None:
            light = np.stack([c[samples[:, k]] for k, c in enumerate(self._curves)], axis=1)
            return (self._profile.after(light) * self._scale).astype(np.float32)
        cell = self._cells[0][samples[:, 0]]
        monomials = np.ones((len(samples), 1), np.float32)
        for k, (cells, parts) in enumerate(zip(self._cells, self._parts, strict=True)):
            cell = cell + cells[samples[:, k]] if k else cell
            part = parts[samples[:, k]][:, None]
            monomials = np.concatenate([monomials, monomials * part], axis=1)
        mixed = np.matmul(monomials[:, None, :], np.take(self._table, cell, axis=0))[:, 0, :]
        return (self._profile.after(mixed) * self._scale).astype(np.float32)


def to_artwork(
    raster: Raster,
    options: ArtworkOptions,
    file: str,
    stamp: tuple[int, int],
    progress: ProgressReport = no_progress,
) -> Artwork:
    """The artwork of a raster: converted to XYZ, and no larger than options.most_px."""
    width, height = raster.size_px
    share = min(options.most_px / max(width, height), 1.0)
    columns, rows = max(round(width * share), 1), max(round(height * share), 1)
    notes = list(raster.notes)
    if share < 1.0:
        notes.append(
            f"The artwork of {width} x {height} pixels is scaled down to {columns} x {rows} by "
            "area averages in linear light."
        )
    conversion = Conversion(raster.profile, options.intent, raster.samples[:0, :0].ravel())
    xyz = np.empty((rows, columns, 3), np.float16)
    alpha = None if raster.alpha is None else np.empty((rows, columns), np.float16)
    plates = dict(raster.plates)
    if share < 1.0:
        plates = {name: np.empty((rows, columns), np.uint8) for name in raster.plates}
    step = max(AT_ONCE // max(columns, int(width * share), 1), 1)

    def band(first: int) -> None:
        last = min(first + step, rows)
        top, bottom = math.floor(first * height / rows), math.ceil(last * height / rows)
        edges = np.linspace(first, last, last - first + 1) * (height / rows) - top

        def reduced(values: Floats) -> Floats:
            return area_means(values, edges, columns) if share < 1.0 else values

        colours = _colours(raster, conversion, slice(top, bottom))
        xyz[first:last] = np.minimum(reduced(colours[..., :3]), 6e4)
        if alpha is not None:
            alpha[first:last] = reduced(colours[..., 3])
        for name, plate in raster.plates.items() if share < 1.0 else ():
            part = plate[top:bottom].astype(np.float32)
            plates[name][first:last] = np.rint(reduced(part))

    with ThreadPoolExecutor(_THREADS) as threads:
        firsts = range(0, rows, step)
        group = 8 * _THREADS
        for k in range(0, len(firsts), group):
            checkpoint()
            progress(k / len(firsts), "converting colours")
            list(threads.map(band, firsts[k : k + group]))
    width_mm, height_mm = _printed_size(raster, options, notes)
    return Artwork(
        xyz,
        width_mm,
        height_mm,
        alpha,
        plates,
        file=file,
        profile_file=options.profile,
        coloured=raster.coloured,
        finish_plates=raster.finish_plates,
        stamp=stamp,
        notes=tuple(notes),
    )


def _colours(raster: Raster, conversion: Conversion, rows: slice) -> Floats:
    """XYZ, and alpha where there is one, of some rows: (rows, W, 3 or 4), times alpha."""
    samples = raster.samples[rows]
    height, width, channels = samples.shape
    if raster.alpha is None:
        xyz = conversion(samples.reshape(-1, channels)).reshape(height, width, 3)
        for name, factors in raster.inks.items():
            plate = raster.plates[name][rows]
            if plate.any():
                xyz *= factors[plate]
        return xyz
    part = raster.alpha[rows]
    alpha = part.astype(np.float32) / np.float32(np.iinfo(part.dtype).max)
    if raster.premultiplied:
        top = np.iinfo(samples.dtype).max
        plain = samples / np.maximum(alpha, 1e-6)[..., None]
        samples = np.rint(np.minimum(plain, top)).astype(samples.dtype)
    xyz = conversion(samples.reshape(-1, channels)).reshape(height, width, 3)
    return np.concatenate([xyz * alpha[..., None], alpha[..., None]], axis=2)


def area_means(values: Floats, row_edges: Array, columns: int) -> Floats:
    """Means over areas of values (h, w) or (h, w, c).

    row_edges: (rows + 1,) between 0 and h, where the areas' rows part. columns: how many areas
    share the width evenly. Each value counts by its part inside the area.
    """
    column_edges = np.linspace(0.0, values.shape[1], columns + 1)
    rows = _means(values, row_edges)
    return np.swapaxes(_means(np.swapaxes(rows, 0, 1), column_edges), 0, 1)


def _means(values: Floats, edges: Array) -> Floats:
    """Means between edges along the first axis."""
    sums = np.zeros((len(values) + 1, *values.shape[1:]))
    np.cumsum(values, axis=0, out=sums[1:])
    whole = np.minimum(edges.astype(np.int64), len(values) - 1)
    part = (edges - whole).reshape(-1, *(1,) * (values.ndim - 1))
    at_edges = sums[whole] + part * values[whole]
    widths = np.diff(edges).reshape(-1, *(1,) * (values.ndim - 1))
    return np.asarray(np.diff(at_edges, axis=0) / widths)


def _printed_size(raster: Raster, options: ArtworkOptions, notes: list[str]) -> tuple[float, float]:
    width, height = raster.size_px
    if options.width_mm is not None:
        tall = height / width
        if raster.width_mm > 0.0:
            tall = raster.height_mm / raster.width_mm
        return options.width_mm, options.width_mm * tall
    if raster.width_mm > 0.0:
        return raster.width_mm, raster.height_mm
    if options.dpi is None:
        notes.append(
            f"The file names no resolution; {USUAL_DPI:g} dpi are taken. Give the printed width "
            "(width_mm) where that is wrong."
        )
    mm = MM_PER_INCH / (options.dpi or USUAL_DPI)
    return width * mm, height * mm
