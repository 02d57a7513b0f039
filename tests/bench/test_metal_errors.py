"""A metal's reflectance by Schlick's form against the optical constants of real metals."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.bench.stability.metal_errors import METALS, schlick_error
from relgloss_view.material import brdf
from relgloss_view.material.conductor import fresnel_conductor

COSINES = np.cos(np.radians(np.arange(0.0, 90.0, 2.5)))


@pytest.mark.parametrize(("metal", "row"), [(m, k) for m in METALS for k in range(len(METALS[m]))])
def test_conductor_against_mitsuba(metal, row):
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    _, n, k = METALS[metal][row]
    expected = [mi.fresnel_conductor(float(c), mi.Complex2f(n, k)) for c in COSINES]
    found = fresnel_conductor(COSINES, n, k)
    np.testing.assert_allclose(found, expected, rtol=2e-6)  # its numbers are float32
    # Negative control: without absorption the same index reflects far less.
    assert np.max(np.abs(fresnel_conductor(COSINES, n, 0.0) - expected)) > 0.1


def test_without_absorption_it_is_a_dielectric():
    np.testing.assert_allclose(
        fresnel_conductor(COSINES, 1.5, 0.0), brdf.fresnel_dielectric(COSINES, 1.5), rtol=1e-12
    )


def test_head_on_is_the_closed_form():
    for rows in METALS.values():
        for _, n, k in rows:
            expected = ((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2)
            assert fresnel_conductor(1.0, n, k) == pytest.approx(expected, rel=1e-12)


#: Largest error of reflectance up to 60, up to 75 and at any angle: docs/method.md has the table.
LARGEST = {
    "gold": (0.023, 0.029, 0.029),
    "copper": (0.012, 0.040, 0.050),
    "aluminium": (0.020, 0.077, 0.130),
}


@pytest.mark.parametrize("metal", METALS)
def test_schlick_is_within_the_charted_error(metal):
    error = schlick_error(metal)
    for up_to, largest in zip((60.0, 75.0, 90.0), LARGEST[metal], strict=True):
        assert error.largest(up_to) == pytest.approx(largest, abs=6e-4)
    np.testing.assert_allclose(error.difference[:, [0, 90]], 0.0, atol=1e-9)


@pytest.mark.parametrize("metal", ["gold", "copper"])
def test_a_colour_kept_at_every_angle_is_worse(metal):
    """Negative control: a coloured strength of a dielectric, at 85 degrees."""
    error = schlick_error(metal)
    kept = error.exact[:, :1] - error.exact
    assert np.max(np.abs(kept[:, 85])) > 5 * np.max(np.abs(error.difference[:, 85]))
