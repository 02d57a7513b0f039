"""One rung on one set of observations: its loss, its linear unknowns, its normal equations.

The loss is soft-L1 in the logarithmic residual r = log((m + e) / (f + e)), which is relative error
with the floor e: sum_nb w_nb rho(r). Its stationary points over the linear unknowns are those of a
least-squares problem with the weights w (rho'(r)/r) / (Lambda(m+e, f+e) (m+e)), Lambda being the
logarithmic mean, because r = (m - f) / Lambda; so the inner problem is solved by reweighting.

Several problems of one rung are solved side by side: starts of a search share the observations,
folds of a cross-validation differ in their weights only. Their arrays have a leading axis P, and
the samples are on the last axis, N.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.fitting import linear
from relgloss_view.fitting.instrument import PINNED
from relgloss_view.fitting.mixed import nnls_mixed
from relgloss_view.fitting.model import (
    SOFT_L1,
    Rung,
    States,
    error_size,
    influence,
    robust,
)
from relgloss_view.fitting.observations import TAU, Observations
from relgloss_view.fitting.shapes import (
    diffuse_columns,
    displaced,
    error_slopes,
    facet_columns,
    index_slope,
    metal_columns,
)
from relgloss_view.fitting.unknowns import shared_unknowns
from relgloss_view.material import brdf

SAMPLES_AT_ONCE = 1 << 15  #: of which products are summed


class Equations(NamedTuple):
    """Gauss-Newton matrix and gradient: K unknowns of each band, S unknowns that bands share."""

    own: Array  #: (P, B, K, K)
    cross: Array  #: (P, B, K, S)
    shared: Array  #: (P, S, S)
    own_gradient: Array  #: (P, B, K)
    shared_gradient: Array  #: (P, S)


class Misfit(NamedTuple):
    """How far models are from the observations, and their losses."""

    above: Array  #: (P, B, N), model plus floor
    residual: Array  #: (P, B, N), logarithm of model over measured
    loss: Array  #: (P,)


@dataclass(frozen=True)
class Prior:
    """Gaussian priors of the instrument's K errors."""

    centre: Array  #: (P, K) or (1, K)
    sd: Array  #: the same
    weight: float  #: of half a squared standard deviation, Observations.sample_weight


def _prior(observations: Observations, rung: Rung) -> Prior | None:
    if not rung.errors:
        return None
    sd = observations.prior_sd
    centre = observations.prior_centre if observations.prior_centre.size else np.zeros(len(sd))
    return Prior(centre[None], sd[None], observations.sample_weight)


def _weighted_gram(columns: Array, weight: Array) -> Array:
    """(P, B, C, C), products of columns (P, C, N) with one another, weighted by (P or 1, B, N).

    One problem after another: the weighted columns of all of them would fill the memory.
    """
    problems, count, samples = columns.shape
    bands = weight.shape[1]
    gram = np.empty((problems, bands * count, count))
    weight = np.broadcast_to(weight, (problems, *weight.shape[1:]))
    for p in range(problems):
        for first in range(0, samples, SAMPLES_AT_ONCE):
            some = slice(first, first + SAMPLES_AT_ONCE)
            part = columns[p, :, some]
            weighted = (weight[p, :, None, some] * part).reshape(bands * count, -1)
            gram[p] = weighted @ part.T if first == 0 else gram[p] + weighted @ part.T
    return gram.reshape(problems, bands, count, count)


