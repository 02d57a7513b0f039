"""A peak towards the lamp, as beads, cat's eyes and some pigments send light back."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.measure.findings.finding import LAMP_PEAK, Finding
from relgloss_view.measure.findings.rows import Rows

#: Rough bodies brighten towards the lamp too, but over tens of degrees (Oren, Nayar 1995); a peak
#: of retroreflection is narrower. Deviations that are tried, degrees.
WIDTHS_DEG = (2.0, 3.5, 6.0, 10.0)
NEAR_DEG, FAR_DEG = 25.0, 100.0
#: Half-vectors near the normal show the highlight, which lies beside the lamp at small incidence.
LEAST_DELTA_DEG = 14.0
#: Height above the body, in bodies, that is named; and how many standard errors it must have.
HEIGHT, ERRORS = 0.15, 7.0
FEWEST = 3


def check(rows: Rows) -> list[Finding]:
    """A finding where readings rise in a narrow peak around the lamp's direction."""
    body = rows.body_level
    use = (rows.delta_deg > LEAST_DELTA_DEG) & (rows.phase_deg < FAR_DEG)
    use &= np.minimum(rows.to_lamp[:, 2], rows.to_receiver[:, 2]) > 0.2
    some = rows.subset(use)
    if np.sum(some.phase_deg < 2.0 * WIDTHS_DEG[-1]) < FEWEST or len(some) < 4 * FEWEST:
        return []
    y = some.level / body
    cosines = np.log(some.to_lamp[:, 2] * some.to_receiver[:, 2])
    phase = np.radians(some.phase_deg)
    tails = 1.0 / (1.0 + np.square(some.delta_deg / 10.0))
    # A rough body's brightening: smooth in the angle to the lamp, steeper at grazing angles.
    smooth = [np.ones(len(some)), cosines, cosines * np.cos(phase), np.cos(phase), np.sin(phase),
              np.cos(2.0 * phase), tails, tails * cosines]  # fmt: skip
    best = (0.0, 0.0, 0.0)
    for width in WIDTHS_DEG:
        peak = np.exp(-0.5 * np.square(some.phase_deg / width))
        if np.sum(peak > 0.3) < FEWEST:
            continue
        height, error = _height(np.column_stack([*smooth, peak]), y)
        if height / error > best[1]:
            best = (height, height / error, width)
    height, errors, width = best
    if height < HEIGHT or errors < ERRORS:
        return []
    between_arms = ", where the arms are near each other," if not np.all(some.kept) else ""
    return [
        Finding(
            LAMP_PEAK,
            f"the sample sends light back to the lamp: within about {width:g} deg of the lamp's "
            f"direction{between_arms} readings rise by {height:.2g} times the body. No model has "
            "retroreflection: pictures with the lamp behind the viewer are too dark",
            False,
        )
    ]


def _height(basis: Array, y: Array) -> tuple[float, float]:
    """The last coefficient of a robust fit of relative values, and its standard error."""
    scale = 1.0 / np.maximum(y, 0.3)
    last = basis[:, -1] > 0.05
    weight: Array = np.ones(len(y))
    height, error = 0.0, 1.0
    for _ in range(4):
        weighted = basis * (weight * scale)[:, None]
        normal = weighted.T @ weighted
        inverse = np.linalg.pinv(normal, rcond=1e-12, hermitian=True)
        solution = inverse @ (weighted.T @ (y * weight * scale))
        residual = (y - basis @ solution) * scale
        spread = max(1.4826 * float(np.median(np.abs(residual))), 0.01)
        # Rows of the peak keep their weight: they are what is looked for.
        weight = np.where(last, 1.0, 1.0 / np.sqrt(1.0 + np.square(residual / spread)))
        spread = max(spread, float(np.std(residual[last])))
        height, error = float(solution[-1]), spread * float(np.sqrt(max(inverse[-1, -1], 0.0)))
    return height, max(error, 1e-6)
