"""Bands x illuminant -> XYZ, exactly: one weight for each band and tristimulus value.

A BRDF that is a sum of spectra times shapes folds into one XYZ triple a spectrum, so a picture
needs three channels only. The lamp is summed on its own fine grid and never at the band centres:
sampling a discharge lamp at 10 nm moves its white by several dE.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable, unreadable
from relgloss_view.base.resources import asset
from relgloss_view.material.lamp_file import EXPECTED as LAMP_FILE
from relgloss_view.material.lamp_file import read_lamp
from relgloss_view.material.lamp_names import lamp_table
from relgloss_view.measure.bands import REC2020, SRGB, Bands

#: Linear sRGB to XYZ, IEC 61966-2-1:1999 with its primaries and D65 (0.3127, 0.3290) carried to
#: full precision, so that white is exactly Y = 1.
SRGB_PRIMARIES_XY = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06))
D65_XY = (0.3127, 0.3290)
#: Of each Bands.primaries; those of ITU-R BT.2020 have the same white.
PRIMARIES_XY = {
    SRGB: SRGB_PRIMARIES_XY,
    REC2020: ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046)),
}
SHIPPED_ILLUMINANTS = ("HP5", "D65", "D50", "A", "C")
#: Endings that no named lamp has: such a name is a file, and colour-science need not be asked.
LAMP_SUFFIXES = (".csv", ".txt", ".tsv", ".dat")


def rgb_to_xyz_matrix(
    primaries_xy: tuple[tuple[float, float], ...], white_xy: tuple[float, float]
) -> Array:
    """Matrix from linear RGB to XYZ with white at Y = 1, shape (3, 3) (SMPTE RP 177:1993).

    primaries_xy: chromaticities of red, green and blue. white_xy: that of white.

    >>> rgb_to_xyz_matrix(SRGB_PRIMARIES_XY, D65_XY).round(4)[1].tolist()  # luminance of sRGB
    [0.2126, 0.7152, 0.0722]
    """
    columns = np.array([(x / y, 1.0, (1.0 - x - y) / y) for x, y in primaries_xy]).T
    scale = np.linalg.solve(columns, white_from_xy(white_xy))
    return np.asarray(columns * scale)


def xy_of(xyz: Array) -> tuple[float, float]:
    """Chromaticity of XYZ (3,); of no light, that of equal energy.

    >>> xy_of(np.array([1.0, 1.0, 2.0]))
    (0.25, 0.25)
    """
    total = float(np.sum(xyz))
    if total <= 0.0:
        return 1.0 / 3.0, 1.0 / 3.0
    return float(xyz[0] / total), float(xyz[1] / total)


def white_from_xy(xy: tuple[float, float]) -> Array:
    """XYZ of a white of chromaticity (x, y) with Y = 1.

    >>> white_from_xy(D65_XY).round(4).tolist()
    [0.9505, 1.0, 1.0891]
    """
    x, y = xy
    return np.array([x / y, 1.0, (1.0 - x - y) / y])


@dataclass(frozen=True)
class Illuminant:
    """A lamp's relative spectral power on a regular or irregular grid of at most 10 nm.

    wavelengths_nm: increasing, nanometres. power: relative, 0 or more. notes: what was passed over
    in its file.
    """

    name: str
    wavelengths_nm: tuple[float, ...]
    power: tuple[float, ...]
    notes: tuple[str, ...] = ()

    @cached_property
    def weighted_observer(self) -> tuple[Array, Array]:
        """The lamp's grid and S(l) times the CIE 1931 observer times the step, Y summing to 1."""
        grid = np.asarray(self.wavelengths_nm)
        table = observer()
        inside = (grid >= table[0, 0]) & (grid <= table[-1, 0])
        grid, power = grid[inside], np.asarray(self.power)[inside]
        matching = np.stack([np.interp(grid, table[:, 0], table[:, k]) for k in (1, 2, 3)])
        product = matching * power * np.gradient(grid)
        return grid, np.asarray(product / np.sum(product[1]))

    @cached_property
    def _white(self) -> Array:
        white = np.asarray(np.sum(self.weighted_observer[1], axis=1))
        white.setflags(write=False)
        return white

    def white_xyz(self) -> Array:
        """XYZ of the perfect diffuser under this lamp, Y = 1; not to be written to."""
        return self._white


