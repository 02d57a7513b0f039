"""What a fit may claim: residuals, standard errors, bounds, and whether the sample is described."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from relgloss_view.fitting.ladder import Candidate, group_errors
from relgloss_view.fitting.model import LOG_S_RANGE, State, predict
from relgloss_view.fitting.samples import Samples
from relgloss_view.fitting.shapes import Geometry, lobe_columns
from relgloss_view.fitting.solver import Problem
from relgloss_view.measure.table import Measurement

Array = NDArray[np.float64]

NEAR_MIRROR_DEG = 5.0  #: half-vector within this of the normal
#: A picture shows errors of this size: beyond them no model of the ladder describes the sample.
POOR_MEDIAN = 0.12
POOR_MEDIAN_NEAR = 0.30
PROFILE_STEPS = 25
_BISECTIONS = 5
#: Rise of the logarithmic error that a profile may have and still be called flat.
FLAT = 1e-4
FLANK_SD = (0.5, 3.0)  #: standard deviations from a lobe's peak between which its width shows
FEWEST_ON_FLANK = 3
NULL_WIDTHS_DEG = (0.1, 0.3, 1.0, 3.0, 10.0)
_LARGEST_STRENGTH = 1e4


def residuals(
    measurement: Measurement, rows: NDArray[np.bool_], g: Geometry, samples: Samples, model: Array
) -> dict[str, Any]:
    """How far the model is from the samples, in several metrics."""
    outside = mostly_outside(samples)
    seen = (samples.value > 0.0) & (samples.weight > 0.0) & ~outside
    relative = np.abs(model - samples.value)[seen] / samples.value[seen]
    near = np.sqrt(g.facing.delta2) < np.radians(NEAR_MIRROR_DEG)
    near = np.broadcast_to(near[:, None], seen.shape)[seen]
    log = np.log((model + samples.floor) / (samples.value + samples.floor))[seen]
    cosine = (g.facing.mu_i * g.facing.mu_o)[:, None]
    linear = ((model - samples.value) * cosine / np.pi)[seen]
    root = (np.cbrt(model * cosine / np.pi) - np.cbrt(samples.value * cosine / np.pi))[seen]

    def median(values: Array) -> float | None:
        return _round(float(np.median(values))) if values.size else None

    return {
        "median_relative_error": median(relative),
        "p90_relative_error": _round(float(np.percentile(relative, 90.0))),
        "rms_log_error": _round(float(np.sqrt(np.mean(log**2)))),
        "near_mirror": {"median_relative_error": median(relative[near]), "values": int(near.sum())},
        "far": {"median_relative_error": median(relative[~near]), "values": int((~near).sum())},
        "near_mirror_deg": NEAR_MIRROR_DEG,
        "cosine_weighted_rms": _round(float(np.sqrt(np.mean(linear**2)))),
        "cube_root_rms": _round(float(np.sqrt(np.mean(root**2)))),
        "samples": int(rows.sum()),
        "values": int(seen.sum()),
        "left_out": measurement.left_out(),
        "values_not_positive": int(((samples.value <= 0.0) & (samples.weight > 0.0)).sum()),
        "channels_outside_gamut": np.flatnonzero(outside).tolist(),
        "aperture_sd_deg": list(measurement.aperture_sd_deg),
    }


def mostly_outside(samples: Samples) -> NDArray[np.bool_]:
    """(B,), channels of linear sRGB that are not positive in most samples.

    Relative errors mean nothing there: the few positive values are differences of large numbers.
    (Spectral bands have no weight where they are not positive, so none of them is marked.)
    """
    positive = np.sum((samples.value > 0.0) & (samples.weight > 0.0), axis=0)
    return np.asarray(positive < 0.5 * np.sum(samples.weight > 0.0, axis=0))


def standard_errors(candidate: Candidate) -> dict[str, Any]:
    """Jackknife over groups: the spread of the unknowns when whole groups are left out.

    Samples of one group share their errors, so J'J alone would promise too much.
    """
    states, rung = candidate.fold_states, candidate.rung
    count = len(states)

    def jackknife(values: Array) -> Array:
        spread = values - np.mean(values, axis=0)
        return np.asarray(np.sqrt((count - 1) / count * np.sum(spread**2, axis=0)))

    result: dict[str, Any] = {"method": f"jackknife over {count} groups"}
    albedo = np.array([s.kd for s in states])
    mean = np.maximum(np.mean(albedo, axis=0), 1e-9)
    result["albedo_relative"] = _round(float(np.median(jackknife(albedo) / mean)))
    if rung.rough:
        sigma = np.degrees(np.sqrt(np.array([s.t for s in states])))
        result["sigma_deg"] = _round(float(jackknife(sigma)))
    if rung.lobes:
        s_deg = np.degrees(np.exp(np.array([s.log_s for s in states])))
        strength = np.array([np.mean(s.ks, axis=1) for s in states])
        result["s_deg"] = [_round(float(x)) for x in jackknife(s_deg)]
        result["strength"] = [_round(float(x)) for x in jackknife(strength)]
        if rung.free_index:
            n = np.array([s.n for s in states])
            result["refractive_index"] = [_round(float(x)) for x in jackknife(n)]
    return result


def index_against_strength(g: Geometry, samples: Samples, candidate: Candidate) -> float | None:
    """Correlation of refractive index and strength of the first lobe, were both free."""
    state, lobes = candidate.solution.state, candidate.rung.lobes
    if lobes == 0:
        return None
    rung = replace(candidate.rung, spectral=False, free_index=True)
    neutral = replace(state, ks=np.repeat(np.mean(state.ks, 1, keepdims=True), samples.bands, 1))
    problem = Problem(g, samples, rung)
    columns, products = problem.columns(neutral.t, neutral.log_s, neutral.n)
    h_oo, h_os, h_ss, _, _, names = problem.normal_equations(columns, products, neutral)
    keep = h_oo[:, 0, 0] > 0.0
    own = h_os[keep, 0, :]
    schur = h_ss - own.T @ (own / h_oo[keep, 0, 0][:, None])
    size = np.sqrt(np.maximum(np.diag(schur), 0.0))
    if np.any(size <= 0.0):
        return None
    covariance = np.linalg.pinv(schur / size[:, None] / size)
    a, b = names.index("n0"), names.index("ks0")
    scale = covariance[a, a] * covariance[b, b]
    return _round(float(covariance[a, b] / np.sqrt(scale))) if scale > 0.0 else None


def width_interval(g: Geometry, samples: Samples, candidate: Candidate, lobe: int) -> Array:
    """(2,), radians: the widths of a lobe that the samples cannot tell from the fitted one.

    The linear unknowns are fitted again at each width. A width is as good when its error rises by
    no more than one standard error over groups, or by nothing to speak of.
    """
    state = candidate.solution.state
    problem = Problem(g, samples, candidate.rung)
    base = group_errors(samples, predict(g, state))
    fitted = float(state.log_s[lobe])
    peak = float(np.max(lobe_columns(g, fitted, float(state.n[lobe]))[0]))

    def as_good(log_s: float) -> bool:
        moved = state.log_s.copy()
        moved[lobe] = log_s
        columns, _ = problem.columns(state.t, moved, state.n)
        now = float(np.max(columns[:, 2 + lobe]))
        ks = state.ks.copy()
        ks[lobe] *= peak / max(now, 1e-30)
        kd, ks = problem.inner(columns, state.kd, ks, 3)
        rise = group_errors(samples, problem.model(columns, kd, ks)) - base
        se = float(np.std(rise, ddof=1) / np.sqrt(len(rise))) if len(rise) > 1 else 0.0
        return float(np.mean(rise)) <= max(se, FLAT)

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


def width_is_seen(g: Geometry, samples: Samples, state: State, lobe: int) -> bool:
    """Whether samples stand on the flank of a lobe, where its width shows.

    A peak sample alone tells strength over width squared; samples far down the foot tell a width
    only if the lobe is Gaussian there, which no real one is.
    """
    s2 = float(np.exp(2.0 * state.log_s[lobe]))
    sd2 = g.along / (s2 + g.blur_along) + g.across / (s2 + g.blur_across)
    column, _ = lobe_columns(g, float(state.log_s[lobe]), float(state.n[lobe]))
    share = np.multiply.outer(column, state.ks[lobe]) / np.maximum(predict(g, state), 1e-12)
    flank = (sd2 >= FLANK_SD[0] ** 2) & (sd2 <= FLANK_SD[1] ** 2) & (np.max(share, axis=1) > 0.1)
    return int(np.sum(flank & np.any(samples.weight > 0.0, axis=1))) >= FEWEST_ON_FLANK


def null_bounds(g: Geometry, samples: Samples, state: State, n: float) -> dict[str, Any]:
    """The strongest lobe of each width that could hide in samples fitted without one.

    None where the samples would not see a lobe of that width at all.
    """
    base_model = predict(g, state)
    base = group_errors(samples, base_model)

    def visible(lobe: Array, strength: float) -> bool:
        rise = group_errors(samples, base_model + strength * lobe[:, None]) - base
        se = float(np.std(rise, ddof=1) / np.sqrt(len(rise))) if len(rise) > 1 else 0.0
        return float(np.mean(rise)) > max(2.0 * se, FLAT)

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
    seen = [u for u in upper if u is not None]
    narrowest = next((s for s, u in zip(NULL_WIDTHS_DEG, upper, strict=True) if u), None)
    return {
        "s_deg": list(NULL_WIDTHS_DEG),
        "strength_upper": upper,
        "largest_strength_upper": max(seen) if seen else None,
        "narrowest_seen_deg": narrowest,
    }


def is_poor(metrics: dict[str, Any]) -> bool:
    """Whether no model of the ladder describes the sample."""
    near = metrics["near_mirror"]["median_relative_error"]
    return bool(
        metrics["median_relative_error"] > POOR_MEDIAN
        or (near is not None and near > POOR_MEDIAN_NEAR)
    )


def _round(value: float) -> float:
    return float(f"{value:.4g}")
