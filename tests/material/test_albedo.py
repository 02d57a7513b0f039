"""Directional albedo against closed forms."""

from __future__ import annotations

import materials
import numpy as np
import pytest

from relgloss_view.material import brdf
from relgloss_view.material.albedo import directional_albedo
from relgloss_view.material.material import Diffuse, Lobe, Material
from relgloss_view.measure.bands import RGB

ANGLES_DEG = [0.0, 30.0, 60.0, 75.0, 85.0]


def test_lambert_reflects_its_albedo():
    material = Material("", "", RGB, Diffuse("lambert", (0.1, 0.5, 0.9)))
    diffuse, specular = directional_albedo(material, ANGLES_DEG)
    np.testing.assert_allclose(diffuse, [[0.1, 0.5, 0.9]] * 5, rtol=1e-3)
    assert np.all(specular == 0.0)


def test_white_eon_reflects_everything():
    material = Material("", "", RGB, Diffuse("eon", (1.0,) * 3, 40.0))
    np.testing.assert_allclose(directional_albedo(material, ANGLES_DEG)[0], 1.0, atol=2e-3)


@pytest.mark.parametrize("s_deg", [0.05, 0.5, 1.0])
def test_narrow_lobe_reflects_as_the_smooth_interface(s_deg):
    """In the limit of a mirror the lobe's albedo is Fresnel's reflectance (G is 1 there).

    Over a lobe of 1 degree F bends by s^2 F''/2, below 1 % up to 60 degrees.
    """
    angles = np.array([0.0, 30.0, 60.0])
    specular = directional_albedo(materials.flat(0.0, (Lobe((0.7,), s_deg),)), angles)[1][:, 0]
    expected = 0.7 * brdf.fresnel_dielectric(np.cos(np.radians(angles)), 1.5)
    np.testing.assert_allclose(specular, expected, rtol=0.01)


def test_lobes_and_bands_add_up():
    lobes = (Lobe((0.5, 1.0, 2.0), 3.0), Lobe((0.2,), 20.0, 1.7))
    both = Material("", "", RGB, Diffuse("lambert", (0.2,) * 3), lobes)
    alone = [Material("", "", RGB, Diffuse("lambert", (0.2,) * 3), (lobe,)) for lobe in lobes]
    parts = [directional_albedo(m, ANGLES_DEG)[1] for m in alone]
    np.testing.assert_allclose(directional_albedo(both, ANGLES_DEG)[1], sum(parts))
    np.testing.assert_allclose(parts[0][:, 2], 4.0 * parts[0][:, 0])


def test_a_lobe_of_twice_the_strength_passes_one_at_grazing_incidence():
    # Negative control of what the fit warns of.
    material = materials.flat(0.0, (Lobe((2.0,), 2.0),))
    assert directional_albedo(material, 85.0)[1][0, 0] > 1.0
    assert directional_albedo(material, 45.0)[1][0, 0] < 0.2


def test_a_fit_that_makes_light_says_so():
    from relgloss_view.fitting.evidence import with_energy_warning
    from relgloss_view.material.material import FitRecord

    def judged(strength, steepest_deg):
        diffuse, lobes = Diffuse("lambert", (0.5,) * 3), (Lobe((strength,), 3.0),)
        material = Material("", "", RGB, diffuse, lobes, FitRecord())
        return with_energy_warning(material, steepest_deg)

    assert not judged(1.0, 80.0).warnings
    beyond = judged(3.0, 60.0)
    (warning,) = beyond.warnings
    assert "more light than it receives at 80 deg" in warning or "at 70 deg" in warning
    assert beyond.fit.quality == "good"
    measured = judged(3.0, 80.0)  # where samples are, no surface does so
    assert measured.fit.quality == "poor"
    assert "check the quantity" in measured.fit.grounds[0]
