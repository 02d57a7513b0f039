"""Cases 17 to 24, 36 and 37: grain, hashes, sampling, other drivers, lamp and eye out of place."""

from __future__ import annotations

import dataclasses
import os
import subprocess
import sys

import glsl
import materials
import numpy as np
import pytest
from both import finite

from relgloss_view.material.material import Lobe
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.model import noise, shape
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp

SMALL = (64, 48)
Z = np.array([0.0, 0.0, 1.0])


def cells(side):
    y, x = np.mgrid[0:side, 0:side]
    return np.stack([x.ravel(), y.ravel(), np.zeros(side * side, dtype=int)], axis=-1)


def hashes(count, seed=1):
    return noise.cell_hash(np.random.default_rng(seed).integers(-9999, 9999, (count, 3)), 0)


def shader_hash(ctx, cell, seed):
    inputs = {"cell": np.asarray(cell, dtype=np.int64).astype(np.uint32)}
    body = f"result = uvec4(cell_hash(ivec3(cell.xyz), {seed}u), 0u);"
    return glsl.evaluate(ctx, ["noise.glsl"], body, inputs, integers=True)[:, :3]


@pytest.mark.parametrize("law", ["paper", "tangent"])
def test_case_17_no_grain_is_the_smooth_picture(ctx, renderer, reference, law):
    """sigma_N = 0: the normal itself, bit for bit, and so the picture."""
    rng = np.random.default_rng(4)
    n = rng.normal(size=(5000, 3))
    n = (n / np.linalg.norm(n, axis=-1, keepdims=True)).astype(np.float32)
    words = hashes(len(n))
    body = f"result = vec4(noisy_normal(NOISE_{law.upper()}, n.xyz, vec3(0, 0, 1), h.xyz, 0.0), 0);"
    shader = glsl.evaluate(ctx, ["noise.glsl"], body, {"n": n, "h": words})[:, :3]
    np.testing.assert_array_equal(shader, n)
    np.testing.assert_array_equal(noise.noisy_normal(law, n, Z, words, 0.0), n)
    scene = Scene(materials.paper("matte"))
    for one in (renderer, reference):
        smooth = one.render(scene, Look(), SMALL).diffuse.copy()
        other = one.render(scene, Look(noise_law=law, seed=7, grain_px=3), SMALL)
        np.testing.assert_array_equal(other.diffuse, smooth)
        # Negative control: the least grain that shows is another picture.
        grainy = one.render(scene, Look(noise_law=law, sigma_n_deg=0.1), SMALL)
        assert np.any(grainy.diffuse != smooth)


@pytest.mark.parametrize("sigma_n_deg", [3.0, 10.0])
def test_case_18_no_specks_at_the_silhouette(ctx, renderer, reference, sigma_n_deg):
    """A grain that would face away is not black: near the silhouette all that is lit stays lit."""
    scene = Scene(materials.flat(0.5), lamp=Lamp(azimuth_deg=20.0))
    for one in (renderer, reference):
        frame = one.render(scene, Look(sigma_n_deg=sigma_n_deg), (160, 120))
        i = scene.lamp.position_m - frame.point_m
        i = i / np.linalg.norm(i, axis=-1, keepdims=True)
        mu_i = np.sum(frame.tilted_normal * i, axis=-1)
        lit = frame.on_object & (mu_i > 0.05)
        assert np.sum(lit) > 3000
        assert finite(frame.diffuse, frame.lab)
        # rho 0.5 times cos_i over at most 1.1^2 of falloff, relative to Y_n.
        assert np.min(frame.diffuse[..., 1][lit]) > 0.5 * 0.05 / 1.3
    rng = np.random.default_rng(2)
    mu = 10.0 ** rng.uniform(-7, -1, 20_000)
    o = np.stack([np.sqrt(1.0 - mu**2), 0.0 * mu, mu], axis=-1).astype(np.float32)
    sigma = float(np.radians(sigma_n_deg))
    body = f"result = vec4(noisy_normal(NOISE_PAPER, vec3(0, 0, 1), o.xyz, h.xyz, {sigma!r}), 0);"
    words = hashes(len(mu))
    tilted = glsl.evaluate(ctx, ["noise.glsl"], body, {"o": o, "h": words})[:, :3]
    assert np.min(np.sum(tilted.astype(np.float64) * o, axis=-1)) > -1e-6
    twin = noise.noisy_normal("paper", np.tile(Z, (len(mu), 1)), o.astype(float), words, sigma)
    assert np.min(np.sum(twin * o, axis=-1)) > 0.0


