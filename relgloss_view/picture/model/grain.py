"""The normal of a grain at points of the object. The twin of shaders/grain.glsl."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.display.display import Display
from relgloss_view.pack.shape import ANALYTIC
from relgloss_view.picture.model import grain_field, noise, shape
from relgloss_view.picture.model.pixel_sampling import eye_grain_samples, grainiest
from relgloss_view.picture.model.view import float32
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene

CENTRE = (0.5, 0.5)


def field_step(display: Display, look: Look) -> float:
    """Steps of the lattice from one texel of the field to the next, rounded to float32."""
    texel_arcmin = display.pixel_arcmin / eye_grain_samples(display, look)
    return float(np.float32(grain_field.CELL_STEPS * texel_arcmin / look.grain_arcmin))


def grain_normal(
    scene: Scene,
    look: Look,
    hit: shape.Hit,
    o: Array,
    pixel: Ints,
    place: tuple[float, float] = CENTRE,
    sigma_n_deg: Array | None = None,
) -> Array:
    """Unit normals (..., 3) as the grain tilts them.

    hit: points of the object. o: unit vectors (..., 3) to the eye. pixel: (..., 2), column and row
    in which each point is seen. place: where in the pixel, 0 to 1 from its left and its top.
    sigma_n_deg: (...), of each point of a pack, in place of the look's.
    """
    look = grainiest(scene, look)
    if look.sigma_n_deg == 0.0:
        return hit.normal
    sigma = np.asarray(np.radians(look.sigma_n_deg if sigma_n_deg is None else sigma_n_deg))
    if look.grain == "eye":
        samples = eye_grain_samples(scene.display, look)
        inside = np.array([int(part * samples) for part in place])
        texel = (samples * pixel + inside) % grain_field.FIELD_TILE
        at = (texel + 0.5) * field_step(scene.display, look)
        tilt = grain_field.smooth_tilt(look.noise_law, at, look.seed)
        return noise.visible_tilt(hit.normal, o, sigma[..., None] * tilt)
    if look.grain == "screen":
        face = np.zeros_like(pixel[..., :1])
        cell = np.concatenate([pixel // look.grain_px, face], axis=-1)
    else:
        grain_m = float(np.float32(look.grain_mm * 1e-3))
        if scene.shape.kind in ANALYTIC:
            half_extent_m = float32(scene.shape.half_extent_m())
            cell = shape.surface_cell(scene.shape.kind, hit, grain_m, half_extent_m)
        else:
            cell = shape.solid_cell(hit.point_m, grain_m)
    hashes = noise.cell_hash(cell, look.seed)
    if sigma_n_deg is None:
        return noise.noisy_normal(look.noise_law, hit.normal, o, hashes, float(sigma))
    if look.noise_law == "none":
        return hit.normal
    tilt = sigma[..., None] * noise.tilt_angles(look.noise_law, hashes, 1.0)
    return noise.visible_tilt(hit.normal, o, tilt)
