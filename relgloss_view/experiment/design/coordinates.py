"""Where a setting lies in steps of its grid: grain in steps of sigma_N, gloss in steps of log c.

Observers judge ratios, so that equal ratios of c are equal steps (Fechner 1860); halving c_max/6 is
as far as halving c_max. The first setting is (0, 0), the last has as many steps as the grid.
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.experiment.design.grid import Grid


def coordinates(grid: Grid) -> Array:
    """Of all settings, (len(grid), 2), in the order of Grid.settings."""
    across = np.interp(grid.sigma_n_deg, *_sigma_axis(grid))
    down = np.interp(_log_c(grid, np.asarray(grid.c_fraction)), *_gloss_axis(grid))
    return np.array([(x, y) for x in across for y in down])


def to_steps(grid: Grid, sigma_n_deg: float, c_fraction: float) -> tuple[float, float]:
    """A setting anywhere in the grid's range, as coordinates."""
    x = np.interp(sigma_n_deg, *_sigma_axis(grid))
    y = np.interp(_log_c(grid, np.asarray(c_fraction)), *_gloss_axis(grid))
    return float(x), float(y)


def from_steps(grid: Grid, points: Array) -> Array:
    """(n, 2) coordinates as (n, 2): sigma_N in degrees, c as a share of c_max."""
    (low, high), (first, last) = _sigma_axis(grid), _gloss_axis(grid)
    sigma = np.interp(points[:, 0], high, low)
    shift = _shift(grid)
    c = np.exp(np.interp(points[:, 1], last, first)) - shift
    return np.stack([sigma, np.maximum(c, 0.0)], axis=1)


def grid_steps(grid: Grid, sigma_n_deg: float, c_fraction: float) -> tuple[float, float]:
    """A setting in whole numbers of the grid's values: (1.5, 2) is between the 2nd and 3rd sigma_N.

    This is how far settings lie from each other as a table shows them; c is linear in between.
    """
    rows, columns = grid.shape
    return (
        float(np.interp(sigma_n_deg, grid.sigma_n_deg, np.arange(rows))),
        float(np.interp(c_fraction, grid.c_fraction, np.arange(columns))),
    )


def _sigma_axis(grid: Grid) -> tuple[Array, Array]:
    """Ends of sigma_N, and of its coordinate."""
    values = np.asarray(grid.sigma_n_deg)
    if len(values) == 1:
        return values, np.zeros(1)
    return values[[0, -1]], np.array([0.0, len(values) - 1.0])


def _gloss_axis(grid: Grid) -> tuple[Array, Array]:
    logs = _log_c(grid, np.asarray(grid.c_fraction))
    if len(logs) == 1:
        return logs, np.zeros(1)
    return logs[[0, -1]], np.array([0.0, len(logs) - 1.0])


def _log_c(grid: Grid, c_fraction: Array) -> Array:
    return np.asarray(np.log(c_fraction + _shift(grid)))


def _shift(grid: Grid) -> float:
    """What keeps the logarithm finite in a grid with c = 0: half of its smallest other c."""
    if grid.c_fraction[0] > 0.0:
        return 0.0
    return 0.5 * grid.c_fraction[1] if len(grid.c_fraction) > 1 else 1.0