def test_case_19_extreme_hashes(ctx):
    """0 and 0xffffffff give finite Gaussians, at most 5.77."""
    words = np.array([0, 0xFFFFFFFF], dtype=np.uint32)
    h = np.stack(np.meshgrid(words, words, words), axis=-1).reshape(-1, 3)
    twin = noise.gaussians(noise.uniforms(h)[:, :2])
    body = "result = vec4(gaussians(uniforms(h.xyz).xy), 0, 0);"
    shader = glsl.evaluate(ctx, ["noise.glsl"], body, {"h": h})[:, :2]
    for found in (shader, twin):
        assert finite(found)
        assert np.max(np.abs(found)) <= 5.77
    # log near 1 is good to 2^-21 absolute in the language's tables, and the radius to its root.
    np.testing.assert_allclose(shader, twin, atol=2e-3)


def test_case_20_cells_beyond_2_to_24_and_below_zero(ctx):
    """None repeats: float32 would run out of whole numbers at 2^24."""
    big = 2**24
    x = np.concatenate([np.arange(-500, 500), big + np.arange(1000), -big - np.arange(1000)])
    cell = np.stack(np.meshgrid(x, np.arange(-3, 3), indexing="ij"), axis=-1).reshape(-1, 2)
    cell = np.concatenate([cell, np.zeros((len(cell), 1), dtype=int)], axis=1)
    shader, twin = shader_hash(ctx, cell, 5), noise.cell_hash(cell, 5)
    np.testing.assert_array_equal(shader, twin)
    assert len(np.unique(twin, axis=0)) == len(cell)
    # Negative control: through float32 they do repeat.
    rounded = cell.astype(np.float32).astype(np.int64)
    assert len(np.unique(noise.cell_hash(rounded, 5), axis=0)) < len(cell)


def test_case_21_one_grain_a_cell_whatever_the_window(ctx, renderer, reference):
    """Resized, or drawn as a tile of a larger picture: the same cell shows the same grain."""
    half = np.array([0.0425, 0.05, 0.0425])
    rng = np.random.default_rng(1)
    ray = rng.uniform(-0.9, 0.9, (4000, 3)) * half - (0.0, 0.0, 0.6)
    hit = shape.meet("cylinder", np.array([0.0, 0.0, 0.6]), ray, half)
    twin = shape.surface_cell("cylinder", hit, 1e-3, half)
    halves = ", ".join(map(repr, half.tolist()))
    body = (
        f"Hit hit = meet(SHAPE_CYLINDER, vec3(0, 0, 0.6), ray.xyz, vec3({halves}));"
        f"result = uvec4(surface_cell(SHAPE_CYLINDER, hit, 1e-3, vec3({halves})), 0);"
    )
    shader = glsl.evaluate(ctx, ["shape.glsl"], body, {"ray": ray}, integers=True)
    same = np.all(shader[:, :3].view(np.int32) == twin, axis=-1)[hit.found]
    assert np.mean(same) > 0.999  # a border may fall to the other side
    # A plane that faces the eye; the eye's shift slides the picture: a tile of the whole.
    scene = Scene(
        materials.paper("matte"),
        shape=Shape(kind="plane"),
        eye=Eye(field_of_view_deg=12.0),
    )
    look = Look(sigma_n_deg=2.0, grain="surface", grain_mm=8.0)
    aside = dataclasses.replace(scene.eye, shift_right=0.03, shift_up=-0.02)
    for one in (renderer, reference):
        grains = []
        for eye, size in ((scene.eye, (80, 80)), (scene.eye, (113, 97)), (aside, (80, 80))):
            frame = one.render(dataclasses.replace(scene, eye=eye), look, size)
            on = frame.on_object
            cell = np.floor(frame.point_m[on][:, :2] / 8e-3).astype(int)
            tilt = np.round(frame.tilted_normal[on], 5)
            grains.append(dict(zip(map(tuple, cell), map(tuple, tilt), strict=True)))
        for other in grains[1:]:
            shared = set(grains[0]) & set(other)
            assert len(shared) > 30
            # A pixel on a border of float32 and float64 may show its neighbour.
            assert np.mean([grains[0][c] == other[c] for c in shared]) > 0.97


MEAN_BODY = """
    vec2 angles = tilt_angles({law}, cell_hash(ivec3(cell.xyz), 7u), {sigma!r});
    vec3 e = tilted(vec3(0.0, 0.0, 1.0), angles) - vec3(sin({delta!r}), 0.0, cos({delta!r}));
    result = vec4(facet_density(squared_angle(dot(e, e)), {sharpness!r}, 1.0));
"""


