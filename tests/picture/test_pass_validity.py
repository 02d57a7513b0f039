"""What is drawn again: every change shows, and nothing is drawn for nothing."""

from __future__ import annotations

import dataclasses
import os
from typing import ClassVar

import materials
import numpy as np
import pytest
from frames import SMALL
from pictures import assert_same_pixels

from relgloss_view.base.errors import InputError, RelglossError
from relgloss_view.display.display import Display
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.gpu.held import FOLLOWING, Held, key_of
from relgloss_view.picture.gpu.passes import PASSES
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.method import FIRST_PASS, Method
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp

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
        {"grain": "eye"}, {"grain": "eye", "grain_arcmin": 4.0}, {"grain": "eye", "seed": 2},
        {"grain": "eye", "grain_arcmin": 0.6},
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


#: What each change draws again of an exact picture of one sample, its c given, and nothing else.
ALL = {"white", "shade", "split", "tone"}
DRAWN_AGAIN = {
    "c": (Look(1.0, 0.5), {}, {"tone"}),
    "a share of c_max": (Look(1.0, None, 0.5), {}, {"tone"}),
    "sigma_N": (Look(1.5, 0.3), {}, {"shade", "split", "tone"}),
    "no grain": (Look(0.0, 0.3), {}, {"shade", "split", "tone"}),
    "the seed": (Look(1.0, 0.3, seed=2), {}, {"shade", "split", "tone"}),
    "the grain's law": (Look(1.0, 0.3, noise_law="tangent"), {}, {"shade", "split", "tone"}),
    "an unused size of grain": (Look(1.0, 0.3, grain_mm=3.0), {}, {"shade", "split", "tone"}),
    "samples": (Look(1.0, 0.3, samples=2), {}, ALL),
    "the albedo": (Look(1.0, 0.3), {"material": materials.flat(0.4)}, {"shade", "split", "tone"}),
    "the paper": (
        Look(1.0, 0.3), {"material": materials.paper("cast")}, {"shade", "split", "tone"}
    ),
    "the shape": (Look(1.0, 0.3), {"shape": Shape("sphere")}, ALL),
    "the lamp's place": (Look(1.0, 0.3), {"lamp": Lamp(azimuth_deg=20.0)}, ALL),
    "the lamp's spectrum": (
        Look(1.0, 0.3), {"lamp": Lamp(illuminant="D65")}, {"shade", "split", "tone"}
    ),
    "Y_n": (Look(1.0, 0.3), {"lamp": Lamp(y_n="front")}, {"shade", "split", "tone"}),
    "the lamp's power": (Look(1.0, 0.3), {"lamp": Lamp(luminance_cd_m2=50.0)}, set()),
    "the eye": (Look(1.0, 0.3), {"eye": Eye(elevation_deg=10.0)}, ALL),
    "the gamut": (Look(1.0, 0.3), {"display": Display(gamut="clip")}, {"tone"}),
    "the display": (Look(1.0, 0.3), {"display": Display(background_lstar=20.0)}, {"tone"}),
    "nothing": (Look(1.0, 0.3), {}, set()),
}  # fmt: skip
#: Stages that are drawn when somebody asks, and after which changes they still hold.
ASKED = {
    "light": ("nothing", "the lamp's power"),
    "geometry": ("c", "a share of c_max", "the gamut", "the display", "nothing"),
    "counts": ("nothing", "the lamp's power"),
}