class Problem:
    """One rung on one set of observations, with one weight for all P problems or one for each.

    weight: (P, B, N) instead of the observations' own. alpha: shape of the loss (model.robust).
    """

    def __init__(
        self,
        observations: Observations,
        rung: Rung,
        alpha: float = SOFT_L1,
        weight: Array | None = None,
    ) -> None:
        self.rung, self.alpha, self.bands = rung, alpha, observations.bands
        self.unknowns = shared_unknowns(rung)
        self.geometry = observations.geometry
        self._value = np.ascontiguousarray(observations.value.T)
        self._floor = np.ascontiguousarray(observations.floor.T)
        self._seen = self._value + self._floor
        self._per_seen = 1.0 / self._seen
        self._weight = observations.weight.T[None].copy() if weight is None else weight
        self._total = np.sum(self._weight, axis=(1, 2))
        self._prior = _prior(observations, rung)
        self._reflectance: dict[float, Array] = {}

    def columns_of(self, states: States) -> Array:
        """The columns at P states."""
        errors = states.errors if self.rung.errors else None
        return self.columns(states.t, states.log_s, states.n, errors)

    def columns(self, t: Array, log_s: Array, n: Array, errors: Array | None = None) -> Array:
        """(P, C, N): columns of D1, D2 and the lobes, then their derivatives (see shapes)."""
        lobes, count = self.rung.lobes, 2 + self.rung.strengths
        freed = lobes if self.rung.free_index else 0
        wrong = lobes * self.rung.errors
        columns = np.empty((len(t), 2 * count + freed + wrong, len(self.geometry.along)))
        g = self.geometry if errors is None else displaced(self.geometry, errors)
        columns[:, 0], columns[:, 1], columns[:, count], columns[:, count + 1] = diffuse_columns(
            self.geometry, t
        )
        for j in range(self.rung.metals):
            facing, grazing, slope = metal_columns(g, log_s[:, j])
            for k, part in ((2 + j, facing), (2 + lobes + j, grazing)):
                columns[:, k], columns[:, count + k] = part, part * slope
        for j in range(self.rung.metals, lobes):
            facets, slope = facet_columns(g, log_s[:, j])
            if errors is None:
                lobe = facets * self._fresnel(n[:, j])
            else:
                lobe = facets * brdf.fresnel_dielectric(g.facing.cos_d, n[:, j, None])
            columns[:, 2 + j], columns[:, count + 2 + j] = lobe, lobe * slope
            if freed:
                columns[:, 2 * count + j] = lobe * index_slope(g, n[:, j])
            if errors is not None:
                place = 2 * count + freed + j * self.rung.errors
                slopes = error_slopes(self.geometry, errors, log_s[:, j], n[:, j])
                columns[:, place : place + self.rung.errors] = lobe[:, None] * slopes
        return columns

    def _fresnel(self, n: Array) -> Array:
        """(P, N) or, where all indices are one held value, (N,)."""
        first = float(n[0])
        if self.rung.free_index or np.any(n != first):
            return brdf.fresnel_dielectric(self.geometry.facing.cos_d, n[:, None])
        if first not in self._reflectance:
            self._reflectance[first] = brdf.fresnel_dielectric(self.geometry.facing.cos_d, first)
        return self._reflectance[first]

    def model(self, columns: Array, kd: Array, ks: Array) -> Array:
        """Radiance factors (P, B, N) from columns and linear unknowns (P, B), (P, J, B)."""
        linear_unknowns = np.concatenate([kd[:, None], (kd * kd)[:, None], ks], axis=1)
        return np.asarray(np.swapaxes(linear_unknowns, 1, 2) @ columns[:, : 2 + ks.shape[1]])

    def misfit(self, model: Array) -> Misfit:
        """Residuals and weighted mean losses of models (P, B, N)."""
        above = model + self._floor
        residual = np.log(above * self._per_seen)
        return Misfit(above, residual, self._mean(robust(residual, self.alpha)))

    def mean_errors(self, model: Array) -> Array:
        """(P,), weighted means of model.error_size."""
        return self._mean(error_size(np.log((model + self._floor) * self._per_seen)))

    def _mean(self, size: Array) -> Array:
        return np.asarray(np.sum(self._weight * size, axis=(1, 2)) / self._total)

    def part(self, rows: Mask) -> Problem:
        """The problems marked in `rows`."""
        part = copy.copy(self)
        if len(self._weight) > 1:
            part._weight, part._total = self._weight[rows], self._total[rows]
        if part._prior is not None and len(part._prior.centre) > 1:
            prior = part._prior
            part._prior = replace(prior, centre=prior.centre[rows], sd=prior.sd[rows])
        return part

    @property
    def samples(self) -> int:
        """N."""
        return int(self._value.shape[1])

    @property
    def prior(self) -> Prior:
        """Of the instrument's errors, which the rung frees."""
        if self._prior is None:
            raise ValueError("the rung holds the instrument's errors")
        return self._prior

    def pinned(self, errors: Array) -> Problem:
        """P problems that hold all errors of the instrument at values (P, K)."""
        pinned = copy.copy(self)
        sd = np.repeat(self.prior.sd * PINNED, len(errors), axis=0)
        pinned._prior = replace(self.prior, centre=errors, sd=sd)
        return pinned

    # --- inside: the linear unknowns ------------------------------------------------------------

    def inner(self, columns: Array, kd: Array, ks: Array, rounds: int) -> tuple[Array, Array]:
        """Reweighted NNLS from the linear unknowns (P, B) and (P, J, B)."""
        values = columns[:, : 2 + self.rung.strengths]
        for _ in range(rounds):
            checkpoint()
            weight = self._inner_weight(self.model(columns, kd, ks))
            kd, ks = self._linear(values, weight, kd)
        return kd, ks

    def first_guess(self, columns: Array, rounds: int) -> tuple[Array, Array]:
        """The linear unknowns from scratch: relative weights first, then reweighting."""
        values = columns[:, : 2 + self.rung.strengths]
        weight = self._weight * (self._per_seen * self._per_seen)
        kd, ks = self._linear(values, weight, np.zeros((len(columns), self.bands)))
        return self.inner(columns, kd, ks, rounds)

    def _inner_weight(self, model: Array) -> Array:
        above = model + self._floor
        residual = np.log(above * self._per_seen)
        near = np.abs(residual) < 1e-6
        if np.any(near):
            mean = np.where(near, above, (above - self._seen) / np.where(near, 1.0, residual))
        else:
            mean = (above - self._seen) / residual
        return np.asarray(self._weight * influence(residual, self.alpha) / (mean * above))

    def _linear(self, values: Array, weight: Array, kd: Array) -> tuple[Array, Array]:
        """Weighted NNLS with the rho^2 term linearised about the running albedo."""
        problems, used, _ = values.shape
        bands, lobes = self.bands, used - 2
        transposed = np.swapaxes(values, 1, 2)
        gram = _weighted_gram(values, weight)
        aim = (weight * self._value) @ transposed + (kd * kd)[..., None] * gram[:, :, 1]
        twice = 2.0 * kd
        a = np.empty((problems, bands, 1 + lobes, 1 + lobes))
        r = np.empty((problems, bands, 1 + lobes))
        first = gram[:, :, 0] + twice[..., None] * gram[:, :, 1]
        a[:, :, 0, 0] = first[:, :, 0] + twice * first[:, :, 1]
        a[:, :, 0, 1:] = a[:, :, 1:, 0] = first[:, :, 2:]
        a[:, :, 1:, 1:] = gram[:, :, 2:, 2:]
        r[:, :, 0] = aim[:, :, 0] + twice * aim[:, :, 1]
        r[:, :, 1:] = aim[:, :, 2:]
        if lobes == 0 or self.rung.spectral:
            x = linear.nnls_blocks(a.reshape(-1, 1 + lobes, 1 + lobes), r.reshape(-1, 1 + lobes))
            x = x.reshape(problems, bands, 1 + lobes)
            return x[:, :, 0], np.swapaxes(x[:, :, 1:], 1, 2)
        if self.rung.own:
            own = 1 + self.rung.own
            x, y = nnls_mixed(
                a[:, :, :own, :own],
                a[:, :, :own, own:],
                np.sum(a[:, :, own:, own:], axis=1),
                r[:, :, :own],
                np.sum(r[:, :, own:], axis=1),
            )
            shared = np.repeat(y[:, :, None], bands, axis=2)
            return x[:, :, 0], np.concatenate([np.swapaxes(x[:, :, 1:], 1, 2), shared], axis=1)
        x0, y = linear.nnls_arrow(
            a[:, :, 0, 0],
            a[:, :, 0, 1:],
            np.sum(a[:, :, 1:, 1:], axis=1),
            r[:, :, 0],
            np.sum(r[:, :, 1:], axis=1),
        )
        return x0, np.repeat(y[:, :, None], bands, axis=2)

    # --- outside: Gauss-Newton on everything, the linear unknowns eliminated ---------------------

    def _jacobian_maps(self, states: States) -> tuple[Array, Array]:
        """How columns combine into derivatives: own (P, B, C, K) and shared (P, B, C, S)."""
        rung, lobes, unknowns = self.rung, self.rung.lobes, self.unknowns
        slope = 2 + rung.strengths
        freed = 2 * slope + (lobes if rung.free_index else 0)
        count = freed + lobes * rung.errors
        own_lobes = rung.own
        own = np.zeros((len(states), self.bands, count, 1 + own_lobes))
        shared = np.zeros((len(states), self.bands, count, unknowns.count))
        own[:, :, 0, 0], own[:, :, 1, 0] = 1.0, 2.0 * states.kd
        for j in range(own_lobes):
            own[:, :, 2 + j, 1 + j] = 1.0
        if rung.rough:
            shared[:, :, slope, unknowns.t.start] = states.kd
            shared[:, :, slope + 1, unknowns.t.start] = states.kd**2
        for j in range(lobes):
            shared[:, :, slope + 2 + j, unknowns.log_s.start + j] = states.ks[:, j]
            if rung.free_index:
                shared[:, :, 2 * slope + j, unknowns.n.start] = states.ks[:, j]
            for k in range(rung.errors):
                place = freed + j * rung.errors + k
                shared[:, :, place, unknowns.errors.start + k] = states.ks[:, j]
        for j in range(rung.metals):
            white = lobes + j
            shared[:, :, slope + 2 + white, unknowns.log_s.start + j] = states.ks[:, white]
        for j in range(own_lobes, rung.strengths):
            shared[:, :, 2 + j, unknowns.ks.start + j - own_lobes] = 1.0
        return own, shared

    def equations(self, columns: Array, misfit: Misfit, states: States) -> Equations:
        """The normal equations of a Gauss-Newton step at `states`."""
        slope = self._weight * influence(misfit.residual, self.alpha) / misfit.above
        transposed = np.swapaxes(columns, 1, 2)
        gram = _weighted_gram(columns, slope / misfit.above)
        gradient = ((slope * misfit.residual) @ transposed)[..., None, :]
        own, shared = self._jacobian_maps(states)
        gram_own = gram @ own
        curvature = np.sum(np.swapaxes(shared, 2, 3) @ (gram @ shared), axis=1)
        pull = np.sum((gradient @ shared)[..., 0, :], axis=1)
        if self._prior is not None:
            errors = self.unknowns.errors
            size = self._total[:, None] * (self._prior.weight * TAU**2 / self._prior.sd**2)
            pull[:, errors] += size * (states.errors - self._prior.centre)
            diagonal = np.einsum("pss->ps", curvature)  # a view that can be written to
            diagonal[:, errors] += size
        return Equations(
            np.swapaxes(own, 2, 3) @ gram_own,
            np.swapaxes(gram_own, 2, 3) @ shared,
            curvature,
            (gradient @ own)[..., 0, :],
            pull,
        )

    def reweighted(self, columns: Array, states: States) -> tuple[States, Misfit]:
        """The states after one reweighting of their linear unknowns, and their misfit."""
        kd, ks = self.inner(columns, states.kd, states.ks, 1)
        states = replace(states, kd=kd, ks=ks)
        misfit = self.misfit(self.model(columns, kd, ks))
        if self._prior is not None:
            away = (states.errors - self._prior.centre) / self._prior.sd
            loss = misfit.loss + 0.5 * self._prior.weight * np.sum(away**2, axis=1)
            misfit = misfit._replace(loss=loss)
        return states, misfit
