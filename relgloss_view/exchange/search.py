"""The search for the parameters of a surface whose picture is nearest to another one's.

What is made small is what a Loss reports: colour differences in the highlight of the paper's
picture, and gloss units. Differences enter squared twice, since a percentile near the largest one
is judged; each is in units of what a file may lose without a warning (loss.MOST_DE2000,
MOST_GLOSS_UNITS). The method is that of Levenberg and Marquardt within bounds (scipy).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.exchange import judge
from relgloss_view.exchange.loss import MOST_DE2000, MOST_GLOSS_UNITS, Loss, Surface
from relgloss_view.exchange.metered import COARSE, gloss_units, reading
from relgloss_view.gloss.meter.geometry import SPECULAR
from relgloss_view.material import cielab

MOST_CALLS = 40  #: of a step of the search, each with one slope a parameter
ROWS = 5  #: of the picture while searching
#: Ways are tried in turn until one costs this: the first are the plainest, which every program
#: draws alike.
ENOUGH = 0.5
STEP = 2e-4  #: of a parameter, for slopes: well above the rounding of gamut mapping
#: A reading of a mirror is hundreds of units; this share of it counts as MOST_GLOSS_UNITS there.
GLOSS_SHARE = 0.03
GLOSS_WEIGHT = 0.7
BODY_WEIGHT = 0.3  #: of the diffuse part beside the highlight, L* as above


class Unknown(NamedTuple):
    """A parameter that is searched for."""

    start: float
    low: float
    high: float


@dataclass(frozen=True)
class Family:
    """Surfaces of one model with some parameters open."""

    name: str  #: for people, such as 'specular and coat'
    unknowns: tuple[Unknown, ...]
    make: Callable[[Array], Surface]


@dataclass(frozen=True)
class Found:
    """The nearest surface of a family."""

    name: str
    surface: Surface
    loss: Loss

    @property
    def cost(self) -> float:
        """How many times what may be lost without a warning is lost; below 1 nothing is warned."""
        return cost_of(self.loss)


def cost_of(loss: Loss) -> float:
    """The larger of the picture's and the meters' loss, in units of what is small."""
    units = max(
        (abs(a - b) / max(MOST_GLOSS_UNITS, GLOSS_SHARE * a) for a, b in loss.gloss_units.values()),
        default=0.0,
    )
    return max(loss.de2000_p95 / MOST_DE2000, units)


def nearest(target: Surface, families: tuple[Family, ...]) -> tuple[Found, ...]:
    """The nearest surface of each family that was tried, the one that loses least first.

    target: a Material or another surface. Families after one that loses next to nothing (ENOUGH)
    are left out.
    """
    aim, found = _Aim(target), []
    for family in families:
        found.append(_nearest(aim, family))
        if found[-1].cost <= ENOUGH:
            break
    return tuple(sorted(found, key=lambda one: one.cost))


class _Aim:
    """What a surface is held against."""

    def __init__(self, target: Surface) -> None:
        self.target = target
        self.points = judge.points_of(judge.AZIMUTH_DEG, rows=ROWS)
        own = judge.seen(target, self.points)
        self.picture = judge.picture_of(own)
        lightness, chroma = self.picture.lab[:, 0], np.hypot(*self.picture.lab[:, 1:].T)
        square = (lightness - 50.0) ** 2
        s_l = 1.0 + 0.015 * square / np.sqrt(20.0 + square)
        #: CIEDE2000's lengths of L*, and of a* and b* as if they were chroma
        self._scale = np.stack([s_l, *2 * [1.0 + 0.045 * chroma]], axis=-1) * MOST_DE2000
        count = max(int(np.sum(self.picture.highlight)), 1)
        self._weight = (self.picture.highlight / np.sqrt(count))[:, None]
        self.units = gloss_units(target)

    def residuals(self, surface: Surface) -> Array:
        """What is squared and added up."""
        seen = judge.seen(surface, self.points)
        apart = (judge.scaled(self.picture, seen) - self.picture.lab) / self._scale
        size = np.sqrt(np.sum(apart * apart, axis=-1) + 1e-9)
        body = cielab.lightness(seen.diffuse[:, 1]) - self.picture.l_d
        units = [
            (reading(surface, meter, COARSE) - self.units[meter.key])
            / max(MOST_GLOSS_UNITS, GLOSS_SHARE * self.units[meter.key])
            for meter in SPECULAR.values()
        ]
        soft = np.arcsinh(units)  # a reading that cannot be reached does not drown the picture
        return np.concatenate(
            [
                (apart * size[:, None] * self._weight).ravel(),
                BODY_WEIGHT * body / MOST_DE2000 / np.sqrt(len(body)),
                GLOSS_WEIGHT * soft / np.sqrt(len(units)),
            ]
        )


def _nearest(aim: _Aim, family: Family) -> Found:
    from scipy.optimize import least_squares

    start, low, high = np.array(family.unknowns).T
    margin = 1e-6 * (high - low)

    def residuals(x: Array) -> Array:
        checkpoint()
        return aim.residuals(family.make(x))

    result = least_squares(
        residuals,
        np.clip(start, low + margin, high - margin),
        bounds=(low, high),
        x_scale=np.maximum(np.abs(start), 0.05),
        diff_step=np.full(len(start), STEP),
        max_nfev=MOST_CALLS,
        xtol=1e-4,
        ftol=1e-4,
    )
    surface = family.make(result.x)
    return Found(family.name, surface, judge.compare(aim.target, surface))
