"""What a renderer promises: sizes, memory, devices, programs, and frames that outlive it."""

from __future__ import annotations

import materials
import pytest
from frames import SMALL
from pictures import assert_same_pixels

from relgloss_view.base.errors import InputError, RelglossError
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Lamp
from relgloss_view.quality.backends import open_renderer
from relgloss_view.quality.planner import MethodChooser


class TestSizesAndMemory:
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

    def test_resizing_and_releasing(self, renderer):
        scene = Scene(materials.paper("cast"))
        first = renderer.render(scene, Look(), SMALL)
        wanted = first.display.copy()
        for size in ((1, 1), (3, 2), (700, 33), (17, 256)):
            assert renderer.render(scene, Look(c=0.1), size).display.shape == (*size[::-1], 3)
        renderer.release()
        again = renderer.render(scene, Look(), SMALL)
        assert_same_pixels(again.display, wanted)

    @pytest.mark.parametrize(
        "size", [(0, 10), (10, 0), (100_000, 100_000), (16_385, 1), (6200, 6200)]
    )
    def test_impossible_sizes(self, renderer, size):
        with pytest.raises(InputError, match="size"):
            renderer.render(Scene(materials.flat()), Look(), size)


class TestFrames:
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

    def test_frames_outlive_the_next_picture(self, renderer):
        scenes = [Scene(materials.paper(name)) for name in ("cast", "uncoated")]
        alone = [renderer.render(s, Look(), SMALL).lab.copy() for s in scenes]
        frames = [renderer.render(s, Look(), SMALL) for s in scenes]
        assert_same_pixels(frames[0].lab, alone[0])
        assert_same_pixels(frames[1].lab, alone[1])


class TestPrograms:
    def test_no_slider_compiles_a_shader(self, ctx):
        renderer = Renderer(ctx, choose=MethodChooser().method)  # with no program of another test
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
        assert renderer.programs.compiled == compiled > 0
        renderer.release()

    def test_missing_uniform_and_broken_shader_are_told(self, renderer):
        from relgloss_view.picture.gpu.shader import ShaderError
        from relgloss_view.picture.gpu.targets import SPLIT

        renderer.render(Scene(materials.paper("cast")), Look(), SMALL)
        target = renderer.passes.targets.framebuffer(SPLIT)
        with pytest.raises(ShaderError, match=r"uniform '\w+' has no value"):
            renderer.programs.draw(
                "tone.frag",
                {"TRANSFER": 0, "GAMUT": 0, "SAMPLED": 0, "DITHER": 0, "SEEN_ON": 0, "REACH": 0},
                {},
                target,
            )
        with pytest.raises(ShaderError, match=r"measure\.frag:\d+.*BLOCK"):
            renderer.programs.get("measure.frag", {})
