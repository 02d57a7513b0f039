"""What this display can't show of a picture that another display would show (`seen_on`)."""

from __future__ import annotations

import weakref
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array, Floats, Mask
from relgloss_view.base.reading import printable
from relgloss_view.display.model import DisplayModel
from relgloss_view.display.seen import (
    ABSOLUTE,
    MATCHED,
    SCREEN_TOLERANCE,
    WHITE_TO_WHITE,
    SeenOn,
    beyond,
)
from relgloss_view.picture.displayed import Displayed
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model import tone
from relgloss_view.picture.stages import parts_of

LEAST_SHARE = 5e-4  #: of the object, below which nothing is worth a warning


@dataclass(frozen=True)
class ScreenLimits:
    """Shares of the object's pixels, 0 to 1; a pixel may be too bright and too saturated."""

    cut: float  #: the screen can't show them as they are
    brighter: float
    darker: float
    more_saturated: float


class Tally:
    """Counts the pixels that a screen can't show."""

    def __init__(self, display: DisplayModel) -> None:
        self._display = display
        self._counts = np.zeros(4, dtype=np.int64)
        self._pixels = 0

    def add(self, light: Floats) -> None:
        """Count pixels (N, 3), linear RGB of the display that is seen."""
        self._pixels += len(light)
        screen = self._display.screen
        if screen is not None and len(light):
            rgb = tone.on_screen(np.asarray(light, dtype=np.float64), self._display)
            cut = beyond(rgb, screen.darkest) | _misses_table(rgb, screen)
            low = np.any(rgb < screen.darkest - SCREEN_TOLERANCE, axis=-1)
            luminance, black = rgb @ screen.xyz_from_rgb[1], screen.xyz_from_rgb[1] @ screen.darkest
            darker = low & (luminance < black)
            high = np.any(rgb > 1.0 + SCREEN_TOLERANCE, axis=-1)
            brighter = high & (~low | (luminance > 1.0))
            saturated = cut & ~darker & (low | ~high)
            self._counts += [np.sum(m) for m in (cut, brighter, darker, saturated)]

    def limits(self) -> ScreenLimits:
        """The shares of what was counted."""
        return ScreenLimits(*(float(n) / max(self._pixels, 1) for n in self._counts))


def _misses_table(rgb: Array, screen: DisplayModel) -> Mask:
    """(N,) whether the nearest that a look-up-table profile can show is another colour."""
    if screen.emission is None or screen.emission.kind != "table":
        return np.zeros(len(rgb), dtype=bool)
    light = (np.clip(rgb, screen.darkest, 1.0) - screen.floor) / (1.0 - screen.floor)
    nearest = screen.emission.light(screen.emission.digital(light))
    return np.asarray(np.any(np.abs(nearest - light) > SCREEN_TOLERANCE, axis=-1))


_COUNTED: weakref.WeakKeyDictionary[Frame, ScreenLimits] = weakref.WeakKeyDictionary()


def screen_limits(frame: Frame, displayed: Displayed | None = None) -> ScreenLimits | None:
    """What this display can't show of a picture; None where it is not seen on another one.

    displayed: of another operator. None too where its light was not kept.
    """
    display = DisplayModel.of(frame.scene.display)
    if display.seen is None or (displayed is not None and not displayed.light.size):
        return None
    if displayed is None and frame in _COUNTED:
        return _COUNTED[frame]
    tally = Tally(display)
    if display.screen is not None:
        for part in parts_of(frame):
            light = part.light if displayed is None else displayed.light[part.rows]
            tally.add(light[part.own][part.on_object[part.own]])
    limits = tally.limits()
    if displayed is None:
        _COUNTED[frame] = limits
    return limits


def seen_numbers(frame: Frame, displayed: Displayed | None = None) -> dict[str, Any] | None:
    """How another display's light is shown, and what of it is cut, as JSON holds it."""
    seen = DisplayModel.of(frame.scene.display).seen
    limits = screen_limits(frame, displayed)
    if seen is None:
        return None
    return {**asdict(seen), "shares": None if limits is None else asdict(limits)}


