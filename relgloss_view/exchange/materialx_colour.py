"""Colour spaces of MaterialX documents by name, to linear sRGB under D65.

Source of the names and curves: MaterialX 1.39.5, libraries/cmlib (its matrices judge these in the
tests). Primaries: ITU-R BT.709, SMPTE EG 432-1 (Display P3), Adobe RGB (1998), ACES S-2014-004.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.exchange.picture_mean import Curve
from relgloss_view.material.cielab import bradford, srgb_decoded
from relgloss_view.material.spectra import (
    D65_XY,
    SRGB_PRIMARIES_XY,
    rgb_to_xyz_matrix,
    white_from_xy,
)

_ACES_WHITE_XY = (0.32168, 0.33767)
_AP1 = ((0.713, 0.293), (0.165, 0.830), (0.128, 0.044))
_P3 = ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060))
_ADOBE = ((0.64, 0.33), (0.21, 0.71), (0.15, 0.06))
Primaries = tuple[tuple[float, float], ...]


class Space(NamedTuple):
    """A colour space: the curve of its values, its primaries, its white."""

    curve: Curve | None = None
    primaries: Primaries = SRGB_PRIMARIES_XY
    white: tuple[float, float] = D65_XY

    def linear_srgb(self, values: Array) -> Array:
        """Values (..., 3) of this space as linear sRGB, which may lie outside of 0 to 1."""
        light = values if self.curve is None else self.curve(values)
        return self.from_primaries(light)

    def from_primaries(self, light: Array) -> Array:
        """Linear light (..., 3) of these primaries as linear sRGB (Bradford's adaptation)."""
        if self.primaries == SRGB_PRIMARIES_XY:
            return light
        xyz = rgb_to_xyz_matrix(self.primaries, self.white)
        adapted = bradford(white_from_xy(self.white), white_from_xy(D65_XY)) @ xyz
        matrix = np.linalg.solve(rgb_to_xyz_matrix(SRGB_PRIMARIES_XY, D65_XY), adapted)
        return np.asarray(light @ matrix.T)


def _power(exponent: float) -> Curve:
    return lambda values: np.asarray(np.maximum(values, 0.0) ** exponent)


_LINEAR = Space()
_SRGB = Space(srgb_decoded)
_ACESCG = Space(None, _AP1, _ACES_WHITE_XY)
SPACES: dict[str, Space] = {
    **dict.fromkeys(("", "none", "raw", "lin_rec709", "lin_srgb", "lin_rec709_scene"), _LINEAR),
    **dict.fromkeys(("srgb_texture", "srgb_rec709_scene", "srgb_rec709_display"), _SRGB),
    "g18_rec709": Space(_power(1.8)),
    "g22_rec709": Space(_power(2.2)),
    "rec709_display": Space(_power(2.4)),
    **dict.fromkeys(("acescg", "lin_ap1", "lin_ap1_scene"), _ACESCG),
    "g22_ap1": Space(_power(2.2), _AP1, _ACES_WHITE_XY),
    "adobergb": Space(_power(563.0 / 256.0), _ADOBE),
    "lin_adobergb": Space(None, _ADOBE),
    "srgb_displayp3": Space(srgb_decoded, _P3),
    "lin_displayp3": Space(None, _P3),
}
