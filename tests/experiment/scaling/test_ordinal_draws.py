"""Scales of many resamplings at once, held against those of one after another."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ndtr

from relgloss_view.base.errors import InputError
from relgloss_view.experiment.scaling import ordinal_draws as module
from relgloss_view.experiment.scaling.ordinal import RIDGE, _Loss, ordinal_scale
from relgloss_view.experiment.scaling.ordinal_draws import ordinal_draws

OBSERVERS, STIMULI = 6, 9


def study(rng, answers=2):
    """Counts (O, J, K) by observers with locations of their own, and resamplings of them."""
    where = np.linspace(-2.0, 2.0, STIMULI) + 0.4 * rng.standard_normal((OBSERVERS, 1))
    upto = ndtr(np.array([-1.5, -0.4, 0.5, 1.4]) - where[..., None])
    ends = np.zeros((*where.shape, 1))
    shares = np.diff(np.concatenate([ends, upto, ends + 1.0], axis=-1), axis=-1)
    counts = rng.multinomial(answers, shares).astype(float)
    weights = rng.multinomial(OBSERVERS, np.full(OBSERVERS, 1.0 / OBSERVERS), size=40)
    return counts, weights[:, :, None, None] * counts


def one_by_one(drawn, observer_effects):
    for counts in drawn:
        table = counts if observer_effects else counts.sum(axis=0)
        yield ordinal_scale(table, observer_effects=observer_effects)


def slope_at(counts, scale, bounds):
    """The largest slope of the loss of pooled counts that use every category."""
    loss = _Loss(counts, np.eye(len(counts)), np.full(len(counts), RIDGE), "probit")
    return np.max(np.abs(loss.gradient(np.concatenate([bounds, -scale]))))


@pytest.fixture
def rng():
    return np.random.default_rng(8)


@pytest.mark.parametrize("observer_effects", [False, True])
def test_are_those_of_one_after_another(rng, observer_effects):
    """A search alone ends at slopes of 1e-5; a value that only the prior holds follows by 1e-4."""
    counts, drawn = study(rng)
    table = counts if observer_effects else counts.sum(axis=0)
    start = ordinal_scale(table, observer_effects=observer_effects)
    draws = ordinal_draws(drawn, start, observer_effects=observer_effects)
    for k, fit in enumerate(one_by_one(drawn, observer_effects)):
        assert draws.scale[k] == pytest.approx(fit.scale, abs=2e-4)
        assert draws.bounds[k] == pytest.approx(fit.bounds, abs=2e-4, nan_ok=True)
    # Control: the resamplings differ by far more than that.
    assert np.min(np.ptp(draws.scale, axis=0)) > 0.1


def test_observer_effects_matter(rng):
    counts, drawn = study(rng)
    pooled = ordinal_draws(drawn, ordinal_scale(counts.sum(axis=0)), observer_effects=False)
    start = ordinal_scale(counts, observer_effects=True)
    located = ordinal_draws(drawn, start, observer_effects=True)
    assert np.max(np.abs(pooled.scale - located.scale)) > 0.05


def test_are_minima(rng):
    counts, drawn = study(rng, answers=5)
    draws = ordinal_draws(drawn, ordinal_scale(counts.sum(axis=0)), observer_effects=False)
    full = [k for k in range(40) if np.all(drawn[k].sum(axis=(0, 1)) > 0.0)]
    assert len(full) > 20
    for k in full:
        # Sums of 270 counts round to 1e-13; what a last step of 1e-6 leaves is its square.
        assert slope_at(drawn[k].sum(axis=0), draws.scale[k], draws.bounds[k]) < 1e-9
        assert slope_at(drawn[k].sum(axis=0), draws.scale[k] + 0.01, draws.bounds[k]) > 1e-3


def test_equal_answers_get_equal_values(rng):
    """Settings that a resampling can't tell apart lead together in it, wherever they started."""
    counts, _ = study(rng)
    drawn = np.repeat(counts[None], 3, axis=0)
    drawn[:, :, 4] = drawn[:, :, 1]
    start = ordinal_scale(counts.sum(axis=0))
    assert abs(start.scale[4] - start.scale[1]) > 0.5
    draws = ordinal_draws(drawn, start, observer_effects=False)
    assert draws.scale[:, 4] == pytest.approx(draws.scale[:, 1], abs=1e-10)


def test_a_far_start_ends_at_the_same_place(rng):
    """The loss has one minimum: a start that every answer contradicts finds it too."""
    counts, drawn = study(rng)
    near = ordinal_scale(counts.sum(axis=0))
    far = ordinal_scale(counts.sum(axis=0)[::-1, ::-1] * 50.0)
    ours, theirs = (ordinal_draws(drawn, s, observer_effects=False) for s in (near, far))
    np.testing.assert_allclose(ours.scale, theirs.scale, atol=1e-9)
    np.testing.assert_allclose(ours.bounds, theirs.bounds, atol=1e-9)


def test_unused_categories_and_settings_without_answers(rng):
    counts, drawn = study(rng)
    drawn[0, :, :, 0] = 0.0  # the end category has no bound
    drawn[1, :, :, 2] = 0.0  # an inner one is merged
    drawn[2, :, 3] = 0.0
    drawn[3] = 0.0
    drawn[4, :, :, 1:] = 0.0  # one category: nothing is scaled
    start = ordinal_scale(counts.sum(axis=0))
    draws = ordinal_draws(drawn[:5], start, observer_effects=False)
    for k, fit in enumerate(one_by_one(drawn[:3], False)):
        assert draws.scale[k] == pytest.approx(fit.scale, abs=2e-4)
        assert draws.bounds[k] == pytest.approx(fit.bounds, abs=2e-4, nan_ok=True)
    assert np.isnan(draws.bounds[0, 0])
    assert draws.bounds[1, 1] == draws.bounds[1, 2]
    assert np.all(np.isnan(draws.scale[3:]))
    assert np.all(np.isnan(draws.bounds[3:]))
    with pytest.raises(InputError):
        ordinal_scale(drawn[4].sum(axis=0))


def test_steps_keep_bounds_in_order():
    limits = np.array([[0.0, 1.0], [0.0, 1.0]])
    share = module._share_in_order(limits, np.array([[2.0, -2.0], [0.0, 0.1]]))
    assert share == pytest.approx([0.9 * 0.25, 1.0])
