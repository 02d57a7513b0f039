"""Where the mirror direction is: the peak of the readings against the geometry of the table.

Under the right geometry the readings depend on the half-vector's angle from the normal nearly
alone. So the rows are put in the order of that angle, once for the geometry as declared and once
for each other convention; neighbours in the right order read alike. How unlike they are is the
mean square of successive differences (von Neumann 1941). And the rows nearest to the right mirror
direction hold the peak.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.measure import ridge
from relgloss_view.measure.findings.finding import MIRROR, Finding
from relgloss_view.measure.findings.rows import Rows, facet_density
from relgloss_view.measure.gonio import from_normal
from relgloss_view.measure.table import Measurement

#: The peak must exceed the body by this factor, or the order of the rows is that of noise.
PEAK = 2.2
STEEPEST_COSINE = 0.34  #: closer to the horizon rough bodies brighten towards the lamp
#: Another geometry is named where neighbours are this many times less unlike than as declared, and
#: where the rows nearest to its mirror direction show this share of the highest density, and more
#: than as declared. Where they show nearly none as declared, the order of the rest matters less.
CLEARLY, SURELY = 1.5, 0.7
SHOWN, SURELY_SHOWN, NOT_SHOWN = 0.3, 0.45, 0.1
FEWEST, FEWEST_NEAREST = 10, 5
#: Near the mirror direction and far from it, degrees; how much brighter far rows must be.
NEAR_DEG, FAR_DEG, BRIGHTER = 4.0, 12.0, 4.0
FEWEST_TOPS, MOST_TOPS = 2, 0.15  #: rows, and share of all: more are those of a wide lobe
TURN_STEP_DEG = 15.0
RIDGE = "the mirror ridge lies at gamma"
SAME_SIDE = "--mirror same-side"


@dataclass(frozen=True)
class _Geometry:
    """Another reading of the table's angles."""

    name: str  #: "same side", "turned" or "tilted"
    to_lamp: Array
    to_receiver: Array
    amount_deg: float = 0.0


def check(measurement: Measurement, rows: Rows) -> list[Finding]:
    """A serious finding where the peak lies elsewhere than the declared geometry puts it."""
    some = rows.subset(np.minimum(rows.to_lamp[:, 2], rows.to_receiver[:, 2]) > STEEPEST_COSINE)
    if len(some) >= FEWEST and float(np.max(some.level)) > PEAK * some.low_level:
        best = _best(measurement, some.thinned())
    else:
        best = None
    if best is not None:
        return [Finding(MIRROR, _words(measurement, some, best), True)]
    told = [w for w in measurement.warnings if w.startswith(RIDGE)]
    elsewhere = told[0] if told else _ridge(measurement, rows)
    if elsewhere is None:
        elsewhere = _bright_elsewhere(some)
    return [] if elsewhere is None else [Finding(MIRROR, elsewhere, True)]


def without_other_remedy(measurement: Measurement, named: Finding) -> Measurement:
    """The measurement without a reader's warning of a ridge where the cause is another."""
    warnings = tuple(w for w in measurement.warnings if not w.startswith(RIDGE) or w == named.text)
    return replace(measurement, warnings=warnings)


def _best(measurement: Measurement, rows: Rows) -> _Geometry | None:
    """The other geometry in which the rows lie clearly better than as declared, or None."""
    declared = _unlikeness(rows, rows.to_lamp, rows.to_receiver)
    shown = _shown(rows, rows.to_lamp, rows.to_receiver)
    best, least = None, np.inf
    for other in _others(measurement, rows):
        geometry = other.to_lamp, other.to_receiver
        turned = other.name == "same side" and abs(other.amount_deg) in (0.0, 180.0)
        tops = turned and _tops(rows, *geometry)
        shows = _shown(rows, *geometry)
        if not tops and shows < max(SHOWN, shown + SHOWN):
            continue
        unlike = _unlikeness(rows, *geometry)
        if tops and unlike < declared:
            return other
        gain = CLEARLY if shown > NOT_SHOWN or shows < SURELY_SHOWN else SURELY
        if shows >= max(SHOWN, shown + SHOWN) and unlike * gain <= declared and unlike < least:
            best, least = other, unlike
    return best


def _unlikeness(rows: Rows, to_lamp: Array, to_receiver: Array) -> float:
    """Mean square difference of neighbours in the order of the half-vector's angle."""
    body = rows.low_level
    density = facet_density(np.maximum(rows.level - body, 0.0), to_lamp, to_receiver)
    floor = float(facet_density(np.array([0.3 * body]), *_upright())[0])
    order = np.argsort(_angle(to_lamp, to_receiver), kind="stable")
    return float(np.mean(np.square(np.diff(np.log(density[order] + floor)))))


