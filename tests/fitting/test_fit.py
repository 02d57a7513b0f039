"""Measurement to material: the choice of the ladder, lobes it must not invent, its doubts."""

from __future__ import annotations

import json
import re
from dataclasses import asdict, replace

import fit_cases
import numpy as np
import pytest

from relgloss_view.base import room
from relgloss_view.base.errors import FitCancelled, InputError
from relgloss_view.fitting import MODELS, describe_fit, fit, fit_material, observations
from relgloss_view.fitting.ladder import Candidate
from relgloss_view.fitting.model import Rung, Solution, State
from relgloss_view.fitting.results import POOR_MEDIAN, POOR_MEDIAN_NEAR, Part
from relgloss_view.fitting.verdict import NEAR_MIRROR_DEG, residuals, standard_errors
from relgloss_view.material import brdf
from relgloss_view.material.material import Material, Quality
from relgloss_view.measure import table
from relgloss_view.measure.readers import read_measurement

LOBE = ((2.5, 0.9),)
#: Five incidence planes of the fifteen: enough where speed counts.
SMALL = fit_cases.GRID[np.isin(fit_cases.GRID[:, 0], (-60.0, -40.0, -20.0, 10.0, 30.0))]


def fitted(lobes: tuple[tuple[float, object], ...], sigma: float = 0.1, **options) -> Material:
    grid = options.pop("grid", fit_cases.GRID)
    seed = options.pop("noise_seed", 0)
    value = fit_cases.truth(lobes, sigma, grid=grid)
    return fit_material(fit_cases.measured(value, grid=grid, seed=seed), **options)


@pytest.mark.parametrize(
    ("lobes", "sigma", "chosen"),
    [
        ((), 0.0, "lambert"),
        ((), 0.3, "rough"),
        (LOBE, 0.1, "lobe"),
        (((2.5, (0.3, 0.6, 0.9, 1.2)),), 0.1, "spectral-lobe"),
        (((2.0, 0.9), (9.0, 0.3)), 0.1, "two-lobes"),
        (((2.0, (0.3, 0.6, 0.9, 1.2)), (9.0, (0.4, 0.3, 0.2, 0.1))), 0.1, "two-spectral-lobes"),
    ],
)
def test_the_ladder_stops_at_the_model_that_made_the_data(
    lobes: tuple[tuple[float, object], ...], sigma: float, chosen: str
) -> None:
    material = fitted(lobes, sigma)
    assert material.fit is not None
    assert material.fit.chosen == chosen, describe_fit(material)
    assert material.fit.quality == "good"
    assert len(material.specular) == len(lobes)
    assert material.diffuse.sigma == pytest.approx(sigma, abs=0.01)
    widths = sorted(lobe.s_deg for lobe in material.specular)
    # Two percent of noise over hundreds of samples leaves s well below one percent.
    np.testing.assert_allclose(widths, [s for s, _ in lobes], rtol=0.01)
    np.testing.assert_allclose(material.diffuse.albedo, fit_cases.ALBEDO, rtol=0.01)


@pytest.mark.parametrize("noise_seed", range(3))
def test_no_lobe_is_invented(noise_seed: int) -> None:
    material = fitted((), 0.2, noise_seed=noise_seed, grid=SMALL)
    assert material.fit is not None
    assert material.specular == ()
    upper = material.fit.bounds["no_lobe"]
    assert 0.0 < upper["largest_strength_upper"] < 0.1
    assert material.fit.quality == "good"


def test_a_lobe_above_the_bound_is_found() -> None:
    """Control: a lobe 20 times as strong as the bound is in the fit."""
    bare = fitted((), 0.1)
    assert bare.fit is not None
    bounds = bare.fit.bounds["no_lobe"]
    upper = dict(zip(bounds["s_deg"], bounds["strength_upper"], strict=True))[3.0]
    material = fitted(((3.0, 20.0 * upper),), 0.1)
    assert [lobe.s_deg for lobe in material.specular] == pytest.approx([3.0], rel=0.1)


