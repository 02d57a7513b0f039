"""Which settings a sample's scale values tell to be best, and how surely."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.experiment.design.coordinates import coordinates
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.scaling.fine_grid import (
    POINT_LIKE,
    RIDGE_LIKE,
    Optimum,
    Shape,
    Smooth,
)

FEWEST_OBSERVERS = 5  #: below, a bootstrap over them is too narrow to call anything best
TIE = 1e-9  #: values closer than this are equal
LEVEL = 0.03  #: of the test that settings differ at all, shared by a study's samples
#: The verdicts on a sample.
BEST = "best"  #: one setting, or a few beside it
RIDGE = "ridge"  #: a curve of settings that are as good as each other
BROAD = "broad"  #: too many settings are as good
CHANCE = "chance"  #: the answers can't be told from answers by chance
FEW = "few"  #: fewer than FEWEST_OBSERVERS


@dataclass(frozen=True)
class Verdict:
    """What is best for one sample by one scale. Arrays are over the settings of the grid."""

    status: str
    leading: int  #: the setting with the largest scale value
    wins: Array | None  #: share of resamplings of the observers in which each setting leads
    as_good: Mask  #: not distinguishable from the leading one at 95 %, jointly
    optimum: Optimum  #: of the smooth fit, between grid points
    shape: Shape | None  #: of what is as good as that
    edges: tuple[str, ...]  #: of the grid on which the leading setting lies
    smooth: Array  #: (fine sigma_N, fine c), closeness of the smooth fit


def verdict_on(
    grid: Grid,
    scale: Array,
    draws: Array | None,
    smooth: Smooth,
    p_chance: float,
    level: float,
    observers: int,
) -> Verdict:
    """The verdict on scale values (J,), NaN without answers, their draws (B, J) and the smooth fit.

    Draws are NaN where those who were drawn tell nothing of a setting. p_chance: of the answers if
    settings did not differ; above `level` nothing is called best. Fewer than FEWEST_OBSERVERS can't
    show how surely, so that too few comes before chance.
    """
    leading = _leading(grid, scale, smooth)
    shape = None
    if smooth.draws is not None:
        shape = smooth.fine.shape_of_best(smooth.closeness, smooth.draws)
    status = BEST
    if shape is None or observers < FEWEST_OBSERVERS:
        status = FEW
    elif p_chance > level:
        status = CHANCE
    elif shape.kind != POINT_LIKE:
        status = RIDGE if shape.kind == RIDGE_LIKE else BROAD
    wins = None
    as_good = np.zeros(len(scale), dtype=bool)
    as_good[leading] = True
    if draws is not None and np.any(np.isfinite(draws)):
        wins = _wins(draws)
        as_good = _as_good(scale, draws, leading)
    return Verdict(
        status=status,
        leading=leading,
        wins=wins,
        as_good=as_good,
        optimum=smooth.fine.optimum(smooth.closeness, smooth.draws, observers),
        shape=shape,
        edges=edges_of(grid, leading),
        smooth=smooth.closeness.reshape(smooth.fine.shape),
    )


def _leading(grid: Grid, scale: Array, smooth: Smooth) -> int:
    """The setting with the largest value; of equals, the one that the smooth fit has closest."""
    equals = np.flatnonzero(scale >= np.nanmax(scale) - TIE)
    places, points = coordinates(grid)[equals], smooth.fine.points
    nearest = [int(np.argmin(np.sum((points - place) ** 2, axis=1))) for place in places]
    return int(equals[np.argmax(smooth.closeness[nearest])])


def _wins(draws: Array) -> Array:
    """Share of draws (B, J) in which each setting leads; those that lead together share a draw."""
    filled = np.where(np.isfinite(draws), draws, -np.inf)
    filled = filled[np.any(np.isfinite(draws), axis=1)]
    leads = filled >= filled.max(axis=1, keepdims=True) - TIE
    return np.asarray(np.mean(leads / leads.sum(axis=1, keepdims=True), axis=0))


def _as_good(scale: Array, draws: Array, leading: int) -> Mask:
    """Settings not worse than the leading one at 95 %, all comparisons together.

    Multiple comparisons with the best (Hsu 1984): what each setting lies behind at least is as far
    below what was found as covers all settings in 95 % of the bootstrap's draws.
    """
    apart = scale[leading] - scale
    drawn = draws[:, leading, None] - draws
    there = np.isfinite(drawn)
    count = np.maximum(there.sum(axis=0), 1)
    filled = np.where(there, drawn, 0.0)
    mean = filled.sum(axis=0) / count
    sd = np.sqrt(np.sum(np.where(there, filled - mean, 0.0) ** 2, axis=0) / count)
    scaled = np.isfinite(scale)
    varies = scaled & (sd > TIE)
    critical = 0.0
    if np.any(varies):
        behind = np.where(there, apart - filled, -np.inf)[:, varies] / sd[varies]
        critical = float(np.quantile(np.max(behind, axis=1), 0.95))
    as_good = scaled & (np.where(scaled, apart, np.inf) <= critical * sd + TIE)
    as_good[leading] = True
    return np.asarray(as_good)


def edges_of(grid: Grid, leading: int) -> tuple[str, ...]:
    """The edges of the grid on which a setting lies."""
    row, column = divmod(leading, grid.shape[1])
    edges = []
    if len(grid.sigma_n_deg) > 1:
        edges += ["smallest sigma_N"] if row == 0 else []
        edges += ["largest sigma_N"] if row == grid.shape[0] - 1 else []
    if len(grid.c_fraction) > 1:
        edges += ["smallest c"] if column == 0 else []
        edges += ["largest c"] if column == grid.shape[1] - 1 else []
    return tuple(edges)
