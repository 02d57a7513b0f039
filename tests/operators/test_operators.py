"""The common ground of all operators: the registry, edges, gamut, what must never happen."""

from __future__ import annotations

import dataclasses
import subprocess
import sys

import numpy as np
import pytest
from lights import HP5_WHITE, Y_N, gray, scene_light
from materials import paper
from pictures import assert_same_pixels

from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.operators.clip import Clip
from relgloss_view.operators.operator import SceneLight
from relgloss_view.operators.registry import DEFAULT_OPERATOR, OPERATORS, make_operator
from relgloss_view.picture.model import tone
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye

LIGHT_OPERATORS = [name for name in OPERATORS if name != "split"]


@pytest.fixture(scope="module")
def frame(reference):
    """A glossy green cylinder whose highlight is far above white, at c = 1."""
    return reference.render(Scene(paper("art")), Look(c=1.0), (48, 40))


class TestRegistry:
    def test_each_says_what_it_is(self):
        assert DEFAULT_OPERATOR == next(iter(OPERATORS)) == "split"
        for name, kind in OPERATORS.items():
            assert kind.name == name
            assert kind.title
            assert kind.meaning
            assert kind.source
            for field in dataclasses.fields(kind):
                assert {"range", "options", "switch"} & set(field.metadata), field.name

    def test_parameters_are_taken_and_checked(self):
        assert make_operator("multiscale", {"local": 0.25}).local == 0.25
        with pytest.raises(InputError, match=r"multiscale\.local: expected 0 to 1, found 2"):
            make_operator("multiscale", {"local": 2})
        with pytest.raises(InputError, match="operator: expected one of split, clip"):
            make_operator("reinhard")
        with pytest.raises(InputError, match="operator clip: expected a parameter of cut"):
            make_operator("clip", {"c": 1})

    def test_importing_them_is_light(self):
        code = "import relgloss_view.operators.registry, relgloss_view.gloss.shown, sys; "
        code += "print('scipy' in sys.modules)"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        assert done.stdout.strip() == "False"


class TestColorimetric:
    def test_clip_is_the_split_at_c_1(self, frame):
        # L_d + 1 L_s is L* of the sum: two ways to one picture, the frame's by another program.
        picture = Clip().draw(frame)
        assert frame.clip_count > 10
        np.testing.assert_allclose(picture.light, frame.light, atol=1e-12)
        np.testing.assert_array_equal(picture.clipped, frame.clipped)
        np.testing.assert_array_equal(picture.out_of_gamut, frame.out_of_gamut)
        assert_same_pixels(picture.digital, frame.display)

    def test_negative_control(self, reference, frame):
        other = reference.render(frame.scene, Look(c=0.8), frame.size)
        assert np.max(np.abs(Clip().draw(frame).light - other.light)) > 0.05

    def test_cutting_rgb_is_what_it_says(self, frame):
        # Colours in the gamut are the same; a bright colour keeps what each channel holds.
        whole, cut = Clip().draw(frame), Clip(cut="rgb").draw(frame)
        plain = ~(whole.clipped | whole.out_of_gamut | cut.clipped | cut.out_of_gamut)
        assert np.sum(plain & frame.on_object) > 200
        np.testing.assert_allclose(cut.light[plain], whole.light[plain], atol=1e-12)
        bright = scene_light([[2.0 * np.array([0.5, 1.0, 0.3]) * Y_N]], white=np.ones(3))
        rgb = bright.display_xyz[0, 0] / Y_N @ bright.display.rgb_from_xyz.T
        shown = Clip(cut="rgb").apply(bright)
        np.testing.assert_allclose(shown.light[0, 0], np.clip(rgb, 0, 1))
        assert shown.clip_count == 1
        np.testing.assert_allclose(Clip().apply(bright).light[0, 0], 1.0, atol=5e-4)  # white

    def test_split_takes_the_frame_s_picture(self, frame):
        picture = make_operator("split").draw(frame)
        assert_same_pixels(picture.digital, frame.display)
        np.testing.assert_array_equal(picture.light, frame.light)
        assert picture.clip_count == frame.clip_count
        assert picture.warnings == frame.warnings


