"""Cases 25 to 30 and 35: measurements, fits, spectra, the multiscale operator."""

from __future__ import annotations

import json

import fit_cases
import numpy as np
import pytest

from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.fitting import fit_material
from relgloss_view.material import brdf, spectra
from relgloss_view.measure import gonio, ridge, table
from relgloss_view.measure import screening as screen
from relgloss_view.measure.bands import Bands
from relgloss_view.operators.multiscale import Multiscale
from relgloss_view.operators.operator import SceneLight

colour = pytest.importorskip("colour")

#: Five of the fifteen incidence planes.
SMALL = fit_cases.GRID[np.isin(fit_cases.GRID[:, 0], (-60.0, -40.0, -20.0, 10.0, 30.0))]
COARSE = fit_cases.COARSE[np.isin(fit_cases.COARSE[:, 0], (-60.0, -40.0, -20.0, 10.0, 30.0))]


def fitted(lobes=(), sigma=0.1, grid=SMALL, **options):
    value = fit_cases.truth(lobes, sigma, grid=grid)
    return fit_material(fit_cases.measured(value, grid=grid), **options)


@pytest.mark.parametrize("declared", [0.0, 30.0])
def test_case_25_mirror_plane_declared_wrong_by_15(declared):
    """The ridge stands elsewhere, and that is said: no width is read off in silence."""
    i, o = gonio.gcms_directions(*fit_cases.GRID.T, 15.0)
    level = np.mean(fit_cases.truth(((0.7, 1.0),)), axis=-1)
    noise = np.exp(0.02 * np.random.default_rng(0).standard_normal(len(level)))
    kept = screen.reasons(i, o, level[:, None], arms_occlude=True) == table.KEPT
    told = ridge.check(fit_cases.GRID[kept], (level * noise)[kept], declared)
    assert f"gamma_s = {declared:g} deg" in told
    assert "--gamma-s-deg 15" in told
    assert ridge.check(fit_cases.GRID[kept], (level * noise)[kept], 15.0) is None


def test_case_26_no_lobe():
    """A sample without one is fitted without one, and what it could hide has a finite bound."""
    material = fitted(())
    assert material.specular == ()
    upper = material.fit.bounds["no_lobe"]["largest_strength_upper"]
    assert 0.0 < upper < 0.1
    json.dumps(material.fit.bounds, allow_nan=False)
    assert len(fitted(((2.5, 0.9),)).specular) == 1  # negative control


def test_case_27_a_lobe_narrower_than_the_grid():
    """s = 0.3 degrees, measured in steps of 10: unidentifiable, its width bounded on one side."""
    material = fitted(((0.3, 1.0),), grid=COARSE)
    assert material.fit.quality == "unidentifiable"
    bounds = material.fit.bounds["main_lobe"]
    assert bounds["s_deg_lower"] is None
    assert 0.3 < bounds["s_deg_upper"] < 1.5  # five degrees off the mirror it would show
    assert any("unidentifiable" in text for text in material.warnings)
    assert fitted(((0.3, 1.0),), grid=SMALL).fit.quality == "good"  # with the one-degree scan


def test_case_28_readings_that_are_none():
    """Negative, missing, saturated and occluded samples are left out, each under its name."""
    angles = np.radians([10.0, 20.0, 30.0, 40.0, 50.0, 89.9])
    i = np.stack([-np.sin(angles), 0 * angles, np.cos(angles)], axis=-1)
    o = i * (-1.0, 1.0, 1.0)
    o[4] = i[4]
    readings = np.array([[0.3], [-0.1], [np.nan], [99.0], [0.3], [0.3]])
    found = screen.reasons(i, o, readings, saturation=90.0, arms_occlude=True)
    expected = [table.KEPT, table.NEGATIVE, table.MISSING, table.SATURATED, table.OCCLUDED]
    assert list(found) == [*expected, table.GRAZING]
    value = fit_cases.truth(((2.5, 0.9),), grid=SMALL)
    measurement = fit_cases.measured(value, grid=SMALL)
    before = fit_material(measurement, model="lobe")
    spoilt = measurement.radiance_factor.copy()
    spoilt[3], spoilt[7, 2], spoilt[9, 1] = np.nan, -0.5, np.inf
    reasons = measurement.reasons.copy().astype("<U40")
    reasons[20:25], spoilt[20:25] = table.SATURATED, 1e9
    after = fit_material(
        table.Measurement(**{**vars(measurement), "radiance_factor": spoilt, "reasons": reasons}),
        model="lobe",
    )
    assert after.fit.residuals["left_out"][table.SATURATED] == 5
    assert after.specular[0].s_deg == pytest.approx(before.specular[0].s_deg, rel=0.02)


