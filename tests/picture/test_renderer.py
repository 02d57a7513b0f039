"""The GPU's frames against the float64 reference; what the renderer itself promises."""

from __future__ import annotations

import ctypes.util
import dataclasses
import os
import subprocess
import sys

import materials
import numpy as np
import pytest
from pictures import assert_same_pixels

from relgloss_view.base.errors import InputError, RelglossError
from relgloss_view.material.material import Diffuse, Lobe
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.model import tone
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Display, Eye, Lamp, Shape
from relgloss_view.quality.backends import open_renderer

colour = pytest.importorskip("colour")

SIZE = (512, 512)
SMALL = (160, 120)


def delta_e(frame, truth):
    """dE2000 over the object between two frames' Lab before gamut mapping."""
    seen = frame.on_object & truth.on_object
    return colour.delta_E(
        frame.lab[seen].astype(np.float64), truth.lab[seen].astype(np.float64), method="CIE 2000"
    )


def displayed_delta_e(frame, truth):
    """dE2000 of the displayed light, before quantisation."""
    model = tone.DisplayModel.of(frame.scene.display)
    back = np.linalg.inv(model.rgb_from_xyz).T
    a, b = (
        tone.lab_from_xyz(f.light.astype(np.float64) @ back, model.white) for f in (frame, truth)
    )
    return colour.delta_E(a.reshape(-1, 3), b.reshape(-1, 3), method="CIE 2000")


def assert_same_picture(frame, truth):
    np.testing.assert_array_equal(frame.coverage, truth.coverage)
    for mask in ("clipped", "out_of_gamut"):
        # Pixels on the very edge of the gamut may fall to either side.
        assert (
            np.sum(getattr(frame, mask) != getattr(truth, mask)) <= 2 + 1e-3 * frame.coverage.size
        )
    assert np.max(delta_e(frame, truth)) <= 0.02
    assert np.max(displayed_delta_e(frame, truth)) <= 0.02
    assert_same_pixels(frame.display, truth.display, within=1)
    if truth.c_max is not None:
        assert frame.c_max == pytest.approx(truth.c_max, rel=1e-5)
        assert frame.scaling.c_max_eq4 == pytest.approx(truth.scaling.c_max_eq4, rel=1e-4)


class TestAgainstReference:
    @pytest.mark.parametrize("azimuth_deg", [20.0, 80.0, 140.0])
    @pytest.mark.parametrize("sample", list(SAMPLES))
    def test_sample_papers(self, renderer, reference, sample, azimuth_deg):
        scene = Scene(load_sample(sample), lamp=Lamp(azimuth_deg=azimuth_deg))
        frame = renderer.render(scene, Look(), SIZE)
        assert_same_picture(frame, reference.render(scene, Look(), SIZE))

    @pytest.mark.slow
    @pytest.mark.parametrize("azimuth_deg", range(30, 140, 10))
    @pytest.mark.parametrize("sample", list(SAMPLES))
    def test_sample_papers_at_every_lamp(self, renderer, reference, sample, azimuth_deg):
        self.test_sample_papers(renderer, reference, sample, float(azimuth_deg))

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


#: A change of every field that a picture can depend on.
CHANGES = {
    "material": [materials.paper("cast"), materials.paper("art", "eon")],
    "shape": [
        {"kind": "sphere"}, {"diameter_m": 0.07}, {"height_m": 0.08},
        {"kind": "box", "width_m": 0.06}, {"kind": "box", "depth_m": 0.06},
    ],
    "lamp": [
        {"azimuth_deg": 70.0}, {"elevation_deg": 30.0}, {"distance_m": 0.3}, {"y_n": "front"},
        {"illuminant": "D65"}, {"luminance_cd_m2": 50.0},
    ],
    "eye": [
        {"azimuth_deg": 20.0}, {"elevation_deg": 10.0}, {"distance_m": 0.3},
        {"field_of_view_deg": 20.0},
    ],
    "display": [
        {"transfer": "gain-offset-gamma"}, {"gamut": "clip"}, {"background_lstar": 20.0},
        {"white_xy": (0.3457, 0.3585)}, {"primaries_xy": ((0.6, 0.3), (0.2, 0.7), (0.1, 0.1))},
        {"transfer": "gain-offset-gamma", "gamma": 2.0},
        {"transfer": "gain-offset-gamma", "gain": 0.9},
        {"transfer": "gain-offset-gamma", "offset": 0.1},
        {"transfer": "gain-offset-gamma", "flare": 0.01},
    ],
    "look": [
        {"sigma_n_deg": 1.0}, {"c": 0.2}, {"c_fraction": 0.5}, {"seed": 3}, {"samples": 3},
        {"grain": "surface"}, {"grain_px": 2}, {"grain": "surface", "grain_mm": 1.0},
        {"noise_law": "tangent"}, {"noisy_lobes": "specular"},
    ],
}  # fmt: skip


