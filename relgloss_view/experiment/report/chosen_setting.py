"""What is chosen for a sample, in one form for full-grid and adaptive studies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.experiment.design.coordinates import coordinates
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.scaling.fine_grid import Shape
from relgloss_view.experiment.verdict.adaptive import AdaptiveVerdict
from relgloss_view.experiment.verdict.analysis import JOINT, SampleResult
from relgloss_view.experiment.verdict.full_grid import (
    ALIKE,
    CHANCE,
    MIXED,
    TWO,
    Verdict,
    edges_of,
)
from relgloss_view.experiment.verdict.groups import MixedGroups
from relgloss_view.picture.scene.setting import Setting

Interval = tuple[float, float]


@dataclass(frozen=True)
class ChosenSetting:
    """A verdict, and the setting that it chooses. Arrays are over the settings of the grid."""

    status: str
    leading: int
    setting: Setting  #: the leading one
    shares: Array | None  #: of resamplings that a setting leads in; adaptive: of the posterior
    at: Setting  #: the best between grid points
    sigma_n_interval_deg: Interval | None  #: 95 %
    c_interval: Interval | None
    as_good: Mask  #: not distinguishable from the leading one, itself among them
    shape: Shape | None
    edges: tuple[str, ...]
    p_chance: float  #: adaptive: the probability that all answers are by chance
    adaptive: bool
    groups: MixedGroups | None = None  #: of observers who disagree
    places: tuple[int, int] | None = None  #: settings nearest to two right places
    alike: float = 0.0  #: the share of the most frequent answer

    @property
    def leads(self) -> float | None:
        """The leading setting's share."""
        return None if self.shares is None else float(self.shares[self.leading])

    @property
    def may_be_named(self) -> bool:
        """Whether a setting may be pointed at.

        Not where the answers may be by chance or nearly all are the same, where groups of
        observers disagree, and where two places are right.
        """
        return self.status not in (CHANCE, ALIKE, MIXED, TWO)


def chosen_setting(result: SampleResult, grid: Grid) -> ChosenSetting:
    """The choice for a sample."""
    if result.adaptive is not None:
        return _of_posterior(result.adaptive, grid)
    return setting_chosen_by(result, grid, result.decided_by)


def setting_chosen_by(result: SampleResult, grid: Grid, question: str) -> ChosenSetting:
    """The choice that the scale of one question makes."""
    verdict: Verdict = result.verdicts[question]
    best = verdict.optimum
    return ChosenSetting(
        status=verdict.status,
        leading=verdict.leading,
        setting=grid.settings[verdict.leading],
        shares=verdict.wins,
        at=Setting(best.sigma_n_deg, best.c_fraction),
        sigma_n_interval_deg=_along(grid, 0, best.sigma_n_interval_deg),
        c_interval=_along(grid, 1, best.c_interval),
        as_good=verdict.as_good,
        shape=verdict.shape,
        edges=verdict.edges,
        p_chance=result.p[question],
        adaptive=False,
        groups=verdict.groups,
        places=verdict.places,
        alike=verdict.alike,
    )


def _of_posterior(verdict: AdaptiveVerdict, grid: Grid) -> ChosenSetting:
    best = verdict.estimate
    return ChosenSetting(
        status=verdict.status,
        leading=verdict.leading,
        setting=grid.settings[verdict.leading],
        shares=nearest_shares(grid, verdict.posterior),
        at=Setting(best.sigma_n_deg, best.c_fraction),
        sigma_n_interval_deg=_along(grid, 0, best.sigma_n_interval_deg),
        c_interval=_along(grid, 1, best.c_interval),
        as_good=verdict.as_good,
        shape=None,
        edges=edges_of(grid, verdict.leading),
        p_chance=best.chance,
        adaptive=True,
    )


def _along(grid: Grid, axis: int, ends: Interval | None) -> Interval | None:
    """An interval, where the grid has more than one value to choose from."""
    return ends if grid.shape[axis] > 1 else None


def nearest_shares(grid: Grid, posterior: Array) -> Array:
    """(J,), how much of a posterior (fine sigma_N, fine c) lies nearest to each setting."""
    places = coordinates(grid).reshape(*grid.shape, 2)
    found = posterior
    for axis, of_grid in enumerate((places[:, 0, 0], places[0, :, 1])):
        fine = np.linspace(0.0, of_grid[-1], posterior.shape[axis])
        nearest = np.argmin(np.abs(fine[:, None] - of_grid), axis=1)
        belongs = np.eye(len(of_grid))[nearest]  # (fine, of the grid)
        found = np.moveaxis(np.tensordot(belongs, found, axes=(0, axis)), 0, axis)
    return np.asarray(found).ravel()


@dataclass(frozen=True)
class ScaleTable:
    """Closeness of the settings by one question, or by both together. Arrays are (J,)."""

    probit: Array  #: NaN without answers
    low: Array  #: 95 % interval, NaN where there is none
    high: Array
    torgerson: Array
    counts: Array | None  #: (J, K), None for both together


def scale_table(result: SampleResult, counts: dict[str, Array], question: str) -> ScaleTable:
    """The scale values of a question; `counts` holds (J, K) of each that was asked."""
    if question != JOINT:
        scale = next(s for s in result.scales if s.question == question)
        none = np.full(len(scale.scale), np.nan)
        low, high = (none, none) if scale.interval is None else scale.interval
        return ScaleTable(scale.scale, low, high, scale.torgerson.scale, counts[question])
    first, second = result.scales
    low = high = np.full(len(first.scale), np.nan)
    if first.draws is not None and second.draws is not None:
        low, high = np.quantile(first.draws + second.draws, (0.025, 0.975), axis=0)
    torgerson = first.torgerson.scale + second.torgerson.scale
    return ScaleTable(first.scale + second.scale, low, high, torgerson, None)
