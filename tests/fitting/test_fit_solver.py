"""The separable solver against an exact model, scipy's least squares and far-apart starts."""

from __future__ import annotations

from dataclasses import replace

import fit_cases
import numpy as np
import pytest
from scipy.optimize import least_squares

from relgloss_view.fitting import (
    ladder,
    model,
    observations,
    search,
    shapes,
    unknowns,
)
from relgloss_view.fitting.descent import gauss_newton_step, refine
from relgloss_view.fitting.ladder import LADDER
from relgloss_view.fitting.problem import Problem
from relgloss_view.fitting.unknowns import shared_unknowns

RUNGS = {rung.name: rung for rung in LADDER}


def prepared(
    lobes: tuple[tuple[float, object], ...], noise: float, seed: int = 0
) -> observations.Observations:
    table = fit_cases.measured(fit_cases.truth(lobes), noise=noise, seed=seed)
    return observations.prepare(table)


def columns_at(problem: Problem, t: float, s_deg: float) -> np.ndarray:
    return problem.columns(np.array([t]), np.log(np.radians([[s_deg]])), np.array([[1.5]]))


@pytest.mark.parametrize(
    ("name", "lobes"),
    [
        ("lobe", ((2.5, 0.9),)),
        ("spectral-lobe", ((2.5, (0.5, 0.7, 1.0, 1.2)),)),
        ("two-lobes", ((2.5, 0.9), (12.0, 0.3))),
    ],
)
def test_an_exact_model_is_found(name: str, lobes: tuple[tuple[float, object], ...]) -> None:
    data = prepared(lobes, noise=0.0)
    state = search.solve(data, RUNGS[name], 1.5).state
    order = np.argsort(state.log_s)
    s_deg = np.degrees(np.exp(state.log_s[order]))
    # The loss is quadratic at the optimum, so its own rounding leaves half of the digits.
    np.testing.assert_allclose(s_deg, [s for s, _ in lobes], rtol=1e-4)
    np.testing.assert_allclose(state.kd, fit_cases.ALBEDO, rtol=1e-4)
    assert np.sqrt(state.t) == pytest.approx(0.1, abs=1e-3)
    expected = np.array([np.broadcast_to(k, 4) for _, k in lobes])
    np.testing.assert_allclose(state.ks[order], expected, rtol=1e-3)


def test_scipy_finds_the_same_optimum() -> None:
    """All unknowns at once, numerical Jacobian, scipy's own soft-L1: nothing separable."""
    # With weights inside, scipy's loss is not ours; unit weights make the two the same.
    data = prepared(((3.0, 1.0),), noise=0.03)
    data = replace(data, weight=np.where(data.weight > 0.0, 1.0, 0.0))
    state = search.solve(data, RUNGS["lobe"], 1.5).state

    def residual(x: np.ndarray) -> np.ndarray:
        trial = model.State(x[0], x[1:2], np.array([1.5]), x[3:], np.full((1, 4), x[2]))
        log = model.log_residual(data, model.predict(data.geometry, trial))
        return (np.sqrt(data.weight) * log / model.TAU).ravel()

    start = np.array([0.05, np.log(np.radians(5.0)), 0.5, *(1.3 * state.kd)])
    fitted = least_squares(residual, start, loss="soft_l1", x_scale="jac", xtol=1e-12, ftol=1e-12)
    assert state.log_s[0] == pytest.approx(fitted.x[1], abs=1e-4)
    assert state.ks[0, 0] == pytest.approx(fitted.x[2], rel=1e-3)
    assert state.t == pytest.approx(fitted.x[0], abs=1e-4)
    np.testing.assert_allclose(state.kd, fitted.x[3:], rtol=1e-3)


def soft_l1(data: observations.Observations, radiance_factor: np.ndarray) -> float:
    """The loss as scipy's documentation of least_squares defines it: 2 (sqrt(1 + z) - 1) / 2."""
    ratio = (radiance_factor + data.floor) / (data.value + data.floor)
    z = (np.log(ratio) / model.TAU) ** 2
    return float(np.average(np.sqrt(1.0 + z) - 1.0, weights=data.weight))


