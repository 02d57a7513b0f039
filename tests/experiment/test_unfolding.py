"""The smooth fit, its optimum and the shape of what is as good, held against known truths."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import check_grad
from scipy.special import ndtr

from relgloss_view.experiment.coordinates import coordinates
from relgloss_view.experiment.grid import Grid
from relgloss_view.experiment.surface import FineGrid, shape_of
from relgloss_view.experiment.unfolding import ROUND, _Loss, fit_unfolding
from relgloss_view.experiment.verdict import BEST, BROAD, CHANCE, FEW, RIDGE, Smooth, judged

GRID = Grid()
BOUNDS = np.array([0.9, 1.8, 2.8, 3.9])


def exact_counts(grid, ideal, slopes, shear=0.0, number=1e4, bounds=BOUNDS):
    """What very many observers of the model would answer."""
    apart = coordinates(grid) - ideal
    u = slopes[0] * apart[:, 0] + shear * apart[:, 1]
    d = np.sqrt(ROUND + u**2 + (slopes[1] * apart[:, 1]) ** 2)
    cumulative = ndtr(bounds - d[:, None])
    edges = np.concatenate([np.zeros((len(d), 1)), cumulative, np.ones((len(d), 1))], axis=1)
    from relgloss_view.experiment.adaptive import LAPSE

    categories = len(bounds) + 1
    return number * ((1.0 - LAPSE) * np.diff(edges, axis=1) + LAPSE / categories)


def ideal_of(fit):
    return fit.parameters[:2]


class TestFit:
    @pytest.mark.parametrize(
        ("ideal", "slopes", "shear"),
        [
            ((2.3, 3.1), (0.8, 1.2), 0.0),
            ((0.0, 4.0), (1.5, 0.7), 0.0),
            ((4.6, 0.4), (0.5, 2.0), 0.4),
            ((5.9, 5.0), (0.4, 0.4), -0.2),
        ],
    )
    def test_finds_the_ideal_of_its_own_model(self, ideal, slopes, shear):
        """Exact counts: what is left is the pull of the priors against 420,000 answers."""
        counts = exact_counts(GRID, ideal, slopes, shear)
        np.testing.assert_allclose(ideal_of(fit_unfolding(GRID, counts)), ideal, atol=0.02)

    def test_gradient(self):
        counts = np.random.default_rng(0).integers(0, 5, (42, 5)).astype(float)
        loss = _Loss(GRID, counts)
        at = np.array([2.2, 3.1, 0.1, 0.2, 0.3, 0.9, 0.1, 0.2, -0.1, 0.2, -0.3])
        value, gradient = loss(at)
        # Two-sided differences of a loss near 400 in steps of 1.5e-8: 1e-6 of its slope.
        off = check_grad(lambda p: loss(p)[0], lambda p: loss(p)[1], at)
        assert off < 1e-5 * np.linalg.norm(gradient)
        assert value > 0.0

    def test_warm_start_ends_where_a_cold_one_does(self):
        random = np.random.default_rng(2)
        counts = exact_counts(GRID, (2.3, 3.1), (0.8, 1.2), number=15)
        first = fit_unfolding(GRID, counts)
        for _ in range(5):
            drawn = random.poisson(counts).astype(float)
            warm, cold = fit_unfolding(GRID, drawn, first), fit_unfolding(GRID, drawn)
            assert warm.loss == pytest.approx(cold.loss, abs=0.05)
            np.testing.assert_allclose(ideal_of(warm), ideal_of(cold), atol=0.15)

    @pytest.mark.parametrize(
        "grid",
        [
            Grid((0.0, 2.0), (0.5, 1.0)),
            Grid((1.0,), (0.2, 0.4, 0.8)),
            Grid((0.0, 1.0), (1.0,)),
            Grid((1.0,), (1.0,)),
            Grid((0.0, 1.0, 2.0), (0.0, 0.5, 1.0)),
        ],
    )
    def test_small_grids(self, grid):
        counts = exact_counts(grid, coordinates(grid)[-1], (1.0, 1.0), number=10)
        fit = fit_unfolding(grid, counts)
        np.testing.assert_allclose(ideal_of(fit), coordinates(grid)[-1], atol=0.2)
        assert np.all(np.isfinite(fit.closeness(FineGrid(grid).points)))

    @pytest.mark.parametrize("categories", [2, 3, 9])
    def test_numbers_of_categories(self, categories):
        bounds = np.linspace(0.8, 4.0, categories - 1)
        counts = exact_counts(GRID, (2.0, 3.0), (0.8, 1.0), bounds=bounds)
        np.testing.assert_allclose(ideal_of(fit_unfolding(GRID, counts)), (2.0, 3.0), atol=0.05)

    def test_unused_categories_and_settings_that_nobody_saw(self):
        counts = exact_counts(GRID, (2.0, 3.0), (0.8, 1.0))
        counts[:, 1] = 0.0
        counts[::3] = 0.0
        fit = fit_unfolding(GRID, counts)
        np.testing.assert_allclose(ideal_of(fit), (2.0, 3.0), atol=0.3)

    def test_one_answer(self):
        counts = np.zeros((42, 5))
        counts[7, 0] = 1.0
        fit = fit_unfolding(GRID, counts)
        np.testing.assert_allclose(ideal_of(fit), coordinates(GRID)[7], atol=0.3)


class TestShape:
    FINE = FineGrid(GRID)

    def test_a_disc_is_a_point(self):
        x, y = self.FINE.points.T
        shape = shape_of(self.FINE.points, np.hypot(x - 3, y - 2) <= 1.0)
        assert shape.kind == "point"
        assert shape.length_steps == pytest.approx(2.0, abs=0.15)
        assert shape.length_steps * shape.width_steps == pytest.approx(np.pi, rel=0.05)

    @pytest.mark.parametrize("turn", [0.0, 0.3, 1.2, np.pi / 2])
    def test_a_band_is_a_ridge(self, turn):
        x, y = self.FINE.points.T
        across = np.cos(turn) * (y - 2.5) - np.sin(turn) * (x - 3)
        shape = shape_of(self.FINE.points, np.abs(across) <= 0.3)
        assert shape.kind == "ridge"
        assert shape.length_steps >= 5.0

    def test_most_of_the_grid_is_broad(self):
        assert shape_of(self.FINE.points, self.FINE.points[:, 0] > 2.0).kind == "broad"

    def test_a_line_of_settings_has_no_ridge(self):
        fine = FineGrid(Grid((1.0,), GRID.c_fraction))
        shape = shape_of(fine.points, fine.points[:, 1] < 2.0)
        assert shape.kind == "point"


def smooth_of(ideal, slopes, draws=200, spread=0.1, seed=0):
    """A fit's closeness over the fine grid, and draws whose ideal varies."""
    fine = FineGrid(GRID)
    random = np.random.default_rng(seed)

    def closeness(at):
        return -np.linalg.norm(slopes * (fine.points - at), axis=1)

    ideals = ideal + spread * random.standard_normal((draws, 2))
    return Smooth(fine, closeness(ideal), np.array([closeness(at) for at in ideals]))


