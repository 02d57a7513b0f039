"""The number of samples that a pixel needs so that the narrowest lobe keeps its energy."""

from __future__ import annotations

import math

from relgloss_view.picture.model.view import Size, View
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import CURVED

MAX_SAMPLES = 16
#: Samples of a Gaussian lobe this many standard deviations apart sum to its energy within
#: 2 exp(-2 pi^2 / 1.5^2) = 0.03 %, and half of it beside the peak still sees 75 % of it.
STEP_SD = 1.5


def sample_count(scene: Scene, look: Look, size: Size) -> int:
    """Samples along each side of a pixel: the look's, or as many as the narrowest lobe needs."""
    return samples_needed(scene, size) if look.samples is None else look.samples


def samples_needed(scene: Scene, size: Size) -> int:
    """Samples along each side of a pixel that keep the energy of the narrowest lobe.

    From one pixel to the next the half-vector turns against the normal by the surface's curvature
    and by the change of both directions. The estimate is for the highlight, where the normal lies
    halfway between eye and lamp.
    """
    lobes = scene.material.visible_lobes()
    if not lobes:
        return 1
    eye, lamp = scene.eye.distance_m, scene.lamp.distance_m
    half = scene.shape.half_extent_m()
    curved = scene.shape.kind in CURVED
    depth = max(eye - float(half[0] if curved else half[2]), 1e-3 * eye)
    footprint_m = View.of(scene, size).pixel_step * depth
    turn = 0.5 * footprint_m * (1.0 / depth + 1.0 / lamp)
    if curved:
        cosine = float(scene.eye.position_m @ scene.lamp.position_m) / (eye * lamp)
        cos_half = math.sqrt(max(0.5 * (1.0 + cosine), 0.01))
        turn += footprint_m / (float(half[0]) * cos_half)
    needed = turn / (STEP_SD * min(lobe.s for lobe in lobes))
    return max(1, min(MAX_SAMPLES, math.ceil(needed)))
