"""Lamps of a size, further lamps and ambient light, against Mitsuba and quadratures."""

from __future__ import annotations

import dataclasses

import glsl
import lamp_discs
import materials
import numpy as np
import pytest
from frames import assert_same_picture, delta_e

from relgloss_view.gloss.pose import Pose
from relgloss_view.material import albedo_table, brdf
from relgloss_view.material.albedo_table import cosines, lobe_table, looked_up
from relgloss_view.material.approximations import mean_lobe
from relgloss_view.material.brdf import MetalPart
from relgloss_view.material.material import Diffuse, Lobe
from relgloss_view.material.spectra import illuminant
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.frame import BLACK, NO_GLOSS
from relgloss_view.picture.gpu.variant import Variant
from relgloss_view.picture.model import lights, tone
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.model.light import AMBIENT_ONLY
from relgloss_view.picture.model.view import View
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, FurtherLamp, Lamp, Setup

TINY = (64, 64)
THREE = (
    FurtherLamp(-40.0, 20.0, 0.7, 0.05, 0.4),
    FurtherLamp(10.0, 60.0, 2.0, 0.0, 3.0),
    FurtherLamp(0.0, -30.0, 1.0, 0.02, 0.3),
)


def lit_scene(material, lamp, further=(), shape="cylinder", eye=None):
    return Scene(material, Setup(Shape(shape), lamp, eye or Eye(), further_lamps=further))


def foil():
    """A metal's lobe beside a dielectric one."""
    gray = materials.flat(0.1)
    f0 = tuple(np.linspace(0.4, 0.95, gray.bands.count))
    return dataclasses.replace(gray, specular=(Lobe((1.0,), 4.0, f0=f0), Lobe((0.5,), 10.0)))


def test_a_point_lamp_alone_costs_nothing():
    """The constants are those of one point lamp, so the compiled shader is the former one."""
    material = materials.paper("art")
    plain = Variant.of(Scene(material), Look()).defines()
    assert (plain["LAMPS"], plain["LAMP_SIZE"], plain["AMBIENT"]) == (1, 0, 0)
    rich = lit_scene(material, Lamp(radius_m=0.01, ambient=0.1), THREE)
    more = Variant.of(rich, Look()).defines()
    assert (more["LAMPS"], more["LAMP_SIZE"], more["AMBIENT"]) == (4, 1, 1)
    dark = lit_scene(material, Lamp(), (FurtherLamp(share=0.0),))
    assert Variant.of(dark, Look()).defines() == plain


@pytest.mark.parametrize(
    ("material", "look"),
    [
        (materials.paper("matte"), Look(2.0, noisy_lobes="specular", c=0.3, samples=2)),
        (foil(), Look()),
    ],
    ids=["paper", "foil"],
)
def test_gpu_and_reference(renderer, reference, material, look):
    scene = lit_scene(material, Lamp(ambient=0.2, radius_m=0.1), THREE, eye=Eye(10.0))
    frame, truth = (r.render(scene, look, TINY) for r in (renderer, reference))
    assert_same_picture(frame, truth)
    # Negative controls: each part of the light is seen.
    for other in (
        lit_scene(material, Lamp(ambient=0.21, radius_m=0.1), THREE, eye=Eye(10.0)),
        lit_scene(material, Lamp(ambient=0.2, radius_m=0.12), THREE, eye=Eye(10.0)),
        lit_scene(material, Lamp(ambient=0.2, radius_m=0.1), THREE[:2], eye=Eye(10.0)),
    ):
        assert np.max(delta_e(renderer.render(other, look, TINY), truth)) > 0.1