class TestDrawnAgain:
    """One change at a time of a picture that was drawn."""

    @pytest.mark.parametrize("change", list(DRAWN_AGAIN))
    def test_what_follows_from_a_change_and_no_more(self, renderer, change):
        look, changes, expected = DRAWN_AGAIN[change]
        scene = Scene(materials.paper("art"))
        renderer.render(scene, Look(1.0, 0.3), SMALL)
        before = dict(renderer.draws)
        renderer.render(dataclasses.replace(scene, **changes), look, SMALL)
        again = {k: n - before[k] for k, n in renderer.draws.items() if n != before[k]}
        assert again == dict.fromkeys(expected, 1)

    @pytest.mark.parametrize("change", list(DRAWN_AGAIN))
    def test_what_was_asked_for_is_drawn_again_where_it_changed(self, renderer, change):
        look, changes, _ = DRAWN_AGAIN[change]
        scene = Scene(materials.paper("art"))
        frame = renderer.render(scene, Look(1.0, 0.3), SMALL)
        _ = frame.light, frame.normal, frame.clip_count
        before = dict(renderer.draws)
        frame = renderer.render(dataclasses.replace(scene, **changes), look, SMALL)
        _ = frame.light, frame.normal, frame.clip_count
        for name, holding in ASKED.items():
            if change in holding:
                assert renderer.draws[name] == before[name]
            elif name != "geometry":
                assert renderer.draws[name] == before[name] + 1

    def test_the_other_pass_that_splits_draws_its_own(self, renderer):
        scene, look = Scene(materials.paper("art")), Look(1.0, 0.3)
        renderer.render(scene, look, SMALL)
        before = dict(renderer.draws)
        cheaper = Method(split=FIRST_PASS)
        frame = renderer.render(scene, look, SMALL, cheaper)
        counted = {k: n - before[k] for k, n in renderer.draws.items() if n != before[k]}
        assert counted == {"shade": 1, "tone": 1}
        # XYZ is drawn when somebody asks, once.
        _ = frame.diffuse, frame.specular
        renderer.render(scene, Look(1.0, 0.4), SMALL, cheaper).diffuse.sum()
        assert renderer.draws["shade"] == before["shade"] + 2
        renderer.render(scene, Look(1.5, 0.4), SMALL, cheaper).diffuse.sum()
        assert renderer.draws["shade"] == before["shade"] + 4


class TestHeld:
    #: Everything that no longer holds where a pass is drawn again, directly or not.
    SHADED: ClassVar = {
        "split", "xyz", "geometry", "extremes", "tone", "light", "counts", "overlay",
    }  # fmt: skip
    GONE: ClassVar = {
        "white": set(),
        "once": set(),
        "grain": {"shade", *SHADED},
        "shade": SHADED,
        "split": {"extremes", "tone", "light", "counts", "overlay"},
        "tone": {"counts", "overlay"},
        "light": {"overlay"},
        "geometry": {"overlay"},
        "extremes": set(),
        "xyz": set(),
        "counts": set(),
        "coverage": set(),
        "edges": set(),
        "overlay": set(),
    }

    @pytest.mark.parametrize("name", list(GONE))
    def test_what_follows_is_drawn_again(self, name):
        held = Held()
        order = ("white", "once", "grain", "shade", "split", "geometry", "light", "tone", "xyz",
                 "extremes", "counts", "coverage", "edges", "overlay")  # fmt: skip
        assert set(order) == set(self.GONE)
        for other in order:  # a pass comes before what follows from it
            assert held.renew(other, 1)
        for other in order:
            assert not held.renew(other, 1)
        assert held.renew(name, 2)
        for other in order:
            again = held.renew(other, 2 if other == name else 1)
            assert again == (other in self.GONE[name]), other

    def test_every_pass_that_follows_is_one_that_is_drawn(self):
        followers = {name for names in FOLLOWING.values() for name in names}
        assert followers | set(FOLLOWING) <= set(self.GONE)
        assert set(PASSES) <= set(self.GONE)

    def test_a_pass_that_was_forgotten_is_drawn_again(self):
        held = Held()
        assert held.renew("tone", 1)
        held.forget("tone")
        assert held.renew("tone", 1)
        held.clear()
        assert held.renew("tone", 1)

    def test_a_key_holds_every_number(self):
        """Names in any order, arrays by their bytes: -0.0 is another number than 0.0."""
        one = key_of({"a": np.arange(3.0), "b": {"c": 1}}, (2, "x"))
        assert one == key_of({"b": {"c": 1}, "a": np.arange(3.0)}, (2, "x"))
        hash(one)
        assert one != key_of({"a": np.array([0.0, 1.0, 2.0000001]), "b": {"c": 1}}, (2, "x"))
        assert one != key_of({"a": np.arange(3.0), "b": {"c": 2}}, (2, "x"))
        assert one != key_of({"a": np.arange(3.0), "d": {"c": 1}}, (2, "x"))
        assert key_of(np.array([0.0])) != key_of(np.array([-0.0]))


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