def test_case_29_starts_at_both_ends():
    """From 0.06 and from 30 degrees the search ends in the same lobe."""
    found = [
        fitted(((2.5, 0.9),), model="lobe", start_s_deg=start).specular[0] for start in (0.06, 30.0)
    ]
    assert found[0].s_deg == pytest.approx(found[1].s_deg, rel=1e-3)
    assert found[0].strength == pytest.approx(found[1].strength, rel=1e-3)
    assert found[0].s_deg == pytest.approx(2.5, rel=0.02)


class TestCase30:
    """A spectrum of 390 to 730 nm under lamps on other grids."""

    BANDS = Bands(tuple(float(w) for w in range(390, 731, 10)))

    @pytest.mark.parametrize("offset", [0.0, 1.0, 2.5, 3.7])
    def test_case_30_shifted_grid_of_the_lamp(self, offset):
        """Weights sum to the lamp's white, whatever its grid; a gray is that white's share."""
        grid = np.arange(380.0 + offset, 781.0, 5.0)
        lamp = spectra.Illuminant("shifted", tuple(grid), tuple(1.0 + 0.5 * np.sin(grid / 40.0)))
        weights = spectra.xyz_weights(self.BANDS, lamp)
        np.testing.assert_allclose(weights.sum(axis=0), lamp.white_xyz(), atol=1e-12)
        # The lamp is smooth: on another grid it has the same white, to the interpolation's error.
        fine = np.arange(380.0, 780.5, 0.5)
        smooth = spectra.Illuminant("fine", tuple(fine), tuple(1.0 + 0.5 * np.sin(fine / 40.0)))
        np.testing.assert_allclose(lamp.white_xyz(), smooth.white_xyz(), atol=3e-3)

    @pytest.mark.parametrize("line_nm", [404.0, 436.0, 546.0, 578.0, 615.0])
    def test_case_30_line_between_two_bands(self, line_nm):
        """A line of the lamp inside a 10 nm gap: a green ink within dE 0.1 of the fine sum."""
        grid = np.arange(380.0, 781.0, 1.0)
        power = 1.0 + 60.0 * np.exp(-0.5 * ((grid - line_nm) / 1.0) ** 2)
        lamp = spectra.Illuminant("line", tuple(grid), tuple(power))

        def ink(w):
            return 0.06 + 0.30 * np.exp(-(((w - 525.0) / 45.0) ** 2))

        white = lamp.white_xyz()
        coarse = ink(np.array(self.BANDS.wavelengths_nm)) @ spectra.xyz_weights(self.BANDS, lamp)
        every = Bands(tuple(grid))
        fine = ink(grid) @ spectra.xyz_weights(every, lamp)
        xy = colour.XYZ_to_xy(white)
        off = colour.delta_E(
            colour.XYZ_to_Lab(coarse, xy), colour.XYZ_to_Lab(fine, xy), method="CIE 2000"
        )
        assert off < 0.1
        # Negative control: the lamp sampled at the bands misses its line, and its white.
        at_bands = power[np.isin(grid, self.BANDS.wavelengths_nm)]
        sampled = spectra.Illuminant("sampled", self.BANDS.wavelengths_nm, tuple(at_bands))
        missed = np.abs(sampled.white_xyz() - white).max()
        assert missed > 0.02


HOT = 1e5


def light(xyz):
    display = DisplayModel.of(Display())
    white = np.array([1.0168, 1.0, 0.6761])
    return SceneLight((xyz * white,), 1.0, np.ones(xyz.shape[:2]), white, 110.0, 32.0, display)


@pytest.mark.parametrize("local", [0.0, 1.0])
@pytest.mark.parametrize("size", [(1, 1), (1, 5), (7, 13), (31, 33)])
@pytest.mark.parametrize("scene", ["black", "hot pixel", "one half black"])
def test_case_35_multiscale(local, size, scene):
    """Nothing, one pixel of 1e5 cd/m2, sizes that halve to odd ones: finite; negatives counted."""
    xyz = np.zeros((*size, 1))
    if scene == "hot pixel":
        xyz += 1.0
        xyz[size[0] // 2, size[1] // 2] = HOT
    if scene == "one half black":
        xyz[:, size[1] // 2 :] = 100.0
    for rods in (False, True):
        shown = Multiscale(local=local, rods=rods).apply(light(xyz))
        assert np.all(np.isfinite(shown.light))
        assert 0.0 <= np.min(shown.light) <= np.max(shown.light) <= 1.0
        assert np.all(np.isfinite(shown.lab))
        negative = [text for text in shown.warnings if "negative light" in text]
        if scene == "black":
            assert not negative
            assert np.max(shown.light) < 1e-6
    if scene == "hot pixel" and size == (31, 33):
        assert int(negative[0].split()[0]) > 0  # the dark ring about it


def test_the_helpers_fit_is_of_the_real_model():
    """Guards the cases above: their samples come from the lobe that is drawn."""
    f = fit_cases.facing(SMALL)
    expected = np.pi * brdf.torrance_sparrow(f, float(np.radians(2.5)), 1.5)
    np.testing.assert_array_equal(fit_cases.lobe(f, 2.5), expected)
