"""The GLSL of the CIELAB split and of the encoding against colour-science, without our twin."""

from __future__ import annotations

import glsl
import numpy as np
import pytest

from relgloss_view.picture.model import tone

colour = pytest.importorskip("colour")

WHITE = np.array([1.0168, 1.0, 0.6761])


def evaluate(ctx, body, **inputs):
    arrays = {name: np.asarray(values, dtype=np.float32) for name, values in inputs.items()}
    return glsl.evaluate(ctx, ["tone.glsl"], body, arrays).astype(np.float64)


def lights(seed):
    """XYZ from 1e-5 of white to ten times it: both branches of CIE 15's f, float32 values."""
    values = WHITE * 10 ** np.random.default_rng(seed).uniform(-5, 1, (20_000, 3))
    return values.astype(np.float32).astype(np.float64)


def test_split_is_lab_of_the_sum_and_the_lightness_of_the_diffuse_part(ctx):
    diffuse, specular = lights(1), lights(2)
    per_white = f"vec3({1 / WHITE[0]!r}, 1.0, {1 / WHITE[2]!r})"
    got = evaluate(ctx, f"result = split_lab(d.xyz, s.xyz, {per_white});", d=diffuse, s=specular)
    white_xy = colour.XYZ_to_xy(WHITE)
    whole = colour.XYZ_to_Lab(diffuse + specular, white_xy)
    body = colour.XYZ_to_Lab(diffuse, white_xy)[:, 0]
    # Cube roots good to 3e-7, of values up to 2.8; 116, 500 and 200 times that, twice for a
    # difference.
    np.testing.assert_allclose(got[:, 0], body, atol=2e-4)
    np.testing.assert_allclose(got[:, 1], whole[:, 0] - body, atol=4e-4)
    np.testing.assert_allclose(got[:, 2], whole[:, 1], atol=1e-3)
    np.testing.assert_allclose(got[:, 3], whole[:, 2], atol=4e-4)


def test_srgb_keeps_its_promise(ctx):
    """Within 1.4e-6 of full scale, as the library says, and 2e-7 of float32's own.

    Half of the values lie where the two branches of the curve meet.
    """
    light = np.concatenate([np.linspace(0, 1, 20_001), 0.0031308 * np.linspace(0.8, 1.3, 20_001)])
    light = light.astype(np.float32).astype(np.float64)
    got = evaluate(ctx, "result = vec4(srgb_encode(v.x));", v=light)[:, 0]
    expected = colour.models.eotf_inverse_sRGB(light)
    # The standard rounds its constants: its branches miss each other by 3e-8 where they meet.
    np.testing.assert_allclose(got, expected, atol=1.4e-6 + 2e-7)


def test_largest_c_puts_a_pixel_at_white(ctx):
    rng = np.random.default_rng(3)
    split = rng.uniform(0.1, 99.0, (5_000, 2))
    c = evaluate(ctx, "result = vec4(largest_c(s.xy));", s=split)[:, 0]
    lab = evaluate(
        ctx,
        "result = vec4(scaled_lab(vec4(s.xy, 3.0, -4.0), c.x), 0.0);",
        s=split,
        c=c,
    )
    # A lightness of 100 through a division and a product: three roundings of 6e-8 relative, and
    # c itself is rounded to float32 on its way in.
    np.testing.assert_allclose(lab[:, 0], 100.0, atol=5e-5)
    assert np.all(lab[:, 1:3] == (3.0, -4.0))
    nothing = evaluate(ctx, "result = vec4(largest_c(s.xy));", s=[[40.0, 0.0], [40.0, 1e-7]])
    assert np.all(nothing[:, 0] > 1e29)


def test_only_what_is_drawn_is_on_the_object(ctx):
    values = [tone.OFF_OBJECT, -1.0, 0.0, 90.0]
    split = np.array([[v, 0.0, 0.0, 0.0] for v in values])
    got = evaluate(ctx, "result = vec4(on_object(s) ? 1.0 : 0.0);", s=split)[:, 0]
    assert got.tolist() == [0.0, 1.0, 1.0, 1.0]


def test_false_colours_are_those_of_the_files(ctx):
    lightness = np.linspace(-10.0, 110.0, 1201).astype(np.float32).astype(np.float64)
    got = evaluate(ctx, "result = vec4(false_colour(v.x), 0.0);", v=lightness)[:, :3]
    # Sine and cosine are good to 2^-11 in the language; Mesa keeps 1e-6 of them, of a chroma of 45.
    np.testing.assert_allclose(got, tone.false_colour(lightness), atol=5e-3)
