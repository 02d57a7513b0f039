"""MERL BRDF database (Matusik et al. 2003): isotropic, over half and difference angles.

Bin edges lie at theta_h = (k / 90)^2 90 degrees, finer towards the mirror direction, and at whole
degrees of theta_d and phi_d (Rusinkiewicz 1998). A negative bin was not measured.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import open_regular, read_opened
from relgloss_view.measure import screening as screen
from relgloss_view.measure.bands import RGB
from relgloss_view.measure.readers import half_difference
from relgloss_view.measure.readers.assemble import (
    evaluate_above,
    require_samples,
    tabulated_directions,
)
from relgloss_view.measure.table import Measurement, source_is_synthetic

SHAPE = (90, 90, 180)  #: theta_h, theta_d, phi_d
HEADER = np.array(SHAPE, dtype="<i4").tobytes()
SIZE = len(HEADER) + 3 * int(np.prod(SHAPE)) * 8
EXPECTED = "a MERL .binary"
#: The factors of the authors' own reader, to 1/sr.
SCALE = np.array([1.0, 1.15, 1.66]) / 1500.0


def read(path: Path) -> Measurement:
    """Read a .binary file at gonio.tabulated_grid(). Raises InputError."""
    brdf = load(path)
    to_lamp, to_receiver, group = tabulated_directions()
    factor = np.pi * brdf.evaluate(to_lamp, to_receiver)
    return require_samples(
        Measurement(
            name=path.stem,
            source=f"{path.name}, MERL BRDF database format (Matusik et al. 2003), "
            "channels taken as linear sRGB",
            to_lamp=to_lamp,
            to_receiver=to_receiver,
            bands=RGB,
            radiance_factor=factor,
            reasons=screen.reasons(to_lamp, to_receiver, factor),
            group=group,
            synthetic=source_is_synthetic(path.name),
            tabulated=True,
        ),
        path,
    )


def load(path: Path) -> MerlBrdf:
    """Read a .binary file. Raises InputError where it is damaged."""
    with open_regular(path, EXPECTED) as file:
        size = os.fstat(file.fileno()).st_size
        # Read, not mapped: a mapped file that someone cuts off ends the program.
        data = read_opened(file, path, SIZE, EXPECTED) if size == SIZE else b""
    if len(data) != SIZE:
        raise InputError(
            f"{path}: {size} bytes, a MERL file of 90 x 90 x 180 bins has {SIZE}; "
            "the file is damaged, download it again"
        )
    bins = np.frombuffer(data, "<f8", offset=len(HEADER)).reshape(3, *SHAPE)
    for channel, values in zip(RGB.labels, bins, strict=True):
        if not np.isfinite(values).all():
            place = ", ".join(str(k) for k in np.argwhere(~np.isfinite(values))[0])
            raise InputError(
                f"{path}: channel {channel} holds a NaN or an infinity in bin [{place}]; "
                "the file is damaged, download it again"
            )
    return MerlBrdf(bins)


@dataclass(frozen=True)
class MerlBrdf:
    """A measured BRDF over half and difference angles; call evaluate."""

    bins: Array  #: (3, 90, 90, 180), as stored

    def evaluate(self, i: ArrayLike, o: ArrayLike) -> Array:
        """BRDF in 1/sr, shape (..., 3); NaN where unmeasured, zero below the horizon.

        i (to the lamp) and o (to the eye) are unit vectors, (..., 3). Interpolates between the
        centres of measured bins: linearly in theta_d and phi_d, and the logarithm in the square of
        theta_h, which is exact for the Gaussians that narrow highlights look like and keeps what a
        straight line adds on their flanks. A direction in an unmeasured bin has no value.
        """
        return evaluate_above(i, o, lambda i, o: self._interpolate(_bin_coordinates(i, o)))

    def _interpolate(self, coordinates: Array) -> Array:
        """Values at bin coordinates (M, 3), where bin k reaches from k to k + 1."""
        counts = np.array(SHAPE)
        own = np.minimum(coordinates.astype(np.int64), counts - 1)
        centred = coordinates - 0.5
        low = np.floor(centred).astype(np.int64)
        fraction = centred - low
        inner, outer = (self._beside(low, fraction, k) for k in (0, 1))
        # Beyond the first and the last centre one bin counts for both.
        ends = np.clip(low[:, :1] + np.arange(2), 0, counts[0] - 1) + 0.5
        square = np.stack([centred[:, 0] + 0.5, *ends.T]) ** 4  # theta_h goes as the square
        share = (square[0] - square[1]) / np.maximum(square[2] - square[1], 1e-30)
        share = np.clip(share, 0.0, 1.0)[:, None]
        value = _joined(inner, outer, share)
        missing = (self._at(own) < 0.0) | np.isnan(value)
        return np.asarray(np.where(missing, np.nan, value * SCALE))

    def _beside(self, low: Ints, fraction: Array, k: int) -> Array:
        """(M, 3), means of the measured bins of theta_h low + k; NaN where none is measured."""
        total, weight = np.zeros((len(low), 3)), np.zeros((len(low), 3))
        for corner in product((0, 1), repeat=2):
            index = low + np.array([k, *corner])
            near = np.where(corner, fraction[:, 1:], 1.0 - fraction[:, 1:])
            share = np.prod(near, axis=1)[:, None]
            index[:, :2] = np.clip(index[:, :2], 0, np.array(SHAPE[:2]) - 1)
            index[:, 2] %= SHAPE[2]  # phi_d has the period pi (reciprocity)
            values = self._at(index)
            measured = np.where(values >= 0.0, share, 0.0)
            total += measured * values
            weight += measured
        return np.where(weight > 0.0, total / np.where(weight > 0.0, weight, 1.0), np.nan)

    def _at(self, index: Ints) -> Array:
        return np.asarray(self.bins[:, index[:, 0], index[:, 1], index[:, 2]]).T


def _joined(inner: Array, outer: Array, share: Array) -> Array:
    """Values between two bins of theta_h; where one is not measured, the other's."""
    inner, outer = (
        np.where(np.isnan(one), other, one) for one, other in ((inner, outer), (outer, inner))
    )
    straight = (1.0 - share) * inner + share * outer
    positive = (inner > 0.0) & (outer > 0.0)
    logs = (np.log(np.where(positive, part, 1.0)) for part in (inner, outer))
    first, second = logs
    return np.where(positive, np.exp((1.0 - share) * first + share * second), straight)


def _bin_coordinates(i: Array, o: Array) -> Array:
    """Continuous bin coordinates (M, 3) of unit vectors i and o (Rusinkiewicz 1998)."""
    theta_h, theta_d, phi_d = half_difference.angles_of(i, o)
    phi_d = phi_d % np.pi
    right = 0.5 * np.pi
    coordinates = np.stack(
        [
            SHAPE[0] * np.sqrt(theta_h / right),
            SHAPE[1] * theta_d / right,
            SHAPE[2] * phi_d / np.pi,
        ],
        axis=1,
    )
    return np.asarray(np.clip(coordinates, 0.0, np.array(SHAPE, dtype=np.float64)))
