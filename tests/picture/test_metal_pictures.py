"""Pictures of a metal's lobe: the GPU against the float64 reference, and cheaper methods."""

from __future__ import annotations

import dataclasses

import glsl
import materials
import numpy as np
import pytest
from frames import SIZE, SMALL, assert_same_picture, delta_e
from splits import excess, internal_format
from test_twins import call, directions, twin  # noqa: F401

from relgloss_view.material import brdf
from relgloss_view.material.material import Diffuse, Lobe
from relgloss_view.picture.gpu.targets import METAL_WEIGHTS, WEIGHTS
from relgloss_view.picture.gpu.variant import Variant
from relgloss_view.picture.method import EXACT, FIRST_PASS, Method
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Lamp
from relgloss_view.quality.domains import outside
from relgloss_view.quality.planner import advise
from relgloss_view.quality.proxy import Proxy

GOLD = tuple(float(v) for v in np.linspace(0.38, 0.95, 35))
METAL = Lobe((0.9,), 4.0, f0=GOLD)
VARNISH = Lobe((1.0,), 2.0)


def foil(*lobes):
    """Foil under ink: a metal's lobes over the green of the papers."""
    return dataclasses.replace(materials.paper("art"), specular=lobes)


def scene(*lobes, azimuth_deg=110.0):
    return Scene(foil(*lobes), lamp=Lamp(azimuth_deg=azimuth_deg, illuminant="HP5"))


@pytest.mark.parametrize("azimuth_deg", [20.0, 110.0, 150.0])
@pytest.mark.parametrize(
    "lobes", [(METAL,), (METAL, VARNISH), (VARNISH, METAL), (METAL, Lobe((0.3,), 15.0, f0=(0.5,)))]
)
def test_against_the_reference(renderer, reference, lobes, azimuth_deg):
    wanted = scene(*lobes, azimuth_deg=azimuth_deg)
    frame, truth = (r.render(wanted, Look(), SMALL) for r in (renderer, reference))
    assert_same_picture(frame, truth)
    for name in ("diffuse", "specular"):
        found, expected = getattr(frame, name), getattr(truth, name)
        assert np.max(np.abs(found - expected)) < 1e-4 * np.max(expected)


def test_grain_samples_and_bands(renderer, reference):
    wanted = scene(METAL, VARNISH)
    for look in (Look(sigma_n_deg=1.0, c=0.2), Look(samples=2)):
        assert_same_picture(*(r.render(wanted, look, SMALL) for r in (renderer, reference)))
    summed = Method(variant=(("bands", 35),))
    exact, other = (renderer.render(wanted, Look(), SMALL, m) for m in (EXACT, summed))
    assert excess(exact, other, 35) <= 2.0


@pytest.mark.parametrize("samples", [1, 2])
def test_the_split_in_pass_1_is_the_same(renderer, samples):
    wanted, look = scene(METAL, VARNISH), Look(c=0.3, samples=samples)
    first, second = (
        renderer.render(wanted, look, SMALL, m) for m in (Method(split=FIRST_PASS), EXACT)
    )
    assert excess(first, second) <= 2.0


def test_a_colour_that_stays_is_another_picture(renderer, reference):
    # Negative control: a dielectric whose strength has the metal's colour, as bright head on.
    coloured = Lobe(tuple(0.9 * v / 0.04 for v in GOLD), 4.0)
    found, other = (
        renderer.render(scene(lobe, azimuth_deg=150.0), Look(c=0.05), SIZE)
        for lobe in (METAL, coloured)
    )
    assert np.max(delta_e(found, other)) > 5.0