def _shown(rows: Rows, to_lamp: Array, to_receiver: Array) -> float:
    """Density of facets in the rows nearest to the mirror direction, as a share of the highest."""
    density = facet_density(rows.level - rows.low_level, to_lamp, to_receiver)
    nearest = max(FEWEST_NEAREST, len(rows) // 50)
    rows_near = np.argsort(_angle(to_lamp, to_receiver), kind="stable")[:nearest]
    highest = float(np.partition(density, -2)[-2])
    return float(np.median(density[rows_near])) / max(highest, 1e-12)


def _angle(to_lamp: Array, to_receiver: Array) -> Array:
    """(N,), increasing with the angle between half-vector and normal: its tangent squared."""
    total = to_lamp + to_receiver
    return np.asarray((total[:, 0] ** 2 + total[:, 1] ** 2) / np.maximum(total[:, 2], 1e-9) ** 2)


def _tops(rows: Rows, to_lamp: Array, to_receiver: Array) -> bool:
    """Whether the brightest rows, far from the declared mirror direction, lie at another.

    On a coarse grid few rows see a narrow highlight: these alone show where it is.
    """
    clear = rows.level > BRIGHTER * rows.low_level
    top = np.argsort(np.where(clear, rows.facets, -np.inf))[-FEWEST_TOPS:]
    few = FEWEST_TOPS <= np.sum(clear) < MOST_TOPS * len(rows)
    if not few or np.min(rows.delta_deg[top]) < FAR_DEG:
        return False
    return bool(np.max(from_normal((to_lamp + to_receiver)[top])) < NEAR_DEG)


def _upright() -> tuple[Array, Array]:
    up = np.array([[0.0, 0.0, 1.0]])
    return up, up


def _others(measurement: Measurement, rows: Rows) -> Iterator[_Geometry]:
    lamp, receiver = rows.to_lamp, rows.to_receiver
    if measurement.gamma_s_deg is None:
        turns = np.arange(TURN_STEP_DEG, 359.0, TURN_STEP_DEG)
        out_of_plane = np.max(np.abs(lamp[:, 0] * receiver[:, 1] - lamp[:, 1] * receiver[:, 0]))
        if out_of_plane < 1e-3:
            turns = np.array([180.0])
        for t in turns:
            name = "same side" if t == 180.0 else "turned"
            yield _Geometry(name, lamp, _turned(receiver, t), float(t))
        return
    yield _Geometry("same side", lamp, receiver * np.array([-1.0, 1.0, 1.0]))
    tilts = np.unique(np.round(np.degrees(np.arctan2(-lamp[:, 1], lamp[:, 2])), 3))
    shifts = tilts[np.abs(tilts) > 0.5] if len(tilts) > 1 else ()
    for shift in shifts:
        back = _about_x(-shift)
        tilted = lamp @ back, receiver @ back
        flipped = tilted[1] * np.array([-1.0, 1.0, 1.0])
        yield _Geometry("tilted", *tilted, float(shift))
        yield _Geometry("same side", tilted[0], flipped, float(shift))


def _about_x(degrees: float) -> Array:
    """Matrix by which rows of vectors are multiplied to tilt them (measure.gonio)."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]])


def _turned(v: Array, degrees: float) -> Array:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.asarray(v @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]))


def _words(measurement: Measurement, rows: Rows, best: _Geometry) -> str:
    top = int(np.argmax(rows.facets))
    lamp_deg, receiver_deg = rows.lamp_deg[top], rows.receiver_deg[top]
    gamma_s = measurement.gamma_s_deg
    if best.name == "same side":
        tilt = ""
        if gamma_s is not None and best.amount_deg:
            tilt = f" and --gamma-s-deg {gamma_s + best.amount_deg:g}"
        where = (
            "at the lamp's azimuth (phi_r = phi_i)"
            if gamma_s is None
            else "at beta = +alpha, not at beta = -alpha"
        )
        return (
            f"the peak lies on the lamp's side, {where}: the receiver is counted to the other "
            f"side; give {SAME_SIDE}{tilt} or add '# mirror: same-side' (or the sample sends light "
            "back to the lamp)"
        )
    if best.name == "tilted":
        there = (gamma_s or 0.0) + best.amount_deg
        return (
            f"{RIDGE} = {there:g} deg (the nearest tilt in the table), not at gamma_s = "
            f"{gamma_s:g} deg: give --gamma-s-deg {there:g} or check the table"
        )
    offset = (best.amount_deg + 180.0) % 360.0 - 180.0
    return (
        f"the peak lies about {abs(offset):.0f} deg in azimuth from the mirror direction "
        f"(brightest row: lamp at {lamp_deg:.0f} deg, receiver at {receiver_deg:.0f} deg "
        f"from the normal): add {offset:+.0f} to every phi_r_deg, or check the azimuths"
    )


def _bright_elsewhere(rows: Rows) -> str | None:
    """Bright rows far from the mirror direction, brighter than all that lie near it."""
    if len(rows) < FEWEST:
        return None
    near, far = rows.delta_deg < NEAR_DEG, rows.delta_deg > FAR_DEG
    # Rows towards the lamp may be bright by retroreflection, which is looked for by itself.
    far &= rows.phase_deg > FAR_DEG
    if np.sum(near) < FEWEST_NEAREST or np.sum(far) < FEWEST:
        return None
    top = int(np.argmax(np.where(far, rows.level, 0.0)))
    second = float(np.sort(rows.level[far])[-2])
    least = max(float(np.max(rows.level[near])), rows.low_level)
    if second < BRIGHTER * least:
        return None
    lamp_deg, receiver_deg = rows.lamp_deg[top], rows.receiver_deg[top]
    return (
        f"the brightest rows lie {rows.delta_deg[top]:.0f} deg from the mirror direction (lamp at "
        f"{lamp_deg:.0f} deg, receiver at {receiver_deg:.0f} deg from the normal), and none near "
        "it is bright: check the azimuths and the signs of the angles"
    )


def _ridge(measurement: Measurement, rows: Rows) -> str | None:
    """The ridge over the tilts of a GCMS table, by its mirror rows (measure.ridge)."""
    gamma_s = measurement.gamma_s_deg
    if gamma_s is None:
        return None
    lamp, receiver = rows.to_lamp[rows.kept], rows.to_receiver[rows.kept]
    angles = np.stack(
        [
            np.round(np.degrees(np.arcsin(np.clip(lamp[:, 0], -1.0, 1.0))), 6),
            np.round(np.degrees(np.arcsin(np.clip(receiver[:, 0], -1.0, 1.0))), 6),
            np.round(np.degrees(np.arctan2(-lamp[:, 1], lamp[:, 2])) + gamma_s, 6),
        ],
        axis=1,
    )
    return ridge.check(angles, rows.level[rows.kept], gamma_s)
