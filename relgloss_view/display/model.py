"""The numbers of a display that both renderers use."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np

from relgloss_view.base.arrays import Array, Floats
from relgloss_view.display.display import USUAL_CD_M2, Display, check_black
from relgloss_view.display.monitor import Emission, Monitor, with_black
from relgloss_view.display.read import monitor_of
from relgloss_view.display.seen import SeenOn, between
from relgloss_view.material import cielab
from relgloss_view.material.spectra import rgb_to_xyz_matrix, white_from_xy


@dataclass(frozen=True)
class DisplayModel:
    """A display in numbers. Arrays are shared, and not to be written to.

    What reaches the eye is the sum of three lights, in cd/m2: what the pixels add to black, the
    black that the screen emits at digital 0, and the light of the room that the screen reflects.
    The luminance of white that a scene or a file states is what an instrument on the screen reads:
    black and pixels at digital 1, nothing reflected. So white shows L_w + R, black shows B + R, and
    digital values d show

        XYZ(d) = luminance_cd_m2 * xyz_from_rgb @ (floor + (1 - floor) * transfer(d)),

    with luminance_cd_m2 = L_w + R. Reflected light has the colour of the display's white, as that
    of a room whose lamps the observer is adapted to; a declared black has it too. CIE 122-1996,
    3.2.2 (offset and flare); IEC 61966-4:2000 (reflected light adds).

    Linear RGB is light relative to white, black and reflected light included.
    """

    white: Array  #: XYZ, Y = 1
    xyz_from_rgb: Array  #: (3, 3)
    rgb_from_xyz: Array  #: (3, 3)
    transfer: str  #: 'srgb', 'gain-offset-gamma', 'curves' or 'table'
    gamut: str
    curve: tuple[float, float, float, float]  #: gain, offset, gamma, flare
    background_light: float  #: of the surround as it is declared: linear, relative to white
    #: (3,) linear RGB under what the transfer gives: light = floor + (1 - floor) transfer. Below 0
    #: where the declared black is darker than that of gain, offset and flare.
    floor: Array = field(default_factory=lambda: np.zeros(3))
    darkest: Array = field(default_factory=lambda: np.zeros(3))  #: (3,) linear RGB at digital 0
    #: (3,) at which linear RGB is cut from below: `darkest`, but 0 where gain, offset and flare
    #: alone make it. Their pictures mix edges with light that was not cut, and keep their pixels.
    lowest: Array = field(default_factory=lambda: np.zeros(3))
    luminance_cd_m2: float = USUAL_CD_M2  #: of white, reflected light included
    emission: Emission | None = None  #: of 'curves' and 'table'
    monitor: Monitor | None = None  #: that a file describes
    screen: DisplayModel | None = None  #: the display that shows what this one would
    screen_from_rgb: Array | None = None  #: (3, 3), from this one's linear RGB to the screen's
    luminance_known: bool = False  #: else it is USUAL_CD_M2
    black_known: bool = False  #: else what black shows is only what is reflected
    reflected_cd_m2: float = 0.0  #: light of the room in both of these
    seen: SeenOn | None = None  #: how the screen shows this one; without a screen: as it is
    #: Digital values of single lights, which the window asks for in every frame: a table takes
    #: milliseconds to invert.
    held: dict[object, tuple[float, ...]] = field(
        init=False, default_factory=dict, repr=False, compare=False
    )

    @property
    def background_rgb(self) -> Array:
        """(3,), linear RGB of the surround as the display shows it."""
        return np.maximum(self.background_light, self.lowest)

    @cached_property
    def fills_cube(self) -> bool:
        """Whether digital values show all linear RGB from black to white; a table may not."""
        if self.emission is None or self.emission.kind == "curves":
            return True
        axis = np.linspace(0.0, 1.0, 9)
        nodes = np.stack(np.meshgrid(axis, axis, axis), axis=-1).reshape(-1, 3)
        return bool(np.all(self.emission.reach(nodes)))

    @property
    def black_cd_m2(self) -> float:
        """Luminance at digital 0, reflected light included."""
        return float(self.luminance_cd_m2 * (self.xyz_from_rgb[1] @ self.darkest))

    def light(self, digital: Array) -> Array:
        """Linear RGB (N, 3) that the display shows of its digital values (N, 3), 0 to 1.

        Sources: IEC 61966-2-1:1999 for sRGB, Berns 1996 for gain, offset and gamma.

        >>> gray = DisplayModel.of(Display()).light(np.full((1, 3), 0.5))
        >>> gray.round(4).tolist()
        [[0.214, 0.214, 0.214]]
        """
        if self.emission is not None:
            of_pixels = self.emission.light(digital)
        elif self.transfer == "srgb":
            of_pixels = cielab.srgb_decoded(digital)
        else:
            gain, offset, gamma, flare = self.curve
            bent = np.maximum(gain * digital + offset, 0.0) ** gamma
            of_pixels = (bent + flare) / ((gain + offset) ** gamma + flare)
        return np.asarray(self.floor + (1.0 - self.floor) * of_pixels)

    def xyz(self, digital: Array) -> Array:
        """XYZ (N, 3) of digital values (N, 3), relative to white at Y = 1."""
        return np.asarray(self.light(digital) @ self.xyz_from_rgb.T)

    @classmethod
    def of(cls, display: Display) -> DisplayModel:
        """Derive the numbers from the declared display; the same object while its files stay."""
        monitor = monitor_of(display.profile) if display.profile else None
        other = monitor_of(display.seen_on) if display.seen_on else None
        if monitor is None and other is None:
            return _declared(display)
        return _model_of(display, monitor, other)

    @classmethod
    def emitted(cls, display: Display) -> DisplayModel:
        """What the screen itself emits, as profiles have it: without the light of the room."""
        monitor = monitor_of(display.profile) if display.profile else None
        if monitor is not None and monitor.reflected_cd_m2:
            monitor = dataclasses.replace(monitor, reflected_cd_m2=0.0)
        return _model_of(
            dataclasses.replace(display, reflected_cd_m2=0.0, seen_on=""), monitor, None
        )


@lru_cache(maxsize=64)
def _declared(display: Display) -> DisplayModel:
    """Of a display without files, which holds no tables and so is kept longer."""
    return _model_of(display, None, None)


@lru_cache(maxsize=16)
def _model_of(display: Display, monitor: Monitor | None, other: Monitor | None) -> DisplayModel:
    if other is not None:
        return _seen_on(display, monitor, other)
    if monitor is not None:
        display = _with_the_files_own(display, monitor)
    floor, luminance, emission = np.zeros(3), display.luminance_cd_m2, None
    transfer = display.transfer
    curve = (display.gain, display.offset, display.gamma, display.flare)
    if monitor is None:
        white = white_from_xy(display.white_xy)
        xyz_from_rgb = rgb_to_xyz_matrix(display.primaries_xy, display.white_xy)
    else:
        white, xyz_from_rgb, floor = monitor.white, monitor.xyz_from_rgb, monitor.floor
        luminance = luminance or monitor.luminance_cd_m2
        emission, transfer = monitor.emission, monitor.emission.kind
    luminance_known = luminance is not None
    luminance = luminance or USUAL_CD_M2
    own = _black_of_curve(curve) if transfer == "gain-offset-gamma" else 0.0
    if display.black_cd_m2 is not None:
        check_black(display.black_cd_m2, luminance, known=luminance_known)
        share = display.black_cd_m2 / luminance
        xyz_from_rgb, floor = _with_declared_black(xyz_from_rgb, floor, white, share, own)
    if display.reflected_cd_m2:
        reflected = display.reflected_cd_m2 / luminance
        black = (xyz_from_rgb @ floor + reflected * white) / (1.0 + reflected)
        added = xyz_from_rgb * (1.0 - floor) / (1.0 + reflected)
        xyz_from_rgb, floor = with_black(added, black)
        luminance += display.reflected_cd_m2
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
        _kept(darkest if np.any(floor) else np.zeros(3)),
        luminance,
        emission,
        monitor,
        luminance_known=luminance_known,
        black_known=_black_is_known(display, monitor),
        reflected_cd_m2=display.reflected_cd_m2,
    )


def _with_the_files_own(display: Display, monitor: Monitor) -> Display:
    """The display with the black and the reflected light of its file, where the scene has none."""
    return dataclasses.replace(
        display,
        black_cd_m2=monitor.black_cd_m2 if display.black_cd_m2 is None else display.black_cd_m2,
        reflected_cd_m2=display.reflected_cd_m2 or monitor.reflected_cd_m2,
    )


def _black_of_curve(curve: tuple[float, float, float, float]) -> float:
    """What gain, offset, gamma and flare show at digital 0, relative to white."""
    gain, offset, gamma, flare = curve
    return float((max(offset, 0.0) ** gamma + flare) / ((gain + offset) ** gamma + flare))


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


def _with_declared_black(
    xyz_from_rgb: Array, floor: Array, white: Array, share: float, own: float
) -> tuple[Array, Array]:
    """(xyz_from_rgb, floor) of the same display with a neutral black of a share of its white.

    own: what the transfer itself shows at black. White stays as it is, and so do the chromaticities
    of what each channel adds to black.
    """
    added = xyz_from_rgb * (1.0 - floor)
    added = added * np.linalg.solve(added, white * (1.0 - share) / (1.0 - own))
    return with_black(added, white * (share - own) / (1.0 - own))


def _kept(array: Floats) -> Array:
    kept = np.array(array, dtype=np.float64)
    kept.setflags(write=False)
    return kept