class TestAmbient:
    @pytest.mark.parametrize("model", ["lambert", "eon"])
    @pytest.mark.parametrize("kind", ["sphere", "box"])
    def test_alone_on_albedo_one_it_is_uniform(self, renderer, reference, model, kind):
        white = materials.flat(1.0)
        albedo = white.diffuse.albedo
        white = dataclasses.replace(white, diffuse=Diffuse(model, albedo, 30.0))
        scene = lit_scene(white, Lamp(ambient=1.0), shape=kind, eye=Eye(20.0, 30.0))
        for drawn in (renderer, reference):
            frame = drawn.render(scene, Look(), TINY)
            np.testing.assert_allclose(frame.diffuse[..., 1][frame.on_object], 1.0, atol=1e-3)
        # Negative control: a lamp's light is not.
        mixed = dataclasses.replace(scene.lamp, ambient=0.9)
        frame = renderer.render(scene.placed(lamp=mixed), Look(c=1.0), TINY)
        assert np.ptp(frame.diffuse[..., 1][frame.on_object]) > 0.05

    def test_a_foil_mirrors_it_at_any_contrast_gloss(self, renderer, reference):
        """A narrow lobe shows its Fresnel reflectance at the eye's angle (Schlick 1994)."""
        gray = materials.flat(0.0)
        f0 = np.linspace(0.4, 0.95, gray.bands.count)
        gold = dataclasses.replace(gray, specular=(Lobe((0.8,), 0.3, f0=tuple(f0)),))
        scene = lit_scene(gold, Lamp(ambient=1.0), shape="sphere")
        weights = gold.xyz_weights(illuminant(scene.lamp.illuminant))
        for drawn in (renderer, reference):
            frame = drawn.render(scene, Look(c=0.1), TINY)
            rays = View.of(scene, TINY).rays(slice(0, TINY[1]))
            mu_o = -np.sum(frame.normal * rays, axis=-1) / np.linalg.norm(rays, axis=-1)
            seen = frame.on_object & (mu_o > 0.2)
            w = (1.0 - mu_o[seen][:, None]) ** 5
            closed = tone.lab_from_xyz(0.8 * ((1.0 - w) * f0 + w) @ weights, weights.sum(axis=0))
            assert np.max(delta_e_2000(frame.lab[seen], closed)) < 0.1
            assert np.max(frame.specular[frame.on_object]) == 0.0  # no highlight
        # Negative control: what a lamp gives is a highlight, and scaled.
        mixed = scene.placed(lamp=Lamp(ambient=0.5))
        few, all_ = (renderer.render(mixed, Look(c=c), TINY) for c in (0.1, 0.2))
        assert np.max(np.abs(few.lab - all_.lab)) > 1.0

    def test_nothing_shows_more_of_it_than_the_perfect_diffuser(self, renderer, reference):
        glossy = dataclasses.replace(materials.flat(1.0), specular=(Lobe((1.0,), 5.0),))
        scene = lit_scene(glossy, Lamp(ambient=1.0), shape="sphere")
        for drawn in (renderer, reference):
            frame = drawn.render(scene, Look(), TINY)
            np.testing.assert_allclose(frame.diffuse[..., 1][frame.on_object], 1.0, atol=1e-3)
        # Negative control: a darker one has room for its lobes, most at the silhouette.
        dark = dataclasses.replace(materials.flat(0.5), specular=glossy.specular)
        frame = renderer.render(lit_scene(dark, Lamp(ambient=1.0), shape="sphere"), Look(), TINY)
        shown = frame.diffuse[..., 1][frame.on_object]
        assert np.min(shown) > 0.53
        assert np.max(shown) > 0.7

    @pytest.mark.parametrize("y_n", ["maximum", "front"])
    def test_the_perfect_diffuser_shows_y_n(self, renderer, y_n):
        """The ambient share of it where no lamp reaches, all of it where Y_n is measured."""
        lamp = Lamp(azimuth_deg=20.0, ambient=0.3, radius_m=0.1, y_n=y_n)
        scene = lit_scene(materials.flat(1.0), lamp, (FurtherLamp(30.0, 10.0, 0.5, 0.05, 0.5),))
        frame = renderer.render(scene, Look(c=1.0), (65, 65))
        y = frame.diffuse[..., 1]
        shown = np.max(y) if y_n == "maximum" else y[32, 32]
        assert shown == pytest.approx(1.0, abs=2e-5)
        assert np.min(y[frame.on_object]) == pytest.approx(0.3, abs=1e-6)

    def test_it_shows_what_no_lamp_lights(self, renderer):
        behind = Lamp(azimuth_deg=180.0)
        scene = lit_scene(materials.paper("art"), behind)
        assert renderer.render(scene, Look(), TINY).warnings == (BLACK,)
        shown = scene.placed(lamp=dataclasses.replace(behind, ambient=0.4))
        frame = renderer.render(shown, Look(), TINY)
        assert AMBIENT_ONLY in frame.warnings
        assert BLACK not in frame.warnings
        assert np.min(frame.diffuse[..., 1][frame.on_object]) > 0.03

    @pytest.mark.parametrize("s_deg", [0.5, 6.0, 30.0])
    @pytest.mark.parametrize("fresnel", [1.5, MetalPart.GRAZING], ids=str)
    def test_a_lobe_is_integrated(self, s_deg, fresnel):
        """Against the midpoint rule over the two slopes of the half-vector."""
        s = float(np.radians(s_deg))
        mu = np.array([0.9, 0.5, 0.15])
        table = looked_up(lobe_table(s, fresnel), mu)
        for mu_o, tabled in zip(mu, table, strict=True):
            o = np.array([np.sqrt(1.0 - mu_o**2), 0.0, mu_o])
            # h = (x, y, 1) / |.|: dw_h = h_z^3 dx dy, and dw_i = 4 (o.h) dw_h.
            reach = np.tan(min(6.0 * s, 1.45))
            step = 2.0 * reach / 600
            x, y = np.meshgrid(*[np.arange(-reach + 0.5 * step, reach, step)] * 2)
            h_z = 1.0 / np.sqrt(1.0 + x * x + y * y)
            h = np.stack([x, y, np.ones_like(x)], axis=-1) * h_z[..., None]
            oh = h @ o
            i = 2.0 * oh[..., None] * h - o
            f = brdf.facing(np.array([0.0, 0.0, 1.0]), i, o)
            value = brdf.torrance_sparrow(f, s, fresnel) * np.maximum(f.mu_i, 0.0)
            total = float(np.sum(np.where(oh > 0.0, value * 4.0 * oh * h_z**3, 0.0))) * step**2
            assert tabled == pytest.approx(total, abs=2e-3), (s_deg, mu_o)

    @pytest.mark.parametrize("s_deg", [0.05, 2.0, 15.0, 40.0])
    def test_between_the_entries_of_a_table(self, s_deg):
        s = float(np.radians(s_deg))
        entries = np.sqrt(cosines()[4:])  # the first is 0.01 degrees above the horizon
        between = (0.5 * (entries[1:] + entries[:-1])) ** 2
        exact = albedo_table.lobe_albedo(s, 1.5, between[::6])
        error = np.abs(looked_up(lobe_table(s, 1.5), between[::6]) - exact)
        assert np.max(error) < 1e-3
        assert np.max(error[between[::6] > 0.1]) < 1e-4

    def test_the_shaders_table(self, ctx):
        rows = np.stack([np.linspace(0.0, 3.0, 257) ** 2] * 4, axis=-1).astype(np.float32)
        texture = ctx.texture((257, 1), 4, rows.tobytes(), dtype="f4")
        mu = np.linspace(-0.1, 1.0, 999).astype(np.float32)
        body = "result = looked_up(0, mu.x);"
        shown = glsl.evaluate(
            ctx, ["ambient.glsl"], body, {"mu": mu}, samplers={"albedo_table": texture}
        )
        texture.release()
        np.testing.assert_allclose(
            shown[:, 0], looked_up(rows[:, 0].astype(np.float64), mu), rtol=1e-4, atol=1e-4
        )


