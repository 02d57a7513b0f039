"""Rows: the readings that checks look at, with the angles that describe their geometry."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.measure.gonio import from_normal
from relgloss_view.measure.table import KEPT, NEGATIVE, OCCLUDED, Measurement
from relgloss_view.measure.thinning import thinned

#: Facets of coatings and inks, for the growth of a highlight with incidence.
F0 = 0.04
#: Half-vectors further from the normal show the body of all but the roughest samples.
BODY_DEG = 25.0
#: Rows that smooth functions are fitted to: more would change no finding.
MOST_ROWS = 16_000


@dataclass(frozen=True)
class Rows:
    """N readings with both directions above the horizon, of any reason but a fault of their own.

    Rows between the arms of an instrument are among them: they are not fitted, but what they read
    must not pass without a word.
    """

    index: Ints  #: (N,), rows of the measurement
    to_lamp: Array  #: (N, 3), unit vectors
    to_receiver: Array  #: (N, 3), unit vectors
    values: Array  #: (N, B), radiance factors, finite
    kept: Mask  #: (N,), whether the fit uses the row
    group: Ints  #: (N,), plane of incidence or setting of the lamp
    whole_body_level: float | None = None  #: of the whole table, where these are some of its rows

    @classmethod
    def of(cls, measurement: Measurement) -> Rows:
        """Those of a measurement."""
        reasons = measurement.reasons
        usable = (reasons == KEPT) | (reasons == OCCLUDED)
        if measurement.bands.is_rgb:
            usable |= reasons == NEGATIVE
        values = measurement.radiance_factor
        usable &= np.isfinite(values).all(axis=1) & (values.mean(axis=1) > 0.0)
        usable &= (measurement.to_lamp[:, 2] > 0.03) & (measurement.to_receiver[:, 2] > 0.03)
        index = np.flatnonzero(usable)
        return cls(
            index,
            measurement.to_lamp[index],
            measurement.to_receiver[index],
            values[index],
            np.asarray(reasons[index] != OCCLUDED),
            measurement.group[index],
        )

    def subset(self, rows: Mask) -> Rows:
        """The marked rows."""
        return Rows(
            self.index[rows],
            self.to_lamp[rows],
            self.to_receiver[rows],
            self.values[rows],
            self.kept[rows],
            self.group[rows],
            self.body_level,
        )

    def thinned(self) -> Rows:
        """These rows, or of more than MOST_ROWS those that stand for them (measure.thinning)."""
        if len(self) <= MOST_ROWS:
            return self
        rows, _ = thinned(self.to_lamp, self.to_receiver, self.group, MOST_ROWS)
        return self.subset(np.isin(np.arange(len(self)), rows))

    def __len__(self) -> int:
        return len(self.index)

    @cached_property
    def level(self) -> Array:
        """(N,), mean over the bands."""
        return np.asarray(self.values.mean(axis=1))

    @cached_property
    def half(self) -> Array:
        """(N, 3), half-vectors, of unit length."""
        total = self.to_lamp + self.to_receiver
        length = np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-12)
        return np.asarray(total / length)

    @cached_property
    def delta_deg(self) -> Array:
        """(N,), angle between the normal and the half-vector."""
        return from_normal(self.half)

    @cached_property
    def cos_d(self) -> Array:
        """(N,), cosine of the angle at which a facet along the half-vector is met."""
        return np.asarray(0.5 * np.linalg.norm(self.to_lamp + self.to_receiver, axis=1))

    @cached_property
    def incidence_deg(self) -> Array:
        """(N,), the same angle, degrees."""
        return np.asarray(np.degrees(np.arccos(np.clip(self.cos_d, 0.0, 1.0))))

    @cached_property
    def phase_deg(self) -> Array:
        """(N,), angle between lamp and receiver."""
        chord = np.linalg.norm(self.to_lamp - self.to_receiver, axis=1)
        return np.asarray(np.degrees(2.0 * np.arcsin(np.minimum(0.5 * chord, 1.0))))

    @cached_property
    def lamp_deg(self) -> Array:
        """(N,), polar angle of the lamp."""
        return np.asarray(np.degrees(np.arccos(np.clip(self.to_lamp[:, 2], -1.0, 1.0))))

    @cached_property
    def receiver_deg(self) -> Array:
        """(N,), polar angle of the receiver."""
        return np.asarray(np.degrees(np.arccos(np.clip(self.to_receiver[:, 2], -1.0, 1.0))))

    @cached_property
    def body_level(self) -> float:
        """Typical level away from the highlight, in the whole table."""
        if self.whole_body_level is not None:
            return self.whole_body_level
        away = self.delta_deg > BODY_DEG
        levels = self.level[away] if np.sum(away) >= 5 else self.level
        return float(np.median(levels))

    @cached_property
    def low_level(self) -> float:
        """Level of the body whatever the geometry is: a fifth of the rows lie below."""
        return float(np.partition(self.level, len(self) // 5)[len(self) // 5])

    @cached_property
    def facets(self) -> Array:
        """(N,), readings above the body in units of what a level facet sends there.

        Proportional to the density of facets (Torrance, Sparrow 1967): the growth with incidence
        by Fresnel's equations (form of Schlick 1994) and by the cosines is divided out.
        """
        return facet_density(self.level - self.body_level, self.to_lamp, self.to_receiver)


def facet_density(excess: Array, to_lamp: Array, to_receiver: Array) -> Array:
    """(N,), light above the body divided by F / (4 cos_i cos_o) of a dielectric."""
    between = np.einsum("ij,ij->i", to_lamp, to_receiver)
    cos_d = np.sqrt(np.clip(0.5 * (1.0 + between), 0.0, 1.0))
    reflectance = F0 + (1.0 - F0) * (1.0 - cos_d) ** 5
    cosines = np.maximum(to_lamp[:, 2] * to_receiver[:, 2], 1e-3)
    return np.asarray(excess * 4.0 * cosines / (np.pi * reflectance))
