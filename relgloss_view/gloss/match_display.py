"""The c that keeps the ratio of gloss on a display whose black is counted.

A match keeps G~ = c L_s*, what the highlight adds to L* (docs/match.md). A display shows no less
than its black, b of its white, room light included. There are two ways to it:

- a picture drawn for the display has the L* that is wanted, down to the black's: the highlight adds
  max(L_d* + c L_s*, L_b*) - max(L_d*, L_b*);
- a picture drawn without that black and opened there is lifted in light: Y becomes b + (1 - b) Y,
  as flare adds to what a monitor shows (Berns 1996), so every difference in L* becomes smaller, in
  dark colours most.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.gloss.match import MatchCurve, Reference
from relgloss_view.gloss.pose import pose_of
from relgloss_view.material import cielab
from relgloss_view.material.material import Material
from relgloss_view.picture.scene.setup import Setup

#: A ratio that changes by less is kept: poses of the lamp alone change it by 30 % and more.
KEPT = 0.02
LEAST_FACTOR = 0.1  #: of a pair's c, below which its pictures show no gloss to judge


@dataclass(frozen=True)
class Screen:
    """A display as far as gloss on it is concerned."""

    name: str
    cd_m2: float | None  #: of white; None where nobody knows
    black: float  #: Y at black relative to white, room light included
    black_known: bool

    @property
    def black_lstar(self) -> float:
        """L* of black."""
        return float(cielab.lightness(np.array(self.black)))


@dataclass(frozen=True)
class OnScreen:
    """One sample on a screen; `drawn` for it, or `opened` there though drawn without its black."""

    label: str
    body_lstar: float  #: smallest L_d* at a highlight of the pair, over the poses
    drawn_share: float | None  #: of the ratio, that the proposed c shows; None: nothing to compare
    drawn_c: float | None  #: that keeps the ratio; None where white is not bright enough
    opened_share: float | None
    opened_c: float | None


def screens_of(display: Display) -> tuple[Screen, ...]:
    """The other display of `seen_on`, and this one where its black is known and no other is seen.

    >>> screens_of(Display()), round(screens_of(Display(black_cd_m2=2.0))[0].black, 9)
    ((), 0.02)
    """
    model = DisplayModel.of(display)
    if model.seen is not None:
        seen = model.seen
        return (Screen(seen.other, seen.other_cd_m2, seen.other_black, seen.blacks_known[0]),)
    black = float(model.xyz_from_rgb[1] @ model.darkest)
    if not model.black_known or black <= 0.0:
        return ()
    luminance = model.luminance_cd_m2 if model.luminance_known else None
    return (Screen("this display", luminance, black, True),)


def added_lstar(l_d: float, l_s: float, c: float, black: float, *, opened: bool) -> float:
    """What a highlight adds to L* on a screen with this black, of light from 0 to 1.

    >>> added_lstar(50.0, 100.0, 0.3, 0.0, opened=False)
    30.0
    >>> added_lstar(5.0, 100.0, 0.3, 0.02, opened=False) < 30.0
    True
    """
    body, bright = _seen(l_d, black, opened), _seen(l_d + c * l_s, black, opened)
    return bright - body


def kept_c(added: float, l_d: float, l_s: float, black: float, *, opened: bool) -> float | None:
    """The c whose highlight adds this much on the screen; None where white is not bright enough.

    The inverse of added_lstar.
    """
    bright = _seen(l_d, black, opened) + added
    if opened:
        shown = float(cielab.ratio_of_f(np.array((bright + 16.0) / 116.0)))
        bright = float(cielab.lightness(np.array((shown - black) / (1.0 - black))))
    return (bright - l_d) / l_s if bright <= 100.0 + 1e-9 else None


def _seen(lstar: float, black: float, opened: bool) -> float:
    """L* that a screen shows where L* is wanted."""
    if not opened:
        return max(lstar, float(cielab.lightness(np.array(black))))
    light = float(cielab.ratio_of_f(np.array((lstar + 16.0) / 116.0)))
    return float(cielab.lightness(np.array(black + (1.0 - black) * light)))


def on_screen(screen: Screen, reference: Reference, m: MatchCurve) -> OnScreen | None:
    """A matched sample on a screen: the geometric mean over the poses; None without a proposal."""
    at = m.proposed
    if at is None or at.c is None:
        return None
    sigma = reference.sample.look.sigma_n_deg
    poses = []
    for setup in reference.setups:
        first = _body_and_peak(setup, reference.sample.material, sigma)
        own = _body_and_peak(setup, m.sample.material, at.sigma_n_deg)
        if first is not None and own is not None:
            poses.append((first, own))
    ways = []
    for opened in (False, True):
        shares: list[float | None] = []
        proposals: list[float | None] = []
        for first, own in poses:
            share, c = _in_pose(screen.black, reference.c, m.ratio, first, own, opened)
            shares.append(share)
            proposals.append(c)
        ways += [_mean(shares), _mean(proposals)]
    body = min(min(first[0], own[0]) for first, own in poses)
    return OnScreen(m.sample.label, body, *ways)


def _in_pose(
    black: float,
    c: float,
    ratio: float,
    first: tuple[float, float],
    own: tuple[float, float],
    opened: bool,
) -> tuple[float | None, float | None]:
    """The share of the ratio that this pose's c shows on the screen, and the c that keeps it.

    c: of the reference. first, own: (L_d*, L_s*) of the reference and of the sample. Both pictures
    are scaled by one factor so that neither clips, as a pair is (picture.pair).
    """
    sample_c = ratio * c * first[1] / own[1]
    factor = min(
        1.0,
        *((100.0 - l_d) / (of * l_s) for of, (l_d, l_s) in ((c, first), (sample_c, own))),
    )
    if factor <= 0.0:
        return None, None
    wanted = ratio * added_lstar(*first, factor * c, black, opened=opened)
    added = added_lstar(*own, factor * sample_c, black, opened=opened)
    if wanted <= 0.0:
        return None, None
    kept = kept_c(wanted, *own, black, opened=opened)
    while kept is None and factor > LEAST_FACTOR:  # a little dimmer, both pictures have room
        factor *= 0.95
        wanted = ratio * added_lstar(*first, factor * c, black, opened=opened)
        kept = kept_c(wanted, *own, black, opened=opened)
    return added / wanted, None if kept is None else kept / factor


def screen_numbers(
    screen: Screen, reference: Reference, curves: Sequence[MatchCurve]
) -> dict[str, Any]:
    """A screen and the samples on it as JSON holds them."""
    samples = [on_screen(screen, reference, m) for m in curves]
    return {
        "name": screen.name,
        "white_cd_m2": screen.cd_m2,
        "black": screen.black if screen.black_known else None,
        "samples": [asdict(sample) for sample in samples if sample is not None],
    }


def _body_and_peak(
    setup: Setup, material: Material, sigma_n_deg: float
) -> tuple[float, float] | None:
    """L_d* at the highlight, and L_s* of its peak; None where the highlight is not seen."""
    pose = pose_of(setup)
    peak = pose.peak(material, sigma_n_deg)
    return None if peak is None else (pose.extremes(material, sigma_n_deg).brightest_l_d, peak)


def _mean(values: Sequence[float | None]) -> float | None:
    """The geometric mean; None where a value is missing or nothing is to be kept."""
    present = [value for value in values if value is not None and value > 0.0]
    if not present or len(present) < len(values):
        return None
    return float(np.exp(np.mean(np.log(present))))
