"""Which settings a sample's scale values tell to be best, and how surely."""

from __future__ import annotations

import dataclasses
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
from relgloss_view.experiment.scaling.two_places import TwoPlaces
from relgloss_view.experiment.verdict.groups import MixedGroups

FEWEST_OBSERVERS = 5  #: below, a bootstrap over them is too narrow to call anything best
TIE = 1e-9  #: values closer than this are equal
LEVEL = 0.03  #: of the test that settings differ at all, shared by a study's samples
#: The verdicts on a sample.
BEST = "best"  #: one setting, or a few beside it
RIDGE = "ridge"  #: a curve of settings that are as good as each other
BROAD = "broad"  #: too many settings are as good
CHANCE = "chance"  #: the answers can't be told from answers by chance
FEW = "few"  #: fewer than FEWEST_OBSERVERS
MIXED = "mixed"  #: two groups of observers agree on no one setting
TWO = "two"  #: two places apart from each other are right
ALIKE = "alike"  #: nearly all answers are the same: too few differ to show where the best is
ALIKE_SHARE = 0.9  #: of the answers in one category


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
    groups: MixedGroups | None = None  #: of observers who disagree
    places: tuple[int, int] | None = None  #: settings nearest to two right places
    alike: float = 0.0  #: the share of the answers that is in one category


def verdict_on(
    grid: Grid,
    scale: Array,
    draws: Array | None,
    smooth: Smooth,
    p_chance: float,
    level: float,
    observers: int,
    *,
    groups: MixedGroups | None = None,
    places: TwoPlaces | None = None,
    alike: float = 0.0,
) -> Verdict:
    """The verdict on scale values (J,), NaN without answers, their draws (B, J) and the smooth fit.

    Draws are NaN where those who were drawn tell nothing of a setting. p_chance: of the answers if
    settings did not differ; above `level` nothing is called best. Fewer than FEWEST_OBSERVERS can't
    show how surely, so that too few comes before chance. `alike` is the share of the most frequent
    answer: where it is nearly all, other answers are too few to be told from chance, and that is no
    sign of answers at random. With mixed `groups` or two `places` no setting is the best one; the
    optimum, which is that of one place for all, has no interval then.
    """
    leading = _leading(grid, scale, smooth)
    shape = None
    if smooth.draws is not None:
        shape = smooth.fine.shape_of_best(smooth.closeness, smooth.draws)
    status = BEST
    if shape is None or observers < FEWEST_OBSERVERS:
        status = FEW
    elif p_chance > level:
        status = ALIKE if alike >= ALIKE_SHARE else CHANCE
    elif groups is not None:
        status = MIXED
    elif places is not None:
        status = TWO
    elif shape.kind != POINT_LIKE:
        status = RIDGE if shape.kind == RIDGE_LIKE else BROAD
    wins = None
    as_good = np.zeros(len(scale), dtype=bool)
    as_good[leading] = True
    if draws is not None and np.any(np.isfinite(draws)):
        wins = _wins(draws)
        as_good = _as_good(scale, draws, leading)
    # Where one setting is better than all others, the smooth fit decides no more than where
    # between it and its neighbours the optimum lies.
    alone = wins is not None and int(np.sum(as_good)) == 1
    within = smooth.fine.near(leading) if alone else None
    optimum = smooth.fine.optimum(smooth.closeness, smooth.draws, observers, within)
    if status in (MIXED, TWO):
        optimum = dataclasses.replace(optimum, sigma_n_interval_deg=None, c_interval=None)
    return Verdict(
        status=status,
        leading=leading,
        wins=wins,
        as_good=as_good,
        optimum=optimum,
        shape=shape,
        edges=edges_of(grid, leading),
        smooth=smooth.closeness.reshape(smooth.fine.shape),
        groups=groups,
        places=None if places is None else _nearest_two(grid, places),
        alike=alike,
    )


def _nearest_two(grid: Grid, places: TwoPlaces) -> tuple[int, int]:
    settings = coordinates(grid)
    first, second = (
        int(np.argmin(np.sum((settings - place) ** 2, axis=1)))
        for place in (places.first, places.second)
    )
    return min(first, second), max(first, second)


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