def illuminant(name: str) -> Illuminant:
    """A lamp by name, or from a file of two columns.

    name: HP5, D65, D50, A, C, another name of colour-science, or a file of wavelength (nm) and
    relative power. A lamp's name comes before a file of that name. An edited file is read again.
    Raises InputError where neither exists or the file is no such table.

    >>> illuminant("D65").white_xyz().round(3).tolist()
    [0.95, 1.0, 1.089]
    """
    if is_lamp_name(name):
        return _named(name)
    try:
        state = os.stat(name)
    except FileNotFoundError as error:
        if Path(name).suffix.lower() in LAMP_SUFFIXES:
            raise unreadable(name, error, LAMP_FILE) from None
        raise InputError(
            f"illuminant {printable(name, 150)!r}: neither a name that colour-science has, such "
            "as D65, A, FL2 or HP5, nor a file of wavelength (nm) and power"
        ) from None
    except (OSError, ValueError) as error:
        raise unreadable(name, error, LAMP_FILE) from None
    return _from_file(name, state.st_mtime_ns, state.st_size)


def is_lamp_name(name: str) -> bool:
    """Whether a name is a lamp's and not a file's."""
    if name in SHIPPED_ILLUMINANTS:
        return True
    if Path(name).suffix.lower() in LAMP_SUFFIXES:
        return False
    return lamp_table(name) is not None


@lru_cache(maxsize=32)
def _named(name: str) -> Illuminant:
    if name in SHIPPED_ILLUMINANTS:
        return _illuminant_file(asset("spectra", f"{name}.csv"), name)
    table = lamp_table(name)
    assert table is not None
    return _white(Illuminant(name, *table), name)


@lru_cache(maxsize=32)
def _from_file(name: str, mtime_ns: int, size: int) -> Illuminant:
    """The lamp in a file; time and size are arguments so that an edited file is a new key."""
    return _illuminant_file(Path(name), Path(name).stem)


def _white(lamp: Illuminant, place: str) -> Illuminant:
    """The lamp, if a perfect diffuser under it has a colour; InputError otherwise."""
    with np.errstate(all="ignore"):
        white = lamp.white_xyz()
    if not (np.all(np.isfinite(white)) and np.all(white > 0.0)):
        raise InputError(
            f"{place}: X, Y and Z of its white must be above 0; it needs power from the blue to "
            "the red"
        )
    return lamp


#: Steps of a regular table differ by at most this factor: instruments round their wavelengths.
EVEN_STEPS = 1.25
SHARE_MARGIN = (
    1e-4  #: of a line's share in `light_weights`, so that rounding leaves nothing negative
)


@lru_cache(maxsize=64)
def xyz_weights(bands: Bands, lamp: Illuminant, *, convex: bool = False) -> Array:
    """Weights W (B, 3): XYZ of reflectances R is R @ W, and R = 1 gives the lamp's white, Y = 1.

    Reflectance between band centres is interpolated as by `interpolation_matrix`: cubic where the
    bands are evenly spaced, linear elsewhere. Beyond the outer bands it is constant, so their
    weights include the rest. convex: linear everywhere, so that no weight is below zero; see
    `light_weights`. Linear RGB reflectances are relative to D65; ratios of XYZ carry them to the
    lamp's white.

    >>> weights = xyz_weights(Bands((400.0, 500.0, 600.0, 700.0)), illuminant("D65"))
    >>> weights.sum(axis=0).round(3).tolist()  # the white of D65
    [0.95, 1.0, 1.089]
    """
    if bands.is_rgb:
        matrix = rgb_to_xyz_matrix(PRIMARIES_XY[bands.primaries], D65_XY)
        return np.asarray((matrix * (lamp.white_xyz() / white_from_xy(D65_XY))[:, None]).T)
    grid, weighted = lamp.weighted_observer
    made = linear_matrix if convex else interpolation_matrix
    return np.asarray((weighted @ made(bands.centres_nm(), grid)).T)


