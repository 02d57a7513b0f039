from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from relgloss_view.measure import gonio


def test_the_papers_grid_has_997_geometries():
    grid = gonio.gcms4_grid()
    assert grid.shape == (997, 3)
    assert len(np.unique(grid, axis=0)) == 997


def test_910_remain_where_the_receiver_stays_between_0_and_70():
    # science.md section 3: 840 regular ones and 78 of the scan, 8 of them shared.
    beta = gonio.gcms4_grid()[:, 1]
    assert np.sum((beta >= 0) & (beta <= 70)) == 910


@pytest.mark.parametrize("gamma_s", [0.0, 15.0, -20.0])
def test_at_the_mirror_the_half_vector_stands_at_the_tilt(gamma_s):
    alpha = np.arange(-70, 71, 5.0)
    for gamma in (0.0, 5.0, 15.0, 60.0):
        i, o = gonio.gcms_directions(alpha, -alpha, gamma, gamma_s)
        half = i + o
        theta = np.degrees(np.arctan2(np.hypot(half[:, 0], half[:, 1]), half[:, 2]))
        # Rounding of unit vectors, over |i + o| >= 2 cos 70: some 1e-15 rad.
        np.testing.assert_allclose(theta, abs(gamma - gamma_s), atol=1e-12)


def test_directions_are_rotations_of_the_arms():
    rng = np.random.default_rng(1)
    alpha, beta, gamma = rng.uniform(-70, 70, (3, 50))
    i, o = gonio.gcms_directions(alpha, beta, gamma, 15.0)
    turn = Rotation.from_euler("x", (gamma - 15.0)[:, None], degrees=True)
    for angle, found in ((alpha, i), (beta, o)):
        # A rotation about y by the polar angle takes z to (sin, 0, cos).
        arm = Rotation.from_euler("y", angle[:, None], degrees=True).apply([0.0, 0.0, 1.0])
        np.testing.assert_allclose(found, turn.apply(arm), atol=1e-14)


def test_tabulated_grid_holds_the_mirror_scan_and_no_repeats():
    grid = gonio.tabulated_grid()
    assert len(np.unique(grid, axis=0)) == len(grid)
    for theta in range(5, 71, 10):
        row = [theta // 10 * 10, theta // 10 * 10 + 1, 180]
        assert (grid == row).all(axis=1).any()
