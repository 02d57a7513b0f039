"""The instrument's errors: how they move a lobe, and what a fit makes of tables that have them."""

from __future__ import annotations

from dataclasses import replace

import fit_cases
import numpy as np
import pytest

from relgloss_view.fitting import fit_material, instrument, shapes, slices
from relgloss_view.fitting.instrument import as_fitted, instrument_of
from relgloss_view.fitting.observations import usable_rows
from relgloss_view.material import brdf
from relgloss_view.measure import gonio

APERTURE = (0.3, 0.4)
GRID = fit_cases.GRID


def table(grid=GRID):
    return replace(
        fit_cases.measured(fit_cases.truth(((0.7, 1.0),), grid=grid), grid=grid),
        aperture_sd_deg=APERTURE,
    )


def test_errors_of_the_angles_are_those_of_the_scales() -> None:
    """Directions computed from wrong angles by the instrument's own formula, to second order."""
    a, b, g = GRID.T
    measured = table()
    device = instrument_of(measured)
    assert device.names == (
        "the mean zero of alpha and beta", instrument.GAMMA_S, instrument.APERTURE,
    )  # fmt: skip
    for k, changed in enumerate(((0.1, 0.1, 0), (0, 0, 0.1))):
        errors = np.zeros(3)
        errors[k] = np.radians(0.1)
        moved = device.moved(measured.to_lamp, measured.to_receiver, errors)
        expected = gonio.gcms_directions(
            a + changed[0], b + changed[1], g, gonio.GAMMA_S_DEG + changed[2]
        )
        for got, true in zip(moved, expected, strict=True):
            np.testing.assert_allclose(got, true, atol=2e-6)


def test_a_plane_has_a_zero_and_a_tilt_and_a_half_space_two_tilts() -> None:
    plane = table(GRID[GRID[:, 2] == gonio.GAMMA_S_DEG])
    assert len(instrument_of(replace(plane, gamma_s_deg=None)).names) == 3
    assert "tilt" in instrument_of(replace(table(), gamma_s_deg=None)).names[0]
    assert instrument_of(replace(table(), tabulated=True)) is None


@pytest.mark.parametrize("s_deg", [0.5, 3.0])
def test_slopes_are_differences_of_exact_geometries(s_deg: float) -> None:
    """d ln L / d error against lobes of directions that were really moved."""
    measured = table()
    device = instrument_of(measured)
    g = shapes.geometry(measured.to_lamp, measured.to_receiver, APERTURE, device)
    log_s, n = np.log(np.radians([s_deg])), np.array([1.5])
    at = np.append(np.radians([0.005, 0.004]), 0.2)
    slopes = shapes.error_slopes(g, at[None], log_s, n)[0]
    lobe = shapes.lobe_columns(shapes.displaced(g, at), log_s[0], 1.5)[0]
    # Beyond 65 degrees the cosines under the lobe bend within these errors.
    near = (
        (np.sqrt(g.along + g.across) < np.radians(3.0 * s_deg))
        & (np.linalg.norm(measured.to_lamp - measured.to_receiver, axis=1) > 0.1)
        & (np.minimum(measured.to_lamp[:, 2], measured.to_receiver[:, 2]) > np.cos(np.radians(65)))
    )
    assert np.sum(near) > 20
    for k in range(3):
        ends = []
        for step in (1e-4, -1e-4):
            errors = at.copy()
            errors[k] += step
            lamp, receiver = device.moved(measured.to_lamp, measured.to_receiver, errors)
            wide = tuple(a * np.exp(errors[-1]) for a in APERTURE)
            ends.append(
                shapes.lobe_columns(shapes.geometry(lamp, receiver, wide), log_s[0], 1.5)[0]
            )
        slope = (ends[0] - ends[1]) / 2e-4
        # The first order about zero: at these errors the second is some hundredths of it.
        np.testing.assert_allclose(
            (slopes[k] * lobe)[near], slope[near], atol=0.02 * np.max(np.abs(slope[near]))
        )


