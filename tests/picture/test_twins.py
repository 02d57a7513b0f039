"""Each GLSL library against its numpy twin on the same inputs.

Agreement of twins is not truth (both are ours): the twins meet truth in test_brdf, test_tone and
test_noise. Bounds: float32 carries 6e-8; the language allows 3 + 2|x| units in the last place for
exp, so a few 1e-6 relative are left to each chain of some twenty operations.
"""

from __future__ import annotations

import glsl
import numpy as np
import pytest

from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.material import brdf
from relgloss_view.picture.gpu import constants
from relgloss_view.picture.model import noise, shape, silhouette, tone


def float32(values):
    return np.asarray(values, dtype=np.float32)


def unit(count, seed, low=-1.0):
    rng = np.random.default_rng(seed)
    z = rng.uniform(low, 1.0, count)
    phi = rng.uniform(0, 2 * np.pi, count)
    s = np.sqrt(1 - z * z)
    return np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1)


@pytest.fixture(scope="module")
def directions():
    """Normals anywhere, lamp and eye mostly above them, a third near the mirror direction."""
    count = 60_000
    rng = np.random.default_rng(8)
    n, i = unit(count, 1), unit(count, 2)
    i *= np.where(np.sum(n * i, axis=-1) < 0, -1, 1)[:, None]
    o = unit(count, 3)
    o *= np.where(np.sum(n * o, axis=-1) < 0, -1, 1)[:, None]
    mirror = 2 * np.sum(n * i, axis=-1)[:, None] * n - i
    near = np.arange(count) % 3 == 0
    o[near] = (mirror + rng.normal(0, 0.03, (count, 3)))[near]
    n, i, o = (float32(v / np.linalg.norm(v, axis=-1, keepdims=True)) for v in (n, i, o))
    return n, i, o


def call(ctx, directions, expression):
    n, i, o = directions
    body = f"Facing f = facing(n.xyz, i.xyz, o.xyz); result = {expression};"
    return glsl.evaluate(ctx, ["brdf.glsl"], body, {"n": n, "i": i, "o": o}).astype(np.float64)


def twin(directions):
    # The float32 directions are renormalised: 1e-8 off unit length is no business of the models.
    n, i, o = (v.astype(np.float64) for v in directions)
    n, i, o = (v / np.linalg.norm(v, axis=-1, keepdims=True) for v in (n, i, o))
    return brdf.facing(n, i, o)


def shapes_of(model, sigma):
    name = constants.glsl_name("DIFFUSE", model)
    terms = f"vec4{tuple(float(v) for v in brdf.diffuse_terms(model, sigma))}"
    return f"vec4(diffuse_shapes({name}, f, {terms}), 0, 0)"


