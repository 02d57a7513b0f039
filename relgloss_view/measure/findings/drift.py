"""A lamp that fades from the first row to the last."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.measure.findings.finding import DRIFT, Finding
from relgloss_view.measure.findings.lobe import Lobe
from relgloss_view.measure.findings.rows import BODY_DEG, Rows
from relgloss_view.measure.findings.units import FEWEST, MOST_REST, last_slope
from relgloss_view.measure.table import Measurement

#: Of the readings, from the first row to the last: what is named, what is serious, and certainty.
NAMED, SERIOUS, ERRORS = 0.08, 0.10, 6.0
#: A wider highlight reaches into what is taken for the body.
WIDEST_DEG = 7.0
#: Instruments set each plane of incidence anew, with this much noise common to its rows: few planes
#: are in a row by chance. A drift exceeds the slope's deviation from that by this factor.
PLANE_NOISE, BEYOND_PLANES = 0.02, 3.5


def check(measurement: Measurement, rows: Rows, core: Lobe | None) -> list[Finding]:
    """A finding where the body, at equal directions, changes with the order of the rows.

    A body is reciprocal (Helmholtz), so the logarithm of its level is a symmetric function of both
    cosines and of the angle between the directions. What goes with the row's number beside it is
    the instrument's.
    """
    ordered = measurement.in_time_order and not measurement.tabulated
    if not ordered or (core is not None and core.width_deg > WIDEST_DEG):
        return []
    away = rows.kept & (rows.delta_deg > BODY_DEG) & (rows.level < 2.0 * rows.body_level)
    away &= rows.phase_deg > 12.0
    if np.sum(away) < 4 * FEWEST:
        return []
    some = rows.subset(away)
    log_i, log_o = (np.log(np.clip(d[:, 2], 0.05, 1.0)) for d in (some.to_lamp, some.to_receiver))
    between = np.sum(some.to_lamp * some.to_receiver, axis=1)
    total = log_i + log_o
    order = some.index / max(len(measurement.reasons) - 1, 1) - 0.5
    basis = np.column_stack(
        [np.ones(len(some)), total, total**2, between, between**2, some.delta_deg / 50.0,
         (log_o - log_i) ** 2, order]
    )  # fmt: skip
    change, error, rest = last_slope(basis, np.log(some.level), some)
    by_chance = PLANE_NOISE * _leverage(basis, some.group)
    least = max(NAMED, ERRORS * error, BEYOND_PLANES * by_chance)
    if rest > MOST_REST or abs(change) < least:
        return []
    word = "fall" if change < 0.0 else "rise"
    return [
        Finding(
            DRIFT,
            f"the readings {word} by {abs(np.expm1(change)):.0%} from the first row to the last at "
            "equal directions, and the sample is not the same with lamp and receiver exchanged: "
            "the lamp drifts; measure a standard between the planes and divide by it",
            abs(change) > SERIOUS,
        )
    ]


def _leverage(basis: Array, group: Ints) -> float:
    """Deviation of the last coefficient where each group is off by an error of deviation one."""
    others, last = basis[:, :-1], basis[:, -1]
    own = last - others @ np.linalg.lstsq(others, last, rcond=1e-9)[0]
    number = np.unique(group, return_inverse=True)[1]
    sums = np.bincount(number, own)
    return float(np.sqrt(np.sum(np.square(sums))) / max(float(own @ own), 1e-12))
