"""Ordinal regression against published fits, statsmodels, closed forms, and hostile counts."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ndtr, ndtri
from scipy.stats import norm
from statsmodels.miscmodels.ordinal_model import OrderedModel

from relgloss_view.experiment.scaling.ordinal import _Loss, fit_cumulative, ordinal_scale
from relgloss_view.experiment.scaling.successive_categories import successive_categories

#: Bitterness of wine (Randall 1989) as Christensen prints it with R's package ordinal: 1 to 5, two
#: bottles by nine judges; cold without and with contact, warm without and with.
WINE = [
    [2, 1, 2, 3, 2, 3, 1, 2, 1, 3, 2, 3, 2, 3, 2, 1, 2, 2],
    [3, 1, 3, 3, 4, 3, 2, 2, 3, 4, 3, 2, 2, 3, 2, 2, 3, 2],
    [4, 2, 5, 3, 3, 2, 2, 3, 3, 4, 3, 5, 2, 3, 4, 3, 3, 2],
    [5, 5, 4, 5, 3, 5, 2, 3, 4, 5, 4, 4, 3, 3, 4, 3, 4, 4],
]
WINE_COUNTS = np.array([np.bincount(cell, minlength=6)[1:] for cell in WINE])
WARM_CONTACT = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]])


def statsmodels_fit(counts, design, distr="probit"):
    """Log-likelihood, bounds, coefficients by statsmodels, which has the same signs."""
    cell, category = np.nonzero(counts)
    often = counts[cell, category].astype(int)
    model = OrderedModel(
        np.repeat(category, often), np.repeat(design[cell], often, axis=0), distr=distr
    )
    # gtol 1e-7: what is left of the log-likelihood is its square over the information.
    done = model.fit(method="bfgs", disp=False, gtol=1e-7, maxiter=2000)
    size = design.shape[1]
    bounds = model.transform_threshold_params(done.params)[1:-1]
    return done.llf, bounds, np.asarray(done.params)[:size]


def drawn(rng, distance, bounds, answers, observers=None):
    """Counts (J, K), or (O, J, K) with a location per observer, of the model itself."""
    where = np.asarray(distance) if observers is None else distance + observers[:, None]
    upto = ndtr(np.asarray(bounds) - where[..., None])
    ends = np.zeros((*where.shape, 1))
    shares = np.diff(np.concatenate([ends, upto, ends + 1.0], axis=-1), axis=-1)
    return rng.multinomial(answers, shares).astype(float)


@pytest.fixture
def rng():
    return np.random.default_rng(5)


class TestWine:
    def test_published_logit(self):
        """clm(rating ~ temp + contact) of R's ordinal (Christensen), to the printed digits."""
        found = fit_cumulative(WINE_COUNTS, WARM_CONTACT, link="logit")
        assert found.log_likelihood == pytest.approx(-86.49192337, abs=1e-5)
        assert found.coefficients == pytest.approx([2.503, 1.528], abs=5e-4)
        assert found.bounds == pytest.approx([-1.344, 1.251, 3.467, 5.006], abs=5e-4)
        loss = _Loss(WINE_COUNTS.astype(float), WARM_CONTACT, np.zeros(2), "logit")
        information = loss.hessian(np.concatenate([found.bounds, found.coefficients]))
        errors = np.sqrt(np.diagonal(np.linalg.inv(information)))
        assert errors == pytest.approx([0.5171, 0.4379, 0.5978, 0.7309, 0.5287, 0.4766], abs=5e-5)
        assert found.converged

    def test_probit_against_statsmodels(self):
        found = fit_cumulative(WINE_COUNTS, WARM_CONTACT)
        best, bounds, coefficients = statsmodels_fit(WINE_COUNTS, WARM_CONTACT)
        assert found.log_likelihood == pytest.approx(best, abs=1e-6)
        assert found.coefficients == pytest.approx(coefficients, abs=1e-5)
        assert found.bounds == pytest.approx(bounds, abs=1e-5)
        # Control: the links tell apart.
        assert abs(found.log_likelihood - -86.49192337) > 0.5


