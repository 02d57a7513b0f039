"""Measures against pictures of which they are known, with pictures that must not count."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from lights import gray
from materials import paper

from relgloss_view.gloss import shown as measures
from relgloss_view.gloss.shown import Measures, Regions, agreement, ranks
from relgloss_view.operators.clip import Clip
from relgloss_view.operators.registry import make_operator
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene

SIZE = 200


def regions(highlight=None, pixels_per_degree=40.0, grain_px=1.0):
    whole = np.ones((SIZE, SIZE), dtype=bool)
    shining = whole if highlight is None else highlight
    return Regions(whole, whole & ~shining, shining, pixels_per_degree, grain_px)


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
        assert measures.sharpness(np.zeros((SIZE, SIZE)), none) is None


class TestGraininess:
    @pytest.mark.parametrize("side", [1, 2, 4])
    def test_independent_grains_give_their_deviation(self, side):
        grains = np.random.default_rng(7).normal(50.0, 2.0, (SIZE // side, SIZE // side))
        lightness = np.kron(grains, np.ones((side, side)))
        found = measures.graininess(lightness, regions(grain_px=float(side)))
        # N grains of which the band takes about an eighth: 2 / sqrt(2 N / 8) is 1 to 4 %.
        assert found == pytest.approx(2.0, rel=0.12)

    def test_shading_and_upright_highlights_are_no_grain(self):
        # Negative control: a sum of any function of x and any of y is no grain; a plain band-pass
        # takes the highlight's edges for it.
        x = np.arange(SIZE) / SIZE
        lightness = 30.0 + 60.0 * np.exp(-(((x - 0.5) / 0.02) ** 2))[None, :] + 20.0 * x[:, None]
        assert measures.graininess(lightness, regions()) < 1e-9

    def test_only_the_highlight_counts(self):
        shining = np.zeros((SIZE, SIZE), dtype=bool)
        shining[:, 60:120] = True
        lightness = np.full((SIZE, SIZE), 40.0)
        noise = np.random.default_rng(8).normal(0.0, 3.0, lightness.shape)
        assert measures.graininess(lightness + noise * ~shining, regions(shining)) < 0.6
        inside = measures.graininess(lightness + noise * shining, regions(shining))
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

    def test_clipping_is_counted(self, reference):
        assert self.draw(reference, "art", "clip").clipped_share > 0.01

    def test_what_can_t_be_measured_is_none(self, reference):
        frame = reference.render(Scene(paper("matte")), Look(), (1, 1))
        assert isinstance(measures.measure(frame, Clip().draw(frame)), Measures)
