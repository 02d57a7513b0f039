"""Nonnegative least squares for the linear unknowns of a rung, from normal equations.

Each band has at most three unknowns of its own, so every set of positive ones can be tried: the
best feasible one is the exact solution. Where the lobe strengths are shared by all bands the
normal equations are an arrow, solved through its Schur complement.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Relative ridge: keeps columns that the samples cannot tell apart from dividing by zero.
RIDGE = 1e-11
_ROUNDS = 8


def nnls_blocks(a: Array, r: Array) -> Array:
    """Minimise x'Ax/2 - r'x over x >= 0 for B independent problems, A (B, K, K), r (B, K), K <= 3.

    Columns with a zero diagonal get zero.
    """
    bands, k = r.shape
    diagonal = np.einsum("bkk->bk", a)
    seen = diagonal > 0.0
    scale = np.where(seen, 1.0 / np.sqrt(np.where(seen, diagonal, 1.0)), 0.0)
    unit = a * scale[:, :, None] * scale[:, None, :]
    right = r * scale
    best = np.zeros((bands, k))
    lowest = np.zeros(bands)
    for chosen in product((False, True), repeat=k):
        index = np.flatnonzero(chosen)
        if len(index) == 0:
            continue
        block = unit[:, index[:, None], index] + RIDGE * np.eye(len(index))
        present = seen[:, index]
        block = np.where(present[:, :, None] & present[:, None, :], block, np.eye(len(index)))
        x = np.linalg.solve(block, right[:, index, None])[..., 0]
        objective = -0.5 * np.sum(x * right[:, index], axis=1)
        better = np.all(x >= 0.0, axis=1) & (objective < lowest)
        lowest = np.where(better, objective, lowest)
        full = np.zeros((bands, k))
        full[:, index] = x
        best = np.where(better[:, None], full, best)
    return np.asarray(best * scale)


def nnls_arrow(a: Array, c: Array, d: Array, r: Array, q: Array) -> tuple[Array, Array]:
    """One own unknown a band and J <= 2 unknowns shared by all bands, all nonnegative.

    Minimises sum_b (a_b x_b^2/2 + x_b c_b.y - r_b x_b) + y'Dy/2 - q'y, with a (B,), c (B, J),
    d (J, J), r (B,), q (J,). Returns x (B,) and y (J,).

    For given y the best x_b is max(0, (r_b - c_b.y)/a_b); the set of positive x_b is iterated to a
    fixed point for every set of positive y.
    """
    shared = len(q)
    diagonal = np.diag(d)
    # Peaks of narrow lobes are 1e4 times those of wide ones: compare columns at unit length.
    scale = np.where(diagonal > 0.0, 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0)), 0.0)
    c, d, q = c * scale, d * scale[:, None] * scale, q * scale
    seen = a > 0.0
    inverse = np.where(seen, 1.0 / np.where(seen, a, 1.0), 0.0)
    lowest, best_x, best_y = np.inf, np.zeros_like(r), np.zeros(shared)
    for chosen in product((False, True), repeat=shared):
        index = np.flatnonzero(chosen)
        free = seen.copy()
        x, y = np.zeros_like(r), np.zeros(shared)
        for _ in range(_ROUNDS):
            if len(index):
                left = c[:, index] * (inverse * free)[:, None]
                schur = d[np.ix_(index, index)] - c[:, index].T @ left
                right = q[index] - left.T @ r
                y[index] = np.linalg.lstsq(schur + RIDGE * np.eye(len(index)), right, rcond=None)[0]
            wanted = (r - c @ y) * inverse
            x = np.maximum(wanted, 0.0)
            again = seen & (wanted > 0.0)
            if np.array_equal(again, free):
                break
            free = again
        if np.any(y < 0.0):
            continue
        objective = float(np.sum(0.5 * a * x * x + x * (c @ y) - r * x) + 0.5 * y @ d @ y - q @ y)
        if objective < lowest:
            lowest, best_x, best_y = objective, x, y
    return best_x, best_y * scale
