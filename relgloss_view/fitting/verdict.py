"""What a fit may claim: residuals, standard errors, bounds, and whether the sample is described."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.fitting.covariance import jackknife_covariance, names_of, sample_covariance
from relgloss_view.fitting.ladder import Candidate, group_errors
from relgloss_view.fitting.metal import metals_of
from relgloss_view.fitting.model import (
    LOG_S_RANGE,
    State,
    States,
    brightness,
    log_residual,
    predict,
)
from relgloss_view.fitting.observations import Observations
from relgloss_view.fitting.problem import Problem
from relgloss_view.fitting.results import (
    IndexBounds,
    NoLobeBounds,
    Part,
    Residuals,
    StandardErrors,
    WidthBounds,
)
from relgloss_view.fitting.shapes import lobe_columns, metal_columns
from relgloss_view.measure.table import Measurement
from relgloss_view.measure.thinning import mean, percentile

NEAR_MIRROR_DEG = 5.0  #: half-vector within this of the normal
PROFILE_STEPS = 25
_BISECTIONS = 5
#: Rise of the logarithmic error that a profile may have and still be called flat.
FLAT = 1e-4
FLANK_SD = (0.5, 3.0)  #: standard deviations from a lobe's peak between which its width shows
FEWEST_ON_FLANK = 3
#: Widths below this (radians) reach the end of the search: the samples set no lower bound.
NO_LOWER_BOUND = float(np.radians(0.06))
UNSEEN_DEG = 1.0  #: of half-vectors; a finer gap hides a mirror's highlight alone
#: Of a smooth dielectric's one: what a printed surface's highlight carries at least.
INTERFACE_STRENGTH = 0.25
NULL_WIDTHS_DEG = (0.1, 0.3, 1.0, 3.0, 10.0)
_LARGEST_STRENGTH = 1e4


def residuals(measurement: Measurement, observations: Observations, model: Array) -> Residuals:
    """How far a model (N, B) is from the observations of a measurement."""
    value, facing = observations.value, observations.geometry.facing
    outside = mostly_outside(observations)
    seen = (value > 0.0) & (observations.weight > 0.0) & ~outside
    relative = np.abs(model - value)[seen] / value[seen]
    near = np.sqrt(facing.delta2) < np.radians(NEAR_MIRROR_DEG)
    near = np.broadcast_to(near[:, None], seen.shape)[seen]
    log = log_residual(observations, model)[seen]
    cosine = (facing.mu_i * facing.mu_o)[:, None]
    linear = ((model - value) * cosine / np.pi)[seen]
    root = (np.cbrt(model * cosine / np.pi) - np.cbrt(value * cosine / np.pi))[seen]
    counts = observations.counts
    if counts is not None:
        counts = np.broadcast_to(counts[:, None], value.shape)[seen]

    def part(rows: Mask) -> Part:
        values, some = relative[rows], None if counts is None else counts[rows]
        return Part(_round(percentile(values, 50.0, some)) if values.size else None, values.size)

    return Residuals(
        median_relative_error=part(np.full(len(relative), True)).median_relative_error,
        p90_relative_error=_round(percentile(relative, 90.0, counts)),
        rms_log_error=_round(float(np.sqrt(mean(log**2, counts)))),
        near_mirror=part(near),
        far=part(~near),
        near_mirror_deg=NEAR_MIRROR_DEG,
        cosine_weighted_rms=_round(float(np.sqrt(mean(linear**2, counts)))),
        cube_root_rms=_round(float(np.sqrt(mean(root**2, counts)))),
        samples=len(value),
        values=int(seen.sum()),
        left_out=measurement.left_out(),
        values_not_positive=int(((value <= 0.0) & (observations.weight > 0.0)).sum()),
        channels_outside_gamut=np.flatnonzero(outside).tolist(),
        aperture_sd_deg=list(measurement.aperture_sd_deg),
    )


def mostly_outside(observations: Observations) -> Mask:
    """(B,), channels of linear sRGB that are not positive in most samples.

    Relative errors mean nothing there: the few positive values are differences of large numbers.
    (Spectral bands have no weight where they are not positive, so none of them is marked.)
    """
    positive = np.sum((observations.value > 0.0) & (observations.weight > 0.0), axis=0)
    return np.asarray(positive < 0.5 * np.sum(observations.weight > 0.0, axis=0))


def standard_errors(candidate: Candidate, order: Sequence[int] | None = None) -> StandardErrors:
    """Standard errors from the samples' noise; of the albedos the median over bands.

    order: of the lobes; that of the candidate without one.
    """
    states, rung = States.of(candidate.fold_states), candidate.rung
    order = range(rung.lobes) if order is None else order
    names = names_of(candidate)
    sd = np.sqrt(np.maximum(np.diag(sample_covariance(candidate)), 0.0))
    error = {name: _round(float(value)) for name, value in zip(names, sd, strict=True)}
    mean = np.maximum(np.mean(states.kd, axis=0), 1e-9)
    bands = np.diag(jackknife_covariance(states.kd / mean)).copy()
    method = f"jackknife over {len(states)} groups"
    for low, high in candidate.shared_states:
        bands += (0.5 * (high.kd - low.kd) / mean) ** 2
    if candidate.shared_states:
        method += ", zero level of the readings"

    def each(name: str) -> list[float]:
        return [error[f"{name}.{j + 1}"] for j in order]

    return StandardErrors(
        method,
        _round(float(np.median(np.sqrt(bands)))),
        sigma_deg=error.get("sigma_deg"),
        s_deg=each("s_deg") if rung.lobes else None,
        strength=each("strength") if rung.lobes else None,
        refractive_index=each("refractive_index") if rung.lobes and rung.free_index else None,
    )


def index_bounds(observations: Observations, candidate: Candidate) -> IndexBounds:
    """Correlation of refractive index and strength of the first lobe, were both free.

    The candidate has a lobe. The correlation is None where the samples do not show that lobe.
    """
    state = candidate.solution.state
    rung = replace(candidate.rung, spectral=False, free_index=True)
    neutral = np.repeat(np.mean(state.ks, 1, keepdims=True), observations.bands, 1)
    states = States.of([replace(state, ks=neutral)])
    problem = Problem(observations, rung)
    columns = problem.columns(states.t, states.log_s, states.n)
    misfit = problem.misfit(problem.model(columns, states.kd, states.ks))
    equations = problem.equations(columns, misfit, states)
    own = equations.own[0, :, 0, 0]
    cross = equations.cross[0, own > 0.0, 0]
    schur = equations.shared[0] - cross.T @ (cross / own[own > 0.0, None])
    size = np.sqrt(np.maximum(np.diag(schur), 0.0))
    correlation = None
    if np.all(size > 0.0):
        covariance = np.linalg.pinv(schur / size[:, None] / size)
        a, b = problem.unknowns.n.start, problem.unknowns.ks.start
        product = covariance[a, a] * covariance[b, b]
        if product > 0.0:
            correlation = _round(float(covariance[a, b] / np.sqrt(product)))
    return IndexBounds(not candidate.rung.free_index, correlation)


def width_bounds(observations: Observations, candidate: Candidate) -> WidthBounds:
    """The widths of the main lobe that fit the samples no worse than the fitted one."""
    state = candidate.solution.state
    main = main_lobe(state)
    low, high = width_interval(observations, candidate, main)
    resolved = low >= NO_LOWER_BOUND and width_is_seen(observations, state, main)
    return WidthBounds(
        _round(float(np.degrees(low))) if resolved else None, _round(float(np.degrees(high)))
    )


def main_lobe(state: State) -> int:
    """Number of the lobe with the greatest mean strength."""
    return int(np.argmax(brightness(state)))


def width_interval(observations: Observations, candidate: Candidate, lobe: int) -> Array:
    """(2,), radians: the widths of a lobe that fit no worse than the fitted one.

    The linear unknowns are fitted again at each width. A width is as good when its error rises by
    no more than one standard error over groups, or by nothing to speak of.
    """
    state = candidate.solution.state
    problem = Problem(observations, candidate.rung)
    base = group_errors(observations, predict(observations.geometry, state))
    fitted = float(state.log_s[lobe])
    states = States.of([state])
    peak = float(np.max(problem.columns(states.t, states.log_s, states.n)[0, 2 + lobe]))

    def as_good(log_s: float) -> bool:
        moved = states.log_s.copy()
        moved[0, lobe] = log_s
        columns = problem.columns(states.t, moved, states.n)
        now = float(np.max(columns[0, 2 + lobe]))
        ks = states.ks.copy()
        ks[0, lobe] *= peak / max(now, 1e-30)
        kd, ks = problem.inner(columns, states.kd, ks, 3)
        rise = group_errors(observations, problem.model(columns, kd, ks)[0].T) - base
        return float(np.mean(rise)) <= max(_standard_error(rise), FLAT)

    grid = np.linspace(*LOG_S_RANGE, PROFILE_STEPS)
    ends = []
    for side in (grid[grid < fitted][::-1], grid[grid > fitted]):
        good: float = fitted
        bad: float | None = None
        for log_s in side:
            if not as_good(float(log_s)):
                bad = float(log_s)
                break
            good = float(log_s)
        for _ in range(_BISECTIONS):
            if bad is None:
                break
            middle = 0.5 * (good + bad)
            good, bad = (middle, bad) if as_good(middle) else (good, middle)
        ends.append(good)
    return np.asarray(np.exp(np.array(ends)))


def _standard_error(rise: Array) -> float:
    return float(np.std(rise, ddof=1) / np.sqrt(len(rise))) if len(rise) > 1 else 0.0


def width_is_seen(observations: Observations, state: State, lobe: int) -> bool:
    """Whether samples lie on the flank of a lobe, where its width shows.

    A peak sample alone gives strength over width squared; samples far down the foot give a width
    only if the lobe is Gaussian there, which no real one is.
    """
    g = observations.geometry
    s2 = float(np.exp(2.0 * state.log_s[lobe]))
    sd2 = g.along / (s2 + g.blur_along) + g.across / (s2 + g.blur_across)
    if lobe < metals_of(state):
        column = metal_columns(g, float(state.log_s[lobe]))[0]
    else:
        column, _ = lobe_columns(g, float(state.log_s[lobe]), float(state.n[lobe]))
    share = np.multiply.outer(column, state.ks[lobe]) / np.maximum(predict(g, state), 1e-12)
    flank = (sd2 >= FLANK_SD[0] ** 2) & (sd2 <= FLANK_SD[1] ** 2) & (np.max(share, axis=1) > 0.1)
    weighted = np.any(observations.weight > 0.0, axis=1)
    return int(np.sum(flank & weighted)) >= FEWEST_ON_FLANK


def unseen_highlight(observations: Observations, state: State) -> str:
    """A warning where samples near the mirror direction are missing that a highlight may hide in.

    The flanks of a lobe show it (FLANK_SD) if it carries the light of an interface; a weak foot far
    out may belong to a highlight that no sample shows.
    """
    seen = np.any(observations.weight > 0.0, axis=1)
    nearest = float(np.sqrt(np.min(observations.geometry.facing.delta2[seen])))
    if nearest <= np.radians(UNSEEN_DEG):
        return ""
    if len(state.ks) and np.any(state.ks > 0.0):
        s = float(np.exp(np.max(state.log_s)))
        if nearest <= FLANK_SD[1] * s and np.sum(np.mean(state.ks, axis=1)) >= INTERFACE_STRENGTH:
            return ""
    return (
        f"unidentifiable: no sample lies within {np.degrees(nearest):.2g} deg of the mirror "
        "direction, so a highlight narrower than that would not be seen: measure there"
    )


def no_lobe_bounds(observations: Observations, state: State, n: float) -> NoLobeBounds:
    """What lobes of refractive index n could hide in samples fitted without one."""
    g = observations.geometry
    base_model = predict(g, state)
    base = group_errors(observations, base_model)

    def visible(lobe: Array, strength: float) -> bool:
        rise = group_errors(observations, base_model + strength * lobe[:, None]) - base
        return float(np.mean(rise)) > max(2.0 * _standard_error(rise), FLAT)

    upper: list[float | None] = []
    for s_deg in NULL_WIDTHS_DEG:
        lobe, _ = lobe_columns(g, float(np.log(np.radians(s_deg))), n)
        if not visible(lobe, _LARGEST_STRENGTH):
            upper.append(None)
            continue
        low, high = 1e-8, _LARGEST_STRENGTH
        for _ in range(24):
            middle = float(np.sqrt(low * high))
            if visible(lobe, middle):
                high = middle
            else:
                low = middle
        upper.append(_round(high))
    return NoLobeBounds(
        list(NULL_WIDTHS_DEG),
        upper,
        max((u for u in upper if u is not None), default=None),
        next((s for s, u in zip(NULL_WIDTHS_DEG, upper, strict=True) if u), None),
    )


def _round(value: float) -> float:
    return float(f"{value:.4g}")
