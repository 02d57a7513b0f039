"""Each kind of simulated observers against closed forms: the shares of categories, worked by hand.

The control of each is the analysis's own model (Euclidean, normal noise): it must not fit there.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from cases import percepts, standing, study
from scipy.optimize import minimize_scalar
from scipy.special import expit, ndtr
from scipy.stats import gumbel_r, norm

from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.observers.kinds import (
    KINDS,
    NOTHING,
    SETTING,
    Mismatch,
    closest_on_average,
    gumbel,
    logistic,
    towards_middle,
)
from relgloss_view.experiment.observers.percept import BOTH_SIGNS, Percept, Percepts, unseen
from relgloss_view.experiment.observers.population import Population, SimulatedObserver
from relgloss_view.experiment.observers.simulation import run_observers
from relgloss_view.experiment.observers.truth import right_settings
from relgloss_view.experiment.session.store import Store
from relgloss_view.picture.scene.setting import Setting

BOUNDS = (1.0, 2.0, 3.0, 4.0)
COUNT = 6000
NAN = math.nan
SD_1_LOGISTIC = math.pi / math.sqrt(3.0)  # per unit of a logistic of sd 1


def by_logistic(distance):
    return np.diff([0.0, *expit((np.array(BOUNDS) - distance) * SD_1_LOGISTIC), 1.0])


def by_gumbel(distance):
    scale = math.sqrt(6.0) / math.pi
    cut = gumbel_r.cdf(np.array(BOUNDS), loc=distance - 0.5772156649015329 * scale, scale=scale)
    return np.diff([0.0, *cut, 1.0])


def by_normal(distance):
    return np.diff([0.0, *ndtr(np.array(BOUNDS) - distance), 1.0])


def moved(shares, share):
    """A share of the answers, one category towards the third of five."""
    to = np.array([1, 2, 2, 2, 3])
    out = (1.0 - share) * shares
    np.add.at(out, to, share * shares)
    return out


def answered(kind, mismatch, question="ratio", **made):
    observer = SimulatedObserver(Population(kind=kind, lapse=0.0), 3, 0, BOUNDS, (0.0, 0.0), **made)
    answers = [observer.judge(k, 0, question, mismatch) for k in range(COUNT)]
    return np.bincount(answers, minlength=5) / COUNT


def fits(found, expected):
    """Within 4 standard errors, every category."""
    return bool(np.all(np.abs(found - expected) <= 4.0 * np.sqrt(expected / COUNT) + 5e-4))


#: kind, mismatch, how it is made, expected shares; distances by hand.
CLOSED_FORMS = [
    # Too glossy by 2: hypot(3, 0) saturates to 4 (1 - exp(-3/4)) = 2.1105; too dull by 2: to 4 (1 -
    # exp(-1/4)) = 0.8848; far too glossy: never 4.
    ("asymmetric", Mismatch(2.0, 0.0), {}, by_gumbel(2.1105)),
    ("asymmetric", Mismatch(-2.0, 0.0), {}, by_gumbel(0.8848)),
    ("asymmetric", Mismatch(50.0, 0.0), {}, by_gumbel(4.0)),
    # hypot(1.5, 2) = 2.5 saturates to 1.8590.
    ("asymmetric", Mismatch(1.0, -2.0), {}, by_gumbel(1.8590)),
    ("city-block", Mismatch(NAN, NAN, ((1.5, -1.5),)), {}, by_logistic(3.0)),
    ("city-block", Mismatch(NAN, NAN, ((0.0, 3.0),)), {}, by_logistic(3.0)),
    ("two-groups", Mismatch(-0.5, 3.0), {"group": 0}, by_logistic(0.5)),
    ("two-groups", Mismatch(-0.5, 3.0), {"group": 1}, by_logistic(3.0)),
    ("two-optima", Mismatch(NAN, NAN, ((6.0, 0.0), (0.0, -1.0))), {}, by_logistic(1.0)),
    ("two-optima", Mismatch(NAN, NAN, ((3.0, 4.0), (9.0, 9.0))), {}, by_logistic(5.0)),
    ("middle", Mismatch(0.5, -2.5), {}, by_logistic(2.5)),
    ("middle", Mismatch(0.0, 0.0), {"to_middle": 1.0}, moved(by_logistic(0.0), 1.0)),
    ("middle", Mismatch(-3.5, 1.0), {"to_middle": 0.4}, moved(by_logistic(3.5), 0.4)),
]


class TestClosedForms:
    @pytest.mark.parametrize(("kind", "mismatch", "made", "expected"), CLOSED_FORMS)
    def test_shares_of_categories(self, kind, mismatch, made, expected):
        assert fits(answered(kind, mismatch, **made), expected)

    @pytest.mark.parametrize(
        "kind", ["asymmetric", "city-block", "two-groups", "two-optima", "middle"]
    )
    def test_the_analysis_has_another_model(self, kind):
        """The control: Euclidean distances and normal noise give other shares of some category."""
        for name, mismatch, made, _ in CLOSED_FORMS:
            pairs = mismatch.settings or ((mismatch.gloss, mismatch.grain),)
            distance = math.hypot(*pairs[0])
            if name == kind and not fits(answered(kind, mismatch, **made), by_normal(distance)):
                return
        pytest.fail(f"{kind} answers as the analysis assumes at every place")

    def test_lapses_are_uniform(self):
        observer = SimulatedObserver(
            Population(kind="city-block", lapse=0.4), 3, 0, BOUNDS, (0.0, 0.0)
        )
        mismatch = Mismatch(NAN, NAN, ((2.0, 0.0),))
        answers = [observer.judge(k, 0, "ratio", mismatch) for k in range(COUNT)]
        found = np.bincount(answers, minlength=5) / COUNT
        assert fits(found, 0.6 * by_logistic(2.0) + 0.08)
        assert not fits(found, by_logistic(2.0))  # the control

    @pytest.mark.parametrize("kind", [k for k, kind in KINDS.items() if kind.depends_on != NOTHING])
    def test_asked_about_grain_only_grain_counts(self, kind):
        observer = SimulatedObserver(Population(kind=kind), 0, 0, BOUNDS, (0.0, 0.0))
        mismatch = Mismatch(7.0, -1.25, ((-1.25, 7.0),))
        assert observer.distance("grain", mismatch) == 1.25

    @pytest.mark.parametrize("draw", [logistic, gumbel])
    def test_noise_has_a_standard_deviation_of_one(self, draw):
        random = np.random.default_rng(1)
        drawn = np.array([draw(random) for _ in range(40_000)])
        assert abs(np.mean(drawn)) < 4.0 / 200.0
        assert abs(np.std(drawn) - 1.0) < 0.04
        # The control: it is not normal.
        share = np.mean(drawn > 2.5)
        assert share > 1.5 * norm.sf(2.5)


class TestObservers:
    def test_every_kind_has_its_own_meaning(self):
        assert len({kind.meaning for kind in KINDS.values()}) == len(KINDS)

    @pytest.mark.parametrize("kind", ["asymmetric", "city-block", "middle"])
    def test_each_category_has_a_personal_width(self, kind):
        """For `unique`, the observers of the analysis, all widths share one factor."""

        def ratios(name):
            made = [SimulatedObserver.of(Population(kind=name), 5, n, 5) for n in range(40)]
            widths = np.array([np.diff(o.bounds) for o in made])
            assert np.all(widths > 0.0)
            return widths[:, 1] / widths[:, 0]

        # Of the log of a ratio of two log-normal widths of sd 0.3: 0.42; 40 observers: +- 0.05.
        assert np.std(np.log(ratios(kind))) == pytest.approx(0.3 * math.sqrt(2.0), abs=0.15)
        assert np.ptp(ratios("unique")) < 1e-9

    def test_groups_are_halves_under_either_sign_of_grain(self):
        made = study(("uncoated",))
        seen = dataclasses.replace(percepts(made, [Setting(1.0, 0.5)]), grain_weights=BOTH_SIGNS)
        who = [
            (SimulatedObserver.of(Population(kind="two-groups"), 0, n, 5).group,
             seen.grain_weight_of(n))
            for n in range(8)
        ]  # fmt: skip
        assert sorted(set(who)) == sorted((g, w) for g in (0, 1) for w in BOTH_SIGNS)
        assert all(who.count(w) == 2 for w in who)
        assert {SimulatedObserver.of(Population(), 0, n, 5).group for n in range(4)} == {0}

    @pytest.mark.parametrize(
        ("categories", "moves"),
        [(2, [0, 1]), (3, [1, 1, 1]), (4, [1, 1, 2, 2]), (5, [1, 2, 2, 2, 3])],
    )
    def test_towards_the_middle(self, categories, moves):
        assert [towards_middle(k, categories) for k in range(categories)] == moves


class TestTruthIsClosestForAll:
    """The truth of a study is what its population finds closest on average."""

    def test_against_an_independent_minimum(self):
        """100,000 observers of made-up truths, minimised by scipy."""
        sd, random = 0.5, np.random.default_rng(0)
        gloss, grain = sd * random.standard_normal((2, 100_000))

        def mean(at):
            signed = at + gloss
            distance = np.hypot(np.where(signed > 0.0, 1.5, 0.5) * signed, grain)
            return np.mean(4.0 * (1.0 - np.exp(-distance / 4.0)))

        least = minimize_scalar(mean, bounds=(-1.5, 1.5), method="bounded").x
        found = closest_on_average(KINDS["asymmetric"], sd)
        assert found == pytest.approx(least, abs=0.01)
        assert found < -0.1  # the control: without it the truth would not be the closest

    @pytest.mark.parametrize("kind", [k for k in KINDS if k != "asymmetric"])
    def test_is_the_mean_of_others(self, kind):
        assert closest_on_average(KINDS[kind], 0.5) == 0.0

    def test_two_optima_are_half_of_the_grid_apart(self):
        grid = Grid()
        for truth in (*grid.settings, Setting(1.37, 0.61)):
            first, second = right_settings(grid, truth, 2)
            assert first == truth
            assert abs(second.sigma_n_deg - truth.sigma_n_deg) == pytest.approx(1.5)
            assert abs(second.c_fraction - truth.c_fraction) == pytest.approx(2.5 / 6)
            assert 0.0 <= second.sigma_n_deg <= 3.0
            assert 1 / 6 - 1e-9 <= second.c_fraction <= 1.0 + 1e-9
        assert right_settings(grid, grid.settings[3], 1) == (grid.settings[3],)

    def test_two_optima_on_a_line(self):
        grid = Grid((0.0,), (0.25, 0.5, 0.75, 1.0))
        assert right_settings(grid, Setting(0.0, 0.25), 2)[1] == Setting(0.0, pytest.approx(0.625))


class TestGrainWeight:
    def test_there_is_no_gloss_without_it(self):
        with pytest.raises(TypeError):
            Percept(1.0, 0.1).log_gloss()
        with pytest.raises(TypeError):
            Percepts(np.zeros((1, 1, 2)), (Setting(0.0, 1.0),), np.zeros((1, 2)))
        with pytest.raises(ValueError, match="at least one"):
            Percepts(np.zeros((1, 1, 2)), (Setting(0.0, 1.0),), np.zeros((1, 2)), ())

    @pytest.mark.parametrize("weight", [-4.0, 0.0, 2.5])
    def test_adds_to_log_gloss(self, weight):
        made = study(grid=Grid((0.0, 2.0), (0.5, 1.0)))
        plain = percepts(made, [Setting(1.0, 0.7)])
        stimuli, targets = dataclasses.replace(plain, grain_weights=(weight,)).seen_by(0)
        np.testing.assert_allclose(
            stimuli[0, :, 0], plain.stimuli[0, :, 0] + weight * plain.stimuli[0, :, 1]
        )
        np.testing.assert_array_equal(stimuli[..., 1], plain.stimuli[..., 1])
        assert targets[0, 0] == Percept(*plain.targets[0]).log_gloss(weight)

    def test_who_judges_settings_sees_no_picture(self, tmp_path):
        made = study(grid=Grid((0.0, 2.0), (0.5, 1.0)))
        for kind in [k for k in KINDS if KINDS[k].depends_on == SETTING]:
            with Store(tmp_path / f"{kind}.sqlite", made) as store:
                run_observers(store, unseen(made, [Setting(0.0, 1.0)]), Population(kind), 3, 7)
                answers = [(k, trial.setting) for _, trial, _, k in standing(store)]
                at_truth = [k for k, setting in answers if setting == 1]
                assert len(answers) == 12
                # The truth, and of two the setting half of the grid away, are closest.
                assert np.mean(at_truth) <= np.mean([k for k, _ in answers])