class TestVerdict:
    SCALE = -np.linalg.norm(coordinates(GRID) - coordinates(GRID)[26], axis=1)

    def draws(self, sd=0.1):
        return self.SCALE + sd * np.random.default_rng(1).standard_normal((400, 42))

    def verdict(self, slopes=(1.0, 1.0), p=0.001, draws="some", spread=0.1, observers=15, **more):
        drawn = self.draws(**more) if draws == "some" else None
        smooth = smooth_of(coordinates(GRID)[26], np.array(slopes), spread=spread)
        if drawn is None:
            smooth = Smooth(smooth.fine, smooth.closeness, None)
        return judged(GRID, self.SCALE, drawn, smooth, p, 0.01, observers)

    def test_best(self):
        verdict = self.verdict()
        assert verdict.status == BEST
        assert verdict.leading == 26
        assert verdict.wins[26] > 0.99
        assert np.flatnonzero(verdict.as_good).tolist() == [26]
        low, high = verdict.optimum.sigma_n_interval_deg
        assert low < 2.0 < high
        # The ideal's spread is 0.1 steps of 0.5 degrees: a 95 % interval of 4 x 0.05 degrees, a
        # tenth of a step wider for the fine grid.
        assert high - low == pytest.approx(0.196 + 0.05, rel=0.25)

    def test_by_chance_nothing_is_declared(self):
        assert self.verdict(p=0.2).status == CHANCE
        assert not self.verdict(p=0.2).declared

    def test_few_observers(self):
        assert self.verdict(draws="none", observers=1).status == FEW
        assert self.verdict(observers=4).status == FEW
        assert self.verdict(observers=5).status == BEST

    def test_equals_lead_together(self):
        """Settings with the same answers: none is called worse, and they share what is won."""
        scale = self.SCALE.copy()
        scale[[20, 27]] = scale[26]
        draws = scale + 0.1 * np.random.default_rng(1).standard_normal((400, 42))
        draws[:, 20] = draws[:, 27] = draws[:, 26]
        smooth = smooth_of(coordinates(GRID)[27], np.ones(2))
        verdict = judged(GRID, scale, draws, smooth, 0.001, 0.01, 15)
        assert verdict.leading == 27  # the smooth fit tells
        assert set(np.flatnonzero(verdict.as_good)) == {20, 26, 27}
        assert verdict.wins[[20, 26, 27]] == pytest.approx(1 / 3, abs=0.01)

    def test_draws_that_tell_nothing_count_for_nobody(self):
        draws = self.draws()
        draws[::3] = np.nan
        draws[:, 5] = np.nan
        smooth = smooth_of(coordinates(GRID)[26], np.ones(2))
        verdict = judged(GRID, self.SCALE, draws, smooth, 0.001, 0.01, 15)
        assert verdict.wins.sum() == pytest.approx(1.0)
        assert verdict.wins[0] == verdict.wins[5] == 0.0
        assert verdict.wins[26] > 0.99

    def test_ridge_and_broad(self):
        assert self.verdict(slopes=(0.01, 1.0)).status == RIDGE
        assert self.verdict(spread=3.0).status == BROAD

    def test_more_noise_tells_fewer_apart(self):
        few, many = (int(np.sum(self.verdict(sd=sd).as_good)) for sd in (0.1, 1.0))
        assert few < many

    def test_as_good_holds_the_truth(self):
        """Multiple comparisons with the best: in 95 % of studies the true best is among them.

        500 studies of normal scales; the share's standard deviation is 1 %, three of them below.
        Without room for chance (the leading one alone) it fails.
        """
        truth = np.zeros(42)
        truth[26] = 0.15
        random = np.random.default_rng(3)
        fine = smooth_of(coordinates(GRID)[26], np.ones(2), draws=2)
        held = leads = 0
        for _ in range(500):
            scale = truth + 0.1 * random.standard_normal(42)
            draws = scale + 0.1 * random.standard_normal((200, 42))
            verdict = judged(GRID, scale, draws, fine, 0.0, 0.01, 15)
            held += bool(verdict.as_good[26])
            leads += verdict.leading == 26
        assert held / 500 >= 0.95 - 0.03
        assert leads / 500 < 0.9

    def test_edges(self):
        def edges(index):
            scale = np.zeros(42)
            scale[index] = 1.0
            smooth = smooth_of(coordinates(GRID)[index], np.ones(2), draws=5)
            return judged(GRID, scale, None, smooth, 0.0, 0.01, 15).edges

        assert edges(0) == ("smallest sigma_N", "smallest c")
        assert edges(41) == ("largest sigma_N", "largest c")
        assert edges(26) == ()