def test_a_lobe_narrower_than_the_grid_is_unidentifiable() -> None:
    material = fitted(((0.3, 1.0),), grid=fit_cases.COARSE)
    fit = material.fit
    assert fit is not None
    assert fit.quality == "unidentifiable"
    bounds = fit.bounds["main_lobe"]
    assert bounds["s_deg_lower"] is None
    assert 0.3 < bounds["s_deg_upper"] < 1.5  # five degrees off the mirror it would show
    assert any("unidentifiable" in text for text in fit.grounds)
    assert fit.warnings == fit.grounds
    # The case's bands lie side by side, which a material warns of.
    assert set(fit.warnings) <= set(material.warnings)
    assert material.specular[0].s_deg <= bounds["s_deg_upper"]


def test_a_width_read_off_the_foot_of_a_lobe_is_not_trusted() -> None:
    """Beyond three standard deviations no real lobe is Gaussian, so its foot gives no width."""
    value = fit_cases.truth(((0.7, 1.0),), grid=fit_cases.COARSE)
    f = fit_cases.facing(fit_cases.COARSE)
    foot = np.exp(-np.degrees(np.sqrt(f.delta2)) / 1.5)  # an exponential tail, invented
    value = value + 2.0 * foot[:, None]
    material = fit_material(fit_cases.measured(value, grid=fit_cases.COARSE), model="lobe")
    assert material.fit is not None
    assert material.fit.quality != "good"


def test_the_one_degree_scan_identifies_it() -> None:
    material = fitted(((0.3, 1.0),))
    assert material.fit is not None
    assert material.fit.quality == "good"
    assert material.specular[0].s_deg == pytest.approx(0.3, rel=0.03)


def test_a_flake_film_is_poor() -> None:
    """Glints toward one side of the mirror: nothing on the ladder has that shape."""
    f = fit_cases.facing(SMALL)
    i, o = fit_cases.directions(SMALL)
    stripes = 1.0 + 0.9 * np.sin(25.0 * i[:, 0]) * np.cos(18.0 * o[:, 0]) * np.cos(9.0 * i[:, 1])
    value = fit_cases.truth((), grid=SMALL) * stripes[:, None] ** 2
    material = fit_material(fit_cases.measured(value, grid=SMALL))
    assert material.fit is not None
    assert f.mu_i.shape == stripes.shape
    assert material.fit.quality == "poor"
    assert any("no model describes" in text for text in material.fit.grounds)
    assert material.warnings[: len(material.fit.grounds)] == material.fit.grounds


def test_a_poor_fit_may_be_unidentifiable_too() -> None:
    """Both warnings go into the file; poor decides the quality and alone explains it.

    The judgement by use adds its own line: stripes are no lobe in the mirror planes either.
    """
    value = fit_cases.truth(((0.3, 1.0),), grid=fit_cases.COARSE)
    i, o = fit_cases.directions(fit_cases.COARSE)
    stripes = 1.0 + 0.8 * np.sin(25.0 * i[:, 0]) * np.cos(18.0 * o[:, 0]) * np.cos(9.0 * i[:, 1])
    measurement = fit_cases.measured(value * stripes[:, None], grid=fit_cases.COARSE)
    fit = fit_material(measurement, model="lobe").fit
    assert fit is not None
    assert fit.quality is Quality.POOR
    # The table's own findings come first: stripes look like a lamp that drifts.
    texts = [text for text in fit.warnings if "readings" not in text[:12]]
    assert [text[:8] for text in texts] == ["no model", "the lobe", "near the"]
    assert {texts[0], texts[2]} <= set(fit.grounds)
    assert texts[1] not in fit.grounds
    assert fit.bounds["main_lobe"]["s_deg_lower"] is None