class TestEvery:
    @pytest.mark.parametrize("name", LIGHT_OPERATORS)
    def test_the_surround_is_the_display_s(self, name):
        light = gray(np.full((20, 20), 40.0))
        coverage = np.zeros((20, 20))
        coverage[5:15, 5:15] = 1.0
        coverage[5, 5:15] = 0.25
        whole = make_operator(name).apply(dataclasses.replace(light, coverage=coverage))
        surround = whole.display.background_light
        assert np.all(whole.light[coverage == 0.0] == surround)
        # A constant field, so the pixel below is what an edge pixel shows of the object itself.
        if name != "multiscale":  # which sees the surround too
            mixed = 0.25 * whole.light[6, 10] + 0.75 * surround
            np.testing.assert_allclose(whole.light[5, 10], mixed, atol=1e-12)
        assert whole.digital[0, 0, 0] == round(255 * float(tone.encode(surround, whole.display)))

    @pytest.mark.parametrize("name", LIGHT_OPERATORS)
    def test_neutral_light_stays_neutral(self, name):
        # The lamp's white is yellowish (HP5); its gray is the display's gray, at any level.
        light = gray(np.linspace(1.0, 300.0, 64).reshape(8, 8))
        shown = make_operator(name).apply(light).lab
        # The cones' gains differ a little between blue and red; all else keeps ratios exactly.
        limit = 1.0 if name == "multiscale" else 0.05
        assert np.max(np.abs(shown[..., 1:])) < limit

    @pytest.mark.parametrize("name", LIGHT_OPERATORS)
    @pytest.mark.parametrize("shape", [(1, 1), (1, 7), (5, 1), (33, 57)])
    @pytest.mark.parametrize("kind", ["black", "hot", "off", "dim", "steep"])
    def test_always_finite(self, name, shape, kind):
        luminance = np.zeros(shape)
        coverage = np.zeros(shape) if kind == "off" else np.ones(shape)
        if kind == "hot":
            luminance[shape[0] // 2, shape[1] // 2] = 1e5
        elif kind == "dim":
            luminance += 1e-30
        elif kind == "steep":
            luminance += np.geomspace(1e-6, 1e7, luminance.size).reshape(shape)
        picture = make_operator(name).apply(gray(luminance, coverage=coverage))
        assert np.all(np.isfinite(picture.light))
        assert np.all((picture.light >= 0.0) & (picture.light <= 1.0))
        if kind == "black":
            # A pinch of light gets to black from nowhere but a picture that has some.
            assert np.all(picture.light < 1e-9)

    @pytest.mark.parametrize("name", LIGHT_OPERATORS)
    def test_more_light_is_never_shown_darker(self, name):
        # Wide steps of two luminances: nothing to adapt to differently within a step. The order
        # must hold for each operator, though how far apart they are shown may not.
        light = gray(np.repeat([[20.0, 60.0]], 64, axis=0).repeat(64, axis=1))
        shown = make_operator(name).apply(light).lab[..., 0]
        assert shown[32, 96] > shown[32, 32] + 2.0

    @pytest.mark.parametrize("transfer", ["srgb", "gain-offset-gamma"])
    def test_another_display_is_drawn_for(self, transfer):
        display = Display(
            transfer=transfer, primaries_xy=((0.68, 0.32), (0.265, 0.69), (0.15, 0.06))
        )
        light = scene_light(np.full((4, 4, 3), 30.0), display=display)
        picture = make_operator("clip").apply(light)
        lab = tone.lab_from_xyz(light.xyz_cd_m2 / Y_N, HP5_WHITE)
        np.testing.assert_allclose(picture.lab, lab, atol=1e-9)


class TestSceneLight:
    def test_numbers_of_a_frame(self, frame):
        light = SceneLight.of(frame)
        total = (frame.diffuse[..., 1] + frame.specular[..., 1]) * 110.0
        np.testing.assert_allclose(light.luminance, total)
        np.testing.assert_allclose(light.display_xyz[..., 1], total)
        # 40 pixels hold twice the tangent of half the angle of view.
        eye = Eye(field_of_view_deg=20.0)
        scene = dataclasses.replace(frame.scene, eye=eye)
        drawn = SceneLight.of(type(frame)(scene, *_rest(frame)))
        step = 2.0 * np.tan(np.radians(10.0)) / 40.0
        assert drawn.pixels_per_degree == pytest.approx(1.0 / np.degrees(step), rel=1e-4)

    def test_adaptation_is_the_log_mean_of_what_is_lit(self):
        coverage = np.array([[1.0, 1.0, 0.0, 1.0]])
        light = gray([[10.0, 1000.0, 5.0, 0.0]], coverage=coverage)
        assert light.adaptation_cd_m2 == pytest.approx(100.0)
        assert gray([[0.0]]).adaptation_cd_m2 == 0.0


def _rest(frame):
    return frame.look, frame.size, frame.scaling, frame._fetch, frame.device
