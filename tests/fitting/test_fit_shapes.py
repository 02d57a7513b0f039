"""The fit's shapes against the reflection models, finite differences and an angular quadrature."""

from __future__ import annotations

import fit_cases
import numpy as np
import pytest
from scipy.special import dawsn

from relgloss_view.fitting import shapes
from relgloss_view.material import brdf

LAMP, RECEIVER = fit_cases.directions()
FACING = fit_cases.facing()
SHARP = shapes.geometry(LAMP, RECEIVER, (0.0, 0.0))


@pytest.mark.parametrize("sigma", [0.0, 0.05, 0.3, 0.7])
def test_diffuse_columns_are_oren_nayar(sigma: float) -> None:
    first, second, _, _ = shapes.diffuse_columns(SHARP, sigma**2)
    expected = brdf.oren_nayar(FACING, sigma)
    np.testing.assert_allclose(first, np.pi * expected[0], atol=1e-12)
    np.testing.assert_allclose(second, np.pi * expected[1], atol=1e-12)


@pytest.mark.parametrize("s_deg", [0.7, 6.0, 35.0])
def test_a_sharp_lobe_is_torrance_sparrow(s_deg: float) -> None:
    column, _ = shapes.lobe_columns(SHARP, np.log(np.radians(s_deg)), 1.5)
    # Everything below exp(-100) is cut off there.
    np.testing.assert_allclose(column, fit_cases.lobe(FACING, s_deg), rtol=1e-9, atol=1e-30)


def test_derivatives_are_finite_differences() -> None:
    blurred = shapes.geometry(LAMP, RECEIVER, (0.3, 0.4))
    h, t, log_s, n = 1e-5, 0.05, np.log(np.radians(2.0)), 1.5
    ahead, behind = shapes.diffuse_columns(blurred, t + h), shapes.diffuse_columns(blurred, t - h)
    _, _, first_t, second_t = shapes.diffuse_columns(blurred, t)
    np.testing.assert_allclose((ahead[0] - behind[0]) / (2 * h), first_t, atol=1e-7)
    np.testing.assert_allclose((ahead[1] - behind[1]) / (2 * h), second_t, atol=1e-7)
    lobe, slope = shapes.lobe_columns(blurred, log_s, n)
    up, down = (shapes.lobe_columns(blurred, log_s + d, n)[0] for d in (h, -h))
    np.testing.assert_allclose((up - down) / (2 * h), slope, atol=1e-5 * np.max(np.abs(slope)))
    up, down = (shapes.lobe_columns(blurred, log_s, n + d)[0] for d in (h, -h))
    expected = lobe * shapes.index_slope(blurred, n)
    np.testing.assert_allclose((up - down) / (2 * h), expected, atol=1e-5 * np.max(expected))


@pytest.mark.parametrize("s_deg", [0.05, 0.7, 6.0, 9.0])
def test_the_amplitude_and_its_slope_are_dawsons(s_deg: float) -> None:
    """A = 1 / (pi sqrt2 s F(sqrt2 s)) with Dawson's F, F'(x) = 1 - 2 x F(x); science.md section 1.

    The closed form counts facets beyond 90 degrees: at 9 degrees they are exp(-50) of the peak.
    """
    s = float(np.radians(s_deg))
    x = np.sqrt(2.0) * s
    expected = 1.0 / (np.pi * x * dawsn(x))
    slope = -1.0 - x * (1.0 - 2.0 * x * dawsn(x)) / dawsn(x)
    amplitudes, slopes = brdf.facet_amplitudes(np.array([s, 2.0 * s]))
    assert amplitudes[0] == brdf.facet_amplitude(s)
    assert amplitudes[0] == pytest.approx(expected, rel=1e-12)
    assert slopes[0] == pytest.approx(slope, rel=1e-9)
    assert abs(slopes[1] / slope - 1.0) > 1e-7  # control: another width has another slope


def test_shapes_of_several_states_are_those_of_each() -> None:
    g = shapes.geometry(LAMP, RECEIVER, (0.3, 0.4))
    t, log_s, n = np.array([0.0, 0.2]), np.array([-3.0, -1.0]), np.array([1.5, 2.5])
    for together, at in (
        (shapes.diffuse_columns(g, t), lambda k: shapes.diffuse_columns(g, t[k])),
        (shapes.lobe_columns(g, log_s, n), lambda k: shapes.lobe_columns(g, log_s[k], n[k])),
        ((shapes.index_slope(g, n),), lambda k: (shapes.index_slope(g, n[k]),)),
    ):
        for k in range(2):
            for many, one in zip(together, at(k), strict=True):
                np.testing.assert_allclose(many[k], one, rtol=1e-13)


@pytest.mark.parametrize("theta_deg", [0.0, 30.0, 60.0])
@pytest.mark.parametrize("s_deg", [0.7, 2.0])
def test_the_mirror_peak_falls_as_derived(s_deg: float, theta_deg: float) -> None:
    """science.md section 3: [(1 + (E/2s)^2)(1 + (E/(2 s cos th))^2)]^-1/2."""
    aperture = (0.3, 0.4)
    lamp = np.array([[-np.sin(np.radians(theta_deg)), 0.0, np.cos(np.radians(theta_deg))]])
    receiver = lamp * np.array([-1.0, 1.0, 1.0])
    log_s = np.log(np.radians(s_deg))
    peaks = [
        shapes.lobe_columns(shapes.geometry(lamp, receiver, a), log_s, 1.5)[0][0]
        for a in (aperture, (0.0, 0.0))
    ]
    ratio = 0.5 * np.hypot(*aperture) / s_deg
    expected = 1.0 / np.sqrt(
        (1.0 + ratio**2) * (1.0 + (ratio / np.cos(np.radians(theta_deg))) ** 2)
    )
    assert peaks[0] / peaks[1] == pytest.approx(expected, rel=1e-9)
