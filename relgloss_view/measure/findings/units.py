"""Units: angles that are radians, values that can be no radiance factors, a cosine left in."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.measure.findings.finding import UNITS, Finding
from relgloss_view.measure.findings.rows import BODY_DEG, Rows
from relgloss_view.measure.screening import percent_warning
from relgloss_view.measure.table import Measurement

#: pi / 2: no direction above the horizon is further from the normal in radians.
MOST_RADIANS = 1.6
#: A body that sends back more than a perfect diffuser is bright by fluorescence up to about this.
MOST_BODY = 1.25
#: A power of the receiver's cosine that is named, and how many standard errors it must have.
COSINE_POWER, ERRORS = 0.25, 6.0
MOST_REST = 0.15  #: scatter about smooth functions of the angles beyond which nothing is said
FEWEST = 12


def radians(measurement: Measurement, rows: Rows) -> list[Finding]:
    """A serious finding where the angles must be radians."""
    return _serious(_radians(measurement, rows)) if len(rows) else []


def values(measurement: Measurement, rows: Rows) -> list[Finding]:
    """Serious findings where the values can't be radiance factors.

    The geometry is taken as right: rows away from the mirror direction show the body.
    """
    if not len(rows):
        return []
    level = _level(measurement, rows)
    return _serious(level, None if measurement.tabulated or level else _cosine(rows))


def _serious(*texts: str | None) -> list[Finding]:
    return [Finding(UNITS, text, True) for text in texts if text]


def _radians(measurement: Measurement, rows: Rows) -> str | None:
    largest = float(max(rows.lamp_deg.max(), rows.receiver_deg.max()))
    if measurement.gamma_s_deg is not None:
        largest = float(np.degrees(np.arcsin(np.abs(rows.to_lamp[:, 0]).max(initial=0.0))))
        other = np.degrees(np.arcsin(np.abs(rows.to_receiver[:, 0]).max(initial=0.0)))
        largest = max(largest, float(other))
    if not 0.0 < largest < MOST_RADIANS or len(np.unique(np.round(rows.delta_deg, 4))) < 3:
        return None
    return (
        f"all angles lie below {MOST_RADIANS:g}: are they radians? The columns hold degrees; "
        "convert the angles"
    )


def _level(measurement: Measurement, rows: Rows) -> str | None:
    arrays = rows.to_lamp, rows.to_receiver, rows.values, rows.kept
    percent = percent_warning(*arrays)
    if percent is not None:
        return percent
    away = rows.kept & (rows.delta_deg > BODY_DEG) & (rows.phase_deg > BODY_DEG)
    away &= np.minimum(rows.to_lamp[:, 2], rows.to_receiver[:, 2]) > 0.4
    if np.sum(away) < FEWEST:
        return None
    body = float(np.median(np.median(rows.values[away], axis=0)))
    if body <= MOST_BODY:
        return None
    return (
        f"away from the mirror direction the sample sends back {body:.2f} times the light of a "
        "perfect diffuser: are the values radiance factors that are declared as BRDF (a factor of "
        "pi)? Give the right --quantity"
    )


def _cosine(rows: Rows) -> str | None:
    """The power of the receiver's cosine that exchanging lamp and receiver shows to be left in.

    A body is reciprocal (Helmholtz), so the logarithm of its level depends on symmetric functions
    of both cosines; a part that changes its sign with their exchange is a cosine left in.
    """
    away = rows.kept & (rows.delta_deg > BODY_DEG) & (rows.level < 2.0 * rows.body_level)
    away &= rows.phase_deg > 12.0
    if np.sum(away) < 2 * FEWEST:
        return None
    some = rows.subset(away)
    log_i, log_o = (np.log(np.clip(d[:, 2], 0.05, 1.0)) for d in (some.to_lamp, some.to_receiver))
    if np.std(log_o - log_i) < 0.1:
        return None
    between = np.sum(some.to_lamp * some.to_receiver, axis=1)
    total = log_i + log_o
    basis = np.column_stack(
        [np.ones(len(some)), total, total**2, between, between**2, some.delta_deg / 50.0,
         (log_o - log_i) ** 2, log_o - log_i]
    )  # fmt: skip
    power, error, rest = last_slope(basis, np.log(some.level), some)
    if rest > MOST_REST:
        return None
    power *= 2.0
    error *= 2.0
    if abs(power) < COSINE_POWER or abs(power) < ERRORS * error:
        return None
    if power > 0.0:
        return (
            f"the body falls with the cosine of the receiver's angle (as its power {power:.2f}), "
            "and the sample is not the same with lamp and receiver exchanged: a cosine is left in, "
            "or the lamp drifted between planes; give --quantity brdf-cos if the values are BRDFs "
            "times that cosine"
        )
    return (
        f"the body grows towards grazing receivers (as the cosine's power {power:.2f}), and the "
        "sample is not the same with lamp and receiver exchanged: a cosine was divided out "
        "twice, or the lamp drifted between planes; check --quantity"
    )


def last_slope(basis: Array, y: Array, rows: Rows) -> tuple[float, float, float]:
    """The last coefficient of a robust fit, its error with rows of a group as one, the spread."""
    weight: Array = np.ones(len(y))
    solution: Array = np.zeros(basis.shape[1])
    residual = y
    for _ in range(4):
        solution = np.asarray(
            np.linalg.lstsq(basis * weight[:, None], y * weight, rcond=1e-9)[0], dtype=np.float64
        )
        residual = y - basis @ solution
        spread = max(1.4826 * float(np.median(np.abs(residual))), 1e-4)
        weight = np.asarray(1.0 / np.sqrt(1.0 + np.square(residual / (2.0 * spread))))
    inverse = np.linalg.pinv((basis * weight[:, None]).T @ (basis * weight[:, None]), rcond=1e-9)
    influence = basis * np.square(weight)[:, None] * residual[:, None]
    names, number = np.unique(rows.group, return_inverse=True)
    sums = np.zeros((len(names), basis.shape[1]))
    np.add.at(sums, number, influence)
    covariance = inverse @ (sums.T @ sums + influence.T @ influence) @ inverse
    error = float(np.sqrt(max(covariance[-1, -1], 0.0)))
    return float(solution[-1]), error, float(np.std(residual))
