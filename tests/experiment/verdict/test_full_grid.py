"""The verdict on scale values and their resamplings, held against known truths."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.experiment.design.coordinates import coordinates
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.scaling.fine_grid import FineGrid, Smooth
from relgloss_view.experiment.verdict.full_grid import BEST, BROAD, CHANCE, FEW, RIDGE, verdict_on

GRID = Grid()


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
        return verdict_on(GRID, self.SCALE, drawn, smooth, p, 0.01, observers)

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
        verdict = verdict_on(GRID, scale, draws, smooth, 0.001, 0.01, 15)
        assert verdict.leading == 27  # the smooth fit tells
        assert set(np.flatnonzero(verdict.as_good)) == {20, 26, 27}
        assert verdict.wins[[20, 26, 27]] == pytest.approx(1 / 3, abs=0.01)

    def test_draws_that_tell_nothing_count_for_nobody(self):
        draws = self.draws()
        draws[::3] = np.nan
        draws[:, 5] = np.nan
        smooth = smooth_of(coordinates(GRID)[26], np.ones(2))
        verdict = verdict_on(GRID, self.SCALE, draws, smooth, 0.001, 0.01, 15)
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
            verdict = verdict_on(GRID, scale, draws, fine, 0.0, 0.01, 15)
            held += bool(verdict.as_good[26])
            leads += verdict.leading == 26
        assert held / 500 >= 0.95 - 0.03
        assert leads / 500 < 0.9

    def test_edges(self):
        def edges(index):
            scale = np.zeros(42)
            scale[index] = 1.0
            smooth = smooth_of(coordinates(GRID)[index], np.ones(2), draws=5)
            return verdict_on(GRID, scale, None, smooth, 0.0, 0.01, 15).edges

        assert edges(0) == ("smallest sigma_N", "smallest c")
        assert edges(41) == ("largest sigma_N", "largest c")
        assert edges(26) == ()
