"""Colour that turns with the angle: spectra that no body under a highlight of one colour sends.

Light of the body is a sum, with weights of at least zero, of the body's spectrum, the same squared
(interreflection; Oren, Nayar 1995), white, and the highlight's spectrum. The highlight itself has
one colour that turns white towards grazing incidence, by as much as an interface's does at most
(Fresnel; form of Schlick 1994). What is left over is measured for each row; where many rows of one
angle leave much, their colour turns.
"""

from __future__ import annotations

import itertools

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.findings.finding import COLOUR, Finding
from relgloss_view.measure.findings.lobe import Lobe
from relgloss_view.measure.findings.rows import BODY_DEG, F0, Rows
from relgloss_view.measure.table import Measurement

#: What may be left over, relative to a row's mean (noise, dispersion of the index, real films of a
#: slight turn), and what is serious.
LEFT_OVER, SERIOUS = 0.10, 0.15
#: Width of the classes of incidence, degrees, and rows a class must have.
CLASS_DEG, FEWEST = 10.0, 4
#: A highlight exceeds the body this many times where its own colour is looked at.
HIGHLIGHT = 5.0
#: Share of the highest density of facets where rows show the core of the highlight alone.
CORE = 0.1
#: Whitening beyond that of an interface of 4 % at normal incidence that is no turn of the colour.
SLACK = 0.05
TAILS = 4.0  #: widths of the highlight within which rows do not show the body alone
DARK = 1e-6


def check(measurement: Measurement, rows: Rows, lobe: Lobe | None) -> list[Finding]:
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
    own, highlight, of_highlight = _highlight(some, values, body)
    spectra = [body, body**2, np.ones_like(body), *([] if own is None else [own])]
    left = _left_over(colour, np.array([s / max(float(s.mean()), DARK) for s in spectra]))
    beyond = 0.0 if lobe is None else TAILS * lobe.width_deg
    worst, where, which = 0.0, 0.0, ""
    parts = (
        ("highlight", highlight, of_highlight),
        ("body", _away(some) & (some.delta_deg > beyond), left),
    )
    for name, members, rest in parts:
        for low in np.arange(0.0, 90.0, CLASS_DEG):
            angle = some.incidence_deg if name == "highlight" else some.receiver_deg
            inside = members & (angle >= low) & (angle < low + CLASS_DEG)
            if np.sum(inside) < FEWEST:
                continue
            typical = float(np.median(rest[inside]))
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
            worst > SERIOUS,
        )
    ]


def _few(values: Array, bands: Bands) -> Array:
    """(N, at most 8), means over neighbouring bands."""
    runs = np.array_split(np.arange(bands.count), min(bands.count, 8))
    return np.stack([values[:, run].mean(axis=1) for run in runs], axis=1)


def _away(rows: Rows) -> Mask:
    return (rows.delta_deg > BODY_DEG) & (rows.level < 2.0 * rows.body_level)


def _body(rows: Rows, colour: Array) -> Array | None:
    """The body's spectrum, of mean 1, where lamp and receiver are not near the horizon."""
    upright = np.minimum(rows.to_lamp[:, 2], rows.to_receiver[:, 2]) > 0.5
    away = _away(rows) & upright
    if np.sum(away) < FEWEST:
        return None
    spectrum = np.median(colour[away], axis=0)
    return np.asarray(spectrum / max(float(spectrum.mean()), DARK))


def _highlight(rows: Rows, values: Array, body: Array) -> tuple[Array | None, Mask, Array]:
    """The highlight's own colour (B,) of mean 1, the rows that show it, and what they leave (N,).

    The colour is that of the rows nearest to normal incidence; None where too few show it.
    """
    left = np.zeros(len(rows))
    bright = rows.level > HIGHLIGHT * rows.body_level
    bright &= rows.facets > CORE * float(np.max(rows.facets))
    if np.sum(bright) < FEWEST:
        return None, bright, left
    excess = values - rows.body_level * body
    colour = excess / np.maximum(excess.mean(axis=1, keepdims=True), DARK)
    least = np.sort(rows.incidence_deg[bright])[FEWEST - 1]
    upright = bright & (rows.incidence_deg <= max(least, 25.0))
    own = np.maximum(np.median(colour[upright], axis=0), 0.0)
    own = own / max(float(own.mean()), DARK)
    grazing = (1.0 - np.clip(rows.cos_d, 0.0, 1.0)) ** 5
    most = grazing / (F0 + grazing) + SLACK
    to_white = 1.0 - own
    share = (colour - own) @ to_white / max(float(to_white @ to_white), DARK)
    share = np.clip(share, 0.0, most)
    rest = colour - own - share[:, None] * to_white
    return own, bright, np.asarray(np.where(bright, np.sqrt(np.mean(np.square(rest), axis=1)), 0.0))


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
