"""Plateaus: many readings that stand at one value, the largest (saturation) or the smallest.

A detector that ends at some level piles up at it what lies above. So the rows at the largest value
are counted, of unlike geometries, and held against the numbers at the next values below. Those are
large where a table is rounded to few digits.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.measure.findings.finding import FLOOR, PLATEAU, Finding
from relgloss_view.measure.findings.rows import Rows
from relgloss_view.measure.table import SATURATED, Measurement

#: Readings within this of another are the same one, written with seven digits and converted.
SAME = 2e-6
#: Rows that stand at one value: so many and more, and times as many as at each of the next values.
FEWEST, TIMES_NEXT = 3, 3
#: Where the next values differ by this share and more, the table is rounded: so many rows more.
ROUNDED, ROUNDED_MORE, STEPS_BELOW = 1e-3, 2, 20
#: A plateau with a little noise: rows within this share of the top, so many, of so many classes of
#: incidence (5 degrees), and a fifth of them at most in the next two such steps.
NEARLY, NEARLY_FEWEST, NEARLY_INCIDENCES = 4e-3, 6, 2
#: A plateau lies above the typical reading by this factor; at it the whole sample is flat.
ABOVE_TYPICAL = 1.03
#: Where the plateau is lower than this many bodies, what is left shows no highlight.
HIGHLIGHT_LEFT = 3.0
#: Floors are low, and hold more than this share of a band's rows.
HIGHEST_FLOOR, FLOOR_SHARE = 0.15, 0.02


def saturation(measurement: Measurement, rows: Rows) -> tuple[Measurement, list[Finding]]:
    """The measurement with the rows on a plateau marked, and a finding that names it."""
    if len(rows) < 2 * FEWEST:
        return measurement, []
    level, marked, bands = _top(measurement, rows)
    if not np.any(marked):
        return measurement, []
    reasons = measurement.reasons.copy()
    reasons[rows.index[marked]] = SATURATED
    body = rows.body_level
    left = rows.level[~marked & rows.kept]
    hidden = float(np.max(left, initial=0.0)) < HIGHLIGHT_LEFT * body
    count = int(np.sum(marked))
    which = "" if len(bands) == measurement.bands.count else f" in {_some(bands)}"
    text = (
        f"{count} rows stand at the largest value {level:.6g}{which} (as radiance factor): the "
        "detector saturates there, and they are left out; declare its level with '# saturation: "
        "LEVEL', in the unit of the file"
    )
    if hidden:
        text += ". Hardly any of the highlight is left: measure it again with less light"
    changed = replace(measurement, reasons=reasons)
    return changed, [Finding(PLATEAU, text, hidden)]


def floors(measurement: Measurement, rows: Rows) -> list[Finding]:
    """A finding where readings were cut off from below."""
    # Published tables hold zeros where a colour lies outside their channels.
    values = rows.values[rows.kept]
    if measurement.tabulated or len(values) < 4 * FEWEST:
        return []
    lowest = values.min(axis=0)
    floor = float(lowest.min())
    typical = float(np.median(values))
    # An ideal matte sample is as low everywhere, but not equally low in several bands.
    same = np.abs(lowest - floor) <= SAME * max(abs(floor), 1e-9)
    at = np.abs(values - floor) <= SAME * max(abs(floor), 1e-9)
    counts = at.sum(axis=0)
    if floor > HIGHEST_FLOOR or np.max(counts) < max(FEWEST, FLOOR_SHARE * len(values)):
        return []
    several = np.sum(same & (counts >= FEWEST)) >= 2
    unlike = several and bool(np.any(at[:, same].any(axis=1) & ~at[:, same].all(axis=1)))
    if not (unlike or (floor == 0.0 and typical > 0.0)):
        return []
    bands = [measurement.bands.labels[k] for k in np.flatnonzero(counts >= FEWEST)]
    share = float(at.any(axis=1).mean())
    return [
        Finding(
            FLOOR,
            f"{share:.0%} of the rows stand at the smallest value {floor:.4g} in {_some(bands)}: "
            "readings were cut off there, and darker ones are not known; export the table without "
            "a lower limit",
            False,
        )
    ]


def _top(measurement: Measurement, rows: Rows) -> tuple[float, Mask, list[str]]:
    """Level of the plateau, the rows on it, and the bands that have it."""
    unlike: Ints | None = None
    marked = np.zeros(len(rows), dtype=bool)
    bands: list[str] = []
    level = 0.0
    for divisor in (np.ones(len(rows)), 1.0 / np.maximum(rows.to_receiver[:, 2], 1e-3)):
        values = rows.values / divisor[:, None]
        for band in range(values.shape[1]):
            column = values[:, band]
            top = float(column.max())
            at = column >= top * (1.0 - SAME)
            if np.sum(at) >= FEWEST and unlike is None:
                unlike = _unlike(rows)
            turned = np.ptp(divisor[at]) > 1e-3 or np.ptp(divisor) == 0.0
            if unlike is None or not turned or not _piled(column, at, top, unlike):
                at = column >= top * (1.0 - NEARLY)
                if not _level_at_all_incidences(column, at, top, rows):
                    continue
                at = column >= top * (1.0 - 2.0 * NEARLY)
            marked |= at
            bands.append(measurement.bands.labels[band])
            level = max(level, top)
        if bands:
            break
    return level, marked, bands


def _level_at_all_incidences(column: Array, at: Mask, top: float, rows: Rows) -> bool:
    """Whether peaks of several incidences are equally high, which no sample's are (Fresnel)."""
    if np.sum(at) < NEARLY_FEWEST or top < HIGHLIGHT_LEFT * float(np.median(column)):
        return False
    below = (column < top * (1.0 - 2.0 * NEARLY)) & (column > top * (1.0 - 4.0 * NEARLY))
    if np.sum(below) > np.sum(at) // 5:
        return False
    return len(np.unique(np.round(rows.incidence_deg[at] / 5.0))) >= NEARLY_INCIDENCES


def _piled(column: Array, at: Mask, top: float, unlike: Ints) -> bool:
    """Whether more rows of unlike geometries stand at the top than their density lets expect."""
    count = len(np.unique(unlike[at]))
    if count < FEWEST or top <= ABOVE_TYPICAL * float(np.median(column)):
        return False
    distinct = np.unique(np.round(column[~at] / top, 6))[-STEPS_BELOW:]
    if len(distinct) == 0:
        return True
    # Values that few digits leave coincide: as many at the next ones are no plateau.
    step = float(np.min(np.diff(np.append(distinct, 1.0))))
    next_most = max(
        len(np.unique(unlike[np.abs(column / top - value) < 1e-6])) for value in distinct[-3:]
    )
    return count >= max(FEWEST + (ROUNDED_MORE if step > ROUNDED else 0), TIMES_NEXT * next_most)


def _unlike(rows: Rows) -> Ints:
    """(N,), equal numbers where an isotropic, reciprocal surface must read the same."""
    pair = np.sort(np.stack([rows.to_lamp[:, 2], rows.to_receiver[:, 2]], axis=1), axis=1)
    between = np.sum(rows.to_lamp * rows.to_receiver, axis=1)
    key = np.round(np.column_stack([pair, between]), 4)
    return np.asarray(np.unique(key, axis=0, return_inverse=True)[1].ravel())


def _some(names: list[str]) -> str:
    if len(names) <= 4:
        return ", ".join(names)
    return f"{', '.join(names[:3])} and {len(names) - 3} more bands"
