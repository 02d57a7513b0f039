"""PBR Neutral against its published specification and what it promises."""

from __future__ import annotations

import numpy as np
import pytest
from lights import EQUAL_ENERGY, gray

from relgloss_view.operators.neutral import Neutral, pbr_neutral


def specification(rgb, k_s=0.8 - 0.04, k_d=0.15, f_90=0.04):
    """One colour by the equations of KhronosGroup/ToneMapping, PBR_Neutral/README.md."""
    x = min(rgb)
    f = x - x * x / (4 * f_90) if x <= 2 * f_90 else f_90
    p = max(c - f for c in rgb)
    if p <= k_s:
        return [c - f for c in rgb]
    p_n = 1 - (1 - k_s) ** 2 / (p + 1 - 2 * k_s)
    g = 1 / (k_d * (p - p_n) + 1)
    return [(c - f) * p_n / p * g + p_n * (1 - g) for c in rgb]


def colours():
    rng = np.random.default_rng(5)
    return np.concatenate([rng.uniform(0, 1, (500, 3)), 10 ** rng.uniform(-6, 6, (1500, 3))])


def test_published_equations():
    for parameters in ({}, {"start_compression": 0.4, "desaturation": 0.6}):
        names = dict(zip(("k_s", "k_d"), parameters.values(), strict=False))
        expected = [specification(c, **names) for c in colours().tolist()]
        np.testing.assert_allclose(
            pbr_neutral(colours(), **parameters), expected, rtol=1e-9, atol=1e-12
        )


def test_an_older_listing_is_another_mapping():
    # Negative control: the repository's first GLSL mixed with 1, the specification mixes with the
    # compressed peak.
    rgb = np.array([2.0, 0.5, 0.3])
    mixed_with_peak = pbr_neutral(rgb)
    p, p_n = 1.96, 1 - 0.24**2 / (1.96 + 0.24 - 0.76)
    g = 1 - 1 / (0.15 * (p - p_n) + 1)
    mixed_with_one = (rgb - 0.04) * (p_n / p) * (1 - g) + g
    assert np.max(np.abs(mixed_with_peak - mixed_with_one)) > 0.004


class TestPromises:
    def test_base_colours_are_exact(self):
        # Their note: out = in - 0.04 where 0.08 <= R, G, B <= 0.8.
        rgb = np.random.default_rng(6).uniform(0.08, 0.8, (1000, 3))
        np.testing.assert_allclose(pbr_neutral(rgb), rgb - 0.04, atol=1e-15)

    def test_it_stays_below_white_and_keeps_hue(self):
        shown = pbr_neutral(colours())
        assert np.all((shown >= 0) & (shown <= 1))
        # No hue shift: out lies in the plane of in and the white axis.
        white = np.ones(3) / np.sqrt(3.0)
        volume = np.cross(colours(), shown) @ white
        size = np.linalg.norm(colours(), axis=1) * np.linalg.norm(shown, axis=1)
        assert np.max(np.abs(volume) / np.maximum(size, 1e-30)) < 1e-9

    def test_value_and_slope_are_continuous(self):
        for corner in (0.08, 0.8):
            gray_ = corner + np.linspace(-1e-4, 1e-4, 201)
            steps = np.diff(pbr_neutral(np.repeat(gray_[:, None], 3, axis=1))[:, 0])
            assert np.all(steps >= 0)
            # Curvature 2/0.24 above the corner at 0.8 and 12.5 below that at 0.08, over 2e-4.
            assert np.ptp(steps) / np.max(steps) < 5e-3


def test_the_perfect_diffuser_is_one():
    light = gray(np.full((3, 3), 55.0), display=EQUAL_ENERGY)  # half of Y_n
    np.testing.assert_allclose(Neutral().apply(light).light, 0.5 - 0.04, atol=1e-9)
    twice = Neutral(exposure=1.2).apply(light)
    np.testing.assert_allclose(twice.light, 0.6 - 0.04, atol=1e-9)


@pytest.mark.parametrize("level", [1e3, 1e5])
def test_highlights_tend_to_white_and_are_not_clipped(level):
    picture = Neutral().apply(gray(np.full((2, 2), level), display=EQUAL_ENERGY))
    assert picture.clip_count == 0
    assert np.all(picture.light > 0.98)
