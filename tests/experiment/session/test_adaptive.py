"""Adaptive studies: the posterior, what it chooses next, and when it has enough."""

from __future__ import annotations

import numpy as np
import pytest
from cases import answer, started, study, to_trial
from scipy.stats import norm

from relgloss_view.experiment.design.coordinates import coordinates, grid_steps
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.session.flow import Phase
from relgloss_view.experiment.session.posterior import (
    FIRST_BOUNDS,
    LAPSE,
    SLOPES,
    WIDTHS,
    Posterior,
)
from relgloss_view.experiment.session.store import Store
from relgloss_view.experiment.verdict.adaptive import adaptive_verdict
from relgloss_view.experiment.verdict.full_grid import BEST, BROAD, CHANCE, RIDGE

GRID = Grid()
PLACES = coordinates(GRID)
BOUNDS = np.array([0.8, 1.7, 2.7, 3.9])


def asked(ideal, slopes, count, seed, by_chance=False):
    """Answers to settings that the posterior itself chooses."""
    random = np.random.default_rng(seed)
    posterior, answers = Posterior(GRID, 5), []
    for _ in range(count):
        setting = posterior.draw(random)
        distance = np.linalg.norm(np.asarray(slopes) * (PLACES[setting] - ideal))
        category = int(np.searchsorted(BOUNDS, distance + random.standard_normal()))
        answers.append((setting, int(random.integers(5)) if by_chance else category))
        posterior.update(answers)
    return posterior


def test_the_likelihood_is_the_ordinal_probit_models():
    """Against scipy's normal distribution, written out for a few of the unknowns."""
    posterior = Posterior(GRID, 5)
    posterior.update([(10, 2)])
    points, slopes = posterior.points, [(a, b) for a in SLOPES for b in SLOPES]
    bounds = [t + w * np.arange(4) for t in FIRST_BOUNDS for w in WIDTHS]
    for point, slope, bound in ((0, 0, 0), (100, 7, 5), (524, 35, 15), (33, 20, 9)):
        d = np.linalg.norm(np.asarray(slopes[slope]) * (points[point] - PLACES[10]))
        share = norm.cdf(bounds[bound][2] - d) - norm.cdf(bounds[bound][1] - d)
        expected = np.log((1.0 - LAPSE) * share + LAPSE / 5)
        assert posterior._log[point, slope, bound] == pytest.approx(expected, abs=1e-5)  # float32


def test_the_order_of_answers_does_not_matter_and_taking_back_does():
    answers = [(3, 0), (20, 4), (3, 1), (41, 2)]
    one, other, less = Posterior(GRID, 5), Posterior(GRID, 5), Posterior(GRID, 5)
    for k in range(1, 5):
        one.update(answers[:k])
    other.update(answers[::-1])
    np.testing.assert_allclose(one.weights(), other.weights(), rtol=1e-4)
    one.update(answers[:2])  # two were taken back
    less.update(answers[:2])
    np.testing.assert_allclose(one.weights(), less.weights(), rtol=1e-6)
    assert not np.allclose(one.weights(), other.weights(), rtol=0.1)


def test_without_answers_nothing_is_known():
    posterior = Posterior(GRID, 5)
    weights = posterior.weights()
    np.testing.assert_allclose(weights, 1.0 / len(weights))
    assert posterior.chance() == pytest.approx(0.5)
    verdict = adaptive_verdict(posterior, GRID, 0.01)
    assert verdict.status != BEST


@pytest.mark.slow
def test_finds_the_ideal_with_60_answers():
    """9 studies with ideals inside and at edges: a median error of at most half a step.

    In steps of the posterior's own plane. The control: with six answers it is farther off.
    """
    ideals = [(4.0, 1.9), (0.0, 4.5), (2.6, 0.0)] * 3

    def median_error(count):
        found = [
            asked(ideal, (0.9, 1.3), count, seed).estimate() for seed, ideal in enumerate(ideals)
        ]
        places = np.array([posterior_steps(estimate) for estimate in found])
        return np.median(np.linalg.norm(places - np.array(ideals), axis=1))

    enough, few = median_error(60), median_error(6)
    assert enough <= 0.5
    assert few > 2.0 * enough


def posterior_steps(estimate):
    from relgloss_view.experiment.design.coordinates import to_steps

    return to_steps(GRID, estimate.sigma_n_deg, estimate.c_fraction)


