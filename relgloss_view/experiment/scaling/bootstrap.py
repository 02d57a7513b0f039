"""Scale values of a sample by one question, and how sure they are over observers.

Uncertainty is that over observers: they are drawn again with replacement, whole sessions at a time
(Efron 1979), and every model is fitted anew to each resampling.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.experiment.scaling.fine_grid import FineGrid, Smooth
from relgloss_view.experiment.scaling.ordinal import OrdinalScale, ordinal_scale
from relgloss_view.experiment.scaling.ordinal_draws import ordinal_draws
from relgloss_view.experiment.scaling.successive_categories import (
    SuccessiveScale,
    Zero,
    successive_categories,
)
from relgloss_view.experiment.scaling.two_places import TwoPlaces, two_places
from relgloss_view.experiment.scaling.unfolding import (
    closeness_at,
    fit_unfolding,
    unfolding_draws,
)
from relgloss_view.experiment.session.pool import Answers

CELLS = 2**15  #: counts that are fitted together: with what is made of them they fit a cache


@dataclass(frozen=True)
class ScaleValues:
    """Closeness of the settings by one question, larger is closer, and how sure it is."""

    question: str
    probit: OrdinalScale
    torgerson: SuccessiveScale
    answered: Mask  #: (J,), settings that somebody judged
    interval: Array | None  #: (2, J), 95 %, of the probit scale
    bounds_interval: Array | None  #: (2, K-1)
    draws: Array | None  #: (B, J), of the probit scale; the mean is 0 in each
    smooth: Smooth  #: the smooth fit
    places: TwoPlaces | None  #: where the answers have two right places

    @property
    def scale(self) -> Array:
        """(J,), the probit scale, NaN without answers."""
        return np.where(self.answered, self.probit.scale, np.nan)


def observer_weights(answers: Answers, draws: int, seed: int) -> Array | None:
    """How often each resampling draws each observer, (draws, observers); None for one observer.

    Drawn from those who answered about the sample.
    """
    present = np.unique(answers.observer)
    if len(present) < 2 or draws < 1:
        return None
    random = np.random.default_rng(seed)
    number = len(present)
    weights = np.zeros((draws, answers.observers))
    weights[:, present] = random.multinomial(number, np.full(number, 1.0 / number), size=draws)
    return weights


def scale_values(
    fine: FineGrid,
    question: str,
    answers: Answers,
    weights: Array | None,
    *,
    observer_effects: bool = False,
    zero: Zero = "clip",
    progress: Callable[[float], object] = lambda share: None,
) -> ScaleValues:
    """Scale the answers about a sample to one question, and their resamplings by `weights`."""
    counts = answers.counts()
    pooled = counts.sum(axis=0)
    probit = ordinal_scale(
        counts if observer_effects else pooled, observer_effects=observer_effects
    )
    try:
        torgerson = successive_categories(pooled, zero)
    except InputError:  # every proportion is 0 or 1, and those are left out
        nothing = np.full(len(pooled), np.nan)
        torgerson = SuccessiveScale(nothing, np.full(pooled.shape[1] - 1, np.nan))
    answered = pooled.sum(axis=1) > 0.0
    unfolding = fit_unfolding(fine.grid, pooled)
    closeness = unfolding.closeness(fine.points)
    places = two_places(unfolding, counts)
    if weights is None:
        smooth = Smooth(fine, closeness, None)
        return ScaleValues(
            question=question,
            probit=probit,
            torgerson=torgerson,
            answered=answered,
            interval=None,
            bounds_interval=None,
            draws=None,
            smooth=smooth,
            places=places,
        )
    scales = np.full((len(weights), len(pooled)), np.nan)
    bounds = np.full((len(weights), pooled.shape[1] - 1), np.nan)
    surfaces = np.zeros((len(weights), len(fine.points)))
    together = max(1, CELLS // (counts.size if observer_effects else pooled.size))
    for k in range(0, len(weights), together):
        checkpoint()
        progress(k / len(weights))
        rows = slice(k, k + together)
        weighted = weights[rows, :, None, None] * counts
        total = weighted.sum(axis=1)
        fits = unfolding_draws(fine.grid, total, unfolding)
        surfaces[rows] = closeness_at(fine.grid, fits, fine.points)
        ordinal = ordinal_draws(
            weighted if observer_effects else total[:, None],
            probit,
            observer_effects=observer_effects,
        )
        scales[rows] = np.where(total.sum(axis=2) > 0.0, ordinal.scale, np.nan)
        bounds[rows] = ordinal.bounds
    return ScaleValues(
        question=question,
        probit=probit,
        torgerson=torgerson,
        answered=answered,
        interval=_interval(scales),
        bounds_interval=_interval(bounds),
        draws=scales,
        smooth=Smooth(fine, closeness, surfaces),
        places=places,
    )


def _interval(draws: Array) -> Array:
    """(2, n) ends of the central 95 % of draws (B, n); NaN where no draw has a value."""
    ends = np.full((2, draws.shape[1]), np.nan)
    for k, column in enumerate(draws.T):
        present = column[np.isfinite(column)]
        if present.size:
            ends[:, k] = np.quantile(present, (0.025, 0.975))
    return ends
