"""The mirror ridge: where the readings of each incidence are highest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.measure.findings.rows import Rows
from relgloss_view.measure.overview.polar import IN_PLANE_DEG, Polar

#: A ridge exceeds the body by this factor; a rough body alone rises less towards its mirror.
ABOVE_BODY = 1.5
#: An incidence needs so many receivers in its plane, and so few lamps stand along the normal.
FEWEST, LEAST_INCIDENCE_DEG = 4, 1.0
#: Between receivers further apart the summit is not interpolated, degrees.
WIDEST_GAP_DEG = 10.0
#: A summit at the end of a scan counts as the ridge's this near to the mirror direction, degrees.
AT_THE_END_DEG = 5.0
STEP_DEG = 0.02  #: lamps within it are the same


@dataclass(frozen=True)
class Summit:
    """The highest reading of one lamp direction in its plane of incidence."""

    incidence_deg: float
    receiver_deg: float  #: of the highest reading, positive on the mirror's side
    radiance_factor: float  #: mean over the bands
    #: Where a parabola through it and its neighbours is highest, less the mirror direction,
    #: degrees; None at the end of the receiver's range and where neighbours are far away
    offset_deg: float | None


def summits(rows: Rows, polar: Polar) -> tuple[Summit, ...]:
    """The ridge for each lamp direction that shows one, by increasing incidence.

    rows: readings. polar: their angles.

    The summit is that of the density of facets, readings above the body without the growth by
    Fresnel and by the cosines. Raw readings of rough samples peak beyond the mirror direction
    (Torrance and Sparrow 1967), which is no fault of an instrument.
    """
    if not len(rows):
        return ()
    body = min(rows.body_level, rows.low_level)
    planar = rows.kept & (polar.out_of_plane_deg < IN_PLANE_DEG)
    planar &= polar.lamp_deg > LEAST_INCIDENCE_DEG
    at = np.flatnonzero(planar)
    azimuth = np.degrees(np.arctan2(rows.to_lamp[at, 1], rows.to_lamp[at, 0]))
    steps = [np.rint(x / STEP_DEG).astype(np.int64) for x in (azimuth, polar.lamp_deg[at])]
    order = np.lexsort(steps)
    at = at[order]
    ends = np.flatnonzero(np.any([np.diff(x[order]) != 0 for x in steps], axis=0)) + 1
    signed, level, facets = polar.signed_receiver_deg, rows.level, rows.facets
    found = []
    for members in np.split(at, ends):
        if len(members) < FEWEST:
            continue
        members = members[np.argsort(signed[members], kind="stable")]
        top = int(np.argmax(facets[members]))
        row = int(members[top])
        if level[row] < ABOVE_BODY * body:
            continue
        incidence = float(np.mean(polar.lamp_deg[members]))
        summit = _summit(signed[members], facets[members], top)
        offset = None if summit is None else summit - incidence
        if offset is None and abs(signed[row] - incidence) > AT_THE_END_DEG:
            continue  # a rough body that rises to the end of the scan
        found.append(Summit(incidence, float(signed[row]), float(level[row]), offset))
    return tuple(found)


def _summit(angle_deg: Array, facets: Array, top: int) -> float | None:
    """Vertex of the parabola through the logarithms of three readings, the middle one highest."""
    if not 0 < top < len(angle_deg) - 1:
        return None
    x, y = angle_deg[top - 1 : top + 2], facets[top - 1 : top + 2]
    steps = np.diff(x)
    if np.min(steps) <= 0.0 or np.max(steps) > WIDEST_GAP_DEG or np.min(y) <= 0.0:
        return None
    before, after = np.diff(np.log(y)) / steps
    if not before > after:
        return float(x[1])
    # The slope of the parabola falls linearly between the middles of both steps.
    first, second = x[0] + 0.5 * steps[0], x[1] + 0.5 * steps[1]
    return float(first + (second - first) * before / (before - after))
