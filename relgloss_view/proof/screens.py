"""What is known of the screen that shows a proof, and what follows for the gloss seen on it.

The page draws for sRGB. A screen shows of a signal d, 0 to 1, the light

    b + (1 - b) d^gamma   relative to its white,

b being its black with the light of the room that it reflects (Berns 1996: gain 1, offset 0, flare),
or sRGB's own curve in the place of d^gamma. All here are neutral colours. What the page asks of the
observer bounds b, since a step that is seen, or not seen, excludes darker or brighter blacks.

Twin: page/js/screens.js, with the same names.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.material import cielab

#: Signals of the patches beside black and below white, of 255.
DARK_STEPS = (1, 2, 3, 4, 6, 8, 11, 15, 20, 27, 36, 48)
BRIGHT_STEPS = (254, 253, 252, 251, 249, 247, 244, 240, 235, 228, 219, 207)
#: L* between two large areas side by side: every eye misses less, and no eye misses more. CIE
#: 1976 was scaled for steps of about 1.
UNSEEN_LSTAR, SEEN_LSTAR = 0.3, 1.2
STEP_LSTAR = 1.0  #: between two glosses that an observer tells apart (shown.ORDER_TIE_LSTAR)
LINES_LIGHT = 0.5  #: of a pattern of black and white lines, relative to black and white
REFERENCE_CD_M2 = 100.0  #: of the white on which a step of gloss is STEP_LSTAR
USUAL_WHITES_CD_M2 = (80.0, 1000.0)  #: of displays; both are tried where white is unknown
GAMMA_ERROR = 0.06  #: of a gamma set by eye: two of 255 at the match
MOST_BLACK = 0.99
#: Of the object's pixels, the strongest: a highlight's centre, and more of it. Observers look at
#: either, and compare it with the body there or with all of the body: an order holds only where all
#: of them give it.
HIGHLIGHT_SHARES = (0.002, 0.012)
SRGB_GAMMA_RANGE = (2.0, 2.4)  #: where sRGB's curve and a power are both possible
SURROUNDS = ("", "dark", "office", "bright")
CHANNELS = ("red", "green", "blue")
LONGEST_NAME = 100  #: characters of a screen's name
KEPT, REVERSED, HIDDEN, ALIKE, UNKNOWN = "kept", "reversed", "hidden", "alike", "unknown"
RANK = {KEPT: 0, HIDDEN: 1, REVERSED: 2}  #: the worst verdict on a screen is the verdict


class Case(NamedTuple):
    """A display that a screen may be. gamma: of its signal; 0: sRGB's curve.

    clipped: signals from here on show white, 0 to 1.
    """

    white_cd_m2: float
    black: float
    gamma: float
    clipped: float


class Highlight(NamedTuple):
    """L* of the body at the highlight, and of the highlight, 0 to 100."""

    body: float
    peak: float


@dataclass(frozen=True)
class Screen:
    """What the check found of a screen; None: nobody knows.

    white_cd_m2: of white. black_least, black_most: bounds of black relative to white, room light
    included. gamma: of gray. channels: of red, green and blue. clipped: the brightest signal that
    is told from white, 0 to 1. surround: one of SURROUNDS, the light around the screen. name: of
    its profile, as a system has it; '' from a browser.
    Raises InputError where a value is out of its range.
    """

    white_cd_m2: float | None = None
    black_least: float | None = None
    black_most: float | None = None
    gamma: float | None = None
    channels: tuple[float, float, float] | None = None
    clipped: float | None = None
    surround: str = ""
    name: str = ""

    def __post_init__(self) -> None:
        _check("white_cd_m2", self.white_cd_m2, 1.0, 10000.0)
        _check("black_least", self.black_least, 0.0, MOST_BLACK)
        _check("black_most", self.black_most, 0.0, MOST_BLACK)
        for name, value in (
            ("gamma", self.gamma),
            *zip(CHANNELS, self.channels or (), strict=False),
        ):
            _check(name, value, 0.5, 5.0)
        _check("clipped", self.clipped, 0.5, 1.0)
        if (self.black_least or 0.0) > (MOST_BLACK if self.black_most is None else self.black_most):
            raise InputError("screen: black_least is above black_most")
        if self.surround not in SURROUNDS:
            raise InputError(f"screen.surround: expected one of {SURROUNDS}")
        if len(self.name) > LONGEST_NAME:
            raise InputError(f"screen.name: longer than {LONGEST_NAME} characters")

    @classmethod
    def from_json(cls, content: object) -> Screen:
        """Of a message's `screen`; InputError names what is wrong."""
        names = {f.name for f in dataclasses.fields(cls)}
        if not isinstance(content, Mapping) or not set(content) <= names:
            raise InputError(f"screen: expected entries of {', '.join(sorted(names))}")
        values = dict(content)
        channels = values.get("channels")
        if channels is not None:
            if (
                not isinstance(channels, Sequence)
                or isinstance(channels, str)
                or len(channels) != 3
            ):
                raise InputError("screen.channels: expected three numbers")
            values["channels"] = tuple(channels)
        for name in ("surround", "name"):
            if not isinstance(values.get(name, ""), str):
                raise InputError(f"screen.{name}: expected a text")
        return cls(**values)

    def as_json(self) -> dict[str, Any]:
        """As a message holds it; without a name where it has none, as browsers write it."""
        values = dataclasses.asdict(self)
        if not self.name:
            values.pop("name")
        return {**values, "channels": None if self.channels is None else list(self.channels)}


