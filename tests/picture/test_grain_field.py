"""Grain of one size at the eye: its field against its twin, closed forms and scipy's functions.

Each test of its statistics stands beside a field that must fail it: the paper's grain in blocks.
"""

from __future__ import annotations

import dataclasses
import itertools

import glsl
import materials
import numpy as np
import pytest
from frames import SMALL, delta_e
from scipy import special, stats

from relgloss_view.display.display import Display
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.method import EXACT
from relgloss_view.picture.model import noise
from relgloss_view.picture.model.grain_field import (
    CELL_STEPS,
    FIELD_TILE,
    FINER_LIGHTNESS,
    REACH_STEPS,
    inverse_erf,
    smooth_gaussians,
    smooth_tilt,
)
from relgloss_view.picture.model.pixel_sampling import eye_grain_samples, sample_count
from relgloss_view.picture.scene.look import Look, viewed_look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp

LAWS = ("paper", "tangent")
SIDE = 1024  #: texels of a field
STEP = 0.5  #: of the lattice, from texel to texel


def places(count, apart, seed=3):
    """Places so far apart that their Gaussians share no point of the lattice, at any phase."""
    rng = np.random.default_rng(seed)
    grid = np.stack(np.meshgrid(np.arange(count), np.arange(count)), axis=-1) * apart
    return grid.reshape(-1, 2) + rng.uniform(0.0, 1.0, (count * count, 2))


@pytest.fixture(scope="module")
def field():
    """One Gaussian of the smooth field, (SIDE, SIDE)."""
    at = np.stack(np.meshgrid(np.arange(SIDE), np.arange(SIDE)), axis=-1) + 0.5
    return smooth_gaussians(at * STEP, 11)[..., 0]


@pytest.fixture(scope="module")
def blocks():
    """The control: independent Gaussians in square cells of CELL_STEPS, (SIDE, SIDE)."""
    cell = np.floor((np.arange(SIDE) + 0.5) * STEP / CELL_STEPS).astype(int)
    values = np.random.default_rng(12).normal(size=(cell[-1] + 1, cell[-1] + 1))
    return values[cell[:, None], cell[None, :]]


def spectrum(values):
    """Power spectrum and the frequencies down and across, in cycles a step of the lattice."""
    window = np.hanning(SIDE)[:, None] * np.hanning(SIDE)[None]
    power = np.abs(np.fft.fft2(values * window)) ** 2 / np.sum(window**2) * STEP**2
    f = np.fft.fftfreq(SIDE, STEP)
    return power, *np.meshgrid(f, f, indexing="ij")


def kernel_power(f):
    """|FT|^2 of (1 - r^2/R^2)^3 over the integral of its square: Sonine's integral, Bessel's J4."""
    x = np.maximum(2.0 * np.pi * np.asarray(f) * REACH_STEPS, 1e-6)
    area = np.pi * REACH_STEPS**2 * 7.0 / 16.0
    return area * (2.0**4 * special.gamma(5.0) * special.jv(4, x) / x**4) ** 2


class TestTwin:
    @pytest.mark.parametrize("law", LAWS)
    def test_smooth_tilt(self, ctx, law):
        at = np.random.default_rng(1).uniform(0.0, 600.0, (20_000, 2)).astype(np.float32)
        body = f"result = vec4(smooth_tilt(NOISE_{law.upper()}, at.xy, 77u), 0.0, 0.0);"
        body = body.replace("at.xy", "place.xy")
        drawn = glsl.evaluate(ctx, ["grain_field.glsl"], body, {"place": at})[:, :2]
        # 600 steps are held to 3e-5 of a step by float32, over which a Gaussian changes as much.
        np.testing.assert_allclose(drawn, smooth_tilt(law, at.astype(float), 77), atol=3e-4)
        assert np.max(np.abs(drawn - smooth_tilt(law, at.astype(float), 78))) > 1.0

    def test_inverse_erf_is_scipys(self, ctx):
        one_less = np.geomspace(1e-7, 1.0, 5_000).astype(np.float32)
        truth = special.erfcinv(one_less.astype(float))
        np.testing.assert_allclose(inverse_erf(one_less.astype(float)), truth, rtol=2e-6, atol=1e-9)
        body = "result = vec4(inverse_erf(y.x), 0.0, 0.0, 0.0);"
        drawn = glsl.evaluate(ctx, ["grain_field.glsl"], body, {"y": one_less})[:, 0]
        np.testing.assert_allclose(drawn, truth, rtol=2e-6, atol=2e-7)