def test_targets(renderer):
    """Without a metal pass 1 writes what it always wrote; with one, two weights a lobe."""
    for lobes, targets, numbers in (
        ((VARNISH,), WEIGHTS, "RG32F"),
        ((METAL,), METAL_WEIGHTS, "RGBA32F"),
        ((VARNISH, METAL), METAL_WEIGHTS, "RGBA32F"),
    ):
        wanted = scene(*lobes)
        renderer.render(wanted, Look(), SMALL, EXACT)
        assert Variant.of(wanted, Look()).targets == targets
        assert internal_format(renderer, targets[1]) == numbers
    assert Variant.of(scene(VARNISH, METAL), Look()).metals == 2
    assert Variant.of(scene(VARNISH), Look()).metals == 0


def test_twins(ctx, directions):  # noqa: F811
    s = float(np.radians(4.0))
    f = twin(directions)
    amplitude = brdf.facet_amplitude(s)
    lobe = f"Lobe({0.5 / s**2!r}, {amplitude!r}, 1.5, 0.0)"
    found = call(ctx, directions, f"vec4(metal_torrance_sparrow(f, {lobe}), 0, 0)")
    peak = amplitude * brdf.shadowing(f) / 4
    steady = (np.minimum(f.mu_i, f.mu_o) > 1e-3) & (f.cos_d > 1e-3)
    for k, expected in enumerate(brdf.metal_torrance_sparrow(f, s)):
        # As in test_twins.py; w itself is off by five roundings.
        error = np.abs(found[:, k] - expected)[steady] / peak[steady]
        assert np.max(error) < 4e-7 / s + 4e-6
    cosine = np.linspace(0.0, 1.0, 2001, dtype=np.float32)
    body = "result = vec4(schlick_weight(c.x));"
    weight = glsl.evaluate(ctx, ["brdf.glsl"], body, {"c": cosine})[:, 0]
    np.testing.assert_allclose(weight, brdf.schlick_weight(cosine), rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("lobes", [(METAL,), (METAL, VARNISH)])
def test_cheaper_methods_are_measured_with_the_metal(renderer, lobes):
    """The proxy's error of what `advise` takes is that of the pictures."""
    wanted, look = scene(*lobes), Look(c=0.2)
    advice = advise(wanted, look, SIZE)
    assert advice.error.highlight_p95 <= 0.5
    exact, cheap = (renderer.render(wanted, look, SIZE, m) for m in (EXACT, advice.method))
    assert np.percentile(delta_e(cheap, exact), 95.0) <= 0.5


def test_a_metal_has_its_own_reflectance_whatever_the_method(renderer):
    constant = Method(fresnel="constant")
    wanted = scene(METAL)
    assert not any(name.startswith("fresnel") for name in outside(wanted, Look(), constant))
    frames = [renderer.render(wanted, Look(c=0.2), SMALL, m).display for m in (EXACT, constant)]
    np.testing.assert_array_equal(*frames)
    assert Proxy(wanted, Look(c=0.2), SMALL).error(constant).largest == 0.0
    # Beside a dielectric lobe the choice counts, for that lobe.
    beside = scene(METAL, VARNISH, azimuth_deg=150.0)
    assert any(name.startswith("fresnel") for name in outside(beside, Look(), constant))


def test_mean_of_the_grain(renderer):
    """noise "mean": the widened lobe, against the mean of many grains."""
    wanted = scene(METAL)
    gray = dataclasses.replace(wanted.material, diffuse=Diffuse("lambert", (0.2,) * 35))
    wanted = dataclasses.replace(wanted, material=gray)
    look = Look(sigma_n_deg=2.0, c=0.1)
    mean = renderer.render(wanted, look, SMALL, Method(noise="mean")).specular
    grains = [
        renderer.render(wanted, dataclasses.replace(look, seed=seed), SMALL, EXACT).specular
        for seed in range(60)
    ]
    rows = slice(40, 80)
    drawn = np.mean([g[rows].sum(axis=(0, 1)) for g in grains], axis=0)
    np.testing.assert_allclose(mean[rows].sum(axis=(0, 1)), drawn, rtol=0.02)
    plain = renderer.render(wanted, Look(c=0.1), SMALL, EXACT).specular
    assert np.max(plain) > 1.1 * np.max(mean)  # negative control: the grain matters
