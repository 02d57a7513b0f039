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
from relgloss_view.display.seen import SeenOn, between
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
    luminance_known: bool = False
    black_known: bool = False
    seen: SeenOn | None = None  #: how the screen shows this one; without a screen: as it is

    @classmethod
    def of(cls, display: Display) -> DisplayModel:
        """Derive the numbers from the declared display; the same object while its files stay."""
        monitor = monitor_of(display.profile) if display.profile else None
        other = monitor_of(display.seen_on) if display.seen_on else None
        if monitor is None and other is None:
            return _declared(display)
        return _model_of(display, monitor, other)


@lru_cache(maxsize=64)
def _declared(display: Display) -> DisplayModel:
    """Of a display without files, which holds no tables and so is kept longer."""
    return _model_of(display, None, None)


@lru_cache(maxsize=16)
def _model_of(display: Display, monitor: Monitor | None, other: Monitor | None) -> DisplayModel:
    if other is not None:
        return _seen_on(display, monitor, other)
    floor, luminance, emission = np.zeros(3), display.luminance_cd_m2, None
    transfer = display.transfer
    if monitor is None:
        white = white_from_xy(display.white_xy)
        xyz_from_rgb = rgb_to_xyz_matrix(display.primaries_xy, display.white_xy)
    else:
        white, xyz_from_rgb, floor = monitor.white, monitor.xyz_from_rgb, monitor.floor
        luminance = luminance or monitor.luminance_cd_m2
        emission, transfer = monitor.emission, monitor.emission.kind
    luminance_known = luminance is not None
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
        luminance_known=luminance_known,
        black_known=_black_is_known(display, monitor),
    )


def _black_is_known(display: Display, monitor: Monitor | None) -> bool:
    if display.black_cd_m2 is not None or display.reflected_cd_m2 > 0.0:
        return True
    if monitor is None:
        return display.transfer == "gain-offset-gamma"
    return monitor.black_known


def _seen_on(display: Display, monitor: Monitor | None, other: Monitor) -> DisplayModel:
    """The model of the other display, with the screen that shows it."""
    own = dataclasses.replace(display, seen_on="", seen_white=Display.seen_white)
    of_other = dataclasses.replace(
        own, profile=display.seen_on, luminance_cd_m2=None, black_cd_m2=None, reflected_cd_m2=0.0
    )
    screen, seen = _model_of(own, monitor, None), _model_of(of_other, other, None)
    luminances = (
        seen.luminance_cd_m2 if seen.luminance_known else None,
        screen.luminance_cd_m2 if screen.luminance_known else None,
    )
    matrix, how, scale = between(
        seen.xyz_from_rgb, screen.rgb_from_xyz, *luminances, display.seen_white
    )
    blacks = [float(m.xyz_from_rgb[1] @ m.darkest) for m in (seen, screen)]
    known = seen.black_known, screen.black_known
    facts = SeenOn(other.name, how, scale, *luminances, blacks[0], blacks[1], known)
    if _same(own, monitor, other):
        return dataclasses.replace(screen, seen=facts)
    return dataclasses.replace(seen, screen=screen, screen_from_rgb=_kept(matrix), seen=facts)


def _same(own: Display, monitor: Monitor | None, other: Monitor) -> bool:
    """Whether the other display is this one, so that nothing is to be carried over."""
    declared = own.luminance_cd_m2, own.black_cd_m2, own.reflected_cd_m2
    return monitor is other and declared == (None, None, 0.0)


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
