"""Measurement -> Material: the smallest reflection model that describes the samples.

Separable robust least squares in the logarithm, with no start values from the user; a ladder of
models chosen by cross-validation over incidence planes; and a verdict that lists what the samples
leave open. The parts are in relgloss_view.fitting.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.room import MB, Need, check_room
from relgloss_view.base.terminal import ProgressReport
from relgloss_view.fitting import ladder, metal, selection, verdict
from relgloss_view.fitting.choice import Choice, Options, choose
from relgloss_view.fitting.derived import with_derived
from relgloss_view.fitting.descent import refine
from relgloss_view.fitting.evidence import ChosenFit, judge, record_fit, with_energy_warning
from relgloss_view.fitting.instrument import corrected
from relgloss_view.fitting.ladder import Candidate
from relgloss_view.fitting.model import (
    INDEX_RANGE,
    LOG_S_RANGE,
    REDESCENDING,
    Rung,
    State,
    States,
    lobe_order,
    mean_error,
    predict,
)
from relgloss_view.fitting.observations import Observations, prepare
from relgloss_view.fitting.problem import Problem
from relgloss_view.fitting.selection import MOST_GEOMETRIES, MOST_VALUES, selected
from relgloss_view.fitting.spread import spread as spread_of
from relgloss_view.fitting.use import with_use
from relgloss_view.material.material import Diffuse, FitRecord, Lobe, Material, Quality
from relgloss_view.measure.findings import Examined, examine
from relgloss_view.measure.findings.finding import MIRROR
from relgloss_view.measure.table import Measurement

MODELS = (*ladder.MODELS, *metal.NAMES)
ASSUMED_INDEX = 1.5  #: of a coating or an ink, where the samples do not show another
_FINAL_ROUNDS = 40
_HIGHLIGHT_COST = 1.05
#: Bytes that a fit takes for each geometry: many starts at once, each with its slopes. Measured: 43
#: to 58 kB, for 3,000 to 28,000 geometries in 4 to 120 bands.
_GEOMETRY_BYTES, _FIT_BYTES = 60e3, 60 * MB
_ROW_BYTES = 700  #: of each row, for the checks before a fit
_FLAT_SIGMA = 0.005  #: rad; Oren-Nayar below this differs from Lambert by less than 0.02 %


def fit_material(
    measurement: Measurement,
    *,
    model: str = "auto",
    refractive_index: float | None = None,
    aperture_sd_deg: tuple[float, float] | None = None,
    seed: int = 0,
    progress: ProgressReport | None = None,
    free_index: bool = True,
    start_s_deg: float | None = None,
    free_errors: bool = True,
) -> Material:
    """Fit the reflection models of the ladder and return the smallest that is enough.

    measurement: radiance factors over directions and bands.
    model: 'auto', or one of MODELS to fit that model alone.
    refractive_index: above 1 and at most 10, held. Without one it is 1.5, and the fit varies it
    where the samples support that; never with free_index=False.
    aperture_sd_deg: per-axis angular standard deviations of lamp and receiver, degrees, instead of
    the measurement's.
    seed: of the random folds, used where a measurement names fewer than four groups.
    progress: called with a share from 0 to 1 and a text; returning False raises FitCancelled.
    start_s_deg: anchor of the scan of lobe widths, degrees, for tests of independence.
    free_errors: whether zeros of the instrument's angles and the spread of its apertures are fitted
    too, with priors (fitting.instrument); else, and for a metal, they are as the table declares.

    Returns a Material whose `fit` holds the evidence: candidates, residuals, standard errors,
    quality and warnings. Raises InputError for an unknown model, an index out of range or too few
    samples. Sources of the models: Torrance and Sparrow 1967, Oren and Nayar 1995; docs/method.md.

    >>> from relgloss_view import read_measurement
    >>> from relgloss_view.base.resources import asset
    >>> paper = read_measurement(asset("papers", "art-coated.csv"))
    >>> material = fit_material(paper, model="lobe")
    >>> round(material.specular[0].s_deg, 1), str(material.fit.quality)
    (2.5, 'good')
    """
    if model not in MODELS:
        raise InputError(f"model is {model!r}; expected one of {', '.join(MODELS)}")
    index = ASSUMED_INDEX if refractive_index is None else refractive_index
    if not 1.0 < index <= INDEX_RANGE[1]:
        raise InputError(
            f"refractive index is {index:g}; expected above 1, at most {INDEX_RANGE[1]:g}"
        )
    count = len(measurement.to_lamp)
    check_room(
        Need(_FIT_BYTES + _GEOMETRY_BYTES * min(count, MOST_GEOMETRIES) + _ROW_BYTES * count),
        f"{measurement.place}: a fit of {count} geometries",
        "thin out the table, most of all far from the mirror direction",
    )
    began = time.perf_counter()
    if aperture_sd_deg is not None:
        measurement = replace(measurement, aperture_sd_deg=aperture_sd_deg)
    examined = examine(measurement)
    measurement = replace(
        examined.measurement, warnings=(*examined.measurement.warnings, *examined.texts)
    )
    measurement = selected(measurement, seed)
    uncertain = free_index and refractive_index is None
    options = Options(
        rungs=ladder.LADDER if model == "auto" else _forced(model),
        index=index,
        free_index=uncertain,
        free_errors=free_errors,
        seed=seed,
        start_s_deg=start_s_deg,
        progress=progress,
        metals=model if model in ("auto", *metal.NAMES) else "none",
    )
    choice = choose(measurement, options)
    ladder.report(progress, 0.95, "all bands")
    material = _judged(choice, options, examined)
    if (
        choice.other is not None
        and material.fit is not None
        and material.fit.quality != Quality.GOOD
    ):
        # The samples hardly tell the index by what is held out, but gloss and picture may.
        other = _judged(replace(choice, best=choice.other), options, examined)
        if other.fit is not None and other.fit.quality == Quality.GOOD:
            material = other
    return _timed(material, began, progress)


def _judged(choice: Choice, options: Options, examined: Examined) -> Material:
    """The material of a choice with all that is known of how good it is."""
    whole = _whole(choice, options, examined.measurement)
    spread = spread_of(choice, whole, errors=options.free_errors, index=options.free_index)
    measurement, full, best = choice.measurement, choice.full, choice.best
    misread = any(f.serious and f.kind == MIRROR for f in examined.findings)
    part = selection.counted(whole.counts)
    fit = ChosenFit(choice, _all_bands(whole, best), spread, examined.serious, misread, part)
    judged = judge(fit)
    state = fit.state
    width = judged.width
    if judged.quality == Quality.UNIDENTIFIABLE and width and width.s_deg_lower is None:
        state = _plainest_width(full, best.rung, state, width.s_deg_upper)
    record = record_fit(fit, judged, options.seed)
    if measurement.stands_for is not None:  # a part, of which no row is left out
        left_out = examined.measurement.left_out()
        record = replace(record, residuals={**record.residuals, "left_out": left_out})
    try:
        material = _material(measurement, best.rung, state, record)
        steepest = float(np.degrees(np.arccos(np.min(measurement.to_lamp[measurement.kept, 2]))))
        material = with_energy_warning(material, steepest)
    except InputError as error:
        raise InputError(
            f"{measurement.place}: the fit is no material: {error}; check the quantity and its unit"
        ) from error
    ladder.report(options.progress, 0.97, "gloss and picture")
    material = with_derived(material)
    # A table that is read wrongly has no gloss of its own that a fit could be compared with.
    return material if misread else with_use(material, measurement)


def _timed(material: Material, began: float, progress: ProgressReport | None) -> Material:
    ladder.report(progress, 1.0, "done")
    assert material.fit is not None
    seconds = round(time.perf_counter() - began, 3)
    return replace(material, fit=replace(material.fit, seconds=seconds))


def _forced(model: str) -> tuple[Rung, ...]:
    # Two lobes may be neutral or not: the samples decide.
    names = (model, "two-spectral-lobes") if model == "two-lobes" else (model,)
    if model in metal.NAMES:  # it starts from the rung of that many coloured lobes
        names = (next(coloured for rung, _, coloured in metal.METALS if rung.name == model),)
    return tuple(rung for rung in ladder.LADDER if rung.name in names)


def _all_bands(full: Observations, best: Candidate) -> State:
    """The chosen model refined on every band; strongest lobe first, absent lobes dropped."""
    few = best.solution.state
    problem = Problem(full, best.rung)
    kd, ks = _linear_unknowns(problem, few, rounds=3)
    if best.rung.lobes:
        mean = np.mean(few.ks, axis=1, keepdims=True)
        ks = np.where(np.mean(ks, axis=1, keepdims=True) > 0.0, ks, mean)
    solution = refine(problem, [replace(few, kd=kd, ks=ks)], _FINAL_ROUNDS)[0]
    state = _settle(full, best.rung, solution.state)
    # A channel that is outside the gamut nearly everywhere has no diffuse part to speak of; the
    # fit leaves the foot of the lobe there.
    outside = verdict.mostly_outside(full)
    return replace(state, kd=np.where(outside, 0.0, state.kd))


def _whole(choice: Choice, options: Options, measurement: Measurement) -> Observations:
    """What the chosen model is refined on: of a large table far more than its choice was made on.

    measurement: the whole table, before any correction of the instrument's errors.
    """
    if choice.measurement.stands_for is None:
        return choice.full
    more = selected(measurement, options.seed, MOST_VALUES // measurement.bands.count)
    whole = prepare(corrected(more, choice.errors), options.seed)
    return replace(whole, noise=choice.full.noise)


def _linear_unknowns(problem: Problem, state: State, rounds: int) -> tuple[Array, Array]:
    """Albedos (B,) and strengths (J, B) from scratch at the nonlinear unknowns of a state."""
    states = States.of([state])
    kd, ks = problem.first_guess(problem.columns(states.t, states.log_s, states.n), rounds)
    return kd[0], ks[0]


def _settle(full: Observations, rung: Rung, state: State) -> State:
    """Descend on from the optimum of soft-L1 with a loss that lets go of what no model reaches.

    The diffuse part then follows most of the surface. Letting go must not cost the highlight, which
    is what the fit is for: otherwise the optimum of soft-L1 stays.
    """
    settled = refine(Problem(full, rung, REDESCENDING), [state], _FINAL_ROUNDS)[0].state
    near = np.sqrt(full.geometry.facing.delta2) < np.radians(verdict.NEAR_MIRROR_DEG)
    if not np.any(near):
        return settled
    highlight = full.subset(near)
    before, after = (
        mean_error(highlight, predict(highlight.geometry, s)) for s in (state, settled)
    )
    return settled if after <= before * _HIGHLIGHT_COST else state


def _plainest_width(full: Observations, rung: Rung, state: State, upper_deg: float) -> State:
    """The plainest width of the main lobe where the samples set no lower bound on it.

    That is the one at which the strength is that of a smooth interface, one, or the nearest to it
    that the samples allow.
    """
    main = verdict.main_lobe(state)
    row = rung.lobes + main if main < rung.metals else main
    problem = Problem(full, rung)
    options = []
    for log_s in np.linspace(LOG_S_RANGE[0], float(np.log(np.radians(upper_deg))), 13):
        moved = replace(state, log_s=np.where(np.arange(rung.lobes) == main, log_s, state.log_s))
        kd, ks = _linear_unknowns(problem, moved, rounds=6)
        distance = abs(np.log(max(float(np.mean(ks[row])), 1e-12)))
        options.append((distance, replace(moved, kd=kd, ks=ks)))
    return min(options, key=lambda option: option[0])[1]


def _material(measurement: Measurement, rung: Rung, state: State, record: FitRecord) -> Material:
    sigma = float(np.sqrt(state.t))
    flat = sigma < _FLAT_SIGMA
    lobes = []
    for j in lobe_order(state):
        if j < rung.metals:
            lobes.append(metal.lobe_of(state, j))
            continue
        strength = state.ks[j]
        values = strength if rung.spectral else strength[:1]
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
        synthetic=measurement.synthetic,
    )