def seen(
    s_deg: float = 0.7,
    *,
    alpha: float = 0.0,
    gamma_s: float = 0.0,
    aperture: tuple[float, float] = APERTURE,
    seed: int = 0,
):
    """A table as the paper's instrument writes it where its scales or apertures are off.

    The lobe's blur is the average over 11 x 11 tilts of the half-vector, not the fit's closed form.
    """
    a, b, g = GRID.T
    i, o = gonio.gcms_directions(a + alpha, b, g, gonio.GAMMA_S_DEG + gamma_s)
    f = brdf.facing(np.broadcast_to(fit_cases.NORMAL, i.shape), i, o)
    along, across = instrument.signed_tilts(i, o)
    half_e = 0.5 * np.radians(np.hypot(*aperture))
    nodes, weights = np.polynomial.hermite_e.hermegauss(11)
    weights = weights / np.sum(weights)
    amplitude, s = brdf.facet_amplitude(np.radians(s_deg)), np.radians(s_deg)
    facets = np.zeros(len(a))
    for u, wu in zip(nodes, weights, strict=True):
        for v, wv in zip(nodes, weights, strict=True):
            tilt2 = (along + u * half_e) ** 2 + (across + v * half_e / f.cos_d) ** 2
            facets += wu * wv * amplitude * np.exp(-tilt2 / (2.0 * s * s))
    lobe = facets * brdf.fresnel_dielectric(f.cos_d, 1.5) * 0.25 * np.pi * brdf.shadowing(f)
    first, second = brdf.oren_nayar(fit_cases.facing(), 0.1)
    kd = np.array(fit_cases.ALBEDO)
    value = np.pi * (first[:, None] * kd + second[:, None] * kd**2) + lobe[:, None]
    return replace(fit_cases.measured(value, noise=0.01, seed=seed), aperture_sd_deg=APERTURE)


def peak_of(material) -> float:
    """Of the main lobe, relative to the one that made the tables: strength over width squared."""
    lobe = material.specular[0]
    ratio = brdf.facet_amplitude(lobe.s) / brdf.facet_amplitude(np.radians(0.7))
    return float(lobe.strength[0] * ratio)


@pytest.mark.parametrize(
    ("faults", "held_peak"),
    [
        ({"aperture": (0.5, 0.6)}, 0.9),
        pytest.param({"alpha": 0.3}, None, marks=pytest.mark.slow),
        pytest.param({"gamma_s": 0.6}, 0.92, marks=pytest.mark.slow),
    ],
    ids=["apertures", "alpha", "gamma_s"],
)
def test_errors_of_the_instrument_do_not_lower_the_peak(faults, held_peak) -> None:
    table = seen(**faults)
    material = fit_material(table)
    # A tilt that no sample shows leaves the peak open by what the fit itself reports.
    names, matrix = material.fit.covariance["names"], material.fit.covariance["priors"]
    at = names.index("strength.1")
    open_by = float(np.sqrt(matrix[at][at])) / material.specular[0].strength[0]
    assert peak_of(material) == pytest.approx(1.0, abs=0.03 + 2.0 * open_by)
    assert open_by < 0.2
    assert material.fit.quality == "good"
    held = fit_material(table, free_errors=False)
    if held_peak is None:  # control: held errors make this table look as if no model described it
        assert held.fit.quality == "poor"
    else:
        assert peak_of(held) < held_peak


def test_an_instrument_in_order_is_found_in_order() -> None:
    errors = fit_material(seen()).fit.instrument
    assert abs(errors["the mean zero of alpha and beta"]["value"]) < 0.02
    assert (
        abs(errors[instrument.APERTURE]["value"])
        < 2.0 * errors[instrument.APERTURE]["standard_error"]
    )


@pytest.mark.slow
def test_an_error_of_two_degrees_is_no_instrument_in_order() -> None:
    material = fit_material(seen(3.0, alpha=2.0))
    assert material.fit.quality == "poor"
    assert any("mean zero of" in warning for warning in material.fit.warnings)


