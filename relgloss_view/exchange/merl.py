"""MERL binary out: the BRDF at the bins of half and difference angle (Matusik et al. 2003).

The file holds 90 x 90 x 180 bins a channel; bin edges of theta_h lie at (k / 90)^2 90 degrees, so
that a narrow lobe is followed (Rusinkiewicz 1998 for the angles). Each bin holds the value at its
middle; a bin whose middle has a direction below the horizon holds -1, as in the database.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.writing import whole_file
from relgloss_view.exchange.channels import TableSurface, in_rgb, metal_notes
from relgloss_view.exchange.formats import Exported, ExportOptions
from relgloss_view.exchange.judge import compare
from relgloss_view.exchange.refit import colour_notes
from relgloss_view.material.material import Material
from relgloss_view.measure.readers.merl import HEADER, SCALE, SHAPE, MerlBrdf
from relgloss_view.pack.pack import Pack

BELOW = -1.0


def write(what: Material | Pack, path: Path, options: ExportOptions) -> Exported:
    """Write a material; see exchange.formats.Writer."""
    assert isinstance(what, Material)  # Format.write refuses packs
    table = table_of(what)
    loss = compare(what, TableSurface(table.evaluate))
    with whole_file(path) as temporary, temporary.open("wb") as file:
        file.write(HEADER)
        file.write(np.ascontiguousarray(table.bins, dtype="<f8").tobytes())
    lines = (
        loss.verdict,
        f"in the file: {loss.words}",
        "carried: the BRDF in linear sRGB at the middles of 90 x 90 x 180 bins",
        "lost: the spectrum, the model and the evidence of the fit; the format holds no words",
        *(f"lost: {note}" for note in colour_notes(what)),
        *metal_notes(what),
    )
    return Exported(lines, {what.name: loss})


def table_of(material: Material) -> MerlBrdf:
    """The bins of a material, as the file stores them: BRDF over SCALE, -1 below the horizon."""
    folded = in_rgb(material)
    bins = np.empty((3, *SHAPE))
    theta_d = np.radians(np.arange(SHAPE[1]) + 0.5)[:, None]
    phi_d = np.radians(np.arange(SHAPE[2]) + 0.5)[None, :]
    for k in range(SHAPE[0]):
        theta_h = np.radians((k + 0.5) ** 2 / SHAPE[0])
        i, o = directions(theta_h, theta_d, phi_d)
        value = np.maximum(folded.brdf(i, o), 0.0) / SCALE
        value[(i[:, 2] <= 0.0) | (o[:, 2] <= 0.0)] = BELOW
        bins[:, k] = value.T.reshape(3, *SHAPE[1:])
    return MerlBrdf(bins)


def directions(theta_h: float, theta_d: Array, phi_d: Array) -> tuple[Array, Array]:
    """Unit vectors to lamp and eye, (M, 3) each, of angles in radians that broadcast.

    The half-vector lies at azimuth 0; i is turned from it by theta_d at azimuth phi_d, and o is i
    mirrored at it (Rusinkiewicz 1998).
    """
    sin_d = np.sin(theta_d)
    x, y = sin_d * np.cos(phi_d), sin_d * np.sin(phi_d)
    z = np.broadcast_to(np.cos(theta_d), x.shape)
    sin_h, cos_h = np.sin(theta_h), np.cos(theta_h)

    def turned(x: Array, y: Array) -> Array:
        return np.stack([x * cos_h + z * sin_h, y, z * cos_h - x * sin_h], axis=-1).reshape(-1, 3)

    return turned(x, y), turned(-x, -y)
