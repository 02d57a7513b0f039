"""What is believed of a printed surface before any reading (docs/estimate.md gives the reasons).

A surface is two lobes of one refractive index over a diffuse body: a main one and, as every paper
with a goniophotometer table here has, a weaker and broader one. The five unknowns of N surfaces are
an array (N, 5), in the order of NAMES.
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array

NAMES = ("log_s_deg", "refractive_index", "strength", "log_ratio", "log_share")
LOG_S, INDEX, STRENGTH, RATIO, SHARE = range(5)
#: Widths of the main lobe, degrees: even in the logarithm, and below the narrow one ever rarer, in
#: proportion to the width: to a gloss meter such lobes are mirrors, and prints are none.
WIDTH_RANGE_DEG, NARROW_DEG = (0.05, 40.0), 0.3
#: Resins, varnishes, oils and papers have 1.45 to 1.6.
INDEX_MEAN, INDEX_SD, INDEX_RANGE = 1.5, 0.05, (1.3, 1.7)
#: The strength of both lobes together is the share of the surface that reflects. Half of what is
#: believed is a surface that reflects everywhere, 1 with this standard deviation (the errors of a
#: fit may lead beyond 1); half is any share, with a density that grows with its square up to 1.
STRENGTH_SD, STRENGTH_MAX = 0.05, 1.3
#: The second lobe's width over the main one's, and its strength over the main one's: even in the
#: logarithm. A share of 0.001 is no second lobe to any instrument.
RATIO_RANGE, SHARE_RANGE = (2.0, 16.0), (1e-3, 0.3)

LOWER = np.array(
    [
        np.log(WIDTH_RANGE_DEG[0]),
        INDEX_RANGE[0],
        0.0,
        np.log(RATIO_RANGE[0]),
        np.log(SHARE_RANGE[0]),
    ]
)
UPPER = np.array(
    [
        np.log(WIDTH_RANGE_DEG[1]),
        INDEX_RANGE[1],
        STRENGTH_MAX,
        np.log(RATIO_RANGE[1]),
        np.log(SHARE_RANGE[1]),
    ]
)


def draws(count: int, random: np.random.Generator) -> Array:
    """Surfaces (count, 5) of the prior, spread evenly along each unknown (Latin hypercube)."""
    places = (np.arange(count) + random.random((5, count))) / count
    even = np.stack([random.permutation(row) for row in places], axis=1)
    result: Array = LOWER + even * (UPPER - LOWER)
    for k, log_marginal in _MARGINALS.items():
        grid = np.linspace(LOWER[k], UPPER[k], 2001)
        density = np.exp(log_marginal(grid))
        cumulative = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]))])
        result[:, k] = np.interp(even[:, k], cumulative / cumulative[-1], grid)
    return result


def log_density(surfaces: Array) -> Array:
    """Logarithm (N,) of the prior's density, but for a constant; -inf outside its range."""
    inside = np.all((surfaces >= LOWER) & (surfaces <= UPPER), axis=1)
    value = sum(log_marginal(surfaces[:, k]) for k, log_marginal in _MARGINALS.items())
    return np.where(inside, value, -np.inf)


def _log_width(log_s: Array) -> Array:
    return np.asarray(np.minimum(log_s - np.log(NARROW_DEG), 0.0))


def _log_index(index: Array) -> Array:
    return np.asarray(-0.5 * ((index - INDEX_MEAN) / INDEX_SD) ** 2)


def _log_strength(strength: Array) -> Array:
    everywhere = np.exp(-0.5 * ((strength - 1.0) / STRENGTH_SD) ** 2)
    everywhere /= STRENGTH_SD * np.sqrt(2.0 * np.pi)
    share = np.where(strength <= 1.0, 3.0 * np.square(strength), 0.0)
    return np.asarray(np.log(0.5 * everywhere + 0.5 * share + 1e-12))


#: The unknowns that are not even, each with the logarithm of its density but for a constant.
_MARGINALS = {LOG_S: _log_width, INDEX: _log_index, STRENGTH: _log_strength}
