"""What a screen's ICC profile holds beside colours: luminance, black point, the card's curves.

Source: ICC.1:2022, 9.2.33 (luminanceTag); ICC.1:2001, 6.4.16 (mediaBlackPointTag); Apple (2000),
ColorSync Manager: CMVideoCardGammaTag (vcgt), which no standard describes.
"""

from __future__ import annotations

import struct

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.icc.profile import D50, Profile
from relgloss_view.display.icc_white import emitted_from_connection

LUMINANCES = (1.0, 10000.0)  #: cd/m2 that a screen's white can have
MOST_CALIBRATION = 1 << 16  #: entries of a curve
CALIBRATION_NODES = 256
UNCHANGED = 1.0 / 512.0  #: half a step of 8 bits

NO_LUMINANCE = (
    "The profile does not hold the luminance of white. Set display.luminance_cd_m2 where you know "
    "it."
)
CALIBRATED = (
    "The profile holds for a screen whose video card has the profile's calibration (vcgt) loaded; "
    "without it the screen shows other colours."
)


def luminance_of_white(profile: Profile) -> tuple[float | None, tuple[str, ...]]:
    """Luminance of white in cd/m2, None where the profile holds none, and notes for people."""
    xyz = xyz_of(profile.tags.get(b"lumi", b""))
    if xyz is None:
        return None, (NO_LUMINANCE,)
    least, most = LUMINANCES
    if not least <= xyz[1] <= most:
        return None, (
            f"The profile holds {xyz[1]:.4g} cd/m2 for the luminance of white, which no screen "
            "has; it is ignored. Set display.luminance_cd_m2 where you know it.",
        )
    return float(xyz[1]), ()


def black_point(profile: Profile) -> Array | None:
    """Emitted XYZ (3,) at black, relative to white at Y = 1; None where the profile holds none."""
    black = xyz_of(profile.tags.get(b"bkpt", b""))
    if black is None or not 0.0 < black[1] < 0.5 * profile.white[1] or black.min() < 0.0:
        return None
    if b"chad" in profile.tags:  # it is under D50, as all of such a profile
        matrix = emitted_from_connection(profile)[0]
        return np.asarray(matrix @ black / (matrix @ D50)[1])
    return np.asarray(black / profile.white[1])


def calibration(profile: Profile) -> tuple[Array | None, tuple[str, ...]]:
    """The video card's curves (3, n), values out for values evenly spaced over 0 to 1; notes.

    None where the profile holds none, or those that change nothing.
    """
    curves = calibration_of(profile.tags.get(b"vcgt", b""))
    if curves is None:
        return None, ()
    same = np.linspace(0.0, 1.0, curves.shape[1])
    if np.abs(curves - same).max() <= UNCHANGED:
        return None, ()
    return curves, (CALIBRATED,)


def calibration_of(part: bytes) -> Array | None:
    """The curves (3, n) of a `vcgt` tag: a table, or a formula; None where it has none.

    >>> calibration_of(b"") is None
    True
    """
    if part[:4] != b"vcgt" or len(part) < 18:
        return None
    (kind,) = struct.unpack_from(">I", part, 8)
    if kind == 0:
        channels, count, size = struct.unpack_from(">HHH", part, 12)
        if channels not in (1, 3) or size not in (1, 2) or count < 2:
            return None
        if 18 + channels * count * size > len(part):
            return None
        numbers = np.frombuffer(part, ">u1" if size == 1 else ">u2", channels * count, 18)
        table = numbers.reshape(channels, count) / (256.0**size - 1.0)
        return np.asarray(np.broadcast_to(table, (3, count)), np.float64)
    if kind == 1 and len(part) >= 48:
        rows = np.array(struct.unpack_from(">9i", part, 12)).reshape(3, 3) / 65536.0
        gamma, low, high = rows.T[:, :, None]
        if gamma.min() <= 0.0:
            return None
        with np.errstate(under="ignore"):
            power = np.linspace(0.0, 1.0, CALIBRATION_NODES) ** gamma
        return np.asarray(np.clip(low + (high - low) * power, 0.0, 1.0))
    return None


def xyz_of(part: bytes) -> Array | None:
    """The first colour (3,) of a tag of type XYZ; None where it is none."""
    if part[:4] != b"XYZ " or len(part) < 20:
        return None
    return np.array(struct.unpack_from(">3i", part, 8)) / 65536.0
