"""What a fit works on: the usable part of a measurement, and its compression to a few bands."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.base.errors import InputError
from relgloss_view.fitting.instrument import instrument_of
from relgloss_view.fitting.shapes import Geometry, geometry
from relgloss_view.measure.gonio import from_normal
from relgloss_view.measure.spectrum import is_45_0
from relgloss_view.measure.table import NEGATIVE, Measurement

#: Radiance factor below which an instrument's reading is its own floor. Dark samples lower it.
FLOOR = 1e-3
FLOOR_OF_MEDIAN = 0.02
#: Where readings of a band fall below zero, its floor is this many times their root mean square.
#: The logarithm is then nearly straight over the noise, and a dark body is not seen too bright.
FLOOR_OF_NOISE = 20.0
#: Squares of its inverse are formed: a band of 1e-300 beside ordinary ones must not overflow.
LEAST_FLOOR = 1e-9
#: No surface's brightest direction is darker: light traps reach 1e-5.
DARKEST = 1e-6
#: A channel of linear sRGB at or below zero means "outside the gamut", not "nothing": it is
#: compared with the brightness of the same sample.
OUT_OF_GAMUT_SLACK = 0.1
FEWEST_SAMPLES = 12
SEARCH_BANDS = 5
FOLDS_WITHOUT_GROUPS = 10
FEWEST_GROUPS = 4
INDEPENDENT = 8
TAU = 0.03  #: logarithmic residual where the loss leaves the square: a good instrument's worst


@dataclass(frozen=True)
class Observations:
    """N samples x B bands in radiance factors (pi times the BRDF), with their geometry."""

    geometry: Geometry
    value: Array  #: (N, B), zero where there is no usable value; below it where noise is
    floor: Array  #: (N, B), added to value and model before the logarithm
    weight: Array  #: (N, B), 0 where there is no usable value, else the band's share
    group: Ints  #: (N,), 0 .. G-1
    groups: int
    prior_sd: Array = field(default_factory=lambda: np.zeros(0))  #: (K,), of instrument errors
    error_names: tuple[str, ...] = ()  #: (K,)
    prior_centre: Array = field(default_factory=lambda: np.zeros(0))  #: (K,) or none: zero
    noise: float = TAU  #: logarithmic residual of a good model, against which priors weigh
    #: (N,), how many geometries of a larger table each stands for; None: itself
    counts: Array | None = None

    @property
    def sample_weight(self) -> float:
        """What half a squared deviation of one sample weighs in a mean loss, in units of TAU^2.

        As if INDEPENDENT of them in each group were independent, at the noise that they have: its
        bands and neighbours share what is wrong with a model or a plane.
        """
        return (self.noise / TAU) ** 2 / min(len(self.value), INDEPENDENT * self.groups)

    @property
    def bands(self) -> int:
        """Number of bands."""
        return int(self.value.shape[1])

    def subset(self, rows: Mask) -> Observations:
        """The samples marked in `rows`; groups keep their numbers."""
        return replace(
            self,
            geometry=self.geometry.subset(rows),
            value=self.value[rows],
            floor=self.floor[rows],
            weight=self.weight[rows],
            group=self.group[rows],
            counts=None if self.counts is None else self.counts[rows],
        )


def usable_rows(measurement: Measurement) -> Mask:
    """(N,), the geometries a fit uses.

    A sample marked negative is still used in linear sRGB when another channel is positive: a
    saturated colour lies outside that gamut everywhere.
    """
    factor = measurement.radiance_factor
    rows = measurement.kept.copy()
    if measurement.bands.is_rgb:
        positive = np.nan_to_num(factor, nan=0.0, posinf=0.0, neginf=0.0) > 0.0
        rows |= (measurement.reasons == NEGATIVE) & np.any(positive, axis=1)
    facing = (measurement.to_lamp[:, 2] > 0.0) & (measurement.to_receiver[:, 2] > 0.0)
    return np.asarray(rows & facing)


def _what_few_serve_for(measurement: Measurement, enough: int) -> str:
    """What can be done with too few samples for a fit, as a part of a sentence."""
    if enough == 0:
        return "check the angles, the quantity and the empty fields"
    estimate = "`relgloss estimate --spectrum FILE` with the readings of a gloss meter"
    lamp, receiver = from_normal(measurement.to_lamp), from_normal(measurement.to_receiver)
    if np.any(is_45_0(lamp, receiver) & measurement.kept) and not measurement.bands.is_rgb:
        return f"`relgloss measure FILE` shows them, and 45/0 gives the colour: {estimate}"
    return "`relgloss measure FILE` shows them"


def prepare(measurement: Measurement, seed: int = 0) -> Observations:
    """The usable samples of a measurement.

    Raises InputError when too little is left to fit anything to.
    """
    rows = usable_rows(measurement)
    factor = measurement.radiance_factor[rows]
    finite = np.isfinite(factor)
    value = np.where(finite, factor, 0.0)
    positive = value > 0.0
    noisy = np.zeros(value.shape[1], dtype=bool)
    if not measurement.bands.is_rgb:
        noisy = np.any(value < 0.0, axis=0)
    # Zero beside noise to either side of it is a reading; else it is what an instrument fills in.
    usable = finite if measurement.bands.is_rgb else finite & (positive | noisy)
    enough = np.sum(np.any(positive, axis=1))
    if enough < FEWEST_SAMPLES:
        left_out = _unusable(measurement, rows, positive)
        why = f" ({left_out})" if left_out else ""
        raise InputError(
            f"{measurement.place}: {enough} usable sample{'' if enough == 1 else 's'} of "
            f"{len(rows)}{why}; {_what_few_serve_for(measurement, int(enough))}; a fit needs at "
            f"least {FEWEST_SAMPLES} geometries, at and beside the mirror direction"
        )
    if float(np.max(value)) < DARKEST:
        raise InputError(
            f"{measurement.place}: the largest radiance factor is {np.max(value):.2g}, darker than "
            "any surface; check the quantity and its unit"
        )
    floor = _floors(value, positive)
    floor[:, noisy] = np.maximum(floor, _noise_floor(value))[:, noisy]
    group, groups = _groups(measurement.group[rows], seed)
    value = np.where(positive | (usable & noisy), value, 0.0)
    share = foreshortening(measurement, rows)
    counts = None if measurement.stands_for is None else measurement.stands_for[rows]
    if counts is not None:
        share = share * counts / np.mean(counts)
    weight = np.where(usable, share[:, None] / value.shape[1], 0.0)
    lamp, receiver = measurement.to_lamp[rows], measurement.to_receiver[rows]
    instrument = instrument_of(measurement)
    if instrument is not None:
        instrument = instrument.subset(rows)
    return Observations(
        geometry(lamp, receiver, measurement.aperture_sd_deg, instrument),
        value,
        floor,
        weight,
        group,
        groups,
        np.zeros(0) if instrument is None else instrument.prior_sd,
        () if instrument is None else instrument.names,
        counts=counts,
    )


def _unusable(measurement: Measurement, rows: Mask, positive: Mask) -> str:
    """Why samples are not usable, with counts that account for each of them."""
    usable = np.zeros(len(rows), dtype=bool)
    usable[rows] = np.any(positive, axis=1)
    reasons = Counter(str(r) or "zero or no number" for r in measurement.reasons[~usable])
    return ", ".join(f"{count} {reason}" for reason, count in reasons.items())


def foreshortening(measurement: Measurement, rows: Mask) -> Array:
    """sqrt(cos_i cos_o) of the marked samples: what a sample weighs.

    A surface seen or lit at grazing angles covers few pixels and gets little light; the cosine
    weight is that of Ngan, Durand, Matusik 2005, shared between the two directions so that the
    fit stays reciprocal.
    """
    cosines = measurement.to_lamp[rows, 2] * measurement.to_receiver[rows, 2]
    return np.asarray(np.sqrt(cosines))


def _floors(value: Array, positive: Mask) -> Array:
    floor = np.full(value.shape, FLOOR)
    for band in range(value.shape[1]):
        if np.any(positive[:, band]):
            typical = float(np.median(value[positive[:, band], band]))
            floor[:, band] = np.clip(FLOOR_OF_MEDIAN * typical, LEAST_FLOOR, FLOOR)
    brightness = np.mean(np.maximum(value, 0.0), axis=1, keepdims=True)
    slack = np.maximum(-value, OUT_OF_GAMUT_SLACK * brightness)
    return np.where(positive, floor, np.maximum(floor, slack))


def _noise_floor(value: Array) -> Array:
    """(B,), the floor where readings fall below zero: above each of them by far."""
    below = np.minimum(value, 0.0)
    count = np.maximum(np.sum(below < 0.0, axis=0), 1)
    typical = np.sqrt(np.sum(np.square(below), axis=0) / count)
    return np.asarray(np.maximum(FLOOR_OF_NOISE * typical, 3.0 * np.max(-below, axis=0)))


def _groups(group: Ints, seed: int) -> tuple[Ints, int]:
    """Consecutive group numbers; random folds when the measurement names too few planes."""
    names, number = np.unique(group, return_inverse=True)
    if len(names) >= FEWEST_GROUPS:
        return number.astype(np.int64), len(names)
    count = min(FOLDS_WITHOUT_GROUPS, len(group))
    order = np.random.default_rng(seed).permutation(len(group))
    return (order % count).astype(np.int64), count


def compress(observations: Observations, most: int = SEARCH_BANDS) -> Observations:
    """Means over neighbouring bands, at most `most` of them.

    The model is linear in the albedos and strengths, so the mean over bands is again of the
    model's form (but for rho^2 in Oren-Nayar, where neighbouring bands hardly differ); the
    nonlinear unknowns are shared by all bands, so the search may run on the means. Bands are cut
    into runs of about equal total variation of the spectrum, so that each run is of one colour.
    """
    if observations.bands <= most:
        return observations
    seen = np.sum(observations.weight > 0.0, axis=0)
    bands = np.flatnonzero(seen > 0.5 * np.max(seen))
    if len(bands) <= most:
        return observations
    spectrum = np.array(
        [np.median(observations.value[observations.weight[:, b] > 0.0, b]) for b in bands]
    )
    change = np.abs(np.diff(np.log(spectrum + FLOOR)))
    # Half of the cut follows the spectrum, half the number of bands: flat spectra stay in runs too.
    position = np.concatenate([[0.0], np.cumsum(change / max(np.sum(change), 1e-9))])
    position = 0.5 * position + 0.5 * np.arange(len(bands)) / (len(bands) - 1)
    run = np.minimum((position * most).astype(int), most - 1)
    used = observations.weight > 0.0
    columns = [_without_gaps(used, bands[run == k]) for k in range(most) if np.any(run == k)]
    value = np.stack([np.mean(observations.value[:, c], axis=1) for c in columns], axis=1)
    floor = np.stack([np.mean(observations.floor[:, c], axis=1) for c in columns], axis=1)
    whole = np.stack([np.all(used[:, c], axis=1) for c in columns], axis=1)
    weight = np.stack([np.sum(observations.weight[:, c], axis=1) for c in columns], axis=1)
    return replace(observations, value=value, floor=floor, weight=np.where(whole, weight, 0.0))


def _without_gaps(used: Mask, run: Ints) -> Ints:
    """A run of bands; the one with the most samples where scattered gaps leave few rows whole.

    used: (N, B), where there is a value.
    """
    counts = np.sum(used[:, run], axis=0)
    if 2 * np.sum(np.all(used[:, run], axis=1)) >= np.max(counts):
        return run
    return run[[np.argmax(counts)]]