def light_weights(spectra: Sequence[ArrayLike], bands: Bands, lamp: Illuminant) -> Array:
    """Weights W (B, 3) under which none of some spectra, (B,) each and 0 or more, is negative.

    Those of `xyz_weights`, unless the cubic's overshoot beside a lone band makes X, Y or Z of a
    spectrum negative. Then the bands are interpolated by a mean of cubic and line, with the
    smallest share of the line that leaves nothing negative: observer and lamp are nowhere negative,
    so neither is any sum of them with a line between bands. One share serves all spectra of a
    material, since a picture mixes them.

    >>> bands, lamp = Bands(tuple(np.arange(400.0, 701.0, 50.0))), illuminant("D65")
    >>> lone = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    >>> (lone @ xyz_weights(bands, lamp)).round(3).tolist()  # Z of a lone band at 550 nm
    [0.217, 0.461, -0.009]
    >>> (lone @ light_weights([lone], bands, lamp)).round(3).tolist()
    [0.217, 0.45, 0.0]
    """
    cubic = xyz_weights(bands, lamp)
    folded = np.array([np.asarray(values) @ cubic for values in spectra])
    if np.all(folded >= 0.0):
        return cubic
    convex = xyz_weights(bands, lamp, convex=True)
    lines = np.array([np.asarray(values) @ convex for values in spectra])
    below = folded < 0.0
    share = float(np.max(folded[below] / (folded[below] - lines[below])))
    share = min(share * (1.0 + SHARE_MARGIN), 1.0)
    mixed = (1.0 - share) * cubic + share * convex
    if all(np.all(np.asarray(values) @ mixed >= 0.0) for values in spectra):
        return mixed
    return convex


def interpolation_matrix(centres: Array, grid: Array) -> Array:
    """Interpolation matrix (G, B) from band centres to a grid, without overshoot at uneven bands.

    Where the bands that surround an interval are evenly spaced: cubic Lagrange, quadratic in the
    outer intervals (ASTM E2022; CIE 15:2004 allows it beside Sprague's polynomial). CIE 15:2004
    recommends a cubic spline for other bands, but a polynomial through bands 1 nm and 278 nm apart
    swings far beyond its values. There the interpolation is linear: every value lies between
    those of the two bands beside it.

    >>> uneven = np.array([380.0, 500.0, 501.0, 502.0, 780.0])
    >>> interpolation_matrix(uneven, np.array([440.0])).tolist()
    [[0.5, 0.5, 0.0, 0.0, 0.0]]
    """
    matrix = lagrange_matrix(centres, grid)
    interval = _intervals(centres, grid)
    windows = [
        np.diff(centres[max(k - 1, 0) : min(k + 3, len(centres))])
        for k in range(max(len(centres) - 1, 1))
    ]
    even = np.array(
        [len(steps) == 0 or np.max(steps) <= EVEN_STEPS * np.min(steps) for steps in windows]
    )
    uneven = ~even[interval]
    matrix[uneven] = linear_matrix(centres, grid[uneven])
    return matrix


def linear_matrix(centres: Array, grid: Array) -> Array:
    """Linear interpolation matrix (G, B) from band centres to a grid; no entry is below zero.

    >>> linear_matrix(np.array([400.0, 500.0]), np.array([380.0, 425.0])).tolist()
    [[1.0, 0.0], [0.75, 0.25]]
    """
    each = np.eye(len(centres))
    return np.stack([np.interp(grid, centres, one) for one in each], axis=-1)


def _intervals(centres: Array, grid: Array) -> Ints:
    """The interval between band centres in which each place of a grid lies, (G,)."""
    last = max(len(centres) - 2, 0)
    return np.asarray(np.clip(np.searchsorted(centres, grid, side="right") - 1, 0, last))


def lagrange_matrix(centres: Array, grid: Array) -> Array:
    """Interpolation matrix (G, B) from band centres to a grid; both increasing, any spacing.

    >>> lagrange_matrix(np.array([400.0, 410.0]), np.array([405.0])).tolist()
    [[0.5, 0.5]]
    """
    count = len(centres)
    matrix = np.zeros((len(grid), count))
    inside = np.clip(grid, centres[0], centres[-1])
    for row, (x, k) in enumerate(zip(inside, _intervals(centres, grid), strict=True)):
        nodes = np.arange(max(k - 1, 0), min(k + 3, count))
        for j in nodes:
            others = nodes[nodes != j]
            factors = (x - centres[others]) / (centres[j] - centres[others])
            matrix[row, j] = np.prod(factors)
    return matrix


@lru_cache(maxsize=1)
def observer() -> Array:
    """The CIE 1931 standard observer, (N, 4): wavelength in nm and the three functions."""
    with asset("spectra", "cie1931_2deg.csv").open(encoding="utf-8") as file:
        rows = [line for line in csv.reader(file) if line and not line[0].startswith("#")]
    return np.array(rows[1:], dtype=np.float64)


def _illuminant_file(path: Path, name: str) -> Illuminant:
    table = read_lamp(path)
    notes = tuple(f"{path.name}: {note}" for note in table.notes)
    return _white(Illuminant(name, table.wavelengths_nm, table.power, notes), str(path))
