"""Paint: the colour of an artwork under D50 as the albedo that a lamp meets.

An artwork holds XYZ under D50 and no spectrum. "lab" keeps its Lab: the lamp's white stands in
place of D50's (von Kries in XYZ, as Ishii et al.'s eqs. 1 to 3 do for the monitor). "spectral"
takes the spectrum of Mallett and Yuksel (2019), which is linear in sRGB, so that both are a matrix.
"""

from __future__ import annotations

import csv
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.icc.profile import D50
from relgloss_view.base.resources import asset
from relgloss_view.material import brdf
from relgloss_view.material.cielab import BRADFORD
from relgloss_view.material.spectra import (
    D65_XY,
    SRGB_PRIMARIES_XY,
    Illuminant,
    rgb_to_xyz_matrix,
    white_from_xy,
)


@lru_cache(maxsize=1)
def paint_from_rgb() -> Array:
    """Linear sRGB -> XYZ under D50, (3, 3): white is D50's, adapted by Bradford as profiles do.

    >>> (paint_from_rgb() @ np.ones(3)).round(6).tolist()
    [0.9642, 1.0, 0.8249]
    """
    responses = (BRADFORD @ D50) / (BRADFORD @ white_from_xy(D65_XY))
    adapted = np.linalg.solve(BRADFORD, responses[:, None] * BRADFORD)
    matrix = np.asarray(adapted @ rgb_to_xyz_matrix(SRGB_PRIMARIES_XY, D65_XY))
    matrix.setflags(write=False)
    return matrix


def paint_matrix(colour: str, lamp: Illuminant) -> Array:
    """XYZ under D50 -> XYZ of the albedo under a lamp, whose white has Y = 1, (3, 3).

    colour: one of pack.COLOUR_RULES.

    >>> from relgloss_view.material.spectra import illuminant
    >>> white = paint_matrix("lab", illuminant("A")) @ D50
    >>> bool(np.allclose(white, illuminant("A").white_xyz()))
    True
    """
    if colour == "lab":
        return np.diag(lamp.white_xyz() / D50)
    wavelengths, basis = _mallett_yuksel()
    grid, weights = lamp.weighted_observer
    spectra = np.stack([np.interp(grid, wavelengths, column) for column in basis.T])
    return np.asarray(weights @ spectra.T @ np.linalg.inv(paint_from_rgb()))


def second_paint(model: str, sigma: float, xyz: Array, alpha: Array) -> Array:
    """The paint of a model's second albedo, (..., 3), times alpha as `xyz` is.

    Exact for a spectrum that is flat inside each channel of linear sRGB: brdf.second_albedo channel
    by channel. sigma: of the model, radians.
    """
    covered = np.maximum(alpha, 1e-6)[..., None]
    rgb = np.clip((xyz / covered) @ np.linalg.inv(paint_from_rgb()).T, 0.0, 1.0)
    second = brdf.second_albedo(model, rgb, sigma) @ paint_from_rgb().T
    return np.asarray(alpha[..., None] * second)


@lru_cache(maxsize=1)
def _mallett_yuksel() -> tuple[Array, Array]:
    """Wavelengths (nm) and the spectra of red, green and blue, (N, 3); they sum to 1."""
    with asset("spectra", "mallett2019.csv").open(encoding="utf-8") as file:
        rows = [line for line in csv.reader(file) if line and not line[0].startswith("#")]
    table = np.array(rows[1:], dtype=np.float64)
    table.setflags(write=False)
    return table[:, 0], table[:, 1:]