class TestPasses:
    @pytest.mark.parametrize("part", list(CHANGES))
    def test_nothing_stale_is_kept(self, renderer, part):
        """Picture after picture on one renderer is what a new renderer draws, bit for bit."""
        scene, look = Scene(materials.paper("art")), Look(sigma_n_deg=2.0)
        stages = ("diffuse", "specular", "lab", "display", "tilted_normal")
        first = renderer.render(scene, look, (48, 40))
        before = {stage: getattr(first, stage) for stage in stages}
        for change in CHANGES[part]:
            if part == "look":
                request = (scene, dataclasses.replace(look, **change))
            elif part == "material":
                request = (dataclasses.replace(scene, material=change), look)
            else:
                value = dataclasses.replace(getattr(scene, part), **change)
                request = (dataclasses.replace(scene, **{part: value}), look)
            renderer.render(scene, look, (48, 40))
            frame = renderer.render(*request, (48, 40))
            fresh = Renderer(renderer.ctx)
            wanted = fresh.render(*request, (48, 40))
            for stage in stages:
                np.testing.assert_array_equal(getattr(frame, stage), getattr(wanted, stage))
            fresh.release()
            seen = any(np.any(getattr(frame, stage) != before[stage]) for stage in stages)
            unseen = ({"luminance_cd_m2": 50.0}, {"grain_px": 1}, {"samples": 1})
            assert seen or change in unseen, f"{change} changes nothing"

    def test_two_devices_do_not_mix(self):
        """Stages fetched late come from the renderer that drew them, whatever was used since."""
        scenes = [Scene(materials.paper(name)) for name in ("cast", "uncoated")]
        alone = []
        for scene in scenes:
            with open_renderer("egl") as one:
                alone.append(one.render(scene, Look(), SMALL).lab.copy())
        with open_renderer("egl") as first:
            kept = first.render(scenes[0], Look(), SMALL)
            with open_renderer("egl") as second:
                other = second.render(scenes[1], Look(), SMALL)
                assert_same_pixels(kept.lab, alone[0])
                assert_same_pixels(other.lab, alone[1])
            assert kept.display.shape == (120, 160, 3)
        with pytest.raises(RelglossError, match="closed"):
            _ = kept.normal

    def test_refused_memory_leaves_a_usable_renderer(self, renderer, monkeypatch):
        from relgloss_view.picture.gpu.targets import Targets

        original = Targets._texture

        def refuse(self, size, dtype):
            if size == (30, 30):
                raise InputError("size 30x30: the device has no memory for it")
            return original(self, size, dtype)

        scene = Scene(materials.paper("cast"))
        monkeypatch.setattr(Targets, "_texture", refuse)
        for _ in range(2):
            with pytest.raises(InputError, match="no memory"):
                renderer.render(scene, Look(), (30, 30))
        assert renderer.render(scene, Look(), (32, 32)).display.shape == (32, 32, 3)

    def test_nothing_is_left_on_the_device(self, ctx):
        made = Renderer(ctx)
        for size in ((64, 64), (100, 30), (64, 64)):
            made.render(Scene(materials.paper("cast")), Look(), size)
        made.release()
        assert not ctx.objects

    def test_numbers_that_change_nothing_draw_nothing(self, renderer):
        scene = Scene(materials.paper("art"))
        renderer.render(scene, Look(c=0.3), SMALL)
        before = dict(renderer.draws)
        brighter = dataclasses.replace(scene, lamp=Lamp(luminance_cd_m2=500.0))
        renderer.render(brighter, Look(c=0.3), SMALL)
        renderer.render(scene, Look(c=0.3, seed=9, grain_mm=3.0, noise_law="tangent"), SMALL)
        assert renderer.draws == before

    def test_c_alone_runs_the_tone_pass_alone(self, renderer):
        scene = Scene(materials.paper("art"))
        renderer.render(scene, Look(sigma_n_deg=1.0, c=0.2), SMALL)
        before = dict(renderer.draws)
        renderer.render(scene, Look(sigma_n_deg=1.0, c=0.3), SMALL)
        changed = {k: v - before[k] for k, v in renderer.draws.items() if v != before[k]}
        assert changed == {"tone": 1}
        renderer.render(scene, Look(sigma_n_deg=1.0, c=0.3), SMALL)
        assert renderer.draws["tone"] == before["tone"] + 1

    def test_sigma_n_leaves_y_n_alone(self, renderer):
        scene = Scene(materials.paper("art"))
        renderer.render(scene, Look(sigma_n_deg=1.0), SMALL)
        white = renderer.draws["white"]
        renderer.render(scene, Look(sigma_n_deg=1.5), SMALL)
        assert renderer.draws["white"] == white

    def test_no_slider_compiles_a_shader(self, renderer):
        scene = Scene(materials.paper("art"))
        renderer.prepare(scene, Look())
        compiled = renderer.programs.compiled
        for sigma_n_deg in (0.0, 0.1, 3.0):
            for c_fraction in (0.2, 1.0):
                for samples in (1, 3):
                    look = Look(sigma_n_deg, None, c_fraction, seed=5, samples=samples)
                    frame = renderer.render(scene, look, SMALL)
                    assert frame.tilted_normal.shape == (120, 160, 3)
                    assert frame.light.shape == (120, 160, 3)
                    assert frame.clip_count == 0
        for azimuth_deg in (10.0, 100.0):
            renderer.render(
                Scene(materials.paper("cast"), lamp=Lamp(azimuth_deg=azimuth_deg)), look, SMALL
            )
        assert renderer.programs.compiled == compiled

    def test_frames_outlive_the_next_picture(self, renderer):
        scenes = [Scene(materials.paper(name)) for name in ("cast", "uncoated")]
        alone = [renderer.render(s, Look(), SMALL).lab.copy() for s in scenes]
        frames = [renderer.render(s, Look(), SMALL) for s in scenes]
        assert_same_pixels(frames[0].lab, alone[0])
        assert_same_pixels(frames[1].lab, alone[1])

    def test_resizing_and_releasing(self, renderer):
        scene = Scene(materials.paper("cast"))
        first = renderer.render(scene, Look(), SMALL)
        wanted = first.display.copy()
        for size in ((1, 1), (3, 2), (700, 33), (17, 256)):
            assert renderer.render(scene, Look(c=0.1), size).display.shape == (*size[::-1], 3)
        renderer.release()
        again = renderer.render(scene, Look(), SMALL)
        assert_same_pixels(again.display, wanted)

    def test_missing_uniform_and_broken_shader_are_told(self, renderer):
        from relgloss_view.picture.gpu.shader import ShaderError
        from relgloss_view.picture.gpu.targets import SPLIT

        renderer.render(Scene(materials.paper("cast")), Look(), SMALL)
        target = renderer.passes.targets.framebuffer(SPLIT)
        with pytest.raises(ShaderError, match=r"uniform '\w+' has no value"):
            renderer.programs.draw(
                "tone.frag", {"TRANSFER": 0, "GAMUT": 0, "SAMPLED": 0}, {}, target
            )
        with pytest.raises(ShaderError, match=r"measure\.frag:\d+.*BLOCK"):
            renderer.programs.get("measure.frag", {})


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

    @pytest.mark.parametrize("s_deg", [0.05, 0.1, 0.3])
    @pytest.mark.parametrize("kind", ["cylinder", "sphere", "plane"])
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

    @pytest.mark.parametrize(
        "size", [(0, 10), (10, 0), (100_000, 100_000), (16_385, 1), (6200, 6200)]
    )
    def test_impossible_sizes(self, renderer, size):
        with pytest.raises(InputError, match="size"):
            renderer.render(Scene(materials.flat()), Look(), size)


