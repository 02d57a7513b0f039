"""Where searches of the ordinal model begin, how far a step may go, and what they refuse."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm

from relgloss_view.experiment.scaling import ordinal, ordinal_draws
from relgloss_view.experiment.scaling.ordinal import OrdinalScale, fit_cumulative

COUNTS = np.array(
    [[[8.0, 3.0, 2.0, 1.0], [2.0, 5.0, 4.0, 3.0]], [[6.0, 4.0, 3.0, 1.0], [1.0, 2.0, 6.0, 5.0]]]
)  # (O, J, K)
ALL = np.ones(3, dtype=bool)


def start_of(bounds, observers=None):
    return OrdinalScale(
        scale=np.array([0.7, -0.7]),
        bounds=np.asarray(bounds, dtype=np.float64),
        log_likelihood=0.0,
        observers=observers,
        converged=True,
    )


def first(bounds, observers=None):
    losses = ordinal_draws._Losses(
        np.stack([COUNTS, COUNTS[::-1, ::-1]]), located=observers is not None
    )
    return ordinal_draws._first(losses, ALL, start_of(bounds, observers))


def test_draws_begin_at_the_fit_that_is_resampled():
    """Distances are minus the scale: what is closer is scaled higher."""
    np.testing.assert_array_equal(first([-1.0, 0.2, 1.5]), [[-1.0, 0.2, 1.5, -0.7, 0.7]] * 2)
    located = first([-1.0, 0.2, 1.5], np.array([0.3, -0.3]))
    np.testing.assert_array_equal(located, [[-1.0, 0.2, 1.5, 0.3, -0.3, -0.7, 0.7]] * 2)


@pytest.mark.parametrize(
    "bounds", [[-1.0, np.nan, 1.5], [-1.0, 0.2, 0.2], [0.2, 0.2, 1.5], [np.nan, 0.2, 1.5]]
)
def test_bounds_that_the_fit_lacks_come_from_the_pooled_counts(bounds):
    share = np.cumsum(COUNTS.sum(axis=(0, 1))) / COUNTS.sum()
    expected = norm.ppf(share[:-1])
    np.testing.assert_allclose(first(bounds)[:, :3], [expected, expected], rtol=1e-12)


@pytest.mark.parametrize("link", ["probit", "logit"])
def test_a_fit_begins_at_the_pooled_counts(link):
    table = COUNTS.sum(axis=0)
    loss = ordinal._Loss(table, np.eye(2), np.zeros(2), link)
    share = (np.cumsum(table.sum(axis=0)) / table.sum())[:-1]
    law = norm.ppf(share) if link == "probit" else np.log(share) - np.log1p(-share)
    np.testing.assert_allclose(ordinal._first(loss), [*law, 0.0, 0.0], rtol=1e-12)


def test_a_step_leaves_a_tenth_of_what_is_above_the_least_gap():
    least = ordinal_draws.LEAST_GAP
    limits = np.array([[0.0, 3.0 * least], [0.0, 1.0]])
    share = ordinal_draws._share_in_order(limits, np.array([[1.0, 0.0], [0.5, 0.0]]))
    np.testing.assert_allclose(share, [0.9 * 2.0 * least, 1.0], rtol=1e-6)


def test_one_value_that_is_no_number_is_refused():
    table = COUNTS.sum(axis=0)
    design = np.eye(2)
    with pytest.raises(ValueError, match="finite"):
        fit_cumulative(table, np.array([[1.0, np.nan], [0.0, 1.0]]))
    for ridge in ([0.0, -1.0], [np.inf, 0.0], [0.1, np.nan]):
        with pytest.raises(ValueError, match="finite"):
            fit_cumulative(table, design, ridge=ridge)
    assert fit_cumulative(table, design, ridge=[0.1, 0.2]).converged


def test_a_search_that_is_cut_short_has_not_converged(monkeypatch):
    table = COUNTS.sum(axis=0) * [[1.0, 1.0, 40.0, 1.0], [60.0, 1.0, 1.0, 1.0]]
    assert fit_cumulative(table, np.eye(2), ridge=0.1).converged
    monkeypatch.setattr(ordinal, "MOST_STEPS", 1)
    assert not fit_cumulative(table, np.eye(2), ridge=0.1).converged
