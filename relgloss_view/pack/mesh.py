"""Mesh: the triangles of a form, with normals and the place of each point on the label."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from relgloss_view.base.arrays import Array, Ints


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles whose bounding box is centred at the origin; a value: its arrays are not written.

    points_m: (V, 3), metres. normals: (V, 3), unit vectors outwards, of the true surface rather
    than of its facets. label_m: (V, 2), the place on the label, metres to the right and up from
    the label's centre, which faces the default eye. part: (V,), number of the part in `parts` that
    a point belongs to; the three points of a triangle belong to one part.
    triangles: (T, 3), numbers of points, counter-clockwise seen from outside.
    parts: names such as 'body', 'neck', 'lid'. printed: whether artwork lies on each part.
    label_size_m: width and height of the label. around: whether its left edge meets its right one.
    notes: what a user should know of it, one sentence each.

    Two meshes are equal where they are the same object.
    """

    points_m: Array
    normals: Array
    label_m: Array
    part: Ints
    triangles: Ints
    parts: tuple[str, ...] = ("body",)
    printed: tuple[bool, ...] = (True,)
    label_size_m: tuple[float, float] = (0.1, 0.1)
    around: bool = False
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in ("points_m", "normals", "label_m", "part", "triangles"):
            getattr(self, name).setflags(write=False)

    @cached_property
    def half_extent_m(self) -> Array:
        """Half the bounding box, (3,)."""
        return np.asarray(np.max(np.abs(self.points_m), axis=0))

    @cached_property
    def outline_m(self) -> Array:
        """(N, 3), the points of its triangles, whose hull is that of the mesh."""
        used = self.points_m[np.unique(self.triangles)]
        return used if len(used) else np.zeros((1, 3))

    def winding_number(self, point_m: Array) -> float:
        """How often the mesh goes around a point: 1 inside a closed mesh, 0 outside it.

        Of a mesh with holes it is the share of all directions that are closed off. It is the sum of
        the triangles' solid angles (Van Oosterom, Strackee 1983) over 4 pi.
        """
        a, b, c = np.moveaxis(self.points_m[self.triangles] - point_m, 1, 0)
        la, lb, lc = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
        volume = np.sum(a * np.cross(b, c), axis=-1)
        products = np.sum(a * b, axis=-1) * lc + np.sum(b * c, axis=-1) * la
        denominator = la * lb * lc + products + np.sum(c * a, axis=-1) * lb
        return float(np.sum(np.arctan2(volume, denominator)) / (2.0 * np.pi))
