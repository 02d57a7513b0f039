"""Draws from what prior and readings leave open, by sequential Monte Carlo.

Del Moral, Doucet and Jasra 2006: surfaces of the prior are led to the posterior by raising the
likelihood to powers that grow from 0 to 1, each so far that half of the draws still count; then the
draws are resampled and moved. A move steps along the difference of two other draws (ter Braak
2006), so its size and direction follow the shape that is left, however narrow or bent.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.fitting.estimate import prior

COUNT = 1000  #: draws
KEPT = 0.5  #: effective share of the draws that a power leaves
MOVES, LAST_MOVES = 2, 8  #: of each draw at each power, and at the last
STEPS = (0.75, 0.35, 0.12)  #: of the difference of two draws; 0.75 is 2.38 / sqrt(2 x 5)
MOST_POWERS = 60  #: readings that contradict one another need the most, about 30
#: Added to each step, as a share of the prior's range, so that no direction is lost.
JITTER = 1e-4

LogLikelihood = Callable[[Array], Array]


class Draws(NamedTuple):
    """Draws of equal weight."""

    surfaces: Array  #: (N, 5)
    fit: Array  #: (N,), their log-likelihood
    log_evidence: float  #: of the readings, as the log-likelihood is normalised


def posterior(
    log_likelihood: LogLikelihood, random: np.random.Generator, count: int = COUNT
) -> Draws:
    """Surfaces of the prior weighted by a likelihood."""
    surfaces = prior.draws(count, random)
    fit = log_likelihood(surfaces)
    density = prior.log_density(surfaces)
    power = evidence = 0.0
    for k in range(MOST_POWERS):
        step = 1.0 - power if k == MOST_POWERS - 1 else _next_step(fit, 1.0 - power)
        power += step
        weight = np.exp(step * (fit - fit.max()))
        evidence += float(np.log(np.mean(weight)) + step * fit.max())
        chosen = _resampled(weight, random)
        surfaces, fit, density = surfaces[chosen], fit[chosen], density[chosen]
        last = power >= 1.0 - 1e-12
        for _ in range(LAST_MOVES if last else MOVES):
            surfaces, fit, density = _moved(surfaces, fit, density, power, log_likelihood, random)
        if last:
            break
    return Draws(surfaces, fit, evidence)


def _next_step(fit: Array, most: float) -> float:
    """The growth of the power that leaves KEPT of the draws effective, by bisection."""

    def effective(step: float) -> float:
        weight = np.exp(step * (fit - fit.max()))
        return float(weight.sum() ** 2 / (weight @ weight))

    wanted = KEPT * len(fit)
    if effective(most) >= wanted:
        return most
    low, high = 0.0, most
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if effective(middle) >= wanted else (low, middle)
        if high - low < 1e-3 * high:
            break
    return high


def _resampled(weight: Array, random: np.random.Generator) -> Array:
    """Systematic resampling: indices (N,) of draws, each as often as its weight asks for."""
    places = (np.arange(len(weight)) + random.random()) / len(weight)
    cumulative = np.cumsum(weight) / np.sum(weight)
    return np.minimum(np.searchsorted(cumulative, places), len(weight) - 1)


def _moved(
    surfaces: Array,
    fit: Array,
    density: Array,
    power: float,
    log_likelihood: LogLikelihood,
    random: np.random.Generator,
) -> tuple[Array, Array, Array]:
    """One Metropolis step of every draw."""
    count = len(surfaces)
    shift = random.integers(1, count, size=2)
    others = random.permutation(count)
    difference = surfaces[np.roll(others, shift[0])] - surfaces[np.roll(others, shift[1])]
    size = random.choice(np.asarray(STEPS), size=(count, 1))
    jitter = JITTER * (prior.UPPER - prior.LOWER) * random.standard_normal(surfaces.shape)
    proposed = _folded(surfaces + size * difference + jitter)
    new_density = prior.log_density(proposed)
    new_fit = log_likelihood(proposed)
    gain = power * (new_fit - fit) + new_density - density
    taken = np.log(np.maximum(random.random(count), 1e-300)) < gain
    return (
        np.where(taken[:, None], proposed, surfaces),
        np.where(taken, new_fit, fit),
        np.where(taken, new_density, density),
    )


def _folded(surfaces: Array) -> Array:
    """Unknowns mirrored at the ends of the prior's range, which keeps a step as likely back."""
    width = prior.UPPER - prior.LOWER
    place = np.mod((surfaces - prior.LOWER) / width, 2.0)
    return np.asarray(prior.LOWER + width * np.where(place > 1.0, 2.0 - place, place))
