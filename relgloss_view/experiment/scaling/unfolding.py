"""The smooth fit of a sample's answers: one right place in the grid, and how fast it falls off.

Unfolding (Coombs 1964): every observer judges how far a setting lies from an ideal one. The
distance is Euclidean in the plane of sigma_N and log c, stretched, sheared and bent by what the
answers tell; categories are cut from it by the ordinal probit model (Aitchison and Silvey 1957).
The ideal place lies between grid points; what is always "far" takes no part in finding it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from relgloss_view.experiment.design.coordinates import coordinates
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.session.adaptive import LAPSE

Array = NDArray[np.float64]

#: Square of the distance that is judged at the ideal place: personal truths differ by about half
#: of the noise, so that the tip of the mean judgment is round.
ROUND = 0.25
#: Priors, weak against one observer's answers: logs of the slopes along both axes, shear, the first
#: bound, logs of the widths of categories, bends. Means and standard deviations.
SLOPES, SLOPE_SD, SHEAR_SD = (-0.3, 0.0), 1.5, 1.5
FIRST_BOUND, FIRST_BOUND_SD, WIDTH_SD, BEND_SD = 1.0, 3.0, 1.5, 0.4
MOST_BEND = 0.9  #: an axis stays ascending up to one
PRECISION = 1e-4  #: of the loss: a hundredth of what a standard error changes
CURVATURE_STEP = 1e-4
LEAST_CURVATURE = 0.3  #: that of the widest prior; what the answers leave open has no more
STARTS = 3  #: settings from which the search begins


@dataclass(frozen=True)
class Unfolding:
    """A fit; its parameters are those of _Loss."""

    grid: Grid
    parameters: Array
    loss: float
    #: (n, n), a basis of parameters in which the loss is about as steep everywhere: searches that
    #: start from this fit take a sixth of the steps in it.
    basis: Array

    def closeness(self, points: Array) -> Array:
        """Minus the judged distance at points (n, 2), in steps; (n,), units of the noise."""
        ends = coordinates(self.grid)[-1]
        return np.asarray(-_Distance(points, ends).at(self.parameters))


def fit_unfolding(grid: Grid, counts: Array, start: Unfolding | None = None) -> Unfolding:
    """The fit of counts (settings, categories) of a grid, from a former fit or from nothing.

    Without a start the search begins at the settings that were judged closest.
    """
    loss = _Loss(grid, counts)
    if start is not None:
        parameters, value = _search(loss, start.parameters, start.basis)
        return Unfolding(grid, parameters, value, start.basis)
    plain = np.eye(len(loss.limits))
    found = [_search(loss, loss.start(place), plain) for place in _closest(grid, counts)]
    parameters, value = min(found, key=lambda one: one[1])
    return Unfolding(grid, parameters, value, _basis(loss, parameters))


def _search(loss: _Loss, first: Array, basis: Array) -> tuple[Array, float]:
    """The parameters with the least loss, and that loss, in steps along a basis."""
    from scipy.optimize import minimize

    low, high = np.array(loss.limits).T

    def along(steps: Array) -> tuple[float, Array]:
        value, gradient = loss(first + basis @ steps)
        return value, gradient @ basis

    def room(steps: Array) -> Array:
        parameters = first + basis @ steps
        return np.concatenate([parameters - low, high - parameters])

    slopes = np.concatenate([basis, -basis])
    inside: Any = {"type": "ineq", "fun": room, "jac": lambda steps: slopes}
    found = minimize(
        along,
        np.zeros(len(first)),
        jac=True,
        method="SLSQP",
        constraints=inside,
        options={"ftol": PRECISION},
    )
    return np.clip(first + basis @ found.x, low, high), float(found.fun)


def _basis(loss: _Loss, at: Array) -> Array:
    """The directions of the loss's curvature at a place, as long as its standard errors."""
    steps = CURVATURE_STEP * np.eye(len(at))
    slopes = [(loss(at + step)[1] - loss(at - step)[1]) / (2.0 * CURVATURE_STEP) for step in steps]
    curvature = np.array(slopes)
    values, vectors = np.linalg.eigh(0.5 * (curvature + curvature.T))
    return np.asarray(vectors / np.sqrt(np.maximum(values, LEAST_CURVATURE)))


def _closest(grid: Grid, counts: Array) -> Array:
    """Coordinates of the settings with the lowest mean category."""
    number = counts.sum(axis=1)
    mean = (counts @ np.arange(counts.shape[1])) / np.maximum(number, 1e-9)
    order = np.argsort(np.where(number > 0.0, mean, np.inf), kind="stable")
    return coordinates(grid)[order[: min(STARTS, int(np.sum(number > 0.0)))]]


