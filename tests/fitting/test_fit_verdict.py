"""What a fit may claim, each number against one that the test works out by itself."""

from __future__ import annotations

from dataclasses import replace

import fit_cases
import numpy as np
import pytest
from scipy.optimize import least_squares

from relgloss_view.fitting import search, verdict
from relgloss_view.fitting.ladder import Candidate, group_errors
from relgloss_view.fitting.model import Rung as Model
from relgloss_view.fitting.model import Solution, State, States, predict
from relgloss_view.fitting.observations import Observations, prepare
from relgloss_view.fitting.problem import Problem
from relgloss_view.fitting.shapes import lobe_columns

S_DEG, STRENGTH, SIGMA = 3.0, 1.0, 0.1
ALBEDO = np.array(fit_cases.ALBEDO)
LOBE = Model("lobe", lobes=1)


def observed(lobes=((S_DEG, STRENGTH),), noise=0.0, **options) -> Observations:
    return prepare(fit_cases.measured(fit_cases.truth(lobes), noise=noise, **options))


def true_state(s_deg: float = S_DEG, strength: float = STRENGTH) -> State:
    return State(
        SIGMA**2,
        np.log(np.radians([s_deg])),
        np.array([1.5]),
        ALBEDO.copy(),
        np.full((1, 4), strength),
    )


def candidate_of(state: State, rung: Model = LOBE, folds: tuple[State, ...] = ()) -> Candidate:
    return Candidate(rung, Solution(state, 0.0), np.zeros(5), folds or (state,) * 5, 0, 0, 0)


