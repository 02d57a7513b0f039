"""The triangles of every form for other programs: of pack.forms, and of the four exact shapes."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.pack.forms import mesh_of
from relgloss_view.pack.forms.patches import Patch, grid_triangles, joined
from relgloss_view.pack.label import label_of
from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.shape import Shape

#: Sides of a round form: a facet's middle lies 0.02 % of the radius too deep.
AROUND = 160
ROWS = AROUND // 2  #: of a sphere, from pole to pole
#: Of each face of a box: right, up and outwards, as Hit.surface_m of the shader's twin has them.
_FACES = {
    "right": ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
    "left": ((0, 0, 1), (0, 1, 0), (-1, 0, 0)),
    "top": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "bottom": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "front": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "back": ((-1, 0, 0), (0, 1, 0), (0, 0, -1)),
}


def triangles_of(shape: Shape) -> Mesh:
    """The triangles of any form, with the normals of its true surface.

    Raises InputError where a mesh file or a profile can't be used.

    >>> mesh = triangles_of(Shape("cylinder"))
    >>> mesh.parts, (2.0 * mesh.half_extent_m).round(6).tolist()
    (('side', 'top', 'bottom'), [0.085, 0.1, 0.085])
    """
    mesh = mesh_of(shape)
    if mesh is not None:
        return mesh
    makers = {"cylinder": _cylinder, "sphere": _sphere, "plane": _plane, "box": _box}
    label = label_of(shape)
    printed = tuple(part for part, prints in zip(label.parts, label.printed, strict=True) if prints)
    return joined(makers[shape.kind](shape), printed, label.size_m, around=label.around)


def _turn() -> tuple[Array, Array]:
    """Angles about y from the back to the back, 0 towards +z, and their directions (N, 3)."""
    angle = np.linspace(-np.pi, np.pi, AROUND + 1)
    out = np.stack([np.sin(angle), 0.0 * angle, np.cos(angle)], axis=-1)
    out[-1] = out[0]  # the seam closes bit by bit
    return angle, out


def _cylinder(shape: Shape) -> list[Patch]:
    radius, half = 0.5 * shape.diameter_m, 0.5 * shape.height_m
    angle, out = _turn()
    rings = [radius * out + (0.0, y, 0.0) for y in (-half, half)]
    label = [np.stack([radius * angle, 0.0 * angle + y], axis=-1) for y in (-half, half)]
    side = Patch(
        "side",
        np.concatenate(rings),
        np.concatenate([out, out]),
        np.concatenate(label),
        grid_triangles(2, AROUND + 1),
    )
    k = np.arange(AROUND)
    caps = []
    for name, y in (("top", half), ("bottom", -half)):
        points = np.concatenate([[[0.0, y, 0.0]], radius * out + (0.0, y, 0.0)])
        fan = np.stack([0 * k, 1 + k, 2 + k], axis=-1)
        normals = np.tile((0.0, np.sign(y), 0.0), (len(points), 1))
        caps.append(
            Patch(name, points, normals, points[:, [0, 2]], fan if y > 0.0 else fan[:, ::-1])
        )
    return [side, *caps]


def _sphere(shape: Shape) -> list[Patch]:
    radius = 0.5 * shape.diameter_m
    angle, out = _turn()
    latitude = np.linspace(-0.5 * np.pi, 0.5 * np.pi, ROWS + 1)
    across = np.cos(latitude)
    across[[0, -1]] = 0.0
    normals = across[:, None, None] * out
    normals[..., 1] = np.sin(latitude)[:, None]
    label = radius * np.stack(np.broadcast_arrays(angle, latitude[:, None]), axis=-1)
    triangles = grid_triangles(ROWS + 1, AROUND + 1)
    points = radius * normals.reshape(-1, 3)
    # At a pole a row of points is one place: half of its triangles have no area.
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=-1)
    kept = triangles[area > 1e-12 * radius * radius]
    return [Patch("body", points, normals.reshape(-1, 3), label.reshape(-1, 2), kept)]


def _plane(shape: Shape) -> list[Patch]:
    return [_face("front", 0.5 * np.array([shape.width_m, shape.height_m, 0.0]))]


def _box(shape: Shape) -> list[Patch]:
    half = 0.5 * np.array([shape.width_m, shape.height_m, shape.depth_m])
    return [_face(name, half) for name in _FACES]


def _face(name: str, half: Array) -> Patch:
    right, up, out = (np.array(axis, dtype=float) for axis in _FACES[name])
    width, height, depth = (float(np.abs(axis) @ half) for axis in (right, up, out))
    corners = np.array([(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)])
    label = corners * (width, height)
    points = label @ np.stack([right, up]) + depth * out
    return Patch(name, points, np.tile(out, (4, 1)), label, grid_triangles(2, 2))