class TestLaw:
    def test_paper_angles_are_gaussian_and_azimuths_uniform(self):
        tilt = smooth_tilt("paper", places(150, 5.0), 5)
        angle, azimuth = np.hypot(*tilt.T), np.arctan2(tilt[:, 1], tilt[:, 0])
        assert stats.kstest(angle, stats.halfnorm.cdf).pvalue > 0.01
        assert stats.kstest(azimuth, stats.uniform(-np.pi, 2 * np.pi).cdf).pvalue > 0.01
        # The control: the other law's angle is Rayleigh distributed.
        other = np.hypot(*smooth_tilt("tangent", places(150, 5.0), 5).T)
        assert stats.kstest(other, stats.halfnorm.cdf).pvalue < 1e-6
        assert stats.kstest(other, stats.rayleigh.cdf).pvalue > 0.01

    def test_both_gaussians_are_normal_and_independent(self):
        g = smooth_gaussians(places(150, 5.0), 6)
        for one in g.T:
            assert stats.kstest(one, "norm").pvalue > 0.01
        assert abs(np.corrcoef(g.T)[0, 1]) < 4.0 / np.sqrt(len(g))

    @pytest.mark.parametrize("phase", [(0.0, 0.0), (0.5, 0.5), (0.5, 0.0), (0.25, 0.1)])
    def test_variance_is_one_at_every_place_of_the_lattice(self, phase):
        grid = np.stack(np.meshgrid(np.arange(120), np.arange(120)), axis=-1) * 4.0
        g = smooth_gaussians(grid + np.array(phase), 8)
        # 28,800 values: their variance is known to 0.8 %. Without the root of the summed squares
        # it would be 1.00 on a point of the lattice and 0.30 between four.
        assert np.var(g) == pytest.approx(1.0, abs=0.035)


class TestSpectrum:
    def test_it_is_the_kernels(self, field):
        power, down, across = spectrum(field)
        f = np.hypot(down, across)
        edges = np.linspace(0.02, 0.5, 13)
        for low, high in itertools.pairwise(edges):
            ring = (f >= low) & (f < high)
            assert np.mean(power[ring]) == pytest.approx(np.mean(kernel_power(f[ring])), rel=0.1)

    def test_low_frequencies_have_the_power_of_square_cells(self, field, blocks):
        for values in (field, blocks):
            power, down, across = spectrum(values)
            coarse = np.mean(power[np.hypot(down, across) < 0.05])
            wanted = CELL_STEPS**2 * (FINER_LIGHTNESS**2 if values is field else 1.0)
            assert coarse == pytest.approx(wanted, rel=0.12)

    def test_no_direction_is_preferred(self, field, blocks):
        """Power along the axes over that along the diagonals."""

        def contrast(values, low, high):
            power, down, across = spectrum(values)
            f, azimuth = np.hypot(down, across) * CELL_STEPS, np.arctan2(down, across)
            ring = (f > low) & (f < high)
            along = ring & (np.cos(4.0 * azimuth) > 0.7)
            slanted = ring & (np.cos(4.0 * azimuth) < -0.7)
            return np.mean(power[along]) / np.mean(power[slanted])

        for ring in ((0.2, 0.5), (0.5, 0.8), (0.8, 1.2)):
            assert contrast(field, *ring) == pytest.approx(1.0, abs=0.1)
        # Square cells: sinc^2(f) at the first side lobe against sinc^4(f / sqrt 2) near its zero.
        assert contrast(blocks, 1.3, 1.5) > 5.0

    def test_no_power_above_the_band(self, field, blocks):
        """Beyond the first zero of the kernel's transform: J4(7.588) = 0 (Abramowitz, Stegun)."""
        limit = 7.588 / (2.0 * np.pi * REACH_STEPS)

        def share_above(values):
            power, down, across = spectrum(values)
            return np.sum(power[np.hypot(down, across) > limit]) / np.sum(power)

        assert share_above(field) < 1e-3
        assert share_above(blocks) > 0.05


