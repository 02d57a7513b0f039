"""Bands: the channels that a measurement and a material share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Bands:
    """Spectral bands by their centres in nanometres, or the three channels of linear sRGB.

    wavelengths_nm is None for linear sRGB; otherwise strictly increasing.
    """

    wavelengths_nm: tuple[float, ...] | None = None

    @property
    def is_rgb(self) -> bool:
        """Whether the channels are linear sRGB reflectances."""
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

    def centres_nm(self) -> NDArray[np.float64]:
        """The band centres as an array; raises ValueError for linear sRGB."""
        if self.wavelengths_nm is None:
            raise ValueError("linear sRGB channels have no wavelengths")
        return np.asarray(self.wavelengths_nm, dtype=np.float64)


RGB = Bands()
