"""Display: the monitor that a picture is for, as a scene declares it."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

from relgloss_view.base.errors import InputError
from relgloss_view.base.parameters import Checked, choice, file_name, parameter
from relgloss_view.display.seen import ABSOLUTE, SEEN_WHITES

TRANSFERS = ("srgb", "gain-offset-gamma")
GAMUTS = ("chroma", "clip")  #: reduce chroma at held L* and hue, or cut RGB
EDGES = ("sampled", "smooth")  #: of silhouettes: what a pixel's sample meets, or its share
DITHERS = ("none", "ordered")
MIN_GAMUT_AREA = 1e-3  #: twice the triangle's area in the xy diagram; sRGB has 0.22
#: Of a primary in white's chromaticity. Without it the primary adds no light, and no RGB has an
#: inverse; sRGB's least share, red's, is 0.21.
MIN_SHARE_OF_WHITE = 1e-6
USUAL_CD_M2 = 100.0  #: luminance of a white of which nothing is known
#: Of white. A black of more leaves no range in which a picture could be shown.
MOST_BLACK = 0.99


def _is_table(value: object, rows: int) -> bool:
    return isinstance(value, tuple) and len(value) == rows


def _is_xy(value: object) -> bool:
    """Whether a value is a chromaticity that a light can have."""
    if not (isinstance(value, tuple) and len(value) == 2):
        return False
    if any(isinstance(v, bool) or not isinstance(v, int | float) for v in value):
        return False
    x, y = value
    return bool(x >= 0.0 and y > 0.0 and x + y <= 1.0)


def check_black(black_cd_m2: float, luminance_cd_m2: float, *, known: bool) -> None:
    """InputError where a display's white is hardly brighter than its black.

    known: whether the luminance of white is stated somewhere.

    >>> check_black(120.0, 100.0, known=False)
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: display.black_cd_m2: expected less than 99 % of white, \
which is assumed to have 100 cd/m2 (display.luminance_cd_m2 states it), found 120
    """
    if black_cd_m2 > MOST_BLACK * luminance_cd_m2:
        has = f"has {luminance_cd_m2:g} cd/m2"
        if not known:
            has = f"is assumed to {has.replace('has', 'have')} (display.luminance_cd_m2 states it)"
        raise InputError(
            f"display.black_cd_m2: expected less than {100 * MOST_BLACK:g} % of white, which "
            f"{has}, found {black_cd_m2:g}"
        )


@dataclass(frozen=True)
class Display(Checked):
    """The monitor, whose white shows L* = 100.

    transfer: 'srgb' (IEC 61966-2-1:1999), or 'gain-offset-gamma' (Berns 1996).
    gain, offset, gamma, flare: light = (gain d + offset)^gamma + flare of a digital value d from 0
    to 1; gain 0.1 to 10, offset -0.5 to 0.5, gamma 0.5 to 5, flare 0 to 0.2.
    gamut: 'chroma' reduces the chroma of colours that the monitor can't show, 'clip' cuts RGB.
    primaries_xy, white_xy: CIE 1931 chromaticities.
    background_lstar: L* of the neutral surround, 0 to 100.
    pixel_pitch_mm: from one pixel to the next, 0.01 to 100 mm. viewing_distance_m: from the monitor
    to the observer, 0.05 to 100 m. How large a grain is at the eye follows from both.
    edges: 'sampled', a pixel shows what its sample meets, or 'smooth', the share of it that the
    object covers. dither: of 8-bit values, 'none' or 'ordered'.

    profile: a file that says what the monitor shows: an ICC profile, or a display file. It takes
    the place of transfer, gain, offset, gamma, flare and chromaticities. "" where those say it.
    luminance_cd_m2: of white, as an instrument on the screen reads it; None where the profile says
    it, or nobody knows (USUAL_CD_M2). black_cd_m2: what the monitor emits at digital 0; None where
    the profile says it, or offset and flare do. reflected_cd_m2: light of the room that the screen
    reflects, everywhere; it adds to both (DisplayModel). seen_on: a file like `profile`, of
    another monitor: this one shows what that one would. seen_white: in the same cd/m2, or so that
    the other's white just fits.

    Edges and dither change digital values only: no measured number, and no 16-bit value by dither.
    `for_the_eye` has both. Raises InputError where a value is out of its range, the primaries lie
    on a line, or a declared white is hardly brighter than black. A white that is not declared is
    compared with black when a setup is made.

    >>> Display(transfer="gain-offset-gamma", gamma=2.4).white_xy
    (0.3127, 0.329)
    >>> Display(gamma=7.0)
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: display.gamma: expected 0.5 to 5, found 7.0
    """

    transfer: str = choice("srgb", TRANSFERS, "how RGB becomes light")
    gamut: str = choice(
        "chroma",
        GAMUTS,
        "chroma: reduces the chroma of colours that the display can't show; clip: cuts RGB",
        label="Out-of-gamut colours",
    )
    gain: float = parameter(1.0, 0.1, 10.0, "", "light = (gain d + offset)^gamma + flare")
    offset: float = parameter(0.0, -0.5, 0.5, "", "see gain")
    gamma: float = parameter(2.2, 0.5, 5.0, "", "see gain")
    flare: float = parameter(0.0, 0.0, 0.2, "", "see gain")
    primaries_xy: tuple[tuple[float, float], ...] = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06))
    white_xy: tuple[float, float] = (0.3127, 0.3290)
    background_lstar: float = parameter(
        50.0,
        0.0,
        100.0,
        "L*",
        "lightness of the neutral surround of the pictures",
        label="Surround lightness (L*)",
    )
    pixel_pitch_mm: float = parameter(
        0.27, 0.01, 100.0, "mm", "from one pixel of the monitor to the next", label="Pixel pitch"
    )
    viewing_distance_m: float = parameter(
        0.6, 0.05, 100.0, "m", "from the monitor to the observer", label="Viewing distance"
    )

    edges: str = choice(
        "sampled",
        EDGES,
        "smooth: a pixel at the silhouette shows the share of it that the object covers; "
        "sampled: what its centre meets",
        option="--edges",
        label="Silhouettes",
        later=True,
    )
    dither: str = choice(
        "none",
        DITHERS,
        "ordered: half a step of 8 bits is added or taken away, so that gradients show no bands",
        option="--dither",
        label="Dither",
        later=True,
    )

    profile: str = file_name(
        "",
        "what the monitor shows: an ICC profile, or a display file that `relgloss display` wrote",
        option="--display",
        label="Profile of the display",
    )
    luminance_cd_m2: float | None = parameter(
        None, 1.0, 10000.0, "cd/m2", "luminance of the display's white", label="Display white"
    )
    black_cd_m2: float | None = parameter(
        None, 0.0, 1000.0, "cd/m2", "luminance of the display's black", label="Display black"
    )
    reflected_cd_m2: float = parameter(
        0.0,
        0.0,
        10000.0,
        "cd/m2",
        "light of the room that the screen reflects",
        label="Reflected light",
        later=True,
    )
    seen_on: str = file_name(
        "",
        "another display, whose picture is shown on this one: an ICC profile or a display file",
        option="--seen-on",
        label="Seen on",
    )
    seen_white: str = choice(
        ABSOLUTE,
        SEEN_WHITES,
        "how bright the other display of --seen-on is shown. absolute: in the same cd/m2; matched: "
        "so that its white just fits into this display's",
        option="--seen-white",
        label="The other's white",
        later=True,
    )

    @property
    def pixel_arcmin(self) -> float:
        """Angle of a pixel at the observer's eye, minutes of arc.

        >>> round(Display().pixel_arcmin, 3)
        1.547
        """
        return 60.0 * math.degrees(math.atan2(1e-3 * self.pixel_pitch_mm, self.viewing_distance_m))

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.gain + self.offset <= 0.0 or max(self.offset, 0.0) >= self.gain + self.offset:
            raise InputError(
                f"display.gain {self.gain:g} with display.offset {self.offset:g}: white is no "
                "brighter than black; expected gain + offset above 0 and above offset"
            )
        if not (_is_table(self.primaries_xy, 3) and all(_is_xy(xy) for xy in self.primaries_xy)):
            raise InputError(
                "display.primaries_xy: expected three chromaticities, as [[x, y], ...]"
            )
        if not _is_xy(self.white_xy):
            raise InputError("display.white_xy: expected a chromaticity, as [x, y]")
        (rx, ry), (gx, gy), (bx, by) = self.primaries_xy
        area = (gx - rx) * (by - ry) - (bx - rx) * (gy - ry)
        if abs(area) < MIN_GAMUT_AREA:
            raise InputError("display.primaries_xy: the three primaries lie on a line")
        if min(map(abs, self._shares_of_white(area))) < MIN_SHARE_OF_WHITE:
            raise InputError(
                "display.white_xy: lies on the line through two primaries, so that the third one "
                "would be black; expected a white between the three"
            )
        if self.black_cd_m2 is not None and self.luminance_cd_m2 is not None:
            check_black(self.black_cd_m2, self.luminance_cd_m2, known=True)

    def _shares_of_white(self, area: float) -> tuple[float, float, float]:
        """Where the white lies in the triangle of the primaries, in barycentric coordinates."""
        (rx, ry), (gx, gy), (bx, by) = self.primaries_xy
        x, y = self.white_xy
        red = ((gx - x) * (by - y) - (bx - x) * (gy - y)) / area
        green = ((bx - x) * (ry - y) - (rx - x) * (by - y)) / area
        return red, green, 1.0 - red - green

    def for_the_eye(self) -> Display:
        """The display with smooth silhouettes and dither, as new pictures are shown.

        Scene files, studies and grids keep the values of their own, so that their pixels stay.
        """
        return dataclasses.replace(self, edges="smooth", dither="ordered")
