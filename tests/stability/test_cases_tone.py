"""Cases 10 to 16, 31 and 32: lightness, c_max, gamut, at the ends of their ranges."""

from __future__ import annotations

import dataclasses

import glsl
import materials
import numpy as np
import pytest
from both import finite

from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.material.material import Lobe
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.frame import Extremes, Scaling
from relgloss_view.picture.method import Method
from relgloss_view.picture.model import light, tone
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp

SMALL = (64, 48)
WHITE = np.array([1.0168, 1.0, 0.6761])


def split(ctx, diffuse, specular):
    """(L_d*, L_s*, a*, b*) by the shader and by its twin, white of equal X, Y and Z."""
    inputs = {"d": np.asarray(diffuse, np.float32), "s": np.asarray(specular, np.float32)}
    body = "result = split_lab(d.xyz, s.xyz, vec3(1.0));"
    shader = glsl.evaluate(ctx, ["tone.glsl"], body, inputs)
    return shader, tone.split_lab(*(v.astype(np.float64) for v in inputs.values()), np.ones(3))


def mirror_scene(lobe, **options):
    """A plane whose middle pixel, of an odd picture, sees the lamp's mirror image."""
    lamp, eye = Lamp(azimuth_deg=25.0, distance_m=0.6), Eye(azimuth_deg=-25.0)
    return Scene(
        materials.flat(0.3, (lobe,)), shape=Shape(kind="plane"), lamp=lamp, eye=eye, **options
    )


def test_case_10_black_and_lit_from_behind(ctx, renderer, reference):
    """Y_d = 0 is L_d* = 0; the literal cube-root law would say -16."""
    zero = np.zeros((1, 3))
    for found in split(ctx, zero, zero):
        np.testing.assert_array_equal(found, 0.0)
    black = Scene(materials.flat(0.0, (Lobe((1.0,), 5.0),)))
    behind = Scene(materials.flat(0.5), lamp=Lamp(azimuth_deg=180.0))
    for one in (renderer, reference):
        for scene in (black, behind):
            frame = one.render(scene, Look(c=0.5), SMALL)
            assert np.min(frame.lab[..., 0]) == 0.0
            assert finite(frame.lab, frame.light)
            assert not np.any(frame.diffuse)


@pytest.mark.parametrize("white", [0.0, -1.0, np.nan, np.inf])
def test_case_11_no_white_to_be_relative_to(renderer, reference, white):
    """A Y_n that is no positive number is refused: nothing is divided by it."""
    scene = Scene(materials.flat(0.5))
    assert light.lit_white(white, scene.setup) == 0.0
    dark = dataclasses.replace(scene, lamp=Lamp(azimuth_deg=180.0))  # its Y_n is 0
    for one in (renderer, reference):
        frame = one.render(dark, Look(), SMALL)
        assert finite(frame.diffuse, frame.lab)
        assert not np.any(frame.diffuse)
        assert any("lights nothing" in text for text in frame.warnings)


@pytest.mark.parametrize("root", ["householder", "power", "table"])
def test_case_12_no_step_where_the_branches_of_lightness_meet(ctx, root):
    """L* never falls, and no step is larger than the slope and float32 make it.

    The slope at 216/24389 is 903.3; L* carries 116 times the error of a root of 0.207, which is
    held to these shares elsewhere (tests/material/test_approximations.py).
    """
    from relgloss_view.picture.gpu.constants import code
    from relgloss_view.picture.gpu.targets import Targets

    y = (tone.LAB_EPSILON * np.linspace(0.999, 1.001, 4001)).astype(np.float32)
    shader = glsl.evaluate(
        ctx,
        ["tone.glsl"],
        "result = vec4(lightness(y.x));",
        {"y": y},
        defines={"CUBE_ROOT": code("CUBE_ROOT", root)},
        samplers={"cube_root_table": Targets(ctx).cube_root_table()},
    )[:, 0].astype(np.float64)
    share = {"householder": 4.5e-7, "power": 3e-6, "table": 3e-6}[root]
    error = 116.0 * 0.207 * share + 1e-6
    smooth = 904.0 * np.max(np.diff(y.astype(np.float64)))
    assert np.min(np.diff(shader)) > -error
    assert np.max(np.diff(shader)) < smooth + error
    twin = tone.lightness(y.astype(np.float64))
    assert np.min(np.diff(twin)) >= 0.0
    assert np.max(np.diff(twin)) < 1.001 * smooth
    np.testing.assert_allclose(shader, twin, atol=error)


def test_case_13_nothing_specular(ctx, renderer, reference):
    """c_max has no value, c is 1, and nothing is infinite."""
    d = np.array([[0.2, 0.3, 0.1]])
    for found in split(ctx, d, np.zeros((1, 3))):
        assert abs(found[0, 1]) < 1e-5
    ratio = glsl.evaluate(
        ctx, ["tone.glsl"], "result = vec4(largest_c(v.xy));", {"v": np.array([[50.0, 0.0]])}
    )
    assert ratio[0, 0] == np.float32(tone.largest_c(np.array(50.0), np.array(0.0)))
    for one in (renderer, reference):
        frame = one.render(Scene(materials.flat(0.5)), Look(c_fraction=0.5), SMALL)
        assert (frame.c, frame.c_max) == (1.0, None)
        assert finite(frame.lab, frame.light)


