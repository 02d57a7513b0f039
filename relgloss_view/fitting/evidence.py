"""The evidence that a fit leaves in the material: candidates, residuals, bounds, warnings."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.fitting import ladder, selection, verdict
from relgloss_view.fitting.choice import Choice
from relgloss_view.fitting.covariance import names_of, prior_covariance, sample_covariance
from relgloss_view.fitting.instrument import instrument_of
from relgloss_view.fitting.ladder import Candidate
from relgloss_view.fitting.limits import OPTICAL_INDEX, USUAL_INDEX, at_limits
from relgloss_view.fitting.model import State, brightness, lobe_order, predict
from relgloss_view.fitting.results import CandidateEvidence, Verdict
from relgloss_view.material.albedo import directional_albedo
from relgloss_view.material.material import FitRecord, Material, Quality

#: Incidences at which the energy of a fit is checked; grazing light beyond is little.
ENERGY_INCIDENCES_DEG = np.arange(0.0, 81.0, 10.0)
#: Prior standard deviations beyond which an error is none of an instrument in order.
BEYOND_SD = 3.0
LARGEST_VARIANCE = 1e9
APERTURE_MATTERS_DEG = 5.0  #: no aperture in use blurs a wider lobe by much
#: How likely another explanation is that counts, and what of the peak it may leave open: what is
#: named, and what makes the fit unidentifiable.
LIKELY, PEAK_NAMED, PEAK_OPEN = 0.3, 0.10, 0.25
ENERGY_EXCESS = 1.02  #: noise of a white sample is not an excess
ENERGY_IMPOSSIBLE = 1.2  #: fluorescence and an ill-calibrated white stay below


@dataclass(frozen=True)
class ChosenFit:
    """A chosen candidate with all that its verdict rests on."""

    choice: Choice
    state: State  #: of the best candidate, on all bands
    spread: Candidate  #: the best candidate where what its samples may leave open is otherwise
    serious: tuple[str, ...] = ()  #: what the table shows by itself, for which no fit is good
    misread: bool = False  #: whether the table shows its mirror direction elsewhere
    part: str = ""  #: how much of a large table it was refined on; '': all


def judge(fit: ChosenFit) -> Verdict:
    """The verdict on a fit: residuals on all bands, bounds on the few of the search."""
    best, few = fit.choice.best, fit.choice.few
    residuals = verdict.residuals(
        fit.choice.measurement, fit.choice.full, predict(fit.choice.full.geometry, fit.state)
    )
    poor = [*fit.serious]
    if residuals.poor:
        near = residuals.near_mirror.median_relative_error
        beside = f", {near:.0%} within {verdict.NEAR_MIRROR_DEG:g} deg of mirror" if near else ""
        poor.append(
            f"no model describes this sample: median relative error "
            f"{residuals.median_relative_error:.0%}{beside}"
        )
    limits = at_limits(best.rung, fit.state) + at_limits(
        fit.spread.rung, fit.spread.solution.state, names=few.error_names
    )
    if limits:
        poor.append(
            f"poor: the fit stopped at a limit of its search ({', '.join(dict.fromkeys(limits))}): "
            "no value within the allowed range fits. Do not use its numbers"
        )
    odd = _odd_index(fit)
    if odd and not fit.choice.measurement.tabulated:
        poor.append(
            f"poor: {odd}: check the quantity and the lamp's constancy, and read gloss from the "
            "table itself"
        )
    poor.append(_beyond(fit))
    ambiguity = _ambiguity(fit)
    unidentifiable = [
        "" if fit.misread else verdict.unseen_highlight(fit.choice.full, fit.state),
        "" if odd else _unusual_index(fit),
        ambiguity[1] if ambiguity is not None and ambiguity[0] else "",
    ]
    width, index, no_lobe = None, None, None
    if best.rung.lobes > 0 and np.any(best.solution.state.ks > 0.0):
        width = verdict.width_bounds(few, best)
        if best.rung.metals == 0:
            index = verdict.index_bounds(few, best)
        if width.s_deg_lower is None:
            unidentifiable.append(
                "the lobe is narrower than the grid sees: s is unidentifiable, at most "
                f"{width.s_deg_upper:.2g} deg; a finer scan across the mirror direction would "
                "show it"
            )
    else:
        largest = fit.choice.candidates[-1]
        n = float(largest.solution.state.n[0]) if largest.rung.lobes else 1.5
        no_lobe = verdict.no_lobe_bounds(few, best.solution.state, n)
    warnings = tuple(
        (quality, text)
        for quality, texts in ((Quality.POOR, poor), (Quality.UNIDENTIFIABLE, unidentifiable))
        for text in texts
        if text
    )
    quality = warnings[0][0] if warnings else Quality.GOOD
    return Verdict(residuals, quality, warnings, width, index, no_lobe)


def record_fit(fit: ChosenFit, judged: Verdict, seed: int) -> FitRecord:
    """The record that goes into the material's file."""
    bounds = {
        "main_lobe": judged.width,
        "refractive_index": judged.index,
        "no_lobe": judged.no_lobe,
    }
    grounds = tuple(text for quality, text in judged.warnings if quality == judged.quality)
    residuals = asdict(judged.residuals)
    errors = verdict.standard_errors(fit.spread, lobe_order(fit.state))
    part = selection.words(fit.choice.measurement)
    if part:
        residuals["selected"] = part
    if fit.part:
        errors = replace(errors, method=f"{errors.method}, from {fit.part}")
    return FitRecord(
        candidates=tuple(asdict(evidence) for evidence in _evidence(fit)),
        chosen=fit.choice.best.name,
        residuals=residuals,
        quality=judged.quality,
        warnings=tuple(dict.fromkeys(_warnings(fit, judged))),
        grounds=grounds,
        seed=seed,
        standard_errors=_present(asdict(errors)),
        covariance=_covariance(fit.spread, lobe_order(fit.state)),
        instrument=_instrument(fit),
        bounds={name: asdict(bound) for name, bound in bounds.items() if bound is not None},
    )


