"""The light that a fit explains: over all samples, near the mirror direction, plane by plane.

Medians over samples let a highlight go that lies in fewer than half of them. Here light counts as
much as there is of it: the error of some samples is the sum of their differences over the sum of
their measured light. A plane that is off by more than the others is named; how much the others
differ among themselves decides what is "more".
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.fitting.departure import METER, Departures, near
from relgloss_view.fitting.results import PlaneUse, TailUse
from relgloss_view.fitting.verdict import NEAR_MIRROR_DEG
from relgloss_view.measure.thinning import percentile

#: Student's t of a share of 0.01, two-sided, over as many planes as there are: a plane that is
#: farther from the mean of the others, in their own sd, is named where it is off by ...
FREEDOM = (2, 3, 4, 6, 8, 13, 30)
STUDENT = (19.96, 10.21, 7.53, 5.71, 5.04, 4.44, 4.07)
#: ... at least this share: less is in no picture.
NAMED_SHARE = 0.05
#: A table whose plane is off by this share is not described by any fit.
POOR_PLANE = 0.12
FEWEST_SAMPLES, FEWEST_PLANES = 4, 4  #: of a plane that is judged; of planes to judge it by
#: Share of the light near the mirror direction that a good fit may miss: of all, of a plane.
POOR_MIRROR, POOR_PLANE_MIRROR = 0.15, 0.30


def tail_use(samples: Departures) -> TailUse:
    """The share of light that is explained, and the tail of the errors."""
    relative = np.abs(np.expm1(-samples.log_ratio[:, METER]))
    mirror = near(samples, NEAR_MIRROR_DEG)
    some = bool(np.any(mirror))
    return TailUse(
        explained=1.0 - _light_error(samples, np.ones_like(mirror)),
        mirror_explained=1.0 - _light_error(samples, mirror) if some else None,
        p90=percentile(relative, 90.0, samples.counts),
        p99=percentile(relative, 99.0, samples.counts),
        mirror_p90=percentile(relative[mirror], 90.0, samples.counted(mirror)) if some else None,
    )


def plane_uses(samples: Departures) -> tuple[PlaneUse, ...]:
    """One row for each plane of incidence with enough samples, by angle of incidence."""
    mirror = near(samples, NEAR_MIRROR_DEG)
    rows = []
    for k in range(int(np.max(samples.group)) + 1):
        own = samples.group == k
        if np.sum(own) < FEWEST_SAMPLES:
            continue
        log_ratio = samples.log_ratio[own, METER]
        middle = percentile(log_ratio, 50.0, samples.counted(own))
        shines = own & mirror
        rows.append(
            (
                float(np.min(samples.incidence[own])),
                int(np.sum(own)),
                middle,
                _light_error(samples, shines) if np.any(shines) else None,
            )
        )
    if not rows:
        return ()
    named = _outliers(np.array([row[2] for row in rows]))
    uses = [
        PlaneUse(incidence, count, float(np.expm1(middle)), mirror_error, bool(name))
        for (incidence, count, middle, mirror_error), name in zip(rows, named, strict=True)
    ]
    return tuple(sorted(uses, key=lambda use: use.incidence_deg))


def _outliers(offsets: Array) -> Mask:
    """Which planes are off by more than the others let expect (Rosner 1983, generalised ESD).

    The farthest from the mean is set aside, again and again, up to a quarter of the planes; each is
    compared with those that are left, so that two do not hide one another.
    """
    named = np.zeros(len(offsets), dtype=bool)
    left = np.ones(len(offsets), dtype=bool)
    aside: list[int] = []
    for _ in range(max(len(offsets) // 4, 1) if len(offsets) >= FEWEST_PLANES else 0):
        distance = np.where(left, np.abs(offsets - np.mean(offsets[left])), -1.0)
        farthest = int(np.argmax(distance))
        left[farthest] = False
        aside.append(farthest)
        rest = offsets[left]
        off = abs(float(offsets[farthest] - np.mean(rest)))
        sd = float(np.std(rest, ddof=1)) * np.sqrt(1.0 + 1.0 / len(rest))
        if off > max(sd * np.interp(len(rest) - 1, FREEDOM, STUDENT), NAMED_SHARE):
            named[aside] = True
    return named


def _light_error(samples: Departures, rows: Mask) -> float:
    """Differences over measured light, at least 0 (cosine weights: Ngan, Durand, Matusik 2005)."""
    cosines = samples.cosines[rows]
    measured: Array = np.maximum(samples.measured[rows], 0.0)
    total = float(np.sum(cosines * measured))
    if total <= 0.0:
        return 0.0
    return float(np.sum(cosines * np.abs(samples.fitted[rows] - measured))) / total


def plane_words(planes: tuple[PlaneUse, ...]) -> tuple[str, ...]:
    """One line for each plane that is named."""
    others = [use.offset for use in planes if not use.named]
    if not others:
        return ()
    spread = max(abs(offset) for offset in others)
    lines = []
    for use in planes:
        if use.named:
            side = "more" if use.offset > 0.0 else "less"
            lines.append(
                f"the plane at incidence {use.incidence_deg:.0f} deg reads {abs(use.offset):.0%} "
                f"{side} than the fit; the others agree within {max(spread, 0.01):.0%}: measure "
                "that plane again, or leave it out"
            )
    return tuple(lines)