def test_case_14_c_max_above_one(renderer, reference):
    """It is flagged, and c = c_max keeps L~* at or below 100 everywhere."""
    scene = Scene(materials.paper("uncoated"))
    for one in (renderer, reference):
        frame = one.render(scene, Look(), SMALL)
        assert frame.c_max > 1.0
        assert any("above 1" in text for text in frame.warnings)
        assert 99.9 < np.max(frame.lab[..., 0]) <= 100.0 + 1e-4
        assert frame.clip_count == 0
        # Negative control: a little more is too much, and said to be.
        above = one.render(scene, Look(c=1.02 * frame.c_max), SMALL)
        assert above.clip_count > 0
        assert any("clipped" in text for text in above.warnings)


def test_case_15_brighter_than_the_white(renderer, reference):
    """L_d* above 100, as from a wrong Y_n: no negative c, but an error; a given c draws it."""
    scene = Scene(materials.flat(1.3, (Lobe((1.0,), 5.0),)))
    for one in (renderer, reference):
        with pytest.raises(InputError, match="diffuse part alone reaches"):
            one.render(scene, Look(), SMALL)
        frame = one.render(scene, Look(c=0.5), SMALL)
        assert frame.c_max is None
        assert frame.clip_count > 0
    with pytest.raises(InputError, match="L\\* = 103"):
        Scaling.of(Look(), Extremes(-0.1, 103.0, 50.0, 103.0, 50.0))


def test_case_16_a_peak_of_1e5(renderer, reference):
    """Whole numbers of 32 bits hold it; targets of 16 bits refuse it by name."""
    scene = mirror_scene(Lobe((60.0,), 0.1))
    size = (65, 65)
    for one in (renderer, reference):
        frame = one.render(scene, Look(), size)
        assert np.max(frame.specular[..., 1]) > 1e5
        assert finite(frame.specular, frame.lab, frame.light)
        assert frame.c_max > 0.0
    with pytest.raises(InputError, match="float16"):
        renderer.render(scene, Look(), size, Method(targets="float16"))
    # Negative control: what 16 bits hold, they draw.
    dull = mirror_scene(Lobe((1.0,), 2.0))
    halves = renderer.render(dull, Look(), size, Method(targets="float16")).lab.copy()
    # L* is kept as a number of 11 bits (0.03 at 100), and a*, b* as well.
    np.testing.assert_allclose(halves, renderer.render(dull, Look(), size).lab, atol=0.1)


def test_case_31_lab_there_and_back(ctx):
    """XYZ from 1e-5 to 1000 times the white, and below zero: within 1e-5."""
    rng = np.random.default_rng(3)
    t = np.concatenate([10.0 ** rng.uniform(-5, 3, (5000, 3)), -0.05 * rng.uniform(0, 1, (500, 3))])
    xyz = np.concatenate([t, np.full((1, 3), 1000.0)]) * WHITE
    twin = tone.xyz_from_lab(tone.lab_from_xyz(xyz, WHITE), WHITE)
    np.testing.assert_allclose(twin, xyz, rtol=1e-5, atol=1e-12)
    white = f"vec3({', '.join(map(repr, WHITE.tolist()))})"
    body = f"result = vec4(xyz_from_lab(lab_from_xyz(v.xyz, {white}), {white}), 0);"
    back = glsl.evaluate(ctx, ["tone.glsl"], body, {"v": xyz})[:, :3]
    # a* and b* are differences: f carries 2e-7 of the larger root, up to 10, and X = f^3 has the
    # slope 3 f^2; below 216/24389 it is 0.13.
    f = np.cbrt(np.maximum(np.abs(xyz / WHITE), tone.LAB_EPSILON))
    bound = 3.0 * f**2 * 4e-7 * np.max(f, axis=-1, keepdims=True) * WHITE
    assert np.max(np.abs(back - xyz) / bound) < 1.0
    alike = np.ptp(f, axis=-1) < 0.1 * np.max(f, axis=-1)  # where no root dwarfs another
    assert np.sum(alike) > 20
    # f stands on 16/116, so that the very dark are good to 6e-8 of that through the slope 0.13.
    np.testing.assert_allclose(back[alike], xyz[alike], rtol=1e-5, atol=2e-7)


