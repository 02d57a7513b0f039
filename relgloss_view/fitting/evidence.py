"""The evidence that a fit leaves in the material: candidates, residuals, bounds, warnings."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from relgloss_view.fitting import ladder, verdict
from relgloss_view.fitting.ladder import Candidate
from relgloss_view.fitting.model import State, predict
from relgloss_view.fitting.samples import Samples
from relgloss_view.fitting.shapes import Geometry
from relgloss_view.material.albedo import directional_albedo
from relgloss_view.material.material import FitRecord, Material
from relgloss_view.measure.table import Measurement

#: Widths below this (radians) reach the end of the search: the samples set no lower bound.
NO_LOWER_BOUND = float(np.radians(0.06))


#: Incidences at which the energy of a fit is looked at; grazing light beyond is little.
ENERGY_INCIDENCES_DEG = np.arange(0.0, 81.0, 10.0)
ENERGY_EXCESS = 1.02  #: noise of a white sample is not an excess


def with_energy_warning(material: Material) -> Material:
    """The material, warned of where it reflects more than it receives.

    The samples end at some incidence; beyond it only the model speaks, and strengths above one
    then meet a Fresnel reflectance that goes to one.
    """
    diffuse, specular = directional_albedo(material, ENERGY_INCIDENCES_DEG)
    largest = np.max(diffuse + specular, axis=1)
    if material.fit is None or not np.any(largest > ENERGY_EXCESS):
        return material
    first = ENERGY_INCIDENCES_DEG[np.argmax(largest > ENERGY_EXCESS)]
    last = ENERGY_INCIDENCES_DEG[-1]
    text = (
        f"the model reflects more light than it receives at {first:g} deg of incidence and more "
        f"({largest[-1]:.2g} times at {last:g} deg): pictures are too bright there"
    )
    return replace(material, fit=replace(material.fit, warnings=(*material.fit.warnings, text)))


def main_lobe(state: State) -> int:
    """Number of the lobe with the greatest mean strength."""
    return int(np.argmax(np.mean(state.ks, axis=1)))


def record_fit(
    measurement: Measurement,
    rows: NDArray[np.bool_],
    g: Geometry,
    full: Samples,
    few: Samples,
    candidates: list[Candidate],
    best: Candidate,
    state: State,
    seed: int,
) -> FitRecord:
    """The record of a fit: `state` on all bands, the candidates on the few of the search."""
    metrics = verdict.residuals(measurement, rows, g, full, predict(g, state))
    bounds: dict[str, Any] = {}
    warnings = list(measurement.warnings)
    quality = "good"
    if verdict.is_poor(metrics):
        quality = "poor"
        near = metrics["near_mirror"]["median_relative_error"]
        beside = f", {near:.0%} within {verdict.NEAR_MIRROR_DEG:g} deg of mirror" if near else ""
        warnings.append(
            f"no model describes this sample: median relative error "
            f"{metrics['median_relative_error']:.0%}{beside}"
        )
    has_lobe = best.rung.lobes > 0 and bool(np.any(best.solution.state.ks > 0.0))
    if has_lobe:
        main = main_lobe(best.solution.state)
        low, high = verdict.width_interval(g, few, best, main)
        unseen = low < NO_LOWER_BOUND or not verdict.width_is_seen(
            g, few, best.solution.state, main
        )
        bounds["main_lobe"] = {
            "s_deg_lower": None if unseen else _round(np.degrees(low)),
            "s_deg_upper": _round(np.degrees(high)),
        }
        if unseen:
            quality = "unidentifiable" if quality == "good" else quality
            warnings.append(
                "the lobe is narrower than the grid sees: s is unidentifiable, at most "
                f"{np.degrees(high):.2g} deg; a finer scan across the mirror direction would tell"
            )
        bounds["refractive_index"] = {
            "held": not best.rung.free_index,
            "correlation_with_strength": verdict.index_against_strength(g, few, best),
            "note": "index and strength hide behind one another; strengths are for this index",
        }
    else:
        index = float(candidates[-1].solution.state.n[0]) if candidates[-1].rung.lobes else 1.5
        bounds["no_lobe"] = verdict.null_bounds(g, few, best.solution.state, index)
    evidence = _evidence(g, few, full.bands, candidates, best)
    return FitRecord(
        candidates=tuple(evidence),
        chosen=best.name,
        residuals=metrics,
        quality=quality,
        warnings=tuple(warnings),
        seed=seed,
        standard_errors=verdict.standard_errors(best),
        bounds=bounds,
    )


def _evidence(
    g: Geometry, few: Samples, bands: int, candidates: list[Candidate], best: Candidate
) -> list[dict[str, Any]]:
    lowest = min(candidates, key=lambda c: c.cv_mean)
    values = int(np.sum(few.weight > 0.0))
    rows = []
    for c in candidates:
        model = predict(g, c.solution.state)
        seen = (few.value > 0.0) & (few.weight > 0.0)
        relative = np.abs(model - few.value)[seen] / few.value[seen]
        mean, se = ladder.gain(c, lowest)
        k = c.rung.parameters(few.bands)
        spread = values * np.log(max(c.error, 1e-12))
        rows.append(
            {
                "name": c.name,
                "parameters": c.rung.parameters(bands),
                "loss": _round(c.solution.loss),
                "error": _round(c.error),
                "rms_log_error": _round(ladder.rms_log_error(few, model)),
                "median_relative_error": _round(float(np.median(relative))),
                "cv_mean": _round(c.cv_mean),
                "cv_se": _round(c.cv_se),
                "behind_best": _round(mean),
                "behind_best_se": _round(se),
                "aicc": _round(spread + 2.0 * k * values / max(values - k - 1, 1)),
                "bic": _round(spread + k * np.log(values)),
                "s_deg": [_round(x) for x in np.degrees(np.exp(c.solution.state.log_s))],
                "strength": [_round(x) for x in np.mean(c.solution.state.ks, axis=1)],
                "refractive_index": [_round(x) for x in c.solution.state.n],
                "sigma_deg": _round(np.degrees(np.sqrt(c.solution.state.t))),
                "converged": c.solution.converged,
                "verdict": "chosen" if c is best else _why_not(c, best),
            }
        )
    return rows


def _why_not(c: Candidate, best: Candidate) -> str:
    if c.rung.parameters(1000) < best.rung.parameters(1000):
        mean, se = ladder.gain(c, best)
        return f"too small: {mean:.2g} worse (se {se:.1g})"
    mean, se = ladder.gain(best, c)
    if mean <= 0.0:
        return "larger, and no better held out"
    if mean <= se:
        return f"gains {mean:.2g}, within one standard error ({se:.1g})"
    return f"gains {mean:.2g}, too little to matter"


def _round(value: float) -> float:
    return float(f"{value:.4g}")