class TestStatsmodels:
    # Slopes of 1e-7 there and 1e-5 here over an information of 10 or more: 1e-6 in coefficients.
    @pytest.mark.parametrize("seed", range(5))
    def test_random_designs(self, seed):
        rng = np.random.default_rng(seed)
        design = rng.normal(size=(30, 3))
        counts = drawn(rng, design @ rng.normal(size=3), [-1.0, 0.2, 1.1], 12)
        best, bounds, coefficients = statsmodels_fit(counts, design)
        found = fit_cumulative(counts, design)
        assert found.log_likelihood == pytest.approx(best, abs=1e-6)
        assert found.coefficients == pytest.approx(coefficients, abs=1e-5)
        assert found.bounds == pytest.approx(bounds, abs=1e-5)

    def test_scale_with_observers(self, rng):
        """Differences to the first stimulus and observer, without a ridge."""
        biases = np.array([-0.8, 0.0, 0.2, 0.6])
        counts = drawn(rng, np.linspace(-1, 1, 5), [-0.7, 0.6], 8, biases)
        found = ordinal_scale(counts, ridge=0.0, observer_effects=True)
        who, what = (a.ravel() for a in np.indices((4, 5)))
        dummies = np.hstack([np.eye(5)[what][:, 1:], np.eye(4)[who][:, 1:]])
        best, bounds, coefficients = statsmodels_fit(counts.reshape(20, 3), dummies)
        assert found.log_likelihood == pytest.approx(best, abs=1e-6)
        assert found.scale[0] - found.scale[1:] == pytest.approx(coefficients[:4], abs=1e-5)
        assert found.observers[1:] - found.observers[0] == pytest.approx(coefficients[4:], abs=1e-5)
        assert found.bounds + found.scale[0] - found.observers[0] == pytest.approx(bounds, abs=1e-5)


class TestDerivatives:
    @pytest.mark.parametrize("link", ["probit", "logit"])
    @pytest.mark.parametrize("spread", [0.5, 4.0])
    def test_are_what_differences_give(self, rng, link, spread):
        counts = rng.poisson(3.0, (8, 5)).astype(float)
        loss = _Loss(counts, rng.normal(size=(8, 3)), np.array([0.0, 0.1, 2.0]), link)
        x = np.concatenate([np.sort(rng.normal(size=4)), spread * rng.normal(size=3)])
        # Central differences: an error of (step)^2 third derivatives, 1e-10 x 1e3 counts, and of
        # rounding 1e-16 x 1e3 / step = 1e-8.
        step = 1e-5
        steps = step * np.eye(x.size)
        slope = [(loss.value(x + s) - loss.value(x - s)) / (2 * step) for s in steps]
        turn = [(loss.gradient(x + s) - loss.gradient(x - s)) / (2 * step) for s in steps]
        assert loss.gradient(x) == pytest.approx(slope, abs=1e-6)
        assert loss.hessian(x) == pytest.approx(np.array(turn), abs=1e-6)
        # Control: the tolerance sees an error of one count in one cell.
        counts[0, 2] += 1.0
        other = _Loss(counts, loss.design, loss.ridge, link)
        assert np.max(np.abs(other.gradient(x) - slope)) > 1e-2

    @pytest.mark.parametrize("link", ["probit", "logit"])
    def test_curve_upward_everywhere(self, rng, link):
        """Concave (Pratt 1981): the second derivatives of the loss are nowhere negative."""
        for _ in range(50):
            counts = rng.poisson(0.5, (6, 5)).astype(float)
            loss = _Loss(counts, rng.normal(size=(6, 2)), np.zeros(2), link)
            x = np.concatenate([np.cumsum(rng.exponential(1.0, 4)), 10.0 * rng.normal(size=2)])
            values = np.linalg.eigvalsh(loss.hessian(x))
            assert values[0] > -1e-9 * values[-1]

    @pytest.mark.parametrize("far", [-30.0, 30.0])
    def test_far_tails_keep_their_digits(self, far):
        """A category from 30 to 31 dispersions out: the tail at 30, but for 1e-13 of it."""
        loss = _Loss(np.array([[0.0, 1.0, 0.0]]), np.array([[1.0]]), np.zeros(1), "probit")
        x = np.array([min(far, far + np.sign(far)), max(far, far + np.sign(far)), 0.0])
        assert loss.value(x) == pytest.approx(-norm.logsf(30.0), rel=1e-12)
        assert np.all(np.isfinite(loss.gradient(x)))
        # Mills' ratio: the density over the tail is 30 + 1/30 to 1e-4.
        assert np.max(np.abs(loss.gradient(x)[:2])) == pytest.approx(30.0 + 1.0 / 30.0, abs=1e-4)
        assert norm.cdf(31.0) - norm.cdf(30.0) == 0.0  # control: what a plain difference leaves


