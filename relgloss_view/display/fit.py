"""A display's model from readings: the candidate that cross-validation chooses, with its errors.

The candidates are those of candidates.py. Each is fitted to all folds but one and held against
that one; the simplest is taken whose excess over the best is within one standard error of it
(Breiman et al. 1984). Weights follow from the noise of the readings (reading_noise.py), and single
misread patches are left out by name.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.display.candidates import KINDS, Fitted, Kind, Shape, fit_candidate
from relgloss_view.display.fitted_monitor import monitor_of_fit
from relgloss_view.display.gamut import area_of_srgb, share_of_srgb
from relgloss_view.display.monitor import Monitor
from relgloss_view.display.reading_noise import Noise, estimate_noise, standardised
from relgloss_view.display.readings import Readings
from relgloss_view.material.cielab import lab_from_xyz
from relgloss_view.material.difference import delta_e_2000
from relgloss_view.material.spectra import xy_of

FOLDS = 5
HUBER = 2.5  #: standard deviations, in three dimensions
ROUNDS = 4  #: of weights and fits in turn
#: A patch this far off is misread: one reading in a million is, by chance (chi2 of 3). One that
#: nobody would see does no harm.
MISREAD_Z2, MISREAD_DE2000 = 30.66, 2.0
MOST_MISREAD = 0.05  #: share of the patches; where more are off, the model is wrong and not they
MOST_PATCHES = 10_000
FEWEST_COLOURS = 8  #: different digital values; fewer can't carry a matrix, a black and curves
POOR_DE2000 = 3.0  #: mean of patches that the fit had not seen


@dataclass(frozen=True)
class Candidate:
    """A candidate's part in the choice.

    score: mean squared standardised residual of unseen patches, cut at 4 standard deviations;
    excess, excess_se: over the best one's, and its standard error. mean_de2000: of unseen patches.
    """

    name: str
    parameters: int
    score: float
    excess: float
    excess_se: float
    mean_de2000: float
    chosen: bool


@dataclass(frozen=True)
class FitErrors:
    """CIEDE2000 between readings and model, relative to the model's white."""

    mean: float
    p95: float
    largest: float
    unseen_mean: float  #: of patches that the fit had not seen, by cross-validation


@dataclass(frozen=True, eq=False)
class DisplayFit:
    """What readings show of a display.

    verdict: "good" or "poor". warnings: whole sentences, each with what is at risk and the step
    that mends it. notes: what was taken for granted. differences: (N,) dE2000 of each patch.
    luminance_cd_m2, black_cd_m2: None where the readings have no unit. contrast: None where no
    light was read at black. gamut_area: of the triangle of the primaries in x, y, sRGB's is 1;
    gamut_share: how much of sRGB's triangle it covers, 0 to 1. misread: places of the patches
    that were left out.
    """

    monitor: Monitor
    errors: FitErrors
    candidates: tuple[Candidate, ...]
    warnings: tuple[str, ...]
    notes: tuple[str, ...]
    verdict: str
    luminance_cd_m2: float | None
    black_cd_m2: float | None
    black_share: float  #: Y of black over white's
    contrast: float | None
    white_xy: tuple[float, float]
    primaries_xy: tuple[tuple[float, float], ...]
    gamut_area: float
    gamut_share: float
    patches: int
    misread: tuple[str, ...]
    noise: Noise
    seed: int
    source: str
    model: Fitted
    differences: Array

    @property
    def chosen(self) -> str:
        """Name of the chosen candidate."""
        return next(c.name for c in self.candidates if c.chosen)


def fit_display(readings: Readings, seed: int = 0) -> DisplayFit:
    """Fit a display's model to readings. seed: of the folds.

    Raises InputError where the readings can't carry a model: one line with the remedy.
    """
    from relgloss_view.display.diagnosis import diagnose, refuse_unusable

    refuse_unusable(readings)
    digital, xyz = readings.rgb, readings.xyz
    colours, group = np.unique(digital.round(6), axis=0, return_inverse=True)
    kept, noise, base = _weighted(digital, xyz)
    whitening = noise.whitening(base, digital[kept])
    kinds = tuple(k for k in KINDS if k.parameters + 6 <= len(colours)) or KINDS[:1]
    folds = _folds(np.asarray(group).ravel()[kept], len(colours), seed)
    models = _fitted(kinds, digital[kept], xyz[kept], whitening, noise.digital)
    z2, unseen = _unseen(kinds, digital[kept], xyz[kept], whitening, noise.digital, folds)
    candidates, index = _choice(kinds, z2, unseen)
    model = models[index]
    white = model.white
    differences = _difference(model, digital, xyz)
    seen = differences[kept]
    errors = FitErrors(
        float(seen.mean()),
        float(np.percentile(seen, 95.0)),
        float(seen.max()),
        float(unseen[index].mean()),
    )
    places = tuple(readings.places[k] for k in np.flatnonzero(~kept))
    primaries = tuple(xy_of(model.matrix[:, k]) for k in range(3))
    luminance = float(white[1]) if readings.absolute else None
    black_share = float(model.black[1] / white[1])
    fit = DisplayFit(
        monitor_of_fit(model, readings),
        errors,
        candidates,
        (),
        readings.notes,
        "good",
        luminance,
        None if luminance is None else luminance * black_share,
        black_share,
        1.0 / black_share if black_share > 1e-7 else None,
        xy_of(white),
        primaries,
        area_of_srgb(primaries),
        share_of_srgb(primaries),
        readings.count,
        places,
        noise,
        seed,
        readings.source,
        model,
        differences,
    )
    findings = diagnose(readings, fit, kept, models[-1], whitening)
    grave = any(finding.grave for finding in findings) or errors.unseen_mean > POOR_DE2000
    return dataclasses.replace(
        fit,
        warnings=tuple(finding.text for finding in findings),
        verdict="poor" if grave else "good",
    )