def test_case_32_green_out_of_gamut(ctx, renderer):
    """Hue held within a degree and L* within 0.05; such pixels are counted."""
    display = DisplayModel.of(Display())
    lab = np.array([[level, -110.0, 60.0] for level in np.linspace(20.0, 90.0, 15)])
    rows = ", ".join(map(repr, display.rgb_from_xyz.T.ravel().tolist()))
    white = ", ".join(map(repr, display.white.tolist()))
    body = (
        f"bool inside; vec3 rgb = display_rgb(GAMUT_CHROMA, v.xyz, vec3({white}), "
        f"mat3({rows}), inside);"
        "result = vec4(rgb, inside ? 1.0 : 0.0);"
    )
    shader = glsl.evaluate(ctx, ["tone.glsl"], body, {"v": lab}).astype(np.float64)
    twin, inside = tone.display_rgb(lab, display)
    assert not np.any(inside)
    assert not np.any(shader[:, 3])
    for shown in (shader[:, :3], twin):
        back = tone.lab_from_xyz(shown @ display.xyz_from_rgb.T, display.white)
        np.testing.assert_allclose(back[:, 0], lab[:, 0], atol=0.05)
        turned = np.arctan2(back[:, 2], back[:, 1]) - np.arctan2(60.0, -110.0)
        assert np.max(np.abs(np.degrees(turned))) < 1.0
    # The picture counts what it changes.
    flat = materials.flat()
    green = dataclasses.replace(flat.diffuse, albedo=(0.0, 0.9, 0.0))
    material = dataclasses.replace(flat, bands=type(flat.bands)(), diffuse=green)
    narrow = Display(primaries_xy=((0.5, 0.35), (0.32, 0.5), (0.2, 0.15)))
    frame = renderer.render(Scene(material, display=narrow), Look(c=1.0), SMALL)
    assert frame.out_of_gamut_count == np.sum(frame.out_of_gamut) > 100
    wide = Display(primaries_xy=((0.7, 0.29), (0.17, 0.8), (0.13, 0.05)))
    frame = renderer.render(Scene(material, display=wide), Look(c=1.0), SMALL)
    assert frame.out_of_gamut_count == 0


class TestFoundHere:
    """Cases that the list does not have."""

    def test_tone_stage_from_nothing_to_far_too_much(self, ctx):
        """Y from 0 and 1e-38 to 1e30: finite L*, light within 0 to 1."""
        y = np.concatenate([[0.0, 1e-38, 1e-30], 10.0 ** np.arange(-12.0, 31.0)])
        d, s = (v.ravel() for v in np.meshgrid(y, y))
        colour = np.array([0.9, 1.0, 0.4])
        d, s = d[:, None] * colour, s[:, None] * colour
        shader, _ = split(ctx, d, s)
        assert finite(shader)
        body = (
            "bool inside; vec4 v = split_lab(d.xyz, s.xyz, vec3(1.0)); vec3 rgb = display_rgb("
            "GAMUT_CHROMA, scaled_lab(v, c), vec3(0.95, 1.0, 1.09), mat3(3.24, -0.97, 0.06, -1.54,"
            " 1.88, -0.2, -0.5, 0.04, 1.06), inside);"
            "result = vec4(encode(TRANSFER_SRGB, rgb, vec4(1)), 1);"
        )
        for c in ("0.0", "1.0", "1e4"):
            shown = glsl.evaluate(
                ctx, ["tone.glsl"], body.replace("v, c)", f"v, {c})"), {"d": d, "s": s}
            )
            assert finite(shown)
            assert np.min(shown) >= 0.0
            # The curve's polynomial is within 1.4e-6 of full scale.
            assert np.max(shown) <= 1.0 + 2e-6

    @pytest.mark.parametrize("size", [(1, 1), (1, 7), (9, 1), (16, 1), (17, 17)])
    def test_tiny_pictures(self, renderer, reference, size):
        """A pixel or a row: every stage is there, c_max is that of the pixels there are."""
        for scene in (Scene(materials.paper("matte")), Scene(materials.flat(0.5))):
            for look in (Look(), Look(sigma_n_deg=3.0, samples=3)):
                frames = [one.render(scene, look, size) for one in (renderer, reference)]
                for frame in frames:
                    assert frame.display.shape == (size[1], size[0], 3)
                    assert finite(frame.lab, frame.light, frame.normal)
                shown = [frame.display.astype(int) for frame in frames]
                assert np.max(np.abs(shown[0] - shown[1])) <= 1

    @pytest.mark.parametrize("size", [(0, 1), (16_385, 1), (1, 16_385), (8192, 8192)])
    def test_sizes_over_the_limits(self, renderer, reference, size):
        for one in (renderer, reference):
            with pytest.raises(InputError, match="size"):
                one.render(Scene(materials.flat()), Look(), size)

    def test_negative_weights_of_a_lamp(self, renderer, reference):
        """A narrow band under a lamp of lines: the cubic's Y is negative, the picture's is not."""
        paper = materials.flat(0.0)
        albedo = [0.0] * paper.bands.count
        albedo[paper.bands.wavelengths_nm.index(530.0)] = 0.9
        dark = dataclasses.replace(paper.diffuse, albedo=tuple(albedo))
        scene = Scene(dataclasses.replace(paper, diffuse=dark), lamp=Lamp(illuminant="FL11"))
        cubic = np.array(albedo) @ xyz_weights(paper.bands, illuminant("FL11"))
        assert np.min(cubic) < 0.0
        for one in (renderer, reference):
            frame = one.render(scene, Look(c=0.0), SMALL)
            assert np.min(frame.diffuse) >= 0.0
            assert np.max(frame.diffuse[..., 0]) > 0.0
            assert finite(frame.lab, frame.light)
            assert np.min(frame.light) >= 0.0
