"""The smooth fit on a fine grid: its optimum, and the shape of what is as good as that."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.experiment.design.coordinates import coordinates, from_steps
from relgloss_view.experiment.design.grid import Grid

PER_STEP = 10  #: fine points a step of the grid
Z_95 = 1.6449  #: one-sided 95 % point of the normal distribution
NEAR = 0.6  #: of the way to a setting's neighbours: the right place of a setting that stands alone
TAIL = 0.025  #: beyond either end of a 95 % interval
RIDGE_STEPS = 2.5  #: from this length on, and ...
RIDGE_RATIO = 3.0  #: ... this many times as long as wide, what is as good as the best is a ridge
BROAD_SHARE = 0.4  #: of the grid as good as the best: the answers do not tell
POINT_LIKE, RIDGE_LIKE, BROAD_LIKE = "point", "ridge", "broad"


def percentiles(observers: int) -> tuple[float, float]:
    """The shares of draws between which a 95 % interval from so few observers lies.

    Resampling n observers is like a normal interval with the variance's divisor n in place of
    n - 1 and without Student's t. The expanded percentile interval (Hesterberg 2015) makes up for
    both: its tail is Phi(-sqrt(n / (n - 1)) t), t that of a tail of 2.5 % with n - 1 degrees of
    freedom. 2 observers at least.
    """
    from scipy.special import ndtr, stdtrit

    n = max(observers, 2)
    tail = float(ndtr(math.sqrt(n / (n - 1.0)) * stdtrit(n - 1.0, TAIL)))
    return tail, 1.0 - tail


@dataclass(frozen=True)
class Optimum:
    """The smooth fit's best point, with 95 % intervals over observers where there are some."""

    sigma_n_deg: float
    c_fraction: float
    sigma_n_interval_deg: tuple[float, float] | None
    c_interval: tuple[float, float] | None


@dataclass(frozen=True)
class Shape:
    """The fine points that are not distinguishable from the best: how long, how wide, in steps."""

    length_steps: float
    width_steps: float
    share: float  #: of the grid
    kind: str  #: "point", "ridge" or "broad"


class FineGrid:
    """Points between the settings of a grid, `PER_STEP` to a step."""

    def __init__(self, grid: Grid) -> None:
        self.grid = grid
        ends = coordinates(grid)[-1]
        axes = [np.linspace(0.0, end, PER_STEP * round(end) + 1) for end in ends]
        self.shape = (len(axes[0]), len(axes[1]))
        self.points: Array = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 2)

    def near(self, setting: int) -> Mask:
        """Which points lie no farther from a setting than NEAR of the way to its neighbours."""
        places = coordinates(self.grid)
        place = places[setting]
        inside = np.ones(len(self.points), dtype=bool)
        for axis in (0, 1):
            of_axis = np.unique(places[:, axis])
            away = np.abs(of_axis - place[axis])
            below, above = away[of_axis < place[axis]], away[of_axis > place[axis]]
            apart = self.points[:, axis] - place[axis]
            half = 0.5 / PER_STEP  # the nearest fine points count where settings lie between them
            inside &= apart >= -max(NEAR * np.min(below, initial=np.inf), half)
            inside &= apart <= max(NEAR * np.min(above, initial=np.inf), half)
        return inside

    def optimum(
        self, smooth: Array, drawn: Array | None, observers: int, within: Mask | None = None
    ) -> Optimum:
        """The best of closeness (points,), with intervals from draws of it (B, points).

        Draws are resamplings of so many observers; see `percentiles`. Only the points `within` a
        mask count.
        An interval is half a fine step wider on both sides: between fine points nothing is known.
        """
        points = self.points if within is None else self.points[within]
        if within is not None:
            smooth, drawn = smooth[within], None if drawn is None else drawn[:, within]
        ((sigma, c),) = from_steps(self.grid, points[[np.argmax(smooth)]])
        if drawn is None:
            return Optimum(float(sigma), float(c), None, None)
        best = points[np.argmax(drawn, axis=1)]
        half = 0.5 / PER_STEP
        low, high = np.quantile(best, percentiles(observers), axis=0)
        low, high = np.maximum(low - half, 0.0), np.minimum(high + half, self.points[-1])
        lows, highs = from_steps(self.grid, np.stack([low, high]))
        return Optimum(
            float(sigma),
            float(c),
            (float(lows[0]), float(highs[0])),
            (float(lows[1]), float(highs[1])),
        )

    def shape_of_best(self, smooth: Array, drawn: Array) -> Shape:
        """What the points form whose closeness is within 95 % of the best's, one by one."""
        return self.region_of_best(smooth, drawn)[0]

    def region_of_best(self, smooth: Array, drawn: Array) -> tuple[Shape, Mask]:
        """That, and which points they are, (points,)."""
        best = int(np.argmax(smooth))
        sd = np.std(drawn[:, best, None] - drawn, axis=0)
        as_good = smooth[best] - smooth <= Z_95 * sd
        return shape_of(self.points, as_good), as_good


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


def shape_of(points: Array, as_good: Mask) -> Shape:
    """The form of a set of points of a regular fine grid: (F, 2) in steps, (F,) of them."""
    inside = points[as_good]
    step = 1.0 / PER_STEP
    share = float(np.mean(as_good))
    if len(inside) < 2:
        return Shape(step, step, share, POINT_LIKE)
    centred = inside - inside.mean(axis=0)
    _, axes = np.linalg.eigh(centred.T @ centred)
    length = float(np.ptp(centred @ axes[:, 1])) + step
    width = len(inside) * step**2 / length  # of a bent band too
    kind = BROAD_LIKE if share > BROAD_SHARE else POINT_LIKE
    line = bool(np.min(points[-1]) == 0.0)  # of a grid with one sigma_N or one c
    if not line and length >= RIDGE_STEPS and length >= RIDGE_RATIO * width:
        kind = RIDGE_LIKE
    return Shape(length, width, share, kind)