class TestBrdf:
    def test_facing(self, ctx, directions):
        f = twin(directions)
        result = call(ctx, directions, "vec4(f.mu_i, f.mu_o, f.t, f.cos_d)")
        np.testing.assert_allclose(result, np.stack(f[:4], axis=-1), atol=4e-7)
        delta2 = call(ctx, directions, "vec4(f.delta2)")[:, 0]
        # Six terms of arcsin^2: below 1e-6 up to 45 degrees, 0.1 % at 90.
        small = f.delta2 < (np.pi / 4) ** 2
        np.testing.assert_allclose(delta2[small], f.delta2[small], rtol=2e-6, atol=2e-7)
        above = (f.mu_i > 0) & (f.mu_o > 0)  # below the horizon nothing asks for delta
        np.testing.assert_allclose(delta2[above], f.delta2[above], rtol=1.2e-3, atol=2e-7)

    @pytest.mark.parametrize("n", [1.0, 1.33, 1.5, 3.0])
    def test_fresnel(self, ctx, n):
        cos_d = float32(np.concatenate([np.linspace(0, 1, 4001), 10 ** np.linspace(-7, -3, 50)]))
        result = glsl.evaluate(
            ctx,
            ["brdf.glsl"],
            f"result = vec4(fresnel_dielectric(c.x, {n}));",
            {"c": cos_d},
        )[:, 0]
        np.testing.assert_allclose(result, brdf.fresnel_dielectric(cos_d, n), rtol=2e-5, atol=1e-7)

    @pytest.mark.parametrize("s_deg", [0.05, 0.5, 5.0, 40.0])
    def test_torrance_sparrow(self, ctx, directions, s_deg):
        """Bound relative to the lobe's own peak.

        delta carries some 2e-7, which the exponent turns into delta 2e-7 / s^2, about 4e-7 / s
        where the lobe still counts; 3e-6 for the rest of the chain. At 40 degrees the series of
        delta^2 limits: 0.1 % of an exponent of 2.5.
        """
        bound = 3e-3 if s_deg == 40.0 else 4e-7 / np.radians(s_deg) + 3e-6
        s = float(np.radians(s_deg))
        f = twin(directions)
        amplitude = brdf.facet_amplitude(s)
        lobe = f"Lobe({0.5 / s**2!r}, {amplitude!r}, 1.5, 0.0)"
        result = call(ctx, directions, f"vec4(torrance_sparrow(f, {lobe}))")[:, 0]
        expected = brdf.torrance_sparrow(f, s, 1.5)
        peak = amplitude * brdf.fresnel_dielectric(f.cos_d, 1.5) * brdf.shadowing(f) / 4
        steady = (np.minimum(f.mu_i, f.mu_o) > 1e-3) & (f.cos_d > 1e-3)
        assert np.mean(steady) > 0.99
        assert np.max(np.abs(result - expected)[steady] / peak[steady]) < bound
        assert np.all(np.isfinite(result))
        assert np.all(result >= 0)

    @pytest.mark.parametrize("model", ["lambert", "oren-nayar", "eon", "qualitative"])
    @pytest.mark.parametrize("sigma", [0.0, 0.1, 0.7])
    def test_diffuse_shapes(self, ctx, directions, model, sigma):
        result = call(ctx, directions, shapes_of(model, sigma))
        f = twin(directions)
        # Times the cosine, as it reaches a picture: tan(b) alone grows without bound at grazing.
        lit = np.maximum(f.mu_i, 0.0)
        steady = np.minimum(f.mu_i, f.mu_o) > 1e-3
        for k, expected in enumerate(brdf.diffuse_shapes(model, f, sigma)):
            error = np.abs(result[:, k] - expected) * lit
            assert np.max(error[steady]) < 3e-6
        assert np.all(np.isfinite(result))
        assert np.all(result >= 0)

    def test_opposite_directions_have_no_half_vector(self, ctx):
        n = float32(unit(500, 11))
        i = float32(unit(500, 12))
        f = brdf.facing(n.astype(np.float64), i.astype(np.float64), -i.astype(np.float64))
        result = call(ctx, (n, i, -i), "vec4(f.cos_d, f.delta2, 0, 0)")
        for cos_d, delta2 in ((f.cos_d, f.delta2), (result[:, 0], result[:, 1])):
            assert np.all(cos_d == 0.0)
            np.testing.assert_allclose(delta2, (np.pi / 2) ** 2, rtol=2e-7)

    @pytest.mark.parametrize("theta", [1e-3, 1e-2])
    def test_oren_nayar_keeps_its_azimuth_near_the_normal(self, ctx, theta):
        """Oren and Nayar 1995, eq. 30: near the normal only their second term holds the azimuth.

        From opposite sides of the plane of incidence it differs by 2 C2 tan(b) / pi, where C2 is
        0.45 sigma^2 / (sigma^2 + 0.09) sin(a), less (2b/pi)^3 on one side, and C3's term vanishes.
        """
        sigma = 0.5
        lamp = [np.sin(theta), 0.0, np.cos(theta)]
        i = float32([lamp, lamp])
        o = float32([lamp, [-np.sin(theta), 0.0, np.cos(theta)]])
        n = float32([[0.0, 0.0, 1.0]] * 2)
        c2 = 0.45 * sigma**2 / (sigma**2 + 0.09)
        expected = c2 * (2.0 * np.sin(theta) - (2.0 * theta / np.pi) ** 3) * np.tan(theta) / np.pi
        first = brdf.oren_nayar(twin((n, i, o)), sigma)[0]
        assert first[0] - first[1] == pytest.approx(expected, rel=1e-3)
        # In float32 the difference of two numbers near 0.3: each is good to a few units of 3e-8.
        first = call(ctx, (n, i, o), shapes_of("oren-nayar", sigma))[:, 0]
        assert first[0] - first[1] == pytest.approx(expected, abs=1.5e-7)

    def test_a_slightly_wrong_roughness_is_seen(self, ctx, directions):
        # Negative control: a roughness 3 % off.
        result = call(ctx, directions, shapes_of("oren-nayar", 0.7))[:, 0]
        f = twin(directions)
        wrong = brdf.oren_nayar(f, 0.68)[0]
        assert np.max(np.abs(result - wrong)) > 1e-3


