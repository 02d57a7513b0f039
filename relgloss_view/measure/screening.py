"""Reasons to leave samples and bands out of a measurement."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.measure import table
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.gonio import GRAZING_COSINE, OCCLUSION_DEG
from relgloss_view.measure.quantity import RADIANCE_FACTOR_PERCENT
from relgloss_view.measure.single_values import MOST_FILLED

#: Values whose half-vector is further from the normal than this show the body of most samples.
BODY_DEG = 20.0
#: No surface sends back more light than it receives; fluorescent papers come near this.
MOST_BODY = 2.0
#: With fewer values of the body one may be anything, and the least of them is taken.
FEWEST_BODY = 5
#: Readings this far below zero are noise about zero: a thousandth of the perfect diffuser ...
NOISE = 1e-3
#: ... or this many standard deviations of the noise that many of them show, up to a limit.
NOISE_DEVIATIONS, MOST_NOISE, FEWEST_NEGATIVE = 5.0, 0.02, 8
#: With fewer samples the shares below mean nothing.
FEWEST_ROWS = 8
#: A band is left out where it has no reading above zero in this share of the samples ...
MOST_WITHOUT = 0.5
#: ... or in this share, where the samples would be left out in its place and most would be.
ENOUGH_WITHOUT = 0.1
#: Above it a value shows light from the surface itself, which no band lacks (Fresnel 1823).
HIGHLIGHT = 1.0
#: Bands outside hardly change a colour: CIE 1931's V(lambda) is below 0.02 there.
SEEN_NM = (420.0, 680.0)


def reasons(
    to_lamp: Array,
    to_receiver: Array,
    readings: Array,
    *,
    saturation: float | None = None,
    arms_occlude: bool = False,
) -> NDArray[np.object_]:
    """For each sample, table.KEPT or the reason to leave it out; shape (N,).

    to_lamp, to_receiver: (N, 3), unit vectors. readings: (N, B), as the instrument wrote them, NaN
    where a field is empty. saturation: largest reading of the instrument, in the same unit.
    arms_occlude: lamp and receiver are arms that shadow each other within 8 degrees.

    Where several reasons apply, the reading's own fault comes before the geometry's.

    >>> above = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    >>> reasons(above, above, np.array([[0.5], [-0.1]])).tolist()
    ['', 'negative']
    """
    missing = np.asarray(np.isnan(readings).any(axis=1))
    filled = np.where(missing[:, None], 0.0, readings)
    lowest = np.minimum(to_lamp[:, 2], to_receiver[:, 2])

    faults = [
        (table.MISSING, missing),
        (table.NEGATIVE, (filled < 0.0).any(axis=1)),
    ]
    if saturation is not None:
        faults.append((table.SATURATED, (filled >= saturation).any(axis=1)))
    # cos(90 deg) is 6e-17 in float64: the horizon itself counts as below.
    faults += [(table.BELOW, lowest <= 1e-12), (table.GRAZING, lowest < GRAZING_COSINE)]
    if arms_occlude:
        # From the chord, which stays exact for near-equal directions where acos does not.
        chord = np.linalg.norm(to_lamp - to_receiver, axis=1)
        angle_deg = np.degrees(2.0 * np.arcsin(np.minimum(0.5 * chord, 1.0)))
        # "Within 8 degrees" includes 8 itself, whatever the last bit of the chord is.
        faults.append((table.OCCLUDED, angle_deg <= OCCLUSION_DEG + 1e-9))

    # References to a few texts: an array of texts would take 124 bytes a sample.
    chosen = np.full(len(readings), table.KEPT, dtype=object)
    for name, mask in reversed(faults):
        chosen[mask] = name
    return chosen


def percent_warning(
    to_lamp: Array, to_receiver: Array, radiance_factor: Array, kept: Mask
) -> str | None:
    """A warning where the values can be no radiance factors, as where they are percent; else None.

    Arrays as in Measurement. Away from the mirror direction the median of the brightest band is the
    diffuse reflectance, at most about 1. Near the lamp a retroreflector sends back more.

    >>> straight = np.array([[0.0, 0.0, 1.0]])
    >>> aslant = np.array([[0.0, 0.9428, 0.3333]])
    >>> percent_warning(straight, aslant, np.array([[0.8]]), np.array([True])) is None
    True
    >>> percent_warning(straight, aslant, np.array([[80.0]]), np.array([True]))
    "away from the mirror direction the values reach 80, ... like percent; pass --quantity ..."
    """
    half = to_lamp + to_receiver
    length = np.linalg.norm(half, axis=1)
    away = kept & (half[:, 2] < np.cos(np.radians(BODY_DEG)) * length)
    away &= np.sum(to_lamp * to_receiver, axis=1) < np.cos(np.radians(BODY_DEG))
    if not np.any(away):
        return None
    few = np.sum(away) < FEWEST_BODY
    typical = np.min(radiance_factor[away], axis=0) if few else np.median(radiance_factor[away], 0)
    level = float(np.max(typical))
    if not level > MOST_BODY:
        return None
    reach = (
        f"away from the mirror direction the values reach {level:.3g}, and the perfect diffuser "
        "has 1"
    )
    if level > 100 * MOST_BODY:
        return f"{reach}: check the unit, and give the right --quantity"
    return (
        f"{reach}: they look like percent; pass --quantity {RADIANCE_FACTOR_PERCENT}, or write "
        f"'# quantity: {RADIANCE_FACTOR_PERCENT}' on top"
    )


def noise_limit(radiance_factor: Array, above: Mask) -> float:
    """How far below zero a reading is noise, as a radiance factor.

    Arrays as in unusable_bands. Where enough readings are negative they show the noise themselves:
    their median over 0.6745 is its standard deviation where the sample is black (Hampel 1974), and
    less where it is not. Samples that are negative in most bands are at fault and not looked at.
    """
    values = radiance_factor[above]
    if not values.size or np.min(values) >= 0.0:
        return NOISE
    negative = values < 0.0
    some = negative & (np.mean(values < -NOISE, axis=1) <= 0.5)[:, None]
    # A band that is negative throughout has an offset, and noise beside it.
    some &= negative.mean(axis=0) <= 1.0 - ENOUGH_WITHOUT
    if np.sum(some) < FEWEST_NEGATIVE:
        return NOISE
    deviation = float(np.median(-values[some])) / 0.6745
    return float(np.clip(NOISE_DEVIATIONS * deviation, NOISE, MOST_NOISE))


def unusable_bands(
    radiance_factor: Array, above: Mask, bands: Bands, noise: float = NOISE
) -> tuple[Mask, Mask]:
    """Bands to leave out, and dark bands whose values below zero are all noise, (B,) each.

    radiance_factor: (N, B), NaN where empty. above: (N,), both directions above the horizon.
    noise: as noise_limit gives it.

    A band that is empty or negative in most samples does not show the sample. So it is left out,
    and what an instrument fills with zeros though it saw the highlight. So are bands without which
    most samples would lack too much. Two bands always stay. A run of several bands in the middle of
    the spectrum that lie about zero is a dark colour and stays: without it the colour would be that
    of its neighbours. Channels of linear sRGB are negative where a colour is saturated, and stay.

    >>> rows = np.tile([-0.0004, 0.2, 0.3], (9, 1))
    >>> unusable_bands(rows, np.full(9, True), Bands((390.0, 550.0, 650.0)))[0].tolist()
    [True, False, False]
    """
    none = np.zeros(bands.count, dtype=bool)
    if bands.wavelengths_nm is None or np.sum(above) < FEWEST_ROWS:
        return none, none
    values = radiance_factor[above]
    if np.min(values) > 0.0:  # False for NaN
        return none, none
    bad = ~(values >= 0.0)
    always = bad.mean(axis=0) > 1.0 - ENOUGH_WITHOUT
    # A sample that lacks most of the other bands is at fault itself.
    beyond = ~(values >= -noise)
    sound = beyond[:, ~always].mean(axis=1) <= 0.5 if not always.all() else np.zeros(len(bad), bool)
    if np.sum(sound) < FEWEST_ROWS:
        return none, none
    values, bad, beyond = values[sound], bad[sound], beyond[sound]
    out = bad.mean(axis=0) > MOST_WITHOUT
    share = beyond.mean(axis=0)
    while np.mean(_lacking(beyond[:, ~out])) > MOST_WITHOUT:
        worst = int(np.argmax(np.where(out, -1.0, share)))
        if share[worst] < ENOUGH_WITHOUT:
            break
        out[worst] = True
    filled = np.all(np.nan_to_num(values) == 0.0, axis=0)
    if np.nanmax(values[:, ~filled], initial=0.0) > HIGHLIGHT:
        out |= filled
    dark = _dark_runs(values, out, bands.centres_nm(), noise)
    out &= ~dark
    return (out, dark) if np.sum(~out) >= 2 else (none, none)


def _lacking(bad: Mask) -> Mask:
    """(N,), the samples with more bad values than are filled."""
    if not bad.shape[1]:
        return np.zeros(len(bad), dtype=bool)
    return np.asarray(bad.mean(axis=1) > MOST_FILLED)


def _dark_runs(values: Array, out: Mask, centres_nm: Array, noise: float) -> Mask:
    """The bands in `out` that lie about zero, in runs with two and more in the seen spectrum."""
    level = np.abs(np.median(np.where(np.isnan(values), np.inf, values), axis=0))
    about_zero = out & (level <= noise) & np.any(values > 0.0, axis=0)
    dark = np.zeros_like(out)
    low, high = SEEN_NM
    edges = np.flatnonzero(np.diff(np.r_[False, about_zero, False].astype(int)))
    for first, end in zip(edges[::2], edges[1::2], strict=True):
        seen = (centres_nm[first:end] >= low) & (centres_nm[first:end] <= high)
        dark[first:end] = np.sum(seen) >= 2
    return dark


def bands_note(radiance_factor: Array, out: Mask, bands: Bands) -> str | None:
    """A sentence that names the bands that are left out and why; None where none is.

    >>> rows = np.tile([-0.0004, 0.2, 0.3], (9, 1))
    >>> bands_note(rows, np.array([True, False, False]), Bands((390.0, 550.0, 650.0)))
    'left out the band 390 nm, which is negative in 9 of 9 samples; the rest is read'
    """
    if not np.any(out):
        return None
    values = radiance_factor[:, out]
    counts = {
        "negative": np.sum(values < 0.0, axis=0),
        "empty": np.sum(np.isnan(values), axis=0),
        "zero": np.sum(values == 0.0, axis=0),
    }
    total = {word: int(np.sum(count)) for word, count in counts.items()}
    word = max(total, key=lambda name: total[name])
    labels = [label for label, left in zip(bands.labels, out, strict=True) if left]
    if len(labels) == 1:
        return (
            f"left out the band {labels[0]}, which is {word} in {counts[word][0]} of {len(values)} "
            "samples; the rest is read"
        )
    shown = labels if len(labels) <= 6 else [*labels[:5], f"{len(labels) - 5} more"]
    return (
        f"left out {len(labels)} bands that are {word} or unread in most samples "
        f"({', '.join(shown)}); the rest is read"
    )
