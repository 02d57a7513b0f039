"""The separable solver against an exact model, scipy's least squares and far-apart starts."""

from __future__ import annotations

from dataclasses import replace

import fit_cases
import numpy as np
import pytest
from scipy.optimize import least_squares

from relgloss_view.fitting import model, samples, search, shapes, solver
from relgloss_view.fitting.ladder import LADDER

RUNGS = {rung.name: rung for rung in LADDER}


def prepared(
    lobes: tuple[tuple[float, object], ...], noise: float, seed: int = 0
) -> tuple[shapes.Geometry, samples.Samples]:
    table = fit_cases.measured(fit_cases.truth(lobes), noise=noise, seed=seed)
    data = samples.prepare(table)
    return shapes.geometry(data.to_lamp, data.to_receiver, (0.0, 0.0)), data


@pytest.mark.parametrize(
    ("name", "lobes"),
    [
        ("lobe", ((2.5, 0.9),)),
        ("spectral-lobe", ((2.5, (0.5, 0.7, 1.0, 1.2)),)),
        ("two-lobes", ((2.5, 0.9), (12.0, 0.3))),
    ],
)
def test_an_exact_model_is_found(name: str, lobes: tuple[tuple[float, object], ...]) -> None:
    g, data = prepared(lobes, noise=0.0)
    found = search.solve(g, data, RUNGS[name], 1.5)
    order = np.argsort(found.state.log_s)
    s_deg = np.degrees(np.exp(found.state.log_s[order]))
    # The loss is quadratic at the optimum, so its own rounding leaves half of the digits.
    np.testing.assert_allclose(s_deg, [s for s, _ in lobes], rtol=1e-4)
    np.testing.assert_allclose(found.state.kd, fit_cases.ALBEDO, rtol=1e-4)
    assert np.sqrt(found.state.t) == pytest.approx(0.1, abs=1e-3)
    expected = np.array([np.broadcast_to(k, 4) for _, k in lobes])
    np.testing.assert_allclose(found.state.ks[order], expected, rtol=1e-3)


def test_scipy_finds_the_same_optimum() -> None:
    """All unknowns at once, numerical Jacobian, scipy's own soft-L1: nothing separable."""
    g, data = prepared(((3.0, 1.0),), noise=0.03)
    found = search.solve(g, data, RUNGS["lobe"], 1.5).state

    def residual(x: np.ndarray) -> np.ndarray:
        state = model.State(x[0], x[1:2], np.array([1.5]), x[3:], np.full((1, 4), x[2]))
        weight = np.sqrt(data.weight / np.mean(data.weight))
        return (weight * model.log_residual(data, model.predict(g, state)) / model.TAU).ravel()

    # With weights inside, scipy's loss is not ours; unit weights make the two the same.
    data = replace(data, weight=np.where(data.weight > 0.0, 1.0, 0.0))
    found = search.solve(g, data, RUNGS["lobe"], 1.5).state
    start = np.array([0.05, np.log(np.radians(5.0)), 0.5, *(1.3 * found.kd)])
    fitted = least_squares(residual, start, loss="soft_l1", x_scale="jac", xtol=1e-12, ftol=1e-12)
    assert found.log_s[0] == pytest.approx(fitted.x[1], abs=1e-4)
    assert found.ks[0, 0] == pytest.approx(fitted.x[2], rel=1e-3)
    assert found.t == pytest.approx(fitted.x[0], abs=1e-4)
    np.testing.assert_allclose(found.kd, fitted.x[3:], rtol=1e-3)


def test_the_inner_solution_is_stationary_in_the_robust_loss() -> None:
    """Reweighted least squares ends where the robust logarithmic loss has no slope."""
    g, data = prepared(((3.0, 1.0),), noise=0.05)
    problem = solver.Problem(g, data, RUNGS["lobe"])
    columns, _ = problem.columns(0.01, np.log(np.radians([3.3])), np.array([1.5]))
    kd, ks = problem.first_guess(columns, 60)

    def loss(kd: np.ndarray, ks: np.ndarray) -> float:
        return model.mean_loss(data, problem.model(columns, kd, ks))

    best = loss(kd, ks)
    h = 1e-5
    for b in range(4):
        step = np.zeros(4)
        step[b] = h * kd[b]
        slope = (loss(kd + step, ks) - loss(kd - step, ks)) / (2 * h)
        assert abs(slope) < 1e-5 * best
    assert abs(loss(kd, ks * (1 + h)) - loss(kd, ks * (1 - h))) / (2 * h) < 1e-5 * best


@pytest.mark.parametrize("s_deg", [0.5, 6.0])
def test_far_apart_starts_give_the_same_optimum(s_deg: float) -> None:
    g, data = prepared(((s_deg, 1.0), (4.0 * s_deg, 0.05)), noise=0.02)
    for name in ("lobe", "two-lobes"):
        found = [
            search.solve(g, data, RUNGS[name], 1.5, start_s_deg=start)
            for start in (None, 0.05, 0.9, 40.0)
        ]
        losses = [f.loss for f in found]
        widths = [f.state.log_s[np.argmax(f.state.ks[:, 0])] for f in found]
        assert np.ptp(losses) < 1e-5 * min(losses)
        assert np.ptp(widths) < 1e-3, name


def test_the_loss_tells_widths_apart() -> None:
    """Control of the test above: one percent off in s costs far more than starts differ by."""
    g, data = prepared(((0.5, 1.0),), noise=0.02)
    problem = solver.Problem(g, data, RUNGS["lobe"])
    best = search.solve(g, data, RUNGS["lobe"], 1.5)
    columns, _ = problem.columns(best.state.t, best.state.log_s + 0.01, best.state.n)
    kd, ks = problem.inner(columns, best.state.kd, best.state.ks, 20)
    assert model.mean_loss(data, problem.model(columns, kd, ks)) > (1.0 + 1e-3) * best.loss


def test_compression_keeps_the_model() -> None:
    """Means over bands are again of the model's form, so the search on them finds the truth."""
    albedo = tuple(0.05 + 0.4 * np.exp(-((np.arange(20) - 9.0) ** 2) / 20.0))
    value = fit_cases.truth(((2.5, 0.9),), albedo=albedo)
    data = samples.prepare(fit_cases.measured(value, noise=0.0))
    few = samples.compress(data)
    assert few.bands <= samples.SEARCH_BANDS
    assert np.sum(few.weight) == pytest.approx(np.sum(data.weight))
    g = shapes.geometry(few.to_lamp, few.to_receiver, (0.0, 0.0))
    found = search.solve(g, few, RUNGS["lobe"], 1.5).state
    # The mean of rho^2 is not the square of the mean: 3e-4 is what that leaves at sigma 0.1.
    assert np.degrees(np.exp(found.log_s[0])) == pytest.approx(2.5, rel=3e-4)
