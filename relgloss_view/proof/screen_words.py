"""How a screen differs from the designer's, and what follows: keys of the page's words.

Twin: page/js/screens.js, with the same names.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.proof.page.build import words
from relgloss_view.proof.screens import (
    CHANNELS,
    LONGEST_NAME,
    Order,
    Screen,
    lstar_of,
    pattern_gamma,
    pixel_light,
    signal_of,
)

SAME_WHITE = 1.1  #: factor between two whites that judgements don't notice
SAME_BLACK = 0.003  #: of white; less than screens change while they warm up
WIDE_BLACK = 0.02  #: of white, between bounds that leave open whether two blacks agree
SAME_GAMMA = 0.12  #: twice what the eye misses at the pattern
SAME_CHANNELS = 0.2  #: between the gammas of two channels: a tint that is seen in grays


class Words(NamedTuple):
    """A key of the words, and the numbers that fill it."""

    key: str
    values: Mapping[str, float | str]


def significant(value: float, digits: int = 2) -> float:
    """A number rounded to significant digits.

    >>> significant(0.01264), significant(137.0)
    (0.013, 140.0)
    """
    if value == 0.0:
        return 0.0
    scale = 10.0 ** (digits - 1 - math.floor(math.log10(abs(value))))
    return math.floor(value * scale + 0.5) / scale


def differences(mine: Screen, theirs: Screen) -> tuple[Words, ...]:
    """What is known of a screen, beside the designer's: one sentence each.

    The page is drawn for sRGB, and a browser that manages colours makes the designer's screen
    follow it. So gamma is compared with sRGB's.
    """
    return (
        *_white(mine, theirs),
        *_black(mine, theirs),
        *_curves(mine),
        *(() if mine.surround == "" else (Words(f"screen.surround.{mine.surround}", {}),)),
    )


def _white(mine: Screen, theirs: Screen) -> tuple[Words, ...]:
    if mine.white_cd_m2 is None:
        return (Words("screen.white.unknown", {}),)
    if theirs.white_cd_m2 is None:
        return (Words("screen.white.designer-unknown", {}),)
    times = mine.white_cd_m2 / theirs.white_cd_m2
    if times * SAME_WHITE < 1.0:
        return (Words("screen.white.dimmer", {"share": significant(100.0 * times)}),)
    if times > SAME_WHITE:
        return (Words("screen.white.brighter", {"times": significant(times)}),)
    return (Words("screen.white.same", {}),)


def _black(mine: Screen, theirs: Screen) -> tuple[Words, ...]:
    if mine.black_least is None or mine.black_most is None:
        return (Words("screen.black.unknown", {}),)
    least, most = significant(100.0 * mine.black_least), significant(100.0 * mine.black_most)
    yours = Words("screen.black.yours", {"least": least, "most": most})
    if theirs.black_most is None:
        return yours, Words("screen.black.designer-unknown", {})
    kind = "unsure" if mine.black_most - mine.black_least > WIDE_BLACK else "same"
    if mine.black_least > theirs.black_most + SAME_BLACK:
        kind = "lighter"
    if mine.black_most < theirs.black_most - SAME_BLACK:
        kind = "darker"
    share = significant(100.0 * theirs.black_most)
    return yours, Words(f"screen.black.{kind}", {"designer": share})


def _curves(mine: Screen) -> tuple[Words, ...]:
    said = []
    if mine.gamma is None:
        said.append(Words("screen.gamma.unknown", {}))
    else:
        usual = pattern_gamma(signal_of(0.5))
        off = mine.gamma - usual
        kind = "same" if abs(off) <= SAME_GAMMA else "higher" if off > 0.0 else "lower"
        values = {"gamma": significant(mine.gamma), "usual": significant(usual)}
        said.append(Words(f"screen.gamma.{kind}", values))
    if mine.channels is not None:
        low, high = min(mine.channels), max(mine.channels)
        if high - low > SAME_CHANNELS:
            weak = CHANNELS[mine.channels.index(high)]
            said.append(Words("screen.channels.differ", {"channel": weak}))
        else:
            said.append(Words("screen.channels.same", {}))
    if mine.clipped is not None and mine.clipped < 1.0:
        lstar = significant(lstar_of(pixel_light(mine.clipped, 0.0)))
        said.append(Words("screen.clipped", {"lstar": lstar}))
    return tuple(said)


def order_words(order: Order, screen: str) -> Words:
    """A verdict on the order of gloss. screen: 'yours' or 'designer', whose it is."""
    if order.cause == "":
        return Words(f"screen.order.{order.kind}", {"screen": f"screen.{screen}"})
    values: dict[str, float | str] = {
        "screen": f"screen.{screen}",
        "side": f"screen.side.{order.side}",
        "black": significant(100.0 * order.black),
    }
    return Words(f"screen.order.{order.kind}-{order.cause}", values)


def short(screen: Screen) -> tuple[Words, ...]:
    """A screen in short: what is known of it."""
    said = []
    if screen.name:
        said.append(Words("screen.short.name", {"name": printable(screen.name, LONGEST_NAME)}))
    if screen.white_cd_m2 is not None:
        said.append(Words("screen.short.white", {"white": significant(screen.white_cd_m2, 3)}))
    if screen.black_least is not None:
        least = significant(100.0 * screen.black_least)
        if screen.black_most is None:
            said.append(Words("screen.short.black-least", {"least": least}))
        elif least == (most := significant(100.0 * screen.black_most)):
            said.append(Words("screen.short.black-is", {"black": most}))
        else:
            said.append(Words("screen.short.black", {"least": least, "most": most}))
    if screen.gamma is not None:
        said.append(Words("screen.short.gamma", {"gamma": significant(screen.gamma)}))
    if screen.surround:
        said.append(Words(f"screen.short.{screen.surround}", {}))
    return tuple(said)


def screen_words(screen: Screen, language: str = "en") -> tuple[str, ...]:
    """What a message holds of its author's screen, for `proof show` and the window.

    >>> screen_words(Screen(white_cd_m2=120.0))
    ('white 120 cd/m2',)
    """
    table = words(language)
    return tuple(table[key].format(**_as_text(values)) for key, values in short(screen))


def screen_line(content: object) -> str:
    """A message's `screen` as it is in a file, in one line; '' where nothing is known.

    >>> screen_line({"white_cd_m2": 120.0, "surround": "dark"})
    'white 120 cd/m2, dark room'
    """
    try:
        return "" if content is None else ", ".join(screen_words(Screen.from_json(content)))
    except InputError:
        return "described in a way that this version does not read"


def _as_text(values: Mapping[str, float | str]) -> dict[str, str]:
    return {k: f"{v:g}" if isinstance(v, float) else v for k, v in values.items()}
