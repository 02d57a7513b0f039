"""The triangles of a form as a page takes them: exact, and small in a file.

What turns about y has few numbers of its own: rings, and sines that they share. Other meshes come
as differences of their numbers' bits, column by column, which deflate well. js/mesh.js is the way
back.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from relgloss_view.base.arrays import AnyArray, Array
from relgloss_view.pack.mesh import Mesh
from relgloss_view.picture.gpu.triangles import WIDE
from relgloss_view.picture.model.pixel_sampling import curvature
from relgloss_view.proof.arrays import packed

FEWEST = 3  #: points of a ring


def mesh_drawing(mesh: Mesh) -> dict[str, Any]:
    """A mesh as JSON.

    `rings`, or `columns` of points, normals and label in float32 with `outline`, the corners of the
    hull in float64, from which the view follows. `triangles`: differences of the numbers of points.
    """
    steps = np.diff(np.asarray(mesh.triangles, dtype=np.int64), axis=0, prepend=0)
    return {
        "points": len(mesh.points_m),
        "wide": WIDE,
        "closed": mesh.is_closed,
        "half_extent_m": mesh.half_extent_m.tolist(),
        "curvature_per_m": curvature(mesh),
        "triangles": packed(np.ascontiguousarray(steps.T.astype(np.int32))),
        **(_rings(mesh) or _columns(mesh)),
    }


def _rings(mesh: Mesh) -> dict[str, Any] | None:
    """Rings about y whose points repeat the same directions; None where a number differs.

    ring: rows of first direction, count of points, part. numbers: rows of radius, height, the
    normal outwards and up, and the label's y. directions: rows of sine, cosine and the label's x.
    """
    points, normals, label = mesh.points_m, mesh.normals, mesh.label_m
    same = np.stack([points[:, 1], normals[:, 1], label[:, 1], mesh.part.astype(float)], axis=-1)
    other = np.any(np.diff(same, axis=0, prepend=np.nan) != 0.0, axis=1)
    begins = np.flatnonzero(other | (np.diff(label[:, 0], prepend=np.inf) < 0.0))
    counts = np.diff(np.append(begins, len(points)))
    if len(begins) == 0 or np.min(counts) < FEWEST:
        return None
    tables: dict[bytes, int] = {}
    directions: list[Array] = []
    ring, numbers, first = [], [], 0
    for begin, count in zip(begins, counts, strict=True):
        own = slice(begin, begin + count)
        x = label[own, 0]
        key = x.tobytes()
        if key not in tables:
            found = _directions(points, normals, label, begins, counts, x)
            if found is None:
                return None
            tables[key] = first
            directions.append(np.stack([*found, x], axis=-1))
            first += count
        sine, cosine = (np.concatenate(directions)[tables[key] :][:count, k] for k in (0, 1))
        radius = _factor(points[own], sine, cosine)
        out = _factor(normals[own], sine, cosine)
        if radius is None or out is None:
            return None
        ring.append((tables[key], count, mesh.part[begin]))
        numbers.append((radius, points[begin, 1], out, normals[begin, 1], label[begin, 1]))
    return {
        "ring": packed(np.array(ring, dtype=np.int32).T.copy()),
        "numbers": packed(np.array(numbers, dtype=np.float64).T.copy()),
        "directions": packed(np.concatenate(directions).T.copy()),
    }


def _directions(
    points: Array, normals: Array, label: Array, begins: AnyArray, counts: AnyArray, x: Array
) -> tuple[Array, Array] | None:
    """Sine and cosine of the points whose places on the label are `x`, of the profile's turns."""
    from relgloss_view.pack.forms.profile import directions_of

    for sides in (len(x) - 1, -len(x)):
        sine, cosine = directions_of(sides)
        for begin, count in zip(begins, counts, strict=True):
            own = slice(begin, begin + count)
            if np.array_equal(label[own, 0], x) and (
                _factor(points[own], sine, cosine) is not None
                and _factor(normals[own], sine, cosine) is not None
            ):
                return sine, cosine
    return None


def _factor(vectors: Array, sine: Array, cosine: Array) -> float | None:
    """The number by which sine and cosine are multiplied in x and z of all vectors, or None."""
    if len(sine) != len(vectors):
        return None
    largest = int(np.argmax(np.abs(cosine)))
    middle = float(vectors[largest, 2] / cosine[largest])
    for tried in (middle, np.nextafter(middle, -np.inf), np.nextafter(middle, np.inf)):
        if np.array_equal(vectors[:, 0], tried * sine) and np.array_equal(
            vectors[:, 2], tried * cosine
        ):
            return float(tried)
    return None


def _columns(mesh: Mesh) -> dict[str, Any]:
    columns = np.concatenate([mesh.points_m, mesh.normals, mesh.label_m], axis=1)
    bits = np.ascontiguousarray(columns.T.astype(np.float32)).view(np.uint32)
    steps = np.diff(bits, axis=1, prepend=np.uint32(0))  # they wrap, as the page's sums do
    part = np.diff(mesh.part.astype(np.int32), prepend=0)
    return {
        "columns": packed(steps),
        "part": packed(part.astype(np.int32)),
        "outline": packed(np.ascontiguousarray(_corners(mesh.outline_m).T)),
    }


def _corners(points: Array) -> Array:
    """The corners of the hull of points; all of them where it has no volume."""
    from scipy.spatial import ConvexHull, QhullError

    points = np.unique(points, axis=0)
    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except QhullError:
        return points
