"""The GPU's frames against the float64 reference."""

from __future__ import annotations

import dataclasses

import materials
import numpy as np
import pytest
from frames import SIZE, SMALL, assert_same_picture, delta_e

from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.material.material import Diffuse, Lobe
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp

MIDDLE = (224, 224)


class TestAgainstReference:
    @pytest.mark.parametrize("azimuth_deg", [20.0, 80.0, 140.0])
    @pytest.mark.parametrize("sample", list(SAMPLES))
    def test_sample_papers(self, renderer, reference, sample, azimuth_deg):
        self.check(renderer, reference, sample, azimuth_deg, MIDDLE)

    @pytest.mark.slow
    @pytest.mark.parametrize("azimuth_deg", range(20, 150, 10))
    @pytest.mark.parametrize("sample", list(SAMPLES))
    def test_sample_papers_at_every_lamp(self, renderer, reference, sample, azimuth_deg):
        self.check(renderer, reference, sample, float(azimuth_deg), SIZE)

    def check(self, renderer, reference, sample, azimuth_deg, size):
        scene = Scene(load_sample(sample), lamp=Lamp(azimuth_deg=azimuth_deg))
        frame = renderer.render(scene, Look(), size)
        assert_same_picture(frame, reference.render(scene, Look(), size))

    def test_a_perceptible_change_fails(self, renderer, reference):
        # Negative control: a lobe 2 % wider is another picture.
        material = materials.paper("art")
        lobe = dataclasses.replace(material.specular[0], s_deg=2.55)
        wider = dataclasses.replace(material, specular=(lobe, material.specular[1]))
        frame = renderer.render(Scene(wider), Look(c=0.4), SIZE)
        truth = reference.render(Scene(material), Look(c=0.4), SIZE)
        assert np.max(delta_e(frame, truth)) > 0.1

    @pytest.mark.parametrize("model", ["lambert", "oren-nayar", "eon"])
    def test_diffuse_models(self, renderer, reference, model):
        scene = Scene(materials.paper("uncoated", model), lamp=Lamp(azimuth_deg=110.0))
        frame = renderer.render(scene, Look(), SMALL)
        assert_same_picture(frame, reference.render(scene, Look(), SMALL))

    def test_spectral_lobe_and_rgb_material(self, renderer, reference):
        spectrum = tuple(np.linspace(0.2, 1.0, 35))
        material = dataclasses.replace(
            materials.paper("matte"), specular=(Lobe(spectrum, 5.0, 1.7),)
        )
        rgb = dataclasses.replace(
            material,
            bands=type(material.bands)(),
            diffuse=Diffuse("oren-nayar", (0.5, 0.05, 0.02), 8.0),
            specular=(Lobe((1.0, 0.8, 0.4), 5.0), Lobe((0.0,), 1.0)),
        )
        for scene in (Scene(material), Scene(rgb, lamp=Lamp(illuminant="HP5"))):
            frame = renderer.render(scene, Look(c=0.5), SMALL)
            assert_same_picture(frame, reference.render(scene, Look(c=0.5), SMALL))

    @pytest.mark.parametrize("kind", ["cylinder", "sphere", "plane", "box"])
    def test_shapes_from_above(self, renderer, reference, kind):
        scene = Scene(
            materials.paper("matte"),
            shape=Shape(kind=kind, width_m=0.07, depth_m=0.05),
            eye=Eye(azimuth_deg=25.0, elevation_deg=30.0),
            lamp=Lamp(azimuth_deg=40.0, elevation_deg=20.0, distance_m=0.3),
        )
        frame = renderer.render(scene, Look(), SMALL)
        truth = reference.render(scene, Look(), SMALL)
        assert 0.1 < np.mean(frame.on_object) < 0.9
        assert_same_picture(frame, truth)
        np.testing.assert_allclose(frame.normal, truth.normal, atol=1e-4)
        np.testing.assert_allclose(frame.point_m, truth.point_m, atol=1e-5)

    def test_supersampling(self, renderer, reference):
        look = Look(samples=4, c_fraction=0.8)
        scene = Scene(materials.paper("cast"))
        frame = renderer.render(scene, look, SMALL)
        assert len(np.unique(frame.coverage)) > 4
        # Wherever there is coverage there is a normal.
        length = np.linalg.norm(frame.normal, axis=-1)
        np.testing.assert_allclose(length, frame.on_object, atol=1e-5)
        assert_same_picture(frame, reference.render(scene, look, SMALL))

    @pytest.mark.parametrize("gamut", ["chroma", "clip"])
    def test_clipped_and_out_of_gamut_pixels(self, renderer, reference, gamut):
        # A saturated blue under strong gloss: both masks hold something, and neither everything.
        material = dataclasses.replace(
            materials.flat(0.3, (Lobe((1.0,), 4.0),)),
            bands=type(materials.flat().bands)(),
            diffuse=Diffuse("lambert", (0.0, 0.02, 0.9)),
        )
        scene = Scene(material, display=Display(gamut=gamut))
        frame = renderer.render(scene, Look(c=2.0), SMALL)
        assert_same_picture(frame, reference.render(scene, Look(c=2.0), SMALL))
        for mask in (frame.clipped, frame.out_of_gamut):
            assert 20 < np.sum(mask) < 0.9 * np.sum(frame.on_object)

    def test_y_n_at_the_front_point(self, renderer, reference):
        # Odd sizes have a pixel at the centre, which sees the front point.
        scene, size = Scene(materials.flat(0.3), lamp=Lamp(y_n="front")), (161, 121)
        frame = renderer.render(scene, Look(), size)
        assert_same_picture(frame, reference.render(scene, Look(), size))
        assert frame.diffuse[60, 80, 1] == pytest.approx(0.3, rel=1e-5)
        assert np.max(frame.diffuse[..., 1]) > 0.35
        with pytest.raises(InputError, match="diffuse part alone"):
            renderer.render(Scene(materials.flat(0.9), lamp=scene.lamp), Look(), SMALL)

    def test_other_display(self, renderer, reference):
        display = Display(
            transfer="gain-offset-gamma",
            gain=0.97,
            offset=0.03,
            gamma=2.4,
            flare=0.003,
            primaries_xy=((0.625, 0.34), (0.28, 0.595), (0.155, 0.07)),
            white_xy=(0.2831, 0.2971),
            background_lstar=20.0,
        )
        scene = Scene(materials.paper("art"), display=display)
        frame = renderer.render(scene, Look(), SMALL)
        assert_same_picture(frame, reference.render(scene, Look(), SMALL))
