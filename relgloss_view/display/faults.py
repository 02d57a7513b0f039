"""Faults of a display that its readings show, each found by a test of its own.

A fault is named where it is large enough to be seen, and where chance does not explain it.
"""

from __future__ import annotations

import itertools

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.display.candidates import KINDS, OFFSET, Fitted, fit_candidate
from relgloss_view.material.spectra import D65_XY, SRGB_PRIMARIES_XY, rgb_to_xyz_matrix

CHANNELS = ("red", "green", "blue")
#: Ends of the scale that are tried; and by how much a fit must become better (squared standard
#: deviations): one display in a million does by chance, times the 30 trials.
TOPS = (0.97, 0.94, 0.9, 0.85, 0.8, 0.7)
BOTTOMS = (0.03, 0.06, 0.1, 0.15, 0.2)
BETTER = 35.0
WORSE = 2.0  #: factor of the squared distance that fine curves leave
SEEN_SHARE, SEEN_SE = 0.03, 5.0  #: of a colour's luminance that does not add; its standard errors
DRIFTED, DRIFTED_SE = 0.02, 5.0
_SUMS = {"white": (0, 1, 2), "yellow": (0, 1), "cyan": (1, 2), "magenta": (0, 2)}


def exchanged(matrix: Array) -> tuple[int, int, int]:
    """Which primary each channel shows, of the columns of a matrix (3, 3) of XYZ.

    By their light in linear sRGB: the order of channels that gathers most of it on the diagonal.

    >>> srgb = rgb_to_xyz_matrix(SRGB_PRIMARIES_XY, D65_XY)
    >>> exchanged(srgb), exchanged(srgb[:, [1, 0, 2]])
    ((0, 1, 2), (1, 0, 2))
    """
    srgb = np.linalg.solve(rgb_to_xyz_matrix(SRGB_PRIMARIES_XY, D65_XY), matrix)
    share = np.maximum(srgb, 0.0) / np.maximum(np.abs(srgb).sum(axis=0), 1e-12)
    orders = list(itertools.permutations(range(3)))
    gathered = [sum(share[order[k], k] for k in range(3)) for order in orders]
    best = orders[int(np.argmax(gathered))]
    if max(gathered) - gathered[orders.index((0, 1, 2))] < 0.2:  # as good as in order
        return 0, 1, 2
    return best[0], best[1], best[2]


def additivity(
    model: Fitted, digital: Array, xyz: Array, whitening: Array, unsteady: float
) -> tuple[str, float] | None:
    """The mixed colour that differs most from the sum of its channels, and by what share; or None.

    To black and matrix come the products of two and three channels' light, in one linear fit.
    """
    light = model.shape.light(digital, unsteady)
    r, g, b = light.T
    products = np.stack([r * g, g * b, b * r, r * g * b], axis=1)
    design = np.concatenate([np.ones((len(light), 1)), light, products], axis=1)
    rows = np.einsum("nij,nk->nikj", whitening, design).reshape(len(light) * 3, -1)
    target = np.einsum("nij,nj->ni", whitening, xyz).ravel()
    if np.linalg.matrix_rank(rows) < rows.shape[1]:
        return None
    solution, *_ = np.linalg.lstsq(rows, target, rcond=None)
    left = target - rows @ solution
    spread = max(float(left @ left) / max(len(target) - rows.shape[1], 1), 1.0)
    covariance = spread * np.linalg.inv(rows.T @ rows)
    pairs = [(0, 1), (1, 2), (0, 2)]
    largest: tuple[str, float] | None = None
    for name, channels in _SUMS.items():
        of_y, total = np.zeros(rows.shape[1]), np.zeros(rows.shape[1])
        for k, pair in enumerate(pairs):
            if set(pair) <= set(channels):
                of_y[3 * (4 + k) + 1] = 1.0
        if len(channels) == 3:
            of_y[3 * 7 + 1] = 1.0
        total[[1, *(3 * (1 + c) + 1 for c in channels)]] = 1.0
        extra, alone = float(of_y @ solution), float(total @ solution)
        error = float(np.sqrt(of_y @ covariance @ of_y))
        if alone <= 0.0 or abs(extra) < max(SEEN_SE * error, SEEN_SHARE * alone):
            continue
        if largest is None or abs(extra / alone) > abs(largest[1]):
            largest = name, extra / alone
    if largest is None:
        return None
    read = _read_share(_SUMS[largest[0]], digital, xyz[:, 1])
    return largest[0], largest[1] if read is None else read