class TestMitsuba:
    def test_lamps_and_surround_on_a_diffuse_sphere(self, renderer):
        """Mitsuba's `point` and `constant` emitters; radiance relative to the brightest pixel."""
        mi = pytest.importorskip("mitsuba")
        mi.set_variant("scalar_rgb")
        further = (FurtherLamp(-60.0, 30.0, 0.4, share=0.25),)
        lamp = Lamp(azimuth_deg=30.0, distance_m=0.5, ambient=0.35)
        scene = lit_scene(materials.flat(0.4), lamp, further, "sphere")
        frame = renderer.render(scene, Look(), TINY)
        view = View.of(scene, TINY)
        ours = frame.diffuse[..., 1] / 0.4
        radius = 0.5 * scene.shape.diameter_m
        # An intensity of one gives the perfect diffuser cos / (pi d^2); the surround's radiance is
        # what makes its share 0.35 of the whole.
        white = np.max(lights.white_seen(scene.setup, frame.point_m, frame.normal)[frame.on_object])
        surround = float(0.35 / 0.65 * white / np.pi)
        emitters = [
            {
                "type": "point",
                "position": [float(v) for v in place.position_m],
                "intensity": {"type": "rgb", "value": [share] * 3},
            }
            for place, share in ((lamp, 1.0), (further[0], 0.25))
        ]
        emitters.append({"type": "constant", "radiance": {"type": "rgb", "value": [surround] * 3}})
        bsdf = {"type": "diffuse", "reflectance": {"type": "spectrum", "value": 0.4}}
        # One emitter a world, sampled so that nothing is left to chance.
        worlds = [
            mi.load_dict(
                {
                    "type": "scene",
                    "integrator": {
                        "type": "direct",
                        "emitter_samples": int(emitter["type"] == "point"),
                        "bsdf_samples": int(emitter["type"] != "point"),
                    },
                    "object": {"type": "sphere", "radius": radius, "bsdf": bsdf},
                    "light": emitter,
                }
            )
            for emitter in emitters
        ]
        sampler = mi.load_dict({"type": "independent"})
        eye = [float(v) for v in view.eye_m]
        rays = view.rays(slice(0, TINY[1]))
        spots = np.argwhere(frame.on_object)[::97]
        theirs = []
        for row, column in spots:
            ray = mi.RayDifferential3f(eye, [float(v) for v in _unit(rays[row, column])])
            values = [world.integrator().sample(world, sampler, ray)[0][1] for world in worlds]
            theirs.append(np.sum(values) / 0.4 * np.pi / white * 0.65)
        own = ours[tuple(spots.T)]
        np.testing.assert_allclose(own, theirs, atol=2e-3)
        # Negative control: half the surround is seen.
        assert np.max(np.abs(own - 0.17 - np.array(theirs))) > 0.1

    @pytest.mark.parametrize("s_deg", [1.0, 6.0])
    def test_a_mirrored_surround(self, s_deg):
        """A narrow lobe of a metal that reflects all shows nearly all of a constant emitter."""
        mi = pytest.importorskip("mitsuba")
        mi.set_variant("scalar_rgb")
        s = float(np.radians(s_deg))
        for mu_o in (1.0, 0.6):
            eye = [float(np.sqrt(1.0 - mu_o**2)), 0.0, mu_o]
            bsdf = mi.load_dict(
                {
                    "type": "roughconductor",
                    "material": "none",
                    "distribution": "beckmann",
                    "alpha": float(np.sqrt(2.0) * s),
                }
            )
            hit = mi.SurfaceInteraction3f()
            hit.wi = mi.Vector3f(eye)
            rng = np.random.default_rng(3)
            theirs = np.mean(
                [
                    bsdf.sample(mi.BSDFContext(), hit, rng.random(), rng.random(2).tolist())[1][1]
                    for _ in range(3000)
                ]
            )
            parts = (lobe_table(s, part) for part in MetalPart)
            own = sum(looked_up(part, np.array(mu_o)) for part in parts)
            assert own == pytest.approx(theirs, abs=5e-3)

    @pytest.mark.parametrize(("s_deg", "radius", "theta_deg"), [(0.5, 0.1, 0.0), (2.0, 0.1, 30.0)])
    def test_a_disc(self, s_deg, radius, theta_deg):
        mi = pytest.importorskip("mitsuba")
        mi.set_variant("scalar_rgb")
        case = mi, s_deg, radius, theta_deg
        assert lamp_discs.largest_error(*case, samples=4000) < 0.07
        # Negative control: a point lamp is something else.
        assert lamp_discs.largest_error(*case, sized=False, samples=4000) > 0.5

    @pytest.mark.slow
    @pytest.mark.parametrize("theta_deg", lamp_discs.INCIDENCES_DEG)
    @pytest.mark.parametrize("radius", [0.02, 0.05, 0.1])
    @pytest.mark.parametrize("s_deg", lamp_discs.WIDTHS_DEG)
    def test_every_disc(self, s_deg, radius, theta_deg):
        """The tolerance of docs/light.md."""
        mi = pytest.importorskip("mitsuba")
        mi.set_variant("scalar_rgb")
        assert lamp_discs.largest_error(mi, s_deg, radius, theta_deg) < 0.1


