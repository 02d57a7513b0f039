"""CIEDE2000 against colour-science and published pairs; overlays against the frame itself."""

from __future__ import annotations

import glsl
import numpy as np
import pytest

from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.picture.gpu.overlays import draw_difference, draw_overlay
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.gpu.request import Request
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Lamp

#: Sharma, Wu, Dalal 2005, table 1: pairs chosen for the formula's corners.
PUBLISHED = [
    ((50.0, 2.6772, -79.7751), (50.0, 0.0, -82.7485), 2.0425),
    ((50.0, -1.3802, -84.2814), (50.0, 0.0, -82.7485), 1.0000),
    ((50.0, 0.0, 0.0), (50.0, -1.0, 2.0), 2.3669),
    ((50.0, 2.4900, -0.0010), (50.0, -2.4900, 0.0009), 7.1792),
    ((50.0, 2.4900, -0.0010), (50.0, -2.4900, 0.0011), 7.2195),
    ((50.0, -0.0010, 2.4900), (50.0, 0.0011, -2.4900), 4.7461),
    ((50.0, 2.5, 0.0), (73.0, 25.0, -18.0), 27.1492),
    ((60.2574, -34.0099, 36.2677), (60.4626, -34.1751, 39.4387), 1.2644),
    ((90.8027, -2.0831, 1.4410), (91.1528, -1.6435, 0.0447), 1.4441),
    ((2.0776, 0.0795, -1.1350), (0.9033, -0.0636, -0.5514), 0.9082),
]


def test_published_pairs():
    first, second, expected = (np.array(v) for v in zip(*PUBLISHED, strict=True))
    np.testing.assert_allclose(delta_e_2000(first, second), expected, atol=5e-5)  # as printed


@pytest.fixture(scope="module")
def pairs():
    rng = np.random.default_rng(4)
    first = rng.uniform((0, -90, -90), (100, 90, 90), (20_000, 3))
    near = first + rng.normal(0, 3, first.shape)
    return np.concatenate([first, first]), np.concatenate([near, rng.permutation(first)])


def test_another_program(pairs):
    colour = pytest.importorskip("colour")
    expected = colour.difference.delta_E_CIE2000(*pairs)
    np.testing.assert_allclose(delta_e_2000(*pairs), expected, rtol=1e-9, atol=1e-9)


def test_shader_agrees(ctx, pairs):
    inputs = {name: p.astype(np.float32) for name, p in zip(("p", "q"), pairs, strict=True)}
    body = "result = vec4(delta_e_2000(p.xyz, q.xyz));"
    found = glsl.evaluate(ctx, ["difference.glsl"], body, inputs)[:, 0]
    expected = delta_e_2000(*(v.astype(np.float64) for v in inputs.values()))
    # Differences of numbers near 100 carry 1e-5 in float32, and the driver's atan another 1e-5 of
    # hue; where both hues stand opposite, either way round is right.
    off = np.abs(found - expected) > 2e-3 + 1e-4 * expected
    assert np.mean(off) < 1e-3


SIZE = (64, 48)
SCENE = Scene(load_sample("uncoated"), lamp=Lamp(azimuth_deg=40))
LOOK = Look(sigma_n_deg=1.0, c_fraction=1.4)  # above c_max: some pixels clip


def overlay_pixels(renderer, name, scene=SCENE, look=LOOK):
    texture = draw_overlay(renderer, scene, look, SIZE, name)
    pixels = np.frombuffer(texture.read(alignment=1), dtype=np.uint8)
    return pixels.reshape(SIZE[1], SIZE[0], 4)[::-1]


