"""The unfolding's loss against scipy.stats, and where its fits may end."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from relgloss_view.experiment.design.coordinates import coordinates
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.scaling.fine_grid import FineGrid
from relgloss_view.experiment.scaling.unfolding import ROUND, UnfoldingLoss, fit_unfolding
from relgloss_view.experiment.session.posterior import LAPSE

GRID = Grid()
PLACES = coordinates(GRID)
ENDS = PLACES[-1]


def distances(p):
    """(settings,) the distances of the model, written out."""
    ideal, slopes, shear, bends = p[:2], np.exp(p[2:4]), p[4], p[-6:-4]
    skews, power, exponent = p[-4:-2], np.exp(p[-2]), 2.0 * np.exp(p[-1])

    def bent(point):
        return ENDS * np.exp(bends * (point / ENDS - 0.5)) / bends

    dx, dy = (bent(PLACES) - bent(ideal)).T
    parts = []
    for side, skew in zip((slopes[0] * dx, slopes[1] * dy + shear * dx), skews, strict=True):
        side = side * np.exp(np.where(side > 0.0, skew, -skew))
        parts.append((ROUND / 2.0 + side**2) ** (exponent / 2.0))
    return sum(parts) ** (power / exponent)


def probabilities(p):
    """(settings, categories) of the model of docs/experiment.md, written out."""
    distance = distances(p)
    bounds = p[5] + np.concatenate([[0.0], np.cumsum(np.exp(p[6:-6]))])
    below = stats.norm.cdf(bounds[None, :], loc=distance[:, None])
    share = np.diff(np.pad(below, ((0, 0), (1, 1)), constant_values=(0, 1)), axis=1)
    return (1.0 - LAPSE) * share + LAPSE / share.shape[1]


def some_parameters(count, seed=1):
    random = np.random.default_rng(seed)
    return [
        np.array([2.2, 3.1, *random.normal(0, 0.4, 3), 0.9, *random.normal(0, 0.3, 9)])
        for _ in range(count)
    ]


def test_loss_is_the_posterior_s():
    counts = np.random.default_rng(0).integers(0, 5, (42, 5)).astype(float)
    loss = UnfoldingLoss(GRID, counts)

    def expected(p):
        prior = stats.norm.logpdf(
            p[2:], [-0.3, 0.0, 0.0, 1.0, *[0.0] * 9],
            [1.5, 1.5, 1.5, 3.0, 1.5, 1.5, 1.5, 1.0, 1.0, 0.5, 0.5, 0.3, 0.4],
        )  # fmt: skip
        return -np.sum(counts * np.log(probabilities(p))) - np.sum(prior)

    # The loss leaves out what does not depend on the parameters.
    off = [float(loss(p)[0]) - expected(p) for p in some_parameters(6)]
    np.testing.assert_allclose(off, off[0], rtol=1e-9)


def test_information_is_that_of_multinomial_answers():
    """Fisher 1925: sum over settings of N J' diag(1/p) J, by a numerical Jacobian of p."""
    counts = np.random.default_rng(0).integers(1, 5, (42, 5)).astype(float)
    p = some_parameters(1)[0]
    step = 1e-6
    jacobian = np.array(
        [
            (probabilities(p + d) - probabilities(p - d)) / (2.0 * step)
            for d in step * np.eye(len(p))
        ]
    )
    weight = counts.sum(axis=1, keepdims=True) / probabilities(p)
    expected = np.einsum("ask,sk,bsk->ab", jacobian, weight, jacobian)
    sd = np.array([np.inf, np.inf, 1.5, 1.5, 1.5, 3.0, 1.5, 1.5, 1.5, 1.0, 1.0, 0.5, 0.5, 0.3, 0.4])
    expected += np.diag(sd**-2.0)
    information = UnfoldingLoss(GRID, counts).scoring(p)[2]
    size = np.sqrt(np.diag(expected))
    np.testing.assert_allclose(
        information / np.outer(size, size), expected / np.outer(size, size), atol=1e-6
    )


@pytest.mark.parametrize("ideal", [(9.0, 3.0), (2.0, 8.0), (-3.0, 3.0), (2.0, -1.5)])
def test_an_ideal_beyond_the_grid_is_on_its_edge(ideal):
    """The loss that a fit reports is that of its own parameters, which lie within limits."""
    apart = PLACES - ideal
    distance = np.sqrt(ROUND + (0.8 * apart[:, 0]) ** 2 + apart[:, 1] ** 2)
    below = stats.norm.cdf([0.9, 1.8, 2.8, 3.9] - distance[:, None])
    counts = 30.0 * np.diff(np.pad(below, ((0, 0), (1, 1)), constant_values=(0, 1)), axis=1)
    fit, loss = fit_unfolding(GRID, counts), UnfoldingLoss(GRID, counts)
    low, high = np.array(loss.limits).T
    assert np.all((fit.parameters >= low) & (fit.parameters <= high))
    assert fit.loss == pytest.approx(float(loss(fit.parameters)[0]), abs=1e-6)
    beyond = int(np.argmax(np.abs(np.array(ideal) - ENDS / 2)))
    edge = ENDS[beyond] if ideal[beyond] > 0.0 else 0.0
    points = FineGrid(GRID).points
    best = points[np.argmax(fit.closeness(points))]
    assert best[beyond] == pytest.approx(edge, abs=1e-6)


def test_closeness_is_minus_the_distance():
    counts = np.random.default_rng(0).integers(0, 5, (42, 5)).astype(float)
    fit = fit_unfolding(GRID, counts)
    np.testing.assert_allclose(fit.closeness(PLACES), -distances(fit.parameters), rtol=1e-9)
