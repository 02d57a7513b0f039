"""What the eye sees of a grain on a monitor, by its sensitivity to contrast.

A monitor shows pixels, so its light has the picture's spectrum and, beyond it, the repetitions that
the pixels' square form leaves. All of it is weighted. So the same light counts the same, however
many pixels show it.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array, Mask

#: Side of the grain whose standard deviation graininess is given as: the paper's pixel.
REFERENCE_ARCMIN = 1.5
#: Cycles per degree below which little counts: shading and broad highlights, rather than grain.
COARSE_CPD = 4.0
HIGHEST_CPD = 80.0  #: the eye sees nothing beyond


def contrast_sensitivity(cycles_per_degree: Array) -> Array:
    """Sensitivity to contrast, 1 at its largest: 2.6 (0.0192 + 0.114 f) exp(-(0.114 f)^1.1).

    Source: Mannos and Sakrison 1974, "The effects of a visual fidelity criterion on the encoding of
    images". Its largest value lies at 8 cycles per degree.

    >>> contrast_sensitivity(np.array([0.0, 8.0, 30.0])).round(2).tolist()
    [0.05, 0.98, 0.19]
    """
    f = 0.114 * np.asarray(cycles_per_degree)
    return np.asarray(2.6 * (0.0192 + f) * np.exp(-(f**1.1)))


def seen_grain(lightness: Array, pixels_per_degree: float) -> Array:
    """L* (H, W) as far as it is grain, weighted by the eye's sensitivity, of mean 0.

    Azimuths of a frequency count by the squared sine of twice the azimuth: what varies along one
    axis alone, as an upright highlight does, is filtered out, and a grain of any size, which varies
    in all directions alike, loses the same share at each frequency.
    """
    from scipy.fft import dctn, idctn

    rows, columns = (np.arange(n) * (0.5 * pixels_per_degree / n) for n in lightness.shape)
    weight = np.sqrt(_shown_power(rows[:, None], columns[None, :], pixels_per_degree))
    return np.asarray(idctn(weight * dctn(np.asarray(lightness, dtype=np.float64))))


def _power(down: Array, across: Array) -> Array:
    """Weight of a grain's power at frequencies in cycles per degree."""
    f2 = np.square(down) + np.square(across)
    # sin^2 of twice the azimuth: 0 for what varies along one axis alone.
    slanted = np.square(2.0 * down * across) / np.square(np.maximum(f2, 1e-12))
    fine = np.square(1.0 - np.exp(-0.5 * f2 / COARSE_CPD**2))
    return np.asarray(np.square(contrast_sensitivity(np.sqrt(f2)) * slanted * fine))


def _shown_power(down: Array, across: Array, pixels_per_degree: float) -> Array:
    """The same of a picture's frequency, with its repetitions beyond the pixels' own frequency."""
    count = int(np.ceil(HIGHEST_CPD / pixels_per_degree))
    total: Array = np.zeros(np.broadcast_shapes(down.shape, across.shape))
    shifts = pixels_per_degree * np.arange(-count, count + 1)
    for shift_down in shifts:
        y = down + shift_down
        for shift_across in shifts:
            x = across + shift_across
            form = np.sinc(y / pixels_per_degree) * np.sinc(x / pixels_per_degree)
            total += _power(y, x) * form * form
    return total


@lru_cache(maxsize=1)
def reference_deviation() -> float:
    """Standard deviation that seen_grain leaves of independent square grains of REFERENCE_ARCMIN.

    Theirs is 1.
    """
    side_deg = REFERENCE_ARCMIN / 60.0
    step = 0.25
    f = np.arange(-HIGHEST_CPD, HIGHEST_CPD, step) + 0.5 * step
    grains = np.square(side_deg * np.sinc(f[:, None] * side_deg) * np.sinc(f[None] * side_deg))
    return float(np.sqrt(np.sum(grains * _power(f[:, None], f[None, :])) * step * step))


def filled(values: Array, whole: Mask) -> Array:
    """Values (H, W) with the nearest of the object where it is not whole, so that no edge shows."""
    from scipy.ndimage import distance_transform_edt

    rows, columns = distance_transform_edt(~whole, return_distances=False, return_indices=True)
    return np.asarray(values[rows, columns])
