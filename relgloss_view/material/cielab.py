"""CIELAB and sRGB as numbers: XYZ to L*, a*, b* and back, and the colour of a colour picker.

CIE 15:2004's piecewise lightness. `picture.model.tone` draws with the same functions.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array
from relgloss_view.material.spectra import (
    D65_XY,
    SRGB_PRIMARIES_XY,
    illuminant,
    rgb_to_xyz_matrix,
    white_from_xy,
)

EPSILON = 216.0 / 24389.0
KAPPA = 24389.0 / 27.0
#: XYZ to the responses of the Bradford transform (Lam 1985; ICC.1:2022, annex E).
BRADFORD = np.array(
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
)


def f_of_ratio(t: Array) -> Array:
    """CIE 15's f of a relative tristimulus value; value and slope are continuous.

    >>> f_of_ratio(np.array([1.0])).tolist()
    [1.0]
    """
    return np.where(t > EPSILON, np.cbrt(t), (KAPPA * t + 16.0) / 116.0)


def ratio_of_f(f: Array) -> Array:
    """Inverse of f_of_ratio."""
    return np.where(f > 6.0 / 29.0, f**3, (116.0 * f - 16.0) / KAPPA)


def lightness(y: Array) -> Array:
    """L* of a relative luminance y: 0 at 0, 100 at 1 (CIE 15:2004)."""
    return np.where(y > EPSILON, 116.0 * np.cbrt(y) - 16.0, KAPPA * y)


def lab_from_xyz(xyz: Array, white: Array) -> Array:
    """L*, a*, b* of XYZ (..., 3) against a white (3,), in the same unit (CIE 15:2004).

    >>> lab_from_xyz(np.array([0.2, 0.18, 0.1]), np.array([0.9505, 1.0, 1.0891])).round(2).tolist()
    [49.5, 15.08, 22.7]
    """
    f = f_of_ratio(xyz / white)
    return np.stack(
        [
            lightness(xyz[..., 1] / white[1]),
            500.0 * (f[..., 0] - f[..., 1]),
            200.0 * (f[..., 1] - f[..., 2]),
        ],
        axis=-1,
    )


def xyz_from_lab(lab: Array, white: Array) -> Array:
    """XYZ (..., 3) of L*, a*, b* against a white (3,); the inverse of lab_from_xyz.

    >>> xyz_from_lab(np.array([100.0, 0.0, 0.0]), np.array([0.95, 1.0, 1.09])).round(6).tolist()
    [0.95, 1.0, 1.09]
    """
    f = (lab[..., 0] + 16.0) / 116.0
    return white * np.stack(
        [
            ratio_of_f(f + lab[..., 1] / 500.0),
            ratio_of_f(f),
            ratio_of_f(f - lab[..., 2] / 200.0),
        ],
        axis=-1,
    )


def bradford(from_white: Array, to_white: Array) -> Array:
    """Matrix (3, 3) that adapts XYZ from one white to another (Lam 1985; ICC.1:2022, annex E).

    >>> d65, d50 = white_from_xy(D65_XY), np.array([0.9642, 1.0, 0.8249])
    >>> (bradford(d65, d50) @ d65).round(4).tolist()
    [0.9642, 1.0, 0.8249]
    """
    gain = (BRADFORD @ to_white) / (BRADFORD @ from_white)
    return np.asarray(np.linalg.solve(BRADFORD, gain[:, None] * BRADFORD))


def srgb_to_lab(srgb: ArrayLike, lamp: str = "D50") -> Array:
    """L*, a*, b* (..., 3) under a lamp of sRGB values (..., 3), 0 to 1 (IEC 61966-2-1:1999).

    The colour is that under sRGB's own white, D65; Bradford's transform adapts it to the lamp's.

    >>> srgb_to_lab([1.0, 1.0, 1.0]).round(6).tolist()[0]
    100.0
    >>> srgb_to_lab([1.0, 0.0, 0.0]).round(1).tolist()  # as ICC profiles of sRGB have it
    [54.3, 80.8, 69.9]
    """
    linear = srgb_decoded(srgb)
    white, d65 = illuminant(lamp).white_xyz(), white_from_xy(D65_XY)
    xyz = linear @ rgb_to_xyz_matrix(SRGB_PRIMARIES_XY, D65_XY).T @ bradford(d65, white).T
    return lab_from_xyz(xyz, white)


def lab_to_srgb(lab: ArrayLike, lamp: str = "D50") -> Array:
    """sRGB values (..., 3) of L*, a*, b* under a lamp; the inverse of srgb_to_lab.

    Colours outside sRGB have values below 0 or above 1.

    >>> lab_to_srgb(srgb_to_lab([0.2, 0.5, 0.7])).round(9).tolist()
    [0.2, 0.5, 0.7]
    """
    white, d65 = illuminant(lamp).white_xyz(), white_from_xy(D65_XY)
    xyz = xyz_from_lab(np.asarray(lab, dtype=np.float64), white) @ bradford(white, d65).T
    linear = xyz @ np.linalg.inv(rgb_to_xyz_matrix(SRGB_PRIMARIES_XY, D65_XY)).T
    return srgb_encoded(linear)


def srgb_decoded(srgb: ArrayLike) -> Array:
    """Linear light of sRGB values, 0 to 1, of any shape (IEC 61966-2-1:1999).

    >>> srgb_decoded([0.0, 0.5, 1.0]).round(4).tolist()
    [0.0, 0.214, 1.0]
    """
    value = np.asarray(srgb, dtype=np.float64)
    bent = ((np.maximum(value, 0.0) + 0.055) / 1.055) ** 2.4
    return np.where(value <= 0.04045, value / 12.92, bent)


def srgb_encoded(linear: ArrayLike) -> Array:
    """sRGB values of linear light of any shape; the inverse of srgb_decoded.

    >>> srgb_encoded([0.0, 0.214, 1.0]).round(2).tolist()
    [0.0, 0.5, 1.0]
    """
    light = np.asarray(linear, dtype=np.float64)
    power = np.maximum(light, 0.0031308) ** (1.0 / 2.4)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * power - 0.055)
