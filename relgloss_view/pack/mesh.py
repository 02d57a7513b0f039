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

    @cached_property
    def is_closed(self) -> bool:
        """Whether the triangles bound a solid: each edge is passed as often one way as the other.

        Points at the same place, in float32, are one point. What is inside out is not closed.
        """
        points = self.points_m.astype(np.float32)
        order = np.lexsort(points.T)
        steps = np.any(np.diff(points[order], axis=0, prepend=np.nan) != 0.0, axis=1)
        place = np.empty(len(points), dtype=np.int64)
        place[order] = np.cumsum(steps)
        corners = place[self.triangles]
        following = np.roll(corners, -1, axis=1)
        wide = len(points) + 1
        there = np.sort((corners * wide + following).ravel())
        back = np.sort((following * wide + corners).ravel())
        a, b, c = (self.points_m[self.triangles[:, k]] for k in range(3))
        volume = float(np.sum(a * np.cross(b, c)))
        return bool(np.array_equal(there, back)) and volume > 0.0

    def contains(self, point_m: Array) -> bool:
        """Whether a point is inside: the triangles fill more than half of what is seen from it.

        The winding number of Jacobson, Kavan and Sorkine-Hornung 2013, which stands holes too, of
        solid angles by Van Oosterom and Strackee 1983.
        """
        a, b, c = (self.points_m[self.triangles[:, k]] - np.asarray(point_m) for k in range(3))
        la, lb, lc = (np.sqrt(np.einsum("ij,ij->i", v, v)) for v in (a, b, c))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c))
        ab, bc, ca = (np.einsum("ij,ij->i", *pair) for pair in ((a, b), (b, c), (c, a)))
        angle = np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb)
        return bool(np.sum(angle) > np.pi)
