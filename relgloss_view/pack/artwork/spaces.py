"""RGB spaces that files name without a profile: sRGB, PNG's gAMA and cHRM, cICP."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array, Floats
from relgloss_view.base.icc.curves import Curve
from relgloss_view.base.icc.profile import D50, Profile, matrix_space
from relgloss_view.material.cielab import BRADFORD

#: x and y of red, green, blue and white.
REC709 = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06), (0.3127, 0.3290))
P3 = ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060), (0.3127, 0.3290))
REC2020 = ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046), (0.3127, 0.3290))
#: ITU-T H.273, tables 2 and 3: colour primaries, and the transfers that pictures have.
CICP_PRIMARIES = {1: REC709, 9: REC2020, 12: P3}

Primaries = tuple[tuple[float, float], ...]


def srgb() -> Profile:
    """sRGB (IEC 61966-2-1), adapted to D50."""
    return matrix_space("sRGB", rgb_to_xyz(REC709), srgb_light)


def srgb_light(values: Floats) -> Floats:
    """Linear light of sRGB values, 0 to 1; IEC 61966-2-1."""
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def power_light(gamma: float) -> Curve:
    """The curve of a plain power."""
    return lambda values: np.asarray(values**gamma)


def rgb_to_xyz(primaries: Primaries) -> Array:
    """The matrix (3, 3) from linear RGB to XYZ under D50. Raises ValueError for no triangle.

    SMPTE RP 177-1993; adapted by Bradford's transform.
    """
    xyz = np.array([[x / y, 1.0, (1.0 - x - y) / y] if y > 0 else [0.0] * 3 for x, y in primaries])
    try:
        amounts = np.linalg.solve(xyz[:3].T, xyz[3])
        turned = np.diag((BRADFORD @ D50) / (BRADFORD @ xyz[3]))
        adapted = np.linalg.solve(BRADFORD, turned @ BRADFORD) @ (xyz[:3].T * amounts)
    except np.linalg.LinAlgError:
        raise ValueError("primaries that span no colours") from None
    if not (np.isfinite(adapted).all() and np.abs(adapted).max() < 4.0):
        raise ValueError("primaries that span no colours")
    return np.asarray(adapted)


def cicp_space(primaries: int, transfer: int) -> Profile:
    """The space of a cICP chunk; ValueError where it is one of a moving picture or unknown."""
    if primaries not in CICP_PRIMARIES:
        raise ValueError(f"colour primaries {primaries} of its cICP chunk are not read")
    if transfer == 13:
        curve: Curve = srgb_light
    elif transfer == 8:
        curve = power_light(1.0)
    elif transfer in (1, 6, 14, 15):
        curve = power_light(2.4)  # ITU-R BT.1886, how such pictures are shown
    else:
        raise ValueError(f"transfer {transfer} of its cICP chunk is not read")
    return matrix_space("cICP", rgb_to_xyz(CICP_PRIMARIES[primaries]), curve)
