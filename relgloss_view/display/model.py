"""The numbers of a display that both renderers use."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array, Floats
from relgloss_view.display.display import USUAL_CD_M2, Display
from relgloss_view.display.monitor import Emission, Monitor, with_black
from relgloss_view.display.read import monitor_of
from relgloss_view.material import cielab
from relgloss_view.material.spectra import rgb_to_xyz_matrix, white_from_xy


@dataclass(frozen=True)
class DisplayModel:
    """A display in numbers. Arrays are shared, and not to be written to.

    Linear RGB is light relative to white, black included. A screen shows no less than `darkest`.
    """

    white: Array  #: XYZ, Y = 1
    xyz_from_rgb: Array  #: (3, 3)
    rgb_from_xyz: Array  #: (3, 3)
    transfer: str  #: 'srgb', 'gain-offset-gamma', 'curves' or 'table'
    gamut: str
    curve: tuple[float, float, float, float]  #: gain, offset, gamma, flare
    background_light: float  #: linear, relative to white
    #: (3,) linear RGB under what the transfer gives: light = floor + (1 - floor) transfer.
    floor: Array = field(default_factory=lambda: np.zeros(3))
    darkest: Array = field(default_factory=lambda: np.zeros(3))  #: (3,) linear RGB at black
    luminance_cd_m2: float = USUAL_CD_M2  #: of white
    emission: Emission | None = None  #: of 'curves' and 'table'
    monitor: Monitor | None = None  #: that a file describes
    screen: DisplayModel | None = None  #: the display that shows what this one would
    screen_from_rgb: Array | None = None  #: (3, 3), from this one's linear RGB to the screen's

    @classmethod
    def of(cls, display: Display) -> DisplayModel:
        """Derive the numbers from the declared display; the same object while its files stay."""
        monitor = monitor_of(display.profile) if display.profile else None
        other = monitor_of(display.seen_on) if display.seen_on else None
        return _model_of(display, monitor, other)


@lru_cache(maxsize=16)
def _model_of(display: Display, monitor: Monitor | None, other: Monitor | None) -> DisplayModel:
    if other is not None:
        screen = _model_of(dataclasses.replace(display, seen_on=""), monitor, None)
        plain = dataclasses.replace(
            display,
            seen_on="",
            profile=display.seen_on,
            luminance_cd_m2=None,
            black_cd_m2=None,
            reflected_cd_m2=0.0,
        )
        seen = _model_of(plain, other, None)
        brighter = seen.luminance_cd_m2 / screen.luminance_cd_m2
        matrix = _kept(brighter * screen.rgb_from_xyz @ seen.xyz_from_rgb)
        return dataclasses.replace(seen, screen=screen, screen_from_rgb=matrix)
    if monitor is not None:
        display = _with_the_files_own(display, monitor)
    floor, luminance, emission = np.zeros(3), display.luminance_cd_m2, None
    transfer = display.transfer
    if monitor is None:
        white = white_from_xy(display.white_xy)
        xyz_from_rgb = rgb_to_xyz_matrix(display.primaries_xy, display.white_xy)
    else:
        white, xyz_from_rgb, floor = monitor.white, monitor.xyz_from_rgb, monitor.floor
        luminance = luminance or monitor.luminance_cd_m2
        emission, transfer = monitor.emission, monitor.emission.kind
    luminance = luminance or USUAL_CD_M2
    if display.black_cd_m2 is not None or display.reflected_cd_m2:
        xyz_from_rgb, floor, white, luminance = _with_more_black(
            display, xyz_from_rgb, floor, white, luminance
        )
    curve = (display.gain, display.offset, display.gamma, display.flare)
    darkest = floor
    if transfer == "gain-offset-gamma":
        gain, offset, gamma, flare = curve
        own = (max(offset, 0.0) ** gamma + flare) / ((gain + offset) ** gamma + flare)
        darkest = floor + (1.0 - floor) * own
    background = float(cielab.ratio_of_f(np.array((display.background_lstar + 16.0) / 116.0)))
    return DisplayModel(
        _kept(white),
        _kept(xyz_from_rgb),
        _kept(np.linalg.inv(xyz_from_rgb)),
        transfer,
        display.gamut,
        curve,
        background,
        _kept(floor),
        _kept(darkest),
        luminance,
        emission,
        monitor,
    )


def _with_the_files_own(display: Display, monitor: Monitor) -> Display:
    """The display with the black and the reflected light of its file, where the scene has none."""
    return dataclasses.replace(
        display,
        black_cd_m2=monitor.black_cd_m2 if display.black_cd_m2 is None else display.black_cd_m2,
        reflected_cd_m2=display.reflected_cd_m2 or monitor.reflected_cd_m2,
    )


def _with_more_black(
    display: Display, xyz_from_rgb: Array, floor: Array, white: Array, luminance: float
) -> tuple[Array, Array, Array, float]:
    """The same with the black and the reflected light that the scene declares, both neutral."""
    black = xyz_from_rgb @ floor
    if display.black_cd_m2 is not None:
        black = white * min(display.black_cd_m2 / luminance, 0.999)
    added = xyz_from_rgb * (1.0 - floor)
    reflected = display.reflected_cd_m2 / luminance
    if display.black_cd_m2 is not None:  # white stays what it is, black included
        added = added * np.linalg.solve(added, white - black)
    total = 1.0 + reflected
    xyz_from_rgb, floor = with_black(added / total, (black + reflected * white) / total)
    return xyz_from_rgb, floor, white, luminance * total


def _kept(array: Floats) -> Array:
    kept = np.array(array, dtype=np.float64)
    kept.setflags(write=False)
    return kept
