"""One step of a descent against the same equations solved whole by numpy."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.fitting.descent import gauss_newton_step
from relgloss_view.fitting.model import Rung, States
from relgloss_view.fitting.problem import Equations
from relgloss_view.fitting.unknowns import INDEX_STEP, WIDTH_STEP, shared_unknowns

PROBLEMS, BANDS = 2, 3
RUNGS = (
    Rung("lambert", rough=False),
    Rung("rough"),
    Rung("two-lobes", lobes=2, free_index=True),
    Rung("two-spectral-lobes", lobes=2, spectral=True),
)


def states_of(rung: Rung) -> States:
    """Well within all bounds."""
    rng = np.random.default_rng(5)
    lobes = rung.lobes
    ks = rng.uniform(2.0, 3.0, (PROBLEMS, lobes, BANDS))
    if not rung.spectral:
        ks[:] = ks[:, :, :1]
    return States(
        rng.uniform(0.1, 0.3, PROBLEMS),
        np.log(np.radians(rng.uniform(2.0, 8.0, (PROBLEMS, lobes)))),
        np.repeat(rng.uniform(1.6, 1.9, (PROBLEMS, 1)), lobes, axis=1),
        rng.uniform(2.0, 3.0, (PROBLEMS, BANDS)),
        ks,
        rng.uniform(-0.01, 0.01, (PROBLEMS, rung.errors)),
    )


def matrix_of(rung: Rung, seed: int = 1) -> tuple[np.ndarray, np.ndarray, int, int]:
    """A Gauss-Newton matrix of all unknowns, in which bands meet in the shared ones alone."""
    k = 1 + (rung.lobes if rung.spectral else 0)
    shared = shared_unknowns(rung).count
    rng = np.random.default_rng(seed)
    size = BANDS * k + shared
    matrix = np.zeros((PROBLEMS, size, size))
    for band in range(BANDS):
        places = np.r_[band * k : (band + 1) * k, BANDS * k : size]
        root = rng.normal(size=(PROBLEMS, 3 * len(places), len(places)))
        matrix[:, places[:, None], places] += root.swapaxes(1, 2) @ root
    return matrix, 0.5 * rng.normal(size=(PROBLEMS, size)), k, shared


def equations_of(matrix: np.ndarray, gradient: np.ndarray, k: int) -> Equations:
    ends = BANDS * k
    blocks = [slice(b * k, (b + 1) * k) for b in range(BANDS)]
    return Equations(
        np.stack([matrix[:, s, s] for s in blocks], axis=1),
        np.stack([matrix[:, s, ends:] for s in blocks], axis=1),
        matrix[:, ends:, ends:],
        np.stack([gradient[:, s] for s in blocks], axis=1),
        gradient[:, ends:],
    )


def solved_whole(
    matrix: np.ndarray, gradient: np.ndarray, damping: float, held: tuple[int, ...] = ()
) -> np.ndarray:
    """Levenberg and Marquardt's step of one problem; held unknowns do not move."""
    free = np.setdiff1d(np.arange(len(gradient)), held)
    damped = matrix + damping * np.diag(np.diag(matrix))
    step = np.zeros(len(gradient))
    step[free] = np.linalg.solve(damped[np.ix_(free, free)], -gradient[free])
    return step


def moved(rung: Rung, before: States, after: States, k: int) -> np.ndarray:
    """How far each unknown went, in the order of the whole matrix."""
    own = np.concatenate([after.kd[:, None] - before.kd[:, None], (after.ks - before.ks)], axis=1)
    own = own[:, :k].swapaxes(1, 2).reshape(PROBLEMS, -1)
    unknowns = shared_unknowns(rung)
    return np.concatenate([own, unknowns.values(after) - unknowns.values(before)], axis=1)


@pytest.mark.parametrize("rung", RUNGS, ids=lambda r: r.name)
@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_a_step_solves_the_whole_system(rung: Rung, damping: float) -> None:
    matrix, gradient, k, _ = matrix_of(rung)
    gradient *= 0.1  # within the limits of one step
    before = states_of(rung)
    per_problem = np.array([damping, 2.0 * damping])
    after = gauss_newton_step(
        shared_unknowns(rung), before, equations_of(matrix, gradient, k), per_problem
    )
    for p in range(PROBLEMS):
        expected = solved_whole(matrix[p], gradient[p], per_problem[p])
        np.testing.assert_allclose(
            moved(rung, before, after, k)[p], expected, rtol=1e-8, atol=1e-10
        )
        assert np.max(np.abs(expected)) > 1e-3