def _covariance(spread: Candidate, order: list[int]) -> dict[str, Any]:
    """Both covariances, of the lobes that the material has, numbered as it lists them."""
    names = list(names_of(spread))
    kept = []
    for k, name in enumerate(names):
        what, _, lobe = name.partition(".")
        if what == "error" or (lobe and int(lobe) - 1 not in order):
            continue
        kept.append(k)
        if lobe:
            names[k] = f"{what}.{order.index(int(lobe) - 1) + 1}"
    parts = {"samples": sample_covariance(spread), "priors": prior_covariance(spread)}
    return {
        "names": [names[k] for k in kept],
        **{
            name: [[_round(value) for value in row] for row in _bounded(matrix)[kept][:, kept]]
            for name, matrix in parts.items()
        },
    }


def _bounded(matrix: Array) -> Array:
    """Variances that a file can hold: a number that the samples leave open has none to speak of."""
    return np.asarray(np.clip(matrix, -LARGEST_VARIANCE, LARGEST_VARIANCE))


def _instrument(fit: ChosenFit) -> dict[str, Any]:
    """The errors found, by name; empty where none were fitted."""
    device = instrument_of(fit.choice.measurement)
    if device is None or not fit.spread.rung.errors:
        return {}
    count = device.count
    errors = fit.choice.errors if fit.choice.errors.size else np.zeros(count)
    both = sample_covariance(fit.spread) + prior_covariance(fit.spread)
    sd = np.sqrt(np.diag(both)[-count:])
    angle = [True] * (count - 1) + [False]
    return {
        name: {
            "value": _round(np.degrees(value) if turns else value),
            "standard_error": _round(np.degrees(error) if turns else error),
            "unit": "deg" if turns else "ln of the ratio to the declared spread",
        }
        for name, value, error, turns in zip(device.names, errors, sd, angle, strict=True)
    }


