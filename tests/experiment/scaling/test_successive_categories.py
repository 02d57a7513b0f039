"""Successive categories: what exact proportions must give back, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ndtr

from relgloss_view.base.errors import InputError
from relgloss_view.experiment.scaling.successive_categories import successive_categories

#: Closeness, mean 0, and bounds: no share of theirs is below Phi(-4) = 3e-5, so that clipping at
#: 1/(2 ANSWERS) touches none.
TRUE_SCALE = np.array([2.0, 1.1, 0.4, 0.3, -0.7, -1.2, -1.9])
BOUNDS = np.array([-1.5, -0.6, 0.1, 1.4])
ANSWERS = 1e6


def shares_upto(scale=TRUE_SCALE, bounds=BOUNDS):
    """P(category <= k), (J, K-1), straight from the law of categorical judgment."""
    return ndtr(np.asarray(bounds) + np.asarray(scale)[:, None])


def counts_of(upto, answers=ANSWERS):
    upto = np.asarray(upto, dtype=np.float64)
    ends = np.zeros((len(upto), 1))
    return answers * np.diff(np.hstack([ends, upto, ends + 1.0]), axis=1)


@pytest.fixture
def rng():
    return np.random.default_rng(11)


class TestExactProportions:
    # Deviates of shares from 3e-5 to 1 - 3e-5 keep a relative error of about 1e-16 / 3e-5 / 4.
    @pytest.mark.parametrize("zero", ["clip", "drop"])
    def test_give_back_scale_and_bounds(self, zero):
        found = successive_categories(counts_of(shares_upto()), zero)
        assert found.scale == pytest.approx(TRUE_SCALE, abs=1e-9)
        assert found.bounds == pytest.approx(BOUNDS, abs=1e-9)

    def test_two_categories(self):
        found = successive_categories(counts_of(shares_upto(bounds=[0.3])))
        assert found.scale == pytest.approx(TRUE_SCALE, abs=1e-9)
        assert found.bounds == pytest.approx([0.3], abs=1e-9)

    def test_of_few_cells_are_enough_when_the_rest_is_dropped(self):
        upto = shares_upto()
        upto[upto < 0.05] = 0.0
        upto[upto > 0.95] = 1.0
        assert np.sum((upto == 0.0) | (upto == 1.0)) == 11
        dropped = successive_categories(counts_of(upto), "drop")
        assert dropped.scale == pytest.approx(TRUE_SCALE, abs=1e-9)
        assert dropped.bounds == pytest.approx(BOUNDS, abs=1e-9)
        # Control: clipping makes something up for them.
        clipped = successive_categories(counts_of(upto, 100.0), "clip")
        assert np.max(np.abs(clipped.scale - TRUE_SCALE)) > 0.1

    def test_closer_is_larger(self):
        found = successive_categories([[9, 1, 0], [1, 9, 1], [0, 1, 9]])
        assert found.scale[0] > found.scale[1] > found.scale[2]
        assert found.bounds[0] < 0.0 < found.bounds[1]


class TestClipping:
    def test_takes_half_an_answer(self):
        # 10 answers: 1/20. Closed form of two stimuli and one bound.
        found = successive_categories([[10, 0], [5, 5]])
        z = 1.6448536269514722  # Phi^-1(0.95), from tables
        assert found.scale == pytest.approx([z / 2, -z / 2], abs=1e-12)
        assert found.bounds == pytest.approx([z / 2], abs=1e-12)

    def test_one_answer_a_stimulus_tells_nothing(self):
        one = np.eye(3)
        found = successive_categories(one)
        assert np.array_equal(found.scale, np.zeros(3))
        assert np.array_equal(found.bounds, np.zeros(2))
        with pytest.raises(InputError, match="lies between 0 and 1"):
            successive_categories(one, "drop")

    def test_less_than_one_answer_is_finite(self):
        found = successive_categories([[0.1, 0.0], [0.0, 0.2], [3.0, 4.0]])
        assert np.all(np.isfinite(found.scale))


class TestUnusedCategories:
    @pytest.mark.parametrize("zero", ["clip", "drop"])
    def test_leave_the_scale_as_if_they_were_not_there(self, zero, rng):
        counts = rng.integers(1, 9, (6, 4)).astype(float)
        without = successive_categories(counts, zero)
        wide = np.zeros((6, 8))
        wide[:, [1, 2, 5, 6]] = counts
        found = successive_categories(wide, zero)
        assert found.scale == pytest.approx(without.scale, abs=1e-12)
        a, b, c = without.bounds
        expected = [np.nan, a, b, b, b, c, np.nan]
        assert found.bounds == pytest.approx(expected, abs=1e-12, nan_ok=True)


class TestMissing:
    @pytest.mark.parametrize("zero", ["clip", "drop"])
    def test_stimulus_without_answers_has_no_place(self, zero):
        counts = counts_of(shares_upto())
        found = successive_categories(np.insert(counts, 2, 0.0, axis=0), zero)
        assert np.isnan(found.scale[2])
        assert np.delete(found.scale, 2) == pytest.approx(TRUE_SCALE, abs=1e-9)
        assert found.bounds == pytest.approx(BOUNDS, abs=1e-9)

    def test_stimuli_that_nothing_joins_to_the_most_have_no_place(self):
        # Three at the lower bound, two at the upper one, one at an end.
        counts = [[1, 3, 0], [2, 2, 0], [3, 1, 0], [0, 1, 3], [0, 3, 1], [0, 0, 4]]
        found = successive_categories(counts, "drop")
        z = 0.6744897501960817  # Phi^-1(0.75), from tables
        expected = [-z, 0.0, z, np.nan, np.nan, np.nan]
        assert found.scale == pytest.approx(expected, abs=1e-12, nan_ok=True)
        assert found.bounds == pytest.approx([0.0, np.nan], abs=1e-12, nan_ok=True)

    def test_bounds_keep_their_order_at_least_cost(self):
        """Steps of 0.1 and 0.05 of one stimulus, of 3 in place of the first of another.

        Without order the second step x would be 0.05 - (first - 0.1)/2 < 0. With x = 0, the first
        step g makes (2/3)(g - 0.1)^2 - (2/3)(g - 0.1) 0.05 + (g - 3)^2 / 2 least: the sums of
        squares about their means of (0, g - 0.1, g - 0.15) and (0, g - 3).
        """
        z = np.array([[-0.1, 0.0, 0.05], [-1.5, 1.5, np.inf]])
        found = successive_categories(counts_of(ndtr(z)), "drop")
        g = (3.0 + 4.0 / 3.0 * 0.1 + 2.0 / 3.0 * 0.05) / (7.0 / 3.0)
        assert np.diff(found.bounds) == pytest.approx([g, 0.0], abs=1e-9)
        assert np.mean(found.scale) == pytest.approx(0.0, abs=1e-12)
        # The second stimulus lies where its two deviates fit best.
        assert found.scale[1] == pytest.approx(-np.mean(found.bounds[:2]), abs=1e-9)


class TestRefused:
    @pytest.mark.parametrize(
        ("counts", "says"),
        [
            ([[0, 5, 0], [0, 2, 0]], "one category"),
            ([[0, 0, 0], [0, 0, 0]], "no answers"),
            ([[1, -1], [2, 3]], "not negative"),
            ([[1, np.nan], [2, 3]], "finite"),
        ],
    )
    def test_what_cannot_be_scaled(self, counts, says):
        for zero in ("clip", "drop"):
            with pytest.raises(InputError, match=says):
                successive_categories(counts, zero)

    @pytest.mark.parametrize("shape", [(3,), (3, 1), (2, 3, 4)])
    def test_other_shapes(self, shape):
        with pytest.raises(ValueError, match="shape"):
            successive_categories(np.ones(shape))

    def test_unknown_way_with_zeros(self):
        with pytest.raises(ValueError, match="'clip' or 'drop'"):
            successive_categories(np.ones((2, 2)), "keep")  # type: ignore[arg-type]