@pytest.mark.parametrize("ratio", [0.2, 1.0, 5.0])
@pytest.mark.parametrize("steps", [0.0, 1.0, 3.0])
def test_case_22_mean_of_the_grain(ctx, ratio, steps):
    """A quarter of a million grains against the closed form: 4 standard errors and 1.5 %."""
    sigma = float(np.radians(2.0))
    s, delta = ratio * sigma, steps * ratio * sigma
    expected = noise.mean_lobe(np.array(delta), s, sigma)
    body = MEAN_BODY.format(law="NOISE_PAPER", sigma=sigma, delta=delta, sharpness=0.5 / s**2)
    cell = cells(512)
    inputs = {"cell": cell.astype(np.uint32)}
    shader = glsl.evaluate(ctx, ["brdf.glsl", "noise.glsl"], body, inputs)[:, 0].astype(float)
    tilted = noise.tilted(
        np.tile(Z, (len(cell), 1)), noise.tilt_angles("paper", noise.cell_hash(cell, 7), sigma)
    )
    away = 2.0 * np.arcsin(
        0.5 * np.linalg.norm(tilted - [np.sin(delta), 0.0, np.cos(delta)], axis=-1)
    )
    twin = np.exp(-np.minimum(0.5 * np.square(away / s), 500.0))
    for values in (shader, twin):
        error = np.std(values) / np.sqrt(len(values))
        assert abs(np.mean(values) - expected) <= 4.0 * error + 0.015 * expected
    # Negative control: the other law's mean is far outside, but for grain that hardly matters.
    other = noise.mean_lobe(np.array(delta), s, sigma, "tangent")
    if ratio < 5.0 and steps < 3.0:
        assert abs(other - expected) > 4.0 * error + 0.015 * expected


def test_case_23_zooming_out_keeps_the_highlights_energy(renderer, reference):
    """Pixels 16 times larger, 8 x 8 samples each: the mean specular light within 2 %."""
    scene = Scene(materials.paper("matte"))
    look = Look(sigma_n_deg=1.0, grain="surface", grain_mm=1.0, c=0.3)
    large = renderer.render(scene, look, (640, 640))
    energy = np.mean(large.specular[..., 1] * large.coverage)
    for one in (renderer, reference):
        small = one.render(scene, dataclasses.replace(look, samples=8), (40, 40))
        found = np.mean(small.specular[..., 1] * small.coverage)
        assert found == pytest.approx(energy, rel=0.02)


def test_case_24_lobe_under_one_pixel(renderer, reference):
    """As many samples as it needs keep its energy within 2 %, wherever pixels fall: no flicker."""
    scene = Scene(materials.flat(0.0, (Lobe((1.0,), 0.4),)))
    size = (48, 48)
    fine = renderer.render(scene, Look(c=0.1, samples=16), (480, 480))
    energy = np.mean(fine.specular[..., 1] * fine.coverage)
    step = 0.17 / 48  # a pixel is some 0.0037 wide, as a tangent
    found, single = [], []
    for k in range(6):
        eye = dataclasses.replace(scene.eye, shift_right=k * step / 6.0)
        moved = dataclasses.replace(scene, eye=eye)
        frame = renderer.render(moved, Look(c=0.1, samples=None), size)
        found.append(np.mean(frame.specular[..., 1] * frame.coverage))
        one = renderer.render(moved, Look(c=0.1), size)
        single.append(np.mean(one.specular[..., 1] * one.coverage))
        assert any("narrow" in text for text in one.warnings)
    np.testing.assert_allclose(found, energy, rtol=0.02)
    # Negative control: one sample a pixel flickers.
    assert np.ptp(single) / np.mean(single) > 0.1
    truth = reference.render(scene, Look(c=0.1, samples=None), size)
    assert np.mean(truth.specular[..., 1] * truth.coverage) == pytest.approx(energy, rel=0.02)


OTHER_DRIVER = """
import sys, numpy as np
sys.path.insert(0, sys.argv[1])
import materials
from relgloss_view.quality.backends import open_renderer
from relgloss_view.picture.gpu.evaluate import evaluate
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
with open_renderer("egl") as r:
    cell = np.random.default_rng(0).integers(0, 2**32, (5000, 3)).astype(np.uint32)
    body = "result = uvec4(cell_hash(ivec3(h.xyz), 3u), 0u);"
    words = evaluate(r.ctx, ["noise.glsl"], body, {"h": cell}, integers=True)
    lab = r.render(Scene(materials.paper("matte")), Look(), (96, 72)).lab
    np.savez(sys.argv[2], words=words, lab=lab, device=str(r.ctx.info["GL_RENDERER"]))
"""