def test_a_limit_is_named_beside_whatever_else_is_wrong() -> None:
    """A lobe wider than the search goes, under stripes that no model describes: both are said."""
    i, o = fit_cases.directions()
    stripes = 1.0 + 0.9 * np.sin(25.0 * i[:, 0]) * np.cos(18.0 * o[:, 0]) * np.cos(9.0 * i[:, 1])
    value = fit_cases.truth(((60.0, 2.0),), albedo=(0.01,) * 4)
    striped = fit_material(fit_cases.measured(value * stripes[:, None] ** 2), model="lobe")
    grounds = striped.fit.grounds
    assert any("no model describes" in text for text in grounds), grounds
    assert any("limit of its search" in text for text in grounds), grounds
    assert set(grounds) <= set(striped.fit.warnings)
    inside = fit_cases.truth(((5.0, 1.0),), albedo=(0.05,) * 4)  # control: stripes alone
    other = fit_material(fit_cases.measured(inside * stripes[:, None] ** 2), model="lobe")
    assert not any("width of a lobe" in text for text in other.fit.grounds), other.fit.grounds


def test_index_hides_behind_strength_and_is_held() -> None:
    material = fitted(LOBE)
    assert material.fit is not None
    entry = material.fit.bounds["refractive_index"]
    assert entry["held"]
    assert entry["correlation_with_strength"] < -0.9  # science.md section 4: -0.96
    assert material.specular[0].refractive_index == 1.5


def test_a_metal_frees_the_index() -> None:
    f = fit_cases.facing()
    shape = 0.25 * brdf.facet_density(f.delta2, float(np.radians(4.0))) * brdf.shadowing(f)
    metal = np.pi * shape * (0.8 + 0.2 * (1.0 - f.cos_d) ** 5)
    value = fit_cases.truth((), albedo=(0.002,) * 4) + metal[:, None] * np.array([0.6, 0.7, 0.9, 1])
    measurement = fit_cases.measured(value)
    material = fit_material(measurement, model="spectral-lobe")
    assert material.fit is not None
    assert not material.fit.bounds["refractive_index"]["held"]
    assert material.specular[0].refractive_index > 2.5
    held = fit_material(measurement, model="spectral-lobe", free_index=False)
    assert held.specular[0].refractive_index == 1.5
    assert held.fit is not None
    ratio = held.fit.residuals["rms_log_error"] / material.fit.residuals["rms_log_error"]
    assert ratio > 1.1


def test_outliers_do_not_move_the_lobe() -> None:
    value = fit_cases.truth(LOBE)
    rng = np.random.default_rng(5)
    hit = rng.random(len(value)) < 0.05
    material = fit_material(fit_cases.measured(value * np.where(hit, 5.0, 1.0)[:, None]))
    assert material.specular[0].s_deg == pytest.approx(2.5, rel=0.01)
    np.testing.assert_allclose(material.diffuse.albedo, fit_cases.ALBEDO, rtol=0.02)


def test_unusable_values_are_left_out_and_counted() -> None:
    measurement = fit_cases.measured(fit_cases.truth(LOBE, grid=SMALL), grid=SMALL)
    value = measurement.radiance_factor.copy()
    reasons = measurement.reasons.copy().astype("<U40")
    value[3], value[7, 2], value[9, 1] = np.nan, -0.5, np.inf
    reasons[20:25] = table.SATURATED
    value[20:25] = 1e9
    spoilt = replace(measurement, radiance_factor=value, reasons=reasons)
    material = fit_material(spoilt, model="lobe")
    assert material.fit is not None
    assert material.fit.residuals["left_out"][table.SATURATED] == 5
    assert material.specular[0].s_deg == pytest.approx(2.5, rel=0.02)


def test_two_fits_are_the_same_fit() -> None:
    a, b = (fitted(LOBE, grid=SMALL, model="lobe") for _ in range(2))
    assert a.fit is not None
    assert b.fit is not None
    assert replace(a, fit=replace(a.fit, seconds=0.0)) == replace(
        b, fit=replace(b.fit, seconds=0.0)
    )


@pytest.mark.parametrize("start", [0.06, 30.0])
def test_the_start_of_the_scan_does_not_matter(start: float) -> None:
    usual = fitted(LOBE, grid=SMALL, model="lobe")
    other = fitted(LOBE, grid=SMALL, model="lobe", start_s_deg=start)
    assert other.specular[0].s_deg == pytest.approx(usual.specular[0].s_deg, rel=1e-3)


