"""A few directions that a table's spectra are shown at: its body, its highlight, grazing light."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.measure.overview.polar import Polar
from relgloss_view.measure.spectrum import from_45_0

BODY, MIRROR, STEEP_MIRROR, GRAZING = (
    "body", "near the mirror", "near the mirror, steep", "grazing",
)  # fmt: skip
#: Half-vectors further from the normal show the body of most samples, nearer ones the highlight.
BODY_DEG, NEAR_DEG = 15.0, 5.0
TIE = 0.01  #: between 45/0 and 0/45 the first is shown, and what lies in the plane
GRAZING_FROM_DEG = 60.0


@dataclass(frozen=True)
class Direction:
    """A geometry that is shown."""

    part: str  #: BODY, MIRROR, STEEP_MIRROR or GRAZING
    row: int  #: of the table, from 0


def directions(polar: Polar, used: Mask) -> tuple[Direction, ...]:
    """The rows that show each part best, among the marked ones; parts that none shows are missing.

    polar: the angles of all rows of a table.
    """
    off_45_0 = from_45_0(polar.lamp_deg, polar.receiver_deg)
    off_45_0 += TIE * (polar.lamp_deg < polar.receiver_deg)
    body = used & (polar.half_deg > BODY_DEG)
    near = used & (polar.half_deg <= max(NEAR_DEG, _least(polar.half_deg, used) + 0.5))
    near &= polar.half_deg < BODY_DEG
    best = near & (polar.half_deg <= _least(polar.half_deg, near) + 0.5)
    steepest = np.maximum(polar.lamp_deg, polar.receiver_deg)
    # Towards the lamp an arm may be in the way, and some samples send light back there.
    grazing = body & (steepest >= GRAZING_FROM_DEG) & (polar.azimuth_deg >= 90.0)
    chosen = (
        (BODY, body, off_45_0),
        (MIRROR, best, np.abs(polar.lamp_deg - 45.0) + polar.half_deg),
        (STEEP_MIRROR, best & (polar.lamp_deg >= GRAZING_FROM_DEG), -polar.lamp_deg),
        (GRAZING, grazing, TIE * polar.out_of_plane_deg - np.round(steepest)),
    )
    result: dict[int, Direction] = {}
    for part, rows, cost in chosen:
        if np.any(rows):
            row = int(np.argmin(np.where(rows, cost, np.inf)))
            result.setdefault(row, Direction(part, row))
    return tuple(result.values())


def _least(values: Array, rows: Mask) -> float:
    return float(np.min(values[rows], initial=np.inf))
