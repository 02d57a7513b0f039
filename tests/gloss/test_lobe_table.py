"""The table of lobes against the integrals that it stands for, and closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.gloss.meter.lobe_table import (
    ALBEDO,
    ANGLES_DEG,
    FINE,
    INDICES,
    TRAPPED,
    WIDTHS_DEG,
    exact_share,
    lobe_table,
)
from relgloss_view.material import brdf

COLUMNS = list(ANGLES_DEG)


def share(column, s_deg, index):
    log_s = np.log(np.atleast_1d(s_deg))
    return lobe_table().shares([column], log_s, np.full(log_s.shape, index))[:, 0]


def fresnel(column, index):
    cos = np.cos(np.radians(ANGLES_DEG[column]))
    return float(brdf.fresnel_dielectric(cos, index))


def tolerance(column, index):
    """Of a share over Fresnel's: 3/128 of the fourth difference, and 1/8 of the fine second one.

    The remainder of a cubic through four even places, in its middle interval, and that of a line;
    and 2e-5 for the polynomial in the index, the next term of which the four lower ones bound.
    """
    values = share(column, WIDTHS_DEG, index) / fresnel(column, index)
    steps = np.geomspace(WIDTHS_DEG[0], WIDTHS_DEG[-1], FINE)
    fine = share(column, steps, index) / fresnel(column, index)
    cubic = 3.0 / 128.0 * np.max(np.abs(np.diff(values, 4)))
    return cubic + np.max(np.abs(np.diff(fine, 2))) / 8.0 + 2e-5


@pytest.mark.parametrize("column", COLUMNS)
def test_it_is_the_integral_between_its_places(column):
    # The middle of an interval, where a cubic is off most, and an index between two.
    for k, index in ((12, 1.45), (45, 1.55), (64, 1.35)):
        s_deg = float(np.sqrt(WIDTHS_DEG[k] * WIDTHS_DEG[k + 1]))
        exact, found = exact_share(column, s_deg, index), float(share(column, s_deg, index)[0])
        allowed = tolerance(column, index) * fresnel(column, index)
        # The directional albedo's own quadrature is off by up to 1e-3.
        assert found == pytest.approx(exact, abs=allowed, rel=1e-4 if column == ALBEDO else 0.0)
    # Control: the place beside is another lobe.
    beside = float(share(column, WIDTHS_DEG[65], 1.35)[0])
    if column != ALBEDO:
        assert abs(beside - exact) > 3.0 * allowed


@pytest.mark.parametrize("index", [1.35, 1.5, 1.7])
def test_a_narrow_lobe_is_a_mirror(index):
    for column in COLUMNS:
        # Fresnel at the nominal angle; over the source image of 0.75 deg it is a little more at 85.
        mirror = fresnel(column, index)
        assert float(share(column, 0.05, index)[0]) == pytest.approx(mirror, rel=2e-3)


def test_shares_fall_with_the_width_and_the_trap_takes_less_than_all():
    widths = np.asarray(WIDTHS_DEG)
    for column in COLUMNS[:4]:
        assert np.all(np.diff(share(column, widths, 1.5)) <= 1e-6)
    albedo, trapped = share(ALBEDO, widths, 1.5), share(TRAPPED, widths, 1.5)
    assert np.all(trapped <= albedo + 1e-6)
    assert trapped[-1] < 0.02 * albedo[-1]


def test_the_table_has_the_shape_that_its_reader_expects():
    assert lobe_table().polynomials.shape == (FINE, len(ANGLES_DEG), len(INDICES))