class TestTone:
    def test_cube_root(self, ctx):
        t = float32(np.concatenate([10 ** np.linspace(-12, 6, 20_000), [0.0, -1.0, 1.0, 8.0]]))
        result = glsl.evaluate(ctx, ["tone.glsl"], "result = vec4(cube_root(t.x));", {"t": t})[:, 0]
        expected = np.cbrt(np.maximum(t.astype(np.float64), 0.0))
        np.testing.assert_allclose(result, expected, rtol=3e-7)

    def test_dither(self, ctx):
        rows, columns = (v.ravel() for v in np.mgrid[0:16384:97, 0:16384:89])
        at = float32(np.stack([columns, rows], axis=-1))
        result = glsl.evaluate(
            ctx, ["tone.glsl"], "result = vec4(dither_step(ivec2(v.xy)));", {"v": at}
        )[:, 0]
        np.testing.assert_allclose(result, tone.dither_step(columns, rows), atol=6e-8)

    def test_places_of_edge_rays(self, ctx):
        k = np.arange(64)
        body = "result = vec4(edge_place(int(k.x)), 0.0, 0.0);"
        result = glsl.evaluate(ctx, ["silhouette.glsl"], body, {"k": float32(k)})
        np.testing.assert_array_equal(result[:, :2], np.stack(silhouette.edge_place(k), axis=-1))

    def test_lab_both_ways(self, ctx):
        rng = np.random.default_rng(2)
        xyz = float32(10 ** rng.uniform(-6, 2, (20_000, 3)))
        white = np.array([1.0168, 1.0, 0.6761])
        literal = f"vec3({white[0]}, {white[1]}, {white[2]})"
        lab = glsl.evaluate(
            ctx, ["tone.glsl"], f"result = vec4(lab_from_xyz(v.xyz, {literal}), 0);", {"v": xyz}
        )
        expected = tone.lab_from_xyz(xyz.astype(np.float64), white)
        # 500 (f_x - f_y) of values up to 5: 500 x 5 x 2e-7.
        np.testing.assert_allclose(lab[:, :3], expected, atol=6e-4)
        back = glsl.evaluate(
            ctx,
            ["tone.glsl"],
            f"result = vec4(xyz_from_lab(lab_from_xyz(v.xyz, {literal}), {literal}), 0);",
            {"v": xyz},
        )
        # f is good to 3e-7 where its neighbour is 5, and the slope below 216/24389 is 0.13.
        np.testing.assert_allclose(back[:, :3], xyz, rtol=1e-5, atol=2e-7)

    @pytest.mark.parametrize("gamut", ["chroma", "clip"])
    @pytest.mark.parametrize("transfer", ["srgb", "gain-offset-gamma"])
    def test_display(self, ctx, transfer, gamut):
        display = DisplayModel.of(
            Display(transfer=transfer, gamut=gamut, gain=0.98, offset=0.02, gamma=2.3, flare=0.003)
        )
        rng = np.random.default_rng(3)
        lab = float32(rng.uniform([0, -120, -120], [110, 120, 120], (40_000, 3)))
        rows = ",".join(str(v) for v in display.rgb_from_xyz.T.ravel())
        white = ",".join(str(v) for v in display.white)
        curve = ",".join(str(v) for v in display.curve)
        code = constants.glsl_name("TRANSFER", transfer)
        result = glsl.evaluate(
            ctx,
            ["tone.glsl"],
            f"bool inside; vec3 rgb = display_rgb(GAMUT_{gamut.upper()}, v.xyz, vec3({white}),"
            f" mat3({rows}), inside);"
            f"result = vec4(encode({code}, rgb, vec4({curve})), inside ? 1 : 0);",
            {"v": lab},
        )
        light, inside = tone.display_rgb(lab.astype(np.float64), display)
        assert 0.1 < np.mean(inside) < 0.9
        assert np.mean(result[:, 3].astype(bool) == inside) > 0.9999
        # One step of bisection (chroma 170 / 2^16) and 2e-6 of light, at the curve's steepest 12.9.
        np.testing.assert_allclose(result[:, :3], tone.encode(light, display), atol=2e-3)


class TestNoise:
    @pytest.mark.parametrize("law", ["paper", "tangent"])
    def test_tilt_and_turn(self, ctx, law):
        count = 50_000
        n = float32(unit(count, 5))
        hashes = noise.cell_hash(np.random.default_rng(1).integers(0, 9999, (count, 3)), 0)
        sigma = float(np.radians(3.0))
        result = glsl.evaluate(
            ctx,
            ["noise.glsl"],
            f"result = vec4(tilted(n.xyz, tilt_angles(NOISE_{law.upper()}, h.xyz, {sigma!r})), 0);",
            {"n": n, "h": hashes},
        )
        expected = noise.tilted(n.astype(np.float64), noise.tilt_angles(law, hashes, sigma))
        np.testing.assert_allclose(result[:, :3], expected, atol=3e-6)

    def test_series_hold_up_to_the_largest_tilt(self, ctx):
        """Cosine and sine over angle, to 3e-8 as the library says and 6e-8 of float32's rounding.

        The largest is sigma_N of 10 degrees times the largest Gaussian that 23 bits make, 5.77.
        """
        t2 = float32(np.linspace(0.0, (np.radians(10.0) * 5.77) ** 2, 5001))
        result = glsl.evaluate(ctx, ["noise.glsl"], "result = vec4(turn(t.x), 0, 0);", {"t": t2})
        angle = np.sqrt(t2.astype(np.float64))
        np.testing.assert_allclose(result[:, 0], np.cos(angle), atol=3e-8 + 9e-8)
        np.testing.assert_allclose(result[:, 1], np.sinc(angle / np.pi), atol=3e-8 + 9e-8)

    def test_series_for_small_tilts_meets_the_sine(self, ctx):
        angles = np.zeros((2001, 2))
        angles[:, 0] = np.linspace(0, 0.3, 2001)
        n = float32(np.tile([0.0, 0.0, 1.0], (2001, 1)))
        result = glsl.evaluate(
            ctx,
            ["noise.glsl"],
            "result = vec4(tilted(n.xyz, a.xy), 0);",
            {"n": n, "a": float32(angles)},
        )
        np.testing.assert_allclose(result[:, 0], np.sin(angles[:, 0]), atol=3e-7)