def _check(name: str, value: object, low: float, high: float) -> None:
    if value is None:
        return
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if not number or not low <= float(value) <= high:  # type: ignore[arg-type]
        raise InputError(f"screen.{name}: expected {low:g} to {high:g}, or null")


def lstar_of(light: float) -> float:
    """CIE L* of light relative to white."""
    if light > cielab.EPSILON:
        return 116.0 * math.cbrt(light) - 16.0
    return cielab.KAPPA * light


def light_of_lstar(lstar: float) -> float:
    """The inverse of lstar_of."""
    f = (lstar + 16.0) / 116.0
    return f**3 if f > 6.0 / 29.0 else (116.0 * f - 16.0) / cielab.KAPPA


def signal_of(light: float) -> float:
    """sRGB's signal, 0 to 1, of linear light, 0 to 1 (IEC 61966-2-1:1999)."""
    light = min(max(light, 0.0), 1.0)
    return 12.92 * light if light <= 0.0031308 else 1.055 * math.pow(light, 1.0 / 2.4) - 0.055


def pixel_light(signal: float, gamma: float) -> float:
    """Light of a signal above black, 0 to 1; gamma 0: by sRGB's curve.

    >>> round(pixel_light(0.5, 2.2), 4), round(pixel_light(0.5, 0.0), 4)
    (0.2176, 0.214)
    """
    if gamma > 0.0:
        return math.pow(signal, gamma)
    return signal / 12.92 if signal <= 0.04045 else math.pow((signal + 0.055) / 1.055, 2.4)


def shown_light(signal: float, case: Case) -> float:
    """Light of a signal on a display, relative to its white."""
    pixel = 1.0 if signal >= case.clipped else pixel_light(signal, case.gamma)
    return case.black + (1.0 - case.black) * pixel


def pattern_gamma(signal: float) -> float:
    """gamma of a screen whose solid gray of this signal is as bright as lines of black and white.

    Black counts in both and cancels: b + (1 - b) d^gamma = (1 + b) / 2.

    >>> round(pattern_gamma(186 / 255), 2), round(pattern_gamma(signal_of(0.5)), 2)
    (2.2, 2.25)
    """
    return math.log(LINES_LIGHT) / math.log(signal)


def dark_step(signal: float, black: float, gamma: float) -> float:
    """L* between a patch of a signal and the black ground beside it."""
    return lstar_of(black + (1.0 - black) * pixel_light(signal, gamma)) - lstar_of(black)


