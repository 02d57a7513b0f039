"""A reflectance spectrum of a given colour: smooth, within 0 to 1, and exactly of that colour.

Many spectra have one colour. This is the least hyperbolic tangent slope squared of Burns (2019,
"Numerical methods for smoothest reflectance reconstruction", Color Research and Application 45):
R = (1 + tanh z) / 2, where z has the least sum of squared slopes. No printed ink is known better
from three numbers; docs/method.md has how far colours under another lamp are from the true ones.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import numbers_of
from relgloss_view.material.cielab import xyz_from_lab
from relgloss_view.material.spectra import illuminant as lamp_of
from relgloss_view.material.spectra import xyz_weights
from relgloss_view.measure.bands import Bands

LAB_LIGHTEST = 100.0
CHROMA_MAX = 200.0  #: of a* and b*; optimal colours end below it
#: Bands finer than this share a value of z with linear interpolation: no spectrum here has detail.
MOST_KNOTS = 80
XYZ_TOLERANCE = 1e-13  #: of XYZ with Y = 1 for white
NEWTON_STEPS = 30
MOST_STEPS = 24  #: on the way from mid gray to the colour
LARGEST_Z = 18.0  #: tanh of more is 1 in float64
RGB_MARGIN = 1e-10
DUAL_STEPS = 200
DUAL_TOLERANCE = 1e-11
LIGHTNESS_TOLERANCE = 0.05  #: of the nearest possible lightness in a message


class Knots(NamedTuple):
    """Values of z at K wavelengths, from which those at B bands follow."""

    spread: Array  #: (B, K)
    roughness: Array  #: (K, K), the sum of squared slopes is z @ roughness @ z


def check_lab(lab: ArrayLike, place: str = "lab") -> Array:
    """L*, a*, b* as numbers, (3,); InputError where they are out of range.

    >>> check_lab((50, 60, 20)).tolist()
    [50.0, 60.0, 20.0]
    """
    values = tuple(np.asarray(lab, dtype=object).ravel().tolist())
    if len(values) != 3:
        raise InputError(f"{place}: expected three numbers L, a, b such as 50, 60, 20")
    lightness = numbers_of(values[:1], place, "L from 0 to 100", 0.0, LAB_LIGHTEST)
    expected = f"a and b from -{CHROMA_MAX:g} to {CHROMA_MAX:g}"
    chroma = numbers_of(values[1:], place, expected, -CHROMA_MAX, CHROMA_MAX)
    return np.array([*lightness, *chroma])


def lab_to_spectrum(lab: ArrayLike, bands: Bands, illuminant: str = "D50") -> Array:
    """The smooth reflectance (B,), 0 to 1, of a colour under a lamp, to 1e-9 in Lab.

    lab: L*, a*, b* of the CIE 1931 observer (2 degrees) under the lamp, by spectra.xyz_weights.
    bands: of the result; linear RGB has one reflectance for each colour. illuminant: a lamp's name
    or file. Source: Burns 2019. Raises InputError where no reflectance has that colour (the limits
    of Schroedinger 1920 and MacAdam 1935), with the nearest possible lightness.

    >>> bands = Bands(tuple(np.arange(400.0, 701.0, 10.0)))
    >>> gray = lab_to_spectrum((50.0, 0.0, 0.0), bands)
    >>> gray.min().round(4).tolist(), gray.max().round(4).tolist()  # ((50 + 16) / 116)^3
    (0.1842, 0.1842)
    """
    wanted = check_lab(lab)
    lamp = lamp_of(illuminant)
    weights = xyz_weights(bands, lamp)
    white = lamp.white_xyz()
    spectrum = xyz_to_spectrum(xyz_from_lab(wanted, white), bands, weights)
    if spectrum is None:
        raise InputError(impossible(wanted, bands, illuminant))
    return spectrum


def xyz_to_spectrum(xyz: Array, bands: Bands, weights: Array) -> Array | None:
    """The smooth reflectance (B,), 0 to 1, of an XYZ (3,); None where no reflectance has it.

    weights: (B, 3), under which 1 is white with Y = 1.
    """
    start = _feasible(xyz, bands, weights)
    if start is None or bands.is_rgb or np.ptp(start) == 0.0:
        return start
    smooth = _smoothest(xyz, weights, _knots(bands))
    return start if smooth is None else smooth


def possible(xyz: Array, bands: Bands, weights: Array) -> bool:
    """Whether some reflectance from 0 to 1 has an XYZ (3,)."""
    return _feasible(xyz, bands, weights) is not None


def _feasible(xyz: Array, bands: Bands, weights: Array) -> Array | None:
    """Any reflectance (B,) of an XYZ (3,); None where there is none."""
    if not bands.is_rgb:
        gray = _neutral(xyz, weights)
        return _dual_spectrum(xyz, weights) if gray is None else gray
    channels = np.linalg.solve(weights.T, xyz)
    inside = np.all((channels >= -RGB_MARGIN) & (channels <= 1.0 + RGB_MARGIN))
    return np.clip(channels, 0.0, 1.0) if inside else None


def _neutral(xyz: Array, weights: Array) -> Array | None:
    """The constant reflectance (B,) of a gray's XYZ; None of another colour's, or beyond white."""
    white = np.sum(weights, axis=0)
    level = float(np.mean(xyz / white))
    if not np.allclose(xyz, level * white, rtol=0.0, atol=XYZ_TOLERANCE):
        return None
    inside = -XYZ_TOLERANCE <= level <= 1.0 + XYZ_TOLERANCE
    return np.full(len(weights), min(max(level, 0.0), 1.0)) if inside else None


def nearest_lightness(lab: Array, bands: Bands, illuminant: str) -> float | None:
    """The lightness nearest to a Lab's at which its a* and b* are possible; None without one."""
    lamp = lamp_of(illuminant)
    weights, white = xyz_weights(bands, lamp), lamp.white_xyz()

    def fits(lightness: float) -> bool:
        return possible(xyz_from_lab(np.array([lightness, *lab[1:]]), white), bands, weights)

    steps = sorted(np.arange(0.5, 100.0, 0.5), key=lambda value: abs(value - lab[0]))
    near = next((float(value) for value in steps if fits(value)), None)
    if near is None:
        return None
    far = float(np.clip(lab[0], near - 0.5, near + 0.5))
    while abs(near - far) > LIGHTNESS_TOLERANCE:
        middle = 0.5 * (near + far)
        near, far = (middle, far) if fits(middle) else (near, middle)
    return near


