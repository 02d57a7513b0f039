"""The grain in pictures: against the float64 reference, its keys, its energy."""

from __future__ import annotations

import dataclasses

import materials
import numpy as np
import pytest
from frames import SMALL, delta_e

from relgloss_view.pack.shape import Shape
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp


class TestNoise:
    @pytest.mark.parametrize(
        "look",
        [
            Look(sigma_n_deg=0.5),
            Look(sigma_n_deg=3.0, seed=9),
            Look(sigma_n_deg=2.0, noise_law="tangent", noisy_lobes="specular", grain_px=3),
            Look(sigma_n_deg=2.0, grain="surface", grain_mm=0.4),
            Look(sigma_n_deg=2.0, grain="surface", samples=3),
        ],
        ids=["mild", "strong", "tangent", "surface", "surface-3x3"],
    )
    @pytest.mark.parametrize("name", ["cast", "matte"])
    def test_against_reference(self, renderer, reference, name, look):
        scene = Scene(materials.paper(name))
        frame, truth = (r.render(scene, look, (256, 256)) for r in (renderer, reference))
        # A surface cell's border may fall to the other side: hence the percentile.
        assert np.percentile(delta_e(frame, truth), 99.9) <= 0.1
        assert np.max(np.abs(frame.tilted_normal - frame.normal)) > 0.02

    def test_another_seed_is_another_picture(self, renderer, reference):
        scene = Scene(materials.paper("matte"))
        frame = renderer.render(scene, Look(sigma_n_deg=2.0, seed=1), SMALL)
        truth = reference.render(scene, Look(sigma_n_deg=2.0, seed=2), SMALL)
        assert np.percentile(delta_e(frame, truth), 99.9) > 1.0

    def test_sphere_grain_keeps_its_area_towards_the_poles(self, renderer):
        look = Look(sigma_n_deg=1.0, grain="surface", grain_mm=2.0)
        scene = Scene(
            materials.paper("matte"), shape=Shape(kind="sphere"), eye=Eye(elevation_deg=80.0)
        )
        frame = renderer.render(scene, look, (256, 256))
        # Pixels of one cell share one tilt; a pole of converging meridians would hold dozens of
        # cells a pixel wide.
        tilt = np.sum(frame.normal * frame.tilted_normal, axis=-1)[118:138, 118:138]
        assert len(np.unique(np.round(tilt, 6))) < 60

    def test_zero_sigma_is_the_noise_free_picture_bit_for_bit(self, renderer, monkeypatch):
        from relgloss_view.picture.gpu import variant

        scene = Scene(materials.paper("matte"))
        smooth = renderer.render(scene, Look(), SMALL)
        wanted = {name: getattr(smooth, name).copy() for name in ("diffuse", "specular", "display")}
        # The noisy variant itself, given a sigma of zero.
        original = variant.Variant.of.__func__
        monkeypatch.setattr(
            variant.Variant,
            "of",
            classmethod(lambda cls, *a: dataclasses.replace(original(cls, *a), noise="paper")),
        )
        noisy = Renderer(renderer.ctx).render(scene, Look(), SMALL)
        for name, values in wanted.items():
            np.testing.assert_array_equal(getattr(noisy, name), values)

    def test_screen_grain_is_keyed_on_the_pixel(self, renderer):
        # A plane under one lamp direction for both sizes: the same pixel draws the same tilt.
        scene = Scene(materials.paper("matte"), shape=Shape(kind="plane"))
        look = Look(sigma_n_deg=2.0)
        small = renderer.render(scene, look, (200, 200)).tilted_normal.copy()
        large = renderer.render(scene, look, (260, 260)).tilted_normal
        both = (np.abs(small).sum(-1) > 0) & (np.abs(large[:200, :200]).sum(-1) > 0)
        assert np.sum(both) > 3000
        np.testing.assert_allclose(small[both], large[:200, :200][both], atol=1e-6)

    def test_surface_grain_is_keyed_on_the_object(self, renderer):
        # Seen from two places, a point keeps its grain.
        scene = Scene(materials.paper("matte"), shape=Shape(kind="plane"))
        look = Look(sigma_n_deg=2.0, grain="surface", grain_mm=8.0)
        tilts = []
        for size in ((200, 200), (331, 257)):
            frame = renderer.render(scene, look, size)
            on = frame.on_object
            cell = np.floor(frame.point_m[on][:, :2] / 8e-3).astype(int)
            tilts.append(
                {
                    tuple(c): tuple(np.round(n, 5))
                    for c, n in zip(cell, frame.tilted_normal[on], strict=True)
                }
            )
        shared = set(tilts[0]) & set(tilts[1])
        assert len(shared) > 80
        assert all(tilts[0][c] == tilts[1][c] for c in shared)
        assert len({tilts[0][c] for c in shared}) > 70

    def test_no_specks_at_the_silhouette(self, renderer):
        scene = Scene(materials.flat(0.5), lamp=Lamp(azimuth_deg=20.0))
        frame = renderer.render(scene, Look(sigma_n_deg=3.0), (400, 400))
        lit = np.sum(frame.normal * scene.lamp.position_m, axis=-1) > 0.3
        assert np.all(np.isfinite(frame.diffuse))
        assert np.min(frame.diffuse[..., 1][lit & frame.on_object]) > 0.02

    def test_zooming_out_keeps_the_highlights_energy(self, renderer):
        """One screenful of the object against 16 x smaller pixels: within 2 %.

        Surface grain, 8 x 8 samples a pixel in the small picture, so both see every region.
        """
        scene = Scene(materials.paper("matte"))
        look = Look(sigma_n_deg=1.0, grain="surface", grain_mm=1.0, c=0.3)
        large = renderer.render(scene, look, (1024, 1024))
        energy = np.mean(large.specular[..., 1] * large.coverage)
        small = renderer.render(scene, dataclasses.replace(look, samples=8), (64, 64))
        assert np.mean(small.specular[..., 1] * small.coverage) == pytest.approx(energy, rel=0.02)
