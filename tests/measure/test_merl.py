"""MERL files, made here from known functions."""

from __future__ import annotations

import numpy as np
import pytest
from files import merl_file
from rgl_data import rgl_file
from scipy.spatial.transform import Rotation

from relgloss_view.exchange.merl import directions as of_half_and_difference
from relgloss_view.measure import table
from relgloss_view.measure.bands import RGB
from relgloss_view.measure.readers import merl, read_measurement, rgl

SCALE = np.array([1 / 1500, 1.15 / 1500, 1.66 / 1500])


def bin_centres():
    """theta_h, theta_d, phi_d bin coordinates of the centres, broadcastable to (90, 90, 180)."""
    return np.ogrid[0.5:90, 0.5:90, 0.5:180]


def gaussian(h):
    """Of theta_h = 90 (h / 90)^2 degrees, a standard deviation of 6 degrees."""
    return 1000.0 * np.exp(-0.5 * (90.0 * (h / 90.0) ** 2 / 6.0) ** 2)


def rusinkiewicz(i, o):
    """Angles theta_h, theta_d, phi_d by rotations."""
    h = (i + o) / np.linalg.norm(i + o, axis=1)[:, None]
    theta, phi = np.arccos(np.clip(h[:, 2], -1, 1)), np.arctan2(h[:, 1], h[:, 0])
    d = Rotation.from_euler("zy", np.stack([-phi, -theta], axis=1)).apply(i)
    return theta, np.arccos(np.clip(d[:, 2], -1, 1)), np.arctan2(d[:, 1], d[:, 0]) % np.pi


@pytest.fixture(scope="module")
def directions():
    rng = np.random.default_rng(5)
    v = rng.normal(size=(2, 4000, 3))
    v /= np.linalg.norm(v, axis=2)[..., None]
    v[..., 2] = np.abs(v[..., 2])
    return v


@pytest.fixture(scope="module")
def linear(tmp_path_factory):
    """A Gaussian in theta_h, and channels that are linear in the other bin coordinates."""
    h, d, p = bin_centres()
    bins = np.stack([gaussian(h) + 0 * d + 0 * p, 2.0 + d + 0 * h + 0 * p, 3.0 + p + 0 * h + 0 * d])
    return merl_file(tmp_path_factory.mktemp("merl") / "linear.binary", bins)


def test_indexing_and_scale(linear, directions):
    i, o = directions
    theta_h, theta_d, phi_d = rusinkiewicz(i, o)
    right = np.pi / 2
    h, d, p = 90 * np.sqrt(theta_h / right), 90 * theta_d / right, 180 * phi_d / np.pi
    expected = np.stack([gaussian(h), 2 + d, 3 + p], axis=1) * SCALE
    # A Gaussian and linear functions are reproduced between centres; outside the first and last
    # centre they are held, and phi_d wraps.
    middle = (h > 0.5) & (h < 89.5) & (d > 0.5) & (d < 89.5) & (p > 0.5) & (p < 179.5)
    assert middle.sum() > 3500
    found = merl.load(linear).evaluate(i, o)
    # arccos in the reference loses half the digits near the pole.
    np.testing.assert_allclose(found[middle], expected[middle], rtol=1e-6)


def test_difference_azimuth_has_the_period_pi(tmp_path, directions):
    i, o = directions
    p = bin_centres()[2] * np.pi / 180
    bins = np.broadcast_to(2 + np.sin(2 * p), (3, 90, 90, 180))
    found = merl.load(merl_file(tmp_path / "t", bins)).evaluate(i, o)
    expected = 2 + np.sin(2 * rusinkiewicz(i, o)[2])
    assert np.sum(np.abs(np.sin(rusinkiewicz(i, o)[2])) < np.pi / 360) > 10  # across the wrap
    # Linear interpolation: step^2 / 8 times the second derivative 4, over values of at least 1.
    np.testing.assert_allclose(found[:, 0] / SCALE[0], expected, rtol=(np.pi / 180) ** 2 / 2)
    swapped = merl.load(tmp_path / "t").evaluate(o, i)
    np.testing.assert_allclose(swapped, found, rtol=1e-9)


