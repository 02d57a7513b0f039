"""Measurement: what an instrument saw, in the sample's frame, and what was left out and why."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from relgloss_view.measure.bands import Bands

Array = NDArray[np.float64]

#: Why a sample is not used. The empty string marks one that is.
KEPT = ""
NEGATIVE = "negative"
MISSING = "missing"
SATURATED = "saturated"
OCCLUDED = "lamp and receiver within 8 degrees"
GRAZING = "within 3 degrees of the horizon"
BELOW = "below the horizon"


@dataclass(frozen=True)
class Measurement:
    """Reflectance of one flat sample over directions and bands.

    Directions are unit vectors in the sample frame (normal +z) that point away from the sample.
    """

    name: str
    source: str  #: file, instrument; 'synthetic' where nothing was measured
    to_lamp: Array  #: (N, 3) unit vectors
    to_receiver: Array  #: (N, 3) unit vectors
    bands: Bands
    radiance_factor: Array  #: (N, B), pi times the BRDF; may hold NaN where the sample is left out
    reasons: NDArray[np.str_]  #: (N,), KEPT or why the sample is left out
    #: (N,), samples that share a plane or a setting of the lamp; validation leaves whole groups out
    group: NDArray[np.int64]
    #: (e_i, e_o): per-axis angular standard deviations of lamp and receiver apertures, degrees
    aperture_sd_deg: tuple[float, float] = (0.0, 0.0)
    gamma_s_deg: float | None = None  #: tilt at which a GCMS table sees the mirror direction
    warnings: tuple[str, ...] = ()
    file: str = ""  #: where it was read from

    @property
    def place(self) -> str:
        """The file, or the name where there is none: what a message about it begins with."""
        return self.file or self.name

    @property
    def kept(self) -> NDArray[np.bool_]:
        """(N,), which samples are used."""
        return np.asarray(self.reasons == KEPT)

    def left_out(self) -> dict[str, int]:
        """How many samples were left out for each reason."""
        return dict(Counter(str(r) for r in self.reasons if r != KEPT))