@pytest.mark.parametrize(("end", "inward"), [("low", 1.0), ("high", -1.0)])
def test_an_unknown_that_is_pushed_over_its_bound_is_held(end: str, inward: float) -> None:
    rung = RUNGS[2]
    unknowns = shared_unknowns(rung)
    matrix, gradient, k, _ = matrix_of(rung)
    gradient *= 0.1
    before = states_of(rung)
    bound = getattr(unknowns, end)[unknowns.t.start]
    before.t[:] = bound
    place = BANDS * k + unknowns.t.start
    gradient[:, place] = 0.4 * inward  # the step would go against it, out of range
    after = gauss_newton_step(
        unknowns, before, equations_of(matrix, gradient, k), np.zeros(PROBLEMS)
    )
    for p in range(PROBLEMS):
        expected = solved_whole(matrix[p], gradient[p], 0.0, held=(place,))
        np.testing.assert_allclose(
            moved(rung, before, after, k)[p], expected, rtol=1e-8, atol=1e-10
        )
    # Pushed inward it is free again.
    gradient[:, place] = -0.4 * inward
    after = gauss_newton_step(
        unknowns, before, equations_of(matrix, gradient, k), np.zeros(PROBLEMS)
    )
    expected = [solved_whole(matrix[p], gradient[p], 0.0)[place] for p in range(PROBLEMS)]
    np.testing.assert_allclose(after.t - bound, expected, rtol=1e-8)


def test_an_albedo_at_zero_is_held_while_it_is_pushed_below() -> None:
    rung = RUNGS[3]
    matrix, gradient, k, _ = matrix_of(rung)
    gradient *= 0.1
    before = states_of(rung)
    before.kd[:, 1] = 0.0
    gradient[:, k] = 0.3
    after = gauss_newton_step(
        shared_unknowns(rung), before, equations_of(matrix, gradient, k), np.zeros(PROBLEMS)
    )
    for p in range(PROBLEMS):
        expected = solved_whole(matrix[p], gradient[p], 0.0, held=(k,))
        np.testing.assert_allclose(
            moved(rung, before, after, k)[p], expected, rtol=1e-8, atol=1e-10
        )
    assert np.all(after.kd[:, 1] == 0.0)


def test_no_step_is_longer_than_its_limit_and_none_leaves_the_bounds() -> None:
    rung = RUNGS[2]
    unknowns = shared_unknowns(rung)
    matrix, gradient, k, _ = matrix_of(rung)
    before = states_of(rung)
    steep = equations_of(matrix, 1e3 * gradient, k)
    after = gauss_newton_step(unknowns, before, steep, np.zeros(PROBLEMS))
    widths, indices = np.abs(after.log_s - before.log_s), np.abs(after.n - before.n)
    assert np.max(widths) == pytest.approx(WIDTH_STEP)
    assert np.max(widths) <= WIDTH_STEP + 1e-12
    assert np.max(indices) <= INDEX_STEP + 1e-12
    values = unknowns.values(after)
    assert np.all((values >= unknowns.low) & (values <= unknowns.high))
    assert np.all(after.kd >= 0.0)
    assert np.all(after.ks >= 0.0)


def test_an_unknown_without_curvature_stays() -> None:
    """A lobe of no strength has no width to find."""
    rung = RUNGS[2]
    unknowns = shared_unknowns(rung)
    matrix, gradient, k, _ = matrix_of(rung)
    gradient *= 0.1
    place = BANDS * k + unknowns.log_s.start
    matrix[:, place] = matrix[:, :, place] = 0.0
    gradient[:, place] = 0.0
    before = states_of(rung)
    after = gauss_newton_step(
        unknowns, before, equations_of(matrix, gradient, k), np.zeros(PROBLEMS)
    )
    assert np.all(after.log_s[:, 0] == before.log_s[:, 0])
    for p in range(PROBLEMS):
        expected = solved_whole(matrix[p], gradient[p], 0.0, held=(place,))
        np.testing.assert_allclose(
            moved(rung, before, after, k)[p], expected, rtol=1e-8, atol=1e-10
        )
