"""Models of a display that are fitted to readings: curves of the channels, a matrix, a black.

XYZ = black + matrix @ light(d), light from 0 to 1 in each channel. The curves are found by least
squares; for any curves, matrix and black follow from a linear problem (variable projection, Golub
and Pereyra 1973).

Two kinds of curve. Gain, offset, gamma: light = (gain d + offset)^gamma (Berns 1996), less what it
shows at 0, and 1 at 1. Monotone: that curve, its lightness bent by a monotone cubic (Fritsch and
Carlson 1980) whose bends are held small, so that noise does not show in it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.material.cielab import lightness, ratio_of_f

GAMMA = (0.5, 5.0)
OFFSET = (-0.4, 0.4)
#: How much the slope of a bent curve may change from knot to knot, of its lightness: the standard
#: deviation that the fit expects before it sees a reading. A wobble of 1 L* between knots is two.
BEND = 0.03


#: Means of the four quarters of a normal distribution; they keep its mean deviation, 0.798.
_QUARTERS = (-1.2711, -0.3246, 0.3246, 1.2711)


@dataclass(frozen=True)
class Kind:
    """A candidate: its name, whether the channels share a curve, how many knots bend it."""

    name: str
    shared: bool
    knots: int = 0  #: inner knots of each curve; 0 for gain, offset, gamma alone

    @property
    def parameters(self) -> int:
        """Numbers of the curves, the matrix and the black."""
        return (2 + self.knots) * (1 if self.shared else 3) + 12


#: From the simplest: a later one must be better by more than its standard error.
KINDS = (
    Kind("gain-offset-gamma, one for all channels", True),
    Kind("gain-offset-gamma, one a channel", False),
    Kind("monotone curve, one for all channels", True, 7),
    Kind("monotone curve, one a channel", False, 7),
    Kind("fine monotone curve, one a channel", False, 19),
)


@dataclass(frozen=True, eq=False)
class Shape:
    """The curves of the channels: offset and gamma (3,), and the lightness at the knots or None."""

    offset: Array
    gamma: Array
    bent: Array | None = None  #: (3, knots + 2), from 0 to 1

    def light(self, digital: Array, unsteady: float = 0.0) -> Array:
        """(N, 3), 0 to 1, of digital values (N, 3).

        unsteady: standard deviation of the digital values. The mean light is returned: at an end of
        the scale they can miss to one side only, so that white is darker than it was asked to be.
        """
        if unsteady <= 0.0:
            return np.stack([self.channel(k, digital[:, k]) for k in range(3)], axis=1)
        missed = [np.clip(digital + unsteady * z, 0.0, 1.0) for z in _QUARTERS]
        return np.asarray(np.mean([self.light(d) for d in missed], axis=0))

    def channel(self, k: int, digital: Array) -> Array:
        """Light of one channel's digital values."""
        plain = gain_offset_gamma(digital, float(self.offset[k]), float(self.gamma[k]))
        if self.bent is None:
            return plain
        at = np.linspace(0.0, 1.0, self.bent.shape[1])
        bent = monotone_cubic(at, self.bent[k], np.asarray(lightness(plain)) / 100.0)
        return np.asarray(_from_lightness(np.clip(bent, 0.0, 1.0)))


def gain_offset_gamma(digital: Array, offset: float, gamma: float) -> Array:
    """Light from 0 at 0 to 1 at 1; gain is 1 - offset.

    >>> gain_offset_gamma(np.array([0.0, 0.5, 1.0]), 0.0, 2.0).tolist()
    [0.0, 0.25, 1.0]
    """
    dark = max(offset, 0.0) ** gamma
    shown = np.maximum((1.0 - offset) * digital + offset, 0.0) ** gamma
    return np.asarray((shown - dark) / (1.0 - dark))


def _from_lightness(share: Array) -> Array:
    """Relative luminance of L*/100 (CIE 15:2004)."""
    return ratio_of_f((100.0 * share + 16.0) / 116.0)


def monotone_cubic(at: Array, values: Array, x: Array) -> Array:
    """A cubic between rising values at rising places that never overshoots, at x (N,).

    Slopes: the weighted harmonic mean of Fritsch and Butland (1984), as PCHIP has it.

    >>> monotone_cubic(np.arange(3.0), np.array([0.0, 1.0, 1.0]), np.array([1.5])).tolist()
    [1.0]
    """
    step, rise = np.diff(at), np.diff(values)
    slope = rise / step
    inner = np.zeros(len(at))
    before, after = slope[:-1], slope[1:]
    w1, w2 = 2.0 * step[1:] + step[:-1], step[1:] + 2.0 * step[:-1]
    rising = (before > 0.0) & (after > 0.0)
    safe = np.where(rising, before, 1.0), np.where(rising, after, 1.0)
    inner[1:-1] = np.where(rising, (w1 + w2) / (w1 / safe[0] + w2 / safe[1]), 0.0)
    inner[0], inner[-1] = _end(step, slope, 0, 1), _end(step, slope, -1, -2)
    cell = np.clip(np.searchsorted(at, x, side="right") - 1, 0, len(at) - 2)
    h = step[cell]
    t = (x - at[cell]) / h
    return np.asarray(
        (1.0 + 2.0 * t) * (1.0 - t) ** 2 * values[cell]
        + t * (1.0 - t) ** 2 * h * inner[cell]
        + t**2 * (3.0 - 2.0 * t) * values[cell + 1]
        + t**2 * (t - 1.0) * h * inner[cell + 1]
    )


