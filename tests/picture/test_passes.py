"""Which passes are drawn again, and that nothing that no longer holds is shown."""

from __future__ import annotations

import dataclasses
import os

import materials
import numpy as np
import pytest
from frames import SMALL
from pictures import assert_same_pixels

from relgloss_view.base.errors import InputError, RelglossError
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.method import EXACT, FIRST_PASS, Method
from relgloss_view.picture.model import tone
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Lamp
from relgloss_view.quality.backends import open_renderer

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


class TestTheCard:
    """Pass 1 writes diffuse and specular to two float targets; pass 2 splits, scales, encodes."""

    LOOKS = (
        Look(),
        Look(sigma_n_deg=2.0, c_fraction=0.5),
        Look(sigma_n_deg=1.0, c=3.0, samples=3),
    )

    def test_two_float_targets_then_their_split(self, renderer):
        scene = Scene(materials.paper("matte"))
        frame = renderer.render(scene, Look(), SMALL)
        targets = renderer.passes.targets
        assert [targets.texture(name).dtype for name in ("diffuse", "specular")] == ["f4", "f4"]
        drawn = {name: count for name, count in renderer.draws.items() if count}
        assert drawn == {"white": 1, "shade": 1, "split": 1, "tone": 1}
        # What pass 1 wrote is what a frame holds: nothing is drawn for it.
        assert np.max(frame.specular) > np.max(frame.diffuse) > 0.0
        assert renderer.draws["shade"] == 1
        white = frame.white_xyz
        l_d, l_s = (
            np.where(frame.on_object, value, 0.0)
            for value in tone.split_lightness(frame.diffuse[..., 1], frame.specular[..., 1])
        )
        split = tone.split_lab(frame.diffuse, frame.specular, white)
        scaled = tone.scaled_lab(split, frame.c)[frame.on_object]
        # Cube roots and differences of float32: 4 units of f in a*, 500 times as large.
        np.testing.assert_allclose(frame.lab[frame.on_object], scaled, rtol=0, atol=2e-3)
        assert frame.c_max == pytest.approx(
            np.min((100.0 - l_d[l_s > 0.5]) / l_s[l_s > 0.5]), rel=1e-5
        )

    @pytest.mark.parametrize("look", LOOKS, ids=["smooth", "grain", "samples"])
    @pytest.mark.parametrize("paper", ["cast", "uncoated"])
    def test_the_split_in_pass_1_is_the_same_picture(self, renderer, paper, look):
        scene = Scene(materials.paper(paper), lamp=Lamp(azimuth_deg=70.0))
        exact = renderer.render(scene, look, SMALL, EXACT)
        lab, light, c_max = exact.lab.copy(), exact.light.copy(), exact.c_max
        total = (exact.diffuse + exact.specular) / exact.white_xyz
        display = exact.display.copy()
        assert renderer.draws["split"] == 1
        first = renderer.render(scene, look, SMALL, Method(split=FIRST_PASS))
        assert renderer.draws["split"] == 1
        bound = max(1.0, exact.c) * split_rounding(total)  # c scales L_s* and its error
        assert np.all(np.abs(first.lab - lab) <= bound[..., None])
        # Y = f^3 up to 1 has the slope 3/116 per L*; a row of the matrix sums to less than 5.
        assert np.max(np.abs(first.light - light)) < 5.0 * 3.0 / 116.0 * np.max(bound)
        assert_same_pixels(first.display, display, within=1)
        assert first.c_max == pytest.approx(c_max, rel=1e-5)
        # Negative control: a split that is held in half floats is another picture.
        if look.samples == 1:
            half = renderer.render(scene, look, SMALL, Method(split=FIRST_PASS, targets="float16"))
            assert np.any(np.abs(half.lab - lab) > bound[..., None])

    def test_parts_of_a_picture_split_in_pass_1_are_the_exact_ones(self, renderer):
        scene, look = Scene(materials.paper("art")), Look(sigma_n_deg=1.0)
        exact = renderer.render(scene, look, SMALL)
        parts = exact.diffuse.copy(), exact.specular.copy(), exact.coverage.copy()
        frame = renderer.render(scene, look, SMALL, Method(split=FIRST_PASS))
        for drawn, wanted in zip(
            (frame.diffuse, frame.specular, frame.coverage), parts, strict=True
        ):
            np.testing.assert_array_equal(drawn, wanted)


def split_rounding(relative_xyz):
    """What float32 leaves open of L*, a* and b* of a pixel, from XYZ over the white, (H, W, 3).

    XYZ is a sum of up to four products, each rounded: 8 units in the last place, a third of it in a
    cube root, which adds 4 units itself. a* is 500 times a difference of two such roots. Compilers
    may order the sums otherwise in the two passes, so each side may be off by that.
    """
    unit = 2.0**-24
    root = np.cbrt(np.maximum(np.max(np.abs(relative_xyz), axis=-1), tone.LAB_EPSILON))
    return 2.0 * 500.0 * 2.0 * (8.0 / 3.0 + 4.0) * unit * root


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