def test_a_narrow_lobe_on_a_coarse_hemisphere_does_not_pass_for_another_index() -> None:
    """Apertures of 1 degree declared as 0.3: the fit bends the index towards 1.8, and says so."""
    theta, azimuth = np.arange(0.0, 71.0, 5.0), np.arange(0.0, 181.0, 30.0)
    i, r, p = (x.ravel() for x in np.meshgrid(theta, theta, azimuth, indexing="ij"))
    lamp, receiver = gonio.spherical(i, 180.0), gonio.spherical(r, 180.0 - p)

    def measured_with(aperture: float):
        g = shapes.geometry(lamp, receiver, (aperture, aperture))
        lobe = shapes.lobe_columns(g, np.log(np.radians(1.0)), 1.5)[0]
        value = 0.3 + lobe[:, None] * np.ones(4)
        noise = 1.0 + 0.01 * np.random.default_rng(2).standard_normal(value.shape)
        full = table()
        return replace(
            full, to_lamp=lamp, to_receiver=receiver, radiance_factor=value * noise,
            reasons=np.full(len(i), ""), group=i.astype(np.int64), gamma_s_deg=None,
        )  # fmt: skip

    wide = fit_material(measured_with(1.0))
    assert wide.fit.quality != "good"
    assert any("apertures" in text for text in wide.fit.grounds), wide.fit.grounds
    right = fit_material(measured_with(0.3))  # control: its own apertures
    assert right.fit.quality == "good", right.fit.grounds


@pytest.mark.slow
def test_a_known_index_is_held() -> None:
    material = fit_material(seen(), refractive_index=1.6)
    assert material.specular[0].refractive_index == 1.6
    names = material.fit.covariance["names"]
    at = names.index("refractive_index.1")
    assert material.fit.covariance["priors"][at][at] == 0.0
    assumed = fit_material(seen()).fit.covariance["priors"]
    assert assumed[at][at] > 0.0  # control: an index that nobody gave is uncertain


def test_peak_and_c_max_are_closed_forms_with_the_errors_of_the_fit() -> None:
    material = fit_material(seen())
    derived, lobe = material.fit.derived, material.specular[0]
    f = brdf.facing(
        fit_cases.NORMAL[None], gonio.direction(-45.0)[None], gonio.direction(45.0)[None]
    )
    # At the mirror direction: A F / (4 cos^2), beside a body of a few percent of it.
    amplitude = brdf.facet_amplitude(lobe.s)
    highlight = amplitude * brdf.fresnel_dielectric(f.cos_d, lobe.refractive_index)[0]
    expected = np.pi * lobe.strength[0] * highlight / (4.0 * np.cos(np.radians(45.0)) ** 2)
    assert derived["peak"]["value"] == pytest.approx(expected, rel=0.02)
    assert 0.0 < derived["peak"]["standard_error"] < 0.3 * expected
    c_max = derived["c_max"]
    assert 0.0 < c_max["standard_error"] < 0.05 * c_max["value"]
    blurred = fit_material(replace(seen(), aperture_sd_deg=(0.0, 0.0)), free_errors=False)
    # Control: read as if its apertures did not blur it, a table has a lower peak, a higher c_max.
    assert blurred.fit.derived["peak"]["value"] < 0.97 * derived["peak"]["value"]
    assert blurred.fit.derived["c_max"]["value"] > c_max["value"]


def test_the_report_sees_the_table_as_the_fit_saw_it() -> None:
    """A lobe of 0.7 degrees, a scale that is 0.3 off: residuals near the mirror are of noise."""
    measured = seen(alpha=0.3)
    material = fit_material(measured)

    def error_near(of):
        page = slices.prepare(material, of, usable_rows(of))
        half, percent = page.residuals()
        return float(np.median(np.abs(percent[half < 1.5])))

    assert error_near(as_fitted(measured, material)) < 2.0  # of 1 % noise
    assert error_near(measured) > 5.0  # control: the scale as declared
