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
    found = linear.nnls_blocks(a, r)
    for b in range(bands):
        np.testing.assert_allclose(found[b], nnls(matrix[b], target[b])[0], atol=TOLERANCE)


@given(seed=st.integers(0, 2**32 - 1), shared=st.integers(1, 2))
@settings(max_examples=150, deadline=None)
def test_arrow_is_scipys_solution_of_the_stacked_problem(seed: int, shared: int) -> None:
    rng = np.random.default_rng(seed)
    bands, rows = 5, 10
    own = rng.uniform(0.1, 1.0, (bands, rows))
    common = rng.uniform(0.0, 1.0, (bands, rows, shared)) * 10.0 ** rng.uniform(-1, 2, shared)
    target = rng.standard_normal((bands, rows)) + rng.uniform(-0.5, 2.0)
    dense = np.zeros((bands * rows, bands + shared))
    for b in range(bands):
        dense[b * rows : (b + 1) * rows, b] = own[b]
        dense[b * rows : (b + 1) * rows, bands:] = common[b]
    expected, residual = nnls(dense, target.ravel())
    x, y = linear.nnls_arrow(
        np.sum(own**2, axis=1),
        np.einsum("bn,bnj->bj", own, common),
        np.einsum("bni,bnj->ij", common, common),
        np.sum(own * target, axis=1),
        np.einsum("bnj,bn->j", common, target),
    )
    assert np.all(x >= 0.0)
    assert np.all(y >= 0.0)
    found = np.concatenate([x, y])
    # The optimum is what counts: where it is flat the unknowns may differ more than it.
    assert np.linalg.norm(dense @ found - target.ravel()) <= residual + 1e-6
    np.testing.assert_allclose(found, expected, atol=1e-4 * (1.0 + np.max(expected)))


def test_an_invisible_column_gets_nothing() -> None:
    a = np.array([[[2.0, 0.0], [0.0, 0.0]]])
    found = linear.nnls_blocks(a, np.array([[1.0, 0.0]]))
    assert found[0, 0] == pytest.approx(0.5, rel=1e-10)
    assert found[0, 1] == 0.0


def test_an_invisible_shared_column_gets_nothing() -> None:
    x, y = linear.nnls_arrow(
        np.array([2.0]), np.zeros((1, 1)), np.zeros((1, 1)), np.array([1.0]), np.zeros(1)
    )
    assert x == pytest.approx([0.5])
    assert y == pytest.approx([0.0])
