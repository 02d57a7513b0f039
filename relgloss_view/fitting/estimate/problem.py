"""Readings and a colour, and how well surfaces agree with them."""

from __future__ import annotations

import math

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.fitting.estimate import grazing, model, prior
from relgloss_view.fitting.estimate.colour import DARK_ERROR, Colour
from relgloss_view.fitting.estimate.given import GlossReading
from relgloss_view.material.estimated import EstimateRecord
from relgloss_view.material.material import Diffuse, Lobe, Material

#: A second lobe of a smaller share of the main one's strength is left out.
LEAST_SHARE = 0.003
LEAST_LIKELIHOOD = 1e-200


class Problem:
    """Readings and a colour, and how well surfaces agree with them."""

    def __init__(
        self,
        readings: tuple[GlossReading, ...],
        colour: Colour,
        factors: tuple[float, ...] | None = None,
    ) -> None:
        self.readings, self.colour = readings, colour
        self.factors = factors or (1.0,) * len(readings)
        self.angles = [reading.angle_deg for reading in readings]
        self.values = np.array([reading.value for reading in readings])
        self.errors = np.array([reading.standard_error for reading in readings]) * self.factors
        self._diffuse_units = model.diffuse_units(self.angles) if readings else np.zeros(0)
        self._luminous = colour.luminous
        near = [k for k, angle in enumerate(self.angles) if angle == grazing.GRAZING_DEG]
        self.grazing = near[0] if near else None  #: index of the reading at 85 degrees

    def with_errors(self, factors: tuple[float, ...]) -> Problem:
        """The same with errors that are larger by a factor each."""
        return Problem(self.readings, self.colour, factors)

    def without(self, k: int) -> Problem:
        """The same without one reading."""
        left = self.readings[:k] + self.readings[k + 1 :]
        return Problem(left, self.colour, self.factors[:k] + self.factors[k + 1 :])

    def gray(self, surfaces: Array) -> Array:
        """What the lobes add to the colour in its geometry, (N,)."""
        return model.lobe_colour(surfaces, self.colour.geometry)

    def diffuse_y(self, gray: Array) -> Array:
        """Luminous albedo (N,) of the body."""
        return np.maximum(self._luminous - np.minimum(gray, self.colour.room), 0.0)

    def predicted(self, surfaces: Array) -> Array:
        """The readings (N, R) that the surfaces give."""
        y = self.diffuse_y(self.gray(surfaces))
        lobes = model.lobe_readings(surfaces, self.angles)
        return np.asarray(lobes + y[:, None] * self._diffuse_units)

    def misfit(self, surfaces: Array, *, facets_alone: bool) -> Array:
        """Differences (N, R + 1) to the readings, and the lobe beyond the colour, over errors.

        facets_alone: whether the reading at 85 degrees is taken as one of facets; otherwise its
        difference is what lies beyond facets and smooth surfaces (grazing).
        """
        return self._misfit(surfaces, self.gray(surfaces), facets_alone)[0]

    def _misfit(self, surfaces: Array, gray: Array, facets_alone: bool) -> tuple[Array, Array]:
        """The differences, and the readings (N, R) that facets give."""
        lobes = model.lobe_readings(surfaces, self.angles)
        predicted = lobes + self.diffuse_y(gray)[:, None] * self._diffuse_units
        misfit = (predicted - self.values) / self.errors
        if self.grazing is not None and not facets_alone:
            k = self.grazing
            misfit[:, k] = grazing.beyond(*self._grazing_parts(surfaces, predicted))
        beyond = np.maximum(gray - self.colour.room, 0.0) / DARK_ERROR
        return np.concatenate([misfit, beyond[:, None]], axis=1), predicted

    def _grazing_parts(
        self, surfaces: Array, predicted: Array
    ) -> tuple[float, float, Array, Array]:
        """Value and error of the reading at 85 degrees; what facets and smooth surfaces give."""
        k = self.grazing
        assert k is not None
        smooth = grazing.smooth_units(surfaces[:, prior.INDEX])
        return float(self.values[k]), float(self.errors[k]), predicted[:, k], smooth

    def strain(self, surfaces: Array) -> Array:
        """Sum (N,) of the squares of misfits and of the index's distance from usual ones."""
        index = (surfaces[:, prior.INDEX] - prior.INDEX_MEAN) / prior.INDEX_SD
        misfit = self.misfit(surfaces, facets_alone=False)
        return np.asarray(np.sum(misfit**2, axis=1) + index**2)

    def log_likelihood(self, surfaces: Array) -> Array:
        """(N,), but for a constant."""
        misfit, predicted = self._misfit(surfaces, self.gray(surfaces), True)
        if self.grazing is None:
            return np.asarray(-0.5 * np.sum(misfit**2, axis=1))
        parts = grazing.parts(*self._grazing_parts(surfaces, predicted))
        misfit[:, self.grazing] = 0.0
        total = np.maximum(parts[0] + parts[1], LEAST_LIKELIHOOD)
        # Far beyond both, the logarithm goes on as the Gaussian's does.
        far = -0.5 * grazing.beyond(*self._grazing_parts(surfaces, predicted)) ** 2
        log_grazing = np.where(total > LEAST_LIKELIHOOD, np.log(total), far)
        return np.asarray(log_grazing - 0.5 * np.sum(misfit**2, axis=1))

    def beyond_facets(self, surfaces: Array) -> bool:
        """Whether the reading at 85 degrees clearly holds more than facets give."""
        if self.grazing is None:
            return False
        alone, more = grazing.parts(*self._grazing_parts(surfaces, self.predicted(surfaces)))
        share = np.mean(more / np.maximum(alone + more, LEAST_LIKELIHOOD))
        return bool(share > grazing.CLEARLY)

    def material(self, surface: Array, name: str, record: EstimateRecord | None) -> Material:
        """The material of one surface (5,)."""
        one = surface[None]
        lobes = []
        for k, (log_s, strength) in enumerate(model.lobes(one)):
            if k == 0 or math.exp(surface[prior.SHARE]) >= LEAST_SHARE:
                lobes.append(
                    Lobe(
                        (float(strength[0]),), float(np.exp(log_s[0])), float(surface[prior.INDEX])
                    )
                )
        body = self.colour.body(float(self.gray(one)[0]))
        words = ", ".join(reading.words for reading in self.readings)
        return Material(
            name,
            f"estimated from gloss {words} and {colour_words(self.colour)}; no gonio table",
            self.colour.bands,
            Diffuse("lambert", body),
            tuple(lobes),
            estimate=record,
        )


def colour_words(colour: Colour) -> str:
    """A colour as people read it, such as 'Lab 46, -50, 25 (D50, 45-0)'."""
    record = colour.record
    if record["kind"] == "spectrum":
        return f"the spectrum {record['name']} ({colour.geometry})"
    numbers = ", ".join(f"{value:g}" for value in record["lab"])
    kind = "an assumed Lab" if record["kind"] == "assumed" else "Lab"
    return f"{kind} {numbers} ({record['illuminant']}, {colour.geometry})"
