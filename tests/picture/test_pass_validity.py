"""What is drawn again: every change shows, and nothing is drawn for nothing."""

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
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Lamp

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
