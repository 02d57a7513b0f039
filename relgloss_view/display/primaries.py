"""The primaries of a screen: whether they can be those of one, and whether channels are swapped."""

from __future__ import annotations

from itertools import permutations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.material.spectra import (
    D65_XY,
    SRGB_PRIMARIES_XY,
    rgb_to_xyz_matrix,
    white_from_xy,
)

CHANNELS = ("red", "green", "blue")
LEAST_WHITE = 0.05  #: Y, where that of the connection space's white is 1
MOST_WHITE = 4.0
#: The volume of the three primaries, each of length 1. sRGB has 0.4, ACES AP0 0.6, and three
#: primaries of a barely coloured screen 0.01.
LEAST_VOLUME = 1e-3


def check_primaries(ends: Array) -> None:
    """Raise ValueError where XYZ (5, 3) of black, red, green, blue and white are of no screen."""
    black, white = ends[0], ends[4]
    if not np.isfinite(ends).all() or not LEAST_WHITE <= white[1] <= MOST_WHITE:
        raise ValueError("an ICC profile whose white shows no light, or beyond all bounds")
    if not black[1] < 0.9 * white[1]:
        raise ValueError("an ICC profile whose black is as bright as its white")
    added = ends[1:4] - black
    lengths = np.linalg.norm(added, axis=1, keepdims=True)
    if lengths.min() < 1e-4 or abs(np.linalg.det(added / lengths)) < LEAST_VOLUME:
        raise ValueError("an ICC profile whose red, green and blue lie on a line")
    shares = np.linalg.solve(added.T, white - black)
    if shares.min() < 0.05 or shares.max() > 20.0:
        raise ValueError("an ICC profile whose red, green and blue do not add to its white")


def swapped(xyz_from_rgb: Array, white: Array) -> tuple[str, ...]:
    """A note where a channel's hue is rather that of another channel.

    By the angle around white in CIE 1976 u'v', against the primaries of sRGB.

    >>> srgb = rgb_to_xyz_matrix(SRGB_PRIMARIES_XY, D65_XY)
    >>> swapped(srgb, white_from_xy(D65_XY))
    ()
    >>> swapped(srgb[:, [1, 0, 2]], white_from_xy(D65_XY))[0][:49]
    'The channels of the screen seem to be swapped: re'
    """
    usual = _hues(rgb_to_xyz_matrix(SRGB_PRIMARIES_XY, D65_XY), white_from_xy(D65_XY))
    apart = np.abs(_hues(xyz_from_rgb, white)[:, None] - usual)
    apart = np.minimum(apart, 2.0 * np.pi - apart)
    orders = list(permutations(range(3)))  # the first leaves all in place
    best = min(orders, key=lambda order: sum(apart[k, order[k]] for k in range(3)))
    if best == orders[0]:
        return ()
    words = ", ".join(f"{CHANNELS[k]} shows {CHANNELS[o]}" for k, o in enumerate(best) if k != o)
    return (
        f"The channels of the screen seem to be swapped: {words}. Check the cable, the settings of "
        "the screen, and that the profile is this screen's.",
    )


def _hues(xyz_from_rgb: Array, white: Array) -> Array:
    """Angles (3,) of the primaries around white in u'v', in radians."""
    xyz = np.vstack([xyz_from_rgb.T, white])
    below = xyz @ np.array([1.0, 15.0, 3.0])
    below = np.where(np.abs(below) < 1e-9, 1e-9, below)
    uv = xyz[:, :2] * np.array([4.0, 9.0]) / below[:, None]
    u, v = (uv[:3] - uv[3]).T
    return np.asarray(np.arctan2(v, u))
