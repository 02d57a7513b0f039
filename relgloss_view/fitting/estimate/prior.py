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
#: Widths of the main lobe, degrees: even in the logarithm.
WIDTH_RANGE_DEG = (0.05, 40.0)
#: Resins, varnishes, oils and papers have 1.45 to 1.6.
INDEX_MEAN, INDEX_SD, INDEX_RANGE = 1.5, 0.05, (1.3, 1.7)
#: The strength of both lobes together is the share of the surface that reflects: its density grows
#: with its square up to 1, and falls as a Gaussian beyond, where a fit's errors may lead.
STRENGTH_SD, STRENGTH_MAX = 0.06, 1.3
#: The second lobe's width over the main one's, and its strength over the main one's: even in the
#: logarithm. A share of 0.002 is no second lobe to any instrument.
RATIO_RANGE, SHARE_RANGE = (2.0, 16.0), (0.002, 0.3)

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
    result = LOWER + even * (UPPER - LOWER)
    for k in (INDEX, STRENGTH):
        grid = np.linspace(LOWER[k], UPPER[k], 2001)
        density = np.exp(_log_index(grid) if k == INDEX else _log_strength(grid))
        cumulative = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]))])
        result[:, k] = np.interp(even[:, k], cumulative / cumulative[-1], grid)
    return result


def log_density(surfaces: Array) -> Array:
    """Logarithm (N,) of the prior's density, but for a constant; -inf outside its range."""
    inside = np.all((surfaces >= LOWER) & (surfaces <= UPPER), axis=1)
    value = _log_index(surfaces[:, INDEX]) + _log_strength(surfaces[:, STRENGTH])
    return np.where(inside, value, -np.inf)


def _log_index(index: Array) -> Array:
    return np.asarray(-0.5 * ((index - INDEX_MEAN) / INDEX_SD) ** 2)


def _log_strength(strength: Array) -> Array:
    grows = 2.0 * np.log(np.clip(strength, 1e-6, 1.0))
    falls = -0.5 * (np.maximum(strength - 1.0, 0.0) / STRENGTH_SD) ** 2
    return np.asarray(grows + falls)
