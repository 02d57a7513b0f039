"""ColourReading: the colour of a flat sample in one geometry, as a spectrophotometer reads it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.measure.bands import Bands

#: Geometries of spectrophotometers (CIE 15:2004, ISO 13655): lamp at 45 degrees and receiver along
#: the normal, or a sphere and a receiver at 8 degrees that sees the mirror direction or not.
AT_45_0, SPHERE_INCLUDED, SPHERE_EXCLUDED = "45-0", "d-8-sci", "d-8-sce"
GEOMETRIES = (AT_45_0, SPHERE_INCLUDED, SPHERE_EXCLUDED)
#: A geometry counts as 45/0 within this, degrees (CIE 15:2004).
LAMP_45_DEG, RECEIVER_0_DEG = 2.0, 10.0
ROUNDING_DEG = 1e-6


@dataclass(frozen=True)
class ColourReading:
    """The reflectance spectrum of a sample in one geometry."""

    name: str
    bands: Bands  #: spectral
    radiance_factor: Array  #: (B,), 1 is the perfect diffuser
    geometry: str | None = None  #: one of GEOMETRIES; None where the file does not state it
    notes: tuple[str, ...] = ()  #: what was passed over or converted
    file: str = ""  #: where it was read from


def from_45_0(lamp_deg: Array, receiver_deg: Array) -> Array:
    """(N,), how far each geometry is from 45/0 or 0/45, degrees: the sum over both directions.

    lamp_deg, receiver_deg: (N,), from the normal. Both geometries read the same (Helmholtz
    reciprocity).
    """
    return np.minimum(
        np.abs(lamp_deg - 45.0) + receiver_deg, np.abs(receiver_deg - 45.0) + lamp_deg
    )


def is_45_0(lamp_deg: Array, receiver_deg: Array) -> Mask:
    """(N,), whether each geometry is one of a 45/0 or 0/45 spectrophotometer (CIE 15:2004).

    lamp_deg, receiver_deg: (N,), from the normal.

    >>> is_45_0(np.array([45.0, 8.0, 45.0]), np.array([0.0, 46.0, 45.0])).tolist()
    [True, True, False]
    """
    result = np.zeros(len(lamp_deg), dtype=bool)
    for a, b in ((lamp_deg, receiver_deg), (receiver_deg, lamp_deg)):
        result |= (np.abs(a - 45.0) <= LAMP_45_DEG + ROUNDING_DEG) & (
            b <= RECEIVER_0_DEG + ROUNDING_DEG
        )
    return result
