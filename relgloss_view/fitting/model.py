"""What a rung predicts and how far that is from the samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.fitting.observations import TAU, Observations
from relgloss_view.fitting.shapes import (
    Geometry,
    diffuse_columns,
    displaced,
    lobe_columns,
    metal_columns,
)
from relgloss_view.material.material import HEAD_ON

SOFT_L1, REDESCENDING = 1.0, 0.25  #: shapes of the loss: of the search, of the last refinement
LOG_S_RANGE = (float(np.log(np.radians(0.05))), float(np.log(np.radians(40.0))))
#: A lobe of a smaller share of the strongest one's strength is noise that a descent has fitted.
FAINT = 1e-3
T_MAX = 0.49  #: sigma = 0.7 rad, the end of Oren and Nayar's own range
#: A freed index below 1.3 would reflect 60 times more at grazing than head on.
INDEX_RANGE = (1.3, 10.0)


@dataclass(frozen=True)
class Rung:
    """One model of the ladder."""

    name: str
    rough: bool = True
    lobes: int = 0
    spectral: bool = False  #: each band has its own lobe strengths
    free_index: bool = False
    metals: int = 0  #: of the lobes, the first, which are a metal's
    errors: int = 0  #: freed errors of the instrument, all of them or none

    @property
    def strengths(self) -> int:
        """Linear unknowns of the lobes in a band: a metal has a coloured and a white one."""
        return self.lobes + self.metals

    @property
    def own(self) -> int:
        """Those of them that are a band's own, the first; all bands share the others."""
        return self.lobes if self.spectral else self.metals

    def parameters(self, bands: int) -> int:
        """Number of unknowns of the sample in `bands` bands."""
        strengths = self.own * bands + (self.strengths - self.own)
        index = 1 if self.free_index and self.lobes else 0
        return bands + int(self.rough) + self.lobes + strengths + index


@dataclass(frozen=True)
class State:
    """The unknowns. `kd` (B,), `ks` (J, B): a neutral lobe repeats its strength.

    Where the first M lobes are a metal's, `ks` is (J + M, B): a metal's own row is its strength
    times F0, and the last M rows are the strengths of the white parts.
    """

    t: float  #: sigma^2
    log_s: Array  #: (J,), ln of radians
    n: Array  #: (J,), refractive indices
    kd: Array
    ks: Array
    #: (K,), errors of the instrument (fitting.instrument); empty where none is fitted
    errors: Array = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True)
class States:
    """P states of one rung, stacked: each field of State with a leading axis of length P."""

    t: Array  #: (P,)
    log_s: Array  #: (P, J)
    n: Array  #: (P, J)
    kd: Array  #: (P, B)
    ks: Array  #: (P, J, B)
    errors: Array  #: (P, K)

    @classmethod
    def of(cls, states: Sequence[State]) -> States:
        """Stack states of one rung, at least one."""
        parts = ([s.t, s.log_s, s.n, s.kd, s.ks, s.errors] for s in states)
        return cls(*(np.array(part, dtype=np.float64) for part in zip(*parts, strict=True)))

    def __len__(self) -> int:
        return len(self.t)

    def __getitem__(self, place: int) -> State:
        return State(
            float(self.t[place]),
            self.log_s[place].copy(),
            self.n[place].copy(),
            self.kd[place].copy(),
            self.ks[place].copy(),
            self.errors[place].copy(),
        )

    def subset(self, rows: Mask) -> States:
        """The states marked in `rows`."""
        return States(*(getattr(self, part.name)[rows] for part in fields(self)))

    def updated(self, rows: Mask, other: States) -> States:
        """These states, with those of `other` where `rows` is true."""
        return States(
            np.where(rows, other.t, self.t),
            np.where(rows[:, None], other.log_s, self.log_s),
            np.where(rows[:, None], other.n, self.n),
            np.where(rows[:, None], other.kd, self.kd),
            np.where(rows[:, None, None], other.ks, self.ks),
            np.where(rows[:, None], other.errors, self.errors),
        )


@dataclass(frozen=True)
class Solution:
    """A state and its mean loss over the samples."""

    state: State
    loss: float
    converged: bool = True


def lobe_order(state: State) -> list[int]:
    """The lobes as a material lists them, the strongest first; none that is FAINT beside it."""
    mean = brightness(state) if len(state.ks) else np.zeros(0)
    least = FAINT * float(np.max(mean, initial=0.0))
    return [int(j) for j in np.argsort(-mean, kind="stable") if mean[j] > least]


def brightness(state: State) -> Array:
    """(J,), mean strength of each lobe; a metal's as that of a dielectric of index 1.5."""
    lobes = len(state.log_s)
    mean = np.mean(state.ks[:lobes], axis=1)
    mean[: len(state.ks) - lobes] /= HEAD_ON
    return np.asarray(mean)


def predict(g: Geometry, state: State) -> Array:
    """Radiance factors (N, B) as the instrument would see them, through its apertures."""
    first, second, _, _ = diffuse_columns(g, state.t)
    if state.errors.size:
        g = displaced(g, state.errors)
    value = np.multiply.outer(first, state.kd) + np.multiply.outer(second, state.kd**2)
    lobes = len(state.log_s)
    metals = len(state.ks) - lobes
    for j, log_s in enumerate(state.log_s):
        if j < metals:
            facing, grazing = metal_columns(g, float(log_s))[:2]
            value += np.multiply.outer(facing, state.ks[j])
            value += np.multiply.outer(grazing, state.ks[lobes + j])
            continue
        value += np.multiply.outer(lobe_columns(g, float(log_s), float(state.n[j]))[0], state.ks[j])
    return np.asarray(value)


def log_residual(observations: Observations, model: Array) -> Array:
    """(N, B), log of model over measured, both above the floor."""
    return np.log((model + observations.floor) / (observations.value + observations.floor))


def error_size(residual: Array) -> Array:
    """Soft-L1, in units of the logarithmic residual: about |r| far out. Scores the candidates."""
    return np.asarray(TAU * (np.sqrt(1.0 + (residual / TAU) ** 2) - 1.0))


def mean_error(observations: Observations, model: Array) -> float:
    """Weighted mean of `error_size` over all values."""
    size = error_size(log_residual(observations, model))
    return float(np.sum(observations.weight * size) / np.sum(observations.weight))


def robust(residual: Array, alpha: float = SOFT_L1) -> Array:
    """The loss that a refinement descends, in units of TAU^2: Barron 2019 of shape `alpha` > 0.

    alpha = 1 is soft-L1. With less, samples that no model reaches (the foot of a film's lobe,
    grazing backscatter) bend the part that it does reach less.
    """
    z = (residual / TAU) ** 2 / abs(alpha - 2.0)
    power = np.sqrt(1.0 + z) if alpha == SOFT_L1 else (1.0 + z) ** (0.5 * alpha)
    return np.asarray(abs(alpha - 2.0) / alpha * (power - 1.0))


def influence(residual: Array, alpha: float = SOFT_L1) -> Array:
    """Weight of a residual in the normal equations: slope of `robust` over residual, x TAU^2."""
    z = (residual / TAU) ** 2 / abs(alpha - 2.0)
    if alpha == SOFT_L1:
        return np.asarray(1.0 / np.sqrt(1.0 + z))
    return np.asarray((1.0 + z) ** (0.5 * alpha - 1.0))
