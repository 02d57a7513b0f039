"""Nonnegative least squares against scipy's, which works on the matrix, not on normal equations."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

from relgloss_view.fitting import linear

# Normal equations square the condition number: columns drawn here have one below about 1e3, so
# half of the digits are left.
TOLERANCE = 1e-7


@given(seed=st.integers(0, 2**32 - 1), unknowns=st.integers(1, 3))
@settings(max_examples=150, deadline=None)
def test_blocks_are_scipys_solution(seed: int, unknowns: int) -> None:
    rng = np.random.default_rng(seed)
    bands, rows = 4, 12
    matrix = rng.standard_normal((bands, rows, unknowns)) + rng.uniform(-1, 1)
    target = rng.standard_normal((bands, rows))
    a = np.einsum("bnk,bnl->bkl", matrix, matrix)
    r = np.einsum("bnk,bn->bk", matrix, target)
    solution = linear.nnls_blocks(a, r)
    for b in range(bands):
        np.testing.assert_allclose(solution[b], nnls(matrix[b], target[b])[0], atol=TOLERANCE)


@given(seed=st.integers(0, 2**32 - 1), shared=st.integers(1, 2))
@settings(max_examples=100, deadline=None)
def test_arrow_is_scipys_solution_of_the_stacked_problem(seed: int, shared: int) -> None:
    """Several problems at once, some of them with unknowns at zero."""
    rng = np.random.default_rng(seed)
    problems, bands, rows = 4, 5, 10
    own = rng.uniform(0.1, 1.0, (problems, bands, rows))
    common = rng.uniform(0.0, 1.0, (problems, bands, rows, shared))
    common = common * 10.0 ** rng.uniform(-1, 2, (problems, 1, 1, shared))
    target = rng.standard_normal((problems, bands, rows))
    target = target + rng.uniform(-0.5, 2.0, (problems, 1, 1))
    assert_scipys_solution(own, common, target)


def test_of_two_columns_alike_the_better_one_is_kept() -> None:
    """Where either shared column alone may be positive, the objective decides."""
    rng = np.random.default_rng(1)
    problems, bands, rows = 300, 4, 8
    own = rng.uniform(0.1, 1.0, (problems, bands, rows))
    alike = rng.uniform(0.0, 1.0, (problems, bands, rows, 1))
    common = alike + rng.uniform(0.0, 0.4, (problems, bands, rows, 2))
    target = alike[..., 0] + 0.7 * rng.standard_normal((problems, bands, rows))
    y = assert_scipys_solution(own, common, target)
    one = np.sum(y > 0.0, axis=1) == 1
    assert np.sum(one & (y[:, 0] > 0.0)) > 30
    assert np.sum(one & (y[:, 1] > 0.0)) > 30


def assert_scipys_solution(own: np.ndarray, common: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Own columns (P, B, N), shared ones (P, B, N, J), targets (P, B, N). Returns y (P, J)."""
    problems, bands, rows, shared = common.shape
    x, y = linear.nnls_arrow(
        np.sum(own**2, axis=2),
        np.einsum("pbn,pbnj->pbj", own, common),
        np.einsum("pbni,pbnj->pij", common, common),
        np.sum(own * target, axis=2),
        np.einsum("pbnj,pbn->pj", common, target),
    )
    assert np.all(x >= 0.0)
    assert np.all(y >= 0.0)
    for p in range(problems):
        dense = np.zeros((bands * rows, bands + shared))
        for b in range(bands):
            dense[b * rows : (b + 1) * rows, b] = own[p, b]
            dense[b * rows : (b + 1) * rows, bands:] = common[p, b]
        expected, residual = nnls(dense, target[p].ravel())
        solution = np.concatenate([x[p], y[p]])
        # The optimum is what counts: where it is flat the unknowns may differ more than it.
        assert np.linalg.norm(dense @ solution - target[p].ravel()) <= residual + 1e-6
        np.testing.assert_allclose(solution, expected, atol=1e-4 * (1.0 + np.max(expected)))
    return y


def test_unconstrained_least_squares_is_another_solution() -> None:
    """Control: where a shared unknown is held at zero, the problem without bounds fits better."""
    a, c, d = np.array([[2.0]]), np.array([[[1.0]]]), np.array([[[2.0]]])
    r, q = np.array([[1.0]]), np.array([[-1.0]])
    x, y = linear.nnls_arrow(a, c, d, r, q)
    assert (x[0, 0], y[0, 0]) == (pytest.approx(0.5), 0.0)
    free = np.linalg.solve([[2.0, 1.0], [1.0, 2.0]], [1.0, -1.0])
    assert free == pytest.approx([1.0, -1.0])


def test_an_invisible_column_gets_nothing() -> None:
    a = np.array([[[2.0, 0.0], [0.0, 0.0]]])
    solution = linear.nnls_blocks(a, np.array([[1.0, 0.0]]))
    assert solution[0, 0] == pytest.approx(0.5, rel=1e-10)
    assert solution[0, 1] == 0.0


def test_an_invisible_shared_column_gets_nothing() -> None:
    x, y = linear.nnls_arrow(
        np.array([[2.0]]),
        np.zeros((1, 1, 1)),
        np.zeros((1, 1, 1)),
        np.ones((1, 1)),
        np.zeros((1, 1)),
    )
    assert x == pytest.approx(np.array([[0.5]]))
    assert y == pytest.approx(np.array([[0.0]]))