class TestClosedForms:
    def test_one_stimulus(self):
        counts = [[3.0, 8.0, 1.0, 4.0]]
        found = ordinal_scale(counts)
        assert found.scale == pytest.approx([0.0], abs=1e-9)
        assert found.bounds == pytest.approx(ndtri([3 / 16, 11 / 16, 12 / 16]), abs=1e-6)
        shares = np.array(counts[0]) / 16.0
        assert found.log_likelihood == pytest.approx(16.0 * np.sum(shares * np.log(shares)))

    def test_two_categories_are_probit_of_shares(self):
        """As many parameters as shares: each is met exactly, without a ridge."""
        counts = np.array([[12.0, 3.0], [7.0, 7.0], [2.0, 9.0]])
        found = ordinal_scale(counts, ridge=0.0)
        deviates = ndtri(counts[:, 0] / counts.sum(axis=1))
        assert found.scale == pytest.approx(deviates - deviates.mean(), abs=1e-6)
        assert found.bounds == pytest.approx([deviates.mean()], abs=1e-6)

    def test_exact_shares_agree_with_successive_categories(self):
        scale, bounds = np.array([1.4, 0.5, -0.4, -1.5]), np.array([-1.0, 0.2, 0.9])
        upto = ndtr(bounds + scale[:, None])
        shares = np.diff(np.hstack([np.zeros((4, 1)), upto, np.ones((4, 1))]), axis=1)
        found = ordinal_scale(1000.0 * shares, ridge=0.0)
        assert found.scale == pytest.approx(scale, abs=1e-6)
        assert found.bounds == pytest.approx(bounds, abs=1e-6)
        older = successive_categories(1e5 * shares)
        assert found.scale == pytest.approx(older.scale, abs=1e-6)
        assert found.bounds == pytest.approx(older.bounds, abs=1e-6)


