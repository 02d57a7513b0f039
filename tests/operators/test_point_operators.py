"""Point operators against other programs' formulas, written out anew, and what they promise.

The formulas are those of RenderPark (as rpkCpp, src/tonemap), tizian/tonemapper (src/operators),
banterle/HDR_Toolbox (source_code/Tmo), Radiance's pcond by Ward himself (src/px/pcond3.c) and
colour-hdri, read there and put down here as plain arithmetic.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from lights import EQUAL_ENERGY, gray, scene_light, shown_luminance

from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.operators import tumblin_rushmeier, ward_histogram
from relgloss_view.operators.registry import make_operator
from relgloss_view.operators.schlick import Schlick, rational
from relgloss_view.operators.tumblin_rushmeier import TumblinRushmeier, brightness_law
from relgloss_view.operators.ward import Ward, contrast_scale
from relgloss_view.operators.ward_histogram import WardHistogram, adjusted_curve, visible_difference

POINT_OPERATORS = ("tumblin-rushmeier", "ward", "schlick", "ward-histogram")


def scene(low=0.5, high=60.0, count=400, seed=8):
    """Luminances over a range in cd/m2, (20, 20), log-uniform."""
    rng = np.random.default_rng(seed)
    return np.exp(rng.uniform(np.log(low), np.log(high), count)).reshape(20, -1)


class TestTumblinRushmeier:
    @staticmethod
    def renderpark(lw, lwa, ldmax, cmax):
        """TumblinRushmeierToneMap: everything in lamberts."""

        def lambert(cd):
            return cd * math.pi * 1e-4

        def law(la):
            x = math.log10(lambert(la))
            return 0.4 * x + 2.92, -0.4 * x * x - 2.584 * x + 2.0208

        (arw, brw), (ad, bd) = law(lwa), law(ldmax / math.sqrt(cmax))
        return lambert(lw) ** (arw / ad) * 10 ** ((brw - bd) / ad) / lambert(ldmax) - 1 / cmax

    @pytest.mark.parametrize("lwa", [0.3, 10.0, 110.0, 4000.0])
    def test_renderpark(self, lwa):
        light = gray(np.array([[lwa / 3.0, lwa * 3.0]]), display=EQUAL_ENERGY)
        operator = TumblinRushmeier(display_cd_m2=80.0, contrast=35.0)
        found = operator.displayed(light.luminance[0], light)
        expected = [self.renderpark(lw, lwa, 80.0, 35.0) for lw in light.luminance[0]]
        np.testing.assert_allclose(found, expected, rtol=1e-9)

    def test_a_bril_is_a_microlambert(self):
        # Stevens's unit: adapted to 1e-6 lambert, 1e-6 lambert has a brightness of one bril; and
        # brightness of what one is adapted to grows with the cube root of luminance.
        micro = 1e-6 * tumblin_rushmeier.LAMBERT_CD_M2
        for decades in (1, 3, 6):
            alpha, beta = brightness_law(micro * 10**decades)
            brils = 10**beta * (1e-6 * 10**decades) ** alpha
            assert math.log10(brils) == pytest.approx(decades / 3, abs=0.03)

    def test_cd_m2_in_place_of_lamberts_is_another_mapping(self, monkeypatch):
        # Negative control, and the reason for the choice: tizian's listing has no lamberts.
        light = gray(scene())
        right = TumblinRushmeier().displayed(light.luminance.ravel(), light)
        monkeypatch.setattr(tumblin_rushmeier, "LAMBERT_CD_M2", 1.0)
        wrong = TumblinRushmeier().displayed(light.luminance.ravel(), light)
        assert np.max(np.abs(wrong - right)) > 0.02
        micro = 1e-6 * 1e4 / math.pi
        alpha, beta = brightness_law(micro)
        assert 10**beta * micro**alpha > 10.0  # brils, where it should be one

    def test_equal_adaptation_shows_the_scene_as_it_is(self):
        # Display white 100, contrast 100: its observer is adapted to 10 cd/m2; so is the scene's.
        light = gray(np.array([[1.0, 100.0]]), display=EQUAL_ENERGY)
        shown = shown_luminance(TumblinRushmeier().apply(light))[0]
        np.testing.assert_allclose(shown, [0.01 - 0.01, 1.0 - 0.01], atol=1e-9)


class TestWard:
    def test_other_programs(self):
        # WardGlobalTMO.m and WardOperator.cpp agree.
        light = gray(scene(), display=EQUAL_ENERGY)
        mean = math.exp(np.mean(np.log(scene())))
        m = ((1.219 + (100 / 2) ** 0.4) / (1.219 + mean**0.4)) ** 2.5
        found = shown_luminance(Ward().apply(light))
        np.testing.assert_allclose(found, np.minimum(scene() * m / 100, 1.0), rtol=1e-9)

    def test_adapted_alike_nothing_is_scaled(self):
        assert contrast_scale(50.0, 100.0) == pytest.approx(1.0)

    def test_just_visible_stays_just_visible(self):
        # Blackwell's threshold at both adaptations, which is where the formula comes from.
        def threshold(adaptation):
            return 0.0594 * (1.219 + adaptation**0.4) ** 2.5

        assert contrast_scale(3.0, 100.0) == pytest.approx(threshold(50.0) / threshold(3.0))


class TestSchlick:
    #: colour-hdri 0.2.6, tonemapping_operator_Schlick1994's example: linear sRGB at p = 1.
    RGB = np.array(
        [
            [[0.48046875, 0.35156256, 0.23632812], [1.39843753, 0.55468757, 0.39062594]],
            [[4.40625388, 2.15625895, 1.34375372], [6.59375023, 3.43751395, 2.21875829]],
        ]
    )
    PUBLISHED = np.array(
        [
            [[0.1194997, 0.0874388, 0.0587783], [0.3478122, 0.1379590, 0.0971544]],
            [[1.0959009, 0.5362936, 0.3342115], [1.6399638, 0.8549608, 0.5518382]],
        ]
    )

    def test_published_example(self):
        display = DisplayModel.of(Display())
        light = scene_light(self.RGB @ display.xyz_from_rgb.T, white=display.white)
        factor = Schlick(p=1.0).displayed(light.luminance.ravel(), light) / light.luminance.ravel()
        found = self.RGB * factor.reshape(2, 2, 1)
        # Printed with seven digits, made with a four-digit matrix.
        np.testing.assert_allclose(found, self.PUBLISHED, rtol=2e-5)

    @pytest.mark.parametrize("p", [1.0, 2.0, 200.0])
    def test_other_programs(self, p):
        # SchlickTMO.m: p L / ((p - 1) L + LMax); tizian's shader: p L / (p L - L + Lmax).
        lw, top = scene(), np.max(scene())
        np.testing.assert_allclose(rational(lw, top, p), p * lw / ((p - 1) * lw + top), rtol=1e-12)
        np.testing.assert_allclose(rational(lw, top, p), p * lw / (p * lw - lw + top), rtol=1e-9)

    def test_the_darkest_is_the_first_level_that_is_seen(self):
        luminance = np.geomspace(0.01, 1000.0, 2001).reshape(1, -1)
        light = gray(luminance)
        shown = Schlick().displayed(luminance[0], light)
        darkest = np.quantile(luminance, 0.01)
        # p = L_max / (256 L_min) puts it at 1/256, less 1/256 of that.
        assert np.interp(darkest, luminance[0], shown) == pytest.approx(1 / 256, rel=0.01)
        assert shown[-1] == 1.0


class TestWardHistogram:
    @staticmethod
    def pcond(samples_cd_m2, ldmax, lddyn, human):
        """mkbrmap and BLw of pcond3.c in plain loops; returns display luminance of a luminance."""
        n = 100
        bldmin, bldmax = math.log(ldmax / lddyn), math.log(ldmax)
        bwmin = math.log(min(samples_cd_m2))
        bwmax = math.log(max(samples_cd_m2) * 1.01)
        hist = [0.0] * n
        for lw in samples_cd_m2:
            hist[int(n * (math.log(lw) - bwmin) / (bwmax - bwmin))] += 1.0
        histot = sum(hist)

        def htcontrs(la):
            if la < 1.148e-4:
                return 1.38e-3
            x = math.log10(la)
            if x < -1.44:
                return 10 ** ((0.405 * x + 1.6) ** 2.18 - 2.86)
            if x < -0.0184:
                return 10 ** (x - 0.395)
            if x < 1.9:
                return 10 ** ((0.249 * x + 0.65) ** 2.7 - 0.72)
            return 10 ** (x - 1.255)

        def blw(lw, cumf):
            b = math.log(lw)
            if b <= bwmin:
                return bldmin
            if b >= bwmax:
                return bldmax
            x = n * (b - bwmin) / (bwmax - bwmin)
            i = int(x)
            return bldmin + (cumf[i] * (1 - x + i) + cumf[i + 1] * (x - i)) * (bldmax - bldmin)

        while True:
            total = sum(hist)
            cumf = [sum(hist[:i]) / total for i in range(n + 1)]
            trimmed = 0.0
            for i in range(n):
                lw = math.exp(bwmin + (i + 0.5) * (bwmax - bwmin) / n)
                b = blw(lw, cumf)
                ratio = htcontrs(math.exp(b)) / htcontrs(lw) if human else math.exp(b) / lw
                ceiling = total * (bwmax - bwmin) / n
                ceiling *= ratio / (math.exp(b) * (bldmax - bldmin) / lw)
                if hist[i] > ceiling:
                    trimmed += hist[i] - ceiling
                    hist[i] = ceiling
            if trimmed <= 0.025 * histot:
                return lambda lw: math.exp(blw(lw, cumf))

    @staticmethod
    def crowded():
        """A wide range with most pixels in the dark and in the bright, none between."""
        rng = np.random.default_rng(2)
        logs = np.concatenate([rng.normal(-2, 0.7, 700), rng.normal(6, 0.5, 300)])
        return np.exp(logs).reshape(25, 40)

    @pytest.mark.parametrize("ceiling", ["linear", "human"])
    def test_the_author_s_program(self, ceiling):
        luminance = self.crowded()
        operator = WardHistogram(ceiling=ceiling, samples="pixels")
        found = operator.displayed(luminance.ravel(), gray(luminance))
        curve = self.pcond(luminance.ravel().tolist(), 100.0, 100.0, ceiling == "human")
        expected = [(curve(lw) - 1.0) / 99.0 for lw in luminance.ravel()]
        # The same arithmetic in another order: rounding alone.
        np.testing.assert_allclose(found, expected, atol=1e-9)

    def test_the_ceilings_differ_and_plain_equalisation_is_neither(self):
        # Negative control for the test above.
        luminance = self.crowded()
        light = gray(luminance)
        found = [
            WardHistogram(ceiling=c, samples="pixels").displayed(luminance.ravel(), light)
            for c in ("linear", "human")
        ]
        assert np.max(np.abs(found[0] - found[1])) > 0.05
        order = np.argsort(np.argsort(luminance.ravel())) / (luminance.size - 1)
        equalised = (100.0 ** (order - 1.0) - 0.01) / 0.99
        assert min(np.max(np.abs(f - equalised)) for f in found) > 0.05

    def test_no_contrast_above_the_scene_s(self):
        # What the linear ceiling is for: d log L_d <= d log L_w, but for the 2.5 % of counts that
        # may stand above it when the loop ends.
        luminance = self.crowded()
        samples = np.log(luminance.ravel())
        curve = adjusted_curve(samples, np.ones(samples.size), (0.0, math.log(100.0)), human=False)
        width = (curve.high - curve.low) / ward_histogram.BINS
        slope = np.diff(curve.cumulative) * math.log(100.0) / width
        assert np.sum(np.maximum(slope - 1.0, 0.0)) * width <= 0.03 * math.log(100.0)

    def test_what_the_display_holds_is_only_scaled(self):
        luminance = scene(1.0, 30.0)
        light = gray(luminance, display=EQUAL_ENERGY)
        shown = shown_luminance(WardHistogram(samples="pixels").apply(light))
        # The log mean goes to the middle of the display's log range, 10 of 100 cd/m2.
        expected = luminance * 0.1 / np.exp(np.mean(np.log(luminance)))
        np.testing.assert_allclose(shown, np.minimum(expected, 1.0), rtol=1e-9)

    def test_thresholds_are_the_published_rods_and_cones(self):
        # Ferwerda et al. 1996 as RenderPark has them, rods and cones apart.
        def rods(x):
            if x <= -3.94:
                return -2.86
            return x - 0.395 if x >= -1.44 else (0.405 * x + 1.6) ** 2.18 - 2.86

        def cones(x):
            if x <= -2.6:
                return -0.72
            return x - 1.255 if x >= 1.9 else (0.249 * x + 0.65) ** 2.7 - 0.72

        logs = np.linspace(-6.0, 5.0, 400)
        found = np.log10(visible_difference(10.0**logs))
        expected = [min(rods(x), cones(x)) for x in logs]
        # The published pieces meet to within a few thousandths.
        np.testing.assert_allclose(found, expected, atol=6e-3)

    def test_a_foveal_sample_is_a_square_degree(self):
        luminance = np.full((24, 36), 2.0)
        luminance[:12, :12] = np.linspace(10.0, 30.0, 144).reshape(12, 12)
        coverage = np.ones((24, 36))
        coverage[:, 24:] = 0.0
        light = gray(luminance, coverage=coverage, pixels_per_degree=12.0)
        means, weights = ward_histogram.foveal_samples(light)
        np.testing.assert_allclose(means, [20.0, 2.0, 2.0, 2.0])
        np.testing.assert_allclose(weights, 144.0)


class TestAll:
    @pytest.mark.parametrize("name", POINT_OPERATORS)
    def test_chromaticity_is_kept_and_order_too(self, name):
        display = DisplayModel.of(EQUAL_ENERGY)
        body = display.xyz_from_rgb @ [0.3, 0.4, 0.3]
        luminance = np.geomspace(0.1, 40.0, 256).reshape(16, 16)
        light = scene_light(
            luminance[..., None] * body / body[1], EQUAL_ENERGY, white=display.white
        )
        picture = make_operator(name).apply(light)
        inside = ~(picture.clipped | picture.out_of_gamut) & (shown_luminance(picture) > 1e-6)
        assert np.sum(inside) > 60
        xyz = picture.light[inside] @ display.xyz_from_rgb.T
        np.testing.assert_allclose(xyz / xyz[:, 1:2], np.tile(body / body[1], (len(xyz), 1)))
        # White is taken 1e-4 outside the cube and cut, by bisection to 1e-5 of chroma.
        assert np.all(np.diff(shown_luminance(picture).ravel()) > -1e-5)

    @pytest.mark.parametrize("name", POINT_OPERATORS)
    def test_nothing_lit_is_told(self, name):
        assert "nothing is lit" in make_operator(name).apply(gray(np.zeros((3, 3)))).warnings[0]
