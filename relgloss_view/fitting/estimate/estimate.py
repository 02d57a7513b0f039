"""estimate: from gloss readings and a colour to the materials that give them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.fitting.estimate import model, prior
from relgloss_view.fitting.estimate.colour import LabColour, colour_of
from relgloss_view.fitting.estimate.contradiction import (
    IGNORED,
    contradiction_of,
    high_near_grazing,
)
from relgloss_view.fitting.estimate.given import GlossReading, readings_of
from relgloss_view.fitting.estimate.problem import Problem
from relgloss_view.fitting.estimate.sampler import Draws, posterior
from relgloss_view.gloss.meter.geometry import SPECULAR
from relgloss_view.material.estimated import LEFT_OUT, EstimateRecord, Interval
from relgloss_view.material.material import Material
from relgloss_view.measure.spectrum import ColourReading

LEVEL = 0.95  #: of the intervals
TAILS = (0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL)
#: Draws about a quantile of the peak, among which the most plausible one stands for it.
NEAR = 0.015
KEPT_DRAWS = 50  #: in the file
REFINING_STEPS = 12
#: How the likeliest surface prefers a strength of 1: one standard deviation below it.
STRENGTH_BELOW = 0.15
#: How closely its second lobe keeps to the middle of the draws, in their standard deviations: else a
#: broad halo would be drawn only to bring the strength nearer to 1.
SECOND_HELD = 2.0
DAMPING = 0.1
DRAWN_WEIGHT = 0.1  #: of a draw's misfit, where a start is chosen
LARGEST_SEED = 2**32 - 1


@dataclass(frozen=True)
class Estimate:
    """The materials that a few readings leave open.

    material: the most plausible one, with the record of the estimate. dullest, glossiest: at the
    2.5 and 97.5 % quantiles of the peak. intervals: by name, 95 %. contradiction: one line, or ''.
    surfaces: (N, 5) draws of equal weight (prior.NAMES). peaks: (N,), their peaks.
    """

    material: Material
    dullest: Material
    glossiest: Material
    intervals: dict[str, Interval]
    contradiction: str
    surfaces: Array
    peaks: Array


def estimate(
    gloss: Mapping[float, float] | tuple[GlossReading, ...],
    colour: LabColour | ColourReading | None = None,
    *,
    geometry: str | None = None,
    name: str = "estimated",
    seed: int = 0,
) -> Estimate:
    """The materials that give gloss readings and a colour, as draws of equal weight.

    gloss: gloss units by angle (20, 60, 85 or 75 degrees), or readings with their own errors.
    colour: Lab or spectrum; None takes a gray. geometry: of the colour, '45-0' (the default),
    'd-8-sci' or 'd-8-sce'. seed: of the draws. Raises InputError where a reading is no reading.

    >>> from relgloss_view import load_sample, gloss_readings
    >>> readings = {r.key: r.value for r in gloss_readings(load_sample("art-coated"))}
    >>> gloss = {angle: round(readings[f"gloss-{angle}"], 1) for angle in (20, 60, 85)}
    >>> found = estimate(gloss, LabColour((46.0, -50.0, 25.0)))
    >>> found.intervals["s_deg"].lower < 2.5 < found.intervals["s_deg"].upper
    True
    """
    if not (isinstance(seed, int) and 0 <= seed <= LARGEST_SEED):
        raise InputError(f"seed {seed}: expected a whole number from 0 to {LARGEST_SEED}")
    readings = gloss if isinstance(gloss, tuple) else readings_of(gloss)
    posed = Problem(readings, colour_of(colour, geometry))
    drawn = posterior(posed.log_likelihood, np.random.default_rng(seed))
    contradiction = contradiction_of(posed, drawn.surfaces, seed)
    if contradiction is not None:
        posed = posed.with_errors(contradiction.factors)
        drawn = posterior(posed.log_likelihood, np.random.default_rng(seed))
    words = "" if contradiction is None else contradiction.words
    note = "" if contradiction else high_near_grazing(posed, drawn.surfaces, seed)
    return _summed_up(posed, drawn, (words, note), name, seed)


def estimate_material(
    gloss: Mapping[float, float],
    *,
    lab: tuple[float, float, float] | None = None,
    spectrum: str | os.PathLike[str] | ColourReading | None = None,
    illuminant: str = "D50",
    geometry: str | None = None,
    name: str = "estimated",
    seed: int = 0,
) -> Material:
    """The most plausible material that gives gloss readings and a colour (docs/estimate.md).

    gloss: gloss units by angle, of 20, 60, 85 (ISO 2813) and 75 degrees (TAPPI T 480).
    lab: L*, a*, b* of the 2 degree observer under `illuminant`; or spectrum: a file, or what
    `read_spectrum` read. Without either a gray is assumed. geometry: of the colour, '45-0' (the
    default), 'd-8-sci' or 'd-8-sce'. seed: of the draws.

    Returns a Material whose `estimate` holds 95 % intervals and some of the draws; contradicting
    readings are among its warnings. Raises InputError where a reading is impossible.

    >>> material = estimate_material({20: 3.8, 60: 30.3, 85: 30.9}, lab=(59.0, -58.0, 45.0))
    >>> material.estimate.words, round(material.specular[0].s_deg, 1)
    ('estimated', 2.5)
    """
    if lab is not None and spectrum is not None:
        raise InputError("estimate_material: give lab or spectrum, not both")
    colour: LabColour | ColourReading | None = None
    if lab is not None:
        colour = LabColour(lab, illuminant)
    elif isinstance(spectrum, ColourReading):
        colour = spectrum
    elif spectrum is not None:
        from relgloss_view.measure.readers.spectrum import read_spectrum

        colour = read_spectrum(os.fspath(spectrum))
    return estimate(gloss, colour, geometry=geometry, name=name, seed=seed).material


def _summed_up(
    posed: Problem, drawn: Draws, words: tuple[str, str], name: str, seed: int
) -> Estimate:
    """words: of a contradiction, and of a high reading near grazing; '' where there is none."""
    contradiction = words[0]
    surfaces = drawn.surfaces
    gray = posed.gray(surfaces)
    body = posed.diffuse_y(gray)
    peaks = model.peaks(surfaces, body)
    centre = _central(posed, surfaces)
    intervals = _intervals(posed, surfaces, centre, body, peaks, seed)
    density = drawn.fit + prior.log_density(surfaces)
    low, high = (_standing_for(share, peaks, density) for share in TAILS)
    warnings = [*filter(None, words), *posed.colour.notes]
    left_out = {k for k, factor in enumerate(posed.factors) if factor >= IGNORED}
    left_out |= {posed.grazing} if words[1] else set()
    chosen = np.linspace(0, len(surfaces) - 1, KEPT_DRAWS).astype(int)
    rows = np.column_stack([surfaces, body, peaks])[chosen]
    record = EstimateRecord(
        readings=tuple(
            {
                "angle_deg": r.angle_deg,
                "value": r.value,
                "standard_error": _rounded(r.standard_error),
                **({LEFT_OUT: True} if k in left_out else {}),
            }
            for k, r in enumerate(posed.readings)
        ),
        colour=posed.colour.record,
        level=LEVEL,
        intervals=intervals,
        draws={
            "names": [*prior.NAMES, "diffuse_y", "peak"],
            "rows": [[_rounded(float(v)) for v in row] for row in rows],
        },
        seed=seed,
        contradiction=contradiction,
        warnings=tuple(warnings),
    )
    return Estimate(
        material=posed.material(centre, name, record),
        dullest=posed.material(surfaces[low], f"{name}, dullest", record),
        glossiest=posed.material(surfaces[high], f"{name}, glossiest", record),
        intervals=intervals,
        contradiction=contradiction,
        surfaces=surfaces,
        peaks=peaks,
    )


def _rounded(value: float) -> float:
    return float(f"{value:.5g}")


def _intervals(
    posed: Problem, surfaces: Array, centre: Array, body: Array, peaks: Array, seed: int
) -> dict[str, Interval]:
    """Value of the most plausible surface, and the quantiles of the draws, by name."""
    # The instrument that read the colour is off by some share of it, whatever the lobe.
    noise = np.random.default_rng([seed, 1]).standard_normal(len(body))
    read = body + posed.colour.relative_error * noise * posed.colour.luminous
    angles = sorted(SPECULAR)
    at_centre, of_draws = (_all_gloss(posed, group, angles) for group in (centre[None], surfaces))
    centre_body = posed.diffuse_y(posed.gray(centre[None]))
    (log_s, main), (log_s2, second) = model.lobes(surfaces)
    (c_log_s, c_main), (c_log_s2, c_second) = model.lobes(centre[None])
    table = {
        "s_deg": (np.exp(c_log_s), np.exp(log_s)),
        "strength": (c_main, main),
        "refractive_index": (centre[None, prior.INDEX], surfaces[:, prior.INDEX]),
        "second_s_deg": (np.exp(c_log_s2), np.exp(log_s2)),
        "second_strength": (c_second, second),
        "diffuse_y": (centre_body, np.maximum(read, 0.0)),
        "peak": (model.peaks(centre[None], centre_body), peaks),
    }
    for k, angle in enumerate(angles):
        table[f"gloss-{angle}"] = at_centre[:, k], of_draws[:, k]
    return {name: _interval(float(value[0]), values) for name, (value, values) in table.items()}


def _interval(value: float, draws: Array) -> Interval:
    """The quantiles of the draws, widened to hold the value: where the draws lie along a bent line,
    the best surface may be at its end."""
    low, high = (float(q) for q in np.quantile(draws, TAILS))
    return Interval(*(_rounded(number) for number in (value, min(low, value), max(high, value))))


def _all_gloss(posed: Problem, surfaces: Array, angles: list[int]) -> Array:
    body = posed.diffuse_y(posed.gray(surfaces))
    return model.lobe_readings(surfaces, angles) + body[:, None] * model.diffuse_units(angles)


def _central(posed: Problem, surfaces: Array) -> Array:
    """The most plausible surface (5,): what the readings leave open is as the prior prefers it.

    The least sum of the readings' squared misfits and of squared distances: of the index and the
    strength from the prior's best, and of the second lobe, of which the prior prefers none, from
    the middle of the draws. By Gauss and Newton's method from the best draw.
    """
    middle, spread = np.mean(surfaces, axis=0), np.std(surfaces, axis=0)
    step = 1e-4 * (prior.UPPER - prior.LOWER)
    second = [prior.RATIO, prior.SHARE]
    facets_alone = not posed.beyond_facets(surfaces)

    def residual(group: Array) -> Array:
        strength = group[:, prior.STRENGTH] - 1.0
        preferred = np.stack(
            [
                (group[:, prior.INDEX] - prior.INDEX_MEAN) / prior.INDEX_SD,
                strength / np.where(strength < 0.0, STRENGTH_BELOW, prior.STRENGTH_SD),
            ],
            axis=1,
        )
        broad = SECOND_HELD * (group - middle)[:, second] / (spread[second] + step[second])
        return np.concatenate(
            [posed.misfit(group, facets_alone=facets_alone), preferred, broad], axis=1
        )

    def held(surface: Array) -> Array:
        return np.asarray(np.clip(surface, prior.LOWER + step, prior.UPPER - step))

    # All draws agree with the readings, within their errors: the most preferred is the start.
    squares = residual(surfaces) ** 2
    known = squares.shape[1] - 4
    losses = DRAWN_WEIGHT * squares[:, :known].sum(axis=1) + squares[:, known:].sum(axis=1)
    present = held(surfaces[np.argmin(losses)])
    best = float(np.sum(residual(present[None]) ** 2))
    for _ in range(REFINING_STEPS):
        group = np.concatenate([present[None], present + np.diag(step)])
        values = residual(group)
        slope = ((values[1:] - values[0]) / step[:, None]).T
        # The width has no preference of its own: a little damping holds it where nothing is known.
        damped = np.concatenate([slope, np.diag(DAMPING / (prior.UPPER - prior.LOWER))])
        move = np.linalg.lstsq(damped, np.concatenate([-values[0], np.zeros(5)]), rcond=None)[0]
        tried = [held(present + part * move) for part in (1.0, 0.5, 0.25, 0.1)]
        losses = np.sum(residual(np.array(tried)) ** 2, axis=1)
        k = int(np.argmin(losses))
        if losses[k] >= best * (1.0 - 1e-6):
            break
        present, best = tried[k], float(losses[k])
    return present


def _standing_for(share: float, peaks: Array, density: Array) -> int:
    """The most plausible draw among those about a quantile of the peak."""
    order = np.argsort(peaks)
    middle = round(share * (len(peaks) - 1))
    reach = max(round(NEAR * len(peaks)), 1)
    near = order[max(middle - reach, 0) : middle + reach + 1]
    return int(near[np.argmax(density[near])])