def _beyond(fit: ChosenFit) -> str:
    """A warning where the samples want errors that no instrument in order has, else ''."""
    sd = fit.choice.full.prior_sd
    if not fit.choice.errors.size:
        return ""
    far = np.flatnonzero(np.abs(fit.choice.errors) > BEYOND_SD * sd)
    words = []
    for k in far.tolist():
        error = float(fit.choice.errors[k])
        if k == len(sd) - 1:
            words.append(f"its apertures {np.exp(error):.2g} times as wide as declared")
        else:
            words.append(f"{fit.choice.full.error_names[k]} off by {np.degrees(error):.2g} deg")
    if not words:
        return ""
    return (
        f"poor: the fit needs an instrument with {' and '.join(words)}: check the angles and the "
        "apertures of the table before its numbers are used"
    )


def _warnings(fit: ChosenFit, judged: Verdict) -> tuple[str, ...]:
    odd, ambiguity = _odd_index(fit), _ambiguity(fit)
    warnings = (*fit.choice.measurement.warnings, *(text for _, text in judged.warnings))
    if ambiguity is not None and not ambiguity[0]:
        warnings = (*warnings, ambiguity[1])
    # Tables that their makers resampled have no lamp that fades: there it is a description alone.
    return (*warnings, odd) if odd and fit.choice.measurement.tabulated else warnings


def _ambiguity(fit: ChosenFit) -> tuple[bool, str] | None:
    """Whether an index and errors of the instrument explain the table alike, and how far apart.

    The first is whether the peak is open by more than PEAK_OPEN; None where nothing is to be said.
    """
    rival, best = fit.choice.rival, fit.choice.best
    if rival is None or rival.likelihood < LIKELY or rival.candidate.rung.lobes != best.rung.lobes:
        return None
    ratio = _peak(rival.candidate.solution.state) / _peak(best.solution.state)
    open_by = max(ratio, 1.0 / ratio) - 1.0
    if open_by < PEAK_NAMED:
        return None
    sd = fit.choice.few.prior_sd
    worst = int(np.argmax(np.abs(rival.errors) / sd))
    error = float(rival.errors[worst])
    if worst == len(sd) - 1:
        words = f"apertures {np.exp(error):.2g} times as wide as declared"
    else:
        words = f"{fit.choice.few.error_names[worst]} off by {np.degrees(error):.2g} deg"
    text = (
        f"the samples cannot tell a refractive index of {rival.index:.3g} from {words}, and the "
        f"highlight's peak differs by {open_by:.0%} between the two: declare what the apertures "
        "are (aperture_sd_deg), or hold the index (--refractive-index)"
    )
    return open_by > PEAK_OPEN, f"unidentifiable: {text}" if open_by > PEAK_OPEN else text


def _peak(state: State) -> float:
    """Height of the main lobe at normal incidence, in relative units."""
    main = verdict.main_lobe(state)
    n, s2 = float(state.n[main]), float(np.exp(2.0 * state.log_s[main]))
    return max(float(np.mean(state.ks[main])), 1e-12) * ((n - 1.0) / (n + 1.0)) ** 2 / s2


def _unusual_index(fit: ChosenFit) -> str:
    """A warning where an instrument's table asks for an index that few coatings have, else ''."""
    low, high = USUAL_INDEX
    choice = fit.choice
    if not choice.best.rung.free_index or choice.measurement.tabulated or not len(fit.state.n):
        return ""
    main = verdict.main_lobe(fit.state)
    n, s = float(fit.state.n[main]), float(np.exp(fit.state.log_s[main]))
    if low <= n <= high or s > np.radians(APERTURE_MATTERS_DEG):
        return ""
    return (
        f"unidentifiable: the fitted refractive index {n:.3g} is rare among coatings; apertures "
        "wider than declared, a lamp that drifts or a cosine left in look the same: check "
        "aperture_sd_deg, or hold the index that you know (--refractive-index)"
    )


def _odd_index(fit: ChosenFit) -> str:
    """What to know of the main lobe's freed index where it is that of no dielectric, else ''."""
    low, high = OPTICAL_INDEX
    if not fit.choice.best.rung.free_index or not len(fit.state.n):
        return ""
    n = float(fit.state.n[verdict.main_lobe(fit.state)])
    if low <= n <= high:
        return ""
    return (
        f"the refractive index {n:.3g} only describes how the highlight changes with incidence; it "
        f"is no optical constant (coatings have {low:g} to {high:g})"
    )


