"""The real GLSL functions over a quarter of a million inputs each, from all over float32's range.

Magnitudes are drawn by their exponents, and directions stand as often within a hair of each other,
of an axis or of the horizon as anywhere.
"""

from __future__ import annotations

import glsl
import numpy as np
import pytest
from both import finite

from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.material import approximations, brdf
from relgloss_view.picture.gpu import constants
from relgloss_view.picture.gpu.targets import Targets

COUNT = 250_000


def magnitudes(rng, low, high, count=COUNT):
    """Numbers whose exponents are uniform, and some zeros."""
    values = 10.0 ** rng.uniform(low, high, count)
    return np.where(rng.random(count) < 0.05, 0.0, values).astype(np.float32)


def directions(seed):
    """n, i, o as unit vectors: anywhere, on an axis, or a hair off another one or its opposite."""
    rng = np.random.default_rng(seed)
    axes = np.concatenate([np.eye(3), -np.eye(3)])

    def any_of(others):
        made = rng.normal(size=(COUNT, 3))
        kind = rng.integers(0, 4, COUNT)
        made[kind == 1] = axes[rng.integers(0, 6, np.sum(kind == 1))]
        for other in others:
            near = kind >= 2
            sign = rng.choice([-1.0, 1.0], (COUNT, 1))
            across = np.cross(other, rng.normal(size=(COUNT, 3)))  # on its horizon
            base = np.where(rng.random((COUNT, 1)) < 0.5, sign * other, across)
            made[near] = base[near]
        made += rng.normal(size=(COUNT, 3)) * 10.0 ** rng.uniform(-9, -1, (COUNT, 1))
        length = np.linalg.norm(made, axis=-1, keepdims=True)
        return np.where(length > 0.0, made / np.maximum(length, 1e-300), [0.0, 0.0, 1.0])

    n = any_of([])
    i = any_of([n])
    return {"n": n, "i": i, "o": any_of([n, i])}


@pytest.mark.parametrize("facets", ["gaussian", "beckmann", "ggx", "mean-gaussian"])
@pytest.mark.parametrize("shadowing", ["v-groove", "none"])
@pytest.mark.parametrize("fresnel", ["exact", "constant"])
def test_lobes(ctx, facets, shadowing, fresnel):
    rng = np.random.default_rng(1)
    widths = np.radians(np.clip(10.0 ** rng.uniform(-1.31, 1.61, COUNT), 0.05, 40.0))
    grains = np.radians(10.0) * rng.random(COUNT)
    table = np.array(
        [
            approximations.mean_lobe(float(s), float(n), float(g), "paper")
            if facets == "mean-gaussian"
            else approximations.plain_lobe(float(s), float(n))
            for s, n, g in zip(
                widths[:200], 1.0 + 9.0 * rng.random(200) ** 4, grains[:200], strict=True
            )
        ]
    )
    inputs = directions(2) | {"lobe": table[rng.integers(0, len(table), COUNT)]}
    body = (
        "Facing f = facing(n.xyz, i.xyz, o.xyz);"
        "float v = torrance_sparrow(f, Lobe(lobe.x, lobe.y, lobe.z, lobe.w));"
        "result = vec4(v, v * max(f.mu_i, 0.0), f.delta2, f.t);"
    )
    defines = {
        "FACETS": constants.code("FACETS", facets),
        "SHADOWING": constants.code("SHADOWING", shadowing),
        "FRESNEL": constants.code("FRESNEL", fresnel),
    }
    found = glsl.evaluate(ctx, ["brdf.glsl"], body, inputs, defines=defines)
    assert finite(found)
    assert np.min(found[:, :3]) >= 0.0
    assert np.mean(found[:, 0] > 0.0) > 0.05


@pytest.mark.parametrize("model", ["lambert", "oren-nayar", "eon", "qualitative"])
def test_diffuse_models(ctx, model):
    rng = np.random.default_rng(3)
    sigmas = np.concatenate([[0.0, 1.0], 10.0 ** rng.uniform(-9, 0, 200)])
    terms = np.array([brdf.diffuse_terms(model, float(s)) for s in sigmas])
    inputs = directions(4) | {"terms": terms[rng.integers(0, len(terms), COUNT)]}
    number = constants.code("DIFFUSE", model)
    body = (
        "Facing f = facing(n.xyz, i.xyz, o.xyz);"
        f"vec2 v = diffuse_shapes({number}, f, terms); result = vec4(v, v * max(f.mu_i, 0.0));"
    )
    found = glsl.evaluate(ctx, ["brdf.glsl"], body, inputs)
    assert finite(found)
    assert np.min(found) >= 0.0
    assert np.mean(found[:, 0] > 0.0) > 0.1


