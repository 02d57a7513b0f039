"""Geometries of multi-angle spectrophotometers: names such as 45as-15 become directions.

The aspecular angle is counted from the mirror direction, in the plane of incidence, positive
towards the lamp (ASTM E2194, DIN 6175-2): 45as45 sees along the normal, 45as-15 lies beyond the
mirror direction. Out of the plane the receiver is turned about the mirror direction (ASTM E2539),
by an azimuth that is counted from the side beyond it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array

USUAL_LAMP_DEG = 45.0  #: of instruments whose names give the aspecular angle alone
_NUMBER = r"(?:[-+\u2212\u2013]|minus[ _]?|m(?=\d))?\s*\d{1,3}(?:[.,]\d{1,3})?"
#: [r]45as-15, 45as25az90, 45:as15, 45°/as 15°, 45asMinus15
_NAMED = re.compile(
    rf"(?<![\d.])r?\s*(\d{{1,2}}(?:[.,]\d{{1,2}})?)\s*(?:°|deg)?\s*[:/_-]?\s*as\s*({_NUMBER})"
    rf"\s*(?:°|deg)?(?:\s*az\s*({_NUMBER}))?(?![\d.])",
    re.IGNORECASE,
)
#: 45:-60 (as-15), the words of ASTM E2194: angles of lamp and receiver from the normal
_PAIR = re.compile(
    rf"(?<![\d.])({_NUMBER})\s*°?\s*:\s*{_NUMBER}\s*°?\s*\(\s*as\s*({_NUMBER})\s*°?\s*\)",
    re.IGNORECASE,
)
#: as15, as-15 alone
_ALONE = re.compile(
    rf"(?<![\w.])as\s*[:_]?\s*({_NUMBER})\s*°?(?:\s*az\s*({_NUMBER}))?(?![\d.])", re.I
)
#: 15as and 25as60az, as CxF files note the angle of a lamp that they give elsewhere
_BEHIND = re.compile(rf"({_NUMBER})\s*as(?:\s*({_NUMBER})\s*az)?", re.IGNORECASE)
_BARE = re.compile(rf"({_NUMBER})\s*(?:°|deg|degrees?)?", re.IGNORECASE)


class Aspecular(NamedTuple):
    """A geometry: all angles in degrees."""

    lamp_deg: float  #: of the lamp from the normal
    aspecular_deg: float  #: of the receiver from the mirror direction, positive towards the lamp
    azimuth_deg: float = 0.0  #: about the mirror direction; 0 within the plane of incidence

    @property
    def words(self) -> str:
        """As instruments name it.

        >>> Aspecular(45.0, -15.0).words, Aspecular(15.0, 38.3, 43.0).words
        ('45as-15', '15as38.3az43')
        """
        turn = f"az{self.azimuth_deg:g}" if self.azimuth_deg else ""
        return f"{self.lamp_deg:g}as{self.aspecular_deg:g}{turn}"

    @property
    def is_45_0(self) -> bool:
        """Whether the receiver sees along the normal what a lamp at 45 degrees lights."""
        return (
            abs(self.lamp_deg - 45.0) <= 1.0
            and abs(self.aspecular_deg - 45.0) <= 1.0
            and not self.azimuth_deg
        )


def split_aspecular(words: str, *, whole: bool = False) -> tuple[Aspecular | None, str]:
    """The geometry that words name, and the words without it; None where they name none.

    whole: the words are a geometry and nothing else, so that a number alone is an aspecular angle
    with the usual lamp at 45 degrees.

    >>> split_aspecular("red r45as-15")
    (Aspecular(lamp_deg=45.0, aspecular_deg=-15.0, azimuth_deg=0.0), 'red')
    >>> split_aspecular("15as38.3az-43")[0], split_aspecular("110°", whole=True)[0].words
    (Aspecular(lamp_deg=15.0, aspecular_deg=38.3, azimuth_deg=-43.0), '45as110')
    >>> split_aspecular("SPECTRAL_NM_400")
    (None, 'SPECTRAL_NM_400')
    """
    if len(words) > 400:
        return None, words
    found = _PAIR.search(words)
    if found is not None:
        return _checked(abs(_value(found[1])), found[2], None), _without(words, found)
    found = _NAMED.search(words)
    if found is not None:
        return _checked(_value(found[1]), found[2], found[3]), _without(words, found)
    found = _ALONE.search(words)
    if found is not None:
        return _checked(USUAL_LAMP_DEG, found[1], found[2]), _without(words, found)
    if whole:
        text = words.strip()
        for pattern in (_BEHIND, _BARE):
            found = pattern.fullmatch(text)
            if found is not None:
                turn = found[2] if pattern is _BEHIND else None
                return _checked(USUAL_LAMP_DEG, found[1], turn), ""
    return None, words


def _checked(lamp_deg: float, aspecular: str, azimuth: str | None) -> Aspecular | None:
    geometry = Aspecular(lamp_deg, _value(aspecular), _value(azimuth) if azimuth else 0.0)
    return geometry if is_possible(geometry) else None


def is_possible(geometry: Aspecular) -> bool:
    """Whether lamp and receiver can be where a geometry puts them."""
    return (
        all(math.isfinite(angle) for angle in geometry)
        and 0.0 <= geometry.lamp_deg < 90.0
        and abs(geometry.aspecular_deg) <= 180.0
        and abs(geometry.azimuth_deg) <= 360.0
    )


def _value(text: str) -> float:
    negative = text.strip().lower()[:1] in ("-", "\u2212", "\u2013", "m")
    size = float(re.sub(r"[^\d.]", "", text.replace(",", ".")))
    return -size if negative else size


def _without(words: str, found: re.Match[str]) -> str:
    rest = f"{words[: found.start()]} {words[found.end() :]}"
    return rest.strip(" \t_-/|:;,()[]")


def directions(geometries: Sequence[Aspecular]) -> tuple[Array, Array]:
    """Unit vectors to lamp and to receiver, (N, 3) each; the mirror direction is at azimuth 0.

    >>> lamp, receiver = directions([Aspecular(45.0, 45.0)])
    >>> receiver.round(6).tolist()
    [[0.0, 0.0, 1.0]]
    """
    theta, off, turn = np.radians(np.array(geometries, np.float64).reshape(-1, 3)).T
    zero = np.zeros_like(theta)
    lamp = np.stack([-np.sin(theta), zero, np.cos(theta)], axis=-1)
    mirror = np.stack([np.sin(theta), zero, np.cos(theta)], axis=-1)
    beyond = np.stack([np.cos(theta), zero, -np.sin(theta)], axis=-1)
    across = np.array([0.0, 1.0, 0.0])
    # Within the plane the sign of the aspecular angle gives the side, beyond it the azimuth does.
    side = np.where(turn == 0.0, -1.0, np.cos(turn))[:, None]
    aside = side * beyond + np.sin(turn)[:, None] * across
    receiver = np.cos(off)[:, None] * mirror + np.sin(off)[:, None] * aside
    return lamp, np.where(np.abs(receiver) < 1e-15, 0.0, receiver)
