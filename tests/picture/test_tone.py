"""The CIELAB split, scaling and gamut mapping against colour-science and the paper's equations."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.picture.frame import Extremes, Scaling
from relgloss_view.picture.model import tone
from relgloss_view.picture.scene.look import Look

colour = pytest.importorskip("colour")

SRGB = DisplayModel.of(Display())
WHITE = np.array([1.0168, 1.0, 0.6761])


def random_xyz(count=5000, seed=3):
    rng = np.random.default_rng(seed)
    return WHITE * 10 ** rng.uniform(-5, 3, (count, 3))  # t from 1e-5 to 1000


def test_lab_is_cie_15():
    xyz = random_xyz()
    expected = colour.XYZ_to_Lab(xyz, colour.XYZ_to_xy(WHITE))
    np.testing.assert_allclose(tone.lab_from_xyz(xyz, WHITE), expected, rtol=1e-9, atol=1e-9)


def test_round_trip_with_negative_and_huge_values():
    xyz = np.concatenate([random_xyz(), -0.05 * random_xyz(100), 1000 * np.ones((1, 3))])
    back = tone.xyz_from_lab(tone.lab_from_xyz(xyz, WHITE), WHITE)
    np.testing.assert_allclose(back, xyz, rtol=1e-5, atol=1e-12)


def test_lightness_has_no_step_where_its_branches_meet():
    y = tone.LAB_EPSILON * np.linspace(0.999, 1.001, 4001)
    steps = np.diff(tone.lightness(y))
    assert np.all(steps > 0)
    # Value and slope are continuous; the curvature of the cube root changes the slope by 0.13 %.
    assert np.ptp(steps) / np.mean(steps) < 2e-3


def test_literal_equation_1_is_not_used():
    # The cube root law at all Y would give L* = -16 for black, and negative light from it.
    assert tone.lightness(np.array(0.0)) == 0.0


def test_split_adds_up():
    y_d, y_s = 10 ** np.random.default_rng(1).uniform(-6, 3, (2, 1000))
    l_d, l_s = tone.split_lightness(y_d, y_s)
    np.testing.assert_allclose(l_d + l_s, tone.lightness(y_d + y_s))
    assert np.all(l_s >= 0)


def test_largest_c_keeps_every_pixel_displayable():
    rng = np.random.default_rng(2)
    l_d, l_s = rng.uniform(0, 99, 4000), rng.uniform(0, 400, 4000)
    c = np.min(tone.largest_c(l_d, l_s))
    assert np.max(l_d + c * l_s) <= 100 + 1e-9
    assert np.max(l_d + 1.001 * c * l_s) > 100


def test_where_nothing_is_specular_every_c_is_displayable():
    c = tone.largest_c(np.array([40.0, 40.0, 40.0]), np.array([0.0, 1e-7, 30.0]))
    assert np.all(c[:2] > 1e29)
    assert c[2] == pytest.approx(2.0)


def test_scaling_moves_the_specular_lightness_alone():
    split = np.array([[10.0, 20.0, 3.0, -4.0], [50.0, 0.0, 0.0, 8.0]])
    np.testing.assert_allclose(
        tone.scaled_lab(split, 0.5), [[20.0, 3.0, -4.0], [50.0, 0.0, 8.0]], rtol=1e-15
    )


def test_the_numbers_of_a_display_are_shared_and_so_not_writable():
    assert DisplayModel.of(Display()) is SRGB
    for array in (SRGB.white, SRGB.xyz_from_rgb, SRGB.rgb_from_xyz):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0


class TestGamut:
    def test_colours_inside_are_kept(self):
        rgb = np.random.default_rng(4).uniform(0.02, 0.98, (2000, 3))
        xyz = colour.RGB_to_XYZ(rgb, "sRGB", apply_cctf_decoding=False)
        lab = colour.XYZ_to_Lab(xyz, SRGB.white[:2] / SRGB.white.sum())
        shown, inside = tone.display_rgb(lab, SRGB)
        assert np.all(inside)
        np.testing.assert_allclose(shown, rgb, atol=2e-4)  # colour's sRGB matrix has four digits

    @pytest.mark.parametrize("hue_deg", range(0, 360, 30))
    def test_hue_and_lightness_are_held(self, hue_deg):
        hue = np.radians(hue_deg)
        lightness = np.linspace(15.0, 95.0, 17)
        chroma = 150.0  # outside sRGB in every direction
        lab = np.stack(
            [lightness, chroma * np.cos(hue) + 0 * lightness, chroma * np.sin(hue) + 0 * lightness],
            axis=-1,
        )
        shown, inside = tone.display_rgb(lab, SRGB)
        assert not np.any(inside)
        assert np.all((shown >= 0) & (shown <= 1))
        back = tone.lab_from_xyz(shown @ np.linalg.inv(SRGB.rgb_from_xyz).T, SRGB.white)
        np.testing.assert_allclose(back[:, 0], lightness, atol=0.05)
        turned = np.degrees(np.arctan2(back[:, 2], back[:, 1])) - hue_deg
        assert np.all(np.abs((turned + 180) % 360 - 180) < 1.0)
        # It is on the gamut's edge: a little more chroma no longer fits.
        back[:, 1:] *= 1.02
        assert not np.any(tone.display_rgb(back, SRGB)[1])

    def test_clipping_alone_turns_the_hue(self):
        # Negative control: clipped without reduction, a saturated green shifts by degrees.
        lab = np.array([[50.0, -110.0, 60.0]])
        rgb = np.clip(tone.xyz_from_lab(lab, SRGB.white) @ SRGB.rgb_from_xyz.T, 0, 1)
        back = tone.lab_from_xyz(rgb @ np.linalg.inv(SRGB.rgb_from_xyz).T, SRGB.white)[0]
        turned = np.degrees(np.arctan2(back[2], back[1]) - np.arctan2(60.0, -110.0))
        assert abs(turned) > 3.0

    def test_above_white_is_white(self):
        shown, _ = tone.display_rgb(np.array([[140.0, -30.0, 20.0]]), SRGB)
        # The gamut's edge is taken 1e-4 outside the cube; other channels give in by a little more.
        np.testing.assert_allclose(shown, 1.0, atol=5e-4)


class TestEncoding:
    def test_srgb(self):
        light = np.linspace(0, 1, 4096)
        expected = colour.models.eotf_inverse_sRGB(light)
        np.testing.assert_allclose(tone.encode(light, SRGB), expected, atol=1e-9)

    def test_gain_offset_gamma_is_inverted(self):
        display = DisplayModel.of(
            Display(transfer="gain-offset-gamma", gain=0.98, offset=0.02, gamma=2.4, flare=0.004)
        )
        digital = np.linspace(0, 1, 256)
        emitted = (0.98 * digital + 0.02) ** 2.4 + 0.004
        relative = emitted / emitted[-1]
        np.testing.assert_allclose(tone.encode(relative, display), digital, atol=1e-12)


class TestScaling:
    EXTREMES = Extremes(0.5, 60.0, 80.0, 60.0, 79.0)

    def test_default_is_c_max_and_fraction_is_of_it(self):
        assert Scaling.of(Look(), self.EXTREMES).c == 0.5
        assert Scaling.of(Look(c_fraction=0.5), self.EXTREMES).c == 0.25
        assert Scaling.of(Look(), self.EXTREMES).c_max_eq4 == pytest.approx(40 / 79)

    def test_no_highlight_means_c_is_one(self):
        scaling = Scaling.of(Look(c_fraction=0.3), Extremes(1e30, 60.0, 0.4, 60.0, 0.4))
        assert (scaling.c, scaling.c_max) == (1.0, None)

    def test_a_highlight_begins_at_half_a_unit(self):
        assert Scaling.of(Look(), Extremes(80.0, 60.0, 0.49, 60.0, 0.49)).c_max is None
        assert Scaling.of(Look(), Extremes(80.0, 60.0, 0.51, 60.0, 0.51)).c_max == 80.0

    def test_a_share_of_no_c_max_is_told(self):
        flat = Extremes(1e30, 60.0, 0.1, 60.0, 0.1)
        assert "c_max has no value" in Scaling.of(Look(c_fraction=0.3), flat).warnings[0]
        assert not Scaling.of(Look(), flat).warnings

    @pytest.mark.parametrize("l_s_max", [0.0, 50.0])
    def test_too_bright_without_a_highlight_is_no_less_an_error(self, l_s_max):
        with pytest.raises(InputError, match="diffuse part alone"):
            Scaling.of(Look(), Extremes(1e30, 110.0, l_s_max, 110.0, l_s_max))

    def test_too_bright_diffuse_is_an_error_and_absolute_c_draws_it(self):
        extremes = Extremes(-0.1, 103.0, 50.0, 103.0, 50.0)
        with pytest.raises(InputError, match="L\\* = 103"):
            Scaling.of(Look(), extremes)
        assert Scaling.of(Look(c=0.5), extremes).warnings

    def test_exaggeration_and_clipping_are_flagged(self):
        bright = Extremes(2.0, 40.0, 30.0, 40.0, 30.0)
        assert "above 1" in Scaling.of(Look(), bright).warnings[0]
        assert "clipped" in Scaling.of(Look(c=0.6), self.EXTREMES).warnings[0]
        assert not Scaling.of(Look(c=0.4), self.EXTREMES).warnings

    def test_non_finite_pixels_are_refused(self):
        with pytest.raises(InputError, match="not finite"):
            Scaling.of(Look(), Extremes(1.0, 1.0, 1.0, 1.0, 1.0, not_finite=3))
