"""GGX, the judge and the refit against closed forms, the gloss meter and scipy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import optimize

from relgloss_view.exchange import ggx, judge
from relgloss_view.exchange.least_squares import least_squares
from relgloss_view.exchange.loss import MOST_DE2000, MOST_GLOSS_UNITS
from relgloss_view.exchange.metered import COARSE, reading
from relgloss_view.exchange.openpbr import OpenPbr, albedo
from relgloss_view.exchange.refit import linear_rgb, refit_openpbr
from relgloss_view.gloss.meter.geometry import SPECULAR
from relgloss_view.gloss.meter.meter import specular_gloss
from relgloss_view.material.material import Diffuse, Lobe, Material
from relgloss_view.measure.bands import RGB
from relgloss_view.pack.built_in import load_finish


def hemisphere(nodes=400):
    """Cosines and weights of solid angle over the hemisphere, dense at the pole."""
    x, weight = np.polynomial.legendre.leggauss(nodes)
    theta = 0.25 * np.pi * (x + 1.0)
    return np.cos(theta), 0.25 * np.pi * weight * 2.0 * np.pi * np.sin(theta)


@pytest.mark.parametrize("alpha", [0.02, 0.2, 0.9])
def test_facets_have_the_area_of_the_surface(alpha):
    cosine, weight = hemisphere()
    area = np.sum(weight * cosine * ggx.density(cosine, alpha))
    assert area == pytest.approx(1.0, abs=1e-6)  # Walter et al. 2007, eq. 4


@pytest.mark.parametrize("alpha", [0.1, 0.5])
def test_weak_white_furnace(alpha):
    """Smith's masking: the projected area of the visible facets is that of the surface.

    Heitz 2014, eq. 98: the integral of G1(o) D(h) / (4 cos_o) over all i is 1.
    """
    generator = np.random.default_rng(1)
    theta = math.radians(50.0)
    o = np.array([math.sin(theta), 0.0, math.cos(theta)])
    u, v = generator.random((2, 400_000))
    cos_h = np.sqrt((1.0 - u) / (1.0 + (alpha**2 - 1.0) * u))  # facets by D cos_h
    sin_h = np.sqrt(1.0 - cos_h**2)
    h = np.stack([sin_h * np.cos(2 * np.pi * v), sin_h * np.sin(2 * np.pi * v), cos_h], axis=-1)
    o_h = h @ o
    # The integrand over the density of i = D cos_h / (4 o.h), G1 from the separable product.
    up = np.array([0.0, 0.0, 1.0])
    g1 = 4.0 * o[2] * ggx.separable_shadowing(ggx.turn(up, o), alpha)
    mean = np.mean(np.where(o_h > 0.0, g1 * o_h / (o[2] * cos_h), 0.0))
    assert mean == pytest.approx(1.0, abs=0.01)


def test_the_fitted_albedo_is_that_of_the_lobe():
    """The rational fit of MaterialX against the integral of the lobe that it stands for."""
    surface = OpenPbr(
        base_weight=0.0, base_metalness=1.0, base_color=(1.0, 1.0, 1.0), specular_roughness=0.6
    )
    theta = math.radians(40.0)
    o = np.array([math.sin(theta), 0.0, math.cos(theta)])
    cosine, weight = hemisphere(200)
    phi = (np.arange(240) + 0.5) * 2.0 * np.pi / 240
    sine = np.sqrt(1.0 - cosine**2)[:, None]
    i = np.stack(
        [sine * np.cos(phi), sine * np.sin(phi), np.broadcast_to(cosine[:, None], (200, 240))],
        axis=-1,
    )
    t = ggx.turn(i, np.broadcast_to(o, i.shape))
    lobe = ggx.density(t.cos_h, 0.36) * ggx.shadowing(t, 0.36)
    whole = np.sum(weight[:, None] / 240 * lobe * i[..., 2])
    assert float(albedo(np.array(o[2]), 0.36, 1.0)) == pytest.approx(whole, abs=0.02)
    assert surface.base_alpha == pytest.approx(0.36)


@pytest.mark.parametrize("name", ["cast-coated", "gloss-varnish", "uncoated", "cold-foil-gold"])
def test_gloss_of_any_surface_is_that_of_the_gloss_meter(name):
    """Two quadratures of one definition; at 75 degrees the disc's edge differs by 1e-3 of it."""
    material = load_finish(name)
    for angle, meter in SPECULAR.items():
        exact = specular_gloss(material, angle)
        assert reading(material, meter) == pytest.approx(exact, rel=1e-3)
        assert reading(material, meter, COARSE) == pytest.approx(exact, rel=2.5e-2)


