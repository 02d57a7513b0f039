"""Measures against pictures of which they are known, with pictures that must not count."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from lights import gray
from materials import paper

from relgloss_view.display.display import Display
from relgloss_view.gloss import eye
from relgloss_view.gloss import shown as measures
from relgloss_view.gloss.shown import Measures, Regions, agreement, ranks
from relgloss_view.operators.clip import Clip
from relgloss_view.operators.registry import make_operator
from relgloss_view.operators.split import Split
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.scene.look import Look, viewed_look
from relgloss_view.picture.scene.scene import Scene

SIZE = 200


def regions(highlight=None, pixels_per_degree=40.0, grain_px=1.0, on_screen=40.0):
    whole = np.ones((SIZE, SIZE), dtype=bool)
    shining = whole if highlight is None else highlight
    return Regions(whole, whole & ~shining, shining, pixels_per_degree, grain_px, on_screen)


def grains(side, deviation=2.0, seed=7, size=SIZE):
    """L* of independent square grains of this side in pixels, whole or not."""
    cell = np.floor((np.arange(size) + 0.5) / side).astype(int)
    values = np.random.default_rng(seed).normal(50.0, deviation, (cell[-1] + 1, cell[-1] + 1))
    return values[cell[:, None], cell[None, :]]


class TestContrast:
    def test_highlight_less_body(self):
        lightness = np.full((SIZE, SIZE), 35.0)
        lightness[:, 90:110] = 95.0  # a tenth of the object
        assert measures.contrast_gloss(lightness, regions()) == pytest.approx(60.0)
        assert measures.peak_contrast(lightness, regions()) == pytest.approx(60.0, abs=0.1)

    def test_a_narrow_highlight_counts_by_its_peak_alone(self):
        lightness = np.full((SIZE, SIZE), 35.0)
        lightness[96:104, 96:104] = 95.0  # 0.16 % of the object
        assert measures.contrast_gloss(lightness, regions()) == pytest.approx(0.0)
        # Eight pixels are 0.2 degrees: six standard deviations of the blur, in both directions.
        share = math.erf(0.1 / (measures.EYE_SD_DEG * math.sqrt(2.0))) ** 2
        found = measures.peak_contrast(lightness, regions())
        assert found == pytest.approx(60.0 * share, rel=0.02)

    def test_nothing_of_the_object_has_no_number(self):
        none = dataclasses.replace(regions(), whole=np.zeros((SIZE, SIZE), dtype=bool))
        assert measures.contrast_gloss(np.zeros((SIZE, SIZE)), none) is None
        assert measures.peak_contrast(np.zeros((SIZE, SIZE)), none) is None
        assert measures.graininess(np.zeros((SIZE, SIZE)), none) is None
        assert measures.grain_deviation(np.zeros((SIZE, SIZE)), none) is None
        assert measures.sharpness(np.zeros((SIZE, SIZE)), none) is None


def square(size, on_screen):
    """Regions of a picture that is all highlight."""
    whole = np.ones((size, size), dtype=bool)
    return Regions(whole, ~whole, whole, 40.0, 1.0, on_screen)


def on_a_side(side):
    """Regions for grains of this side in pixels that are 1.5 minutes of arc at the eye."""
    return dataclasses.replace(square(400, 40.0 * side), grain_px=side)


class TestEye:
    def test_sensitivity_is_as_published(self):
        """Mannos and Sakrison 1974: 1 at the most, at 8 cycles a degree."""
        f = np.linspace(0.0, 60.0, 6001)
        sensitivity = eye.contrast_sensitivity(f)
        assert f[np.argmax(sensitivity)] == pytest.approx(8.0, abs=0.5)
        assert np.max(sensitivity) == pytest.approx(1.0, abs=0.03)
        assert eye.contrast_sensitivity(np.array([0.0]))[0] == pytest.approx(2.6 * 0.0192)
        assert sensitivity[-1] < 0.01

    def test_another_published_sensitivity_judges_alike(self, monkeypatch):
        """How much less a grain of one pixel is seen at half the pitch, by Barten 1999.

        The function is colour-science's, at 110 cd/m2 on ten degrees. The control: without any
        sensitivity the two displays show the same.
        """
        from colour.contrast import barten1999 as barten

        def share():
            deviations = []
            for scale in (38.8, 77.6):
                f = np.arange(200) / 400.0 * scale
                power = eye._shown_power(f[:, None], f[None, :], scale)
                deviations.append(math.sqrt(np.mean(power)))
            return deviations[1] / deviations[0]

        ours = share()
        diameter = barten.pupil_diameter_Barten1999(110.0, 10.0)
        sigma = barten.sigma_Barten1999(0.5 / 60.0, 0.08 / 60.0, diameter)
        troland = barten.retinal_illuminance_Barten1999(110.0, diameter)

        def theirs(f):
            f = np.maximum(f, 0.1)
            return barten.contrast_sensitivity_function_Barten1999(
                f, sigma=sigma, E=troland, X_0=10.0
            )

        monkeypatch.setattr(eye, "contrast_sensitivity", theirs)
        assert ours == pytest.approx(share(), rel=0.1)
        monkeypatch.setattr(eye, "contrast_sensitivity", np.ones_like)
        assert share() > 1.3 * ours


class TestGraininess:
    @pytest.mark.parametrize("side", [1.0, 1.49, 1.51, 2.0, 2.3, 4.0])
    def test_independent_grains_give_their_deviation(self, side):
        found = measures.grain_deviation(grains(side, size=400), on_a_side(side))
        # N grains of which the band takes about an eighth: 2 / sqrt(2 N / 8) is 1 to 2 %.
        assert found == pytest.approx(2.0, rel=0.07)
        # The control: grains of twice the deviation.
        other = measures.grain_deviation(grains(side, 4.0, size=400), on_a_side(side))
        assert other == pytest.approx(4.0, rel=0.07)

    @pytest.mark.parametrize("side", [1.0, 1.49, 1.51, 2.0, 2.3, 4.0])
    def test_grains_of_the_papers_pixel_are_seen_as_they_are(self, side):
        """1.5 minutes of arc by one pixel or several."""
        found = measures.graininess(grains(side, size=400), on_a_side(side))
        assert found == pytest.approx(2.0, rel=0.07)
        # The control: on a display of half the pitch the same pixels are finer grains.
        finer = dataclasses.replace(on_a_side(side), screen_pixels_per_degree=80.0 * side)
        assert measures.graininess(grains(side, size=400), finer) < 1.4

    def test_the_same_light_counts_the_same_whatever_pixels_show_it(self):
        lightness = grains(1.0, size=150)
        fine = np.kron(lightness, np.ones((3, 3)))
        one = measures.graininess(lightness, square(150, 40.0))
        three = measures.graininess(fine, square(450, 120.0))
        assert three == pytest.approx(one, rel=0.02)
        # The control: as fine a grain on the finer display is seen less.
        assert measures.graininess(grains(1.0, size=450), square(450, 120.0)) < 0.6 * one

    def test_what_the_eye_does_not_resolve_is_no_grain(self):
        far = measures.graininess(grains(1.0), regions(on_screen=400.0))
        near = measures.graininess(grains(1.0), regions(on_screen=40.0))
        assert far < 0.2 * near

    def test_shading_and_upright_highlights_are_no_grain(self):
        # Negative control: a sum of any function of x and any of y is no grain; a plain band-pass
        # takes the highlight's edges for it.
        x = np.arange(SIZE) / SIZE
        lightness = 30.0 + 60.0 * np.exp(-(((x - 0.5) / 0.02) ** 2))[None, :] + 20.0 * x[:, None]
        assert measures.graininess(lightness, regions()) < 1e-9
        assert measures.grain_deviation(lightness, regions()) < 1e-9

    def test_only_the_highlight_counts(self):
        shining = np.zeros((SIZE, SIZE), dtype=bool)
        shining[:, 60:120] = True
        lightness = np.full((SIZE, SIZE), 40.0)
        noise = np.random.default_rng(8).normal(0.0, 3.0, lightness.shape)
        for measured in (measures.graininess, measures.grain_deviation):
            assert measured(lightness + noise * ~shining, regions(shining)) < 0.6
            inside = measured(lightness + noise * shining, regions(shining))
            assert inside == pytest.approx(3.0, rel=0.1)


class TestCoverage:
    def test_the_share_above_the_flank(self):
        lightness = np.full((SIZE, SIZE), 30.0)
        lightness[:, 60:90] = 80.0  # 15 %
        assert measures.coverage(lightness, regions()) == pytest.approx(0.15, abs=0.005)
        assert measures.coverage(np.full((SIZE, SIZE), 30.0), regions()) == 0.0


class TestSharpness:
    def test_a_ramp(self):
        ramp = np.repeat(0.25 * np.arange(SIZE)[None, :], SIZE, axis=0)  # L* per pixel
        assert measures.sharpness(ramp, regions()) == pytest.approx(0.25 * 40.0)

    @pytest.mark.parametrize("pixels_per_degree", [40.0, 80.0])
    def test_an_edge_is_as_sharp_as_the_eye(self, pixels_per_degree):
        # A step of 50 blurred by a Gaussian has a slope of 50 / (sqrt(2 pi) sd), in degrees:
        # pixels don't count, but for their finite difference (4 % at 1.3 pixels of blur).
        step = np.where(np.arange(SIZE) < SIZE // 2, 30.0, 80.0)[None, :].repeat(SIZE, axis=0)
        found = measures.sharpness(step, regions(pixels_per_degree=pixels_per_degree))
        expected = 50.0 / (math.sqrt(2.0 * math.pi) * measures.EYE_SD_DEG)
        assert found == pytest.approx(expected, rel=0.15 if pixels_per_degree < 50 else 0.05)

    def test_grain_is_no_sharpness_and_an_edge_under_grain_is(self):
        """Matte's grain of sd 1.4 on a flat highlight, against the flank of one."""
        grain = np.random.default_rng(3).normal(0.0, 1.4, (SIZE, SIZE))
        grainy = dataclasses.replace(regions(), grainy=True)
        # The mean over 4 grains leaves 1.4 / (2 sqrt(pi) 4) = 0.1 L*, with a slope of
        # 0.1 / (sqrt(2) 4) a pixel; the largest of 200^2 / (4 pi 4^2) = 200 places is 3.3 of it.
        expected = 3.3 * 1.4 / (2.0 * math.sqrt(math.pi) * 4.0) / (math.sqrt(2.0) * 4.0) * 40.0
        assert measures.sharpness(grain, grainy) == pytest.approx(expected, rel=0.3)
        ramp = np.repeat(0.25 * np.arange(SIZE)[None, :], SIZE, axis=0)
        assert measures.sharpness(ramp + grain, grainy) == pytest.approx(0.25 * 40.0, rel=0.3)
        # The control: without the mean grain passes for an edge.
        assert measures.sharpness(grain, regions()) > 5.0 * measures.sharpness(grain, grainy)

    def test_the_terminator_is_no_highlight(self):
        step = np.where(np.arange(SIZE) < 40, 0.0, 60.0)[None, :].repeat(SIZE, axis=0)
        shining = np.zeros((SIZE, SIZE), dtype=bool)
        shining[:, 120:150] = True
        assert measures.sharpness(step, regions(shining)) < 1e-9


