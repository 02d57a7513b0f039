"""The search for the parameters of a surface whose picture is nearest to another one's.

What is made small is what a Loss reports: colour differences in the highlight of the paper's
picture, and gloss units. Differences enter squared twice, since a percentile near the largest one
is judged; each is in units of what a file may lose without a warning (loss.MOST_DE2000,
MOST_GLOSS_UNITS).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.exchange import judge
from relgloss_view.exchange.least_squares import least_squares
from relgloss_view.exchange.loss import LAMP, MOST_DE2000, MOST_GLOSS_UNITS, Loss, Surface
from relgloss_view.exchange.metered import COARSE, window_of
from relgloss_view.gloss.meter.geometry import SPECULAR
from relgloss_view.gloss.meter.meter import luminous_weights
from relgloss_view.material import brdf, cielab
from relgloss_view.material.material import Material
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.measure.bands import RGB

ROWS = 5  #: of the picture while searching
#: Ways are tried in turn until one costs this: the first are the plainest, which every program
#: draws alike.
ENOUGH = 0.5
#: A reading of a mirror is hundreds of units; this share of it counts as MOST_GLOSS_UNITS there.
GLOSS_SHARE = 0.03
GLOSS_WEIGHT = 1.2
#: Where a way loses more than may be lost without a warning, it is searched with this weight too:
#: no sum of GGX lobes shows a Gaussian, so the picture hardly gets worse, and gloss is kept better.
STRICT_GLOSS_WEIGHT = 6.0
STRICT_COST = 1.1  #: how many times the picture's loss may be as large for that
#: Azimuths of the lamp, degrees, and the weights of their pictures: the paper's, which is judged,
#: and lamps from the front and from behind, so that a surface holds where it is turned.
LAMPS = ((judge.AZIMUTH_DEG, 1.0), (10.0, 0.4), (110.0, 0.4))
BODY_WEIGHT = 0.3  #: of the diffuse part's Lab, everywhere


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
class Way:
    """A way to show a target that was tried: the nearest surface of a family, and its loss."""

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


def ways_to_show(target: Surface, families: tuple[Family, ...]) -> tuple[Way, ...]:
    """The nearest surface of each family that is tried, the one that loses least first.

    target: a Material or another surface. Families after one that loses next to nothing (ENOUGH)
    are left out.
    """
    aim, ways = _Aim(target), list[Way]()
    for family in families:
        ways.append(_tried(aim, family))
        if ways[-1].cost <= ENOUGH:
            break
    return tuple(sorted(ways, key=lambda way: way.cost))


class _View:
    """One picture that a surface is held against."""

    def __init__(self, own: judge.Seen, weight: float) -> None:
        self.picture = judge.picture_of(own)
        self._body = self._lab_of(own.diffuse)
        lightness, chroma = self.picture.lab[:, 0], np.hypot(*self.picture.lab[:, 1:].T)
        square = (lightness - 50.0) ** 2
        s_l = 1.0 + 0.015 * square / np.sqrt(20.0 + square)
        #: CIEDE2000's lengths of L*, and of a* and b* as if they were chroma
        self._scale = np.stack([s_l, *2 * [1.0 + 0.045 * chroma]], axis=-1) * MOST_DE2000
        count = max(int(np.sum(self.picture.highlight)), 1)
        self._weight = (weight * self.picture.highlight / np.sqrt(count))[:, None]
        self._body_weight = weight * BODY_WEIGHT / MOST_DE2000 / np.sqrt(len(lightness))

    def residuals(self, seen: judge.Seen) -> tuple[Array, Array]:
        """Of the highlight and of the diffuse part."""
        apart = (judge.scaled(self.picture, seen) - self.picture.lab) / self._scale
        size = np.sqrt(np.sum(apart * apart, axis=-1) + 1e-9)
        body = self._lab_of(seen.diffuse) - self._body
        return (apart * size[:, None] * self._weight).ravel(), self._body_weight * body.ravel()

    @staticmethod
    def _lab_of(xyz: Array) -> Array:
        return cielab.lab_from_xyz(xyz, illuminant(LAMP).white_xyz())


class _Aim:
    """What a surface is held against: pictures and gloss units, asked for at one go."""

    def __init__(self, target: Surface) -> None:
        self.target = target
        # Read as coarsely as the others are, so that the error of the quadrature cancels.
        seen, self._units = self._asked(target)
        self._scales = {
            key: max(MOST_GLOSS_UNITS, GLOSS_SHARE * units) for key, units in self._units.items()
        }
        self._views = [_View(own, weight) for own, (_, weight) in zip(seen, LAMPS, strict=True)]

    def residuals(self, surface: Surface, gloss_weight: float) -> Array:
        """What is squared and added up."""
        seen, units = self._asked(surface)
        parts = [
            part
            for view, shown in zip(self._views, seen, strict=True)
            for part in view.residuals(shown)
        ]
        off = [(units[key] - aim) / self._scales[key] for key, aim in self._units.items()]
        soft = np.arcsinh(off)  # a reading that cannot be reached does not drown the picture
        return np.concatenate([*parts, gloss_weight * soft / np.sqrt(len(off))])

    @staticmethod
    def _asked(surface: Surface) -> tuple[list[judge.Seen], dict[str, float]]:
        """What a surface shows in each picture, and its gloss units."""
        asked = _asked_points()
        if isinstance(surface, Material):
            diffuse, specular = surface.evaluate_facing(asked.facing)
            weights, luminous = surface.xyz_weights(illuminant(LAMP)), surface.bands
        else:
            diffuse, specular = surface.evaluate(asked.i, asked.o)
            weights, luminous = xyz_weights(RGB, illuminant(LAMP)), RGB
        seen = [
            judge.Seen(*(arriving[:, None] * (part[part_of] @ weights) for part in parts))
            for part_of, arriving in asked.pictures
            for parts in [(diffuse, specular)]
        ]
        of_light = luminous_weights(luminous)
        units = {
            key: float(100.0 * np.sum(weight * ((diffuse[part] + specular[part]) @ of_light)))
            for key, (part, weight) in asked.meters.items()
        }
        return seen, units


class _Asked(NamedTuple):
    """The directions of all pictures and meters, one after the other."""

    i: Array
    o: Array
    facing: brdf.Facing
    pictures: tuple[tuple[slice, Array], ...]  #: which of them, and what arrives there
    meters: dict[str, tuple[slice, Array]]  #: by key: which, and weights of gloss units


@lru_cache(maxsize=1)
def _asked_points() -> _Asked:
    parts = [judge.points_of(azimuth, rows=ROWS) for azimuth, _ in LAMPS]
    windows = {meter: window_of(meter, COARSE) for _, meter in sorted(SPECULAR.items())}
    pairs = [(p.i, p.o) for p in parts] + [(w.i, w.o) for w in windows.values()]
    i, o = (np.concatenate(ways) for ways in zip(*pairs, strict=True))
    normal = np.broadcast_to(np.array([0.0, 0.0, 1.0]), i.shape)
    ends = np.cumsum([0, *(len(to_lamp) for to_lamp, _ in pairs)])
    slices = [slice(first, last) for first, last in itertools.pairwise(ends.tolist())]
    return _Asked(
        i,
        o,
        brdf.facing(normal, i, o),
        tuple(zip(slices, (part.arriving for part in parts), strict=False)),
        {
            meter.key: (part, window.weight / meter.mirror_flux(meter.glass))
            for part, (meter, window) in zip(slices[len(parts) :], windows.items(), strict=True)
        },
    )


def _tried(aim: _Aim, family: Family) -> Way:
    tried, x = _searched(aim, family, GLOSS_WEIGHT, None)
    if tried.cost <= 1.0:
        return tried
    again = [_searched(aim, family, STRICT_GLOSS_WEIGHT, start)[0] for start in (x, None)]
    most = STRICT_COST * tried.loss.de2000_p95
    seen_alike = [one for one in again if one.loss.de2000_p95 <= most]
    return min((tried, *seen_alike), key=lambda one: one.cost)


def _searched(
    aim: _Aim, family: Family, gloss_weight: float, start: Array | None
) -> tuple[Way, Array]:
    """The nearest surface with a weight of gloss, and its unknowns.

    start: None for the family's own.
    """
    own, low, high = np.array(family.unknowns).T
    x = least_squares(
        lambda x: aim.residuals(family.make(x), gloss_weight),
        own if start is None else start,
        low,
        high,
    )
    surface = family.make(x)
    return Way(family.name, surface, judge.compare(aim.target, surface)), x