def test_the_search_finds_what_scipy_finds():
    generator = np.random.default_rng(3)
    matrix, aim = generator.normal(size=(40, 4)), generator.normal(size=40)
    low, high = np.full(4, -0.1), np.full(4, 0.1)

    def residuals(x):
        return matrix @ x + 0.3 * (matrix @ x) ** 2 - aim

    ours = least_squares(residuals, np.zeros(4), low, high)
    theirs = optimize.least_squares(residuals, np.zeros(4), bounds=(low, high))
    assert np.sum(residuals(ours) ** 2) == pytest.approx(2.0 * theirs.cost, rel=1e-4)


def test_a_refit_passes_where_a_renamed_width_fails():
    """The negative control of the refit: alpha = sqrt(2) s, all else as the material has it."""
    material = load_finish("matte-coated")
    refit = refit_openpbr(material)
    assert refit.loss.de2000_p95 <= MOST_DE2000
    assert refit.loss.largest_gloss_units <= MOST_GLOSS_UNITS
    lobe = material.specular[0]
    colour = np.clip(linear_rgb(np.asarray(material.diffuse.albedo), material) / 0.95, 0.0, 1.0)
    renamed = OpenPbr(
        base_color=tuple(colour.tolist()),
        base_diffuse_roughness=material.diffuse.sigma,
        specular_roughness=math.sqrt(math.sqrt(2.0) * lobe.s),
        specular_ior=lobe.refractive_index,
    )
    loss = judge.compare(material, renamed)
    assert loss.de2000_p95 > MOST_DE2000
    assert loss.largest_gloss_units > MOST_GLOSS_UNITS


def test_a_lobe_that_ggx_is_comes_back():
    """A surface of OpenPBR itself loses nothing: the search finds its parameters again."""
    from relgloss_view.exchange.ways import Family, Unknown, ways_to_show

    truth = OpenPbr(base_color=(0.4, 0.5, 0.2), specular_roughness=0.45, specular_weight=0.7)

    def make(x):
        return OpenPbr(
            base_color=tuple(float(v) for v in x[:3]),
            specular_roughness=float(x[3]),
            specular_weight=float(x[4]),
        )

    unknowns = (*[Unknown(0.3, 0.0, 1.0)] * 3, Unknown(0.3, 0.05, 1.0), Unknown(1.0, 0.0, 1.0))
    [way] = ways_to_show(truth, (Family("itself", unknowns, make),))
    assert way.surface.specular_roughness == pytest.approx(0.45, abs=2e-3)
    assert way.loss.de2000_p95 < 0.1


@pytest.mark.slow
def test_matter_without_a_lobe_is_refitted_too():
    gray = Material("gray", "by hand", RGB, Diffuse("lambert", (0.2, 0.2, 0.2)))
    refit = refit_openpbr(gray)
    assert refit.loss.de2000_p95 == 0.0  # there is no highlight
    assert refit.surface.specular_weight == 0.0
    assert refit.surface.base_color == pytest.approx((0.2,) * 3, abs=0.01)
    mirror = Material("mirror", "by hand", RGB, gray.diffuse, (Lobe((1.0,), 1e-3),))
    assert math.isfinite(refit_openpbr(mirror).loss.de2000_p95)


def test_the_highlight_of_a_body_beyond_white_is_judged():
    """At its own c of 0 each lobe would look alike, and a file would lose nothing whatever."""
    body = Diffuse("lambert", (1.5, 1.5, 1.5), 0.0)
    lobes = (Lobe((1.0,), 5.0, 1.5),)
    fluorescent = Material("x", "synthetic", RGB, body, lobes)
    without = Material("x", "synthetic", RGB, body, ())
    assert judge.compare(fluorescent, fluorescent).de2000_p95 == 0.0  # the control
    assert judge.compare(fluorescent, without).de2000_p95 > 3.0