def _unit(v):
    return v / np.linalg.norm(v)


class TestSize:
    @pytest.mark.parametrize("t", [0.2, 1.0, 2.0, 3.0, 8.0, 20.0])
    def test_a_gaussian_averaged_over_a_disc(self, t):
        """The non-central chi-squared distribution: peak exact, elsewhere as documented."""
        ncx2 = pytest.importorskip("scipy.stats").ncx2
        x = np.linspace(0.0, t + 6.0, 400)
        exact = ncx2.cdf(t * t, 2, x * x) * 2.0 / (t * t)  # over the Gaussian's own peak
        up = np.broadcast_to(np.array([0.0, 0.0, 1.0]), (400, 3))
        f = brdf.facing(up, up, up)._replace(delta2=x * x * 1e-6)  # s = 0.001
        sin2_r = 4.0 * t * t * 1e-6
        delta2, peak = lights.spread_by_lamp(f, 0.5e6, np.zeros(400), sin2_r)
        own = peak * np.exp(-0.5e6 * delta2)
        assert own[0] == pytest.approx(exact[0], rel=1e-6)
        assert np.max(np.abs(own - exact)) < (0.011 if t <= 3.0 else 0.07) * exact[0]
        volume = [np.trapezoid(profile * x, x) for profile in (own, exact)]
        assert volume[0] == pytest.approx(volume[1], rel=5e-3)

    @pytest.mark.parametrize(("s_deg", "r"), [(0.5, 0.1), (6.0, 0.05), (15.0, 0.3)])
    def test_the_shaders_lobe(self, ctx, s_deg, r):
        rng = np.random.default_rng(5)
        n = np.tile([0.0, 0.0, 1.0], (4000, 1))
        i, h = (
            _rows(np.concatenate([rng.normal(0, w, (4000, 2)), np.ones((4000, 1))], 1))
            for w in (0.7, 1.5 * np.radians(s_deg))
        )
        o = 2.0 * np.sum(i * h, axis=-1)[:, None] * h - i
        n, i, o = (v.astype(np.float32) for v in (n, i, o))
        sharpness = 0.5 / np.radians(s_deg) ** 2
        terms = mean_lobe(float(np.radians(s_deg)), 1.5, 0.03, "paper")
        lobe = ", ".join(str(float(v)) for v in terms)
        body = f"""
            Facing f = facing(n.xyz, i.xyz, o.xyz);
            float share = across(n.xyz, i.xyz, o.xyz, f);
            vec2 spread = spread_by_lamp(f, {sharpness}, share, {r * r});
            Lobe wide = widened(Lobe({lobe}), f.cos_d, {r * r});
            result = vec4(spread.y * exp(-spread.x * {sharpness}), wide.sharpness / {sharpness},
                          wide.amplitude * wide.spread, share);"""
        shown = glsl.evaluate(ctx, ["brdf.glsl", "lamp_size.glsl"], body, {"n": n, "i": i, "o": o})
        n, i, o = (_rows(v.astype(np.float64)) for v in (n, i, o))
        f = brdf.facing(n, i, o)
        share = lights.across(n, i, o, f)
        delta2, peak = lights.spread_by_lamp(f, sharpness, share, r * r)
        wide = lights.widened(terms, f.cos_d, r * r)
        np.testing.assert_allclose(shown[:, 0], peak * np.exp(-sharpness * delta2), atol=2e-3)
        np.testing.assert_allclose(shown[:, 1], wide.sharpness / sharpness, rtol=1e-4)
        np.testing.assert_allclose(shown[:, 2], wide.amplitude * wide.spread, rtol=1e-3)
        steady = np.linalg.norm(np.cross(i, o), axis=-1) > 0.05
        steady &= f.delta2 > 1e-4
        np.testing.assert_allclose(shown[steady, 3], share[steady], atol=2e-2)

    def test_a_large_lamp_is_reported(self, renderer):
        scene = lit_scene(materials.paper("art"), Lamp(radius_m=0.3))
        assert any("too large" in w for w in renderer.render(scene, Look(), TINY).warnings)
        scene = lit_scene(materials.paper("art"), Lamp(radius_m=0.05))
        assert renderer.render(scene, Look(), TINY).warnings == ()


def _rows(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


@pytest.mark.parametrize("lamp", [Lamp(ambient=0.3), Lamp(radius_m=0.08)], ids=["ambient", "disc"])
def test_a_pose_has_all_the_light(reference, lamp):
    """c_max of the pose against that of a picture."""
    material = materials.paper("art")
    scene = lit_scene(material, lamp, THREE[:1])
    frame = reference.render(scene, Look(), (128, 128))
    extremes = Pose(scene.setup).extremes(material)
    assert extremes.smallest_ratio == pytest.approx(frame.c_max, rel=0.03)
    # Negative control: the main lamp alone has another c_max.
    plain = Pose(Setup()).extremes(material)
    assert plain.smallest_ratio != pytest.approx(frame.c_max, rel=0.03)


def test_a_further_lamps_highlight_is_gloss(renderer):
    """The main lamp lies beside the mirror direction of a plane, another one in it."""
    material = materials.paper("art")
    for azimuth_deg, seen in ((0.0, True), (-60.0, False)):
        scene = lit_scene(material, Lamp(60.0), (FurtherLamp(azimuth_deg),), "plane")
        assert (NO_GLOSS in renderer.render(scene, Look(), TINY).warnings) != seen
