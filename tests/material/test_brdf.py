"""Reflection models against closed forms, published values and an independent renderer."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.material import brdf

Z = np.array([0.0, 0.0, 1.0])


def direction(theta, phi=0.0):
    theta, phi = np.broadcast_arrays(theta, phi)
    return np.stack(
        [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1
    )


def facing(i, o):
    return brdf.facing(Z, i, o)


def random_pairs(count=4000, seed=5):
    rng = np.random.default_rng(seed)
    theta = np.arccos(rng.uniform(0.001, 1.0, (2, count)))
    phi = rng.uniform(0, 2 * np.pi, (2, count))
    return direction(theta[0], phi[0]), direction(theta[1], phi[1])


def diffuse_albedo(model, sigma, theta_i, rho=1.0):
    """Directional albedo by Gauss-Legendre in mu and the trapezoid in azimuth.

    The integrands have a kink where cos(phi) changes sign, at which the trapezoid with 720 steps
    errs by (2 pi / 720)^2 ~ 8e-5 of the term; the bound of the callers leaves room for it.
    """
    x, w = np.polynomial.legendre.leggauss(128)
    mu = 0.5 * (x + 1.0)
    phi = (np.arange(720) + 0.5) * 2 * np.pi / 720
    o = direction(np.arccos(mu)[:, None], phi[None, :])
    first, second = brdf.diffuse_shapes(model, facing(direction(theta_i), o), sigma)
    f = rho * first + brdf.second_albedo(model, rho, sigma) * second
    return float(np.sum(0.5 * w * mu * f.mean(axis=1)) * 2 * np.pi)


class TestFresnel:
    # Black glass n = 1.567 at the gloss meter's angles, n = 1.540 at TAPPI's, four digits.
    @pytest.mark.parametrize(
        ("angle_deg", "n", "percent"),
        [(20, 1.567, 4.91), (60, 1.567, 10.01), (85, 1.567, 61.9), (75, 1.540, 26.02)],
    )
    def test_standard_glass(self, angle_deg, n, percent):
        value = 100 * brdf.fresnel_dielectric(np.cos(np.radians(angle_deg)), n)
        assert value == pytest.approx(percent, abs=0.5 * 10.0 ** -(2 if percent < 60 else 1))

    def test_closed_forms(self):
        n = np.array([1.0, 1.3, 1.5, 2.4])
        np.testing.assert_allclose(brdf.fresnel_dielectric(1.0, n), ((n - 1) / (n + 1)) ** 2)
        assert np.all(brdf.fresnel_dielectric(np.linspace(0, 1, 50), 1.0) == 0.0)
        assert brdf.fresnel_dielectric(0.0, 1.5) == pytest.approx(1.0)

    def test_against_amplitude_coefficients(self):
        # Fresnel's own sine and tangent laws, another form of the same physics.
        theta = np.radians(np.linspace(1, 89, 89))
        refracted = np.arcsin(np.sin(theta) / 1.5)
        s = np.sin(theta - refracted) / np.sin(theta + refracted)
        p = np.tan(theta - refracted) / np.tan(theta + refracted)
        np.testing.assert_allclose(
            brdf.fresnel_dielectric(np.cos(theta), 1.5), 0.5 * (s**2 + p**2), rtol=1e-12
        )


class TestFacets:
    @pytest.mark.parametrize("s_deg", [0.05, 0.7, 3.0, 12.0])
    def test_amplitude_is_dawsons_integral(self, s_deg):
        from scipy.special import dawsn

        s = np.radians(s_deg)
        # The closed form runs to infinity; up to 12 degrees nothing lies beyond 90.
        expected = 1.0 / (np.pi * np.sqrt(2) * s * dawsn(np.sqrt(2) * s))
        assert brdf.facet_amplitude(s) == pytest.approx(expected, rel=1e-10)

    @pytest.mark.parametrize("s_deg", [0.05, 1.0, 15.0, 40.0])
    def test_projected_area_is_one(self, s_deg):
        from scipy.integrate import quad

        s = np.radians(s_deg)

        def integrand(delta):
            density = brdf.facet_density(np.array(delta * delta), s)
            return 2 * np.pi * density * np.cos(delta) * np.sin(delta)

        area, _ = quad(integrand, 0, min(9 * s, np.pi / 2), epsabs=1e-12, limit=200)
        assert area == pytest.approx(1.0, abs=1e-8)


#: Incidences and widths in degrees at which the albedo is computed by every run of the tests.
FEW = {(0.0, 5.0), (60.0, 2.0), (75.0, 40.0), (85.0, 0.5), (85.0, 5.0)}


class TestTorranceSparrow:
    @pytest.mark.parametrize(
        ("theta_deg", "s_deg"),
        [
            pytest.param(theta, s, marks=() if (theta, s) in FEW else pytest.mark.slow)
            for theta in (0.0, 30.0, 60.0, 75.0, 85.0)
            for s in (0.5, 2.0, 5.0, 15.0, 30.0, 40.0)
        ],
    )
    def test_albedo_is_at_most_one(self, theta_deg, s_deg):
        # F = 1 is the hardest case. Half-vectors are integrated over, where the lobe is smooth:
        # dw_o = 4 (i.h) dw_h.
        s, i = np.radians(s_deg), direction(np.radians(theta_deg))
        x, w = np.polynomial.legendre.leggauss(400)
        upper = min(9 * s, np.pi / 2)
        delta = 0.5 * upper * (x + 1)
        phi = (np.arange(720) + 0.5) * 2 * np.pi / 720
        h = direction(delta[:, None], phi[None, :])
        ih = h @ i
        o = 2 * ih[..., None] * h - i
        f = facing(np.broadcast_to(i, o.shape), o)
        value = 0.25 * brdf.facet_density(f.delta2, s) * brdf.shadowing(f)
        seen = (f.mu_o > 0) & (ih > 0)
        value = np.where(seen, value * f.mu_o * 4 * ih, 0.0)
        albedo = np.sum(0.5 * upper * w * np.sin(delta) * value.mean(axis=1)) * 2 * np.pi
        assert albedo <= 1.0 + 1e-3
        assert albedo > 0.4  # it is a reflection, not darkness

    def test_without_shadowing_the_furnace_fails(self):
        # Negative control of the test above: G = 1 gives 3.08 at s = 30, incidence 85 degrees.
        s, i = np.radians(30.0), direction(np.radians(85.0))
        x, w = np.polynomial.legendre.leggauss(200)
        mu, phi = 0.5 * (x + 1), (np.arange(720) + 0.5) * 2 * np.pi / 720
        o = direction(np.arccos(mu)[:, None], phi[None, :])
        f = facing(np.broadcast_to(i, o.shape), o)
        value = 0.25 * brdf.facet_density(f.delta2, s) / (f.mu_i * f.mu_o)
        albedo = np.sum(0.5 * w * mu * value.mean(axis=1)) * 2 * np.pi
        assert albedo == pytest.approx(3.08, abs=0.02)

    def test_reciprocity(self):
        i, o = random_pairs()
        for s_deg in (0.5, 6.0, 30.0):
            there = brdf.torrance_sparrow(facing(i, o), np.radians(s_deg), 1.5)
            back = brdf.torrance_sparrow(facing(o, i), np.radians(s_deg), 1.5)
            np.testing.assert_allclose(there, back, rtol=1e-12, atol=1e-12)

    # Y at incidence 0, 60, 80 relative to white that faces the lamp, n = 1.5: known figures.
    @pytest.mark.parametrize(
        ("s_deg", "peaks"),
        [(0.1, (1641, 7321, 91618)), (0.5, (66, 293, 3665)), (2.0, (4.1, 18, 229))],
    )
    def test_mirror_peaks(self, s_deg, peaks):
        for theta_deg, expected in zip((0, 60, 80), peaks, strict=True):
            theta = np.radians(theta_deg)
            f = facing(direction(theta), direction(-theta))
            value = float(np.pi * brdf.torrance_sparrow(f, np.radians(s_deg), 1.5) * f.mu_i)
            assert value == pytest.approx(expected, rel=0.02)  # some are given to two digits

    @pytest.mark.parametrize("theta_deg", [0.0, 20.0, 45.0, 60.0])
    def test_narrow_lobe_against_mitsuba(self, theta_deg):
        """Mitsuba's rough conductor with k = 0 is a dielectric; Beckmann alpha = sqrt(2) s.

        For s = 0.7 deg within 2 s, tan^2 differs from the angle's square by 1e-3 and its cos^-4 and
        Smith terms by less than 1e-3 at 60 degrees: 1 % is left for them together. A normalisation
        of 1/pi in place of 1/4 would be 27 % off.
        """
        mi = pytest.importorskip("mitsuba")
        mi.set_variant("scalar_rgb")
        s = np.radians(0.7)
        lobe = mi.load_dict(
            {
                "type": "roughconductor",
                "distribution": "beckmann",
                "alpha": float(np.sqrt(2) * s),
                "eta": {"type": "rgb", "value": 1.5},
                "k": {"type": "rgb", "value": 0.0},
            }
        )
        theta = np.radians(theta_deg)
        for offset in (0.0, 1.0, 2.0):
            i, o = direction(theta), direction(-theta + 2 * offset * s)
            si = mi.SurfaceInteraction3f()
            si.wi = mi.Vector3f(*[float(v) for v in i])
            value = lobe.eval(mi.BSDFContext(), si, mi.Vector3f(*[float(v) for v in o]))
            ours = brdf.torrance_sparrow(facing(i, o), s, 1.5) * o[2]
            assert float(ours) == pytest.approx(float(value[0]), rel=0.01)

    def test_unit_index_reflects_nothing(self):
        i, o = random_pairs(200)
        assert np.all(brdf.torrance_sparrow(facing(i, o), 0.1, 1.0) == 0.0)


class TestHorizon:
    @pytest.mark.parametrize("model", ["lambert", "oren-nayar", "eon", "qualitative"])
    @pytest.mark.parametrize(("mu_i", "mu_o"), [(-0.2, 0.5), (0.5, -0.2), (-0.3, -0.4), (0.0, 0.5)])
    def test_nothing_is_lit_or_seen_from_below(self, model, mu_i, mu_o):
        f = brdf.Facing(*(np.array([v]) for v in (mu_i, mu_o, 0.1, 0.6, 0.2)))
        for part in brdf.diffuse_shapes(model, f, 0.4):
            assert part.tolist() == [0.0]
        assert brdf.torrance_sparrow(f, 0.1, 1.5).tolist() == [0.0]


class TestDiffuse:
    @pytest.mark.parametrize("r", [0.0, 0.1, 0.5, 1.0])
    @pytest.mark.parametrize("theta_deg", [0.0, 40.0, 75.0, 88.0])
    def test_eon_white_furnace(self, r, theta_deg):
        # Its albedo polynomial is fitted by its authors to within 1e-3.
        assert diffuse_albedo("eon", r, np.radians(theta_deg)) == pytest.approx(1.0, abs=1e-3)

    def test_eon_mean_albedo_is_the_mean_of_the_directional_one(self):
        x, w = np.polynomial.legendre.leggauss(64)
        mu = 0.5 * (x + 1)
        for r in (0.1, 0.6, 1.0):
            mean = np.sum(w * mu * brdf.fujii_albedo(mu, r))
            assert mean == pytest.approx(brdf.fujii_mean_albedo(r), abs=1e-3)

    def test_eon_without_roughness_is_lambert(self):
        i, o = random_pairs(500)
        first, second = brdf.eon(facing(i, o), 0.0)
        value = 0.8 * first + brdf.second_albedo("eon", 0.8, 0.0) * second
        np.testing.assert_allclose(value, 0.8 / np.pi, rtol=1e-6)

    def test_oren_nayar_without_roughness_is_lambert(self):
        i, o = random_pairs(500)
        first, second = brdf.oren_nayar(facing(i, o), 0.0)
        np.testing.assert_allclose(first, 1 / np.pi, rtol=1e-12)
        np.testing.assert_allclose(second, 0.0)

    def test_oren_nayar_known_furnace(self):
        # sigma 0.5, white, normal incidence: 0.896 (full model), verified against another program.
        assert diffuse_albedo("oren-nayar", 0.5, 0.0) == pytest.approx(0.896, abs=1e-3)

    def test_oren_nayar_retro_peak(self):
        # Their eqs. 30-31 by hand, sigma = 0.5, i = o at 60 degrees:
        # C1 = 1 - 0.125/0.58, C2 tan b = 0.45 (0.25/0.34) sin 60 tan 60,
        # L2 = 0.17 (0.25/0.38) (1 - (2/3)^2).
        f = facing(direction(np.radians(60.0)), direction(np.radians(60.0)))
        first, second = brdf.oren_nayar(f, 0.5)
        assert np.pi * first == pytest.approx(1 - 0.125 / 0.58 + 0.45 * 0.25 / 0.34 * 1.5)
        assert np.pi * second == pytest.approx(0.17 * 0.25 / 0.38 * (1 - 4 / 9))

    def test_oren_nayar_sideways(self):
        # The same by hand at both angles 60 degrees, azimuth 90: what is left of L1 is
        # C1 + C3 tan 60 with C3 = 0.125 (0.25/0.34) (4 (pi/3)^2 / pi^2)^2, and all of L2. Two known
        # shader libraries have 0.17 for 0.125 here, and tests that repeat it.
        i, o = direction(np.radians(60.0)), direction(np.radians(60.0), np.pi / 2)
        first, second = brdf.oren_nayar(facing(i, o), 0.5)
        c3 = 0.125 * 0.25 / 0.34 * (4.0 / 9.0) ** 2
        assert np.pi * first == pytest.approx(1 - 0.125 / 0.58 + c3 * np.sqrt(3.0))
        assert np.pi * second == pytest.approx(0.17 * 0.25 / 0.38)

    @pytest.mark.parametrize("rho", [0.2, 0.5, 0.9])
    def test_eon_multiple_scattering_is_its_series(self, rho):
        # Light that misses the eye after k bounces inside meets the albedo again: the sum of
        # rho (rho (1 - E))^k E rho over k >= 0 is what multiplies the second shape.
        mean = brdf.fujii_mean_albedo(0.7)
        series = sum(rho * mean * rho * (rho * (1.0 - mean)) ** k for k in range(400))
        assert brdf.second_albedo("eon", rho, 0.7) == pytest.approx(series, rel=1e-12)

    @pytest.mark.parametrize("sigma", [0.05, 0.2, 0.3, 0.5, 0.7])
    @pytest.mark.parametrize("theta_deg", [0.0, 45.0, 75.0, 88.0])
    def test_oren_nayar_furnace_in_its_range(self, sigma, theta_deg):
        """Up to rho = 0.93 the full model keeps within 1.

        Above it the model of 1995 itself gains energy at grazing incidence (5 % for white, sigma
        0.3): it is a fit to a simulation, and EON is there for those who need the furnace.
        """
        assert diffuse_albedo("oren-nayar", sigma, np.radians(theta_deg), rho=0.93) <= 1 + 1e-3

    def test_white_oren_nayar_gains_energy(self):
        # What the test above is limited for; if this stops holding, its range can be widened.
        assert diffuse_albedo("oren-nayar", 0.3, np.radians(88.0)) > 1.03

    @pytest.mark.parametrize("model", ["lambert", "oren-nayar", "eon"])
    def test_reciprocity(self, model):
        i, o = random_pairs()
        there, back = (brdf.diffuse_shapes(model, facing(a, b), 0.4) for a, b in ((i, o), (o, i)))
        np.testing.assert_allclose(there, back, rtol=1e-12, atol=1e-12)

    def test_transposed_is_not_reciprocal(self):
        # Negative control: a model that treats its directions unequally fails the same comparison.
        i, o = random_pairs()
        f, g = facing(i, o), facing(o, i)
        with pytest.raises(AssertionError):
            np.testing.assert_allclose(f.mu_i * brdf.lambert(f)[0], g.mu_i * brdf.lambert(g)[0])

    def test_grazing_and_polar_directions_are_finite(self):
        angles = np.array([0.0, 1e-9, 1e-5, 1.0, np.pi / 2 - 1e-9, np.pi / 2, 2.0])
        i, o = direction(angles[:, None], 0.3), direction(angles[None, :], 1.9)
        i, o = np.broadcast_arrays(i, o)
        f = facing(i, o)
        for sigma in (0.0, 0.5, 1.0):
            for model in ("lambert", "oren-nayar", "eon"):
                for shape in brdf.diffuse_shapes(model, f, sigma):
                    assert np.all(np.isfinite(shape))
                    assert np.all(shape >= 0.0)
        for s in (np.radians(0.05), np.radians(40.0)):
            value = brdf.torrance_sparrow(f, s, 1.5)
            assert np.all(np.isfinite(value))
            assert np.all(value >= 0.0)

    def test_opposite_directions_have_no_half_vector(self):
        f = facing(direction(0.4), -direction(0.4))
        assert f.cos_d == 0.0
        assert brdf.torrance_sparrow(f, 0.1, 1.5) == 0.0