@pytest.mark.parametrize("root", constants.NAMES["CUBE_ROOT"])
@pytest.mark.parametrize("gamut", ["GAMUT_CHROMA", "GAMUT_CLIP"])
@pytest.mark.parametrize("transfer", ["TRANSFER_SRGB", "TRANSFER_GAIN_OFFSET_GAMMA"])
def test_from_light_to_display(ctx, root, gamut, transfer):
    """XYZ from 0 and 1e-38 to 1e12, c from 0 to 1e4: digital values within 0 to 1."""
    rng = np.random.default_rng(5)
    inputs = {
        name: np.stack([magnitudes(rng, -38, 12) for _ in range(3)], axis=-1) for name in "ds"
    }
    inputs["c"] = magnitudes(rng, -12, 4)
    display = DisplayModel.of(Display())
    rows, white = (
        ", ".join(map(repr, v.ravel().tolist()))
        for v in (
            display.rgb_from_xyz.T,
            display.white,
        )
    )
    body = (
        "bool inside; vec4 v = split_lab(d.xyz, s.xyz, vec3(1.0));"
        f"vec3 rgb = display_rgb({gamut}, scaled_lab(v, c.x), vec3({white}), mat3({rows}), inside);"
        f"result = vec4(encode({transfer}, rgb, vec4(0.98, 0.02, 2.3, 0.003)), "
        "dot(abs(v), vec4(1.0)));"
    )
    found = glsl.evaluate(
        ctx,
        ["tone.glsl"],
        body,
        inputs,
        defines={"CUBE_ROOT": constants.code("CUBE_ROOT", root)},
        samplers={"cube_root_table": Targets(ctx).cube_root_table()},
    )
    assert finite(found)
    assert np.min(found[:, :3]) >= 0.0
    # sRGB's polynomial is within 1.4e-6 of full scale.
    assert np.max(found[:, :3]) <= 1.0 + 2e-6


@pytest.mark.parametrize("law", ["NOISE_PAPER", "NOISE_TANGENT"])
def test_grain(ctx, law):
    """Any hash, any sigma_N to 10 degrees, any normal and eye: a unit normal that faces the eye."""
    rng = np.random.default_rng(6)
    inputs = directions(7)
    o = inputs["o"]
    facing = np.sum(inputs["n"] * o, axis=-1) > 1e-6
    words = rng.integers(0, 2**32, (COUNT, 3)).astype(np.uint32)
    words[: COUNT // 10] = rng.choice(np.array([0, 0xFFFFFFFF], np.uint32), (COUNT // 10, 3))
    inputs |= {"h": words, "sigma": np.radians(10.0) * rng.random(COUNT)}
    body = (
        f"vec3 m = noisy_normal({law}, n.xyz, o.xyz, h.xyz, sigma.x);"
        "result = vec4(length(m), dot(m, o.xyz), 0, 0);"
    )
    found = glsl.evaluate(ctx, ["noise.glsl"], body, inputs)
    assert finite(found)
    # The frame's and the turn's roundings, some ten of 6e-8.
    np.testing.assert_allclose(found[:, 0], 1.0, atol=2e-6)
    assert np.min(found[facing, 1]) > -1e-6


def test_naive_forms_fail_on_the_same_inputs(ctx):
    """Control: what the library avoids, acos of a cosine and cos(phi) by division, fails."""
    body = (
        "vec3 h = normalize(i.xyz + o.xyz); float a = dot(n.xyz, i.xyz), b = dot(n.xyz, o.xyz);"
        "float phi = (dot(i.xyz, o.xyz) - a * b) / (sqrt(1.0 - a * a) * sqrt(1.0 - b * b));"
        "result = vec4(acos(dot(n.xyz, h)), phi, 0, 0);"
    )
    found = glsl.evaluate(ctx, ["brdf.glsl"], body, directions(2))
    assert np.mean(~np.isfinite(found[:, 1])) > 1e-3
    assert not finite(found[:, 0])