def impossible(lab: Array, bands: Bands, illuminant: str) -> str:
    """The sentence that refuses a colour which no reflectance has."""
    near = nearest_lightness(lab, bands, illuminant)
    words = f"lab {', '.join(f'{value:g}' for value in lab)}: "
    if bands.is_rgb:
        words += f"a material of {bands.words} can't have this colour"
    else:
        words += f"no reflectance has this colour under {illuminant}"
    if near is None:
        return f"{words}, whatever its lightness; use a and b nearer to 0"
    if near < lab[0]:
        return f"{words}; with these a and b, L can be at most {math.floor(10.0 * near) / 10.0:g}"
    return f"{words}; with these a and b, L must be at least {math.ceil(10.0 * near) / 10.0:g}"


@lru_cache(maxsize=16)
def _knots(bands: Bands) -> Knots:
    """Where z is free: at each band, or at fewer wavelengths where the bands are very many."""
    centres = bands.centres_nm()
    places = centres
    if len(centres) > MOST_KNOTS:
        places = np.interp(np.linspace(0, 1, MOST_KNOTS), np.linspace(0, 1, len(centres)), centres)
    each = np.eye(len(places))
    spread = np.stack([np.interp(centres, places, one) for one in each], axis=-1)
    slopes = np.diff(each, axis=0) / np.sqrt(np.diff(places) / np.mean(np.diff(places)))[:, None]
    return Knots(spread, slopes.T @ slopes)


