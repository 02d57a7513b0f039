"""The smooth fit of a sample's answers: one right place in the grid, and how fast it falls off.

Unfolding (Coombs 1964): every observer judges how far a setting lies from an ideal one. The plane
of sigma_N and log c is stretched, sheared and bent by what the answers show. The distance in it is
signed: either side of the ideal has a slope of its own along both axes, as too glossy may be worse
than too dull (two slopes about a reference point: Kahneman and Tversky 1979). Its power, below one,
lets far settings differ less than near ones (Stevens 1957: a power law of magnitudes). Categories
are cut from it by the ordinal probit model (Aitchison and Silvey 1957). Both differences add up by
Minkowski's exponent: 2 is Euclid's, 1 the city block (Attneave 1950), a large one the larger alone.

Priors draw the additional shapes towards the symmetric, straight, Euclidean one. All shapes are
fitted anew to each resampling of the observers, so that intervals contain the choice between them.

The ideal place lies between grid points; what is always "far" takes no part in finding it. It may
lie a step beyond the grid, so that one on the edge can be missed to either side; what is reported
is the nearest place of the grid.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.experiment.design.coordinates import coordinates
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.scaling.bounded_minima import minima_within
from relgloss_view.experiment.session.posterior import LAPSE

#: Square of the distance that is judged at the ideal place: personal truths differ by about half
#: of the noise, so that the tip of the mean judgment is round.
ROUND = 0.25
#: Priors, weak against one observer's answers: logs of the slopes along both axes, shear, the first
#: bound, logs of the widths of categories. Means and standard deviations.
SLOPES, SLOPE_SD, SHEAR_SD = (-0.3, 0.0), 1.5, 1.5
FIRST_BOUND, FIRST_BOUND_SD, WIDTH_SD = 1.0, 3.0, 1.5
#: Of the shapes, about 0. A bend is the log of the ratio of an axis's scales at both ends of the
#: grid: 1.8 makes a linear axis of a logarithmic one over a ratio of six. A skew is half the log
#: of the ratio of slopes above and below the ideal: 0.55 triples it. The power's log.
BEND_SD, SKEW_SD, POWER_SD, EXPONENT_SD = 1.0, 0.5, 0.3, 0.4
MOST_BEND, MOST_SKEW, POWERS, EXPONENTS = 4.0, 1.5, (-1.0, 0.7), (-0.6, 1.2)
BEYOND = 1.0  #: steps that the ideal may lie beyond the grid
STRAIGHT = 1e-4  #: a bend below has its series
SHAPES = 6  #: bends, skews, power: the last parameters
STEEP = 1.5  #: log of how much steeper
STARTS = 3  #: settings from which the search begins


@dataclass(frozen=True)
class Unfolding:
    """A fit; its parameters are those of UnfoldingLoss."""

    grid: Grid
    parameters: Array  #: (n,)
    loss: float

    def closeness(self, points: Array) -> Array:
        """Minus the judged distance at points (n, 2), in steps; (n,), units of the noise."""
        return closeness_at(self.grid, self.parameters, points)


def closeness_at(grid: Grid, parameters: Array, points: Array) -> Array:
    """Minus the distances at points (m, 2), in steps, of fits (..., n); (..., m)."""
    return np.asarray(-Distance(points, coordinates(grid)[-1]).at(parameters))


def fit_unfolding(grid: Grid, counts: Array) -> Unfolding:
    """The fit of counts (settings, categories) of a grid.

    The search begins at each of the settings that were judged closest, with usual and with steep
    slopes: from usual ones it may lose a lone setting among many that are far. The best end counts.
    """
    places = np.repeat(_closest(grid, counts), 2, axis=0)
    loss = UnfoldingLoss(grid, np.broadcast_to(counts, (len(places), *counts.shape)))
    first = loss.start(places)
    first[1::2, 2:4] += STEEP
    ends, values = minima_within(loss, first)
    best = int(np.argmin(values))
    return Unfolding(grid, ends[best], float(values[best]))


def unfolding_draws(grid: Grid, counts: Array, start: Unfolding) -> Array:
    """Parameters (B, n) of the fits of counts (B resamplings, settings, categories).

    The searches begin at the fit of the answers that were resampled.
    """
    first = np.tile(start.parameters, (len(counts), 1))
    return minima_within(UnfoldingLoss(grid, counts), first)[0]


def _closest(grid: Grid, counts: Array) -> Array:
    """Coordinates of the settings with the lowest mean category."""
    number = counts.sum(axis=1)
    mean = (counts @ np.arange(counts.shape[1])) / np.maximum(number, 1e-9)
    order = np.argsort(np.where(number > 0.0, mean, np.inf), kind="stable")
    return coordinates(grid)[order[: min(STARTS, int(np.sum(number > 0.0)))]]


class _FromOne:
    """The distance of fixed points from one ideal place, and its derivatives.

    Parameters (..., n): ideal x and y in steps, log slope along x and y, shear, ...; the last are
    bend of x and y, skew along x and y, log power, log of half the exponent. With x and y the bent
    differences from the ideal: u = slope x, v = slope y + shear x, each times exp(skew) above 0 and
    exp(-skew) below;
    distance = ((r + u^2)^(e / 2) + (r + v^2)^(e / 2))^(power / e), r = ROUND / 2, e the exponent;
    Euclidean with e = 2: (ROUND + u^2 + v^2)^(power / 2).
    """

    def __init__(self, points: Array, ends: Array) -> None:
        self._ends = np.where(ends > 0.0, ends, 1.0)
        self._from_middle = np.ascontiguousarray((points / self._ends).T - 0.5)  # (2, points)

    def at(self, p: Array) -> Array:
        """(..., points)."""
        ideal = p[..., :2] / self._ends - 0.5
        bend, skew = p[..., -6:-4], p[..., -4:-2, None]
        self._power, self._exponent = np.exp(p[..., -2, None]), 2.0 * np.exp(p[..., -1, None])
        self._slopes, self._shear = np.exp(p[..., 2:4, None]), p[..., 4, None]
        self._apart(ideal, bend)
        self._own = self._slopes[..., 1, :] * self._y  # of y alone
        u, v = self._slopes[..., 0, :] * self._x, self._own + self._shear * self._x
        self._side_u = np.exp(np.where(u > 0.0, skew[..., 0, :], -skew[..., 0, :]))
        self._side_v = np.exp(np.where(v > 0.0, skew[..., 1, :], -skew[..., 1, :]))
        self._u, self._v = u * self._side_u, v * self._side_v
        # By logarithms: with any exponent no power of a large number overflows.
        self._log_u = np.log(0.5 * ROUND + self._u * self._u)
        self._log_v = np.log(0.5 * ROUND + self._v * self._v)
        apart = np.exp(0.5 * self._exponent * (self._log_v - self._log_u))
        self._part_u = 1.0 / (1.0 + apart)  # of the sum of both powers
        self._log_sum = 0.5 * self._exponent * self._log_u - np.log(self._part_u)
        self._d = np.asarray(np.exp(self._power / self._exponent * self._log_sum))
        return self._d

    def _apart(self, ideal: Array, bend: Array) -> None:
        """Differences from the ideal on axes whose scale grows as exp(bend share)."""
        bent = np.where(np.abs(bend) < STRAIGHT, STRAIGHT, bend)
        at_ideal = np.exp(bent * ideal)
        at_points = np.exp(bent[..., None] * self._from_middle)
        apart = (at_points - at_ideal[..., None]) * (self._ends / bent)[..., None]
        self._ideal_turn = at_ideal
        grown = at_points * self._from_middle - (at_ideal * ideal)[..., None]
        self._by_bend = (grown * self._ends[:, None] - apart) / bent[..., None]
        self._x, self._y = apart[..., 0, :], apart[..., 1, :]

    def derivatives(self) -> Array:
        """Where `at` was asked last, (..., 11, points).

        By ideal, log slopes, shear, bends, skews, log power and log exponent.
        """
        part_v = 1.0 - self._part_u
        steep = self._power * self._d
        by_u = steep * self._part_u * self._u / (0.5 * ROUND + self._u * self._u)
        by_v = steep * part_v * self._v / (0.5 * ROUND + self._v * self._v)
        of_v = by_v * self._side_v  # by v before its side is counted
        by_x = self._slopes[..., 0, :] * by_u * self._side_u + self._shear * of_v
        by_y = self._slopes[..., 1, :] * of_v
        by_place = np.stack([by_x, by_y], axis=-2)
        rest = [
            by_u * self._u,
            of_v * self._own,
            of_v * self._x,
            by_x * self._by_bend[..., 0, :],
            by_y * self._by_bend[..., 1, :],
            by_u * np.abs(self._u),
            by_v * np.abs(self._v),
            steep / self._exponent * self._log_sum,
            steep
            * (
                0.5 * (self._part_u * self._log_u + part_v * self._log_v)
                - self._log_sum / self._exponent
            ),
        ]
        return np.concatenate(
            [-by_place * self._ideal_turn[..., None], np.stack(rest, axis=-2)], axis=-2
        )


class Distance:
    """The distance of fixed points from the ideal place, or from the nearer of two.

    Parameters (..., n) as in _FromOne; of two places, the second one follows at the end.
    """

    def __init__(self, points: Array, ends: Array, places: int = 1) -> None:
        self._each = [_FromOne(points, ends) for _ in range(places)]

    def at(self, p: Array) -> Array:
        """(..., points)."""
        if len(self._each) == 1:
            return self._each[0].at(p)
        first, second = p[..., :-2], np.concatenate([p[..., -2:], p[..., 2:-2]], axis=-1)
        distances = [one.at(q) for one, q in zip(self._each, (first, second), strict=True)]
        self._nearer = distances[0] <= distances[1]
        return np.minimum(*distances)

    def derivatives(self) -> Array:
        """Where `at` was asked last: (..., 11, points), of two places (..., 13, points).

        By ideal, log slopes, shear, bends, skews, log power, log exponent, and second ideal.
        """
        first = self._each[0].derivatives()
        if len(self._each) == 1:
            return first
        nearer = self._nearer[..., None, :]
        second = self._each[1].derivatives()
        shared = np.where(nearer, first[..., 2:, :], second[..., 2:, :])
        own = np.where(nearer, first[..., :2, :], 0.0)
        return np.concatenate([own, shared, np.where(nearer, 0.0, second[..., :2, :])], axis=-2)


class UnfoldingLoss:
    """Minus the log-likelihood of counts and minus the log of the priors, with its derivatives.

    Counts (..., settings, categories) are those of one fit or of many. Parameters (..., n) are
    those of Distance, and between shear and the shapes the first bound and the logs of the widths
    of the categories after it. With two `places` a setting is judged from the nearer one.
    """

    def __init__(self, grid: Grid, counts: Array, places: int = 1) -> None:
        settings = coordinates(grid)
        more = 2 * (places - 1)
        self._shapes = SHAPES + more
        judged = np.any(counts > 0.0, axis=(*range(counts.ndim - 2), -1))
        self._counts = np.ascontiguousarray(counts[..., judged, :].swapaxes(-1, -2))
        self._distance = Distance(settings[judged], settings[-1], places)
        self._judged = judged
        widths = counts.shape[-1] - 2
        ideal = [(-BEYOND, float(end) + BEYOND) if end else (0.0, 0.0) for end in settings[-1]]
        self.limits = [
            *ideal,
            (-4.0, 4.0), (-4.0, 4.0), (-8.0, 8.0), (-5.0, 10.0),
            *[(-4.0, 3.0)] * widths,
            *[(-MOST_BEND, MOST_BEND)] * 2, *[(-MOST_SKEW, MOST_SKEW)] * 2, POWERS, EXPONENTS,
            *ideal[:more],
        ]  # fmt: skip
        of_shapes = [BEND_SD, BEND_SD, SKEW_SD, SKEW_SD, POWER_SD, EXPONENT_SD]
        self._mean = np.array(
            [0.0, 0.0, *SLOPES, 0.0, FIRST_BOUND, *[0.0] * (widths + self._shapes)]
        )
        sd = [SLOPE_SD, SLOPE_SD, SHEAR_SD, FIRST_BOUND_SD, *[WIDTH_SD] * widths, *of_shapes]
        self._precision = np.array([0.0, 0.0, *(s**-2 for s in sd), *[0.0] * more])

    def start(self, place: Array) -> Array:
        """Parameters at the priors' means with the ideal at places (..., 2)."""
        first = np.tile(self._mean, (*place.shape[:-1], 1))
        first[..., :2] = place
        return first

    def of(self, rows: Mask) -> UnfoldingLoss:
        """That of some of many fits."""
        chosen = copy.copy(self)
        chosen._counts = self._counts[rows]
        return chosen

    def __call__(self, p: Array) -> tuple[Array, Array]:
        """Values (...,) and gradients (..., n)."""
        share, density, by_bound = self._shares(p)
        return self._slope(p, share, density, by_bound, self._distance.derivatives())

    def shares(self, p: Array) -> Array:
        """Probabilities of categories, (settings, categories) of one fit; 1 where nobody judged."""
        every = np.ones((len(self._judged), self._counts.shape[-2]))
        every[self._judged] = self._shares(p)[0].T
        return every

    def scoring(self, p: Array) -> tuple[Array, Array, Array]:
        """Values, gradients, and the expected second derivatives (..., n, n) (Fisher 1925)."""
        share, density, by_bound = self._shares(p)
        by_distance = self._distance.derivatives()
        value, gradient = self._slope(p, share, density, by_bound, by_distance)
        # Of the share of a category by its two bounds: +density at the upper, -density at the
        # lower one; the expected curvature is the sum of their products over the share.
        weight = self._counts.sum(axis=-2, keepdims=True) / share
        own = density**2 * (weight[..., :-1, :] + weight[..., 1:, :])
        beside = -density[..., :-1, :] * density[..., 1:, :] * weight[..., 1:-1, :]
        rows = own.copy()
        rows[..., :-1, :] += beside
        rows[..., 1:, :] += beside
        k = np.arange(own.shape[-2])
        of_bounds = np.zeros((*own.shape[:-2], len(k), len(k)))
        of_bounds[..., k, k] = own.sum(axis=-1)
        of_bounds[..., k[:-1], k[1:]] = of_bounds[..., k[1:], k[:-1]] = beside.sum(axis=-1)
        across = -by_bound.swapaxes(-1, -2) @ rows @ by_distance.swapaxes(-1, -2)
        corner = (by_distance * rows.sum(axis=-2, keepdims=True)) @ by_distance.swapaxes(-1, -2)
        places = np.concatenate([across.swapaxes(-1, -2), corner], axis=-1)
        bounds = np.concatenate([by_bound.swapaxes(-1, -2) @ of_bounds @ by_bound, across], axis=-1)
        information = np.concatenate([bounds, places], axis=-2)
        size = information.shape[-1]
        shapes = size - self._shapes
        order = np.r_[shapes - 5 : shapes, : shapes - 5, shapes:size]
        information = information[..., order[:, None], order]
        return value, gradient, information + np.diag(self._precision)

    def _shares(self, p: Array) -> tuple[Array, Array, Array]:
        """Probabilities of categories (..., K, settings), and what follows from bounds.

        That is: their densities at bounds (..., K-1, settings), and the derivatives of bounds by
        their parameters (..., K-1, K-1).
        """
        from scipy.special import ndtr

        widths = np.exp(p[..., 6 : -self._shapes])
        number = widths.shape[-1] + 1
        by_bound = np.ones((*p.shape[:-1], number, number))
        by_bound[..., 1:] = np.tri(number, number - 1, -1) * widths[..., None, :]
        bounds = p[..., 5, None] + by_bound[..., 1:].sum(axis=-1)
        z = bounds[..., None] - self._distance.at(p)[..., None, :]
        below = ndtr(z)
        share = np.empty((*z.shape[:-2], number + 1, z.shape[-1]))
        share[..., 0, :], share[..., -1, :] = below[..., 0, :], 1.0 - below[..., -1, :]
        np.subtract(below[..., 1:, :], below[..., :-1, :], out=share[..., 1:-1, :])
        share *= 1.0 - LAPSE
        share += LAPSE / (number + 1)
        density = np.exp(-0.5 * z * z)
        density *= (1.0 - LAPSE) / np.sqrt(2.0 * np.pi)
        return share, density, by_bound

    def _slope(
        self, p: Array, share: Array, density: Array, by_bound: Array, by_distance: Array
    ) -> tuple[Array, Array]:
        off = p - self._mean
        pull = self._precision * off
        likelihood = np.sum(self._counts * np.log(share), axis=(-1, -2))
        by_share = self._counts / share
        by_z = (by_share[..., 1:, :] - by_share[..., :-1, :]) * density
        of_places = -(by_distance @ by_z.sum(axis=-2)[..., None])[..., 0]
        of_bounds = (by_z.sum(axis=-1)[..., None, :] @ by_bound)[..., 0, :]
        gradient = np.concatenate([of_places[..., :5], of_bounds, of_places[..., 5:]], axis=-1)
        return 0.5 * np.sum(pull * off, axis=-1) - likelihood, gradient + pull
