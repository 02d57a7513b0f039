"""The meter's compressed and level integrals against the plain sums over vectors, as a control."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from relgloss_view.base.resources import asset
from relgloss_view.gloss.meter.compressed import LEAST_INDEX, compressed
from relgloss_view.gloss.meter.geometry import (
    DIFFUSE_NODES,
    DISTINCTNESS,
    HAZE,
    MIRROR_DEG,
    SPECULAR,
    facet_flux,
)
from relgloss_view.gloss.meter.geometry import _directions as directions
from relgloss_view.gloss.meter.meter import from_fluxes, gloss_readings
from relgloss_view.gloss.meter.shares import WINDOWS, lobe_flux
from relgloss_view.gloss.meter.uncertainty import fitted_steps, standard_error
from relgloss_view.material import brdf, spectra
from relgloss_view.material.albedo import directional_albedo
from relgloss_view.material.files import load_material
from relgloss_view.material.material import DIFFUSE_MODELS, Diffuse, FitRecord, Lobe, Material
from relgloss_view.measure.bands import RGB, Bands
from relgloss_view.picture.scene.sample import SAMPLES, load_sample

METERS = (*SPECULAR.values(), HAZE, DISTINCTNESS)
FINISHES = ("cold-foil-gold", "gloss-varnish", "kraft", "satin-varnish")
#: Both ways sum the same nodes; a reading differs by the rounding of some 1e4 terms, and a standard
#: error is a difference of readings of at most about 100, which keeps their absolute rounding.
RELATIVE, ABSOLUTE = 1e-9, 1e-13


def plain_lobe_flux(meter, window, s_deg, fresnel):
    """The sum over all nodes, each a pair of vectors."""
    s = float(np.radians(max(s_deg, MIRROR_DEG)))
    amplitude = brdf.facet_amplitude(s)
    return facet_flux(
        meter, window, lambda d2: brdf.facet_density(d2, s, amplitude), fresnel, s
    )  # fmt: skip


class Control:
    """Readings of materials by plain sums; equal parts of moved materials are summed once."""

    def __init__(self):
        self.fluxes, self.bodies = {}, {}

    def flux(self, material, meter, window):
        weight = material.xyz_weights(spectra.illuminant("C"))[:, 1]
        body = material.diffuse
        key = (meter, window, body.model, body.sigma)
        if key not in self.bodies:
            f, area = directions(meter, window, None, DIFFUSE_NODES)
            shapes = brdf.diffuse_shapes(body.model, f, body.sigma)
            self.bodies[key] = [float(np.sum(area * f.mu_o * shape)) for shape in shapes]
        first, second = self.bodies[key]
        total = first * (weight @ np.asarray(body.albedo))
        total += second * (weight @ material.second_albedo())
        for lobe in material.visible_lobes():
            for part in lobe.parts(material.bands.count):
                key = (meter, window, lobe.s_deg, part.fresnel)
                if key not in self.fluxes:
                    self.fluxes[key] = plain_lobe_flux(*key)
                total += self.fluxes[key] * float(weight @ part.spectrum)
        return total

    def metered(self, meter):
        return lambda m: from_fluxes(meter, [self.flux(m, meter, w) for w in meter.windows])

    @staticmethod
    def contrast(material):
        weight = material.xyz_weights(spectra.illuminant("C"))[:, 1]
        diffuse, specular = (float(weight @ part[0]) for part in directional_albedo(material, 0.0))
        return float(np.cbrt(specular + 0.5 * diffuse) - np.cbrt(0.5 * diffuse))

    def readings(self, material):
        """(value, standard error) by key."""
        steps = fitted_steps(material)
        numbers = {meter.key: self.metered(meter) for meter in METERS}
        numbers["contrast-gloss"] = self.contrast
        return {key: (of(material), standard_error(of, steps)) for key, of in numbers.items()}


def random_material(k):
    """A fitted material that no paper is: any model, lobes from mirror to velvet, metals."""
    rng = np.random.default_rng([7, k])
    bands = RGB if k % 2 else Bands(tuple(np.linspace(400.0, 700.0, 31)))
    lobes, errors = [], {"albedo_relative": 0.01, "sigma_deg": float(rng.uniform(0, 8))}
    errors |= {"s_deg": [], "strength": [], "refractive_index": []}
    for j in range(1 + k % 2):
        s_deg = 40.0 if k % 7 == 6 else float(np.exp(rng.uniform(np.log(0.02), np.log(35.0))))
        metal = tuple(rng.uniform(0.2, 0.95, bands.count)) if (k + j) % 4 == 3 else None
        index = 1.02 if k % 5 == 4 else float(rng.uniform(1.3, 2.2))
        lobes.append(Lobe((float(rng.uniform(0.05, 1.0)),), s_deg, index, metal))
        errors["s_deg"].append(s_deg * float(rng.uniform(0.001, 0.5)))
        errors["strength"].append(float(rng.uniform(0.0, 0.05)))
        errors["refractive_index"].append(float(rng.choice([0.0, 0.01, 0.05])))
    body = Diffuse(
        DIFFUSE_MODELS[k % len(DIFFUSE_MODELS)],
        tuple(rng.uniform(0.02, 0.95, bands.count)),
        float(rng.uniform(0.0, 50.0)),
    )
    fit = FitRecord(standard_errors=errors)
    return Material(f"random {k}", "by hand", bands, body, tuple(lobes), fit=fit)


def finish(name):
    return load_material(asset("finishes", f"{name}.json"))


def assert_same(material):
    expected = Control().readings(material)
    for reading in gloss_readings(material):
        if reading.key not in expected:
            continue
        value, error = expected[reading.key]
        close = {"rel": RELATIVE, "abs": ABSOLUTE}
        assert reading.value == (None if value is None else pytest.approx(value, **close))
        assert reading.standard_error == (None if error is None else pytest.approx(error, **close))


@pytest.mark.parametrize("name", ["art-coated", "cast-coated"])
def test_papers_read_as_by_the_plain_sums(name):
    assert_same(load_sample(name))


@pytest.mark.parametrize("name", FINISHES)
def test_finishes_read_as_by_the_plain_sums(name):
    assert_same(finish(name))


@pytest.mark.parametrize("k", range(1))
def test_random_materials_read_as_by_the_plain_sums(k):
    assert_same(random_material(k))


@pytest.mark.slow
@pytest.mark.parametrize("k", range(1, 40))
def test_more_random_materials(k):
    assert_same(random_material(k))


@pytest.mark.slow
@pytest.mark.parametrize("name", SAMPLES)
def test_all_papers(name):
    assert_same(load_sample(name))


def test_a_millionth_of_an_index_is_seen():
    """Negative control: the tolerance is not so wide that another material passes."""
    material = finish("gloss-varnish")
    lobe = dataclasses.replace(material.specular[0], refractive_index=1.500001)
    expected = Control().readings(dataclasses.replace(material, specular=(lobe,)))
    value = next(r.value for r in gloss_readings(material) if r.key == "gloss-60")
    assert value != pytest.approx(expected["gloss-60"][0], rel=RELATIVE, abs=ABSOLUTE)


@pytest.mark.parametrize("index", [1.0, 1.05, LEAST_INDEX, 1.5, 10.0, *brdf.MetalPart])
def test_compressed_windows_serve_every_reflectance(index):
    """Widths on both sides of where a window's compressed integral begins to serve."""
    for meter, window in WINDOWS:
        scale = meter.mirror_flux(meter.glass)
        for s_deg in (1e-6, 0.9, 3.0, 40.0):
            plain = plain_lobe_flux(meter, window, s_deg, index)
            # A half-vector is rounded to 2e-16, which in a mirror is 1e-8 of the facets' spread.
            rounding = 4.0 * np.finfo(float).eps / np.radians(s_deg)
            assert lobe_flux(meter, window, s_deg, index) == pytest.approx(
                plain, rel=RELATIVE + rounding, abs=1e-13 * scale
            )


def test_wide_lobes_are_served_by_the_compressed_windows():
    meter = SPECULAR[20]
    few = compressed(meter, meter.windows[0])
    assert few.serves(meter, meter.windows[0], np.radians(2.0))
    assert not few.serves(meter, meter.windows[0], np.radians(0.05))
