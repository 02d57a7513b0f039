"""BSDF XML with tensor trees, as Radiance's genBSDF, bsdf2ttree and relgloss write it.

A tree holds mean values of cells of directions, and a fit wants values of directions. So the cells
that hold the directions of gonio.tabulated_grid(), and more beside the mirror direction and towards
grazing incidence, are read at their middles, with what their means are above their middles taken
off (cell_middles). A tree too coarse for that has its means read, with the cells as an aperture.
"""

from __future__ import annotations

from typing import NamedTuple
from xml.etree.ElementTree import Element

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.xml import line_of
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.gonio import spherical, tabulated_grid
from relgloss_view.measure.readers.assemble import one_channel
from relgloss_view.measure.readers.cell_middles import middles_of
from relgloss_view.measure.readers.shirley_chiu import coordinates, directions
from relgloss_view.measure.readers.tensor_tree import (
    RADIANCE_WHITE,
    Tree,
    read_tree,
    xyz_of,
)
from relgloss_view.measure.readers.tristimulus import rgb_of

BASIS = "lbnl/shirley-chiu"
#: XYZ of the perfect diffuser under D65 (CIE 15:2004), which tristimulus.py takes as white.
D65_WHITE = np.array([0.95046, 1.0, 1.08906])
VISIBLE, CIE_U, CIE_V = "visible", "cie-u", "cie-v"
RANKS = {"tensortree3": 3, "tensortree4": 4}
#: Beside the mirror direction, degrees: a lobe may be narrower than the grid's scan of a degree.
BESIDE_DEG = (0.25, 0.5, 0.75, 1.5)
#: Incidence beyond that of the grid, degrees, where the gloss of papers and films is read, and the
#: receiver's angles beside the mirror direction there. Programs that make trees know no arms that
#: shadow each other.
GRAZING_DEG = (75.0,)
BESIDE_GRAZING_DEG = (*BESIDE_DEG, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0)
STEEPEST_DEG = 89.0
#: A middle that is less certain than this, as a share, is left out.
LARGEST_UNCERTAINTY = 0.05
#: Share of planes whose highest middle must be certain, or the means are read as they are.
MOST_PLANES = 0.5
#: A grazing plane with fewer readings is left out: a fit judges models by whole planes, and a
#: coarse tree has a cell or two there.
FEWEST_IN_PLANE = 5
#: Azimuths of the lamp at which a tree of four dimensions is read; those of three depend on none.
AZIMUTHS = {3: (180.0,), 4: (180.0, 225.0, 270.0, 315.0, 0.0, 45.0, 90.0, 135.0)}
NEAR_MIRROR_DEG = 3.0


class Readings(NamedTuple):
    """What of the trees serves as a measurement."""

    to_lamp: Array  #: (N, 3)
    to_receiver: Array
    group: Array  #: (N,), the nominal angle of incidence, degrees
    bands: Bands
    values: Array  #: (N, B), 1/sr
    cell_sd_deg: float  #: per-axis standard deviation of directions within the cells of the lobe
    notes: tuple[str, ...]


def tree_readings(structure: str, blocks: dict[str, Element], place: str) -> Readings:
    """Read the trees of one surface. Raises InputError, which begins with `place`.

    structure: IncidentDataStructure in lower case. blocks: WavelengthDataBlock by wavelength, in
    lower case.
    """
    rank = RANKS.get(structure)
    if rank is None:
        raise InputError(
            f"{place}: IncidentDataStructure {printable(structure, 30)!r}; expected TensorTree3 or "
            "TensorTree4"
        )
    if VISIBLE not in blocks:
        raise InputError(
            f"{place}: the tensor trees hold {printable(', '.join(blocks), 80)} only; export the "
            "BSDF for Visible"
        )
    luminance = _tree(blocks[VISIBLE], rank, place)
    to_lamp, to_receiver, group = _directions(luminance)
    taken, values, sd = _values(luminance, to_lamp, to_receiver, group)
    to_lamp, to_receiver, group = to_lamp[taken], to_receiver[taken], group[taken]
    places = coordinates(to_lamp, to_receiver, rank)
    notes = []
    if CIE_U in blocks and CIE_V in blocks:
        u, v = (_tree(blocks[key], rank, place).at(places) for key in (CIE_U, CIE_V))
        xyz = np.maximum(xyz_of(values, u, v), 0.0) / RADIANCE_WHITE * D65_WHITE
        # The sentence about an unknown white is not true here: Radiance's is that of equal energy.
        bands, channels, (_, *more) = rgb_of(xyz)
        notes += more
    else:
        bands, channels, gray = one_channel(values[:, None], VISIBLE)
        notes.append(gray)
    if rank == 4:
        notes.append(
            f"the tensor tree depends on the azimuth; {len(AZIMUTHS[4])} azimuths of incidence are "
            "read, and a material here is the same in all"
        )
    notes.append(_words(luminance, len(taken) - int(np.sum(taken)), sd))
    return Readings(to_lamp, to_receiver, group, bands, channels, sd, tuple(notes))