class TestPictures:
    @pytest.mark.parametrize(
        ("look", "display"),
        [
            (viewed_look(sigma_n_deg=2.0, c=0.4), Display()),
            (viewed_look(sigma_n_deg=2.0, c=0.4, noise_law="tangent", samples=2), Display()),
            (viewed_look(sigma_n_deg=2.0, c=0.4), Display(viewing_distance_m=0.2)),
            (viewed_look(sigma_n_deg=2.0, c=0.4), Display(pixel_pitch_mm=0.12)),
        ],
        ids=["usual", "tangent-2x2", "many grains a pixel", "fine display"],
    )
    def test_against_reference(self, renderer, reference, look, display):
        scene = Scene(materials.paper("matte"), display=display)
        frame, truth = (r.render(scene, look, (96, 80)) for r in (renderer, reference))
        assert np.max(delta_e(frame, truth)) < 0.02
        np.testing.assert_allclose(frame.tilted_normal, truth.tilted_normal, atol=2e-5)
        other = reference.render(scene, dataclasses.replace(look, seed=5), (96, 80))
        assert np.max(delta_e(frame, other)) > 1.0

    def test_only_what_the_grain_hangs_on_draws_the_field(self, renderer):
        scene, look = Scene(materials.paper("art")), viewed_look(sigma_n_deg=1.0, c=0.3)

        def drawn(scene, look, size=SMALL):
            before = renderer.draws["grain"]
            renderer.render(scene, look, size)
            return renderer.draws["grain"] - before

        drawn(scene, look)
        turned = scene.placed(eye=Eye(azimuth_deg=20.0), lamp=Lamp(azimuth_deg=9.0))
        assert drawn(scene, dataclasses.replace(look, sigma_n_deg=1.5, c=0.2)) == 0
        assert drawn(turned, look) == 0
        for changed in ({"seed": 2}, {"grain_arcmin": 3.0}, {"noise_law": "tangent"}):
            assert drawn(scene, dataclasses.replace(look, **changed)) == 1
        nearer = scene.placed(display=Display(viewing_distance_m=0.5))
        assert drawn(nearer, look) == 1
        assert drawn(scene, Look(1.0, 0.3)) == 0

    def test_a_larger_picture_keeps_the_grain(self, renderer, reference):
        """The field begins at the top left: the same pixel has the same tilt at every size."""
        scene, look = Scene(materials.paper("matte")), viewed_look(sigma_n_deg=2.0)
        flat = scene.placed(shape=dataclasses.replace(scene.shape, kind="plane"))
        small = renderer.render(flat, look, (120, 120)).tilted_normal.copy()
        large = renderer.render(flat, look, (180, 170)).tilted_normal[:120, :120]
        both = (np.abs(small).sum(-1) > 0) & (np.abs(large).sum(-1) > 0)
        assert np.sum(both) > 2000
        np.testing.assert_allclose(small[both], large[both], atol=2e-5)

    def test_it_repeats_after_the_tile_alone(self, renderer):
        assert FIELD_TILE >= 4096
        look = viewed_look(sigma_n_deg=2.0, grain_arcmin=0.1)
        assert eye_grain_samples(Display(), look) == 16
        frame = renderer.render(Scene(materials.paper("matte")), look, (300, 40))
        assert np.all(np.isfinite(frame.lab))

    def test_grain_far_below_a_pixel_is_the_mean_of_the_lobe(self, renderer):
        """256 draws in linear light against the closed form (noise.mean_lobe), by Method's mean."""
        scene = Scene(materials.paper("matte"), lamp=Lamp(azimuth_deg=20.0))
        look = viewed_look(sigma_n_deg=3.0, c=0.4, grain_arcmin=0.1, noisy_lobes="specular")
        fine = renderer.render(scene, look, SMALL).specular[..., 1].copy()
        mean = renderer.render(
            scene, Look(3.0, 0.4), SMALL, dataclasses.replace(EXACT, noise="mean")
        )
        coarse = renderer.render(scene, dataclasses.replace(look, grain_arcmin=1.5), SMALL)
        wanted = mean.specular[..., 1]
        bright = wanted > 0.3 * np.max(wanted)

        def off(found):
            return np.std(found[bright] / wanted[bright])

        assert np.mean(fine[bright]) == pytest.approx(np.mean(wanted[bright]), rel=0.02)
        assert off(fine) < 0.03
        assert off(coarse.specular[..., 1]) > 0.15
        # The oracle itself, at the peak: (1 + q^2)^-1/2.
        s = min(lobe.s for lobe in scene.material.visible_lobes())
        q = np.radians(3.0) / s
        assert noise.mean_lobe(np.array([0.0]), s, q * s)[0] == pytest.approx(1 / np.hypot(1.0, q))


class TestSampling:
    def test_it_follows_the_size_of_the_grain(self):
        scene, look = Scene(materials.paper("matte")), viewed_look(sigma_n_deg=1.0)
        for arcmin, expected in ((1.5, 1), (1.0, 2), (0.3, 6), (0.05 * 2, 16)):
            assert sample_count(scene, look.with_entries(grain_arcmin=arcmin), SMALL) == expected
        assert sample_count(scene, look.with_entries(grain_arcmin=1.0, samples=3), SMALL) == 4
        assert sample_count(scene, look.with_entries(grain_arcmin=0.3, sigma_n_deg=0.0), SMALL) == 1
        assert sample_count(scene, Look(1.0), SMALL) == 1

    @pytest.mark.parametrize(
        ("look", "display", "words"),
        [
            (viewed_look(sigma_n_deg=1.0), {}, None),
            (viewed_look(sigma_n_deg=1.0), {"viewing_distance_m": 0.4}, "raise --grain-arcmin"),
            (viewed_look(sigma_n_deg=0.0), {"viewing_distance_m": 0.4}, None),
            (viewed_look(sigma_n_deg=1.0, grain_arcmin=0.1), {"pixel_pitch_mm": 1.0}, "reach"),
            (Look(1.0, grain="surface", grain_mm=1.0), {}, None),
            (Look(1.0, grain="surface", grain_mm=0.2), {}, "--samples 5 averages"),
            (Look(1.0, grain="surface", grain_mm=0.2, samples=5), {}, None),
            (Look(1.0, grain="surface", grain_mm=0.01), {}, "reach"),
        ],
    )
    def test_what_a_display_can_t_show_is_warned_of(self, renderer, look, display, words):
        scene = Scene(materials.paper("matte"), display=Display(**display))
        frame: Frame = renderer.render(scene, look, (128, 128))
        found = [text for text in frame.warnings if "grain" in text]
        assert len(found) == (words is not None)
        assert words is None or words in found[0]
