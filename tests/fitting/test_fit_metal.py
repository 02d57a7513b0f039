"""A metal's lobe in the fit: its unknowns, when it is tried, and when it is chosen."""

from __future__ import annotations

import fit_cases
import numpy as np
import pytest
from scipy.optimize import nnls

from relgloss_view.fitting import curves, fit_material, metal, model, observations
from relgloss_view.fitting.mixed import nnls_mixed
from relgloss_view.fitting.problem import Problem
from relgloss_view.gloss.meter.meter import gloss_readings
from relgloss_view.material import brdf
from relgloss_view.material.material import Lobe, Material

Array = np.ndarray
F0 = np.array([0.4, 0.6, 0.85, 0.95])
ALBEDO = (0.02, 0.03, 0.03, 0.02)
RUNGS = [rung for rung, *_ in metal.METALS]
SMALL = fit_cases.GRID[np.isin(fit_cases.GRID[:, 0], (-60.0, -40.0, -20.0, 10.0, 30.0))]


def foil(s_deg: float, strength: float, f0: Array = F0, grid: Array = fit_cases.GRID) -> Array:
    """Radiance factors (N, B) of a metal's lobe: D G F / (4 cos cos) with Schlick's F, by hand."""
    f = fit_cases.facing(grid)
    s = float(np.radians(s_deg))
    w = (1.0 - f.cos_d)[:, None] ** 5
    lit = (f.mu_i > 0.0) & (f.mu_o > 0.0)
    facets = np.where(lit, np.pi * 0.25 * brdf.facet_density(f.delta2, s) * brdf.shadowing(f), 0.0)
    return strength * facets[:, None] * (f0 + (1.0 - f0) * w)


def fitted(value: Array, **options) -> Material:
    grid = options.pop("grid", fit_cases.GRID)
    return fit_material(fit_cases.measured(value, grid=grid), **options)


def names(material: Material) -> list[str]:
    assert material.fit is not None
    return [candidate["name"] for candidate in material.fit.candidates]


class TestChoice:
    def test_a_foil_is_found(self) -> None:
        value = fit_cases.truth((), albedo=ALBEDO) + foil(3.0, 0.8)
        material = fitted(value)
        assert material.fit is not None
        assert material.fit.chosen == "metal"
        assert material.fit.quality == "good"
        (lobe,) = material.specular
        assert lobe.f0 is not None
        # Two percent of noise over hundreds of samples; k shows at grazing incidence only.
        assert lobe.s_deg == pytest.approx(3.0, rel=0.01)
        np.testing.assert_allclose(np.array(lobe.f0) * lobe.strength[0], 0.8 * F0, rtol=0.01)
        assert lobe.strength[0] == pytest.approx(0.8, rel=0.1)

    def test_a_varnished_foil_is_found(self) -> None:
        value = fit_cases.truth(((1.5, 0.9),), albedo=ALBEDO) + foil(7.0, 0.5)
        material = fitted(value)
        assert material.fit is not None
        assert material.fit.chosen == "metal-and-lobe"
        (shine,) = (lobe for lobe in material.specular if lobe.is_metal)
        (varnish,) = (lobe for lobe in material.specular if not lobe.is_metal)
        assert shine.s_deg == pytest.approx(7.0, rel=0.02)
        assert varnish.s_deg == pytest.approx(1.5, rel=0.02)
        assert varnish.strength[0] == pytest.approx(0.9, rel=0.05)

    def test_a_colour_that_stays_is_a_dielectrics(self) -> None:
        """Negative control: the same colour at every angle."""
        material = fitted(fit_cases.truth(((3.0, tuple(F0)),), albedo=ALBEDO))
        assert material.fit is not None
        assert material.fit.chosen == "spectral-lobe"

    def test_a_silver_foil_is_a_metal_though_it_has_no_colour(self) -> None:
        """A dielectric would need a strength of 18, and would triple its gloss at 60 degrees."""
        silver = np.full(4, 0.92)
        value = fit_cases.truth((), albedo=ALBEDO, grid=SMALL) + foil(3.0, 0.8, silver, SMALL)
        material = fitted(value, grid=SMALL)
        assert material.fit is not None
        assert material.fit.chosen == "metal"
        assert material.fit.quality == "good"
        (lobe,) = material.specular
        assert lobe.is_metal
        np.testing.assert_allclose(np.array(lobe.f0) * lobe.strength[0], 0.8 * silver, rtol=0.01)

    @pytest.mark.parametrize("f0", [np.full(4, 0.92), F0], ids=["silver", "gold"])
    def test_a_foil_of_two_widths_is_two_metals(self, f0) -> None:
        """A narrow highlight on a wide foot, as foil on paper has it."""
        value = (
            fit_cases.truth((), albedo=ALBEDO, grid=SMALL)
            + foil(1.5, 0.8, f0, SMALL)
            + foil(7.0, 0.15, f0, SMALL)
        )
        material = fitted(value, grid=SMALL)
        assert material.fit is not None
        assert material.fit.chosen == "two-metals"
        assert material.fit.quality == "good"
        narrow, wide = material.specular
        assert narrow.is_metal
        assert wide.is_metal
        assert (narrow.s_deg, wide.s_deg) == pytest.approx((1.5, 7.0), rel=0.02)

    def test_a_bright_dielectric_stays_one(self) -> None:
        """Negative control: three times a full lobe, as a table in a wrong unit has it."""
        value = fit_cases.truth(((3.0, 3.0),), albedo=ALBEDO, grid=SMALL)
        material = fitted(value, grid=SMALL)
        assert material.fit is not None
        assert "metal" in names(material)  # it is tried, and loses by how it grows with incidence
        assert material.fit.chosen == "lobe"

    @pytest.mark.parametrize("lobes", [((2.5, 0.9),), ((2.0, 0.9), (9.0, 0.3))])
    def test_a_neutral_lobe_costs_nothing(self, lobes) -> None:
        """No rung with a metal is tried, so such a fit takes as long as it did."""
        assert not set(names(fitted(fit_cases.truth(lobes, grid=SMALL), grid=SMALL))) & set(
            metal.NAMES
        )

    def test_candidates_stand_in_order_of_size(self) -> None:
        material = fitted(fit_cases.truth((), albedo=ALBEDO) + foil(3.0, 0.8))
        assert names(material).index("metal") > names(material).index("spectral-lobe")
        sizes = {c["name"]: c["parameters"] for c in material.fit.candidates}
        # 4 bands: albedos, sigma, width, k F0 of each band, k.
        assert sizes["metal"] == 4 + 1 + 1 + 4 + 1
        assert sizes["spectral-lobe"] == 4 + 1 + 1 + 4


