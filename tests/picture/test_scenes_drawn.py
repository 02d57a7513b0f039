"""Scenes at the ends of their ranges: unlit, unseen, brighter than white, narrow lobes."""

from __future__ import annotations

import dataclasses

import materials
import numpy as np
import pytest
from frames import SIZE, SMALL
from pictures import assert_same_pixels

from relgloss_view.base.errors import InputError
from relgloss_view.material.material import Lobe
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp

#: Form and width of the lobe, degrees, in the fast suite; all of them are in the slow one.
LOBES = (("cylinder", 0.05), ("sphere", 0.1), ("plane", 0.3))


class TestScenes:
    def test_c_max_keeps_every_pixel_displayable(self, renderer):
        for name in materials.PAPERS:
            for azimuth_deg in (20.0, 110.0):
                scene = Scene(materials.paper(name), lamp=Lamp(azimuth_deg=azimuth_deg))
                frame = renderer.render(scene, Look(sigma_n_deg=1.0), SMALL)
                assert np.max(frame.lab[..., 0]) <= 100 + 1e-4
                assert np.max(frame.lab[..., 0]) > 99.9
                assert np.sum(frame.clipped) == 0
                above = renderer.render(scene, Look(sigma_n_deg=1.0, c=1.02 * frame.c_max), SMALL)
                assert np.sum(above.clipped) > 0

    def test_equation_4_overestimates_on_broad_lobes(self, renderer):
        scene = Scene(materials.paper("uncoated"))
        scaling = renderer.render(scene, Look(), SIZE).scaling
        assert 1.0 < scaling.c_max_eq4 / scaling.c_max < 1.07

    def test_white_lambert_shows_l_100_at_most(self, renderer):
        frame = renderer.render(Scene(materials.flat(1.0)), Look(), SMALL)
        assert frame.c == 1.0
        assert frame.c_max is None
        assert np.max(frame.lab[..., 0]) == pytest.approx(100.0, abs=1e-3)
        assert frame.y_n_cd_m2 == 110.0

    def test_more_than_white_is_refused(self, renderer):
        material = materials.flat(1.3, (Lobe((1.0,), 5.0),))
        with pytest.raises(InputError, match="diffuse part alone"):
            renderer.render(Scene(material), Look(), SMALL)
        frame = renderer.render(Scene(material), Look(c=0.5), SMALL)
        assert np.sum(frame.clipped) > 0

    @pytest.mark.parametrize("backend", ["gpu", "reference"])
    def test_unlit_and_unseen_are_defined(self, renderer, reference, backend):
        draw = renderer if backend == "gpu" else reference
        material = materials.paper("cast")
        for lamp in (Lamp(azimuth_deg=180.0), Lamp(distance_m=0.01), Lamp(elevation_deg=90.0)):
            frame = draw.render(Scene(material, lamp=lamp), Look(sigma_n_deg=1.0), SMALL)
            assert np.any(frame.on_object)
            assert np.max(frame.specular) == 0.0
            assert "lights nothing" in frame.warnings[-1]
        frame = draw.render(Scene(material, eye=Eye(distance_m=0.02)), Look(), SMALL)
        assert not np.any(frame.on_object)
        assert "inside the object" in frame.warnings[-1]
        plane = Scene(material, shape=Shape(kind="plane"), eye=Eye(azimuth_deg=180.0))
        assert not np.any(draw.render(plane, Look(), SMALL).on_object)

    def test_lamp_in_the_plane_of_a_sheet_lights_nothing(self, renderer, reference):
        scene = Scene(
            materials.paper("cast"), shape=Shape(kind="plane"), lamp=Lamp(azimuth_deg=90.0)
        )
        for draw in (renderer, reference):
            frame = draw.render(scene, Look(sigma_n_deg=1.0), SMALL)
            assert np.max(frame.diffuse) == 0.0
            assert "lights nothing" in frame.warnings[-1]

    def test_an_object_out_of_the_picture_is_told(self, renderer, reference):
        scene = Scene(materials.paper("cast"), eye=Eye(field_of_view_deg=170.0))
        for draw in (renderer, reference):
            frame = draw.render(scene, Look(samples=1), (2, 2))
            assert not np.any(frame.on_object)
            assert "nothing of the object" in frame.warnings[-1]

    @pytest.mark.parametrize(
        ("kind", "s_deg"),
        [
            pytest.param(kind, s_deg, marks=() if (kind, s_deg) in LOBES else pytest.mark.slow)
            for kind in ("cylinder", "sphere", "plane")
            for s_deg in (0.05, 0.1, 0.3)
        ],
    )
    def test_a_lobe_under_a_pixel_keeps_its_energy(self, renderer, s_deg, kind):
        """The samples chosen against four times as many a side: within 2 %."""
        lamp = Lamp(azimuth_deg=0.0 if kind == "plane" else 50.0, distance_m=1.0)
        material = materials.flat(0.3, (Lobe((1.0,), s_deg),))
        scene = Scene(material, shape=Shape(kind=kind), lamp=lamp)
        size = (128, 128)
        frame = renderer.render(scene, Look(c=0.1, samples=None), size)
        chosen = frame.specular[..., 1].sum()
        assert not any("narrow" in w for w in frame.warnings)
        best = renderer.render(scene, Look(c=0.1, samples=16), size).specular[..., 1].sum()
        large = renderer.render(scene, Look(c=0.1, samples=12), (640, 640))
        truth = large.specular[..., 1].sum() / 25
        assert best == pytest.approx(truth, rel=0.02)
        assert chosen == pytest.approx(truth, rel=0.02)
        # One sample a pixel is told to be too few, where it is.
        one = renderer.render(scene, Look(c=0.1, samples=1), size)
        if one.specular[..., 1].sum() != pytest.approx(truth, rel=0.02):
            assert "narrow" in one.warnings[0]

    def test_a_strength_beyond_float32_is_refused(self, renderer):
        lobe = Lobe((1e6,), 0.05)
        object.__setattr__(lobe, "strength", (1e38,))  # past the material's own check
        with pytest.raises(InputError, match="not finite"):
            renderer.render(Scene(materials.flat(0.3, (lobe,))), Look(samples=None), SMALL)

    @pytest.mark.parametrize("s_deg", [0.05, 40.0])
    def test_extreme_lobes_are_finite(self, renderer, s_deg):
        material = materials.flat(0.3, (Lobe((1.0,), s_deg, 1.5),))
        for azimuth_deg in (0.0, 90.0, 170.0, 179.0):
            scene = Scene(material, lamp=Lamp(azimuth_deg=azimuth_deg))
            frame = renderer.render(scene, Look(sigma_n_deg=3.0, c=0.1), SMALL)
            for stage in (frame.diffuse, frame.specular, frame.lab, frame.light):
                assert np.all(np.isfinite(stage))
            assert np.min(frame.specular) >= 0.0
            assert np.min(frame.diffuse) >= 0.0

    def test_unit_index_has_no_highlight(self, renderer):
        material = materials.flat(0.3, (Lobe((1.0,), 2.0, 1.0),))
        frame = renderer.render(Scene(material), Look(), SMALL)
        assert np.max(frame.specular) == 0.0
        assert frame.c == 1.0

    def test_a_lone_bright_band_gives_no_negative_light(self, renderer, reference):
        """Weights of a regular table's cubic can be negative, and would make its Y so."""
        paper = load_sample("uncoated")
        albedo = [0.0] * paper.bands.count
        albedo[paper.bands.wavelengths_nm.index(530.0)] = 0.9
        material = dataclasses.replace(
            paper, diffuse=dataclasses.replace(paper.diffuse, albedo=tuple(albedo))
        )
        scene = Scene(material, lamp=Lamp(illuminant="FL11"))
        look = Look(c=0.0)
        got, wanted = (r.render(scene, look, SMALL) for r in (renderer, reference))
        cubic = xyz_weights(paper.bands, illuminant("FL11"))
        assert np.min(np.asarray(albedo) @ cubic) < 0.0  # control: the cubic alone
        assert np.min(got.diffuse) >= 0.0
        assert_same_pixels(got.display, wanted.display, within=1)
        assert got.c_max == pytest.approx(wanted.c_max, rel=1e-4)