class _Distance:
    """The distance of fixed points from the ideal place, and its derivatives.

    Parameters: ideal x and y in steps, log slope along x and y, shear, ..., bend of x and y (last).
    """

    def __init__(self, points: Array, ends: Array) -> None:
        self._ends = np.where(ends > 0.0, ends, 1.0)
        self._share = np.ascontiguousarray((points / self._ends).T)  # (2, n)
        self._arch = self._share * (1.0 - self._share)

    def at(self, p: Array) -> Array:
        """(n,)."""
        ideal, bend = p[:2] / self._ends, p[-2:]
        (a, b), shear = np.exp(p[2:4]), p[4]
        self._slope, self._shear = (a, b), shear
        self._ideal_arch = ideal * (1.0 - ideal)
        self._ideal_turn = 1.0 + bend * (1.0 - 2.0 * ideal)
        apart = self._share + bend[:, None] * self._arch
        apart -= (ideal + bend * self._ideal_arch)[:, None]
        apart *= self._ends[:, None]
        self._apart = apart
        self._u = a * apart[0] + shear * apart[1]
        self._v = b * apart[1]
        self._d = np.asarray(np.sqrt(ROUND + self._u * self._u + self._v * self._v))
        return self._d

    def back(self, of_distance: Array, gradient: Array) -> None:
        """Put the gradient by these parameters in place, given that by the distances (n,)."""
        (a, b), (x, y) = self._slope, self._apart
        share = of_distance / self._d
        by_u, by_v = share * self._u, share * self._v
        by_x, by_y = a * by_u, self._shear * by_u + b * by_v
        total = np.array([by_x.sum(), by_y.sum()])
        gradient[:2] = -total * self._ideal_turn
        gradient[2:5] = by_x @ x, by_v @ self._v, by_u @ y
        bends = np.array([by_x @ self._arch[0], by_y @ self._arch[1]])
        gradient[-2:] = self._ends * (bends - total * self._ideal_arch)


class _Loss:
    """Minus the log-likelihood of counts and minus the log of the priors, with its gradient.

    Parameters: those of _Distance, and between shear and bends the first bound and the logs of the
    widths of the categories after it.
    """

    def __init__(self, grid: Grid, counts: Array) -> None:
        places = coordinates(grid)
        judged = np.any(counts > 0.0, axis=1)
        self._counts = np.ascontiguousarray(counts[judged].T)
        self._distance = _Distance(places[judged], places[-1])
        widths = counts.shape[1] - 2
        self.limits = [
            *((0.0, float(end)) for end in places[-1]),
            (-4.0, 4.0), (-4.0, 4.0), (-8.0, 8.0), (-5.0, 10.0),
            *[(-4.0, 3.0)] * widths,
            *[(-MOST_BEND, MOST_BEND)] * 2,
        ]  # fmt: skip
        self._mean = np.array([0.0, 0.0, *SLOPES, 0.0, FIRST_BOUND, *[0.0] * widths, 0.0, 0.0])
        sd = [SLOPE_SD, SLOPE_SD, SHEAR_SD, FIRST_BOUND_SD, *[WIDTH_SD] * widths, BEND_SD, BEND_SD]
        self._precision = np.array([0.0, 0.0, *(s**-2 for s in sd)])

    def start(self, place: Array) -> Array:
        """Parameters at the priors' means with the ideal at a place."""
        first = self._mean.copy()
        first[:2] = place
        return first

    def __call__(self, p: Array) -> tuple[float, Array]:
        """Value and gradient. Categories along the first axis, settings along the second."""
        from scipy.special import ndtr

        widths = np.exp(p[6:-2])
        bounds = p[5] + np.concatenate([[0.0], np.cumsum(widths)])
        z = bounds[:, None] - self._distance.at(p)
        below = ndtr(z)
        share = np.empty(self._counts.shape)
        share[0], share[-1] = below[0], 1.0 - below[-1]
        np.subtract(below[1:], below[:-1], out=share[1:-1])
        share *= 1.0 - LAPSE
        share += LAPSE / len(share)
        off = p - self._mean
        pull = self._precision * off
        value = 0.5 * (pull @ off) - np.vdot(self._counts, np.log(share))
        by_share = self._counts / share
        by_z = (by_share[1:] - by_share[:-1]) * np.exp(-0.5 * z * z)
        by_z *= (1.0 - LAPSE) / np.sqrt(2.0 * np.pi)
        gradient = np.empty(len(p))
        self._distance.back(-by_z.sum(axis=0), gradient)
        of_bounds = by_z.sum(axis=1)
        gradient[5] = of_bounds.sum()
        gradient[6:-2] = widths * np.cumsum(of_bounds[:0:-1])[::-1]
        return float(value), gradient + pull
