"""The smooth fit and the shape of what is as good, held against known truths."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import check_grad, lsq_linear, minimize
from scipy.special import ndtr

from relgloss_view.experiment.design.coordinates import coordinates
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.scaling.bounded_minima import steps_within
from relgloss_view.experiment.scaling.fine_grid import FineGrid, shape_of
from relgloss_view.experiment.scaling.unfolding import (
    ROUND,
    UnfoldingLoss,
    fit_unfolding,
    unfolding_draws,
)

GRID = Grid()
BOUNDS = np.array([0.9, 1.8, 2.8, 3.9])
#: Parameters of a fit, none of them at a limit.
INSIDE = np.array([2.2, 3.1, 0.1, 0.2, 0.3, 0.9, 0.1, 0.2, -0.1, 0.4, -0.5, 0.3, -0.2, -0.2, 0.2])


def exact_counts(grid, ideal, slopes, shear=0.0, number=1e4, bounds=BOUNDS):
    """What very many observers of the model would answer."""
    apart = coordinates(grid) - ideal
    u = slopes[0] * apart[:, 0] + shear * apart[:, 1]
    d = np.sqrt(ROUND + u**2 + (slopes[1] * apart[:, 1]) ** 2)
    cumulative = ndtr(bounds - d[:, None])
    edges = np.concatenate([np.zeros((len(d), 1)), cumulative, np.ones((len(d), 1))], axis=1)
    from relgloss_view.experiment.session.posterior import LAPSE

    categories = len(bounds) + 1
    return number * ((1.0 - LAPSE) * np.diff(edges, axis=1) + LAPSE / categories)


def ideal_of(fit):
    """Where the fit is closest: an ideal beyond the grid counts on its edge."""
    return np.clip(fit.parameters[:2], 0.0, coordinates(fit.grid)[-1])


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
        loss = UnfoldingLoss(GRID, counts)
        value, gradient = loss(INSIDE)
        # Two-sided differences of a loss near 400 in steps of 1.5e-8: 1e-6 of its slope.
        off = check_grad(lambda p: loss(p)[0], lambda p: loss(p)[1], INSIDE)
        assert off < 1e-5 * np.linalg.norm(gradient)
        assert value > 0.0

    def test_expected_curvature(self):
        """Counts that the model expects: expected second derivatives are the second derivatives.

        Those of the distances themselves have no share then (Fisher 1925).
        """
        share = UnfoldingLoss(GRID, np.ones((42, 5)))._shares(INSIDE)[0]
        loss = UnfoldingLoss(GRID, 15.0 * share.T)
        # Central differences of slopes near 1e2: an error of step^2 x 1e3, and 1e-14 / step.
        steps = 1e-5 * np.eye(len(INSIDE))
        turn = np.array([(loss(INSIDE + s)[1] - loss(INSIDE - s)[1]) / 2e-5 for s in steps])
        _, _, information = loss.scoring(INSIDE)
        np.testing.assert_allclose(information, turn, atol=1e-5 * np.max(turn))
        # Control: other counts have another curvature.
        other = UnfoldingLoss(GRID, 15.0 * share.T[::-1])
        off = np.array([(other(INSIDE + s)[1] - other(INSIDE - s)[1]) / 2e-5 for s in steps])
        assert np.max(np.abs(information - off)) > 0.1 * np.max(turn)

    def test_many_fits_are_those_of_one(self):
        random = np.random.default_rng(0)
        counts = random.integers(0, 5, (3, 42, 5)).astype(float)
        at = INSIDE + 0.1 * random.standard_normal((3, len(INSIDE)))
        together = UnfoldingLoss(GRID, counts).scoring(at)
        for k in range(3):
            alone = UnfoldingLoss(GRID, counts[k]).scoring(at[k])
            for ours, theirs in zip(together, alone, strict=True):
                np.testing.assert_allclose(ours[k], theirs, rtol=1e-12, atol=1e-10)


class TestDraws:
    def test_end_where_searches_from_nothing_do(self):
        random = np.random.default_rng(2)
        counts = exact_counts(GRID, (2.3, 3.1), (0.8, 1.2), number=15)
        drawn = random.poisson(counts, (8, 42, 5)).astype(float)
        ends = unfolding_draws(GRID, drawn, fit_unfolding(GRID, counts))
        losses = UnfoldingLoss(GRID, drawn)(ends)[0]
        for end, loss, one in zip(ends, losses, drawn, strict=True):
            alone = fit_unfolding(GRID, one)
            # Searches end where a step promises 1e-6: a thousandth of a standard error.
            assert loss == pytest.approx(alone.loss, abs=1e-4)
            np.testing.assert_allclose(end[:2], ideal_of(alone), atol=0.01)

    @pytest.mark.parametrize("ideal", [(2.3, 3.1), (0.0, 5.0), (6.0, 0.3)])
    def test_no_search_of_scipy_ends_lower(self, ideal):
        """SLSQP from the same start, an optimiser of another kind; ideals on edges of the grid."""
        random = np.random.default_rng(4)
        counts = exact_counts(GRID, ideal, (0.7, 1.1), shear=0.2, number=15)
        start = fit_unfolding(GRID, counts)
        drawn = random.poisson(counts, (12, 42, 5)).astype(float)
        ends = unfolding_draws(GRID, drawn, start)
        limits = np.array(UnfoldingLoss(GRID, counts).limits)
        assert np.all((ends >= limits[:, 0]) & (ends <= limits[:, 1]))
        for end, one in zip(ends, drawn, strict=True):
            loss = UnfoldingLoss(GRID, one)
            best = minimize(
                loss, start.parameters, jac=True, method="SLSQP", bounds=limits,
                options={"ftol": 1e-9, "maxiter": 500},
            )  # fmt: skip
            assert loss(end)[0] <= best.fun + 1e-4

    def test_steps_between_limits(self):
        """Bounded least squares by scipy on the same quadratics."""
        random = np.random.default_rng(1)
        root = random.standard_normal((40, 6, 6))
        matrix = root @ root.swapaxes(1, 2) + 0.3 * np.eye(6)
        slope = 3.0 * random.standard_normal((40, 6))
        low, high = -random.random((40, 6)), random.random((40, 6))
        low[::2, 0] = 0.0
        steps = steps_within(slope, matrix, low, high)
        assert np.all((steps >= low) & (steps <= high))
        lowered = lowest = 0.0
        for k in range(40):
            upper = np.linalg.cholesky(matrix[k]).T
            best = lsq_linear(upper, -np.linalg.solve(upper.T, slope[k]), (low[k], high[k])).x
            ours, theirs = (x @ (slope[k] + 0.5 * matrix[k] @ x) for x in (steps[k], best))
            assert ours < 0.0
            lowered, lowest = lowered + ours, lowest + theirs
        # Nearly all of what the best steps would give; a search needs no more.
        assert lowest - 1e-6 <= lowered <= 0.98 * lowest


class TestHardCounts:
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
        counts[:, 0] += counts[:, 1]  # nobody used the second category
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