@pytest.mark.parametrize("model", [m for m in MODELS if m != "auto"])
def test_a_model_can_be_forced(model: str) -> None:
    material = fitted(LOBE, grid=SMALL, model=model)
    assert material.fit is not None
    assert material.fit.chosen.startswith(model[:4])
    json.dumps(asdict(material.fit), allow_nan=False)


@pytest.mark.slow
def test_standard_errors_cover_the_truth() -> None:
    """Jackknife over planes: three standard errors of s, over ten draws, and not absurdly wide."""
    ratios = []
    for seed in range(10):
        material = fitted(LOBE, grid=SMALL, model="lobe", noise_seed=seed)
        assert material.fit is not None
        error = material.fit.standard_errors["s_deg"][0]
        assert 0.0 < error < 0.05
        ratios.append((material.specular[0].s_deg - 2.5) / error)
    # Five planes give a t of four degrees of freedom: |t| > 4.6 has probability 1 %.
    assert np.sum(np.abs(ratios) < 4.6) >= 9
    assert np.max(np.abs(ratios)) > 0.3


def test_source_and_warnings_of_the_measurement_stay() -> None:
    measurement = fit_cases.measured(fit_cases.truth(LOBE, grid=SMALL), grid=SMALL)
    measurement = replace(measurement, warnings=("the mirror ridge lies at gamma = 0",))
    material = fit_material(measurement, model="lobe")
    assert material.synthetic
    assert not fit_material(replace(measurement, synthetic=False), model="lobe").synthetic
    assert material.warnings[0] == "the mirror ridge lies at gamma = 0"


def test_progress_is_reported_and_can_cancel() -> None:
    seen: list[float] = []

    def progress(fraction: float, text: str) -> bool:
        assert text
        seen.append(fraction)
        return len(seen) < 4

    with pytest.raises(FitCancelled):
        fitted(LOBE, grid=SMALL, progress=progress)
    assert len(seen) == 4
    assert seen == sorted(seen)


def test_bad_requests_are_named() -> None:
    measurement = fit_cases.measured(fit_cases.truth(LOBE))
    with pytest.raises(InputError, match="model is 'glossy'"):
        fit_material(measurement, model="glossy")
    with pytest.raises(InputError, match="refractive index"):
        fit_material(measurement, refractive_index=0.9)
    nothing = replace(measurement, reasons=np.full(len(measurement.reasons), table.MISSING))
    with pytest.raises(InputError, match="0 usable samples"):
        fit_material(nothing)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda v: np.full_like(v, 1e11), "albedo[0]: expected an albedo, 0 to 4"),
        (lambda v: np.full_like(v, 1e-300), "darker than any surface"),
        (lambda v: 0.0 * v, "0 usable samples of"),
    ],
)
def test_values_that_no_surface_has_are_refused_by_file(change, says) -> None:
    value = change(fit_cases.truth(LOBE, grid=SMALL))
    measurement = fit_cases.measured(value, grid=SMALL)
    with pytest.raises(InputError) as caught:
        fit_material(replace(measurement, file="folder/table.csv"), model="lobe")
    message = str(caught.value)
    assert message.startswith("folder/table.csv: ")
    assert says in message
    if "usable" in says:  # each sample is accounted for, in words
        inside = message[message.index("(") : message.index(")")]
        assert "{" not in message
        assert sum(int(n) for n in re.findall(r"[(,] ?(\d+) ", inside)) == len(value)
    else:
        assert "check the quantity" in message


def test_a_dead_band_does_not_spoil_the_others() -> None:
    value = fit_cases.truth(LOBE, grid=SMALL)
    value[:, 1] = 1e-300
    material = fit_material(fit_cases.measured(value, grid=SMALL), model="spectral-lobe")
    assert material.specular[0].s_deg == pytest.approx(2.5, rel=0.02)