def test_the_inner_solution_is_stationary_in_the_robust_loss() -> None:
    """Reweighted least squares ends where the robust logarithmic loss has no slope."""
    data = prepared(((3.0, 1.0),), noise=0.05)
    problem = Problem(data, RUNGS["lobe"])
    columns = columns_at(problem, 0.01, 3.3)
    kd, ks = problem.first_guess(columns, 60)

    def loss(kd: np.ndarray, ks: np.ndarray) -> float:
        return soft_l1(data, problem.model(columns, kd, ks)[0].T)

    best = loss(kd, ks)
    h = 1e-5
    for b in range(4):
        step = np.zeros((1, 4))
        step[0, b] = h * kd[0, b]
        slope = (loss(kd + step, ks) - loss(kd - step, ks)) / (2 * h)
        assert abs(slope) < 1e-5 * best
    assert abs(loss(kd, ks * (1 + h)) - loss(kd, ks * (1 - h))) / (2 * h) < 1e-5 * best


RIVALS = (
    model.Rung("lobe", lobes=1),
    model.Rung("lobe", lobes=1, free_index=True),
    model.Rung("two-lobes", lobes=2, free_index=True),
    model.Rung("two-spectral-lobes", lobes=2, spectral=True),
    model.Rung("two-spectral-lobes", lobes=2, spectral=True, free_index=True),
)


@pytest.mark.parametrize("rung", RIVALS, ids=lambda r: f"{r.name}{r.free_index:d}")
def test_the_gradient_is_that_of_the_loss(rung: model.Rung) -> None:
    """Each place of the vector of unknowns against central differences of soft_l1."""
    data = prepared(((3.0, 1.0),), noise=0.05)
    rng = np.random.default_rng(3)
    strengths = rng.uniform(0.2, 0.8, (rung.lobes, 4))
    if not rung.spectral:
        strengths[:] = strengths[:, :1]
    state = model.State(
        0.03, np.log(np.radians([4.0, 11.0][: rung.lobes])), np.full(rung.lobes, 1.6),
        np.array(fit_cases.ALBEDO), strengths,
    )  # fmt: skip
    problem = Problem(data, rung)
    states = model.States.of([state])
    columns = problem.columns(states.t, states.log_s, states.n)
    misfit = problem.misfit(problem.model(columns, states.kd, states.ks))
    assert misfit.loss[0] == pytest.approx(soft_l1(data, model.predict(data.geometry, state)))
    equations = problem.equations(columns, misfit, states)
    # The equations leave the loss in units of the logarithmic residual: TAU^2 larger.
    per_loss = 1.0 / (model.TAU**2 * np.sum(data.weight))
    shared = problem.unknowns.values(states)

    def loss(values: np.ndarray, kd: np.ndarray, ks: np.ndarray) -> float:
        moved = problem.unknowns.replaced(states, values, kd, ks)[0]
        return soft_l1(data, model.predict(data.geometry, moved))

    h = 1e-6
    for place in range(problem.unknowns.count):
        step = h * (np.arange(problem.unknowns.count) == place)
        high, low = (loss(shared + d, states.kd, states.ks) for d in (step, -step))
        slope = per_loss * equations.shared_gradient[0, place]
        assert (high - low) / (2 * h) == pytest.approx(slope, rel=1e-5, abs=1e-7), place
    for b in range(4):
        step = h * (np.arange(4) == b)
        high, low = (loss(shared, states.kd + d, states.ks) for d in (step, -step))
        slope = per_loss * equations.own_gradient[0, b, 0]
        assert (high - low) / (2 * h) == pytest.approx(slope, rel=1e-5, abs=1e-7)
        for j in range(rung.lobes if rung.spectral else 0):
            step = h * (np.arange(4) == b) * (np.arange(rung.lobes)[:, None] == j)
            high, low = (loss(shared, states.kd, states.ks + d) for d in (step, -step))
            slope = per_loss * equations.own_gradient[0, b, 1 + j]
            assert (high - low) / (2 * h) == pytest.approx(slope, rel=1e-5, abs=1e-7)


