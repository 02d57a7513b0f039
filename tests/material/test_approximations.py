import numpy as np
import pytest
from scipy import special

from relgloss_view.material import approximations, brdf
from relgloss_view.material.approximations import plain_lobe
from tests import glsl
from tests.picture.test_twins import call, directions, float32, twin  # noqa: F401 - a fixture

DELTA = np.linspace(0.0, 0.5 * np.pi, 400_001)


def integral(density):
    """Of D cos(delta) over the hemisphere."""
    return 2.0 * np.pi * np.trapezoid(density * np.cos(DELTA) * np.sin(DELTA), DELTA)


class TestAgainstOthers:
    @pytest.mark.parametrize("s_deg", [0.7, 6.0, 20.0])
    def test_ggx_holds_as_much_area_as_the_surface(self, s_deg):
        # Closed form: Walter et al. 2007 normalise it so.
        sharpness = 0.5 / np.radians(s_deg) ** 2
        density = approximations.ggx_density(DELTA**2, sharpness)
        assert integral(density) == pytest.approx(1.0, abs=1e-4)

    @pytest.mark.parametrize("s_deg", [0.7, 6.0, 20.0])
    def test_beckmann_holds_as_much_area_as_the_surface(self, s_deg):
        sharpness = 0.5 / np.radians(s_deg) ** 2
        density = approximations.beckmann_density(DELTA**2, sharpness)
        assert integral(density) == pytest.approx(1.0, abs=1e-4)

    def test_beckmann_and_gaussian_meet_in_narrow_lobes(self):
        # tan(delta) = delta (1 + delta^2 / 3): at s = 0.5 deg they differ by some 1e-4.
        lobe = plain_lobe(float(np.radians(0.5)), 1.5)
        near = (3.0 * np.radians(0.5) * np.linspace(0, 1, 50)) ** 2
        gaussian = brdf.facet_density(near, float(np.radians(0.5)))
        beckmann = approximations.beckmann_density(near, lobe.sharpness)
        np.testing.assert_allclose(beckmann, gaussian, rtol=1e-3)

    def test_schlick_meets_fresnel_at_both_ends(self):
        # Published (Schlick 1994): exact at normal and at grazing incidence by construction.
        ends = np.array([1.0, 0.0])
        exact = brdf.fresnel_dielectric(ends, 1.5)
        np.testing.assert_allclose(approximations.fresnel_schlick(ends, 1.5), exact, atol=1e-12)
        np.testing.assert_allclose(exact, [0.04, 1.0], atol=1e-12)

    def test_schlick_is_not_fresnel_between(self):
        # Negative control, and what the chart is about: at 70 deg a sixth is missing or too much.
        c = np.cos(np.radians([60.0, 70.0, 80.0]))
        ratio = approximations.fresnel_schlick(c, 1.5) / brdf.fresnel_dielectric(c, 1.5)
        assert np.max(np.abs(ratio - 1.0)) > 0.1

    def test_qualitative_is_the_published_formula(self):
        # Oren, Nayar 1995, eq. 32: A + B max(0, cos phi) sin(alpha) tan(beta).
        rng = np.random.default_rng(2)
        theta_i, theta_o = rng.uniform(0.05, 1.4, (2, 500))
        phi = rng.uniform(0, np.pi, 500)
        i = np.stack([np.sin(theta_i), 0 * phi, np.cos(theta_i)], axis=-1)
        o = np.stack(
            [np.sin(theta_o) * np.cos(phi), np.sin(theta_o) * np.sin(phi), np.cos(theta_o)], axis=-1
        )
        sigma = 0.35
        a = 1.0 - 0.5 * sigma**2 / (sigma**2 + 0.33)
        b = 0.45 * sigma**2 / (sigma**2 + 0.09)
        alpha, beta = np.maximum(theta_i, theta_o), np.minimum(theta_i, theta_o)
        published = (a + b * np.maximum(0, np.cos(phi)) * np.sin(alpha) * np.tan(beta)) / np.pi
        f = brdf.facing(np.array([0.0, 0.0, 1.0]), i, o)
        first, second = brdf.qualitative_oren_nayar(f, sigma)
        np.testing.assert_allclose(first, published, rtol=1e-12)
        assert not np.any(second)


MODELS = [
    ("schlick", "v-groove", "gaussian"),
    ("constant", "none", "gaussian"),
    ("exact", "v-groove", "beckmann"),
    ("exact", "v-groove", "ggx"),
    ("exact", "v-groove", "mean-gaussian"),
]


@pytest.mark.parametrize("models", MODELS)
@pytest.mark.parametrize("s_deg", [0.5, 6.0])
def test_twins(ctx, directions, models, s_deg):  # noqa: F811
    """Bound relative to the lobe's own peak, as for the exact lobe in test_twins.py."""
    s, f = float(np.radians(s_deg)), twin(directions)
    lobe = plain_lobe(s, 1.5)
    if models[2] == "mean-gaussian":
        lobe = approximations.mean_lobe(s, 1.5, 1.3 * s, "paper")
    n, i, o = directions
    defines = {
        "FRESNEL": approximations.FRESNEL.index(models[0]),
        "SHADOWING": approximations.SHADOWING.index(models[1]),
        "FACETS": approximations.FACETS.index(models[2]),
    }
    text = ", ".join(repr(float(v)) for v in lobe)
    expression = f"torrance_sparrow(f, Lobe({text}))"
    body = f"Facing f = facing(n.xyz, i.xyz, o.xyz); result = vec4({expression});"
    inputs = {"n": n, "i": i, "o": o}
    result = glsl.evaluate(ctx, ["brdf.glsl"], body, inputs, defines=defines)[:, 0]
    expected = approximations.torrance_sparrow(f, lobe, *models)
    peak = approximations.torrance_sparrow(f._replace(delta2=0 * f.delta2), lobe, *models)
    steady = (np.minimum(f.mu_i, f.mu_o) > 1e-3) & (f.cos_d > 1e-3)
    bound = 6e-7 / s + 3e-6
    assert np.max(np.abs(result - expected)[steady] / peak[steady]) < bound
    assert np.all(np.isfinite(result))
    assert np.all(result >= 0)


def test_bessel(ctx):
    z = float32(np.concatenate([np.linspace(0, 20, 20_001), 10 ** np.linspace(1, 6, 1000)]))
    result = glsl.evaluate(ctx, ["brdf.glsl"], "result = vec4(bessel_i0e(z.x));", {"z": z})[:, 0]
    # The published bounds, 1.6e-7 on I0 and 1.9e-7 on sqrt(z) e^-z I0, and float32's rounding.
    expected = special.i0e(z.astype(np.float64))
    np.testing.assert_allclose(result, expected, rtol=1.5e-6)
    np.testing.assert_allclose(approximations.bessel_i0e(z), expected, rtol=6e-7)


@pytest.mark.parametrize(("choice", "bound"), [(0, 4.5e-7), (1, 3e-6)])
def test_cube_roots(ctx, choice, bound):
    t = float32(10 ** np.linspace(-9, 6, 30_000))
    body = "result = vec4(cube_root(t.x));"
    result = glsl.evaluate(ctx, ["cube_root.glsl"], body, {"t": t}, defines={"CUBE_ROOT": choice})
    np.testing.assert_allclose(result[:, 0], np.cbrt(t.astype(np.float64)), rtol=bound)