@pytest.fixture(scope="module")
def material() -> Material:
    value = fit_cases.truth((), albedo=ALBEDO, grid=SMALL) + foil(3.0, 0.8, grid=SMALL)
    return fitted(value, grid=SMALL, model="metal")


class TestEvidence:
    def test_the_fitted_sample_is_the_materials(self, material) -> None:
        """What the report and the window draw beside the samples is the BRDF of the material."""
        i, o = fit_cases.directions(SMALL)
        up = (i[:, 2] > 0.1) & (o[:, 2] > 0.1)
        diffuse, specular = material.evaluate(i[up], o[up])
        seen = curves.seen(material, i[up], o[up], (0.0, 0.0))
        np.testing.assert_allclose(seen, np.pi * (diffuse + specular), rtol=1e-9, atol=1e-12)

    def test_errors_reach_the_gloss_meter(self, material) -> None:
        errors = material.fit.standard_errors
        assert len(errors["strength"]) == len(errors["s_deg"]) == 1
        readings = {r.key: r for r in gloss_readings(material)}
        sixty = readings["gloss-60"]
        assert 0.0 < sixty.standard_error < 0.05 * sixty.value
        # k F0 is known to a few parts in a thousand, as the noise is 2 % over many samples.
        assert 0.0 < errors["strength"][0] < 0.02 * material.specular[0].strength[0]

    def test_a_lobe_that_is_no_metal_can_be_forced(self) -> None:
        material = fitted(fit_cases.truth(((3.0, 0.9),), grid=SMALL), grid=SMALL, model="metal")
        (lobe,) = material.specular
        assert lobe.is_metal
        assert max(lobe.f0) <= 1.0
        head_on = np.array(lobe.f0) * lobe.strength[0]
        np.testing.assert_allclose(head_on, 0.9 * 0.04, rtol=0.1)


