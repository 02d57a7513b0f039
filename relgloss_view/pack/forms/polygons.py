"""Polygons of mesh files as triangles: fans where they fit, ears where a polygon is concave.

Source: Meisters 1975 (every simple polygon has two ears); the normal is Newell's (Sutherland,
Sproull and Schumacker 1974).
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array, Ints

MOST_CONCAVE = 20_000  #: corners of concave polygons that are cut ear by ear; the rest become fans


def triangulated(points: Array) -> Ints:
    """Corners (N, n - 2, 3), numbers 0 to n - 1, of the triangles of N polygons (N, n, 3).

    A convex polygon is the fan about its first corner, a concave one that about another, where
    such a fan stays inside. Others are cut ear by ear.
    """
    count, size = points.shape[:2]
    k = np.arange(1, size - 1)
    fan = np.stack([np.zeros_like(k), k, k + 1], axis=-1)
    chosen = np.broadcast_to(fan, (count, size - 2, 3)).copy()
    if size == 3 or not count:
        return chosen
    with np.errstate(all="ignore"):
        points = points - points[:, :1]
        normal = np.cross(points, np.roll(points, -1, axis=1)).sum(axis=1)
        left = np.flatnonzero(~_inside(points, fan, normal))
        for first in range(1, size):
            if not len(left):
                break
            turned = (fan + first) % size
            fits = _inside(points[left], turned, normal[left])
            chosen[left[fits]] = turned
            left = left[~fits]
        for number in left[: MOST_CONCAVE // size]:
            chosen[number] = _ears(points[number], normal[number])
    return chosen


def _inside(
    points: Array, triangles: Ints, normal: Array
) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Whether all triangles of each polygon run about it as it does itself."""
    a, b, c = (points[:, triangles[:, k]] for k in range(3))
    along = np.einsum("ptk,pk->pt", np.cross(b - a, c - a), normal)
    size = np.einsum("pk,pk->p", normal, normal)
    return np.asarray((along >= -1e-9 * size[:, None]).all(axis=1))


def _ears(points: Array, normal: Array) -> Ints:
    """The triangles (n - 2, 3) of one polygon (n, 3)."""
    drop = int(np.argmax(np.abs(normal)))
    flat = np.delete(points, drop, axis=1)
    if (normal[drop] < 0.0) != (drop == 1):  # counter-clockwise in the plane
        flat = flat * [-1.0, 1.0]
    corners, found = list(range(len(points))), []
    while len(corners) > 3:
        place = next((p for p in range(len(corners)) if _is_ear(flat, corners, p)), 1)
        around = [corners[place - 1], corners[place], corners[(place + 1) % len(corners)]]
        found.append(around)
        del corners[place]
    return np.array([*found, corners], dtype=np.int64)


def _is_ear(flat: Array, corners: list[int], place: int) -> bool:
    a, b, c = (flat[corners[(place + k) % len(corners)]] for k in (-1, 0, 1))
    if _turn(a, b, c) <= 0.0:
        return False
    others = flat[[o for k, o in enumerate(corners) if (k - place + 1) % len(corners) > 2]]
    within = (
        (_turn(a, b, others) >= 0.0) & (_turn(b, c, others) >= 0.0) & (_turn(c, a, others) >= 0.0)
    )
    same = (others == a).all(axis=1) | (others == b).all(axis=1) | (others == c).all(axis=1)
    return not bool((within & ~same).any())


def _turn(a: Array, b: Array, c: Array) -> Array:
    """Twice the area of triangles, positive where they run counter-clockwise."""
    return np.asarray((b[0] - a[0]) * (c[..., 1] - a[1]) - (b[1] - a[1]) * (c[..., 0] - a[0]))
