"""Where each unknown that all bands share has its place in one vector."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.fitting.instrument import LARGEST_ANGLE, LARGEST_LOG_APERTURE
from relgloss_view.fitting.model import (
    INDEX_RANGE,
    LOG_S_RANGE,
    T_MAX,
    Rung,
    States,
)

WIDTH_STEP, INDEX_STEP = 0.7, 0.5  #: limits of one step in ln s and in a refractive index
ANGLE_STEP, SPREAD_STEP = 0.01, 0.3  #: and in the instrument's errors, rad and ln


@dataclass(frozen=True)
class SharedUnknowns:
    """The S shared unknowns of a rung, in order, with their bounds and limits of one step."""

    t: slice
    log_s: slice
    n: slice
    ks: slice  #: empty where each band has its own strengths
    own: int  #: strengths that are a band's own, before those
    errors: slice  #: of the instrument
    low: Array  #: (S,)
    high: Array  #: (S,)
    limit: Array  #: (S,)

    @property
    def count(self) -> int:
        """S."""
        return len(self.low)

    def values(self, states: States) -> Array:
        """(P, S), the shared unknowns of P states."""
        values = np.empty((len(states), self.count))
        values[:, self.t] = states.t[:, None][:, : self.t.stop]
        values[:, self.log_s] = states.log_s
        values[:, self.n] = states.n[:, : self.n.stop - self.n.start]
        values[:, self.ks] = states.ks[:, self.own : self.own + self.ks.stop - self.ks.start, 0]
        values[:, self.errors] = states.errors[:, : self.errors.stop - self.errors.start]
        return values

    def replaced(self, states: States, values: Array, kd: Array, own_ks: Array) -> States:
        """The states with new shared unknowns (P, S), albedos (P, B) and own strengths (P, J, B).

        Unknowns that the rung holds keep their values.
        """
        bands = kd.shape[1]
        neutral = values[:, self.ks]
        return States(
            values[:, 0] if self.t.stop else states.t,
            values[:, self.log_s],
            np.repeat(values[:, self.n], states.n.shape[1], axis=1)
            if self.n.stop > self.n.start
            else states.n,
            kd,
            self._strengths(np.repeat(neutral[:, :, None], bands, axis=2), own_ks),
            values[:, self.errors] if self.errors.stop > self.errors.start else states.errors,
        )

    def _strengths(self, neutral: Array, own: Array) -> Array:
        if not neutral.shape[1]:
            return own
        return np.concatenate([own, neutral], axis=1) if self.own else neutral


@lru_cache(maxsize=64)
def shared_unknowns(rung: Rung) -> SharedUnknowns:
    """Roughness, widths, freed indices, neutral strengths, errors, each as the rung has it."""
    neutral = rung.strengths - rung.own
    index = int(rung.free_index and rung.lobes > 0)  # all lobes are of one surface
    free = (index, neutral, max(rung.errors - 1, 0))
    counts = (int(rung.rough), rung.lobes, *free, min(rung.errors, 1))
    ends = np.cumsum(counts).tolist()
    angle, spread = LARGEST_ANGLE, LARGEST_LOG_APERTURE
    ranges = (
        *((0.0, T_MAX), LOG_S_RANGE, INDEX_RANGE, (0.0, np.inf)),
        *((-angle, angle), (-spread, spread)),
    )
    low, high = np.repeat(np.array(ranges), counts, axis=0).T
    steps = (np.inf, WIDTH_STEP, INDEX_STEP, np.inf, ANGLE_STEP, SPREAD_STEP)
    t, log_s, n, ks, angles, last = (slice(e - c, e) for c, e in zip(counts, ends, strict=True))
    return SharedUnknowns(
        t=t, log_s=log_s, n=n, ks=ks, own=rung.own, errors=slice(angles.start, last.stop),
        low=low, high=high, limit=np.repeat(steps, counts),
    )  # fmt: skip
