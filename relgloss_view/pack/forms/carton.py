"""Carton: a box with rounded edges, whose panels lie on one unfolded artwork."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.pack.forms.patches import Patch, grid_triangles, joined
from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.shape import Shape

PANELS = ("front", "right", "back", "left", "top", "bottom")
#: Of each panel: which axes run right, up and outwards on its artwork, as columns of a matrix.
_AXES = {
    "front": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "right": ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
    "back": ((-1, 0, 0), (0, 1, 0), (0, 0, -1)),
    "left": ((0, 0, 1), (0, 1, 0), (-1, 0, 0)),
    "top": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "bottom": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
}
DEEPEST = 2e-6  #: metres that the middle of a facet of an edge lies too deep, at most
EDGE_NOTE = "The edge radius is made smaller, so that it fits the smallest side."


def carton(shape: Shape) -> Mesh:
    """A folding carton: edges are quarter cylinders, corners eighths of spheres.

    Label: the front in the middle, left of it the left panel, right of it the right one and then
    the back; the top above the front, the bottom below it. Each panel reaches to the middle of its
    edges; lengths on the label are those on the surface. Parts: one for each panel, all printed.
    """
    full = np.array([shape.width_m, shape.height_m, shape.depth_m])
    radius = min(shape.edge_radius_m, 0.5 * float(full.min()))
    notes = (EDGE_NOTE,) if radius < shape.edge_radius_m else ()
    core = 0.5 * full - radius
    core[core < 1e-9 * full] = 0.0
    # The length of a panel on the label: its flat part, and half of an edge on either side.
    width, height, depth = 2.0 * core + 0.5 * np.pi * radius
    middles = {
        "front": (0.0, 0.0),
        "right": (0.5 * (width + depth), 0.0),
        "back": (width + depth, 0.0),
        "left": (-0.5 * (width + depth), 0.0),
        "top": (0.0, 0.5 * (height + depth)),
        "bottom": (0.0, -0.5 * (height + depth)),
    }
    patches = [_panel(name, core, radius, middles[name]) for name in PANELS]
    size = (2.0 * (width + depth), height + 2.0 * depth)
    return joined(patches, PANELS, size, around=True, notes=notes)


def _panel(name: str, core: Array, radius: float, middle: tuple[float, float]) -> Patch:
    right, up, out = (np.array(axis, dtype=float) for axis in _AXES[name])
    half = np.abs(np.stack([right, up, out])) @ core
    columns, column_turns = _nodes(half[0], radius)
    rows, row_turns = _nodes(half[1], radius)
    x, y = np.meshgrid(columns, rows)
    across, along = np.meshgrid(column_turns, row_turns)
    # In a corner, lines of equal angle of both edges: the mesh of a cube blown up to a sphere.
    local = np.stack([_tangent(across), _tangent(along), np.ones_like(across)], axis=-1)
    frame = np.stack([right, up, out])
    directions = local.reshape(-1, 3) @ frame
    normals = directions / np.sqrt(np.sum(directions**2, axis=1))[:, None]
    flat = np.stack([x, y, np.full_like(x, half[2])], axis=-1).reshape(-1, 3) @ frame
    label = np.stack(
        [middle[0] + x + radius * across, middle[1] + y + radius * along], axis=-1
    ).reshape(-1, 2)
    triangles = grid_triangles(len(rows), len(columns))
    return Patch(name, flat + radius * normals, normals, label, triangles)


def _nodes(half: float, radius: float) -> tuple[Array, Array]:
    """Places along one side of a panel: of its flat part, and the angle within an edge."""
    if radius <= 0.0:
        return np.array([-half, half]), np.zeros(2)
    step = 2.0 * np.arccos(max(1.0 - DEEPEST / radius, 0.5))
    count = int(np.clip(np.ceil(0.25 * np.pi / step), 3, 64))
    turns = np.linspace(0.0, 0.25 * np.pi, count + 1)
    if half <= 0.0:
        turns = np.concatenate([-turns[:0:-1], turns])
        return np.zeros(len(turns)), turns
    flat = np.repeat([-half, half], count + 1)
    return flat, np.concatenate([-turns[::-1], turns])


def _tangent(turns: Array) -> Array:
    """tan, exactly 1 at the end, where panels meet."""
    return np.where(np.abs(turns) == 0.25 * np.pi, np.sign(turns), np.tan(turns))