class TestResiduals:
    def test_each_metric_by_hand(self) -> None:
        """Errors of 10 % near the mirror direction, of 30 % elsewhere and of 80 % at a few."""
        table = fit_cases.measured(fit_cases.truth(((S_DEG, STRENGTH),)), noise=0.0)
        data = prepare(table)
        rows = table.kept
        i, o = table.to_lamp[rows], table.to_receiver[rows]
        half = (i + o) / np.linalg.norm(i + o, axis=1)[:, None]
        tilt_deg = np.degrees(np.arccos(np.clip(half[:, 2], -1.0, 1.0)))
        near = tilt_deg < 5.0
        assert 20 < np.sum(near) < len(near) - 20
        share = np.where(near, 1.1, 0.7)[:, None] * np.ones(4)
        share[np.flatnonzero(~near)[::14]] = 1.8
        result = verdict.residuals(table, data, data.value * share)
        relative = np.abs(share - 1.0)
        assert result.median_relative_error == pytest.approx(np.median(relative), abs=1e-4)
        assert result.p90_relative_error == pytest.approx(np.percentile(relative, 90), abs=1e-4)
        assert result.near_mirror.median_relative_error == pytest.approx(0.1, abs=1e-4)
        assert result.far.median_relative_error == pytest.approx(0.3, abs=1e-4)
        # Samples at 5 degrees but for rounding may fall to either side.
        least, most = (4 * np.sum(tilt_deg < 5.0 + edge) for edge in (-1e-6, 1e-6))
        assert least <= result.near_mirror.values <= most
        assert result.near_mirror.values + result.far.values == result.values == share.size
        assert result.samples == len(data.value) == np.sum(rows)
        # Ngan, Durand, Matusik 2005: the BRDF times both cosines; a radiance factor is pi times it.
        brdf_cosines = table.radiance_factor[rows] / np.pi * (i[:, 2] * o[:, 2])[:, None]
        linear = np.sqrt(np.mean(((share - 1.0) * brdf_cosines) ** 2))
        assert result.cosine_weighted_rms == pytest.approx(linear, rel=1e-3)
        root = np.sqrt(np.mean(((np.cbrt(share) - 1.0) * np.cbrt(brdf_cosines)) ** 2))
        assert result.cube_root_rms == pytest.approx(root, rel=1e-3)
        # Both are above the floor of a thousandth, by 30 times at the darkest band.
        log = np.sqrt(np.mean(np.log(share) ** 2))
        assert result.rms_log_error == pytest.approx(log, rel=0.03)
        assert result.channels_outside_gamut == []
        assert result.values_not_positive == 0

    def test_no_sample_near_the_mirror_direction(self) -> None:
        grid = fit_cases.COARSE[np.abs(fit_cases.COARSE[:, 0] + fit_cases.COARSE[:, 1]) > 20.0]
        table = fit_cases.measured(fit_cases.truth(grid=grid), noise=0.0, grid=grid)
        data = prepare(table)
        result = verdict.residuals(table, data, data.value)
        assert result.near_mirror.values == 0
        assert result.near_mirror.median_relative_error is None
        assert result.far.median_relative_error == 0.0

    def test_channels_outside_the_gamut_are_left_out(self) -> None:
        """A channel counts where it is positive in at least half of the samples with weight."""
        data = observed()
        value, weight = data.value.copy(), data.weight.copy()
        count = len(value)
        value[: count // 2 + 1, 1] = 0.0  # just fewer than half are positive
        value[: count // 2 - 1, 2] = 0.0  # just more than half
        value[: count // 2 + 1, 3] = 0.0
        weight[: count // 2 + 1, 3] = 0.0  # and these do not count
        outside = verdict.mostly_outside(replace(data, value=value, weight=weight))
        assert outside.tolist() == [False, True, False, False]


def test_standard_errors_are_the_jackknife_of_each_unknown() -> None:
    """Leaving one group out moves a mean by 1/(n - 1): the jackknife is then sd / sqrt(n)."""
    rng = np.random.default_rng(1)
    sigma_deg, s_deg, n, strength = rng.uniform([[4], [2], [1.4], [0.5]], [[7], [4], [1.8], [1]],
                                                (4, 6))  # fmt: skip

    def without(x: np.ndarray) -> np.ndarray:
        return (np.sum(x) - x) / (len(x) - 1)

    folds = tuple(
        State(
            np.radians(sd) ** 2, np.log(np.radians([s])), np.array([m]),
            ALBEDO, np.array([[0.5, 1.5, 0.7, 1.3]]) * k,
        )
        for sd, s, m, k in zip(*map(without, (sigma_deg, s_deg, n, strength)), strict=True)
    )  # fmt: skip
    rung = Model("spectral-lobe", lobes=1, spectral=True, free_index=True)
    errors = verdict.standard_errors(candidate_of(folds[0], rung, folds))

    def of_mean(x: np.ndarray) -> object:
        wider = 1.4759 / 1.2816  # Student's t of 5 degrees of freedom at 90 %, from a table
        return pytest.approx(wider * np.std(x, ddof=1) / np.sqrt(len(x)), rel=1e-3)

    assert errors.sigma_deg == of_mean(sigma_deg)
    assert errors.s_deg == [of_mean(s_deg)]
    assert errors.strength == [of_mean(strength)]
    assert errors.refractive_index == [of_mean(n)]
    assert errors.albedo_relative == pytest.approx(0.0, abs=1e-12)
    assert "6 groups" in errors.method
    held = verdict.standard_errors(candidate_of(folds[0], replace(rung, free_index=False), folds))
    assert held.refractive_index is None
    diffuse = Model("lambert", rough=False)
    alone = verdict.standard_errors(candidate_of(folds[0], diffuse, folds))
    assert (alone.sigma_deg, alone.s_deg, alone.strength) == (None, None, None)


def unknowns_of(state: State) -> np.ndarray:
    return np.array([state.t, state.log_s[0], state.n[0], state.ks[0, 0], *state.kd])


def weighted_residual(data: Observations):
    """The logarithmic residuals as a function of all unknowns of a neutral lobe, free index."""

    def residual(x: np.ndarray) -> np.ndarray:
        state = State(x[0], x[1:2], x[2:3], x[4:], np.full((1, 4), x[3]))
        model = predict(data.geometry, state)
        log = np.log((model + data.floor) / (data.value + data.floor))
        return (np.sqrt(data.weight) * log).ravel()

    return residual


def test_index_and_strength_are_correlated_as_least_squares_has_it() -> None:
    """All unknowns at once, scipy's numerical Jacobian: the covariance is that of J'J."""
    data, state = observed(), true_state()
    at = unknowns_of(state)
    jacobian = least_squares(weighted_residual(data), at, jac="3-point", max_nfev=1).jac
    covariance = np.linalg.inv(jacobian.T @ jacobian)
    expected = covariance[2, 3] / np.sqrt(covariance[2, 2] * covariance[3, 3])
    assert -1.0 < expected < -0.9
    bounds = verdict.index_bounds(data, candidate_of(state))
    assert bounds.held
    assert bounds.correlation_with_strength == pytest.approx(expected, abs=2e-4)
    freed = candidate_of(state, replace(LOBE, free_index=True))
    assert not verdict.index_bounds(data, freed).held
    # A lobe that the samples do not show tells nothing of its index.
    unseen = verdict.index_bounds(data, candidate_of(true_state(strength=0.0)))
    assert unseen.correlation_with_strength is None


def test_equations_are_those_of_the_numerical_jacobian() -> None:
    """At an exact fit the robust loss is a square, so the matrix is J'WJ, all unknowns at once."""
    data, state = observed(), true_state()
    states = States.of([state])
    problem = Problem(data, replace(LOBE, free_index=True))
    columns = problem.columns(states.t, states.log_s, states.n)
    misfit = problem.misfit(problem.model(columns, states.kd, states.ks))
    equations = problem.equations(columns, misfit, states)
    jacobian = least_squares(
        weighted_residual(data), unknowns_of(state), jac="3-point", max_nfev=1
    ).jac
    expected = jacobian.T @ jacobian  # t, ln s, n, ks, then kd of each band
    size = np.sqrt(np.diag(expected))
    np.testing.assert_allclose(
        equations.shared[0] / np.outer(size[:4], size[:4]),
        expected[:4, :4] / np.outer(size[:4], size[:4]),
        atol=1e-5,
    )
    for b in range(4):
        k = 4 + b
        assert equations.own[0, b, 0, 0] == pytest.approx(expected[k, k], rel=1e-5)
        np.testing.assert_allclose(
            equations.cross[0, b, 0] / size[:4], expected[k, :4] / size[:4], rtol=1e-4, atol=1e-8
        )


class TestWidth:
    NOISE = 0.08

    @pytest.fixture(scope="class")
    @classmethod
    def case(cls):
        data = observed(lobes=((S_DEG, 0.02),), noise=cls.NOISE, seed=4)
        return data, candidate_of(search.solve(data, LOBE, 1.5).state)

    def rise(self, data: Observations, candidate: Candidate, log_s: float) -> tuple[float, float]:
        """Mean rise of the group errors and its standard error, all else fitted by scipy."""
        state = candidate.solution.state

        def moved(x: np.ndarray) -> State:
            return State(state.t, np.array([log_s]), state.n, x[1:], np.full((1, 4), x[0]))

        def residual(x: np.ndarray) -> np.ndarray:
            log = np.log(
                (predict(data.geometry, moved(x)) + data.floor) / (data.value + data.floor)
            )
            return (np.sqrt(data.weight) * log).ravel() / 0.03

        start = np.array([state.ks[0, 0] * np.exp(2 * (log_s - state.log_s[0])), *state.kd])
        x = least_squares(residual, start, loss="soft_l1", x_scale="jac").x
        base = group_errors(data, predict(data.geometry, state))
        rise = group_errors(data, predict(data.geometry, moved(x))) - base
        return float(np.mean(rise)), float(np.std(rise, ddof=1) / np.sqrt(len(rise)))

    def test_ends_lie_where_the_error_rises_by_one_standard_error(self, case) -> None:
        data, candidate = case
        low, high = np.log(verdict.width_interval(data, candidate, 0))
        fitted = candidate.solution.state.log_s[0]
        assert low < fitted < high
        # Bisection leaves a 32nd of a step of the grid, 6.7/24; the rise grows as its square.
        for end in (low, high):
            for share, worse in ((0.6, False), (1.6, True)):
                mean, se = self.rise(data, candidate, fitted + share * (end - fitted))
                assert (mean > max(se, verdict.FLAT)) == worse, (end, share, mean, se)

    def test_more_noise_leaves_more_widths(self, case) -> None:
        data, candidate = case
        low, high = verdict.width_interval(data, candidate, 0)
        noisy = observed(lobes=((S_DEG, 0.02),), noise=4 * self.NOISE, seed=4)
        wide_low, wide_high = verdict.width_interval(noisy, candidate, 0)
        assert wide_low <= low
        assert wide_high >= high

    @pytest.mark.parametrize(("on_flank", "seen"), [(2, False), (3, True)])
    @pytest.mark.parametrize("end", ["nearest the peak", "farthest from it"])
    def test_three_samples_on_the_flank_show_a_width(
        self, on_flank: int, seen: bool, end: str
    ) -> None:
        # Some directions have their half-vector at 7.1 degrees: 2.9 standard deviations of 2.4.
        s_deg = S_DEG if end == "nearest the peak" else 2.4
        data, state = observed(((s_deg, STRENGTH),)), true_state(s_deg)
        sd2 = data.geometry.facing.delta2 / np.radians(s_deg) ** 2
        lobe, _ = lobe_columns(data.geometry, float(state.log_s[0]), 1.5)
        strong = lobe[:, None] * state.ks > 0.1 * predict(data.geometry, state)
        flank = np.flatnonzero((sd2 > 0.5**2) & (sd2 < 3.0**2) & np.any(strong, axis=1))
        elsewhere = np.flatnonzero((sd2 < 0.5**2) | (sd2 > 3.0**2))
        assert len(flank) > 5
        flank = flank[np.argsort(sd2[flank])]
        if end == "farthest from it":
            flank = flank[::-1]
            assert sd2[flank[2]] > 8.0
        weight = np.zeros_like(data.weight)
        weight[elsewhere] = 1.0
        weight[flank[:on_flank]] = 1.0
        assert verdict.width_is_seen(replace(data, weight=weight), state, 0) is seen

    def test_a_lobe_that_the_body_outshines_shows_no_width(self) -> None:
        data = observed()
        assert verdict.width_is_seen(data, true_state(), 0)
        assert not verdict.width_is_seen(data, true_state(strength=1e-6), 0)


class TestNoLobe:
    def test_bounds_are_where_a_lobe_shows(self) -> None:
        """Twice the bound shows, half of it does not; by two standard errors over groups."""
        data = observed(lobes=(), noise=0.03, seed=2)
        state = State(SIGMA**2, np.empty(0), np.empty(0), ALBEDO, np.empty((0, 4)))
        bounds = verdict.no_lobe_bounds(data, state, 1.5)
        assert bounds.s_deg == [0.1, 0.3, 1.0, 3.0, 10.0]
        base = predict(data.geometry, state)

        def shows(s_deg: float, strength: float) -> bool:
            lobe, _ = lobe_columns(data.geometry, float(np.log(np.radians(s_deg))), 1.5)
            with_lobe = base + strength * lobe[:, None]
            rise = group_errors(data, with_lobe) - group_errors(data, base)
            return np.mean(rise) > max(2 * np.std(rise, ddof=1) / np.sqrt(len(rise)), 1e-4)

        pairs = list(zip(bounds.s_deg, bounds.strength_upper, strict=True))
        found = [(s, upper) for s, upper in pairs if upper is not None]
        assert len(found) >= 3
        for s_deg, upper in found:
            assert shows(s_deg, 1.02 * upper)
            assert not shows(s_deg, 0.98 * upper)
        assert bounds.largest_strength_upper == max(upper for _, upper in found)
        assert bounds.narrowest_seen_deg == found[0][0]

    def test_a_grid_far_from_the_mirror_direction_sees_no_narrow_lobe(self) -> None:
        full = fit_cases.GRID
        f = fit_cases.facing(full)
        grid = full[np.degrees(np.sqrt(f.delta2)) > 4.0]
        data = prepare(fit_cases.measured(fit_cases.truth(grid=grid), noise=0.02, grid=grid))
        state = State(SIGMA**2, np.empty(0), np.empty(0), ALBEDO, np.empty((0, 4)))
        bounds = verdict.no_lobe_bounds(data, state, 1.5)
        assert bounds.strength_upper[:2] == [None, None]
        assert bounds.strength_upper[-1] is not None
        assert bounds.narrowest_seen_deg >= 1.0
