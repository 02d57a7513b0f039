"""Intersections of rays with the object. The twin of shaders/shape.glsl, in float64 over arrays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask


class Hit(NamedTuple):
    """Intersections of rays with the object; fields have the rays' shape, vectors (..., 3)."""

    found: Mask  #: whether the ray meets the object
    point_m: Array
    normal: Array
    surface_m: Array  #: (..., 2), coordinates along the surface
    face: Ints


def meet_cylinder(eye_m: Array, ray: Array, half_extent_m: Array) -> Hit:
    """Round cylinder about y, closed by two caps; half_extent_m = (radius, half height, radius)."""
    radius, half_height = half_extent_m[0], half_extent_m[1]
    dx, dy, dz = np.moveaxis(ray, -1, 0)
    length2 = dx * dx + dz * dz
    moment = eye_m[0] * dz - eye_m[2] * dx
    discriminant = radius * radius * length2 - moment * moment
    usable = (length2 > 0.0) & (discriminant >= 0.0)
    length2 = np.where(usable, length2, 1.0)
    root = np.sqrt(np.where(usable, discriminant, 0.0))
    travel = (-(eye_m[0] * dx + eye_m[2] * dz) - root) / length2
    y = eye_m[1] + travel * dy
    side = usable & (travel > 0.0) & (np.abs(y) <= half_height)
    nx = (moment * dz - root * dx) / (length2 * radius)
    nz = (-moment * dx - root * dz) / (length2 * radius)

    cap = np.copysign(half_height, eye_m[1])
    can_see_cap = (abs(eye_m[1]) > half_height) & (dy != 0.0)
    to_cap = np.where(can_see_cap, (cap - eye_m[1]) / np.where(dy != 0.0, dy, 1.0), -1.0)
    cx, cz = eye_m[0] + to_cap * dx, eye_m[2] + to_cap * dz
    on_cap = ~side & (to_cap > 0.0) & (cx * cx + cz * cz <= radius * radius)

    zero = np.zeros_like(nx)
    n = np.stack(
        [
            np.where(side, nx, 0.0),
            np.where(on_cap, np.sign(cap), 0.0),
            np.where(side, nz, np.where(on_cap, 0.0, 1.0)),
        ],
        axis=-1,
    )
    p_side = np.stack([nx * radius, y, nz * radius], axis=-1)
    p_cap = np.stack([cx, zero + cap, cz], axis=-1)
    s_side = np.stack([np.arctan2(nx, nz) * radius, y], axis=-1)
    s_cap = np.stack([cx, cz], axis=-1)
    point = np.where(side[..., None], p_side, np.where(on_cap[..., None], p_cap, 0.0))
    surface = np.where(side[..., None], s_side, np.where(on_cap[..., None], s_cap, 0.0))
    face = np.where(on_cap, 1 if cap > 0.0 else 2, 0)
    return Hit(side | on_cap, point, n, surface, face)


def meet_sphere(eye_m: Array, ray: Array, half_extent_m: Array) -> Hit:
    """Sphere of radius half_extent_m[0]."""
    radius = half_extent_m[0]
    length2 = np.sum(ray * ray, axis=-1)
    moment = np.cross(eye_m, ray)
    discriminant = radius * radius * length2 - np.sum(moment * moment, axis=-1)
    root = np.sqrt(np.maximum(discriminant, 0.0))
    found = (discriminant >= 0.0) & (-(ray @ eye_m) - root > 0.0)
    n = (np.cross(ray, moment) - root[..., None] * ray) / (length2 * radius)[..., None]
    n = np.where(found[..., None], n, np.array([0.0, 0.0, 1.0]))
    n = n / np.linalg.norm(n, axis=-1, keepdims=True)
    latitude = np.arcsin(np.clip(n[..., 1], -1.0, 1.0))
    surface = radius * np.stack([np.arctan2(n[..., 0], n[..., 2]), latitude], axis=-1)
    point = np.where(found[..., None], n * radius, 0.0)
    return Hit(found, point, n, surface, np.zeros(found.shape, dtype=np.int64))


def meet_plane(eye_m: Array, ray: Array, half_extent_m: Array) -> Hit:
    """Rectangle in x-y that faces +z; nothing is seen from behind."""
    dz = ray[..., 2]
    facing = (eye_m[2] > 0.0) & (dz < 0.0)
    travel = np.where(facing, -eye_m[2] / np.where(facing, dz, -1.0), 0.0)
    p = eye_m[:2] + travel[..., None] * ray[..., :2]
    found = facing & np.all(np.abs(p) <= half_extent_m[:2], axis=-1)
    p = np.where(found[..., None], p, 0.0)
    point = np.concatenate([p, np.zeros((*found.shape, 1))], axis=-1)
    n = np.broadcast_to(np.array([0.0, 0.0, 1.0]), point.shape)
    return Hit(found, point, n, p, np.zeros(found.shape, dtype=np.int64))


