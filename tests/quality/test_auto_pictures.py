"""Quality "auto": split in pass 1, in half floats where these do, XYZ in float32 all the same."""

from __future__ import annotations

import dataclasses

import materials
import numpy as np
import pytest
from splits import IN_PASS_1, SIZE, internal_format, scene_of

from relgloss_view.base.errors import InputError
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.gpu.targets import XYZ
from relgloss_view.picture.method import EXACT, FIRST_PASS
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Lamp


class TestQualityAuto:
    AUTO = Look(sigma_n_deg=1.0, c_fraction=0.5, quality="auto")

    @pytest.mark.parametrize("sample", list(SAMPLES))
    def test_it_splits_in_pass_1_in_half_floats(self, renderer, sample):
        frame = renderer.render(scene_of(material=load_sample(sample)), self.AUTO, SIZE)
        assert frame.method.split == FIRST_PASS
        assert renderer.draws["split"] == 0
        assert renderer.draws["shade"] == 1
        half = frame.method.targets == "float16"
        assert internal_format(renderer, "split") == ("RGBA16F" if half else "RGBA32F")

    def test_half_floats_are_taken_for_some_sample(self, renderer):
        """Negative control of the test above: where none took them, it would show nothing."""
        scenes = [scene_of(material=load_sample(sample)) for sample in SAMPLES]
        numbers = {renderer.choose(scene, self.AUTO, SIZE).targets for scene in scenes}
        assert "float16" in numbers

    @pytest.mark.parametrize("sample", list(SAMPLES))
    def test_xyz_is_never_of_half_floats(self, renderer, sample):
        scene = scene_of(material=load_sample(sample))
        method = dataclasses.replace(
            renderer.choose(scene, self.AUTO, SIZE), targets="float16", split=FIRST_PASS
        )
        frame = renderer.render(scene, self.AUTO, SIZE, method)
        rounded = frame._fetch("split")
        np.testing.assert_array_equal(rounded, rounded.astype(np.float16))
        whole = renderer.render(
            scene, self.AUTO, SIZE, dataclasses.replace(method, targets="float32")
        )
        wanted = {name: getattr(whole, name).copy() for name in XYZ}
        frame = renderer.render(scene, self.AUTO, SIZE, method)
        for name, values in wanted.items():
            got = getattr(frame, name)
            assert got.dtype == np.float32
            np.testing.assert_array_equal(got, values)
            lit = values[values > 0.0]
            assert np.mean(lit != lit.astype(np.float16)) > 0.5

    @pytest.mark.parametrize("c", [None, 0.001])
    @pytest.mark.parametrize("brightest", [1e3, 4e4, 5e4, 1e5, 1e7])
    def test_a_very_bright_highlight_is_drawn(self, renderer, reference, brightest, c):
        """Half floats are refused above a Y of some 43,700: float32 takes over before that."""
        scene = bright(reference, brightest)
        look = Look(c=c, quality="auto")
        frame = renderer.render(scene, look, SIZE)
        assert np.max(frame.specular[..., 1]) == pytest.approx(brightest, rel=0.1)
        assert frame.method.targets == ("float16" if brightest <= 4e4 else "float32")
        method = frame.method
        shown = frame.display.astype(int)
        exact = renderer.render(scene, dataclasses.replace(look, quality="exact"), SIZE)
        assert np.percentile(np.abs(shown - exact.display), 99) <= 2
        if brightest > 4.4e4:  # drawn in half floats nevertheless, it would be refused
            half = dataclasses.replace(method, targets="float16")
            with pytest.raises(InputError, match="targets float16"):
                renderer.render(scene, look, SIZE, half)

    @pytest.mark.parametrize("s_deg", [0.05, 2.5])
    def test_the_strongest_lobe_is_drawn(self, renderer, s_deg):
        frame = renderer.render(sheet(1e6, s_deg), Look(quality="auto"), SIZE)
        assert frame.method.targets == "float32"
        assert np.max(frame.specular) > 1e6
        assert np.all(np.isfinite(frame.lab))

    def test_a_renderer_without_a_chooser_draws_everything(self, ctx):
        plain = Renderer(ctx)
        scene = scene_of()
        auto = plain.render(scene, self.AUTO, SIZE)
        assert auto.method == EXACT
        stages = ("diffuse", "specular", "lab", "display")
        got = {name: getattr(auto, name).copy() for name in stages}
        exact = Renderer(ctx).render(scene, dataclasses.replace(self.AUTO, quality="exact"), SIZE)
        for name, values in got.items():
            np.testing.assert_array_equal(values, getattr(exact, name))
        plain.release()

    def test_a_chooser_is_asked_for_every_picture(self, ctx):
        asked = []

        def choose(scene, look, size):
            asked.append((scene, look, size))
            return IN_PASS_1

        renderer = Renderer(ctx, choose=choose)
        scene = scene_of()
        assert renderer.render(scene, self.AUTO, SIZE).method == IN_PASS_1
        assert asked == [(scene, self.AUTO, SIZE)]
        assert renderer.render(scene, self.AUTO, SIZE, EXACT).method == EXACT
        assert len(asked) == 1
        renderer.release()


def sheet(strength, s_deg):
    """A sheet of one lobe that mirrors the lamp into the eye."""
    paper = materials.paper("art")
    lobe = dataclasses.replace(paper.specular[0], strength=(strength,), s_deg=s_deg)
    return Scene(
        dataclasses.replace(paper, specular=(lobe,)),
        shape=Shape("plane"),
        lamp=Lamp(azimuth_deg=0.0, distance_m=1.0),
    )


def bright(reference, brightest):
    """A sheet whose highlight's largest Y is a number, by the strength of its lobe."""
    s_deg = 2.5 if brightest < 1e7 else 0.5
    one = reference.render(sheet(1.0, s_deg), Look(c=0.1, samples=1), SIZE)
    return sheet(brightest / np.max(one.specular[..., 1]), s_deg)