def test_measurement_on_the_grid(linear):
    m = read_measurement(linear)
    assert m.name == "linear"
    assert m.bands == RGB
    assert m.kept.all()
    # In the mirror plane at 40 degrees, theta_h = 0 and theta_d = 40: held at the first centre of
    # theta_h, between the centres 39.5 and 40.5 of theta_d.
    h = m.to_lamp + m.to_receiver
    mirror = np.hypot(h[:, 0], h[:, 1]) < 1e-12
    at_40 = mirror & (np.abs(m.to_lamp[:, 2] - np.cos(np.radians(40))) < 1e-12)
    assert at_40.sum() == 1
    expected = np.pi * np.array([gaussian(0.5), 42.0]) * SCALE[:2]
    np.testing.assert_allclose(m.radiance_factor[at_40][0, :2], expected, rtol=1e-9)


def test_unmeasured_bins_are_masked(tmp_path):
    bins = np.ones((3, 90, 90, 180))
    bins[:, :, 60:] = -1.0  # beyond theta_d = 60
    m = read_measurement(merl_file(tmp_path / "t", bins))
    cos_d = np.linalg.norm(m.to_lamp + m.to_receiver, axis=1) / 2
    theta_d = np.degrees(np.arccos(cos_d))
    missing = m.reasons == table.MISSING
    clear = np.abs(theta_d - 60) > 1e-6  # at the edge of the bin rounding decides
    np.testing.assert_array_equal(missing[clear], theta_d[clear] > 60)
    assert 0 < missing.sum() < len(missing)
    # Unmeasured neighbours do not darken measured ones.
    kept = m.radiance_factor[m.kept]
    np.testing.assert_allclose(kept, np.tile(np.pi * SCALE, (len(kept), 1)), rtol=1e-12)


def test_below_the_horizon_is_dark(linear):
    brdf = merl.load(linear)
    np.testing.assert_array_equal(brdf.evaluate([0, 0, 1.0], [0, 0.6, -0.8]), 0.0)
    np.testing.assert_array_equal(brdf.evaluate([0, 0.6, -0.8], [0, 0, 1.0]), 0.0)


def beside_the_mirror(brdf, h, d, p):
    """A BRDF (M, 3) at bin coordinates: theta_h a number, theta_d and phi_d arrays."""
    theta_h = np.radians(h**2 / 90)
    return brdf.evaluate(*of_half_and_difference(theta_h, np.radians(d)[:, None], np.radians(p)))


def error_between_bins(name):
    """Median error, half-way between centres of theta_h within 1 degree of the mirror direction.

    As a share of the measurement itself: of bins of it, and of a straight line between the bins.
    """
    brdf = rgl.load(rgl_file(name))
    d, p = np.arange(10.5, 60.0, 10.0), np.arange(0.5, 180.0, 30.0)
    at_centres = np.stack([beside_the_mirror(brdf, k + 0.5, d, p) for k in range(11)])
    bins = np.ones((3, 90, 90, 180))
    place = np.ix_(range(3), range(11), d.astype(int), p.astype(int))
    bins[place] = (at_centres / SCALE).reshape(11, len(d), len(p), 3).transpose(3, 0, 1, 2)
    truth = np.stack([beside_the_mirror(brdf, k, d, p) for k in range(1, 10)])
    found = np.stack([beside_the_mirror(merl.MerlBrdf(bins), k, d, p) for k in range(1, 10)])
    straight = 0.5 * (at_centres[:-2] + at_centres[1:-1])
    return [np.median(np.abs(between / truth - 1.0)) for between in (found, straight)]


def test_between_the_bins_of_a_measured_film():
    """Its highlight of 0.2 degrees falls by half from bin to bin, where a straight line is off."""
    error, straight = error_between_bins("cg_sunflower")
    assert error < 0.75 * straight  # 0.66; the foot of the highlight is no Gaussian
    assert straight > 0.03  # control: there is something to follow


def test_between_the_bins_of_a_measured_paper():
    """Nothing to follow: the logarithm of values that differ by a percent is a straight line."""
    error, straight = error_between_bins("paper_white")
    assert max(error, straight) < 0.001