def _smoothest(xyz: Array, weights: Array, knots: Knots) -> Array | None:
    """Burns' spectrum by Newton's method, from mid gray in steps that it can follow."""
    count = knots.roughness.shape[0]
    gray = 0.5 * np.sum(weights, axis=0)
    state: tuple[Array, Array] = np.zeros(count), np.zeros(3)
    reached, step = 0.0, 1.0
    for _ in range(MOST_STEPS):
        aim = min(reached + step, 1.0)
        after = _newton(gray + aim * (xyz - gray), weights, knots, state)
        if after is None:
            step *= 0.5
            continue
        state, reached, step = after, aim, 2.0 * step
        if reached == 1.0:
            return np.asarray(0.5 + 0.5 * np.tanh(knots.spread @ state[0]))
    return None


def _newton(
    xyz: Array, weights: Array, knots: Knots, state: tuple[Array, Array]
) -> tuple[Array, Array] | None:
    """z and the multipliers of the colour from a start nearby; None where they don't settle."""
    z, multipliers = state
    count = len(z)
    system = np.zeros((count + 3, count + 3))
    for _ in range(NEWTON_STEPS):
        bands_z = knots.spread @ z
        if np.max(np.abs(bands_z)) > LARGEST_Z:
            return None
        tanh = np.tanh(bands_z)
        slope = 0.5 * (1.0 - tanh * tanh)
        weighted = knots.spread.T @ (slope[:, None] * weights)
        off = (0.5 + 0.5 * tanh) @ weights - xyz
        gradient = knots.roughness @ z + weighted @ multipliers
        if np.max(np.abs(off)) < XYZ_TOLERANCE and np.max(np.abs(gradient)) < 1e-9:
            return z, multipliers
        curvature = -2.0 * tanh * slope * (weights @ multipliers)
        system[:count, :count] = knots.roughness + knots.spread.T @ (
            curvature[:, None] * knots.spread
        )
        system[:count, count:], system[count:, :count] = weighted, weighted.T
        try:
            move = np.linalg.solve(system, -np.concatenate([gradient, off]))
        except np.linalg.LinAlgError:
            return None
        if not np.all(np.isfinite(move)):
            return None
        z, multipliers = z + move[:count], multipliers + move[count:]
    return None


def _dual_spectrum(xyz: Array, weights: Array) -> Array | None:
    """A reflectance inside 0 to 1 of this XYZ; None where there is none.

    The one of largest binary entropy, R = 1 / (1 + exp(-w.k)): three numbers k, found by Newton's
    method on the convex dual. Where k grows without end its direction is the normal of a plane that
    parts the XYZ from all reflectances, whose furthest ones are the optimal colours (1 where w.k is
    above zero, 0 elsewhere; Schroedinger 1920), so the colour is impossible.
    """
    # Columns of one size make the Newton steps well scaled.
    scale = np.sum(np.abs(weights), axis=0)
    scaled, target = weights / scale, xyz / scale

    def dual(k: Array) -> float:
        return float(np.sum(np.logaddexp(0.0, scaled @ k)) - target @ k)

    k = np.zeros(3)
    value = dual(k)
    for _ in range(DUAL_STEPS):
        spectrum = 0.5 + 0.5 * np.tanh(0.5 * (scaled @ k))
        gradient = spectrum @ scaled - target
        if np.max(np.abs(gradient)) < DUAL_TOLERANCE:
            return np.asarray(spectrum)
        furthest = np.sum(np.maximum(scaled @ k, 0.0))
        if target @ k > furthest + DUAL_TOLERANCE * np.max(np.abs(k)):
            return None
        hessian = (scaled * (spectrum * (1.0 - spectrum))[:, None]).T @ scaled
        hessian += 1e-14 * np.trace(hessian) * np.eye(3)
        try:
            move = np.linalg.solve(hessian, -gradient)
        except np.linalg.LinAlgError:
            return None
        size, slope = 1.0, float(gradient @ move)
        # The value can't resolve the last steps.
        rounding = 1e-15 * max(len(weights), abs(value), float(np.max(np.abs(k))))
        while size > 1e-10 and dual(k + size * move) > value + 1e-4 * size * slope + rounding:
            size *= 0.5
        k = k + size * move
        value = dual(k)
    return None
