"""Bands: the channels that a measurement and a material share."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.reading import numbers_of, refuse

#: No instrument reads reflectance outside; a header in micrometres or picometres falls outside too.
WAVELENGTH_RANGE_NM = (100.0, 3000.0)
FINEST_STEP_NM = 0.5
SRGB, REC2020 = "srgb", "rec2020"
#: Names of the primaries of linear RGB, for people.
PRIMARIES = {SRGB: "linear sRGB", REC2020: "linear Rec. 2020"}


@dataclass(frozen=True)
class Bands:
    """Spectral bands by their centres, or three channels of linear RGB.

    wavelengths_nm: two or more centres in increasing order, nanometres, 100 to 3000, at least 0.5
    apart; None for linear RGB reflectances. Raises InputError for anything else.
    primaries: of linear RGB: 'srgb', or the wider 'rec2020' (ITU-R BT.2020, the same white) for
    colours that have a negative channel in sRGB.

    >>> Bands((400.0, 500.0, 600.0)).labels
    ('400 nm', '500 nm', '600 nm')
    >>> Bands().labels
    ('R', 'G', 'B')
    >>> Bands((500.0, 400.0))
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: wavelengths_nm: expected two or more wavelengths, ...
    """

    wavelengths_nm: tuple[float, ...] | None = None
    primaries: str = SRGB

    def __post_init__(self) -> None:
        if self.primaries not in PRIMARIES:
            refuse("primaries", f"one of {', '.join(PRIMARIES)}", self.primaries)
        if self.wavelengths_nm is None:
            return
        if self.primaries != SRGB:
            refuse("primaries", "none beside wavelengths", self.primaries)
        place = "wavelengths_nm"
        low, high = WAVELENGTH_RANGE_NM
        expected = f"a wavelength in nm, {low:g} to {high:g}"
        centres = numbers_of(self.wavelengths_nm, place, expected, low, high)
        steps = [b - a for a, b in itertools.pairwise(centres)]
        if not steps or min(steps) <= 0.0:
            refuse(place, "two or more wavelengths, increasing", list(centres))
        if min(steps) < FINEST_STEP_NM:
            k = steps.index(min(steps))
            refuse(
                f"{place}[{k + 1}]",
                f"wavelengths at least {FINEST_STEP_NM:g} nm apart",
                list(centres[k : k + 2]),
            )
        object.__setattr__(self, place, centres)

    @property
    def is_rgb(self) -> bool:
        """Whether the channels are linear RGB reflectances."""
        return self.wavelengths_nm is None

    @property
    def count(self) -> int:
        """Number of channels."""
        return 3 if self.wavelengths_nm is None else len(self.wavelengths_nm)

    @property
    def labels(self) -> tuple[str, ...]:
        """A short name for each channel: '550 nm', or 'R', 'G', 'B'."""
        if self.wavelengths_nm is None:
            return ("R", "G", "B")
        return tuple(f"{w:g} nm" for w in self.wavelengths_nm)

    @property
    def words(self) -> str:
        """The channels as people read them, such as '35 bands, 390 to 730 nm'."""
        if self.wavelengths_nm is None:
            return PRIMARIES[self.primaries]
        return f"{self.count} bands, {self.labels[0][:-3]} to {self.labels[-1]}"

    def centres_nm(self) -> Array:
        """The band centres, (B,), nanometres; raises ValueError for linear RGB."""
        if self.wavelengths_nm is None:
            raise ValueError(f"{self.words} channels have no wavelengths")
        return np.asarray(self.wavelengths_nm, dtype=np.float64)


RGB = Bands()
WIDE_RGB = Bands(primaries=REC2020)
