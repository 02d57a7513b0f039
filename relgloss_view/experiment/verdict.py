"""Which settings a sample's scale values tell to be best, and how surely."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from relgloss_view.experiment.grid import Grid
from relgloss_view.experiment.surface import (
    POINT_LIKE,
    RIDGE_LIKE,
    FineGrid,
    Optimum,
    Shape,
)

Array = NDArray[np.float64]

LEVEL = 0.03  #: of the test that settings differ at all, shared by a study's samples
#: What is said of a sample.
BEST = "best"  #: one setting, or a few beside it
RIDGE = "ridge"  #: a curve of settings that are as good as each other
BROAD = "broad"  #: too many settings are as good
CHANCE = "chance"  #: the answers can't be told from answers by chance
FEW = "few"  #: too few observers to say how surely


@dataclass(frozen=True)
class Verdict:
    """What is best for one sample by one scale. Arrays are over the settings of the grid."""

    status: str
    leading: int  #: the setting with the largest scale value
    wins: Array | None  #: share of resamplings of the observers in which each setting leads
    as_good: NDArray[np.bool_]  #: not distinguishable from the leading one at 95 %, jointly
    optimum: Optimum  #: of the smooth fit, between grid points
    shape: Shape | None  #: of what is as good as that
    edges: tuple[str, ...]  #: of the grid on which the leading setting lies
    smooth: Array  #: (fine sigma_N, fine c), closeness of the smooth fit

    @property
    def declared(self) -> bool:
        """Whether a setting is called the best."""
        return self.status == BEST


@dataclass(frozen=True)
class Smooth:
    """Closeness on the points of a fine grid: (points,), and its draws (B, points)."""

    fine: FineGrid
    closeness: Array
    draws: Array | None

    def plus(self, other: Smooth) -> Smooth:
        """Both together, as when both have to be right."""
        draws = None
        if self.draws is not None and other.draws is not None:
            draws = self.draws + other.draws
        return Smooth(self.fine, self.closeness + other.closeness, draws)


def judged(
    grid: Grid, scale: Array, draws: Array | None, smooth: Smooth, p_chance: float, level: float
) -> Verdict:
    """The verdict on scale values (J,), NaN without answers, their draws (B, J) and the smooth fit.

    p_chance: of the answers if settings did not differ; above `level` nothing is called best. One
    observer without repeats can't show that, so that too few comes before chance.
    """
    leading = int(np.nanargmax(scale))
    shape = None
    if smooth.draws is not None:
        shape = smooth.fine.shape_of_best(smooth.closeness, smooth.draws)
    status = BEST
    if shape is None:
        status = FEW
    elif p_chance > level:
        status = CHANCE
    elif shape.kind != POINT_LIKE:
        status = RIDGE if shape.kind == RIDGE_LIKE else BROAD
    wins = None
    as_good = np.zeros(len(scale), dtype=bool)
    as_good[leading] = True
    if draws is not None:
        filled = np.where(np.isfinite(draws), draws, -np.inf)
        wins = np.bincount(np.argmax(filled, axis=1), minlength=len(scale)) / len(draws)
        as_good = _as_good(scale, draws, leading)
    return Verdict(
        status,
        leading,
        wins,
        as_good,
        smooth.fine.optimum(smooth.closeness, smooth.draws),
        shape,
        edges_of(grid, leading),
        smooth.closeness.reshape(smooth.fine.shape),
    )


def _as_good(scale: Array, draws: Array, leading: int) -> NDArray[np.bool_]:
    """Settings not worse than the leading one at 95 %, all comparisons together.

    Multiple comparisons with the best (Hsu 1984): what each setting lies behind at least is as far
    below what was found as covers all settings in 95 % of the bootstrap's draws.
    """
    apart = scale[leading] - scale
    drawn = draws[:, leading, None] - draws
    sd = np.std(drawn, axis=0)
    told = np.isfinite(scale) & (sd > 0.0)
    found = np.zeros(len(scale), dtype=bool)
    found[leading] = True
    if not np.any(told):
        return found
    largest = np.max((apart[told] - drawn[:, told]) / sd[told], axis=1)
    critical = float(np.quantile(largest, 0.95))
    found[told] |= apart[told] <= critical * sd[told]
    return found


def edges_of(grid: Grid, leading: int) -> tuple[str, ...]:
    """The edges of the grid on which a setting lies."""
    row, column = divmod(leading, grid.shape[1])
    found = []
    if len(grid.sigma_n_deg) > 1:
        found += ["smallest sigma_N"] if row == 0 else []
        found += ["largest sigma_N"] if row == grid.shape[0] - 1 else []
    if len(grid.c_fraction) > 1:
        found += ["smallest c"] if column == 0 else []
        found += ["largest c"] if column == grid.shape[1] - 1 else []
    return tuple(found)
