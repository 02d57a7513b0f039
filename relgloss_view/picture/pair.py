"""Pair: one factor for the contrast gloss of pictures that are looked at together.

Where a view can't display the c of one picture without clipping, all of them are scaled alike, so
that the ratio of their gloss stays; only R, the ratio of the real gloss to the displayed, grows
(Ishii et al.: R is the same for all samples).
"""

from __future__ import annotations

from collections.abc import Iterable

#: While a hand moves, a factor that is this much too small is kept, so that pictures do not pump.
SLACK = 1.25
#: And one that has to fall is taken this much smaller than needed, so that it need not fall again
#: at the next step.
RESERVE = 1.04
UNSEEN = 0.995  #: a factor above this changes nothing that is seen


def common_factor(contrasts: Iterable[tuple[float, float | None]]) -> float:
    """The factor of all c, 0 to 1, with which no picture clips.

    contrasts: (c, c_max) of each picture; c_max is None where a picture shows no highlight.

    >>> common_factor([(0.2, 0.1), (0.4, 0.5)]), common_factor([(0.2, 0.3), (0.4, None)])
    (0.5, 1.0)
    """
    factor = 1.0
    for c, c_max in contrasts:
        if c_max is not None and c > c_max:
            factor = min(factor, c_max / c)
    return factor


def held_factor(needed: float, present: float) -> float:
    """The factor while a hand moves: the present one, unless it clips or is much too small.

    >>> held_factor(0.5, 0.45), held_factor(0.5, 1.0), held_factor(1.0, 0.9), held_factor(1.0, 0.5)
    (0.45, 0.4807692307692307, 0.9, 1.0)
    """
    if needed < present:
        return needed / RESERVE
    return present if needed < SLACK * present else needed


def ratio_words(factor: float) -> str:
    """What a factor below 1 does to R, as people read it; empty for 1.

    >>> ratio_words(0.55)
    'R is 1.8 times as large in this view: the ratio of gloss is kept, the highlights are dimmer'
    """
    if factor > UNSEEN or factor <= 0.0:
        return ""
    times = 1.0 / factor
    amount = f"{times:.2f}" if times < 1.095 else f"{times:.2g}"
    return (
        f"R is {amount} times as large in this view: the ratio of gloss is kept, the highlights "
        "are dimmer"
    )