@pytest.mark.parametrize("rung", RUNGS, ids=lambda r: r.name)
def test_the_gradient_is_that_of_the_loss(rung: model.Rung) -> None:
    """Each unknown against central differences of soft-L1 in whole predictions."""
    value = fit_cases.truth(((1.5, 0.9),), grid=SMALL) + foil(7.0, 0.5, grid=SMALL)
    data = observations.prepare(fit_cases.measured(value, grid=SMALL, noise=0.05))
    rng = np.random.default_rng(3)
    ks = rng.uniform(0.2, 0.8, (rung.strengths, 4))
    ks[rung.own :] = ks[rung.own :, :1]
    state = model.State(
        0.03, np.log(np.radians([4.0, 2.0][: rung.lobes])), np.full(rung.lobes, 1.5),
        np.array(fit_cases.ALBEDO), ks,
    )  # fmt: skip
    problem, states = Problem(data, rung), model.States.of([state])
    columns = problem.columns(states.t, states.log_s, states.n)
    predicted = model.predict(data.geometry, state)
    np.testing.assert_allclose(problem.model(columns, states.kd, states.ks)[0].T, predicted)
    misfit = problem.misfit(problem.model(columns, states.kd, states.ks))
    equations = problem.equations(columns, misfit, states)
    per_loss = 1.0 / (model.TAU**2 * np.sum(data.weight))
    shared = problem.unknowns.values(states)

    def loss(values: Array, kd: Array, own: Array) -> float:
        moved = problem.unknowns.replaced(states, values, kd, own)[0]
        residual = model.log_residual(data, model.predict(data.geometry, moved))
        return float(np.sum(data.weight * model.robust(residual)) / np.sum(data.weight))

    own = states.ks[:, : rung.own]

    def slope(values: Array, kd: Array, ks: Array) -> float:
        """Of the loss along a step of each kind of unknown."""
        high = loss(shared + values, states.kd + kd, own + ks)
        low = loss(shared - values, states.kd - kd, own - ks)
        return (high - low) / 2e-6

    assert problem.unknowns.count == rung.parameters(0)
    for place in range(problem.unknowns.count):
        step = 1e-6 * (np.arange(problem.unknowns.count) == place)
        expected = per_loss * equations.shared_gradient[0, place]
        assert slope(step, 0.0, 0.0) == pytest.approx(expected, rel=1e-5), place
    for b in range(4):
        step, gradient = 1e-6 * (np.arange(4) == b), per_loss * equations.own_gradient[0, b]
        assert slope(0.0, step, 0.0) == pytest.approx(gradient[0], rel=1e-5)
        for j in range(rung.own):
            row = np.multiply.outer(np.arange(rung.own) == j, step)
            assert slope(0.0, 0.0, row) == pytest.approx(gradient[1 + j], rel=1e-5)


@pytest.mark.parametrize("seed", range(20))
def test_mixed_is_scipys_solution_of_the_stacked_problem(seed: int) -> None:
    """scipy works on the matrix, nnls_mixed on normal equations: half of the digits are left."""
    rng = np.random.default_rng(seed)
    problems, bands, rows, own, shared = 3, 4, 12, 2, 1 + seed % 2
    mine = rng.uniform(0.0, 1.0, (problems, bands, rows, own))
    common = rng.uniform(0.0, 1.0, (problems, bands, rows, shared)) * 10.0 ** rng.uniform(-1, 1)
    target = rng.standard_normal((problems, bands, rows)) + rng.uniform(-0.5, 2.0)
    x, y = nnls_mixed(
        np.einsum("pbnk,pbnl->pbkl", mine, mine),
        np.einsum("pbnk,pbnj->pbkj", mine, common),
        np.einsum("pbnj,pbni->pji", common, common),
        np.einsum("pbnk,pbn->pbk", mine, target),
        np.einsum("pbnj,pbn->pj", common, target),
    )
    for p in range(problems):
        stacked = np.zeros((bands * rows, bands * own + shared))
        for b in range(bands):
            stacked[b * rows : (b + 1) * rows, b * own : (b + 1) * own] = mine[p, b]
            stacked[b * rows : (b + 1) * rows, bands * own :] = common[p, b]
        expected = nnls(stacked, target[p].ravel())[0]
        np.testing.assert_allclose(np.append(x[p].ravel(), y[p]), expected, atol=1e-6)


def test_an_absent_column_gets_nothing() -> None:
    zero = np.zeros((1, 1, 2, 2))
    zero[0, 0, 0, 0] = 2.0
    x, y = nnls_mixed(
        zero,
        np.zeros((1, 1, 2, 1)),
        np.zeros((1, 1, 1)),
        np.array([[[3.0, 0.0]]]),
        np.zeros((1, 1)),
    )
    np.testing.assert_allclose(x, [[[1.5, 0.0]]])
    assert y.tolist() == [[0.0]]


def test_unknowns_of_a_material_and_back() -> None:
    lobes = (Lobe((0.9,), 1.5), Lobe((0.5,), 7.0, f0=(0.2, 0.4)))
    log_s, n, ks = metal.unknowns_of(lobes, 2)
    np.testing.assert_allclose(np.degrees(np.exp(log_s)), [7.0, 1.5])
    np.testing.assert_allclose(ks, [[0.1, 0.2], [0.9, 0.9], [0.5, 0.5]])
    state = model.State(0.0, log_s, n, np.zeros(2), ks)
    assert metal.metals_of(state) == 1
    made = metal.lobe_of(state, 0)
    assert made.f0 == pytest.approx((0.2, 0.4))
    assert made.strength == (0.5,)
    np.testing.assert_allclose(model.brightness(state), [0.15 / 0.04, 0.9])
    assert metal.largest_f0(state) == pytest.approx(0.4)
