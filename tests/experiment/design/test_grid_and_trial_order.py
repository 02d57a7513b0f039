"""The grid of settings, its coordinates, and the order in which observers see it."""

from __future__ import annotations

import collections
import itertools
import math

import numpy as np
import pytest
from cases import study

from relgloss_view.base.errors import InputError
from relgloss_view.experiment.design.coordinates import (
    coordinates,
    from_steps,
    grid_steps,
    to_steps,
)
from relgloss_view.experiment.design.grid import Grid, share_of
from relgloss_view.experiment.design.trial_order import planned_trials, sample_order, williams_row
from relgloss_view.picture.scene.setting import Setting, share_words

THREE = ("art-coated", "matte-coated", "uncoated")


def test_the_papers_grid():
    """Ishii et al.: 0.0 to 3.0 degrees by 0.5, c_max/6 to c_max: 42 pictures."""
    grid = Grid()
    assert grid.sigma_n_deg == (0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0)
    assert [share_words(c) for c in grid.c_fraction] == ["1/6", "2/6", "3/6", "4/6", "5/6", "6/6"]
    assert len(grid.settings) == len(grid) == 42
    assert Setting(2.0, 2 / 6) in grid.settings
    assert Setting(2.1, 2 / 6) not in grid.settings


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (((), (1.0,)), "grid.sigma_n_deg: expected at least one"),
        (((0.0, 0.0), (1.0,)), "ascending"),
        (((1.0, 0.5), (1.0,)), "ascending"),
        (((0.0,), (float("nan"),)), r"grid.c_fraction\[0\]"),
        (((0.0,), (11.0,)), r"grid.c_fraction\[0\]"),
        ((tuple(k / 10 for k in range(30)), tuple(k / 30 for k in range(30))), "at most 400"),
    ],
)
def test_bad_grids(values, words):
    with pytest.raises(InputError, match=words):
        Grid(*values)


@pytest.mark.parametrize(
    ("given", "share"), [("5/6", 5 / 6), (0.5, 0.5), ("1", 1.0), ("0.25", 0.25), (" 2/6 ", 1 / 3)]
)
def test_shares(given, share):
    assert share_of(given, "here") == pytest.approx(share, abs=1e-15)


@pytest.mark.parametrize(
    "given", ["1/0", "six", "1e400", "-1/6", "1//6", None, [1], "11", math.inf]
)
def test_bad_shares(given):
    with pytest.raises(InputError, match="here: expected a share of c_max"):
        share_of(given, "here")


class TestCoordinates:
    def test_equal_ratios_of_c_are_equal_steps(self):
        grid = Grid((0.0, 1.0, 2.0), (0.125, 0.25, 0.5, 1.0))
        places = coordinates(grid)
        np.testing.assert_allclose(places[:4], [[0, 0], [0, 1], [0, 2], [0, 3]], atol=1e-12)
        assert tuple(places[-1]) == (2.0, 3.0)

    @pytest.mark.parametrize(
        "grid",
        [
            Grid(),
            Grid((0.0, 0.4, 3.0), (0.0, 0.5, 2.0)),
            Grid((1.0,), (0.2, 1.0)),
            Grid((2.0,), (0.5,)),
        ],
    )
    def test_there_and_back(self, grid):
        for setting in grid.settings:
            at = to_steps(grid, setting.sigma_n_deg, setting.c_fraction)
            ((sigma, c),) = from_steps(grid, np.array([at]))
            assert sigma == pytest.approx(setting.sigma_n_deg, abs=1e-12)
            assert c == pytest.approx(setting.c_fraction, abs=1e-12)

    def test_steps_of_a_table(self):
        assert grid_steps(Grid(), 0.75, 0.25) == pytest.approx((1.5, 0.5))


class TestOrder:
    def test_williams_square(self):
        """Williams 1949 for six treatments: 0 1 5 2 4 3 and its shifts."""
        assert williams_row(6, 0) == (0, 1, 5, 2, 4, 3)
        pairs = collections.Counter(
            pair for row in range(6) for pair in itertools.pairwise(williams_row(6, row))
        )
        assert set(pairs.values()) == {1}
        assert len(pairs) == 30

    def test_balanced_over_42_observers(self):
        """Each stimulus once at each place, and once after each other one."""
        made = study()
        rows = [[t.setting for t in planned_trials(made, n)] for n in range(42)]
        places = collections.Counter((k, s) for row in rows for k, s in enumerate(row))
        pairs = collections.Counter(pair for row in rows for pair in itertools.pairwise(row))
        assert len(places) == 42 * 42
        assert set(places.values()) == {1}
        assert len(pairs) == 42 * 41
        assert set(pairs.values()) == {1}

    @pytest.mark.parametrize("count", [1, 2, 3, 5, 8])
    def test_two_observers_in_turn_balance_each_other(self, count):
        """A row and its reverse: the mean place of every stimulus is the middle, after any pair."""
        made = study(grid=Grid(tuple(float(k) for k in range(count)), (1.0,)))
        for first in (0, 2, 4):
            rows = [[t.setting for t in planned_trials(made, first + k)] for k in (0, 1)]
            assert rows[0] == rows[1][::-1]

    def test_random_order_is_not_balanced_but_repeats(self):
        """The control: by chance two observers in turn are no reverse of each other."""
        made = study(order="random")
        rows = [[t.setting for t in planned_trials(made, n)] for n in (0, 1, 0)]
        assert rows[0] == rows[2]
        assert rows[0] != rows[1][::-1]
        assert sorted(rows[0]) == list(range(42))

    def test_seed_and_observer_change_the_order(self):
        rows = {
            (seed, n): tuple(t.setting for t in planned_trials(study(seed=seed), n))
            for seed in (0, 1)
            for n in (0, 1, 2)
        }
        assert len(set(rows.values())) == 6

    def test_samples_come_one_after_another_in_balanced_order(self):
        made = study(THREE, repeats=2)
        trials = planned_trials(made, 3)
        assert [t.position for t in trials] == list(range(252))
        blocks = [key for key, _ in itertools.groupby(trials, key=lambda t: (t.sample, t.repeat))]
        assert blocks == [(s, r) for s in sample_order(made, 3) for r in (0, 1)]
        firsts = collections.Counter(sample_order(made, n)[0] for n in range(6))
        assert set(firsts.values()) == {2}

    def test_repeats_are_orders_of_their_own(self):
        trials = planned_trials(study(repeats=2), 0)
        first, second = ([t.setting for t in trials if t.repeat == r] for r in (0, 1))
        assert sorted(first) == sorted(second)
        assert first != second