def _values(
    tree: Tree, to_lamp: Array, to_receiver: Array, group: Array
) -> tuple[Mask, Array, float]:
    """Which directions are read, their values, and the cells' aperture, which is 0 at middles."""
    leaves = tree.leaf_at(coordinates(to_lamp, to_receiver, tree.rank))
    means, middles = tree.values[leaves], middles_of(tree, leaves)
    certain = middles.uncertainty <= LARGEST_UNCERTAINTY
    planes = np.unique(group)
    highest = [int(np.argmax(np.where(group == plane, means, -1.0))) for plane in planes]
    if np.mean(certain[highest]) < MOST_PLANES:
        return np.full(len(means), True), means, _cell_sd_deg(tree, to_lamp, to_receiver)
    # A plane without its peak would show the foot of a highlight as if it were all of it.
    readings = np.array([np.sum(certain[group == plane]) for plane in planes])
    many = (readings >= FEWEST_IN_PLANE) | ~np.isin(planes, GRAZING_DEG)
    taken = certain & np.isin(group, planes[certain[highest] & many])
    return taken, middles.values[taken], 0.0


def _words(tree: Tree, left_out: int, sd: float) -> str:
    finest, resolved = 2.0 * tree.smallest, 0.5 * float(np.hypot(sd, sd))
    text = (
        f"each value is an average over a cell of a tensor tree (down to {finest:.2g} in the sine "
        "of the angle)"
    )
    if sd > 0.0:
        return (
            f"{text}: a highlight narrower than {resolved:.2g} deg of the half-vector is not "
            "resolved"
        )
    text += ", from which the value at its middle is derived by the cells beside it"
    if left_out:
        text += f"; {left_out} cells on steep flanks of the highlight are left out"
    return text


def _tree(block: Element, rank: int, place: str) -> Tree:
    where = f"{place}: line {line_of(block)}"
    basis = " ".join((block.findtext("AngleBasis") or "").split())
    if basis.lower() != BASIS:
        raise InputError(
            f"{where}: AngleBasis {printable(basis, 40)!r} of a tensor tree; expected "
            "LBNL/Shirley-Chiu"
        )
    kind = " ".join((block.findtext("ScatteringDataType") or "").split())
    if kind.lower() not in ("", "btdf", "brdf", "bsdf"):
        raise InputError(
            f"{where}: ScatteringDataType {printable(kind, 40)!r}; expected BRDF, in 1/sr"
        )
    return read_tree(block.findtext("ScatteringData") or "", rank, where)


def _directions(tree: Tree) -> tuple[Array, Array, Array]:
    """Middles of the cells about the wanted directions, (N, 3) each, and the nominal incidence."""
    theta_i, theta_r, phi = _wanted().T
    lamps, receivers, nominal = [], [], []
    for azimuth in AZIMUTHS[tree.rank]:
        lamps.append(spherical(theta_i, np.full_like(theta_i, azimuth)))
        receivers.append(spherical(theta_r, azimuth - phi))
        nominal.append(theta_i)
    places = coordinates(np.concatenate(lamps), np.concatenate(receivers), tree.rank)
    leaves: Ints
    leaves, first = np.unique(tree.leaf_at(places), return_index=True)
    # In the order of the directions, so that a file's warnings do not depend on its cells.
    order = np.argsort(first)
    leaves, first = leaves[order], first[order]
    to_lamp, to_receiver = directions(tree.middles(leaves))
    return to_lamp, to_receiver, np.concatenate(nominal)[first]


def _wanted() -> Array:
    """(theta_i, theta_r, phi) in degrees, phi 180 on the mirror's side."""
    grid = tabulated_grid()
    near = [
        (theta, abs(theta + side * beside), 180.0 if theta + side * beside >= 0.0 else 0.0)
        for theta in np.unique(grid[:, 0]).tolist()
        for beside in BESIDE_DEG
        for side in (-1.0, 1.0)
    ]
    grazing = [
        (theta, theta + side * beside, 180.0)
        for theta in GRAZING_DEG
        for beside in BESIDE_GRAZING_DEG
        for side in (-1.0, 1.0)
        if theta + side * beside <= STEEPEST_DEG
    ]
    return np.concatenate([grid, np.array(near), np.array(grazing)])


def _cell_sd_deg(tree: Tree, to_lamp: Array, to_receiver: Array) -> float:
    """The usual standard deviation, per axis, of a direction within a cell near the mirror's.

    A cell w wide in the disk has w / sqrt(12), which is 1 / cos(theta) times as much along the
    meridian; the mean over both axes.
    """
    half = to_lamp + to_receiver
    tilt = np.degrees(np.arctan2(np.hypot(half[:, 0], half[:, 1]), half[:, 2]))
    near = tilt < max(NEAR_MIRROR_DEG, float(np.min(tilt)))
    near = near if np.any(near) else np.ones(len(tilt), dtype=np.bool_)
    levels = tree.levels[tree.leaf_at(coordinates(to_lamp, to_receiver, tree.rank))]
    cos = np.maximum(np.minimum(to_lamp[:, 2], to_receiver[:, 2]), 0.1)
    width = 2.0 * 0.5**levels
    sd = np.degrees(width / np.sqrt(12.0)) * np.sqrt(0.5 * (1.0 + 1.0 / cos**2))
    return float(np.median(sd[near]))