class TestBody:
    def test_difference_is_the_median_ciede2000(self):
        light = gray(np.linspace(20.0, 90.0, SIZE * SIZE).reshape(SIZE, SIZE))
        plain = Clip().apply(light)
        darker = Clip().apply(dataclasses.replace(light, y_n_cd_m2=150.0))
        body = dataclasses.replace(regions(), body=np.ones((SIZE, SIZE), dtype=bool))
        expected = np.median(delta_e_2000(plain.lab.reshape(-1, 3), darker.lab.reshape(-1, 3)))
        assert measures.body_difference(darker, plain, body) == pytest.approx(expected)
        assert expected > 5.0
        assert measures.body_difference(plain, plain, body) == 0.0


TRUTH = {"cast": 4.0, "art": 3.0, "matte": 2.0, "uncoated": 1.0}


class TestOrder:
    def test_ranks_and_ties(self):
        values = {"a": 10.0, "b": 30.0, "c": 29.5, "d": 10.0}
        assert ranks(values) == {"b": 0, "c": 1, "a": 2, "d": 2}
        assert list(ranks(values, tie=1.0).items()) == [("b", 0), ("c", 0), ("a", 2), ("d", 2)]

    @pytest.mark.parametrize(
        ("shown", "tau", "same"),
        [
            # Kendall's tau by counting pairs: 6 agree; 5 agree, 1 not; none agrees.
            ((9.0, 7.0, 5.0, 3.0), 1.0, True),
            ((7.0, 9.0, 5.0, 3.0), 4 / 6, False),
            ((3.0, 5.0, 7.0, 9.0), -1.0, False),
            # Tau-b with one tie: 5 / sqrt(5 * 6).
            ((9.0, 8.5, 5.0, 3.0), 5 / math.sqrt(30), False),
            ((5.0, 5.1, 5.2, 5.3), None, False),
        ],
    )
    def test_agreement(self, shown, tau, same):
        found = agreement(dict(zip(TRUTH, shown, strict=True)), TRUTH, tie=1.0)
        assert found.tau == (None if tau is None else pytest.approx(tau))
        assert found.same is same

    def test_a_true_tie_may_be_told_apart(self):
        truth = {"a": 2.0, "b": 2.0, "c": 1.0}
        assert agreement({"a": 9.0, "b": 5.0, "c": 1.0}, truth, tie=1.0).same