def meet_box(eye_m: Array, ray: Array, half_extent_m: Array) -> Hit:
    """Box by its slabs (Kay, Kajiya 1986); a face is met only from outside."""
    shape = ray.shape[:-1]
    found = np.zeros(shape, dtype=bool)
    point, normal = np.zeros(ray.shape), np.zeros(ray.shape)
    normal[..., 2] = 1.0
    surface, face = np.zeros((*shape, 2)), np.zeros(shape, dtype=np.int64)
    for axis in range(3):
        side = 1.0 if eye_m[axis] > 0.0 else -1.0
        if abs(eye_m[axis]) <= half_extent_m[axis]:
            continue
        facing = ray[..., axis] * side < 0.0
        distance = side * half_extent_m[axis] - eye_m[axis]
        travel = np.where(facing, distance / np.where(facing, ray[..., axis], 1.0), -1.0)
        p = eye_m + travel[..., None] * ray
        p[..., axis] = side * half_extent_m[axis]
        met = ~found & (travel > 0.0) & np.all(np.abs(p) <= half_extent_m, axis=-1)
        found |= met
        point[met] = p[met]
        normal[met] = side * np.eye(3)[axis]
        surface[met] = p[met][:, ((2, 1), (0, 2), (0, 1))[axis]]
        face[met] = 2 * axis + (0 if side > 0.0 else 1)
    return Hit(found, point, normal, surface, face)


_MEET = {
    "cylinder": meet_cylinder,
    "sphere": meet_sphere,
    "plane": meet_plane,
    "box": meet_box,
}


def meet(kind: str, eye_m: Array, ray: Array, half_extent_m: Array) -> Hit:
    """First intersection of rays with the named shape.

    eye_m: (3,), origin, metres. ray: (..., 3), directions of any length. half_extent_m: (3,).

    >>> eye, ray = np.array([0.0, 0.0, 0.6]), np.array([[0.0, 0.0, -1.0]])
    >>> meet("sphere", eye, ray, np.full(3, 0.04)).point_m.tolist()
    [[0.0, 0.0, 0.04]]
    """
    return _MEET[kind](eye_m, ray, half_extent_m)


def surface_cell(kind: str, hit: Hit, cell_m: float, half_extent_m: Array) -> Ints:
    """Grain cell on the surface (column, row, face), (..., 3).

    A whole number of cells goes around a cylinder or a row of a sphere, so that no seam shows.
    """
    row = np.floor(hit.surface_m[..., 1] / cell_m)
    column = np.floor(hit.surface_m[..., 0] / cell_m)
    if kind in ("cylinder", "sphere"):
        turn = 2.0 * np.pi * half_extent_m[0]
        latitude = (row + 0.5) * cell_m / half_extent_m[0] if kind == "sphere" else 0.0 * row
        columns = np.maximum(1.0, np.floor(turn * np.cos(latitude) / cell_m + 0.5))
        place = np.floor((hit.surface_m[..., 0] / turn + 0.5) * columns)
        column = np.where(hit.face == 0, np.minimum(place, columns - 1.0), column)
    return np.stack([column.astype(np.int64), row.astype(np.int64), hit.face], axis=-1)


#: Turns the lattice of solid_cell, so that flat faces of an object do not lie along it; rows are
#: orthonormal.
LATTICE = np.array([[2.0, 3.0, 6.0], [3.0, -6.0, 2.0], [6.0, 2.0, -3.0]]) / 7.0
#: Side of a cube whose sections have on average the area of a square of side 1: a plane cuts
#: through a cube of side a in 2/3 a^2 on average (its volume over its mean width 3/2 a).
SECTION = 1.5**0.5


def solid_cell(point_m: Array, cell_m: float) -> Ints:
    """Grain cell in space of points (..., 3): three numbers of a turned cubic lattice, (..., 3).

    A surface cuts the cubes in cells of the mean area cell_m^2, without seams, whatever its form.

    >>> solid_cell(np.zeros((1, 3)), 1e-3).tolist()
    [[0, 0, 0]]
    """
    return np.floor((point_m @ LATTICE.T) / (SECTION * cell_m)).astype(np.int64)