def _end(step: Array, slope: Array, first: int, second: int) -> float:
    """The three-point slope of an end, cut so that the curve keeps its shape (Moler 2004)."""
    h, g = float(step[first]), float(step[second])
    s, t = float(slope[first]), float(slope[second])
    end = ((2.0 * h + g) * s - h * t) / (h + g)
    if end * s <= 0.0:
        return 0.0
    return 3.0 * s if s * t <= 0.0 and abs(end) > 3.0 * abs(s) else end


@dataclass(frozen=True, eq=False)
class Fitted:
    """A candidate with its numbers, in the unit of the readings."""

    kind: Kind
    shape: Shape
    matrix: Array  #: (3, 3), XYZ of each channel alone, less black, in its column
    black: Array  #: XYZ (3,)

    def xyz(self, digital: Array, unsteady: float = 0.0) -> Array:
        """XYZ (N, 3) of digital values (N, 3); unsteady as Shape.light has it."""
        return np.asarray(self.black + self.shape.light(digital, unsteady) @ self.matrix.T)

    @property
    def white(self) -> Array:
        """XYZ (3,) at the top of all channels."""
        return np.asarray(self.black + self.matrix.sum(axis=1))


def fit_candidate(
    kind: Kind,
    digital: Array,
    xyz: Array,
    whitening: Array,
    unsteady: float = 0.0,
    start: Shape | None = None,
) -> Fitted:
    """Fit a candidate to readings (N, 3) of digital values (N, 3); unsteady as Shape.light has it.

    whitening: (N, 3, 3), what makes residuals of a patch independent with variance 1. start: the
    curves that a bent one bends; those of the same kind without knots.
    """
    from scipy.optimize import least_squares

    if kind.knots:
        plain = Kind(kind.name, kind.shared)
        base = start or fit_candidate(plain, digital, xyz, whitening, unsteady).shape
        low, high, first = _bends(kind)
        steps = kind.knots + 1

        def shape_of(x: Array) -> Shape:
            # Shares of the whole rise, each above 0: so the curve rises whatever the numbers are.
            weights = np.exp(x.reshape(-1, steps))
            rises = weights / weights.sum(axis=1, keepdims=True)
            bent = np.concatenate([np.zeros((len(rises), 1)), np.cumsum(rises, axis=1)], axis=1)
            return Shape(base.offset, base.gamma, np.broadcast_to(bent, (3, steps + 1)))

        def held(x: Array) -> Array:
            # log-slopes of neighbours differ by BEND times the knots' distance, as a rule
            rows = x.reshape(-1, steps)
            scale = BEND * np.sqrt(steps)
            return np.concatenate([(np.diff(rows, axis=1) / scale).ravel(), rows.sum(axis=1)])
    else:
        count = 1 if kind.shared else 3
        first = np.tile([0.02, 2.2], count)
        low, high = (np.tile([OFFSET[k], GAMMA[k]], count) for k in range(2))

        def shape_of(x: Array) -> Shape:
            offset, gamma = np.broadcast_to(x.reshape(-1, 2), (3, 2)).T
            return Shape(offset, gamma)

        def held(x: Array) -> Array:
            return np.zeros(0)

    def residuals(x: Array) -> Array:
        light = shape_of(x).light(digital, unsteady)
        coefficients = _linear(light, xyz, whitening)
        predicted = _design(light) @ coefficients
        off = np.einsum("nij,nj->ni", whitening, predicted - xyz)
        return np.concatenate([off.ravel(), held(x)])

    found = least_squares(
        residuals, first, bounds=(low, high), x_scale="jac", max_nfev=30, ftol=1e-6, xtol=1e-6
    )
    shape = shape_of(found.x)
    coefficients = _linear(shape.light(digital, unsteady), xyz, whitening)
    return Fitted(kind, shape, coefficients[1:].T.copy(), coefficients[0].copy())


def _bends(kind: Kind) -> tuple[Array, Array, Array]:
    count = (kind.knots + 1) * (1 if kind.shared else 3)
    return np.full(count, -8.0), np.full(count, 4.0), np.zeros(count)


def _design(light: Array) -> Array:
    return np.concatenate([np.ones((len(light), 1)), light], axis=1)


def _linear(light: Array, xyz: Array, whitening: Array) -> Array:
    """Black and matrix (4, 3) of given curves by weighted least squares; no black is below 0."""
    design = _design(light)
    rows = np.einsum("nij,nk->nikj", whitening, design).reshape(-1, 12)
    target = np.einsum("nij,nj->ni", whitening, xyz).ravel()
    free = np.ones(12, dtype=bool)
    solution = np.zeros(12)
    for _ in range(4):  # a black that comes out below 0 is held at 0
        solution[:] = 0.0
        solution[free] = np.linalg.lstsq(rows[:, free], target, rcond=None)[0]
        below = np.zeros(12, dtype=bool)
        below[:3] = solution[:3] < 0.0
        if not below.any():
            break
        free &= ~below
    return solution.reshape(4, 3)
