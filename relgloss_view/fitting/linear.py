"""Nonnegative least squares for the linear unknowns of a rung, from normal equations.

Each band has at most three unknowns of its own, so every set of positive ones can be tried: the
best feasible one is the exact solution. Where all bands share the lobe strengths, the normal
equations have the shape of an arrow and are solved through their Schur complement. Many problems
are solved at once. A problem whose unconstrained solution is nonnegative needs no further set,
because the problems are convex.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask

#: Relative ridge: keeps columns that the samples cannot separate from dividing by zero.
RIDGE = 1e-11
_ROUNDS = 8


def nnls_blocks(a: Array, r: Array) -> Array:
    """Minimise x'Ax/2 - r'x over x >= 0 for M independent problems, A (M, K, K), r (M, K), K <= 3.

    Columns with a zero diagonal get zero.
    """
    k = r.shape[1]
    scale = _unit_scale(np.einsum("mkk->mk", a))
    unit, right = a * scale[:, :, None] * scale[:, None, :], r * scale
    best = _solve_present(unit, right, scale > 0.0)
    rest = np.flatnonzero(~np.all(best >= 0.0, axis=1))
    if len(rest):
        best[rest] = 0.0
    lowest = np.zeros(len(rest))
    for positive in product((False, True), repeat=k):
        index = np.flatnonzero(positive)
        if len(rest) == 0 or not 0 < len(index) < k:
            continue
        block, aim = unit[rest[:, None, None], index[:, None], index], right[rest[:, None], index]
        x = _solve_present(block, aim, scale[rest[:, None], index] > 0.0)
        objective = -0.5 * np.sum(x * aim, axis=1)
        better = np.all(x >= 0.0, axis=1) & (objective < lowest)
        lowest[better] = objective[better]
        full = np.zeros((len(rest), k))
        full[:, index] = x
        best[rest[better]] = full[better]
    return np.asarray(best * scale)


def _solve_present(block: Array, right: Array, present: Mask) -> Array:
    """Solve A x = r with a ridge; a column that is not present gets its right-hand side, zero."""
    size = right.shape[1]
    if size == 1:
        return np.asarray(right / np.where(present, block[:, :, 0] + RIDGE, 1.0))
    block = block + RIDGE * np.eye(size)
    both = present[:, :, None] & present[:, None, :]
    block = np.where(both, block, np.eye(size))
    return np.asarray(np.linalg.solve(block, right[:, :, None])[..., 0])


def nnls_arrow(a: Array, c: Array, d: Array, r: Array, q: Array) -> tuple[Array, Array]:
    """P problems with one own unknown a band and J <= 2 unknowns shared by all bands, all >= 0.

    Each minimises sum_b (a_b x_b^2/2 + x_b c_b.y - r_b x_b) + y'Dy/2 - q'y, with a (P, B),
    c (P, B, J), d (P, J, J), r (P, B), q (P, J). Returns x (P, B) and y (P, J).

    For given y the best x_b is max(0, (r_b - c_b.y)/a_b); the set of positive x_b is iterated to a
    fixed point for every set of positive y.
    """
    # Peaks of narrow lobes are 1e4 times those of wide ones: compare columns at unit length.
    scale = _unit_scale(np.einsum("pjj->pj", d))
    c, d, q = c * scale[:, None], d * scale[:, :, None] * scale[:, None, :], q * scale
    best_x, best_y = np.zeros_like(r), np.zeros_like(q)
    lowest = np.full(len(q), np.inf)
    rest = np.arange(len(q))
    for positive in product((True, False), repeat=q.shape[1]):
        x, y, fixed = _arrow_at(np.flatnonzero(positive), a, c, d, r, q)
        feasible = np.all(y >= 0.0, axis=1)
        cross = (c @ y[:, :, None])[..., 0]
        objective = np.sum((0.5 * a * x + cross - r) * x, axis=1)
        objective = objective + np.sum((0.5 * (d @ y[:, :, None])[..., 0] - q) * y, axis=1)
        better = feasible & (objective < lowest)
        lowest = np.where(better, objective, lowest)
        best_x[rest[better]], best_y[rest[better]] = x[better], y[better]
        if all(positive):
            unsettled = ~(feasible & fixed)
            if not np.any(unsettled):
                break
            rest, lowest = rest[unsettled], lowest[unsettled]
            a, c, d, r, q = (part[unsettled] for part in (a, c, d, r, q))
    return best_x, best_y * scale


def _arrow_at(
    index: Ints, a: Array, c: Array, d: Array, r: Array, q: Array
) -> tuple[Array, Array, Mask]:
    """x and y where only the shared unknowns of `index` may differ from zero.

    Also returns, (P,), whether the set of positive x was a fixed point at the end.
    """
    present = a > 0.0
    inverse = np.where(present, 1.0 / np.where(present, a, 1.0), 0.0)
    y = np.zeros_like(q)
    part = c[:, :, index]
    corner = d[:, index[:, None], index] + RIDGE * np.eye(len(index))
    free = present
    for _ in range(_ROUNDS):
        if len(index):
            left = np.swapaxes(part * (inverse * free)[:, :, None], 1, 2)
            schur, right = corner - left @ part, q[:, index, None] - left @ r[:, :, None]
            step = right / schur if len(index) == 1 else np.linalg.solve(schur, right)
            y[:, index] = step[..., 0]
        wanted = (r - (c @ y[:, :, None])[..., 0]) * inverse
        again = present & (wanted > 0.0)
        fixed = np.all(again == free, axis=1)
        if np.all(fixed):
            break
        free = again
    return np.maximum(wanted, 0.0), y, fixed


def _unit_scale(diagonal: Array) -> Array:
    """What makes columns of these squared lengths unit columns; zero for a zero column."""
    return np.where(diagonal > 0.0, 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0)), 0.0)