class TestOverlays:
    @pytest.mark.parametrize(
        ("name", "stage"), [("clipped", "clipped"), ("out of gamut", "out_of_gamut")]
    )
    def test_stripes_stand_exactly_on_flagged_pixels(self, renderer, name, stage):
        flagged = getattr(renderer.render(SCENE, LOOK, SIZE), stage)
        assert 0 < np.sum(flagged) < flagged.size
        pixels = overlay_pixels(renderer, name)[..., :3]
        striped = np.all((pixels == 0) | (pixels == 255), axis=-1)
        np.testing.assert_array_equal(striped, flagged)
        assert len(np.unique(pixels[flagged])) == 2
        # Stripes and dots: one can be told from the other without a colour.
        row, column = np.indices(flagged.shape)
        row = flagged.shape[0] - 1 - row  # from below, as the shader counts
        stripes = (row + column) // 4 % 2 == 0
        dots = (row % 6 < 3) & (column % 6 < 3)
        white = pixels[..., 0] == 255
        pattern, other = (stripes, dots) if name == "clipped" else (dots, stripes)
        np.testing.assert_array_equal(white[flagged], pattern[flagged])
        assert np.mean(white[flagged] != other[flagged]) > 0.2

    def test_lightness_shows_the_scaled_lightness(self, renderer):
        frame = renderer.render(SCENE, LOOK, SIZE)
        pixels = overlay_pixels(renderer, "lightness")
        model = DisplayModel.of(Display())
        lab = tone.false_colour(frame.lab[..., 0].astype(np.float64))
        expected = 255 * tone.encode(tone.display_rgb(lab, model)[0], model)
        seen = frame.on_object
        assert np.abs(pixels[seen][:, :3] - expected[seen]).max() <= 0.51 + 1e-2
        assert np.ptp(frame.lab[seen][:, 0]) > 30

    def test_diffuse_and_specular_alone(self, renderer):
        frame = renderer.render(SCENE, LOOK, SIZE)
        l_d, l_s = frame.split
        seen = frame.on_object
        model = DisplayModel.of(Display())
        lab = tone.lab_from_xyz(frame.diffuse.astype(np.float64), frame.white_xyz)
        for name, wanted in (
            ("diffuse only", lab),
            ("specular only", np.stack([frame.c * l_s, 0 * l_s, 0 * l_s], axis=-1)),
        ):
            expected = 255 * tone.encode(tone.display_rgb(wanted, model)[0], model)
            pixels = overlay_pixels(renderer, name)
            assert np.abs(pixels[seen][:, :3] - expected[seen]).max() <= 0.52, name
        assert np.max(np.abs(lab[..., 0] - l_d)[seen]) < 1e-6

    def test_normals(self, renderer):
        frame = renderer.render(SCENE, LOOK, SIZE)
        pixels = overlay_pixels(renderer, "normals")
        seen = np.linalg.norm(frame.tilted_normal, axis=-1) > 0.5
        expected = 255 * (0.5 + 0.5 * frame.tilted_normal)
        assert np.abs(pixels[seen][:, :3] - expected[seen]).max() <= 0.51

    def test_follows_c_and_is_kept_otherwise(self, renderer):
        first = overlay_pixels(renderer, "clipped").copy()
        drawn = renderer.draws["overlay"]
        overlay_pixels(renderer, "clipped")
        assert renderer.draws["overlay"] == drawn
        calm = overlay_pixels(renderer, "clipped", look=Look(sigma_n_deg=1.0, c_fraction=0.2))
        assert renderer.draws["overlay"] == drawn + 1
        assert not np.array_equal(first, calm)


class TestDifference:
    def pixels(self, texture):
        data = np.frombuffer(texture.read(alignment=1), dtype=np.uint8)
        return data.reshape(SIZE[1], SIZE[0], 4)[::-1, :, 0]

    def test_map_is_the_difference_of_what_is_shown(self, ctx, renderer):
        other = Renderer(ctx, renderer.programs)
        looks = (Look(c_fraction=0.3), Look(c_fraction=0.9))
        frames = [r.render(SCENE, k, SIZE) for r, k in zip((renderer, other), looks, strict=True)]
        model = DisplayModel.of(Display())
        labs = [
            tone.lab_from_xyz(f.light.astype(np.float64) @ model.xyz_from_rgb.T, model.white)
            for f in frames
        ]
        expected = delta_e_2000(*labs)
        top = float(np.max(expected)) * 1.01
        requests = tuple(Request(SCENE, k, SIZE) for k in looks)
        found = self.pixels(draw_difference(renderer, other, requests, top))
        light = tone.lab_f_inverse((100 * expected / top + 16) / 116)
        seen = frames[0].on_object
        np.testing.assert_allclose(found[seen], 255 * tone.srgb_encode(light[seen]), atol=1.0)
        np.testing.assert_array_equal(found[~seen], frames[0].display[~seen][:, 0])
        assert np.max(expected) > 2.0
        same = (requests[0], requests[0])
        assert np.max(self.pixels(draw_difference(renderer, other, same, top))[seen]) == 0
        other.release()