class TestVerdict:
    def test_best(self):
        verdict = adaptive_verdict(asked((4.0, 1.9), (0.9, 1.3), 60, 1), GRID, 0.01)
        assert verdict.status == BEST
        setting = GRID.settings[verdict.leading]
        assert grid_steps(GRID, setting.sigma_n_deg, setting.c_fraction) == pytest.approx(
            (4.0, 1.0), abs=1.01
        )

    def test_ridge(self):
        statuses = [
            adaptive_verdict(asked((3.0, 2.0), (0.0, 1.3), 90, s), GRID, 0.01).status
            for s in range(4)
        ]
        assert statuses.count(RIDGE) >= 3

    def test_by_chance(self):
        """What was chosen depends on the answers, and yet they tell nothing."""
        statuses = [
            adaptive_verdict(asked((0, 0), (0, 0), 60, s, by_chance=True), GRID, 0.01).status
            for s in range(6)
        ]
        assert set(statuses) <= {CHANCE, BROAD}
        assert statuses.count(CHANCE) >= 5

    @pytest.mark.parametrize(
        "grid", [Grid((1.0,), GRID.c_fraction), Grid((0.0, 1.0, 2.0), (0.3, 0.6, 1.0))]
    )
    def test_small_grids_and_answers_that_tell_nothing(self, grid):
        """Nearly always "close", wherever asked: nothing is best, and a line has no ridge."""
        statuses = []
        for seed in range(6):
            random = np.random.default_rng(seed)
            posterior = Posterior(grid, 5)
            answers = [
                (
                    int(random.integers(len(grid))),
                    int(random.random() < 0.1) * int(random.integers(5)),
                )
                for _ in range(60)
            ]
            posterior.update(answers)
            statuses.append(adaptive_verdict(posterior, grid, 0.01).status)
        assert RIDGE not in statuses
        assert statuses.count(BEST) <= 1
        empty = adaptive_verdict(Posterior(grid, 5), grid, 0.01)
        assert empty.status != BEST

    def test_a_line_of_settings_has_a_best(self):
        grid = Grid((1.0,), GRID.c_fraction)
        places = coordinates(grid)
        random = np.random.default_rng(0)
        posterior, answers = Posterior(grid, 5), []
        for _ in range(60):
            setting = posterior.draw(random)
            noisy = 1.3 * abs(places[setting, 1] - 2.0) + random.standard_normal()
            answers.append((setting, int(np.searchsorted(BOUNDS, noisy))))
            posterior.update(answers)
        assert adaptive_verdict(posterior, grid, 0.01).status == BEST


class TestChooser:
    def test_stops_after_its_trials_and_goes_to_the_next_sample(self, tmp_path):
        made = study(("matte-coated", "uncoated"), design="adaptive", gap_s=0.0)
        with Store(tmp_path / "s.sqlite", made) as store:
            flow = started(store)
            while flow.phase is not Phase.FINISHED:
                answer(flow, 2)
            samples = [t.sample for t in store.trials(flow.observer)]
        assert len(samples) == 2 * made.adaptive.trials
        assert sorted(samples) in (samples, samples[::-1])

    def test_stops_when_the_interval_is_narrow(self, tmp_path):
        import dataclasses

        from relgloss_view.experiment.design.study import Adaptive

        made = dataclasses.replace(
            study(design="adaptive"), adaptive=Adaptive(trials=1000, interval_steps=1.5)
        )
        ideal = PLACES[26]
        random = np.random.default_rng(0)
        with Store(tmp_path / "s.sqlite", made) as store:
            flow = started(store)
            while flow.phase is not Phase.FINISHED:
                apart = np.array([0.9, 1.3]) * (PLACES[flow.trial.setting] - ideal)
                noisy = np.linalg.norm(apart) + random.standard_normal()
                answer(flow, int(np.searchsorted(BOUNDS, noisy)))
            count = len(store.answers())
            posterior = flow._chooser.posterior(0, store.answers())
        assert 10 < count < 300
        assert max(posterior.estimate().width_steps) <= 1.5

    def test_grain_takes_no_part_in_the_choice(self, tmp_path):
        """Whatever is answered about the grain, the same settings are asked about."""
        asked_of = []
        for k, grain in enumerate((0, 4)):
            made = study(design="adaptive", ask_grain=True)
            with Store(tmp_path / f"{k}.sqlite", made) as store:
                flow = started(store)
                while flow.phase is not Phase.FINISHED:
                    answer(flow, grain if flow.question == "grain" else flow.trial.setting % 5)
                asked_of.append([t.setting for t in store.trials(flow.observer)])
        assert asked_of[0] == asked_of[1]
        assert len(set(asked_of[0])) > 3  # a draw of its own for each trial

    def test_observers_share_what_is_known(self, tmp_path):
        """The second observer begins where the first has led, not with nothing."""
        made = study(design="adaptive")
        with Store(tmp_path / "s.sqlite", made) as store:
            first = started(store)
            while first.phase is not Phase.FINISHED:
                answer(first, 0 if first.trial.setting == 26 else 4)
            first.end()
            second = started(store)
            to_trial(second)
            posterior = second._chooser.posterior(0, store.answers())
        assert posterior.estimate().answers == made.adaptive.trials
        assert np.ptp(posterior.weights()) > 0.0