def _read_share(channels: tuple[int, ...], digital: Array, y: Array) -> float | None:
    """By what share a full mixed colour read brighter than its primaries did together.

    None where one of them, or black, was not measured.
    """

    def at(lit: tuple[int, ...]) -> float:
        wanted = np.array([1.0 if k in lit else 0.0 for k in range(3)])
        return float(np.median(y[np.all(np.abs(digital - wanted) < 1e-3, axis=1)]))

    present = {tuple(row) for row in digital.round(3).tolist()}
    needed = [channels, (), *((k,) for k in channels)]
    if any(tuple(float(k in lit) for k in range(3)) not in present for lit in needed):
        return None
    black = at(())
    alone = sum(at((k,)) - black for k in channels)
    share = (at(channels) - black) / alone - 1.0 if alone > 0.0 else 0.0
    return share if abs(share) >= SEEN_SHARE else None


def clipped(
    digital: Array, xyz: Array, whitening: Array, unsteady: float, fine: Fitted
) -> dict[int, float]:
    """Channels whose light ends below the top of their scale, and the level where.

    fine: a model with fine curves, which must not be better: an S-shaped curve is none of these.
    """
    return _ended(digital, xyz, whitening, unsteady, fine, TOPS)


def crushed(
    digital: Array, xyz: Array, whitening: Array, unsteady: float, fine: Fitted
) -> dict[int, float]:
    """Channels whose light begins above 0, and the level where.

    fine: a model with fine curves, which must not be better: an S-shaped curve is none of these.
    """
    return _ended(digital, xyz, whitening, unsteady, fine, BOTTOMS)


def _ended(
    digital: Array,
    xyz: Array,
    whitening: Array,
    unsteady: float,
    fine: Fitted,
    levels: tuple[float, ...],
) -> dict[int, float]:
    """Of each channel the level that makes a fit of gain, offset and gamma much better.

    Channels are tried together first and then alone, so that a fault of all is found of all.
    """
    top = levels is TOPS

    def cut(channels: tuple[int, ...], level: float) -> Array:
        changed = digital.copy()
        for k in channels:
            if top:
                changed[:, k] = np.minimum(digital[:, k] / level, 1.0)
            else:
                changed[:, k] = np.maximum((digital[:, k] - level) / (1.0 - level), 0.0)
        return changed

    def far(model: Fitted, at: Array) -> float:
        z = np.einsum("nij,nj->ni", whitening, xyz - model.xyz(at, unsteady))
        return float(np.sum(np.minimum(np.sum(z * z, axis=1), 100.0)))

    def cost(changed: Array) -> float:
        model = fit_candidate(
            KINDS[1], changed, xyz, whitening, unsteady, offsets=OFFSET if top else (0.0, OFFSET[1])
        )
        return far(model, changed)

    curved = far(fine, digital)
    plain = cost(digital)
    found: dict[int, float] = {}
    for channels in ((0, 1, 2), (0,), (1,), (2,)):
        if found:
            break
        costs = [cost(cut(channels, level)) for level in levels]
        best = int(np.argmin(costs))
        if plain - costs[best] < BETTER or costs[best] > 0.7 * plain:
            continue
        if costs[best] > WORSE * curved + BETTER:
            continue
        end = levels[best]
        if len(channels) == 1:
            found[channels[0]] = end
            continue
        for k in channels:  # those of them that the fault needs
            others = tuple(c for c in channels if c != k)
            if cost(cut(others, end)) - costs[best] > BETTER:
                found[k] = end
    return found


def drift(model: Fitted, digital: Array, xyz: Array, unsteady: float) -> float | None:
    """By what share the light changed from the first patch to the last; None where it did not.

    A line through the logarithms of luminance over the model's, of patches that are not dark.
    """
    expected = model.xyz(digital, unsteady)[:, 1]
    lit = (expected > 0.05 * expected.max()) & (xyz[:, 1] > 0.0)
    if lit.sum() < 12:
        return None
    when = np.linspace(-0.5, 0.5, len(digital))[lit]
    off = np.log(xyz[lit, 1] / expected[lit])
    when = when - when.mean()
    total = float(when @ when)
    change = float(when @ off) / total
    left = off - off.mean() - change * when
    error = np.sqrt(float(left @ left) / (len(off) - 2) / total)
    if abs(change) < DRIFTED or abs(change) < DRIFTED_SE * error:
        return None
    return float(np.expm1(change))
