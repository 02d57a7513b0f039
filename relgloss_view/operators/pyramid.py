"""Low-pass pictures in octaves of cycles per degree, all at full size."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from relgloss_view.base.arrays import Array

#: Nominal frequency of each band, cycles per degree (Pattanaik et al. 1998).
BANDS_CPD = (16.0, 8.0, 4.0, 2.0, 1.0, 0.5)
#: The pictures of a pyramid whose top band is at 16 cycles per degree have this many pixels.
PYRAMID_PIXELS_PER_DEGREE = 32.0
#: A filter this wide leaves 0.7 % at half the pixels' frequency, so every other pixel will do.
DECIMATED_SD_PX = 2.0


def low_pass_sd_deg(level: int) -> float:
    """Standard deviation of the Gaussian of a level, in degrees; level 0 is the picture itself.

    The filter of Burt and Adelson 1983 (a = 0.375, variance one pixel) applied at every level of a
    pyramid has a variance of (4^level - 1)/3 pixels.
    """
    return float(np.sqrt((4.0**level - 1.0) / 3.0)) / PYRAMID_PIXELS_PER_DEGREE


def low_passes(planes: Array, pixels_per_degree: float) -> Iterator[Array]:
    """Levels 1 to 6 of planes (C, H, W), each at full size, as they are needed.

    Widths are those of degrees, whatever the size of the pixels. Wide filters run on fewer pixels,
    which loses nothing that they would pass. The border's pixels are repeated.
    """
    shapes: list[tuple[int, int]] = []
    done = 0.0  # of the current pixels, the filter so far
    coarse = planes
    for level in range(1, len(BANDS_CPD) + 1):
        wanted = low_pass_sd_deg(level) * pixels_per_degree
        while wanted / 2.0 ** len(shapes) > 2.0 * DECIMATED_SD_PX and max(coarse.shape[1:]) > 1:
            step = np.sqrt(max(DECIMATED_SD_PX**2 - done**2, 0.0))
            shapes.append(coarse.shape[1:])
            coarse = _blur(coarse, step)[:, ::2, ::2]
            done = max(done, DECIMATED_SD_PX) / 2.0
        here = wanted / 2.0 ** len(shapes)
        coarse, done = _blur(coarse, np.sqrt(max(here**2 - done**2, 0.0))), here
        full = coarse
        for shape in reversed(shapes):
            full = enlarge(full, shape)
        yield full


def _blur(planes: Array, sd_px: float) -> Array:
    from scipy.ndimage import gaussian_filter1d

    if sd_px < 1e-3:
        return planes
    for axis in (1, 2):
        if planes.shape[axis] > 1:
            planes = gaussian_filter1d(planes, sd_px, axis=axis, mode="nearest")
    return planes


def enlarge(planes: Array, shape: tuple[int, int]) -> Array:
    """Planes (C, h, w) of every other pixel at the full size, by cubic interpolation.

    Between samples the weights are those of Keys 1981, (-1, 9, 9, -1)/16.
    """
    for axis, size in zip((1, 2), shape, strict=True):
        planes = _enlarge_axis(planes, axis, size)
    return planes


def _enlarge_axis(planes: Array, axis: int, size: int) -> Array:
    count = planes.shape[axis]
    full = np.empty((*planes.shape[:axis], size, *planes.shape[axis + 1 :]))

    def places(chosen: slice) -> tuple[slice, ...]:
        return tuple(chosen if a == axis else slice(None) for a in range(planes.ndim))

    full[places(slice(0, None, 2))] = planes
    between = size // 2
    if between:
        padding = [(1, 2) if a == axis else (0, 0) for a in range(planes.ndim)]
        padded = np.pad(planes, padding, mode="edge")
        inner = padded[places(slice(1, 1 + between))] + padded[places(slice(2, 2 + between))]
        outer = padded[places(slice(0, between))] + padded[places(slice(3, 3 + between))]
        full[places(slice(1, None, 2))] = (9.0 * inner - outer) / 16.0
    assert count == size - between
    return full