def dense_step(
    data: observations.Observations, rung: model.Rung, state: model.State, damping: float
) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Newton without any structure: dense, its Jacobian by central differences.

    Returns the steps of the shared unknowns (S,) and of each band's own (B, K). An own unknown that
    is zero and would leave its bound is held.
    """
    places = shared_unknowns(rung)
    bands, own_lobes = 4, rung.lobes if rung.spectral else 0
    shared = places.values(model.States.of([state]))[0]
    own = np.column_stack([state.kd, *state.ks[:own_lobes]])

    def residual(x: np.ndarray) -> np.ndarray:
        values, linear_unknowns = x[: len(shared)], x[len(shared) :].reshape(bands, -1)
        ks = linear_unknowns[:, 1:].T if own_lobes else state.ks
        moved = places.replaced(
            model.States.of([state]), values[None], linear_unknowns[None, :, 0], ks[None]
        )[0]
        return model.log_residual(data, model.predict(data.geometry, moved)).ravel()

    x = np.concatenate([shared, own.ravel()])
    h = 1e-6
    jacobian = np.column_stack(
        [(residual(x + d) - residual(x - d)) / (2 * h) for d in h * np.eye(len(x))]
    )
    weight = data.weight.ravel() / np.sqrt(1.0 + (residual(x) / model.TAU) ** 2)
    matrix = jacobian.T @ (weight[:, None] * jacobian)
    gradient = jacobian.T @ (weight * residual(x))
    free = (np.arange(len(x)) < len(shared)) | (x > 0.0) | (gradient < 0.0)
    matrix = matrix + damping * np.diag(np.diag(matrix))
    step = np.zeros(len(x))
    step[free] = -np.linalg.solve(matrix[np.ix_(free, free)], gradient[free])
    return step[: len(shared)], step[len(shared) :].reshape(bands, -1)


@pytest.mark.parametrize("rung", RIVALS, ids=lambda r: f"{r.name}{r.free_index:d}")
@pytest.mark.parametrize("dark", [False, True])
def test_a_step_is_that_of_dense_least_squares(rung: model.Rung, dark: bool) -> None:
    """Elimination band by band gives the step of the whole system; dark: with albedos at zero."""
    data = prepared(((3.0, 1.0),), noise=0.05)
    state = starts_of(rung, count=8)[2]
    if dark:  # far too bright and wide lobes: the gradient keeps the albedo of some bands at zero
        wide = np.log(np.radians([38.0, 30.0][: rung.lobes]))
        kd = np.array([0.0, 0.3, 0.0, 0.2])
        state = replace(state, log_s=wide, kd=kd, ks=state.ks + 3.0)
    states, damping = model.States.of([state]), 3.0
    problem = Problem(data, rung)
    columns = problem.columns(states.t, states.log_s, states.n)
    misfit = problem.misfit(problem.model(columns, states.kd, states.ks))
    equations = problem.equations(columns, misfit, states)
    moved = gauss_newton_step(problem.unknowns, states, equations, np.array([damping]))
    shared, own = dense_step(data, rung, state, damping)
    before = problem.unknowns.values(states)[0]
    after = np.clip(before + shared, problem.unknowns.low, problem.unknowns.high)
    assert np.all(np.abs(shared) < problem.unknowns.limit)
    np.testing.assert_allclose(problem.unknowns.values(moved)[0], after, rtol=1e-5, atol=1e-7)
    np.testing.assert_allclose(
        moved.kd[0], np.maximum(state.kd + own[:, 0], 0.0), rtol=1e-5, atol=1e-7
    )
    if dark:
        assert np.any(own[:, 0] == 0.0)
    if rung.spectral:
        expected = np.maximum(state.ks + own[:, 1:].T, 0.0)
        np.testing.assert_allclose(moved.ks[0], expected, rtol=1e-5, atol=1e-7)


def test_a_step_in_width_is_limited() -> None:
    """From a lobe that is 20 times too wide the step is the limit, and the bounds hold."""
    rung = RUNGS["lobe"]
    data = prepared(((1.0, 1.0),), noise=0.0)
    states = model.States.of([replace(starts_of(rung)[0], log_s=np.log(np.radians([20.0])))])
    problem = Problem(data, rung)
    columns = problem.columns(states.t, states.log_s, states.n)
    misfit = problem.misfit(problem.model(columns, states.kd, states.ks))
    equations = problem.equations(columns, misfit, states)
    moved = gauss_newton_step(problem.unknowns, states, equations, np.zeros(1))
    assert abs(moved.log_s[0, 0] - states.log_s[0, 0]) == pytest.approx(unknowns.WIDTH_STEP)


@pytest.mark.parametrize("rounds", [1, 3])
def test_a_descent_takes_no_more_steps_than_asked(rounds: int) -> None:
    taken: list[int] = []

    class Counted(Problem):
        def equations(self, columns, misfit, states):
            taken.append(len(states))
            return super().equations(columns, misfit, states)

    data = prepared(((2.5, 0.9),), noise=0.0)
    solution = refine(Counted(data, RUNGS["lobe"]), starts_of(RUNGS["lobe"])[1:2], rounds)[0]
    assert not solution.converged
    assert len(taken) == rounds


def test_a_refused_step_is_tried_again_with_more_damping() -> None:
    """A loss that refuses steps of more than half the undamped one still lets the descent move."""
    rung = RUNGS["lobe"]
    data = prepared(((2.5, 0.9),), noise=0.03)
    start = starts_of(rung)[1]
    free = refine(Problem(data, rung), [start], rounds=1)[0].state.log_s[0] - start.log_s[0]
    assert abs(free) > 0.1

    class Steep(Problem):
        def reweighted(self, columns, states):
            states, misfit = super().reweighted(columns, states)
            far = np.abs(states.log_s[:, 0] - start.log_s[0]) > 0.5 * abs(free)
            return states, misfit._replace(loss=np.where(far, 1e9, misfit.loss))

    moved = refine(Steep(data, rung), [start], rounds=1)[0].state.log_s[0] - start.log_s[0]
    assert 0.01 * abs(free) < abs(moved) <= 0.5 * abs(free)


def test_starts_come_from_different_valleys() -> None:
    """Errors over ten widths with valleys at 2 and 7: a valley's neighbours are passed over."""
    width = np.arange(10.0)
    errors = np.minimum(np.abs(width - 2.0), 0.1 + np.abs(width - 7.0))
    one = np.ones((10, 1))
    states = model.States(one[:, 0], width[:, None], one, one, one[:, :, None], np.empty((10, 0)))
    starts = search.lowest_of_valleys(states, errors, pitch=1.1)
    assert [float(state.log_s[0]) for state in starts] == [2.0, 7.0, 0.0]
    # Control: without a pitch they are the lowest three.
    starts = search.lowest_of_valleys(states, errors, pitch=-1.0)
    assert [float(state.log_s[0]) for state in starts] == [2.0, 7.0, 1.0]