def _present(values: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in values.items() if value is not None}


def with_energy_warning(material: Material, steepest_deg: float = 80.0) -> Material:
    """The material, with a warning where it reflects more than it receives.

    Beyond steepest_deg, the last incidence of the samples, the model extrapolates, and strengths
    above one then meet a Fresnel reflectance that goes to one. Before it no surface does so, and
    the fit is poor.
    """
    diffuse, specular = directional_albedo(material, ENERGY_INCIDENCES_DEG)
    largest = np.max(diffuse + specular, axis=1)
    fit = material.fit
    if fit is None or not np.any(largest > ENERGY_EXCESS):
        return material
    first = ENERGY_INCIDENCES_DEG[np.argmax(largest > ENERGY_EXCESS)]
    last = ENERGY_INCIDENCES_DEG[-1]
    text = (
        f"the model reflects more light than it receives at {first:g} deg of incidence and more "
        f"({largest[-1]:.2g} times at {last:g} deg): pictures are too bright there"
    )
    warned = replace(fit, warnings=(*fit.warnings, text))
    seen = largest[steepest_deg >= ENERGY_INCIDENCES_DEG]
    most = float(np.max(seen)) if len(seen) else 0.0
    if most > ENERGY_IMPOSSIBLE:
        text = (
            f"poor: where it was measured the sample would reflect {most:.2g} times the light that "
            "it receives: check the quantity (a BRDF is a radiance factor over pi) and the unit"
        )
        grounds = fit.grounds if fit.quality == Quality.POOR else ()
        warned = replace(
            warned,
            warnings=(*warned.warnings, text),
            grounds=(*grounds, text),
            quality=Quality.POOR,
        )
    return replace(material, fit=warned)


def _evidence(fit: ChosenFit) -> list[CandidateEvidence]:
    few, best = fit.choice.few, fit.choice.best
    lowest = min(fit.choice.candidates, key=lambda c: c.cv_mean)
    values = int(np.sum(few.weight > 0.0))
    evidence = []
    for c in fit.choice.candidates:
        state = c.solution.state
        model = predict(few.geometry, state)
        seen = (few.value > 0.0) & (few.weight > 0.0)
        relative = np.abs(model - few.value)[seen] / few.value[seen]
        mean, se = ladder.gain(c, lowest)
        k = c.rung.parameters(few.bands)
        spread = values * np.log(max(c.error, 1e-12))
        evidence.append(
            CandidateEvidence(
                name=c.name,
                parameters=c.rung.parameters(fit.choice.full.bands),
                loss=_round(c.solution.loss),
                error=_round(c.error),
                rms_log_error=_round(ladder.rms_log_error(few, model)),
                median_relative_error=_round(float(np.median(relative))),
                cv_mean=_round(c.cv_mean),
                cv_se=_round(c.cv_se),
                behind_best=_round(mean),
                behind_best_se=_round(se),
                aicc=_round(spread + 2.0 * k * values / max(values - k - 1, 1)),
                bic=_round(spread + k * np.log(values)),
                s_deg=[_round(x) for x in np.degrees(np.exp(state.log_s))],
                strength=[_round(x) for x in brightness(state)],
                refractive_index=[_round(x) for x in state.n],
                sigma_deg=_round(np.degrees(np.sqrt(state.t))),
                converged=c.solution.converged,
                verdict="chosen" if c is best else _why_not(c, best),
            )
        )
    return evidence


def _why_not(c: Candidate, best: Candidate) -> str:
    if c.rung.parameters(1000) < best.rung.parameters(1000):
        mean, se = ladder.gain(c, best)
        return f"too small: {mean:.2g} worse (se {se:.1g})"
    mean, se = ladder.gain(best, c)
    limits = at_limits(c.rung, c.solution.state)
    if mean > se and limits:
        return f"gains {mean:.2g}, but stopped at a limit: {limits[0]}"
    if mean <= 0.0:
        return "larger, and no better held out"
    if mean <= se:
        return f"gains {mean:.2g}, within one standard error ({se:.1g})"
    return f"gains {mean:.2g}, too little to matter"


def _round(value: float) -> float:
    return float(f"{value:.4g}")