class TestFrames:
    def draw(self, reference, name, operator, **look):
        frame = reference.render(Scene(paper(name)), Look(**look), (80, 80))
        return measures.measure(frame, make_operator(operator).draw(frame))

    def test_scaling_scales_contrast_and_slope_and_keeps_the_body(self, reference):
        full = self.draw(reference, "matte", "split", c_fraction=1.0)
        half = self.draw(reference, "matte", "split", c_fraction=0.5)
        assert half.peak_contrast < full.peak_contrast - 10.0
        assert half.sharpness < 0.8 * full.sharpness
        for found in (full, half):
            assert found.body_difference < 0.3
            assert found.clipped_share == 0.0
            assert found.graininess < 0.1

    def test_tilted_normals_are_grain(self, reference):
        smooth = self.draw(reference, "matte", "split")
        noisy = self.draw(reference, "matte", "split", sigma_n_deg=2.0)
        assert noisy.graininess > 10.0 * smooth.graininess

    def test_grain_at_the_eye_looks_the_same_on_every_display(self, renderer):
        """Matte paper, sigma_N 2 degrees: within 10 %, 90 to 220 dpi, 256 and 512 px."""
        self.looks_the_same(renderer, (256, 512), (90, 140, 220))

    @pytest.mark.slow
    def test_grain_at_the_eye_looks_the_same_on_more_displays(self, renderer):
        self.looks_the_same(renderer, (256, 512, 1024), (90, 110, 140, 164, 188, 220))

    def looks_the_same(self, renderer, sizes, dots_per_inch):

        def seen(look, dpi, size):
            display = Display(pixel_pitch_mm=25.4 / dpi)
            frame = renderer.render(Scene(paper("matte"), display=display), look, (size, size))
            lightness = Split().draw(frame).lab[..., 0]
            return measures.graininess(lightness, Regions.of(frame))

        cases = [(dpi, size) for size in sizes for dpi in dots_per_inch]
        found = np.array([seen(viewed_look(sigma_n_deg=2.0, c=0.4), *case) for case in cases])
        assert np.max(np.abs(found / np.mean(found) - 1.0)) < 0.1
        # The control: grain of one pixel is seen less the finer the pixels are.
        found = np.array([seen(Look(2.0, 0.4), dpi, 512) for dpi in (90, 220)])
        assert found[1] < 0.65 * found[0]

    def test_clipping_is_counted(self, reference):
        assert self.draw(reference, "art", "clip").clipped_share > 0.01

    def test_what_can_t_be_measured_is_none(self, reference):
        frame = reference.render(Scene(paper("matte")), Look(), (1, 1))
        assert isinstance(measures.measure(frame, Clip().draw(frame)), Measures)