def test_a_held_index_of_each_state_counts() -> None:
    problem = Problem(prepared(((2.5, 0.9),), noise=0.0), RUNGS["lobe"])
    log_s, n = np.full((2, 1), -3.0), np.array([[1.5], [1.7]])
    columns = problem.columns(np.zeros(2), log_s, n)
    for k in range(2):
        lobe, slope = shapes.lobe_columns(problem.geometry, log_s[k, 0], n[k, 0])
        np.testing.assert_allclose(columns[k, 2], lobe, rtol=1e-12)
        np.testing.assert_allclose(columns[k, 5], slope, rtol=1e-12)


def starts_of(rung: model.Rung, *, count: int = 4) -> list[model.State]:
    """Starts near and far: some steps are refused, and the descents end at different times."""
    spread = np.linspace(0.0, 1.0, count)
    return [
        model.State(
            0.2 * x,
            np.log(np.radians([0.4 + 9.0 * x, 25.0 - 5.0 * x][: rung.lobes])),
            np.full(rung.lobes, 1.5),
            np.full(4, 0.1 + 0.5 * x),
            np.full((rung.lobes, 4), 0.2 + x),
        )
        for x in spread
    ]


@pytest.mark.parametrize("name", ["rough", "lobe", "spectral-lobe", "two-lobes"])
def test_descents_side_by_side_are_the_same_as_alone(name: str) -> None:
    rung = RUNGS[name]
    problem = Problem(prepared(((2.5, 0.9), (12.0, 0.1)), noise=0.03), rung)
    starts = starts_of(rung)
    together = refine(problem, starts, rounds=8)
    assert len({solution.loss for solution in together}) > 1
    for start, solution in zip(starts, together, strict=True):
        alone = refine(problem, [start], rounds=8)[0]
        assert solution.converged == alone.converged
        assert solution.loss == pytest.approx(alone.loss, rel=1e-10)
        np.testing.assert_allclose(solution.state.log_s, alone.state.log_s, rtol=1e-7)
        np.testing.assert_allclose(solution.state.kd, alone.state.kd, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("name", ["rough", "lobe", "two-spectral-lobes"])
def test_a_fold_is_a_fit_without_the_group(name: str) -> None:
    """Weights of zero do what leaving the samples out does."""
    rung = RUNGS[name]
    data = prepared(((2.5, 0.9), (12.0, 0.1)), noise=0.03)
    solution = search.solve(data, rung, 1.5)
    candidate = ladder.evaluate(ladder.make_folds(data), rung, solution)
    assert len(candidate.held_out) == data.groups
    for number in (0, 7, data.groups - 1):
        kept, left = data.subset(data.group != number), data.subset(data.group == number)
        refined = refine(Problem(kept, rung), [solution.state], ladder.FOLD_ROUNDS)[0]
        error = model.mean_error(left, model.predict(left.geometry, refined.state))
        assert candidate.held_out[number] == pytest.approx(error, rel=1e-9)
        np.testing.assert_allclose(candidate.fold_states[number].kd, refined.state.kd, rtol=1e-9)
        # Control: the fold of another group is another fit.
        other = candidate.fold_states[(number + 1) % data.groups].kd
        assert np.max(np.abs(other / refined.state.kd - 1.0)) > 1e-6


@pytest.mark.parametrize("s_deg", [0.5, 6.0])
def test_far_apart_starts_give_the_same_optimum(s_deg: float) -> None:
    data = prepared(((s_deg, 1.0), (4.0 * s_deg, 0.05)), noise=0.02)
    for name in ("lobe", "two-lobes"):
        solutions = [
            search.solve(data, RUNGS[name], 1.5, start_s_deg=start)
            for start in (None, 0.05, 0.9, 40.0)
        ]
        losses = [f.loss for f in solutions]
        widths = [f.state.log_s[np.argmax(f.state.ks[:, 0])] for f in solutions]
        assert np.ptp(losses) < 1e-5 * min(losses)
        assert np.ptp(widths) < 1e-3, name


def test_the_loss_separates_widths() -> None:
    """Control of the test above: one percent off in s costs far more than starts differ by."""
    data = prepared(((0.5, 1.0),), noise=0.02)
    problem = Problem(data, RUNGS["lobe"])
    best = search.solve(data, RUNGS["lobe"], 1.5)
    states = model.States.of([best.state])
    columns = problem.columns(states.t, states.log_s + 0.01, states.n)
    kd, ks = problem.inner(columns, states.kd, states.ks, 20)
    assert soft_l1(data, problem.model(columns, kd, ks)[0].T) > (1.0 + 1e-3) * best.loss


def test_compression_keeps_the_model() -> None:
    """Means over bands are again of the model's form, so the search on them finds the truth."""
    albedo = tuple(0.05 + 0.4 * np.exp(-((np.arange(20) - 9.0) ** 2) / 20.0))
    value = fit_cases.truth(((2.5, 0.9),), albedo=albedo)
    data = observations.prepare(fit_cases.measured(value, noise=0.0))
    few = observations.compress(data)
    assert few.bands <= observations.SEARCH_BANDS
    assert np.sum(few.weight) == pytest.approx(np.sum(data.weight))
    state = search.solve(few, RUNGS["lobe"], 1.5).state
    # The mean of rho^2 is not the square of the mean: 3e-4 is what that leaves at sigma 0.1.
    assert np.degrees(np.exp(state.log_s[0])) == pytest.approx(2.5, rel=3e-4)


@pytest.mark.parametrize(
    "rung", [*RIVALS, *RUNGS.values()], ids=lambda r: f"{r.name}{r.free_index:d}"
)
def test_shared_unknowns_keep_their_places(rung: model.Rung) -> None:
    """A state taken apart and put together is the same, and each unknown moves only itself."""
    state = starts_of(rung)[1]
    states = model.States.of([state, replace(state, t=0.07)])
    places = shared_unknowns(rung)
    values = places.values(states)
    # The bands have own strengths where the rung is spectral; the rest is shared.
    assert places.count == rung.parameters(0)
    for k in range(2):
        again = places.replaced(states, values, states.kd, states.ks)[k]
        for name in ("t", "log_s", "n", "kd", "ks"):
            np.testing.assert_array_equal(getattr(again, name), getattr(states[k], name))
    assert np.all(places.low <= values[0])
    assert np.all(values[0] <= places.high)
    for place in range(places.count):
        moved = values.copy()
        moved[1, place] += 0.01
        new = places.replaced(states, moved, states.kd, states.ks)[1]
        changed = sum(
            bool(np.any(getattr(new, name) != getattr(states[1], name)))
            for name in ("t", "log_s", "n", "ks")
        )
        assert changed == 1, place
