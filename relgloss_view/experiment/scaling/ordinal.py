"""Scale values by ordinal regression, maximum likelihood.

McCullagh, Regression models for ordinal data (1980); with the normal law Aitchison and Silvey, The
generalization of probit analysis to the case of multiple responses (1957). The log-likelihood is
concave (Pratt 1981; Burridge 1981), so the optimum that is found is the only one. Categories, signs
and unused categories as in successive.py.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array
from relgloss_view.experiment.scaling.successive_categories import (
    checked_counts,
    counted_bounds,
    spread_bounds,
    used_categories,
)

Link = Literal["probit", "logit"]

#: Standard deviation of a scale value before any answer, dispersions. At 15 answers a stimulus it
#: draws the scale in by one percent, and holds one that only ever got an end category 2.4 beyond
#: that category's bound, where the likelihood alone would send it to infinity.
PRIOR_SD = 3.5
RIDGE = PRIOR_SD**-2
#: Slope of the loss at which the search ends, for each 1000 answers: a well judged value is within
#: 1e-6 dispersions then. Where the loss's own rounding ends the search first, a slope NEAR_ENOUGH
#: times as large is convergence too.
SLOPE_TOLERANCE = 1e-5
NEAR_ENOUGH = 100.0
MOST_STEPS = 200
FIRST_RADIUS = 10.0  #: of the search, dispersions of all values together
LEAST_GAP = 1e-9  #: between bounds, within the search
#: Of a category within a tail: bounds in order keep 1e-10, and slopes at others can be squared.
LEAST_SHARE = 1e-30


@dataclass(frozen=True)
class CumulativeFit:
    """Category bounds and coefficients: P(category <= k) = F(bounds[k] - design @ coefficients)."""

    bounds: Array  #: (K-1,), never decreasing; NaN beyond the end categories in use
    coefficients: Array  #: (p,)
    log_likelihood: float  #: natural, sum over answers, without the ridge's part
    converged: bool


@dataclass(frozen=True)
class OrdinalScale:
    """Where stimuli, category bounds and observers lie, in units of the discriminal dispersion.

    P(category <= k) = Phi(bounds[k] + scale[j] - observers[o]).
    """

    scale: Array  #: (J,), closeness: larger is closer, mean 0
    bounds: Array  #: (K-1,), along distance, never decreasing; NaN beyond the end categories in use
    log_likelihood: float  #: natural, sum over answers, without the ridge's part
    observers: Array | None  #: (O,), how much farther each calls everything, mean 0
    converged: bool


def ordinal_scale(
    counts: ArrayLike,
    *,
    ridge: float = RIDGE,
    observer_effects: bool = False,
) -> OrdinalScale:
    """The most likely scale of counts (J stimuli, K categories) or (O observers, J, K), probit.

    Without `observer_effects` observers are pooled; with them each has a location of its own. The
    ridge is the inverse variance of a normal prior of mean 0 on each scale value and location
    (`PRIOR_SD`); it keeps finite a stimulus that always got the same end category, and places one
    without answers at 0. With a ridge of 0 such values only show where the search ended.
    InputError as `fit_cumulative`.
    """
    table = np.asarray(counts, dtype=np.float64)
    if table.ndim != 3 and (observer_effects or table.ndim != 2):
        raise ValueError(f"counts of shape {table.shape}: observers, stimuli and categories")
    table = checked_counts(table, table.ndim)
    stimuli, categories = table.shape[-2:]
    if observer_effects:
        observers = table.shape[0]
        design = np.hstack([
            np.tile(np.eye(stimuli), (observers, 1)),
            np.repeat(np.eye(observers), stimuli, axis=0),
        ])  # fmt: skip
    else:
        observers = 0
        table = table.sum(axis=0) if table.ndim == 3 else table
        design = np.eye(stimuli)
    fit = fit_cumulative(table.reshape(-1, categories), design, ridge=ridge)
    # The likelihood knows only differences; at the optimum the ridge has made both means 0, but
    # for what the search left.
    distances, locations = fit.coefficients[:stimuli], fit.coefficients[stimuli:]
    middle, bias = np.mean(distances), np.mean(locations) if observers else 0.0
    return OrdinalScale(
        scale=middle - distances,
        bounds=fit.bounds - middle - bias,
        log_likelihood=fit.log_likelihood,
        observers=locations - bias if observers else None,
        converged=fit.converged,
    )


def fit_cumulative(
    counts: ArrayLike,
    design: ArrayLike,
    *,
    ridge: ArrayLike = 0.0,
    link: Link = "probit",
) -> CumulativeFit:
    """Maximum likelihood of counts (cells, K) under a design (cells, p).

    F is the standard normal or the standard logistic distribution. `ridge`, one for all or (p,),
    adds ridge/2 coefficient^2 to the loss; without it a coefficient that separates the categories
    stops where the likelihood no longer tells, and a design that leaves a direction open stays
    where it began in that direction. Unused categories are merged with their neighbours. InputError
    where the counts are not counts or all lie in one category.
    """
    from scipy.optimize import minimize

    table = checked_counts(counts, 2)
    matrix = np.asarray(design, dtype=np.float64)
    if matrix.ndim != 2 or len(matrix) != len(table):
        raise ValueError(f"a design of shape {matrix.shape} for {len(table)} cells")
    size = matrix.shape[1]
    penalty = np.broadcast_to(np.asarray(ridge, dtype=np.float64), (size,))
    if not np.all(np.isfinite(matrix)) or not np.all(np.isfinite(penalty) & (penalty >= 0.0)):
        raise ValueError("a design and its ridge must be finite, and the ridge not negative")
    used = used_categories(table)
    answered = np.any(table > 0.0, axis=1)
    held = np.ascontiguousarray(table[np.ix_(answered, used)])
    loss = _Loss(held, matrix[answered], penalty, link)
    counted = counted_bounds(used)
    tolerance = SLOPE_TOLERANCE * max(1.0, float(held.sum()) / 1000.0)
    optimum = minimize(
        loss.value,
        _first(loss),
        method="trust-exact",
        jac=loss.gradient,
        hess=loss.hessian,
        options={
            "gtol": tolerance,
            "initial_trust_radius": FIRST_RADIUS,
            "maxiter": MOST_STEPS,
        },
    )
    limits = np.full(counted.shape, np.nan)
    limits[counted] = optimum.x[: loss.limits]
    return CumulativeFit(
        bounds=spread_bounds(limits, used),
        coefficients=np.asarray(optimum.x[loss.limits :]),
        log_likelihood=loss.log_likelihood(optimum.x),
        converged=bool(np.linalg.norm(optimum.jac) < NEAR_ENOUGH * tolerance),
    )


def _first(loss: _Loss) -> Array:
    """Where the search begins: bounds of the pooled counts, and coefficients of 0."""
    from scipy.special import ndtri

    share = np.cumsum(loss.counts.sum(axis=0))
    share = share[:-1] / share[-1]
    pooled = ndtri(share) if loss.link == "probit" else np.log(share / (1.0 - share))
    return np.concatenate([pooled, np.zeros(loss.design.shape[1])])


class CategoryShares:
    """Probabilities of categories cut at u (..., K-1), and how the loss of counts changes with u.

    Category k lies between u[k-1] and u[k]. The share of an inner category is a difference of two
    tails, taken on the side where both are small: nothing is lost to cancellation, however far out.
    """

    def __init__(self, u: Array, link: Link) -> None:
        left, right, log_density, self._turn = _law(u, link)
        upper = u[..., :-1] + u[..., 1:] > 0.0
        large = np.where(upper, right[..., :-1], left[..., 1:])
        small = np.where(upper, right[..., 1:], left[..., :-1])
        inner = large + np.log(np.maximum(-np.expm1(small - large), LEAST_SHARE))
        #: Natural logarithms of the probabilities, (..., K).
        self.log_p: Array = np.concatenate([left[..., :1], inner, right[..., -1:]], axis=-1)
        self._high = np.exp(log_density - self.log_p[..., :-1])  # f(u[k]) / P(category k)
        self._low = np.exp(log_density - self.log_p[..., 1:])  # f(u[k]) / P(category k+1)

    def slopes(self, counts: Array) -> Array:
        """First derivatives by u of minus the log-likelihood of counts (..., K); (..., K-1)."""
        return np.asarray(counts[..., 1:] * self._low - counts[..., :-1] * self._high)

    def curvatures(self, counts: Array) -> tuple[Array, Array]:
        """Second derivatives: by each u (..., K-1), and by each two neighbours (..., K-2)."""
        high, low, turn = self._high, self._low, self._turn
        own = counts[..., :-1] * high * (high - turn) + counts[..., 1:] * low * (low + turn)
        return own, -counts[..., 1:-1] * high[..., 1:] * low[..., :-1]


def row_sums(own: Array, beside: Array) -> Array:
    """Row sums of the tridiagonal matrices of `CategoryShares.curvatures`, (..., K-1)."""
    rows = own.copy()
    rows[..., :-1] += beside
    rows[..., 1:] += beside
    return rows


class _Loss:
    """Minus the log-likelihood plus the ridge's part, as a function of bounds and coefficients.

    The categories of a cell are cut at u[k] = bounds[k] - design @ coefficients.
    """

    def __init__(self, counts: Array, design: Array, ridge: Array, link: Link) -> None:
        self.counts, self.design, self.ridge, self.link = counts, design, ridge, link
        self.limits = counts.shape[1] - 1
        self._last: tuple[Array, CategoryShares] | None = None

    def value(self, x: Array) -> float:
        """The loss; infinite where bounds are out of order."""
        if np.any(np.diff(x[: self.limits]) < LEAST_GAP):
            return float("inf")
        b = x[self.limits :]
        return 0.5 * float(np.sum(self.ridge * b * b)) - self.log_likelihood(x)

    def log_likelihood(self, x: Array) -> float:
        """Without the ridge's part."""
        return float(np.sum(self.counts * self._shares(x).log_p))

    def gradient(self, x: Array) -> Array:
        """First derivatives, (limits + p,)."""
        slope = self._shares(x).slopes(self.counts)
        b = x[self.limits :]
        return np.concatenate(
            [slope.sum(axis=0), self.ridge * b - self.design.T @ slope.sum(axis=1)]
        )

    def hessian(self, x: Array) -> Array:
        """Second derivatives, (limits + p, limits + p). Within a cell they are tridiagonal."""
        own, beside = self._shares(x).curvatures(self.counts)
        rows = row_sums(own, beside)
        n, design = self.limits, self.design
        hessian = np.empty((n + design.shape[1],) * 2)
        hessian[:n, :n] = np.diag(own.sum(axis=0))
        k = np.arange(n - 1)
        hessian[k, k + 1] = hessian[k + 1, k] = beside.sum(axis=0)
        hessian[:n, n:] = -(rows.T @ design)
        hessian[n:, :n] = hessian[:n, n:].T
        hessian[n:, n:] = design.T @ (rows.sum(axis=1)[:, None] * design)
        hessian[n:, n:] += np.diag(self.ridge)
        return hessian

    def _shares(self, x: Array) -> CategoryShares:
        """The probabilities at x, which value and derivatives share."""
        if self._last is None or not np.array_equal(x, self._last[0]):
            u = x[: self.limits] - (self.design @ x[self.limits :])[:, None]
            self._last = x.copy(), CategoryShares(u, self.link)
        return self._last[1]


def _law(u: Array, link: Link) -> tuple[Array, Array, Array, Array]:
    """Of a law at u: log F, log(1 - F), log f, and f'/f, f the density."""
    from scipy.special import log_expit, log_ndtr

    if link == "probit":
        return log_ndtr(u), log_ndtr(-u), -0.5 * u * u - 0.5 * np.log(2.0 * np.pi), -u
    if link == "logit":
        left, right = log_expit(u), log_expit(-u)
        return left, right, left + right, -np.tanh(0.5 * u)
    raise ValueError(f"the link is 'probit' or 'logit', not {link!r}")
