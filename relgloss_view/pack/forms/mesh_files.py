"""Mesh files."""

from __future__ import annotations

import numpy as np
import functools
import os
from relgloss_view.base.reading import check_regular
from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.shape import UNITS


def read_mesh(file: str, unit: str) -> Mesh:
    """A mesh file's triangles."""
    check_regular(file, "a mesh (.glb, .gltf, .obj, .ply, .stl)")
    stamp = os.stat(file)
    return _read(os.path.abspath(file), unit, stamp.st_mtime_ns, stamp.st_size)


@functools.lru_cache(maxsize=4)
def _read(file: str, unit: str, stamp: int, size: int) -> Mesh:
    import trimesh

    loaded = trimesh.load(file, process=False, force="mesh")
    scale = UNITS.get(unit, 1.0)
    points = np.array(loaded.vertices, dtype=float) * scale
    points -= 0.5 * (points.min(0) + points.max(0))
    uv = getattr(loaded.visual, "uv", None)
    label = np.zeros((len(points), 2)) if uv is None else (np.array(uv, dtype=float) - 0.5) * 0.2
    return Mesh(
        points,
        np.array(loaded.vertex_normals, dtype=float),
        label,
        np.zeros(len(points), dtype=int),
        np.array(loaded.faces, dtype=int),
        label_size_m=(0.2, 0.2),
    )
