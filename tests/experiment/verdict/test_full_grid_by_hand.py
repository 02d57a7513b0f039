"""Who leads and who is as good, against the definitions written out as loops."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.experiment.design.coordinates import coordinates
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.scaling.fine_grid import FineGrid, Smooth
from relgloss_view.experiment.verdict.full_grid import verdict_on

GRID = Grid()
COUNT = len(coordinates(GRID))


def smooth_at(place, draws=3):
    fine = FineGrid(GRID)
    closeness = -np.linalg.norm(fine.points - coordinates(GRID)[place], axis=1)
    return Smooth(fine, closeness, np.tile(closeness, (draws, 1)))


def wins_by_hand(draws):
    """Shares of the draws that tell anything; those that lead together share a draw."""
    won, counted = [0.0] * draws.shape[1], 0
    for row in draws:
        values = {j: v for j, v in enumerate(row) if np.isfinite(v)}
        if not values:
            continue
        counted += 1
        leaders = [j for j, v in values.items() if v >= max(values.values()) - 1e-9]
        for j in leaders:
            won[j] += 1.0 / len(leaders)
    return np.array(won) / counted


def as_good_by_hand(scale, draws, leading):
    """Hsu 1984 by the bootstrap: behind - critical x sd <= 0 with one critical value for all.

    A draw's largest studentised shortfall (what was found behind the leader, less what was drawn)
    is below the critical value in 95 % of the draws.
    """
    sd, largest = {}, []
    for j in range(len(scale)):
        drawn = [row[leading] - row[j] for row in draws if np.isfinite(row[leading] - row[j])]
        sd[j] = float(np.std(drawn)) if drawn else 0.0
    varying = [j for j in sd if np.isfinite(scale[j]) and sd[j] > 1e-9]
    for row in draws:
        behind = [
            (scale[leading] - scale[j] - (row[leading] - row[j])) / sd[j]
            for j in varying
            if np.isfinite(row[leading] - row[j])
        ]
        largest.append(max(behind, default=-np.inf))
    critical = np.quantile(largest, 0.95)
    return np.array(
        [
            bool(np.isfinite(v)) and (scale[leading] - v <= critical * sd[j] + 1e-9 or j == leading)
            for j, v in enumerate(scale)
        ]
    )


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("missing", [0.0, 0.05])
def test_wins_and_as_good(seed, missing):
    random = np.random.default_rng(seed)
    scale = random.normal(0.0, 1.0, COUNT)
    spread = random.uniform(0.05, 1.0, COUNT)
    draws = scale + spread * random.standard_normal((150, COUNT))
    draws[random.random(draws.shape) < missing] = np.nan
    if missing:
        draws[::40] = np.nan  # draws of those who saw nothing
        scale[[3, 17]] = np.nan
        draws[:, [3, 17]] = np.nan
    verdict = verdict_on(GRID, scale, draws, smooth_at(5), 0.001, 0.01, 15)
    assert verdict.leading == np.nanargmax(scale)
    np.testing.assert_allclose(verdict.wins, wins_by_hand(draws), atol=1e-12)
    expected = as_good_by_hand(scale, draws, verdict.leading)
    np.testing.assert_array_equal(verdict.as_good, expected)
    assert 1 < np.sum(expected) < COUNT


def test_draws_that_never_vary_leave_the_leader_alone():
    scale = np.linspace(0.0, 1.0, COUNT)
    verdict = verdict_on(GRID, scale, np.tile(scale, (20, 1)), smooth_at(5), 0.001, 0.01, 15)
    assert np.flatnonzero(verdict.as_good).tolist() == [COUNT - 1]


def test_without_draws_only_the_leader_is_known():
    scale = np.linspace(1.0, 0.0, COUNT)
    for draws in (None, np.full((5, COUNT), np.nan)):
        verdict = verdict_on(GRID, scale, draws, smooth_at(5), 0.001, 0.01, 15)
        assert verdict.wins is None
        assert np.flatnonzero(verdict.as_good).tolist() == [0]


def test_both_questions_add_up():
    one, two = smooth_at(5), smooth_at(30)
    both = one.plus(two)
    np.testing.assert_array_equal(both.closeness, one.closeness + two.closeness)
    np.testing.assert_array_equal(both.draws, one.draws + two.draws)
    alone = Smooth(one.fine, one.closeness, None)
    assert alone.plus(two).draws is None
    assert two.plus(alone).draws is None


@pytest.mark.parametrize(
    ("grid", "leading", "edges"),
    [
        (Grid((1.0,), (0.2, 0.5, 1.0)), 0, ("smallest c",)),
        (Grid((1.0,), (0.2, 0.5, 1.0)), 1, ()),
        (Grid((0.0, 1.0, 2.0), (1.0,)), 2, ("largest sigma_N",)),
        (Grid((0.0, 1.0), (0.5, 1.0)), 1, ("smallest sigma_N", "largest c")),
    ],
)
def test_an_axis_of_one_value_has_no_edges(grid, leading, edges):
    scale = np.zeros(len(coordinates(grid)))
    scale[leading] = 1.0
    fine = FineGrid(grid)
    smooth = Smooth(fine, np.zeros(len(fine.points)), None)
    assert verdict_on(grid, scale, None, smooth, 0.0, 0.01, 15).edges == edges