DRIVER_SCRIPT = """
import sys, numpy as np
sys.path.insert(0, sys.argv[1])
import materials
from relgloss_view.quality.backends import open_renderer
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
with open_renderer(sys.argv[2]) as renderer:
    out = {"device": np.array(str(renderer.ctx.info["GL_RENDERER"]))}
    for name in ("cast", "uncoated"):
        for sigma in (0.0, 2.0):
            scene, look = Scene(materials.paper(name)), Look(sigma_n_deg=sigma)
            frame = renderer.render(scene, look, (256, 256))
            for stage in ("diffuse", "specular", "lab", "display"):
                out[f"{name} {sigma} {stage}"] = getattr(frame, stage)
np.savez(sys.argv[3], **out)
"""


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    folder = tmp_path_factory.mktemp("drivers")

    def draw(backend, **environment):
        if backend == "osmesa" and ctypes.util.find_library("OSMesa") is None:
            return None
        path = folder / f"{backend}-{len(environment)}.npz"
        here = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
        done = subprocess.run(
            [sys.executable, "-c", DRIVER_SCRIPT, here, backend, str(path)],
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert done.returncode == 0, done.stderr
        return np.load(path)

    return {
        "egl": draw("egl"),
        "osmesa": draw("osmesa"),
        "softpipe": draw("egl", GALLIUM_DRIVER="softpipe"),
        # As far as macOS goes.
        "gl41": draw("egl", MESA_GL_VERSION_OVERRIDE="4.1", MESA_GLSL_VERSION_OVERRIDE="410"),
    }


class TestDrivers:
    """Each driver in a process of its own, as its environment is read once a process."""

    def stages(self, pictures):
        return [name for name in pictures["egl"].files if name != "device"]

    def test_osmesa_is_bit_identical(self, pictures):
        if pictures["osmesa"] is None:
            pytest.skip("this system has no libOSMesa; Mesa 25.1 dropped it")
        if "llvmpipe" not in str(pictures["egl"]["device"]):
            pytest.skip("EGL is not on the software driver that OSMesa uses")
        for name in self.stages(pictures):
            assert_same_pixels(pictures["osmesa"][name], pictures["egl"][name])

    def test_opengl_41_is_bit_identical(self, pictures):
        for name in self.stages(pictures):
            assert_same_pixels(pictures["gl41"][name], pictures["egl"][name])

    def test_softpipe_is_close(self, pictures):
        """An independent driver of floats: 1e-4 relative, and 1e-6 of the brightest for the dark.

        Lab, a difference of roots, is held to the same 1e-4 of a lightness of 10.
        """
        assert "softpipe" in str(pictures["softpipe"]["device"])
        differs = False
        for name in self.stages(pictures):
            a, b = (pictures[d][name].astype(np.float64) for d in ("softpipe", "egl"))
            differs |= bool(np.any(a != b))
            if name.endswith("display"):
                assert_same_pixels(a, b, within=1)
            elif name.endswith("lab"):
                assert_same_pixels(a, b, within=1e-3)
            else:
                np.testing.assert_allclose(a, b, rtol=1e-4, atol=1e-6 * np.max(b))
        assert differs, "two drivers that never differ are one driver: this test shows nothing"


ATTACH_SCRIPT = """
import ctypes, sys, numpy as np
import imgui_bundle, glfw  # in this order both use the bundle's own GLFW
sys.path.insert(0, sys.argv[1])
import materials
from relgloss_view.quality.backends import open_renderer
from relgloss_view.picture.gpu.context import attach
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
glfw.init_hint(glfw.PLATFORM, glfw.PLATFORM_NULL)
assert glfw.init()
for hint, value in ((glfw.CONTEXT_CREATION_API, glfw.EGL_CONTEXT_API),
                    (glfw.CONTEXT_VERSION_MAJOR, 3), (glfw.CONTEXT_VERSION_MINOR, 3),
                    (glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE)):
    glfw.window_hint(hint, value)
window = glfw.create_window(64, 64, "window", None, None)
glfw.make_context_current(window)
load = lambda name: ctypes.cast(glfw.get_proc_address(name), ctypes.c_void_p).value or 0
request = Scene(materials.paper("matte")), Look(sigma_n_deg=1.0), (64, 48)
ctx = attach(load)
in_window = Renderer(ctx).render(*request).lab.copy()
assert ctx.error == "GL_NO_ERROR"
with open_renderer("egl") as headless:
    np.testing.assert_array_equal(in_window, headless.render(*request).lab)
"""


def test_a_windows_own_context_draws_the_same():
    """GLFW's null platform: a window and its context, without a display."""
    here = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    words = [sys.executable, "-c", ATTACH_SCRIPT, here]
    done = subprocess.run(words, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


def test_backends_open_and_close():
    for backend in ("egl", "reference"):
        with open_renderer(backend) as renderer:
            assert renderer.render(Scene(materials.flat()), Look(), (8, 8)).display.shape == (
                8,
                8,
                3,
            )


class TestBounds:
    """Passes draw only the rectangle that the object can reach; the rest must be as if drawn."""

    @pytest.mark.parametrize("kind", ["cylinder", "sphere", "plane", "box"])
    def test_no_pixel_outside_shows_the_object(self, renderer, monkeypatch, kind):
        from relgloss_view.picture.model import view as views

        rng = np.random.default_rng(3)
        for _ in range(12):
            azimuth, elevation = rng.uniform(-180, 180), rng.uniform(-90, 90)
            eye = Eye(
                azimuth_deg=azimuth,
                elevation_deg=elevation,
                distance_m=rng.choice([0.09, 0.3, 0.6]),
                field_of_view_deg=rng.choice([None, 12.0, 40.0]),
                shift_right=rng.uniform(-0.1, 0.1),
                shift_up=rng.uniform(-0.1, 0.1),
            )
            scene = Scene(load_sample("uncoated"), shape=Shape(kind=kind), eye=eye)
            size = (61, 47)
            bounded = renderer.render(scene, Look(), size)
            with monkeypatch.context() as whole:
                whole.setattr(views, "_bounds", lambda *given: (0, 0, *given[-1]))
                views.view_of.cache_clear()
                full = Renderer(renderer.ctx, renderer.programs)
                expected = full.render(scene, Look(), size)
                np.testing.assert_array_equal(bounded.coverage, expected.coverage)
                assert_same_pixels(bounded.display, expected.display)
                full.release()
            views.view_of.cache_clear()

    def test_what_stood_there_before_is_gone(self, renderer):
        """The object moves in the picture; its old place is surround again."""
        near = Scene(load_sample("uncoated"), eye=Eye(field_of_view_deg=12.0, shift_right=0.06))
        far = dataclasses.replace(near, eye=Eye(field_of_view_deg=12.0, shift_right=-0.06))
        size = (80, 60)
        renderer.render(near, Look(), size)
        moved = renderer.render(far, Look(), size)
        fresh = Renderer(renderer.ctx, renderer.programs)
        expected = fresh.render(far, Look(), size)
        assert np.any(moved.on_object)
        np.testing.assert_array_equal(moved.coverage, expected.coverage)
        assert_same_pixels(moved.display, expected.display)
        assert_same_pixels(moved.light, expected.light)
        fresh.release()

    @pytest.mark.parametrize(
        ("shape", "eye"),
        [
            (
                Shape("cylinder", diameter_m=10, height_m=1e-3),
                Eye(azimuth_deg=1, distance_m=5.0005, field_of_view_deg=100),
            ),
            (
                Shape("cylinder", diameter_m=1, height_m=0.01),
                Eye(distance_m=0.505, field_of_view_deg=100),
            ),
            *(
                (
                    Shape(kind, 1e-3, 1e-3, 1e-3, 1e-3),
                    Eye(azimuth_deg=33, elevation_deg=21, distance_m=1000),
                )
                for kind in ("sphere", "cylinder", "box")
            ),
        ],
    )
    def test_very_near_and_very_far(self, renderer, monkeypatch, shape, eye):
        from relgloss_view.picture.model import view as views

        scene = Scene(load_sample("uncoated"), shape=shape, eye=eye)
        size = (300, 250)
        bounded = renderer.render(scene, Look(), size)
        assert np.sum(bounded.on_object) > 100
        monkeypatch.setattr(views, "_bounds", lambda *given: (0, 0, *given[-1]))
        views.view_of.cache_clear()
        full = Renderer(renderer.ctx, renderer.programs)
        np.testing.assert_array_equal(bounded.coverage, full.render(scene, Look(), size).coverage)
        full.release()
        views.view_of.cache_clear()


class TestFaultsInBetween:
    """A pass that fails was not drawn: the next picture is the one that was asked for."""

    @pytest.mark.parametrize("failing", range(1, 9))
    @pytest.mark.parametrize("kind", ["texture", "draw"])
    def test_next_picture_is_right(self, ctx, renderer, monkeypatch, failing, kind):
        import moderngl

        from relgloss_view.picture.gpu.shader import ShaderError

        scene, look = Scene(load_sample("matte-coated")), Look(sigma_n_deg=1.0, c_fraction=0.5)
        fresh = Renderer(ctx)
        wanted = fresh.render(scene, look, SMALL)
        expected = (wanted.display.copy(), wanted.light.copy(), wanted.clip_count)
        fresh.release()
        calls = []

        def broken(original, fault):
            def call(*arguments, **options):
                calls.append(1)
                if len(calls) == failing:
                    raise fault("now")
                return original(*arguments, **options)

            return call

        with monkeypatch.context() as patch:
            if kind == "texture":
                target = type(renderer.passes.targets)
                patch.setattr(target, "_texture", broken(target._texture, InputError))
            else:
                patch.setattr(
                    type(renderer.programs),
                    "draw",
                    broken(type(renderer.programs).draw, ShaderError),
                )
            try:
                frame = renderer.render(scene, look, SMALL)
                _ = frame.light, frame.clip_count
            except (RelglossError, ShaderError, moderngl.Error):
                pass
            assert calls
        again = renderer.render(scene, look, SMALL)
        assert_same_pixels(again.display, expected[0])
        assert_same_pixels(again.light, expected[1])
        assert again.clip_count == expected[2]


class TestNothingStale:
    def test_counts_follow_c(self, renderer):
        seen = set()
        for c in (8.0, 0.1, 8.0):
            f = renderer.render(Scene(load_sample("uncoated")), Look(c=c), SMALL)
            counts = (f.clip_count, f.out_of_gamut_count)
            assert counts == (np.sum(f.clipped), np.sum(f.out_of_gamut))
            seen.add(counts)
        assert len(seen) == 2
        assert any(clipped != outside for clipped, outside in seen)

    def test_an_edited_lamp_file_is_noticed(self, ctx, renderer, tmp_path):
        lamp = tmp_path / "lamp.csv"
        lamp.write_text("".join(f"{w},{w / 100}\n" for w in range(380, 781, 5)))
        scene = Scene(load_sample("uncoated"), lamp=Lamp(illuminant=str(lamp)))
        first = renderer.render(scene, Look(), SMALL).diffuse.copy()
        lamp.write_text("".join(f"{w},{(800 - w) / 100}\n" for w in range(380, 781, 5)))
        os.utime(lamp, (1e9, 1e9))
        second = renderer.render(scene, Look(), SMALL).diffuse
        fresh = Renderer(ctx)
        np.testing.assert_array_equal(second, fresh.render(scene, Look(), SMALL).diffuse)
        assert np.max(np.abs(second - first)) > 0.01
        fresh.release()

    def test_slightly_negative_light_is_on_the_object(self, renderer, reference):
        """Weights of a broad band can be negative, and so its Y."""
        paper = load_sample("uncoated")
        albedo = [0.0] * paper.bands.count
        albedo[paper.bands.wavelengths_nm.index(530.0)] = 0.9
        material = dataclasses.replace(
            paper, diffuse=dataclasses.replace(paper.diffuse, albedo=tuple(albedo))
        )
        scene = Scene(material, lamp=Lamp(illuminant="FL11"))
        look = Look(c=0.0)
        got, wanted = (r.render(scene, look, SMALL) for r in (renderer, reference))
        assert np.min(got.diffuse[..., 1]) < 0.0
        assert_same_pixels(got.display, wanted.display, within=1)
        assert got.c_max == pytest.approx(wanted.c_max, rel=1e-4)
