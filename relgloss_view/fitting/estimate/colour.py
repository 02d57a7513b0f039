"""The colour of a surface in one geometry, and what the lobe leaves of it to the diffuse body."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.gloss.meter.meter import luminous_weights
from relgloss_view.material.cielab import xyz_from_lab
from relgloss_view.material.reflectance import check_lab, lab_to_spectrum, xyz_to_spectrum
from relgloss_view.material.spectra import illuminant as lamp_of
from relgloss_view.material.spectra import xyz_weights
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.spectrum import AT_45_0, GEOMETRIES, ColourReading

BANDS = Bands(tuple(float(w) for w in range(390, 731, 10)))  #: of a spectrum made from Lab
#: Standard error of a lightness L*, between two instruments of one kind (ISO 13655 asks for a mean
#: difference between instruments well below 1).
LIGHTNESS_ERROR = 0.3
#: What the lobe may take beyond the darkest band, one standard deviation, in radiance factor.
DARK_ERROR = 0.003
LARGEST_FACTOR = 2.0  #: radiance factors above are percent; fluorescent papers reach 1.4
ASSUMED_L = 50.0
ROOM_STEPS = 14  #: bisections: the room is found to 1/16,000 of the darkest tristimulus value


@dataclass(frozen=True)
class LabColour:
    """L*, a*, b* of the CIE 1931 observer under a lamp (ISO 13655: D50, 2 degrees)."""

    lab: tuple[float, float, float]
    illuminant: str = "D50"
    lightness_error: float = LIGHTNESS_ERROR


@dataclass(frozen=True)
class Colour:
    """A colour as an estimate needs it.

    radiance_factor: (B,). room: the most gray that a lobe can add to it, so that some body is left.
    body_of: the albedo (B,) of a body from the gray that the lobe adds.
    """

    bands: Bands
    radiance_factor: Array
    geometry: str
    room: float
    body_of: Callable[[float], Array]
    relative_error: float  #: standard error of its luminance, as a share
    record: dict[str, Any]  #: how the file states it
    notes: tuple[str, ...] = ()

    @property
    def luminous(self) -> float:
        """Its luminous radiance factor under illuminant C, as a gloss meter sees it."""
        return float(luminous_weights(self.bands) @ self.radiance_factor)

    def body(self, gray: float) -> tuple[float, ...]:
        """The albedo, one value a band, where a lobe adds a gray."""
        return tuple(float(value) for value in self.body_of(gray))


def colour_of(colour: LabColour | ColourReading | None, geometry: str | None = None) -> Colour:
    """The colour of a Lab, of a spectrum, or a neutral one where none is given.

    geometry: one of GEOMETRIES; None takes the spectrum's own, or 45-0. InputError where the colour
    is impossible, in percent, or stated in another geometry.
    """
    if geometry is not None and geometry not in GEOMETRIES:
        raise InputError(f"geometry {geometry!r}: expected one of {', '.join(GEOMETRIES)}")
    if isinstance(colour, ColourReading):
        return _of_spectrum(colour, geometry)
    where = geometry or AT_45_0
    if colour is None:
        gray = LabColour((ASSUMED_L, 0.0, 0.0))
        note = (
            f"no colour is given: a gray of L* {ASSUMED_L:g} is assumed; give --lab or --spectrum"
        )
        return _of_lab(gray, where, "assumed", (note,))
    return _of_lab(colour, where, "lab", ())


@lru_cache(maxsize=32)
def _of_lab(colour: LabColour, geometry: str, kind: str, notes: tuple[str, ...]) -> Colour:
    lab = check_lab(colour.lab)
    spectrum = lab_to_spectrum(lab, BANDS, colour.illuminant)
    lamp = lamp_of(colour.illuminant)
    weights, white = xyz_weights(BANDS, lamp), lamp.white_xyz()
    xyz = xyz_from_lab(lab, white)

    def without(gray: float) -> Array | None:
        return xyz_to_spectrum(xyz - gray * white, BANDS, weights)

    # The room ends where no reflectance has the colour that is left.
    low, high = 0.0, float(np.min(xyz / white))
    for _ in range(ROOM_STEPS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if without(middle) is not None else (low, middle)

    def body_of(gray: float) -> Array:
        left = without(min(gray, low))
        return np.clip(spectrum - gray, 0.0, None) if left is None else left

    # d ln Y / d L* of the cube root: 3 / (L* + 16).
    relative = 3.0 / (float(lab[0]) + 16.0) * colour.lightness_error
    record = {
        "kind": kind, "lab": [float(v) for v in lab], "illuminant": colour.illuminant,
        "geometry": geometry,
    }  # fmt: skip
    return Colour(BANDS, spectrum, geometry, low, body_of, relative, record, notes)


def _of_spectrum(colour: ColourReading, geometry: str | None) -> Colour:
    place = printable(colour.file or colour.name, 150)
    factor = np.asarray(colour.radiance_factor, dtype=np.float64)
    notes = list(colour.notes)
    stated = colour.geometry
    if geometry is not None and stated is not None and geometry != stated:
        notes.append(f"{place}: states the geometry {stated}; it is taken as {geometry}, as asked")
    if geometry is None and stated is None:
        notes.append(
            f"{place}: does not state its geometry; it is taken as {AT_45_0}; for a sphere give "
            "--measured d-8-sci or d-8-sce"
        )
    where = geometry or stated or AT_45_0
    largest = float(np.max(factor))
    if not np.all(np.isfinite(factor)) or float(np.min(factor)) < -0.02:
        raise InputError(f"{place}: expected radiance factors of at least 0")
    if largest > LARGEST_FACTOR:
        raise InputError(
            f"{place}: a radiance factor of {largest:.3g} is no surface's; "
            "if the values are percent, divide them by 100"
        )
    factor = np.maximum(factor, 0.0)
    y = max(float(luminous_weights(colour.bands) @ factor), 1e-4)
    lightness = 116.0 * math.cbrt(y) - 16.0
    relative = min(3.0 / (max(lightness, 0.0) + 16.0) * LIGHTNESS_ERROR, 0.5)
    record = {"kind": "spectrum", "name": colour.name, "file": colour.file, "geometry": where}
    return Colour(
        colour.bands, factor, where, float(np.min(factor)),
        lambda gray: np.clip(factor - gray, 0.0, None), relative, record, tuple(notes),
    )  # fmt: skip