class TestScale:
    BOUNDS = (-1.5, -0.5, 0.5, 1.5)

    def test_covers_the_truth(self, rng):
        """42 stimuli, 15 answers: an error's sd is 1/sqrt(15 x 0.9) = 0.27 dispersions."""
        truth = np.linspace(2.0, -2.0, 42)
        found = ordinal_scale(drawn(rng, -truth, self.BOUNDS, 15))
        assert found.converged
        # A mean square of 42 is within 1 +- 3 sqrt(2/42) = 0.65 of its expectation.
        assert np.std(found.scale - truth) == pytest.approx(0.27, rel=0.35)
        assert np.mean(found.scale) == pytest.approx(0.0, abs=1e-12)
        # Control: a wrong sign errs by twice the truth.
        assert np.std(found.scale + truth) > 2.0

    def test_ridge_draws_in_by_a_percent(self):
        """As PRIOR_SD says, of expected counts; and 2.4 beyond the bound for an end category."""
        truth = np.linspace(2.0, -2.0, 42)
        upto = ndtr(np.array(self.BOUNDS) + truth[:, None])
        ends = np.zeros((42, 1))
        counts = 15.0 * np.diff(np.hstack([ends, upto, ends + 1.0]), axis=1)
        slope = np.polyfit(truth, ordinal_scale(counts).scale, 1)[0]
        assert slope == pytest.approx(0.99, abs=0.003)
        counts[0] = [15.0, 0.0, 0.0, 0.0, 0.0]
        found = ordinal_scale(counts)
        assert found.bounds[0] + found.scale[0] == pytest.approx(2.4, abs=0.1)

    def test_observer_effects_find_biases_and_likelihood(self, rng):
        biases = np.linspace(-1.2, 1.2, 10)
        truth = np.linspace(1.5, -1.5, 20)
        counts = drawn(rng, -truth, self.BOUNDS, 1, biases)
        found = ordinal_scale(counts, observer_effects=True)
        # 20 answers an observer, 10 a stimulus, of information 0.9 each: sd 0.24 and 0.33. One in
        # 200 times is the worst of ten observers 3.5 sd off; a mean square of 20 values is within
        # 1 + 3 sqrt(2/20) of its expectation.
        assert np.max(np.abs(found.observers - biases)) < 3.5 * 0.24
        assert np.std(found.scale - truth) < (1.0 + 3.0 * np.sqrt(2 / 20)) ** 0.5 * 0.33
        assert np.mean(found.observers) == pytest.approx(0.0, abs=1e-12)
        assert np.mean(found.scale) == pytest.approx(0.0, abs=1e-12)
        pooled = ordinal_scale(counts)
        assert pooled.observers is None
        same = ordinal_scale(counts.sum(axis=0))
        assert np.array_equal(pooled.scale, same.scale)
        # Nine more parameters that are truly there: far more than chi-square's 9/2 + 3 sqrt(9/2).
        assert found.log_likelihood > pooled.log_likelihood + 12.0
        # Pooling takes the observers' spread for noise, and shrinks the scale. Control.
        assert np.std(pooled.scale) < 0.9 * np.std(found.scale)

    def test_one_observer_has_no_bias(self, rng):
        counts = drawn(rng, np.linspace(-1, 1, 6), self.BOUNDS, 5)
        found = ordinal_scale(counts[None], observer_effects=True)
        alone = ordinal_scale(counts)
        assert found.observers == pytest.approx([0.0], abs=1e-9)
        assert found.scale == pytest.approx(alone.scale, abs=1e-6)
        assert found.bounds == pytest.approx(alone.bounds, abs=1e-6)


class TestHostileCounts:
    def test_separation_stays_finite(self):
        found = ordinal_scale(15.0 * np.eye(5))
        assert found.converged
        assert np.all(np.diff(found.scale) < -1.0)
        # A normal prior of 3.5 does not leave five values of it 10 standard deviations apart.
        assert np.max(np.abs(found.scale)) < 10.0
        assert np.all(np.diff(found.bounds) > 0.0)
        # Control: the likelihood itself has no end there, and says where the search stopped.
        assert np.max(np.abs(ordinal_scale(15.0 * np.eye(5), ridge=0.0).scale)) > 10.0

    def test_stimulus_without_answers_lies_at_the_middle(self, rng):
        counts = drawn(rng, np.linspace(-1, 1, 6), TestScale.BOUNDS, 9)
        without = ordinal_scale(counts)
        found = ordinal_scale(np.insert(counts, 3, 0.0, axis=0))
        assert found.scale[3] == pytest.approx(0.0, abs=1e-6)
        assert np.delete(found.scale, 3) == pytest.approx(without.scale, abs=1e-6)

    def test_unused_categories_leave_the_scale_as_if_they_were_not_there(self, rng):
        counts = rng.integers(1, 9, (6, 4)).astype(float)
        without = ordinal_scale(counts)
        wide = np.zeros((6, 8))
        wide[:, [1, 2, 5, 6]] = counts
        found = ordinal_scale(wide)
        assert found.scale == pytest.approx(without.scale, abs=1e-12)
        a, b, c = without.bounds
        expected = [np.nan, a, b, b, b, c, np.nan]
        assert found.bounds == pytest.approx(expected, abs=1e-12, nan_ok=True)

    def test_calls_that_make_no_sense(self):
        counts = np.ones((3, 2))
        with pytest.raises(ValueError, match="observers, stimuli and categories"):
            ordinal_scale(counts, observer_effects=True)
        with pytest.raises(ValueError, match="design of shape"):
            fit_cumulative(counts, np.ones((2, 1)))
        with pytest.raises(ValueError, match="not negative"):
            fit_cumulative(counts, np.ones((3, 1)), ridge=-1.0)
        with pytest.raises(ValueError, match="link"):
            fit_cumulative(counts, np.ones((3, 1)), link="cloglog")  # type: ignore[arg-type]
