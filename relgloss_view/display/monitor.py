"""Monitor: what a screen emits for its digital values, by an ICC profile or by readings.

Light is relative to the screen's own white, as it is emitted and not as it is adapted to D50.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.display.tone_curve import ToneCurve


class Emission(Protocol):
    """How digital values (N, 3) become light of the channels, 0 black and 1 white, and back."""

    @property
    def kind(self) -> str:
        """'curves' or 'table'."""

    def light(self, digital: Array) -> Array:
        """(N, 3) of digital values (N, 3); of a table also below 0 and above 1."""

    def digital(self, light: Array) -> Array:
        """(N, 3), 0 to 1, of light (N, 3): those that show what is nearest to it."""

    def cut(self, light: Array) -> Array:
        """(N, 3), 0 to 1, of light (N, 3): what a device gives, which cuts each channel by itself.

        The same as `digital` where some digital values show the light.
        """

    def reach(self, light: Array) -> Array:
        """(N,) whether some digital values show light (N, 3)."""


@dataclass(frozen=True, eq=False)
class Curves:
    """Channels that add: one curve each."""

    curves: tuple[ToneCurve, ToneCurve, ToneCurve]
    kind: str = "curves"

    def light(self, digital: Array) -> Array:
        """(N, 3) of digital values (N, 3)."""
        return np.stack([c.light(digital[:, k]) for k, c in enumerate(self.curves)], axis=1)

    def digital(self, light: Array) -> Array:
        """(N, 3) of light (N, 3)."""
        return np.stack([c.digital(light[:, k]) for k, c in enumerate(self.curves)], axis=1)

    def cut(self, light: Array) -> Array:
        """(N, 3) of light (N, 3)."""
        return self.digital(light)

    def reach(self, light: Array) -> Array:
        """(N,) whether some digital values show light (N, 3): whether it is from 0 to 1."""
        slack = 1e-6  # of float32
        return np.asarray(((light >= -slack) & (light <= 1.0 + slack)).all(axis=1))


@dataclass(frozen=True)
class Numbers:
    """The numbers of a fitted model, from which curves, matrix and white follow exactly.

    kind: "gain-offset-gamma" (Berns 1996) or "curves". xyz_from_rgb: 3 rows. floor: as Monitor has
    it. offset, gamma: of each channel, for the first kind: light = ((1 - offset) d + offset)^gamma,
    less what that is at 0, and 1 at 1. samples: of each channel for the second kind, the light at
    evenly spaced digital values, straight between them.
    """

    kind: str
    xyz_from_rgb: tuple[tuple[float, float, float], ...]
    floor: tuple[float, float, float]
    offset: tuple[float, ...] = ()
    gamma: tuple[float, ...] = ()
    samples: tuple[tuple[float, ...], ...] = ()


@dataclass(frozen=True, eq=False)
class Monitor:
    """What is known of a screen.

    white: XYZ (3,), Y = 1. xyz_from_rgb: (3, 3), from linear RGB, where (1, 1, 1) is white, to XYZ.
    floor: (3,), linear RGB that the screen shows at black. So digital values d show
    xyz_from_rgb @ (floor + (1 - floor) * emission.light(d)).
    luminance_cd_m2: of white; None where nothing says it. black_known: whether the source says what
    black shows; floor is 0 otherwise. notes: what is missing or surprises, for people. icc: the
    profile that pictures for this screen embed; None where it is made of the rest. calibration:
    (3, n), the video card's curves that the source supposes, values out for values evenly spaced
    over 0 to 1; None where it supposes none.

    black_cd_m2, reflected_cd_m2: what a display file sets instead of what the model has; a scene's
    own entries come before them. fitted: the numbers of a model from readings. verdict: of its fit,
    "good" or "poor"; "" where nothing was fitted. beside: further files that it was read from.
    """

    name: str
    source: str  #: "profile" or "readings"
    white: Array
    xyz_from_rgb: Array
    floor: Array
    emission: Emission
    luminance_cd_m2: float | None = None
    black_known: bool = False
    notes: tuple[str, ...] = ()
    icc: bytes | None = None
    calibration: Array | None = None
    black_cd_m2: float | None = None
    reflected_cd_m2: float = 0.0
    fitted: Numbers | None = None
    verdict: str = ""
    beside: tuple[str, ...] = ()

    def xyz(self, digital: Array) -> Array:
        """XYZ (N, 3) of digital values (N, 3), relative to white at Y = 1."""
        rgb = self.floor + (1.0 - self.floor) * self.emission.light(digital)
        return np.asarray(rgb @ self.xyz_from_rgb.T)

    def digital(self, xyz: Array) -> Array:
        """Digital values (N, 3), 0 to 1, of XYZ (N, 3): those that show what is nearest to it."""
        rgb = np.linalg.solve(self.xyz_from_rgb, xyz.T).T
        return self.emission.digital((rgb - self.floor) / (1.0 - self.floor))


def with_black(matrix: Array, black_xyz: Array) -> tuple[Array, Array]:
    """(xyz_from_rgb, floor) of a screen whose channels add `matrix` (3, 3) to a black (3,).

    XYZ = matrix @ t + black with t from 0 to 1 is xyz_from_rgb @ (floor + (1 - floor) t).

    >>> m, f = with_black(np.eye(3), np.full(3, 0.25))
    >>> m.diagonal().tolist(), f.tolist()
    ([1.25, 1.25, 1.25], [0.2, 0.2, 0.2])
    """
    share = np.linalg.solve(matrix, black_xyz)
    return matrix * (1.0 + share), share / (1.0 + share)
