"""Rows that do not belong: spikes, and rows of another sample."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.measure.findings.finding import ROWS, Finding
from relgloss_view.measure.findings.lobe import Lobe
from relgloss_view.measure.findings.rows import BODY_DEG, MOST_ROWS, Rows

#: A row stands apart where its level is off by this factor and this many robust deviations.
APART, DEVIATIONS = 0.3, 6.0
#: Its colour is another where it is off by this much.
OTHER_COLOUR = 0.10
#: Scatter of the body about any smooth function for which the table is of more than one sample.
SCATTER = 0.15
FEWEST_ROWS, FEWEST_APART = 30, 3
#: Shares of rows apart that are named, and serious.
NAMED, SERIOUS = 0.01, 0.08


def check(rows: Rows, lobe: Lobe | None, *, lamp_peak: bool = False) -> list[Finding]:
    """A finding where readings of the body stand apart from their neighbours.

    lamp_peak: whether the sample sends light back to the lamp, so that rows near it stand apart.
    """
    beyond = BODY_DEG if lobe is None else max(BODY_DEG, 4.0 * lobe.width_deg)
    away = rows.kept & (rows.delta_deg > beyond) & (rows.phase_deg > (45.0 if lamp_peak else 12.0))
    away &= np.minimum(rows.to_lamp[:, 2], rows.to_receiver[:, 2]) > 0.25
    if np.sum(away) < FEWEST_ROWS:
        return []
    body = rows.subset(away)
    rest = _rest(body)
    spread = 1.4826 * float(np.median(np.abs(rest - np.median(rest))))
    colour = body.values / body.level[:, None]
    typical = np.maximum(np.median(colour, axis=0), 0.02)
    turned = np.sqrt(np.mean(np.square(colour - typical), axis=1))
    other = turned > OTHER_COLOUR + DEVIATIONS * float(np.median(turned))
    limit = max(APART, DEVIATIONS * spread)
    high, low = rest > limit, rest < -limit
    apart = high | low | other
    count, share = int(np.sum(apart)), float(np.mean(apart))
    if spread > SCATTER:
        return [
            Finding(
                ROWS,
                f"readings of the body scatter by {spread:.0%} about any smooth function of the "
                "angles: are rows of two samples mixed? Measure it again, or part the table",
                True,
            )
        ]
    if count < FEWEST_APART or share < NAMED:
        return []
    worst = int(np.argmax(np.where(apart, np.abs(rest) + turned, -1.0)))
    place = (
        f"lamp at {body.lamp_deg[worst]:.0f} deg, receiver at {body.receiver_deg[worst]:.0f} deg"
    )
    if np.sum(high & ~other) > 0.8 * count:
        text = (
            f"{count} single rows are spikes, up to {np.exp(rest[worst]):.1f} times their "
            f"neighbours ({place}): dust or glints? Leave them out or measure them again"
        )
    else:
        text = (
            f"{count} rows ({share:.0%} of those that show the body) stand apart from their "
            f"neighbours in level or colour ({place}): are rows of two samples mixed? Leave them "
            "out or measure them again"
        )
    return [Finding(ROWS, text, share > SERIOUS)]


def _rest(rows: Rows) -> Array:
    """(N,), logarithms of the level about a smooth function of the angles, by a robust fit."""
    log_i, log_o = (np.log(np.clip(d[:, 2], 0.05, 1.0)) for d in (rows.to_lamp, rows.to_receiver))
    between = np.sum(rows.to_lamp * rows.to_receiver, axis=1)
    tail = 1.0 / (1.0 + np.square(rows.delta_deg / 15.0))
    basis = np.column_stack(
        [np.ones(len(rows)), log_i, log_o, log_i * log_o, (log_i + log_o) ** 2, between,
         between**2, between * (log_i + log_o), tail, tail * (log_i + log_o)]
    )  # fmt: skip
    y = np.log(rows.level)
    some = slice(None, None, max(len(y) // MOST_ROWS, 1))  # a few thousand show a smooth function
    rest = y - np.median(y)
    for _ in range(8):
        spread = max(1.4826 * float(np.median(np.abs(rest))), 0.01)
        weight = 1.0 / (1.0 + np.square(rest / (2.0 * spread)))
        scaled = basis[some] * weight[some, None]
        rest = y - basis @ np.linalg.lstsq(scaled, (y * weight)[some], rcond=1e-9)[0]
    return np.asarray(rest)
