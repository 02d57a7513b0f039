"""Nonnegative least squares where some lobe strengths are a band's own and others are shared."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.fitting.linear import RIDGE


def nnls_mixed(a: Array, c: Array, d: Array, r: Array, q: Array) -> tuple[Array, Array]:
    """P problems with K own unknowns a band and J unknowns that all bands share, all >= 0.

    Each minimises sum_b (x_b'A_b x_b/2 + x_b'C_b y - r_b'x_b) + y'Dy/2 - q'y, with a (P, B, K, K),
    c (P, B, K, J), d (P, J, J), r (P, B, K), q (P, J). Returns x (P, B, K) and y (P, J); a column
    that is zero everywhere gets zero. By the active set of Lawson and Hanson 1974 on the Cholesky
    factor of the normal equations.
    """
    from scipy.linalg import solve_triangular
    from scipy.optimize import nnls

    problems, bands, own = r.shape
    count, shared = bands * own, q.shape[1]
    matrix = np.zeros((problems, count + shared, count + shared))
    for b in range(bands):
        place = slice(b * own, (b + 1) * own)
        matrix[:, place, place] = a[:, b]
        matrix[:, place, count:] = c[:, b]
        matrix[:, count:, place] = np.swapaxes(c[:, b], 1, 2)
    matrix[:, count:, count:] = d
    right = np.concatenate([r.reshape(problems, count), q], axis=1)
    diagonal = np.einsum("pkk->pk", matrix)
    scale = np.where(diagonal > 0.0, 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0)), 0.0)
    unit = matrix * scale[:, :, None] * scale[:, None]
    # An absent column gets a diagonal of its own, so that the factor exists.
    np.einsum("pkk->pk", unit)[...] += np.where(scale > 0.0, RIDGE, 1.0)
    factor = np.linalg.cholesky(unit)
    solved = np.empty_like(right)
    for p in range(problems):
        aim = solve_triangular(factor[p], right[p] * scale[p], lower=True)
        solved[p] = nnls(factor[p].T, aim, maxiter=30 * len(aim))[0]
    solved *= scale
    return solved[:, :count].reshape(problems, bands, own), solved[:, count:]
