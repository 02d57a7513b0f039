"""Concavity: how much of a form faces the form itself.

A picture has no shadow that the object casts on itself and no light that one part of it throws on
another. That is right for convex forms; elsewhere a warning names the share of the surface that is
concerned.
"""

from __future__ import annotations

import weakref

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.pack.mesh import Mesh

#: A point counts where at least this share of its sky, weighted by the cosine, is the object.
SEEN_SHARE = 0.05
#: Above this share of the surface a picture is warned about. The usual can has 0.13 (neck, lid and
#: base), the pouch 0.05, the bottle 0.03, the carton 0.
LARGEST_SHARE = 0.2
DIRECTIONS = 96  #: of the sphere of skies
POINTS = 4000  #: places of the surface that see and are seen
CELLS = 40  #: along each side of a depth map, over the object's diameter
#: Nearer than so many cells in depth the surface is taken as the point's own neighbourhood.
NEAR_CELLS = 1.5
LOWEST_COSINE = 0.15  #: of a direction above a point's horizon; below it depth maps are too coarse

_known: weakref.WeakKeyDictionary[Mesh, float] = weakref.WeakKeyDictionary()


def concavity(mesh: Mesh) -> float:
    """Share of a form's surface that sees the form itself, 0 to 1; 0 for every convex form.

    A point of the surface sees it where SEEN_SHARE of its sky (weighted by the cosine to its
    normal, as light is) is covered. By depth maps along DIRECTIONS of points spread evenly over
    the area, so dents below a fortieth of the object's size are not found. The same mesh has the
    same number, remembered.
    """
    if mesh not in _known:
        _known[mesh] = _concavity(mesh)
    return _known[mesh]


def concavity_note(mesh: Mesh) -> str | None:
    """The warning of a form that sees much of itself; None for others."""
    share = concavity(mesh)
    if share <= LARGEST_SHARE:
        return None
    return (
        f"{100.0 * share:.0f} % of the form's surface faces other parts of it: shadows and light "
        "that they cast on each other are left out of the picture"
    )


def _concavity(mesh: Mesh) -> float:
    points, normals = _spread(mesh)
    if len(points) == 0:
        return 0.0
    size = float(np.max(np.linalg.norm(points, axis=-1))) or 1.0
    cell = 2.0 * size / CELLS
    covered, sky = np.zeros(len(points)), np.zeros(len(points))
    for w in _directions(DIRECTIONS):
        cosine = normals @ w
        depth = points @ w
        right = np.cross(w, (0.0, 1.0, 0.0) if abs(w[1]) < 0.9 else (1.0, 0.0, 0.0))
        right /= np.linalg.norm(right)
        up = np.cross(right, w)
        column = np.floor((points @ right + size) / cell).astype(np.int64)
        row = np.floor((points @ up + size) / cell).astype(np.int64)
        cells = np.clip(row, 0, CELLS) * (CELLS + 1) + np.clip(column, 0, CELLS)
        farthest = np.full((CELLS + 1) ** 2, -np.inf)
        np.maximum.at(farthest, cells, depth)
        above = cosine > LOWEST_COSINE
        # Points of one cell lie on a plane that is at most this much deeper across it.
        slope = cell * (NEAR_CELLS + np.sqrt(2.0) / np.maximum(cosine, LOWEST_COSINE))
        blocked = above & (farthest[cells] > depth + slope)
        sky += np.where(above, cosine, 0.0)
        covered += np.where(blocked, cosine, 0.0)
    seen = covered >= SEEN_SHARE * np.maximum(sky, 1e-12)
    return float(np.mean(seen & (sky > 0.0)))


def _spread(mesh: Mesh) -> tuple[Array, Array]:
    """POINTS places of equal area and their normals, (N, 3) each, the same for the same mesh."""
    corners = mesh.points_m[mesh.triangles]
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=-1
    )
    total = np.cumsum(area)
    if len(total) == 0 or not total[-1] > 0.0:
        return np.zeros((0, 3)), np.zeros((0, 3))
    rng = np.random.default_rng(0)
    at = (np.arange(POINTS) + 0.5) / POINTS * total[-1]
    chosen = np.minimum(np.searchsorted(total, at), len(total) - 1)
    u, v = rng.random((2, POINTS))
    flipped = u + v > 1.0
    u, v = np.where(flipped, 1.0 - u, u), np.where(flipped, 1.0 - v, v)
    weights = np.stack([1.0 - u - v, u, v], axis=-1)[..., None]
    normals = np.sum(weights * mesh.normals[mesh.triangles[chosen]], axis=1)
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    return np.sum(weights * corners[chosen], axis=1), normals / np.maximum(length, 1e-12)


def _directions(count: int) -> Array:
    """Directions spread evenly over the sphere: a spiral of the golden angle (Swinbank 2006)."""
    z = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(count)
    flat = np.sqrt(1.0 - z * z)
    return np.stack([flat * np.cos(turn), z, flat * np.sin(turn)], axis=-1)
