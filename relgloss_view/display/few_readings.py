"""Luminance and black of a profile's monitor from a few readings, and how well they agree."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.errors import InputError
from relgloss_view.display.display import USUAL_CD_M2
from relgloss_view.display.monitor import Monitor, with_black
from relgloss_view.display.readings import Readings
from relgloss_view.material.cielab import lab_from_xyz
from relgloss_view.material.difference import delta_e_2000

MOST_BLACK = 0.999  #: share of white
AT_END = 1e-3  #: how near to 0 or 1 digital values of black and white are
#: Mean dE2000 from which readings are of another monitor than the profile's, or of one that has
#: changed: twice what two instruments of one kind differ by on displays (about 1.5).
OF_ANOTHER = 3.0


@dataclass(frozen=True)
class Agreement:
    """A profile beside readings: dE2000 relative to white, mean and largest, and where that is."""

    patches: int
    mean: float
    largest: float
    place: str
    luminance_cd_m2: float | None
    black_cd_m2: float | None

    @property
    def agrees(self) -> bool:
        """Whether the profile describes the readings."""
        return self.mean < OF_ANOTHER


def with_readings(monitor: Monitor, readings: Readings) -> tuple[Monitor, Agreement]:
    """The monitor with the luminance and black of readings, and how well it agrees with them.

    Raises InputError where no reading is of white.
    """
    white = _white(readings)
    black = _mean(readings, np.all(readings.rgb <= AT_END, axis=1))
    luminance = float(white[1]) if readings.absolute else monitor.luminance_cd_m2
    black_cd_m2 = None
    if black is not None and luminance is not None:
        black_cd_m2 = max(float(black[1] / white[1]), 0.0) * luminance
    changed = dataclasses.replace(
        monitor,
        luminance_cd_m2=luminance,
        black_cd_m2=monitor.black_cd_m2 if black_cd_m2 is None else black_cd_m2,
        black_known=monitor.black_known or black_cd_m2 is not None,
    )
    apart = _differences(with_own_black(changed), readings, white)
    worst = int(np.argmax(apart))
    return changed, Agreement(
        readings.count,
        float(apart.mean()),
        float(apart[worst]),
        readings.places[worst],
        luminance,
        black_cd_m2,
    )


def with_own_black(monitor: Monitor) -> Monitor:
    """The monitor whose model shows the black that its display file sets, where it sets one."""
    if monitor.black_cd_m2 is None:
        return monitor
    luminance = monitor.luminance_cd_m2 or USUAL_CD_M2
    black = monitor.white * min(monitor.black_cd_m2 / luminance, MOST_BLACK)
    added = monitor.xyz_from_rgb * (1.0 - monitor.floor)
    added = added * np.linalg.solve(added, monitor.white - black)  # white stays what it is
    xyz_from_rgb, floor = with_black(added, black)
    return dataclasses.replace(monitor, xyz_from_rgb=xyz_from_rgb, floor=floor, black_cd_m2=None)


def differences(monitor: Monitor, readings: Readings) -> Array:
    """dE2000 (N,) between readings and what a monitor shows, relative to white. InputError."""
    return _differences(monitor, readings, _white(readings))


def _differences(monitor: Monitor, readings: Readings, white: Array) -> Array:
    read = lab_from_xyz(readings.xyz / white[1], monitor.white)
    return delta_e_2000(read, lab_from_xyz(monitor.xyz(readings.rgb), monitor.white))


def _white(readings: Readings) -> Array:
    white = _mean(readings, np.all(readings.rgb >= 1.0 - AT_END, axis=1))
    if white is None or white[1] <= 0.0:
        raise InputError(
            f"{readings.source}: no reading of white (R, G and B at their largest); measure white "
            "and black at least"
        )
    return white


def _mean(readings: Readings, patches: Mask) -> Array | None:
    """XYZ (3,) of several readings of one patch; None without any."""
    return np.asarray(readings.xyz[patches].mean(axis=0)) if np.any(patches) else None