def black_of_step(signal: float, step_lstar: float, gamma: float) -> float:
    """The black on which a patch of a signal differs from the ground by a step of L*.

    0 where it differs by less on any black; MOST_BLACK where it differs by more on all.
    """
    if dark_step(signal, 0.0, gamma) <= step_lstar:
        return 0.0
    if dark_step(signal, MOST_BLACK, gamma) >= step_lstar:
        return MOST_BLACK
    low, high = 0.0, MOST_BLACK
    for _ in range(60):  # more light below makes each step smaller
        middle = 0.5 * (low + high)
        if dark_step(signal, middle, gamma) > step_lstar:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def black_bounds(first_seen: int, gammas: Sequence[float]) -> tuple[float, float]:
    """(least, most) black, when first_seen is the darkest of DARK_STEPS that is seen.

    first_seen: an index; len(DARK_STEPS) where no patch is seen. gammas: that are possible.
    """
    least, most = MOST_BLACK, 0.0
    for gamma in gammas:
        low, high = 0.0, MOST_BLACK
        if first_seen > 0:
            low = black_of_step(DARK_STEPS[first_seen - 1] / 255.0, SEEN_LSTAR, gamma)
        if first_seen < len(DARK_STEPS):
            high = black_of_step(DARK_STEPS[first_seen] / 255.0, UNSEEN_LSTAR, gamma)
        least, most = min(least, low), max(most, high)
    return min(least, most), most


def clipped_from(first_seen: int) -> float:
    """The signal from which a screen shows white, when first_seen of BRIGHT_STEPS is seen.

    first_seen: an index, the brightest patch that is told from white; len(BRIGHT_STEPS) where none
    is. 1 where the patches before it are too near white for any eye.
    """
    if first_seen == 0:
        return 1.0
    unseen = BRIGHT_STEPS[first_seen - 1] / 255.0
    if 100.0 - lstar_of(pixel_light(unseen, 0.0)) < SEEN_LSTAR:
        return 1.0
    return unseen


def possible_gammas(gamma: float | None) -> tuple[float, ...]:
    """Gammas that a screen may have, of one that was set by eye; 0 is sRGB's curve.

    >>> possible_gammas(None), possible_gammas(1.8)
    ((0.0,), (1.74, 1.86))
    """
    if gamma is None:
        return (0.0,)
    near = (gamma - GAMMA_ERROR, gamma + GAMMA_ERROR)
    low, high = SRGB_GAMMA_RANGE
    return (*near, 0.0) if low <= gamma <= high else near


def cases(screen: Screen) -> tuple[Case, ...]:
    """The displays that a screen may be, at the ends of what is known; () without its black."""
    if screen.black_least is None or screen.black_most is None:
        return ()
    whites = USUAL_WHITES_CD_M2 if screen.white_cd_m2 is None else (screen.white_cd_m2,)
    blacks = (screen.black_least, screen.black_most)
    clipped = 1.0 if screen.clipped is None else screen.clipped
    return tuple(
        Case(white, black, gamma, clipped)
        for white in whites
        for black in blacks
        for gamma in possible_gammas(screen.gamma)
    )


