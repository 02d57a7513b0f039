"""Agreement against published values and scipy; permutation tests against their own promise."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import friedmanchisquare, kstest, rankdata, spearmanr

from relgloss_view.experiment.verdict.agreement import (
    _mid_ranks,
    kendall_w,
    krippendorff_alpha,
    no_difference_p,
    relation_to_others,
)

NAN = float("nan")
#: Four observers, twelve units, values of 1 to 5 (Krippendorff 2011, section C).
KRIPPENDORFF = [
    [1, 2, 3, 3, 2, 1, 4, 1, 2, NAN, NAN, NAN],
    [1, 2, 3, 3, 2, 2, 4, 1, 2, 5, NAN, 3],
    [NAN, 3, 3, 3, 2, 3, 4, 2, 2, 5, 1, NAN],
    [1, 2, 3, 3, 2, 4, 4, 1, 2, 5, 1, NAN],
]
#: Chance of 0.1 % that a Kolmogorov-Smirnov distance of n values exceeds this / sqrt(n).
KS_LIMIT = 1.95


def as_answers(table):
    """Observer, stimulus, category of a complete table (observers, stimuli)."""
    who, what = np.indices(np.shape(table))
    return who.ravel(), what.ravel(), np.ravel(table)


def ks_distance(p):
    """Of p-values from the uniform law."""
    return kstest(p, "uniform").statistic


@pytest.fixture
def rng():
    return np.random.default_rng(3)


class TestKrippendorff:
    @pytest.mark.parametrize(
        ("level", "published"), [("nominal", 0.743), ("ordinal", 0.815), ("interval", 0.849)]
    )
    def test_published_example(self, level, published):
        assert krippendorff_alpha(KRIPPENDORFF, level) == pytest.approx(published, abs=5e-4)

    def test_ordinal_knows_only_order(self):
        stretched = np.square(KRIPPENDORFF)
        found = krippendorff_alpha(stretched)
        assert found == pytest.approx(krippendorff_alpha(KRIPPENDORFF), abs=1e-12)
        assert krippendorff_alpha(stretched, "interval") != pytest.approx(0.849, abs=5e-3)

    def test_agreement_and_chance(self, rng):
        order = np.tile(np.arange(5.0), 8)
        assert krippendorff_alpha([order, order, order]) == pytest.approx(1.0)
        # About the mean correlation of 105 pairs of observers, each of sd 1/sqrt(42) and all
        # uncorrelated: sd 1/sqrt(105 x 42) = 0.015.
        random = krippendorff_alpha(rng.integers(0, 5, (15, 42)))
        assert random == pytest.approx(0.0, abs=4 * 0.015)

    @pytest.mark.parametrize(
        "ratings",
        [
            np.full((3, 4), NAN),
            np.full((3, 4), 2.0),
            [[1.0, 2.0, NAN], [NAN, NAN, 3.0]],  # no unit twice
            [[1.0, 2.0, 3.0]],
            [[1.0, 1.0, 2.0], [1.0, 1.0, NAN]],  # what is there twice is alike
        ],
    )
    def test_none_where_nothing_is_to_agree_on(self, ratings):
        assert krippendorff_alpha(ratings) is None

    def test_unknown_level(self):
        with pytest.raises(ValueError, match="level"):
            krippendorff_alpha(KRIPPENDORFF, "ratio")  # type: ignore[arg-type]


class TestKendall:
    @pytest.mark.parametrize("categories", [3, 5, 1000])
    def test_is_friedmans_over_its_most(self, rng, categories):
        table = rng.integers(0, categories, (7, 12)) + np.arange(12) // 3
        expected = friedmanchisquare(*table.T).statistic / (7 * 11)
        assert kendall_w(table) == pytest.approx(expected, abs=1e-12)
        assert kendall_w(table[:, :1]) is None

    def test_ends(self):
        order = np.arange(6.0)
        assert kendall_w([order, 2 * order, order**2]) == pytest.approx(1.0)
        assert kendall_w([order, order[::-1]]) == pytest.approx(0.0)

    def test_full_agreement_with_ties_is_one(self):
        ties = [0, 0, 1, 1, 1, 2]
        assert kendall_w([ties, ties, ties]) == pytest.approx(1.0)

    def test_leaves_out_what_not_all_rated(self):
        table = np.array([[1.0, 2.0, NAN, 4.0], [2.0, 1.0, 9.0, 3.0]])
        assert kendall_w(table) == kendall_w(table[:, [0, 1, 3]])

    @pytest.mark.parametrize("table", [np.ones((3, 4)), [[1.0, 2.0]], np.full((3, 3), NAN)])
    def test_none_where_nothing_is_ranked(self, table):
        assert kendall_w(table) is None


class TestRelationToOthers:
    def test_correlation_is_spearmans_with_the_others_mean(self, rng):
        table = np.arange(20) // 4 + rng.integers(0, 4, (6, 20))
        for found in relation_to_others(*as_answers(table), seed=1):
            others = np.delete(table, found.observer, axis=0).mean(axis=0)
            expected = spearmanr(table[found.observer], others).statistic
            assert found.correlation == pytest.approx(expected, abs=1e-12)

    def test_points_out_who_answers_at_random(self, rng):
        """Nine who see a difference of 5 categories under a noise of 1, and one who guesses."""
        table = np.arange(20) // 4 + rng.integers(-1, 2, (10, 20))
        table[4] = rng.integers(0, 5, 20)
        found = relation_to_others(*as_answers(table), seed=1)
        assert [r.observer for r in found] == list(range(10))
        for relation in found:
            if relation.observer == 4:
                assert relation.p > 0.05
                assert abs(relation.correlation) < 3.0 / np.sqrt(19)
            else:
                assert relation.p == 1 / 1000
                assert relation.correlation > 0.7

    def test_p_is_uniform_under_random_answers_and_not_otherwise(self):
        """On a grid of 1/100, in ties on the safe side: two steps of it beyond the test's limit."""
        random, following = [], []
        for seed in range(300):
            rng = np.random.default_rng(seed)
            table = np.arange(20) // 4 + rng.integers(-1, 2, (4, 20))
            table[0] = rng.integers(0, 8, 20)
            random.append(relation_to_others(*as_answers(table), seed, 99)[0].p)
            table[0] += np.arange(20) // 10  # control: half a category of what the others see
            following.append(relation_to_others(*as_answers(table), seed, 99)[0].p)
        limit = KS_LIMIT / np.sqrt(300) + 0.02
        assert ks_distance(random) < limit
        assert ks_distance(following) > limit

    def test_against_the_others_has_a_large_p(self):
        table = np.tile(np.arange(10), (4, 1))
        table[2] = table[2, ::-1]
        found = relation_to_others(*as_answers(table), seed=1)[2]
        assert found.correlation == pytest.approx(-1.0)
        assert found.p > 0.99

    def test_who_cannot_be_told(self):
        who = [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 3, 3, 3]
        what = [0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 7, 8, 9]
        answer = [0, 1, 2, 3, 2, 2, 2, 2, 1, 4, 1, 2, 3]
        found = relation_to_others(who, what, answer, seed=1)
        # Always the same; two answers; stimuli that nobody else judged.
        assert [r.observer for r in found if r.correlation is None] == [1, 2, 3]
        assert all((r.p is None) == (r.correlation is None) for r in found)
        alone = relation_to_others([5, 5, 5], [0, 1, 2], [0, 1, 2], seed=1)
        assert [(r.observer, r.correlation, r.p) for r in alone] == [(5, None, None)]
        assert relation_to_others([], [], [], seed=1) == []

    def test_repeats_pair_with_the_others_only(self):
        """Own answers do not count among the others': one stimulus twice, two observers."""
        who, what = [0, 0, 0, 0, 1, 1, 1], [0, 0, 1, 2, 0, 1, 2]
        found = relation_to_others(who, what, [0, 4, 1, 2, 1, 2, 3], seed=1)[0]
        expected = spearmanr([0, 4, 1, 2], [1, 1, 2, 3]).statistic
        assert found.correlation == pytest.approx(expected, abs=1e-12)

    def test_depends_on_the_seed_and_not_on_the_order_of_answers(self, rng):
        answers = as_answers(rng.integers(0, 5, (5, 12)))
        order = rng.permutation(60)
        shuffled = [a[order] for a in answers]
        assert relation_to_others(*answers, seed=7) == relation_to_others(*shuffled, seed=7)
        assert relation_to_others(*answers, seed=7) != relation_to_others(*answers, seed=8)


