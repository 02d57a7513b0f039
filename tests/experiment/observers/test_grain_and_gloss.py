"""Does a rough surface look glossier? What is published, and what BOTH_SIGNS makes of it.

The data sets GlossyBumpy and BumpyGlossy of the R package MLCM (Ho, Landy and Maloney 2008). They
are of bumps of the size of the object's features; of the grain of a print nothing is published.
"""

from __future__ import annotations

import numpy as np
import pytest
from cases import study
from conjoint import fit_additive, published
from scipy.special import ndtr, ndtri
from statsmodels.discrete.discrete_model import Probit

from relgloss_view.experiment.observers.percept import BOTH_SIGNS, see_study
from relgloss_view.experiment.observers.truth import PUBLISHED, truths_of

THREE = ("art-coated", "matte-coated", "uncoated")


def made_up(seed, first=(0.0, 0.4, 1.3), second=(0.0, -0.5, -0.2), count=4000):
    random = np.random.default_rng(seed)
    a, b = random.integers(3, size=(2, count, 2))
    apart = np.subtract(*np.array(first)[a].T) + np.subtract(*np.array(second)[b].T)
    return (random.random(count) < ndtr(apart)).astype(int), a, b


class TestFit:
    def test_two_levels_of_one_property_have_a_closed_form(self):
        """The second level beats the first in 140 of 200: it adds the normal quantile of 0.7."""
        response = np.r_[np.ones(140, int), np.zeros(60, int)]
        levels = np.tile([1, 0], (200, 1))
        # The other property decides in as many cases either way: it adds nothing.
        response = np.r_[response, 1, 0]
        other = np.r_[np.zeros((200, 2), int), np.tile([1, 0], (2, 1))]
        levels = np.r_[levels, np.zeros((2, 2), int)]
        found = fit_additive(response, levels, other, 2)
        assert found.first[1] == pytest.approx(ndtri(0.7), abs=1e-9)
        assert found.second[1] == pytest.approx(0.0, abs=1e-9)
        assert found.log_likelihood == pytest.approx(
            140 * np.log(0.7) + 60 * np.log(0.3) + 2 * np.log(0.5)
        )

    def test_against_statsmodels(self):
        response, a, b = made_up(2)
        columns = [
            (p[:, 0] == k).astype(float) - (p[:, 1] == k) for p in (a, b) for k in (1, 2)
        ]  # fmt: skip
        oracle = Probit(response, np.stack(columns, axis=1)).fit(disp=0)
        found = fit_additive(response, a, b, 3)
        np.testing.assert_allclose(np.r_[found.first[1:], found.second[1:]], oracle.params, 1e-6)
        np.testing.assert_allclose(np.sqrt(np.diag(found.covariance)), oracle.bse, 1e-3)
        assert found.log_likelihood == pytest.approx(oracle.llf)

    def test_finds_what_was_put_in(self):
        found = fit_additive(*made_up(3), 3)
        sd = np.sqrt(np.diag(found.covariance))
        apart = np.r_[found.first[1:], found.second[1:]] - (0.4, 1.3, -0.5, -0.2)
        assert np.all(np.abs(apart) < 4.0 * sd)
        assert found.second[1] < -4.0 * sd[2]  # the control: the sign is found


class TestPublished:
    """The values of an independent probit fit; the data are not part of the project."""

    def test_bumps_make_it_glossier(self):
        found = fit_additive(*published("glossy_bumpy"), 5)
        np.testing.assert_allclose(
            found.first[1:], (0.0107, 1.5719, 3.1578, 3.9169), atol=6e-5
        )  # fmt: skip
        np.testing.assert_allclose(found.second[1:], (0.9006, 1.1733, 1.4455, 1.3538), atol=6e-5)
        assert found.log_likelihood == pytest.approx(-273.7255, abs=6e-5)
        sd = np.sqrt(np.diag(found.covariance))[4:]
        assert np.all(found.second[1:] > 4.0 * sd)

    def test_gloss_makes_it_bumpier_by_less(self):
        response, gloss, bumps = published("bumpy_glossy")
        found = fit_additive(response, gloss, bumps, 5)
        np.testing.assert_allclose(found.first[1:], (0.1321, 0.1848, 0.5041, 0.6302), atol=6e-5)
        np.testing.assert_allclose(found.second[1:], (1.6927, 2.9469, 4.2814, 5.2753), atol=6e-5)
        assert found.log_likelihood == pytest.approx(-238.2402, abs=6e-5)

    def test_answers_of_others_give_nothing(self):
        """The control: with the answers in another order bumps add nothing."""
        response, gloss, bumps = published("glossy_bumpy")
        shuffled = np.random.default_rng(4).permutation(response)
        found = fit_additive(shuffled, gloss, bumps, 5)
        sd = np.sqrt(np.diag(found.covariance))[4:]
        assert np.all(np.abs(found.second[1:]) < 4.0 * sd)

    def test_as_a_weight_of_grain(self, renderer):
        """All bumps add a share of what all gloss adds; all grain, of what all c adds."""
        found = fit_additive(*published("glossy_bumpy"), 5)
        share = found.second[4] / found.first[4]
        assert share == pytest.approx(0.346, abs=5e-4)
        made = study(THREE, size_px=192)
        seen = see_study(renderer, made, truths_of(made, PUBLISHED, {}, 0), (0.0,))
        highlight, grain = (seen.stimuli[..., k].reshape(3, 7, 6) for k in (0, 1))
        by_c = np.mean(highlight[:, :, -1] - highlight[:, :, 0])
        by_grain = np.mean(grain[:, -1] - grain[:, 0])
        low, high = BOTH_SIGNS
        assert high == -low
        assert share * by_c / by_grain == pytest.approx(high, abs=0.5)