def highlights_of(l_d: Array, l_s: Array, c: float) -> tuple[Highlight, ...]:
    """The highlight of a picture as observers may see it: means over its strongest pixels.

    For each of HIGHLIGHT_SHARES the pixels with the largest L_s*, over the body there; then the
    brightest pixels, over the picture's median (as shown.contrast_gloss). l_d, l_s: (N,) of the
    object's pixels. c: with the pair's common factor. () without pixels. Single grains don't decide
    it, as they would decide the brightest pixel.
    """
    count = len(l_s)
    if count == 0:
        return ()
    seen = np.minimum(l_d + c * l_s, 100.0)
    by_gloss, by_lightness = (np.argsort(v, kind="stable") for v in (l_s, seen))
    usual = float(seen[by_lightness[count // 2]])
    found, whole = [], []
    for share in HIGHLIGHT_SHARES:
        first = count - max(1, round(share * count))
        strongest, brightest = by_gloss[first:], by_lightness[first:]
        found.append(Highlight(float(np.mean(l_d[strongest])), float(np.mean(seen[strongest]))))
        whole.append(Highlight(usual, float(np.mean(seen[brightest]))))
    return (*found, *whole)


def gloss_shown(highlight: Highlight, case: Case) -> float:
    """What a highlight adds on a display: a difference of L*, times the cube root of its white.

    Cube roots of cd/m2 after Pellacini, Ferwerda and Greenberg 2000 (docs/display.md); the L* of
    the display itself on a white of REFERENCE_CD_M2.

    >>> round(gloss_shown(Highlight(50.0, 80.0), Case(100.0, 0.0, 0.0, 1.0)), 6)
    30.0
    """
    body, peak = (
        lstar_of(shown_light(signal_of(light_of_lstar(lstar)), case)) for lstar in highlight
    )
    return (peak - body) * math.pow(case.white_cd_m2 / REFERENCE_CD_M2, 1.0 / 3.0)


class Order(NamedTuple):
    """The verdict on one display.

    kind: KEPT, REVERSED, HIDDEN, ALIKE or UNKNOWN. side: whose highlight loses most, 'reference'
    or 'test'. cause: 'black', 'white', 'clipped' or 'gamma', '' where nothing is lost. black: that
    the verdict is for, relative to white.
    """

    kind: str
    side: str = ""
    cause: str = ""
    black: float = 0.0


def order_of_gloss(
    reference: Sequence[Highlight], test: Sequence[Highlight], screen: Screen
) -> Order:
    """Whether a screen keeps the order of two glosses as it was designed.

    reference, test: of highlights_of. The order is kept where it is kept on each display that the
    screen may be, for the highlight's centre as for all of it. ALIKE: there is no clear order.
    """
    pairs = list(zip(reference, test, strict=True))
    designed = [(p.peak - p.body) - (q.peak - q.body) for p, q in pairs]
    if not pairs or (min(designed) < STEP_LSTAR and max(designed) > -STEP_LSTAR):
        return Order(ALIKE)
    possible = cases(screen)
    if not possible:
        return Order(UNKNOWN)
    worst = Order(KEPT)
    for case in possible:
        for wanted, (first, second) in zip(designed, pairs, strict=True):
            kind = _kind(wanted, first, second, case)
            if RANK[kind] <= RANK[worst.kind]:
                continue
            less = _share_shown(first, case) < _share_shown(second, case)
            cause = _cause(wanted, first, second, case)
            worst = Order(kind, "reference" if less else "test", cause, case.black)
    return worst


def _kind(designed: float, reference: Highlight, test: Highlight, case: Case) -> str:
    shown = gloss_shown(reference, case) - gloss_shown(test, case)
    if abs(shown) < STEP_LSTAR:
        return HIDDEN
    return KEPT if (shown > 0.0) == (designed > 0.0) else REVERSED


def _share_shown(highlight: Highlight, case: Case) -> float:
    """Of a gloss; a gloss of 0 loses nothing."""
    added = highlight.peak - highlight.body
    return gloss_shown(highlight, case) / added if added > 0.0 else math.inf


def _cause(designed: float, reference: Highlight, test: Highlight, case: Case) -> str:
    """What of a display has to change so that the order is kept; the first that is enough."""
    for cause, mended in (
        ("black", case._replace(black=0.0)),
        ("clipped", case._replace(clipped=1.0)),
        ("gamma", case._replace(gamma=0.0)),
        ("white", case._replace(white_cd_m2=USUAL_WHITES_CD_M2[1])),
    ):
        if mended != case and _kind(designed, reference, test, mended) == KEPT:
            return cause
    return "black" if case.black > 0.0 else "white"


def designers_screen(display: Mapping[str, Any]) -> Screen:
    """The screen of a proof's content.display, where its numbers are known."""
    luminance = float(display["luminance_cd_m2"])
    black = None
    if display["black_known"]:
        black = min(max(float(display["black_cd_m2"]) / luminance, 0.0), MOST_BLACK)
    white = luminance if display["luminance_known"] else None
    return Screen(white, black, black)
