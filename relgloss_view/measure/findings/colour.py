"""Colour that turns with the angle: spectra that no body under a highlight of one colour sends.

The light of a sample is a sum, with weights of at least zero, of the body's spectrum, the same
squared (interreflection; Oren, Nayar 1995), white, and the highlight's spectrum, which turns white
towards grazing incidence (Fresnel; form of Schlick 1994). What is left over is measured for each
row; where many rows of one incidence leave much, their colour turns.
"""

from __future__ import annotations

import itertools

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.findings.finding import COLOUR, Finding
from relgloss_view.measure.findings.rows import BODY_DEG, Rows
from relgloss_view.measure.table import Measurement

#: What may be left over, relative to a row's mean: noise, dispersion of the index, lamp colour.
LEFT_OVER = 0.06
#: Width of the classes of incidence, degrees, and rows a class must have.
CLASS_DEG, FEWEST = 10.0, 4
#: A highlight exceeds the body this many times where its own colour is looked at.
HIGHLIGHT = 2.0
DARK = 1e-6


def check(measurement: Measurement, rows: Rows) -> list[Finding]:
    """A finding where the colour of the highlight or the body changes with the angle."""
    if measurement.bands.count < 3 or len(rows) < 4 * FEWEST:
        return []
    some = rows.subset(rows.kept & (rows.values.min(axis=1) > -DARK))
    if len(some) < 4 * FEWEST:
        return []
    values = np.maximum(_few(some.values, measurement.bands), 0.0)
    level = values.mean(axis=1, keepdims=True)
    colour = values / np.maximum(level, DARK)
    body = _body(some, colour)
    if body is None:
        return []
    spectra, highlight = _spectra(some, values, body)
    left = _left_over(colour, spectra)
    worst, where, which = 0.0, 0.0, ""
    for name, members in (("highlight", highlight), ("body", _away(some))):
        for low in np.arange(0.0, 90.0, CLASS_DEG):
            angle = some.incidence_deg if name == "highlight" else some.receiver_deg
            inside = members & (angle >= low) & (angle < low + CLASS_DEG)
            if np.sum(inside) < FEWEST:
                continue
            typical = float(np.median(left[inside]))
            if typical > worst:
                worst, where, which = typical, float(np.median(angle[inside])), name
    if worst < LEFT_OVER:
        return []
    at = "incidence" if which == "highlight" else "of the receiver"
    return [
        Finding(
            COLOUR,
            f"this sample changes colour near {where:.0f} deg {at}: {worst:.0%} of its {which}'s "
            "light there has a colour that no model here gives; pictures show it wrong",
            True,
        )
    ]


def _few(values: Array, bands: Bands) -> Array:
    """(N, at most 8), means over neighbouring bands."""
    runs = np.array_split(np.arange(bands.count), min(bands.count, 8))
    return np.stack([values[:, run].mean(axis=1) for run in runs], axis=1)


def _away(rows: Rows) -> Mask:
    return (rows.delta_deg > BODY_DEG) & (rows.level < HIGHLIGHT * rows.body_level)


def _body(rows: Rows, colour: Array) -> Array | None:
    """The body's spectrum, of mean 1, where lamp and receiver are not near the horizon."""
    upright = np.minimum(rows.to_lamp[:, 2], rows.to_receiver[:, 2]) > 0.5
    away = _away(rows) & upright
    if np.sum(away) < FEWEST:
        return None
    spectrum = np.median(colour[away], axis=0)
    return np.asarray(spectrum / max(float(spectrum.mean()), DARK))


def _spectra(rows: Rows, values: Array, body: Array) -> tuple[Array, Mask]:
    """Spectra (K, B) that may add up, and the rows that show the highlight's own colour."""
    highlight = rows.level > (1.0 + HIGHLIGHT) * rows.body_level
    white = np.ones_like(body)
    spectra = [body, body**2, white]
    if np.sum(highlight) >= FEWEST:
        excess = values[highlight] - rows.body_level * body
        least = np.sort(rows.incidence_deg[highlight])[FEWEST - 1]
        upright = rows.incidence_deg[highlight] <= max(least, 25.0)
        own = excess[upright] / np.maximum(excess[upright].mean(axis=1, keepdims=True), DARK)
        spectra.append(np.maximum(np.median(own, axis=0), 0.0))
    return np.array([s / max(float(s.mean()), DARK) for s in spectra]), highlight


def _left_over(colour: Array, spectra: Array) -> Array:
    """(N,), root mean square of what the best sum with weights of at least zero leaves."""
    least = np.full(len(colour), np.inf)
    for size in range(1, len(spectra) + 1):
        for chosen in itertools.combinations(range(len(spectra)), size):
            basis = spectra[list(chosen)]
            weights = colour @ np.linalg.pinv(basis, rcond=1e-3)
            rest = np.sqrt(np.mean(np.square(colour - weights @ basis), axis=1))
            fine = np.all(weights >= -1e-9, axis=1)
            least = np.where(fine & (rest < least), rest, least)
    return np.where(np.isfinite(least), least, 0.0)