class TestNoDifference:
    def answers(self, rng, effect):
        """Fifteen observers with biases, each a third of 12 stimuli at random, twice."""
        who = np.repeat(np.arange(15), 8)
        what = np.concatenate([np.tile(rng.choice(12, 4, replace=False), 2) for _ in range(15)])
        answer = rng.integers(0, 5, who.size) + who % 3 + effect * what
        return who, what, answer

    def test_p_is_uniform_under_random_answers_and_not_otherwise(self):
        """On a grid of 1/100: one step of it beyond the test's limit."""
        random, weak = [], []
        for seed in range(300):
            random.append(no_difference_p(*self.answers(np.random.default_rng(seed), 0), seed, 99))
            weak.append(no_difference_p(*self.answers(np.random.default_rng(seed), 0.1), seed, 99))
        limit = KS_LIMIT / np.sqrt(300) + 0.01
        assert ks_distance(random) < limit
        assert ks_distance(weak) > limit

    def test_strong_effect_has_the_least_p(self, rng):
        assert no_difference_p(*self.answers(rng, 3), seed=1) == 1 / 1000
        assert no_difference_p(*self.answers(rng, 0), seed=1) > 0.01

    def test_observers_biases_are_no_difference(self, rng):
        """Two groups of stimuli, each seen by observers who answer higher or lower throughout."""
        who = np.repeat(np.arange(10), 6)
        what = np.where(who < 5, 0, 6) + np.tile(np.arange(6), 10)
        answer = rng.integers(0, 5, 60) + np.where(who < 5, 0, 40)
        assert no_difference_p(who, what, answer, seed=1) > 0.01

    def test_is_friedmans_of_a_complete_table(self):
        """Its law is chi-square to 1/observers; a p near 0.1 of 999 permutations has sd 0.01."""
        rng = np.random.default_rng(8)
        for _ in range(5):
            table = rng.integers(0, 100, (30, 6)) + 4 * np.arange(6)
            expected = friedmanchisquare(*table.T).pvalue
            found = no_difference_p(*as_answers(table), seed=1)
            assert found == pytest.approx(expected, abs=0.05)

    def test_nothing_can_differ(self):
        assert no_difference_p([], [], [], seed=1) == 1.0
        assert no_difference_p([0, 1], [5, 5], [0, 3], seed=1) == 1.0
        assert no_difference_p([0, 0, 1, 1], [2, 3, 2, 3], [1, 1, 4, 4], seed=1) == 1.0
        assert no_difference_p([0, 1, 2], [0, 1, 2], [0, 1, 2], seed=1) == 1.0

    def test_depends_on_the_seed_and_not_on_the_order_of_answers(self, rng):
        answers = self.answers(rng, 0)
        order = rng.permutation(answers[0].size)
        shuffled = [a[order] for a in answers]
        assert no_difference_p(*answers, seed=7) == no_difference_p(*shuffled, seed=7)
        found = {no_difference_p(*answers, seed=s) for s in range(5)}
        assert len(found) > 1

    def test_arrays_of_other_lengths(self):
        with pytest.raises(ValueError, match="shapes"):
            no_difference_p([0, 1], [0], [0, 1], seed=1)


def test_mid_ranks_are_those_of_scipy():
    values = np.random.default_rng(0).integers(0, 4, (6, 11)).astype(float)
    np.testing.assert_array_equal(_mid_ranks(values), rankdata(values, axis=1))
    np.testing.assert_array_equal(_mid_ranks(values[0]), rankdata(values[0]))
