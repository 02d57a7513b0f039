"""From the connection space of an ICC profile, under D50, to light as a screen emits it.

Profiles hold colours as they look under D50. How they came there is in `chad` (version 4, and
version 2 of some makers); without it, version 2 holds the screen's white in `wtpt`.

Source: ICC.1:2022, 9.2.15 (chromaticAdaptationTag), 9.2.36 (mediaWhitePointTag), annex E;
ICC.1:2001, 6.4.22 (mediaWhitePointTag: of a display, its own white).
"""

from __future__ import annotations

import struct

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.icc.profile import D50, Profile
from relgloss_view.material.cielab import bradford

#: Two whites are the same where their XYZ differ by less: 0.004 in x and y, about 100 K at 6500 K.
SAME_WHITE = 0.01
#: A chromatic adaptation of real whites (2,000 K to 50,000 K) has entries within these, and is far
#: from singular: Bradford's from 2,000 K has a determinant of 4.
LARGEST_ENTRY = 10.0
LEAST_DETERMINANT = 0.02

NO_WHITE = (
    "The profile does not hold the white of the screen: it names D50, the white of print, and no "
    "adaptation to it (chad). Pictures are made for a white of D50."
)
TWO_WHITES = (
    "The profile holds two whites that contradict each other (wtpt and chad). Pictures are made "
    "for the white of chad."
)


def emitted_from_connection(profile: Profile) -> tuple[Array, tuple[str, ...]]:
    """Matrix (3, 3) from media-relative XYZ under D50 to emitted XYZ, and notes for people.

    White of the connection space goes to the screen's own white, not scaled to Y = 1. `chad`
    counts where it can be an adaptation; then `wtpt` is D50, or the screen's own white (version 2
    of some makers). Without it, Bradford's transform leads from D50 to `wtpt`.
    """
    adaptation = chromatic_adaptation(profile.tags.get(b"chad", b""))
    known = b"wtpt" in profile.tags
    neutral = _same(profile.white, D50)
    if adaptation is None:
        notes = () if known and not neutral else (NO_WHITE,)
        return bradford(D50, profile.white), notes
    back = np.asarray(np.linalg.inv(adaptation), np.float64)
    if not known or neutral or _same(profile.white, back @ D50):
        return back, ()
    if np.abs(adaptation - np.eye(3)).max() < SAME_WHITE:  # it adapts nothing
        return bradford(D50, profile.white), ()
    return back, (TWO_WHITES,)


def chromatic_adaptation(part: bytes) -> Array | None:
    """The matrix of a `chad` tag, from emitted XYZ to those under D50; None where it is none.

    >>> chromatic_adaptation(b"") is None
    True
    """
    if part[:4] != b"sf32" or len(part) < 44:
        return None
    matrix = np.array(struct.unpack_from(">9i", part, 8)).reshape(3, 3) / 65536.0
    if np.abs(matrix).max() > LARGEST_ENTRY or np.linalg.det(matrix) < LEAST_DETERMINANT:
        return None
    white = np.linalg.solve(matrix, D50)
    return matrix if white.min() > 0.05 and 0.5 < white[1] < 2.0 else None


def _same(one: Array, other: Array) -> bool:
    return bool(np.abs(one / one[1] - other / other[1]).max() < SAME_WHITE)
