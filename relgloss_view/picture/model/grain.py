"""The normal of a grain at points of the object. The twin of shaders/grain.glsl."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.picture.model import noise, shape
from relgloss_view.picture.model.view import float32
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene


def grain_normal(scene: Scene, look: Look, hit: shape.Hit, o: Array, pixel: Ints) -> Array:
    """Unit normals (..., 3) as the grain tilts them.

    hit: points of the object. o: unit vectors (..., 3) to the eye. pixel: (..., 2), column and row
    in which each point is seen.
    """
    if look.sigma_n_deg == 0.0:
        return hit.normal
    if look.grain == "screen":
        face = np.zeros_like(pixel[..., :1])
        cell = np.concatenate([pixel // look.grain_px, face], axis=-1)
    else:
        grain_m = float(np.float32(look.grain_mm * 1e-3))
        half_extent_m = float32(scene.shape.half_extent_m())
        cell = shape.surface_cell(scene.shape.kind, hit, grain_m, half_extent_m)
    hashes = noise.cell_hash(cell, look.seed)
    return noise.noisy_normal(look.noise_law, hit.normal, o, hashes, np.radians(look.sigma_n_deg))