def _weighted(digital: Array, xyz: Array) -> tuple[Mask, Noise, Fitted]:
    """Which patches are not misread, the noise of the readings, a model that they belong to.

    Fits and weights take turns; the second model has bent curves, so that what a curve of gain,
    offset and gamma misses does not pass for noise.
    """
    plain = KINDS[1]
    colours = len(np.unique(digital.round(6), axis=0))
    bent = next((k for k in reversed(KINDS) if k.parameters + 6 <= colours), plain)
    scale = 0.01 * float(np.max(xyz[:, 1]))
    whitening = np.broadcast_to(np.eye(3) / scale, (len(digital), 3, 3))
    noise, start = Noise(digital=0.0), None
    model = fit_candidate(plain, digital, xyz, whitening)
    for turn in range(ROUNDS):
        noise = estimate_noise(model, digital, xyz, noise)
        whitening = _robust(model, digital, xyz, noise)
        # At last with fine curves: those of gain, offset and gamma may be what is wrong.
        kind = bent if turn == ROUNDS - 1 else plain
        start = model.shape if kind is not plain else None
        model = fit_candidate(kind, digital, xyz, whitening, noise.digital, start)
    noise = estimate_noise(model, digital, xyz, noise)
    whitening = noise.whitening(model, digital)
    return _kept(model, digital, xyz, whitening, noise.digital), noise, model


def _robust(model: Fitted, digital: Array, xyz: Array, noise: Noise) -> Array:
    """Whitening in which a patch that is far off counts by its distance only (Huber 1964)."""
    whitening = noise.whitening(model, digital)
    z2 = standardised(model, digital, xyz, whitening, noise.digital)
    weight = np.minimum(1.0, HUBER / np.sqrt(np.maximum(z2, 1e-12)))
    return np.asarray(whitening * np.sqrt(weight)[:, None, None])


def _kept(model: Fitted, digital: Array, xyz: Array, whitening: Array, unsteady: float) -> Mask:
    """Which patches are not misread; all of them where so many are off that the model is wrong."""
    z2 = standardised(model, digital, xyz, whitening, unsteady)
    off = (z2 > MISREAD_Z2) & (_difference(model, digital, xyz) > MISREAD_DE2000)
    _, group = np.unique(digital.round(6), axis=0, return_inverse=True)
    group = np.asarray(group).ravel()
    repeated = np.bincount(group)[group] > 1
    confirmed = np.bincount(group, off)[group] == np.bincount(group)[group]
    off &= ~(repeated & confirmed)  # two readings that agree are right
    every: Mask = np.ones(len(digital), dtype=bool)
    return np.asarray(~off) if off.mean() <= MOST_MISREAD else every


def _fitted(
    kinds: tuple[Kind, ...], digital: Array, xyz: Array, whitening: Array, unsteady: float
) -> list[Fitted]:
    """Each candidate; bent curves start from the plain ones."""
    models: list[Fitted] = []
    plain: dict[bool, Shape] = {}
    for kind in kinds:
        model = fit_candidate(kind, digital, xyz, whitening, unsteady, plain.get(kind.shared))
        plain.setdefault(kind.shared, model.shape)
        models.append(model)
    return models


def _folds(group: Ints, groups: int, seed: int) -> Array:
    """The fold of each patch; patches of the same digital values share one."""
    order = np.random.default_rng(seed).permutation(groups)
    return np.asarray((np.argsort(order) % FOLDS)[group])


def _unseen(
    kinds: tuple[Kind, ...],
    digital: Array,
    xyz: Array,
    whitening: Array,
    unsteady: float,
    folds: Array,
) -> tuple[Array, Array]:
    """(kinds, N): squared standardised residuals and dE2000 of patches that a fit had not seen."""
    z2, difference = (np.zeros((len(kinds), len(digital))) for _ in range(2))
    for fold in np.unique(folds):
        out = folds == fold
        if not 0 < out.sum() < len(out):
            continue
        models = _fitted(kinds, digital[~out], xyz[~out], whitening[~out], unsteady)
        for k, model in enumerate(models):
            z2[k, out] = standardised(model, digital[out], xyz[out], whitening[out], unsteady)
            difference[k, out] = _difference(model, digital[out], xyz[out])
    return z2, difference


def _choice(kinds: tuple[Kind, ...], z2: Array, unseen: Array) -> tuple[tuple[Candidate, ...], int]:
    """The candidates with their scores, and the place of the chosen one."""
    cut = np.minimum(z2, 3.0 * 16.0)
    best = int(np.argmin(cut.mean(axis=1)))
    excess = cut - cut[best]
    mean = excess.mean(axis=1)
    error = excess.std(axis=1, ddof=1) / np.sqrt(excess.shape[1])
    index = next(k for k in range(len(kinds)) if mean[k] <= error[k] or k == best)
    made = tuple(
        Candidate(
            kind.name,
            kind.parameters,
            float(cut[k].mean()),
            float(mean[k]),
            float(error[k]),
            float(unseen[k].mean()),
            k == index,
        )
        for k, kind in enumerate(kinds)
    )
    return made, index


def _difference(model: Fitted, digital: Array, xyz: Array) -> Array:
    white = model.white
    return delta_e_2000(lab_from_xyz(xyz, white), lab_from_xyz(model.xyz(digital), white))
