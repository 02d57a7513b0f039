"""Patches: pieces of a form's surface, joined to one Mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.pack.mesh import Mesh


@dataclass(frozen=True)
class Patch:
    """Triangles of one part; arrays as in Mesh, `triangles` numbered from 0."""

    part: str
    points_m: Array
    normals: Array
    label_m: Array
    triangles: Ints


def joined(
    patches: list[Patch],
    printed: tuple[str, ...],
    label_size_m: tuple[float, float],
    *,
    around: bool = False,
    notes: tuple[str, ...] = (),
) -> Mesh:
    """The patches as one Mesh, with its bounding box centred at the origin.

    printed: names of the parts that artwork lies on. Parts keep the order of their first patch.
    """
    parts = tuple(dict.fromkeys(patch.part for patch in patches))
    counts = [len(patch.points_m) for patch in patches]
    first = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(int)
    points = np.concatenate([patch.points_m for patch in patches])
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return Mesh(
        points_m=points - centre,
        normals=np.concatenate([patch.normals for patch in patches]),
        label_m=np.concatenate([patch.label_m for patch in patches]),
        part=np.repeat([parts.index(patch.part) for patch in patches], counts),
        triangles=np.concatenate(
            [patch.triangles + k for patch, k in zip(patches, first, strict=True)]
        ),
        parts=parts,
        printed=tuple(name in printed for name in parts),
        label_size_m=(float(label_size_m[0]), float(label_size_m[1])),
        around=around,
        notes=notes,
    )


def grid_triangles(rows: int, columns: int) -> Ints:
    """Two triangles for each cell of a grid of points, numbered row by row.

    Counter-clockwise where columns run to the right and rows run up.

    >>> grid_triangles(2, 2).tolist()
    [[0, 1, 3], [0, 3, 2]]
    """
    row, column = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = (row * columns + column).ravel()
    b, c, d = a + 1, a + columns + 1, a + columns
    return np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], 1).reshape(-1, 3)
