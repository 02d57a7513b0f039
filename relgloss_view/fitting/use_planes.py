"""The light that a fit explains: over all samples, near the mirror direction, plane by plane.

Medians over samples let a highlight go that lies in fewer than half of them. Here light counts as
much as there is of it: the error of some samples is the sum of their differences over the sum of
their measured light. A plane that is off by more than the others is named; how much the others
differ among themselves decides what is "more".
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.fitting.departure import METER, TO_SD, Departures, near
from relgloss_view.fitting.results import PlaneUse, TailUse
from relgloss_view.fitting.verdict import NEAR_MIRROR_DEG

#: A plane is named where its offset from the median plane is this many times the planes' spread,
#: and more where few planes give the spread (by 4 over their number) ...
NAMED_SPREADS, FEW_PLANES = 5.0, 4.0
#: ... and at least this share: less is in no picture.
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
        p90=float(np.percentile(relative, 90.0)),
        p99=float(np.percentile(relative, 99.0)),
        mirror_p90=float(np.percentile(relative[mirror], 90.0)) if some else None,
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
        middle = float(np.median(log_ratio))
        error = TO_SD * float(np.median(np.abs(log_ratio - middle))) / np.sqrt(np.sum(own))
        shines = own & mirror
        rows.append(
            (
                float(np.min(samples.incidence[own])),
                int(np.sum(own)),
                middle,
                error,
                _light_error(samples, shines) if np.any(shines) else None,
            )
        )
    if not rows:
        return ()
    offsets, errors = np.array([row[2] for row in rows]), np.array([row[3] for row in rows])
    centre = float(np.median(offsets))
    spread = TO_SD * float(np.median(np.abs(offsets - centre)))
    spreads = NAMED_SPREADS * (1.0 + FEW_PLANES / len(rows))
    allowed = np.maximum(spreads * np.hypot(spread, errors), NAMED_SHARE)
    named = (np.abs(offsets - centre) > allowed) & (len(rows) >= FEWEST_PLANES)
    uses = [
        PlaneUse(incidence, count, float(np.expm1(middle)), mirror_error, bool(name))
        for (incidence, count, middle, _, mirror_error), name in zip(rows, named, strict=True)
    ]
    return tuple(sorted(uses, key=lambda use: use.incidence_deg))


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