def test_case_36_another_driver(tmp_path):
    """Softpipe rounds and contracts in its own way: whole numbers are equal, Lab within 0.05."""
    here = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    found = {}
    for name, environment in (("own", {}), ("other", {"GALLIUM_DRIVER": "softpipe"})):
        path = str(tmp_path / f"{name}.npz")
        subprocess.run(
            [sys.executable, "-c", OTHER_DRIVER, here, path],
            env={**os.environ, **environment},
            check=True,
            timeout=100,
        )
        found[name] = np.load(path)
    if str(found["own"]["device"]) == str(found["other"]["device"]):
        pytest.skip("there is one driver here, and it is no software driver of Mesa")
    np.testing.assert_array_equal(found["own"]["words"], found["other"]["words"])
    cell = np.random.default_rng(0).integers(0, 2**32, (5000, 3))
    np.testing.assert_array_equal(found["own"]["words"][:, :3], noise.cell_hash(cell, 3))
    assert np.any(found["own"]["lab"] != found["other"]["lab"])
    np.testing.assert_allclose(found["own"]["lab"], found["other"]["lab"], atol=0.05)


@pytest.mark.parametrize("kind", ["cylinder", "sphere", "plane", "box"])
def test_case_37_lamp_or_eye_out_of_place(renderer, reference, kind):
    """Lamp behind or inside, eye inside: a defined picture, empty or black, that says so."""
    material = materials.paper("matte")
    inside = 0.02
    cases = {
        "lamp behind": Scene(material, shape=Shape(kind), lamp=Lamp(azimuth_deg=180.0)),
        "lamp inside": Scene(
            material, shape=Shape(kind), lamp=Lamp(distance_m=inside, azimuth_deg=10.0)
        ),
        "lamp at the centre": Scene(material, shape=Shape(kind), lamp=Lamp(distance_m=1e-3)),
        "eye inside": Scene(material, shape=Shape(kind), eye=Eye(distance_m=inside)),
    }
    for name, scene in cases.items():
        for one in (renderer, reference):
            frame = one.render(scene, Look(sigma_n_deg=1.0, c=0.5), SMALL)
            assert finite(frame.diffuse, frame.specular, frame.lab, frame.light)
            # A plane has no inside: a lamp or an eye near it is a near lamp or eye.
            if kind == "plane" and name != "lamp behind":
                assert np.any(frame.diffuse)
                continue
            assert not np.any(frame.diffuse)
            assert not np.any(frame.specular)
            said = "inside the object" if name == "eye inside" else "lights nothing"
            assert any(said in text for text in frame.warnings), name


class TestFoundHere:
    """Cases that the list does not have."""

    @pytest.mark.parametrize("kind", ["cylinder", "sphere", "plane", "box"])
    @pytest.mark.parametrize("distance_m", [1e-3, 0.0501, 0.1, 1e3])
    def test_very_near_and_very_far(self, renderer, reference, kind, distance_m):
        """Lamp and eye from a millimetre to a kilometre: finite, and the twin sees the same."""
        scene = Scene(
            materials.paper("matte"),
            shape=Shape(kind),
            lamp=Lamp(distance_m=distance_m, azimuth_deg=30.0, elevation_deg=20.0),
            eye=Eye(distance_m=distance_m, elevation_deg=10.0),
        )
        frame, truth = (
            one.render(scene, Look(sigma_n_deg=1.0, c=0.5), SMALL) for one in (renderer, reference)
        )
        assert finite(frame.diffuse, frame.specular, frame.lab, frame.light)
        assert min(np.min(frame.diffuse), np.min(frame.specular)) >= 0.0
        # A kilometre in float32 is good to 6e-5 m: of the object's 0.085, a pixel at its edges.
        assert np.mean(frame.on_object != truth.on_object) < 0.02
        assert bool(np.any(frame.diffuse)) == bool(np.any(truth.diffuse))

    @pytest.mark.parametrize("kind", ["cylinder", "sphere", "plane", "box"])
    @pytest.mark.parametrize("grain", ["screen", "surface"])
    def test_strongest_grain_on_every_shape(self, renderer, reference, kind, grain):
        """sigma_N = 10 degrees: tilts up to 58 degrees."""
        look = Look(sigma_n_deg=10.0, grain=grain, grain_mm=0.5, c=0.5)
        scene = Scene(materials.paper("cast"), shape=Shape(kind), eye=Eye(elevation_deg=15.0))
        for one in (renderer, reference):
            frame = one.render(scene, look, SMALL)
            assert finite(frame.diffuse, frame.specular, frame.lab, frame.tilted_normal)
            assert min(np.min(frame.diffuse), np.min(frame.specular)) >= 0.0
            length = np.linalg.norm(frame.tilted_normal[frame.on_object], axis=-1)
            np.testing.assert_allclose(length, 1.0, atol=1e-5)
