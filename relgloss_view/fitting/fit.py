"""Measurement -> Material: the smallest reflection model that describes the samples.

Separable least squares in the logarithm, robust, with no start values from the user; a ladder of
models chosen by cross-validation over incidence planes; and a verdict that says what the samples
cannot tell. The parts are in relgloss_view.fitting.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from relgloss_view.base.errors import InputError
from relgloss_view.fitting import ladder, verdict
from relgloss_view.fitting.evidence import main_lobe, record_fit, with_energy_warning
from relgloss_view.fitting.ladder import Candidate, Progress
from relgloss_view.fitting.model import INDEX_RANGE, REDESCENDING, Rung, State, mean_error, predict
from relgloss_view.fitting.samples import Samples, compress, prepare, usable_rows
from relgloss_view.fitting.shapes import Geometry, geometry
from relgloss_view.fitting.solver import Problem
from relgloss_view.material.material import Diffuse, FitRecord, Lobe, Material
from relgloss_view.measure.table import Measurement

MODELS = ladder.MODELS
_FINAL_ROUNDS = 40
_HIGHLIGHT_COST = 1.05
_FLAT_SIGMA = 0.005  #: rad; Oren-Nayar below this differs from Lambert by less than 0.02 %


def fit_material(
    measurement: Measurement,
    *,
    model: str = "auto",
    refractive_index: float = 1.5,
    aperture_sd_deg: tuple[float, float] | None = None,
    seed: int = 0,
    progress: Progress | None = None,
    free_index: bool = True,
    start_s_deg: float | None = None,
) -> Material:
    """Fit the reflection models of the ladder and return the smallest that is enough.

    model: 'auto', or a rung by name (MODELS). refractive_index: held; freed only where the samples
    support it, never with free_index=False. aperture_sd_deg: per-axis angular sd of lamp and
    receiver instead of the measurement's. seed: of the random folds used where a measurement names
    fewer than four groups. progress(fraction, text): called regularly; answering False raises
    FitCancelled. start_s_deg: anchors the scan of lobe widths (for tests of independence).

    Raises InputError for an unknown model, an index outside 1 to 10 or too few samples.
    """
    if model not in MODELS:
        raise InputError(f"model is {model!r}; expected one of {', '.join(MODELS)}")
    if not 1.0 < refractive_index <= INDEX_RANGE[1]:
        raise InputError(
            f"refractive index is {refractive_index:g}; expected above 1, at most "
            f"{INDEX_RANGE[1]:g}"
        )
    began = time.perf_counter()
    if aperture_sd_deg is not None:
        measurement = replace(measurement, aperture_sd_deg=aperture_sd_deg)
    rows = usable_rows(measurement)
    full = prepare(measurement, seed)
    few = compress(full)
    g = geometry(full.to_lamp, full.to_receiver, measurement.aperture_sd_deg)

    rungs = ladder.LADDER if model == "auto" else _forced(model)
    candidates, folds = ladder.climb(g, few, rungs, refractive_index, progress, start_s_deg)
    chosen = ladder.choose(candidates)
    best = candidates[chosen]
    if free_index:
        ladder.report(progress, 0.9, "refractive index")
        freed = ladder.free_index(g, few, folds, best)
        if freed is not None:
            candidates.insert(chosen + 1, freed)
            if not ladder.enough(best, freed, ladder.RELEVANT_SHARE_INDEX):
                best = freed
    ladder.report(progress, 0.95, "all bands")
    state = _all_bands(g, full, best)
    record = record_fit(measurement, rows, g, full, few, candidates, best, state, seed)
    state, record = _settle_width(g, full, few, best, state, record)
    ladder.report(progress, 1.0, "done")
    record = replace(record, seconds=round(time.perf_counter() - began, 3))
    try:
        return with_energy_warning(_material(measurement, best, state, record))
    except InputError as error:
        raise InputError(
            f"{measurement.place}: the fit is no material: {error}; check the quantity and its unit"
        ) from error


def _forced(model: str) -> tuple[Rung, ...]:
    # Two lobes may be neutral or not: the samples decide.
    names = (model, "two-spectral-lobes") if model == "two-lobes" else (model,)
    return tuple(rung for rung in ladder.LADDER if rung.name in names)


def _all_bands(g: Geometry, full: Samples, best: Candidate) -> State:
    """The chosen model refined on every band; strongest lobe first, absent lobes dropped."""
    few = best.solution.state
    problem = Problem(g, full, best.rung)
    columns, _ = problem.columns(few.t, few.log_s, few.n)
    kd, ks = problem.first_guess(columns, 3)
    if best.rung.lobes:
        mean = np.mean(few.ks, axis=1, keepdims=True)
        ks = np.where(np.mean(ks, axis=1, keepdims=True) > 0.0, ks, mean)
    start = replace(few, kd=kd, ks=ks)
    state = _settle(g, full, best.rung, problem.refine(start, _FINAL_ROUNDS).state)
    # A channel that is outside the gamut nearly everywhere has no diffuse part to speak of; what
    # the fit leaves there stands for the foot of the lobe.
    outside = verdict.mostly_outside(full)
    return replace(state, kd=np.where(outside, 0.0, state.kd))


def _settle(g: Geometry, full: Samples, rung: Rung, state: State) -> State:
    """Descend on from the optimum of soft-L1 with a loss that lets go of what no model reaches.

    The diffuse part then follows most of the surface. Letting go must not cost the highlight, which
    is what the fit is for: otherwise the optimum of soft-L1 stands.
    """
    settled = Problem(g, full, rung, REDESCENDING).refine(state, _FINAL_ROUNDS).state
    near = np.sqrt(g.facing.delta2) < np.radians(verdict.NEAR_MIRROR_DEG)
    if not np.any(near):
        return settled
    before, after = (
        mean_error(full.subset(near), predict(g.subset(near), s)) for s in (state, settled)
    )
    return settled if after <= before * _HIGHLIGHT_COST else state


def _settle_width(
    g: Geometry, full: Samples, few: Samples, best: Candidate, state: State, record: FitRecord
) -> tuple[State, FitRecord]:
    """Where the samples set no lower bound on the main lobe's width, take the plainest width.

    That is the one at which the strength is that of a smooth interface, one, or the nearest to it
    that the samples allow.
    """
    bounds = record.bounds.get("main_lobe")
    if record.quality != "unidentifiable" or bounds is None:
        return state, record
    main = main_lobe(state)
    problem = Problem(g, full, best.rung)
    upper = float(np.log(np.radians(bounds["s_deg_upper"])))
    options = []
    for log_s in np.linspace(np.log(np.radians(0.05)), upper, 13):
        moved = state.log_s.copy()
        moved[main] = log_s
        columns, _ = problem.columns(state.t, moved, state.n)
        kd, ks = problem.first_guess(columns, 6)
        strength = float(np.mean(ks[main]))
        distance = abs(np.log(max(strength, 1e-12)))
        options.append((distance, replace(state, log_s=moved, kd=kd, ks=ks)))
    return min(options, key=lambda item: item[0])[1], record


def _material(
    measurement: Measurement, best: Candidate, state: State, record: FitRecord
) -> Material:
    sigma = float(np.sqrt(state.t))
    flat = sigma < _FLAT_SIGMA
    lobes = []
    for j in np.argsort(-np.mean(state.ks, axis=1)) if best.rung.lobes else ():
        strength = state.ks[j]
        if not np.any(strength > 0.0):
            continue
        values = strength if best.rung.spectral else strength[:1]
        lobes.append(
            Lobe(
                tuple(float(v) for v in values),
                float(np.degrees(np.exp(state.log_s[j]))),
                float(state.n[j]),
            )
        )
    return Material(
        name=measurement.name,
        source=measurement.source,
        bands=measurement.bands,
        diffuse=Diffuse(
            "lambert" if flat else "oren-nayar",
            tuple(float(k) for k in state.kd),
            0.0 if flat else float(np.degrees(sigma)),
        ),
        specular=tuple(lobes),
        fit=record,
    )
