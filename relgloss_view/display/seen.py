"""Through the other's display: its light in the linear RGB of the screen that shows it.

Light is compared in cd/m2 where both whites are known, and white to white where one is not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Mask

#: absolute: cd/m2 are kept. matched: the other's white is made to fit just into this one's.
SEEN_WHITES = ABSOLUTE, MATCHED = ("absolute", "matched")
WHITE_TO_WHITE = "white to white"  #: as matched, because a luminance is not known
#: Of linear RGB of the screen: ten times what the rounding of profiles changes, and less than 1 L*.
SCREEN_TOLERANCE = 1e-3


@dataclass(frozen=True)
class SeenOn:
    """How the light of another display is shown on this one.

    how: 'absolute', 'matched' or 'white to white'. scale: of the other's light, 1 where cd/m2 are
    kept; where they are not known, of light with both whites at the same luminance.
    """

    other: str  #: name
    how: str
    scale: float
    other_cd_m2: float | None  #: of white; None where nobody knows
    screen_cd_m2: float | None
    other_black: float  #: Y relative to its own white
    screen_black: float
    blacks_known: tuple[bool, bool] = (True, True)  #: of the other, of the screen


def between(
    other_xyz: Array,
    screen_rgb: Array,
    other_cd_m2: float | None,
    screen_cd_m2: float | None,
    seen_white: str,
) -> tuple[Array, str, float]:
    """(matrix (3, 3), how, scale): from the other's linear RGB to the screen's.

    other_xyz: XYZ of the other's RGB (3, 3), white at Y = 1. screen_rgb: RGB of the screen's XYZ.
    The two luminances are of white, cd/m2; None where nobody knows.

    >>> matrix, how, scale = between(np.eye(3), np.eye(3), 250.0, 100.0, "absolute")
    >>> matrix.diagonal().tolist(), how, scale
    ([2.5, 2.5, 2.5], 'absolute', 1.0)
    >>> matrix, how, scale = between(np.eye(3), np.eye(3), 250.0, 100.0, "matched")
    >>> matrix.diagonal().tolist(), how, scale
    ([1.0, 1.0, 1.0], 'matched', 0.4)
    """
    matrix = screen_rgb @ other_xyz
    known = other_cd_m2 is not None and screen_cd_m2 is not None
    if other_cd_m2 is not None and screen_cd_m2 is not None:
        matrix = matrix * (other_cd_m2 / screen_cd_m2)
    how = seen_white if known else WHITE_TO_WHITE
    if how == ABSOLUTE:
        return matrix, how, 1.0
    scale = 1.0 / float(np.max(matrix @ np.ones(3)))
    return matrix * scale, how, scale


def beyond(rgb: Array, darkest: Array) -> Mask:
    """(...) whether a screen can't show linear RGB (..., 3); darkest: (3,), what it shows at black.

    >>> rgb = np.array([[1.0, 0.5, 0.1], [1.1, 0.5, 0.1], [0.5, 0.5, 0.0]])
    >>> beyond(rgb, np.full(3, 0.05)).tolist()
    [False, True, True]
    """
    low, high = darkest - SCREEN_TOLERANCE, 1.0 + SCREEN_TOLERANCE
    return np.asarray(np.any((rgb > high) | (rgb < low), axis=-1))