EYES = ((0.0, 0.0, 0.6), (0.3, 0.25, 0.4), (-0.2, -0.5, -0.3))
HALF = {
    "cylinder": (0.0425, 0.05, 0.0425),
    "sphere": (0.0425, 0.0425, 0.0425),
    "plane": (0.05, 0.04, 0.0),
    "box": (0.05, 0.04, 0.03),
}


class TestShape:
    @pytest.mark.parametrize("kind", list(HALF))
    @pytest.mark.parametrize("eye", EYES)
    def test_meeting(self, ctx, kind, eye):
        half = float32(HALF[kind]).astype(np.float64)
        eye_m = float32(eye).astype(np.float64)
        rng = np.random.default_rng(4)
        targets = rng.uniform(-1.3, 1.3, (30_000, 3)) * half
        ray = float32(targets - eye_m)
        hit = shape.meet(kind, eye_m, ray.astype(np.float64), half)
        inputs = {"ray": ray}
        eye_text, half_text = (f"vec3{tuple(v.tolist())}" for v in (eye_m, half))
        prelude = f"Hit hit = meet(SHAPE_{kind.upper()}, {eye_text}, ray.xyz, {half_text});"
        point = glsl.evaluate(
            ctx, ["shape.glsl"], prelude + "result = vec4(hit.point_m, hit.found ? 1 : 0);", inputs
        )
        normal = glsl.evaluate(
            ctx, ["shape.glsl"], prelude + "result = vec4(hit.normal, hit.face);", inputs
        )
        surface = glsl.evaluate(
            ctx, ["shape.glsl"], prelude + "result = vec4(hit.surface_m, 0, 0);", inputs
        )
        found = hit.found & (point[:, 3] > 0)
        # Rays that graze an edge may miss on one side.
        assert np.mean(hit.found != (point[:, 3] > 0)) < 1e-3
        if kind != "plane" or eye[2] > 0:
            assert np.mean(found) > 0.2
        # At the silhouette the normal turns without bound: sqrt(6e-8) ~ 2.5e-4 there at most.
        toward = -np.sum(hit.normal * ray, axis=-1) / np.linalg.norm(ray, axis=-1)
        steady = found & (toward > 0.05)
        assert np.max(np.abs(normal[:, :3] - hit.normal)[steady], initial=0) < 1e-5
        assert np.max(np.abs(normal[:, :3] - hit.normal)[found], initial=0) < 3e-3
        assert np.max(np.abs(point[:, :3] - hit.point_m)[steady], initial=0) < 5e-7
        # Longitude is lost at a sphere's poles.
        sited = steady & ((kind != "sphere") | (np.hypot(*hit.normal[:, [0, 2]].T) > 0.2))
        assert np.max(np.abs(surface[:, :2] - hit.surface_m)[sited], initial=0) < 5e-7
        np.testing.assert_array_equal(normal[steady, 3], hit.face[steady])
        # Truth of both: the point lies on the ray and on the surface, and is seen.
        p = hit.point_m[found]
        along = np.cross(p - eye_m, ray[found])
        assert np.max(np.abs(along), initial=0) < 1e-9
        assert np.all(toward[found] > -1e-9)
        assert np.all(np.abs(p) <= half + 1e-9)

    def test_arc_tangent(self, ctx):
        angle = np.linspace(-np.pi, np.pi, 20_001)[1:]
        v = float32(np.stack([np.sin(angle), np.cos(angle)], axis=-1) * 0.04)
        result = glsl.evaluate(
            ctx, ["shape.glsl"], "result = vec4(arc_tangent(v.x, v.y));", {"v": v}
        )[:, 0]
        expected = np.arctan2(v[:, 0].astype(np.float64), v[:, 1].astype(np.float64))
        np.testing.assert_allclose(result, expected, atol=4e-7)