def seen_warnings(frame: Frame, displayed: Displayed | None = None) -> tuple[str, ...]:
    """Where this display can't show what the other one does, and why: a sentence each."""
    seen = DisplayModel.of(frame.scene.display).seen
    if seen is None:
        return ()
    return (*unknown_words(seen), *limit_words(seen, screen_limits(frame, displayed)))


def seen_words(seen: SeenOn) -> str:
    """How the light of the other display is shown."""
    name = printable(seen.other, 60)
    if seen.how == WHITE_TO_WHITE:
        return f"as {name} shows it, white to white"
    whites = f"its white has {seen.other_cd_m2:.4g} cd/m2, this display's {seen.screen_cd_m2:.4g}"
    if seen.how == ABSOLUTE:
        return f"as {name} shows it, in the same cd/m2: {whites}"
    return f"as {name} shows it, at {seen.scale:.3g} times its light: {whites}"


def unknown_words(seen: SeenOn) -> tuple[str, ...]:
    """What nobody knows of the two displays, and how to mend it."""
    name = printable(seen.other, 60)
    words = []
    if seen.how == WHITE_TO_WHITE:
        missing = [
            owner
            for owner, value in ((name, seen.other_cd_m2), ("this display", seen.screen_cd_m2))
            if value is None
        ]
        mend = []
        if seen.other_cd_m2 is None:
            mend.append(f"write a display file for {name} with its luminance_cd_m2")
        if seen.screen_cd_m2 is None:
            mend.append("give this display's with --set display.luminance_cd_m2=VALUE")
        words.append(
            f"the luminance of white is not known of {' and of '.join(missing)}, so the two whites "
            f"are shown alike and a difference in brightness is not seen; {' and '.join(mend)}"
        )
    missing = [
        owner
        for owner, known in zip((name, "this display"), seen.blacks_known, strict=True)
        if not known
    ]
    if missing:
        words.append(
            f"the black is not known of {' and of '.join(missing)}, and is taken as without light"
        )
    return tuple(words)


def limit_words(seen: SeenOn, limits: ScreenLimits | None) -> tuple[str, ...]:
    """What this display can't show of the other's picture: a sentence for each reason."""
    if limits is None:
        return ()
    name = printable(seen.other, 60)
    words = []
    if limits.brighter >= LEAST_SHARE:
        share = share_words(limits.brighter)
        if seen.how == ABSOLUTE and (seen.other_cd_m2 or 0.0) > (seen.screen_cd_m2 or 0.0):
            words.append(
                f"the white of {name} has {seen.other_cd_m2:.4g} cd/m2, this display's "
                f"{seen.screen_cd_m2:.4g}: {share} of the object is brighter than this display can "
                f"show and is cut; --seen-white {MATCHED} shows it dimmed to fit"
            )
        else:
            words.append(
                f"the white of {name} has another colour than this display's: {share} of the "
                "object is brighter in a channel than this display can show and is cut; "
                f"--seen-white {MATCHED} shows it dimmed to fit"
            )
    if limits.darker >= LEAST_SHARE:
        blacks = f"this display's black has {seen.screen_black:.2%} of its white"
        if seen.screen_cd_m2 is not None:
            blacks = f"this display's black has {seen.screen_black * seen.screen_cd_m2:.3g} cd/m2"
        words.append(
            f"{blacks}: {share_words(limits.darker)} of the object is darker than this display "
            "can show and appears as its black"
        )
    if limits.more_saturated >= LEAST_SHARE:
        words.append(
            f"{share_words(limits.more_saturated)} of the object has colours of {name} that are "
            "more saturated than this display can show; they appear paler"
        )
    return tuple(words)


def share_words(share: float) -> str:
    """A share in percent.

    >>> share_words(0.1234), share_words(0.004), share_words(1.0), share_words(0.99999)
    ('12 %', '0.4 %', '100 %', 'more than 99.9 %')
    """
    percent = 100.0 * share
    if percent < 10.0:
        return f"{percent:.1f} %"
    if share < 1.0 and percent > 99.5:
        return "more than 99.9 %" if percent > 99.9 else f"{percent:.1f} %"
    return f"{percent:.0f} %"
