"""The geometry of readings as people who stand at an instrument describe it: angles in a plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.measure.gonio import from_normal
from relgloss_view.measure.table import Measurement

#: Nearer to the normal than this a direction has no azimuth, degrees.
POLE_DEG = 0.01
#: Lamp, normal and receiver count as one plane within this azimuth, degrees.
IN_PLANE_DEG = 0.5


@dataclass(frozen=True)
class Polar:
    """Angles (N,) of lamp and receiver in the sample's frame, degrees."""

    lamp_deg: Array  #: from the normal, 0 to 180
    receiver_deg: Array  #: from the normal, 0 to 180
    #: Between the azimuths of both: 180 on the mirror's side, 0 on the lamp's. 180 where one of
    #: them lies along the normal, because there is no other side then.
    azimuth_deg: Array
    half_deg: Array  #: of the half-vector from the normal

    @classmethod
    def of(cls, measurement: Measurement) -> Polar:
        """Those of all rows of a measurement."""
        lamp, receiver = measurement.to_lamp, measurement.to_receiver
        crossed = lamp[:, 0] * receiver[:, 1] - lamp[:, 1] * receiver[:, 0]
        along = lamp[:, 0] * receiver[:, 0] + lamp[:, 1] * receiver[:, 1]
        azimuth = np.degrees(np.arctan2(np.abs(crossed), along))
        lamp_deg, receiver_deg = from_normal(lamp), from_normal(receiver)
        azimuth[np.minimum(lamp_deg, receiver_deg) < POLE_DEG] = 180.0
        return cls(lamp_deg, receiver_deg, azimuth, from_normal(lamp + receiver))

    def subset(self, rows: Mask | Ints) -> Polar:
        """The marked rows."""
        return Polar(
            self.lamp_deg[rows],
            self.receiver_deg[rows],
            self.azimuth_deg[rows],
            self.half_deg[rows],
        )

    @property
    def signed_receiver_deg(self) -> Array:
        """(N,), the receiver's angle, positive on the mirror's side of the normal."""
        return np.where(self.azimuth_deg >= 90.0, self.receiver_deg, -self.receiver_deg)

    @property
    def out_of_plane_deg(self) -> Array:
        """(N,), 0 to 90: azimuth of the receiver from the plane of incidence."""
        return np.minimum(self.azimuth_deg, 180.0 - self.azimuth_deg)

    def words(self, row: int) -> str:
        """One geometry in words.

        >>> at = np.array
        >>> Polar(at([45.0]), at([10.0]), at([0.0]), at([17.5])).words(0)
        'lamp 45, receiver -10 deg'
        """
        words = f"lamp {self.lamp_deg[row]:.4g}, receiver {self.signed_receiver_deg[row]:.4g} deg"
        out = float(self.out_of_plane_deg[row])
        return f"{words}, azimuth {out:.3g} deg out of the plane" if out > IN_PLANE_DEG else words
