"""Tristimulus BRDFs, in which each of X, Y and Z is a BRDF of its own, as linear RGB."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.measure.bands import RGB, WIDE_RGB, Bands

#: Linear sRGB from XYZ with the white D65, for column vectors (IEC 61966-2-1).
SRGB_FROM_XYZ = np.array(
    [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
)
#: Linear Rec. 2020 from XYZ with the white D65 (ITU-R BT.2020).
REC2020_FROM_XYZ = np.array(
    [[1.7167, -0.3557, -0.2534], [-0.6667, 1.6165, 0.0158], [0.0176, -0.0428, 0.9421]]
)


def rgb_of(xyz: Array) -> tuple[Bands, Array, tuple[str, ...]]:
    """Bands, linear RGB (N, 3) and notes for XYZ (N, 3), whose white is taken as D65.

    A colour outside sRGB is kept in linear Rec. 2020; what is negative there too becomes zero.
    Rows that hold a NaN, or a negative Y, stay as they are for the screening.

    >>> rgb_of(np.array([[0.9505, 1.0, 1.0890]]))[1].round(2).tolist()
    [[1.0, 1.0, 1.0]]
    """
    notes = ["the file does not declare the white of its XYZ values: D65 is assumed"]
    rgb = xyz @ SRGB_FROM_XYZ.T
    sound = np.asarray((xyz >= 0.0).all(axis=1))
    outside = sound & (rgb < -1e-6 * np.abs(xyz).max(axis=1, keepdims=True)).any(axis=1)
    bands = RGB
    if np.any(outside):
        bands, rgb = WIDE_RGB, xyz @ REC2020_FROM_XYZ.T
        notes.append(f"the colour lies outside sRGB in {int(outside.sum())} samples: kept in "
                     f"{bands.words}")  # fmt: skip
    rgb = np.where(sound[:, None], np.maximum(rgb, 0.0), np.where(np.isnan(xyz), np.nan, -1.0))
    return bands, np.asarray(rgb), tuple(notes)