def test_the_jackknife_of_a_mean_is_its_standard_error() -> None:
    """Where leaving out moves an unknown as it moves a mean, the jackknife is sd/sqrt(n).

    It is widened by Student's t against the normal, at 80 %.
    """
    groups = np.array([1.0, 2.0, 4.0, 7.0, 3.0])
    without = (np.sum(groups) - groups) / (len(groups) - 1)
    states = tuple(
        State(0.0, np.empty(0), np.empty(0), np.array([m]), np.empty((0, 1))) for m in without
    )
    solution = Solution(states[0], 0.0)
    candidate = Candidate(
        Rung("lambert", rough=False), solution, np.zeros(5), states, 0.0, 0.0, 0.0
    )
    error = standard_errors(candidate).albedo_relative
    expected = np.std(groups, ddof=1) / np.sqrt(len(groups)) / np.mean(groups)
    expected *= 1.5332 / 1.2816  # t of 4 degrees of freedom at 90 %, from a table
    assert error == pytest.approx(expected, rel=1e-3)  # kept to four digits


def test_residuals_of_a_scaled_model_are_closed_forms() -> None:
    """A model 10 % too bright near the mirror and 4 % too dark elsewhere, on a known grid."""
    measurement = fit_cases.measured(fit_cases.truth(LOBE, grid=SMALL), noise=0.0, grid=SMALL)
    data = observations.prepare(measurement)
    cosine = (data.geometry.facing.mu_i * data.geometry.facing.mu_o)[:, None]
    near = np.sqrt(data.geometry.facing.delta2) < np.radians(NEAR_MIRROR_DEG)
    share = np.where(near, 0.1, -0.04)[:, None]
    measures = residuals(measurement, data, data.value * (1.0 + share))
    assert measures.near_mirror.median_relative_error == pytest.approx(0.1)
    assert measures.far.median_relative_error == pytest.approx(0.04)
    assert measures.near_mirror.values == 4 * np.sum(near)
    assert measures.near_mirror.values + measures.far.values == measures.values == data.value.size
    assert measures.median_relative_error == pytest.approx(0.04)
    assert measures.p90_relative_error == pytest.approx(0.1)
    linear = data.value * share * cosine / np.pi
    root = np.cbrt(data.value * cosine / np.pi) * (np.cbrt(1.0 + share) - 1.0)
    # Kept to four digits.
    assert measures.cosine_weighted_rms == pytest.approx(np.sqrt(np.mean(linear**2)), rel=5e-4)
    assert measures.cube_root_rms == pytest.approx(np.sqrt(np.mean(root**2)), rel=5e-4)
    assert measures.samples == len(data.value)
    assert not measures.poor


@pytest.mark.parametrize(
    ("median", "near", "poor"),
    [
        (POOR_MEDIAN, POOR_MEDIAN_NEAR, False),
        (1.001 * POOR_MEDIAN, 0.0, True),
        (0.0, 1.001 * POOR_MEDIAN_NEAR, True),
        (POOR_MEDIAN, None, False),
    ],
)
def test_either_median_makes_a_fit_poor(median: float, near: float | None, poor: bool) -> None:
    measurement = fit_cases.measured(fit_cases.truth(LOBE, grid=SMALL), grid=SMALL)
    data = observations.prepare(measurement)
    measures = residuals(measurement, data, data.value)
    part = Part(near, 0 if near is None else 4)
    assert replace(measures, median_relative_error=median, near_mirror=part).poor is poor


def test_a_fit_that_there_is_no_memory_for_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Before, the system ended it: a million geometries would take 50 GB."""
    paper = read_measurement("art-coated")
    monkeypatch.setattr(room, "rooms", lambda: [room.Room(150e6, "is free", "resident")])
    monkeypatch.setattr(fit, "_GEOMETRY_BYTES", 1e6)
    with pytest.raises(InputError, match=r"a fit of 997 geometries .* thin out"):
        fit_material(paper)
    monkeypatch.undo()
    assert fit._GEOMETRY_BYTES * 1e6 > 50e9
