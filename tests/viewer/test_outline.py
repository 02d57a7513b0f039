"""The edge of a highlight: lines of one value, against circles and straight lines."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.viewer.plots.outline import MOST_SEGMENTS, highlight_edge, level_lines


def lengths(segments):
    return np.hypot(*(segments[:, 1] - segments[:, 0]).T)


@pytest.mark.parametrize("radius", [5.0, 17.3, 30.0])
def test_a_circle_has_its_circumference_and_its_radius(radius):
    y, x = np.mgrid[:81, :81].astype(float)
    segments = level_lines(50.0 - np.hypot(x - 40.0, y - 40.0), 50.0 - radius)
    assert lengths(segments).sum() == pytest.approx(2.0 * np.pi * radius, rel=0.01)
    np.testing.assert_allclose(np.hypot(*(segments - 40.0).reshape(-1, 2).T), radius, atol=0.05)
    # Negative control: another level is another circle, and beyond all values is none.
    other = level_lines(50.0 - np.hypot(x - 40.0, y - 40.0), 52.0 - radius)
    assert abs(lengths(other).sum() - 2.0 * np.pi * radius) > 10.0
    assert len(level_lines(50.0 - np.hypot(x - 40.0, y - 40.0), 51.0)) == 0


def test_a_saddle_has_two_lines():
    segments = level_lines(np.array([[1.0, -1.0], [-1.0, 1.0]]), 0.0)
    assert sorted(np.round(segments.reshape(-1, 2), 6).tolist()) == [
        [0.0, 0.5], [0.5, 0.0], [0.5, 1.0], [1.0, 0.5],
    ]  # fmt: skip


def test_the_edge_is_where_half_of_the_highlight_is_left():
    body = np.full((60, 90), 0.2)
    x = np.arange(90.0)
    stripe = np.broadcast_to(np.where(np.abs(x - 44.5) < 10.0, 0.1, 0.0), (60, 90))
    edge = highlight_edge(body, stripe, 1.0, grainy=False)
    np.testing.assert_allclose(np.unique(np.round(90.0 * edge[..., 0], 6)), [35.0, 55.0])
    assert highlight_edge(body, 0.0 * stripe, 1.0, grainy=False).shape == (0, 2, 2)


def test_grain_is_averaged_and_noise_alone_has_no_edge():
    body, x = np.full((200, 150), 0.2), np.arange(150.0)
    mean = np.where(np.abs(x - 74.5) < 20.0, 0.1, 0.0)
    grainy = mean * 2.0 * np.random.default_rng(1).random((200, 150))
    edge = highlight_edge(body, grainy, 1.0, grainy=True)
    assert 300 < len(edge) <= MOST_SEGMENTS
    left = edge[edge[..., 0].mean(axis=1) < 0.5]
    assert 150.0 * np.median(left[..., 0]) == pytest.approx(55.0, abs=1.5)
    noise = np.random.default_rng(1).random((400, 400))
    assert highlight_edge(np.full((400, 400), 0.2), noise, 1.0, grainy=True).shape == (0, 2, 2)
