"""Linear RGB and XYZ of other programs' files to the channels of a measurement."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.measure.bands import RGB, WIDE_RGB, Bands
from relgloss_view.measure.screening import NOISE

#: Rec. 709 luminance of linear sRGB.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
#: Linear sRGB to linear Rec. 2020 (ITU-R BT.2087-0), for column vectors.
REC2020_FROM_SRGB = np.array(
    [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]]
)
#: XYZ, of a diffuser of 1 under D65, to linear sRGB (IEC 61966-2-1), for column vectors.
SRGB_FROM_XYZ = np.array(
    [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
)


def srgb_from_xyz(xyz: Array) -> Array:
    """Linear sRGB of XYZ, (N, 3) each, in the unit of Y.

    >>> srgb_from_xyz(np.array([[0.9505, 1.0, 1.0890]])).round(3).tolist()
    [[1.0, 1.0, 1.0]]
    """
    return np.asarray(xyz @ SRGB_FROM_XYZ.T)


def within_gamut(rgb: Array, used: Mask) -> tuple[Bands, Array, tuple[str, ...]]:
    """Bands, values (N, 3) of at least zero, and warnings, for linear sRGB (N, 3).

    used: (N,), the samples that count. A saturated colour has a negative channel in linear sRGB;
    that is its gamut and no fault of the instrument. It is kept in linear Rec. 2020, with a
    warning. Values that are not used stay as they are where they are NaN.

    >>> within_gamut(np.array([[-0.1, 0.5, 0.1]]), np.array([True]))[0].primaries
    'rec2020'
    """
    outside = _negative(rgb, used)
    if not np.any(outside):
        return RGB, np.maximum(rgb, 0.0), ()
    wide = rgb @ REC2020_FROM_SRGB.T
    warnings = [
        f"the colour lies outside sRGB in {np.max(outside)} samples (channel "
        f"{RGB.labels[int(np.argmax(outside))]} is negative): kept in {WIDE_RGB.words}"
    ]
    warnings += [
        f"channel {label} is negative in {count} samples in {WIDE_RGB.words} too; it is taken as "
        "0 there"
        for label, count in zip(WIDE_RGB.labels, _negative(wide, used), strict=True)
        if count
    ]
    return WIDE_RGB, np.maximum(wide, 0.0), tuple(warnings)


def _negative(rgb: Array, used: Mask) -> Array:
    """How many used samples are negative, in each channel."""
    return np.asarray(((rgb < 0.0) & used[:, None]).sum(axis=0))


def readable_rgb(rgb: Array) -> tuple[Bands, Array, tuple[str, ...]]:
    """As within_gamut, for an instrument's own readings of f_r, linear sRGB (N, 3) in 1/sr.

    Noise about zero is no colour, and a luminance below zero is none either: such rows keep their
    sign, so that they are left out as negative.
    """
    rgb = np.where((rgb < 0.0) & (rgb > -NOISE / np.pi), 0.0, rgb)
    dark = ~(rgb @ LUMINANCE >= 0.0)  # NaN too
    bands, values, warnings = within_gamut(rgb, ~dark)
    return bands, np.where(dark[:, None], rgb, values), warnings


def rgb_of(xyz: Array) -> tuple[Bands, Array, tuple[str, ...]]:
    """As within_gamut, for XYZ (N, 3), each a BRDF of its own, whose white is taken as D65.

    Rows that hold a NaN, or a value below zero, come out as NaN and -1 for the screening.

    >>> rgb_of(np.array([[0.9505, 1.0, 1.0890]]))[1].round(2).tolist()
    [[1.0, 1.0, 1.0]]
    """
    sound = np.asarray((xyz >= 0.0).all(axis=1))
    rgb = srgb_from_xyz(xyz)
    # The matrix of four digits puts neutral colours this far outside.
    rgb = np.where((rgb < 0.0) & (rgb > -1e-3 * xyz.max(axis=1, keepdims=True)), 0.0, rgb)
    bands, values, warnings = within_gamut(rgb, sound)
    note = "the file does not declare the white of its XYZ values: D65 is assumed"
    values = np.where(sound[:, None], values, np.where(np.isnan(xyz), np.nan, -1.0))
    return bands, values, (note, *warnings)
