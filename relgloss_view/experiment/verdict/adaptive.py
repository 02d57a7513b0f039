"""What an adaptive study tells of a sample: its posterior, judged as scales are judged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.experiment.design.coordinates import coordinates, to_steps
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.scaling.fine_grid import BROAD_SHARE
from relgloss_view.experiment.session.posterior import INTERVAL, Estimate, Posterior
from relgloss_view.experiment.verdict.full_grid import BEST, BROAD, CHANCE, RIDGE

RIDGE_SD = 0.8  #: steps: a posterior longer than this ...
RIDGE_RATIO = 3.0  #: ... and this many times as long as wide is a ridge


@dataclass(frozen=True)
class AdaptiveVerdict:
    """The verdict of an adaptive study on one sample."""

    status: str
    estimate: Estimate
    leading: int  #: the setting of the grid that is nearest to the estimate
    as_good: Mask  #: settings nearest to the points of the 95 % region
    posterior: Array  #: (fine sigma_N, fine c), probability


def adaptive_verdict(posterior: Posterior, grid: Grid, level: float) -> AdaptiveVerdict:
    """The verdict; nothing is best where the answers are by chance with more than `level`."""
    estimate = posterior.estimate()
    weights = posterior.weights()
    places = coordinates(grid)
    at = np.array(to_steps(grid, estimate.sigma_n_deg, estimate.c_fraction))
    leading = int(np.argmin(np.sum((places - at) ** 2, axis=1)))
    order = np.argsort(-weights)
    held = order[: int(np.searchsorted(np.cumsum(weights[order]), INTERVAL)) + 1]
    nearest = np.argmin(
        np.sum((posterior.points[held][:, None] - places[None]) ** 2, axis=-1), axis=1
    )
    as_good = np.zeros(len(grid), dtype=bool)
    as_good[nearest] = True
    as_good[leading] = True
    centred = posterior.points - weights @ posterior.points
    covariance = centred.T @ (weights[:, None] * centred)
    short, long = np.sqrt(np.maximum(np.linalg.eigvalsh(covariance), 0.0))
    line = min(places[-1]) == 0.0  # of a grid with one sigma_N or one c
    status = BEST
    if estimate.chance > level:
        status = CHANCE
    elif len(held) > BROAD_SHARE * len(weights):
        status = BROAD
    elif not line and long > RIDGE_SD and long > RIDGE_RATIO * short:
        status = RIDGE
    return AdaptiveVerdict(status, estimate, leading, as_good, posterior.table(weights))
