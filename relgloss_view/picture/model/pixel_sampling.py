"""How many samples a pixel needs, so that the narrowest lobe and the smallest grain count whole."""

from __future__ import annotations

import dataclasses
import math
from functools import lru_cache

import numpy as np

from relgloss_view.display.display import Display
from relgloss_view.pack import forms
from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.shape import CURVED
from relgloss_view.picture.model.lights import lamps_of
from relgloss_view.picture.model.sight import plane_normal
from relgloss_view.picture.model.view import Size, View
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import FurtherLamp, Lamp

MAX_SAMPLES = 16
#: Samples of a Gaussian lobe this many standard deviations apart sum to its energy within
#: 2 exp(-2 pi^2 / 1.5^2) = 0.03 %, and half of it beside the peak still sees 75 % of it.
STEP_SD = 1.5
#: A pixel up to so many times as large as a grain shows one draw of it, as the paper's pixel does.
#: The draws of neighbours are as good as independent there, and each stands for a grain this much
#: too large. Averaging inside the pixel begins above.
PIXELS_A_GRAIN = 1.1
#: Percentile of the curvature over a form's area: that of an ordinary place. Sharp edges and rims
#: are a small part of the picture, and highlights on them may stay undersampled.
TURN_PERCENTILE = 50.0


def sample_count(scene: Scene, look: Look, size: Size) -> int:
    """Samples along each side of a pixel: the look's, or as many as the narrowest lobe needs.

    Where a pixel holds several grains of one size at the eye, each has as many samples as the
    others.
    """
    count = samples_needed(scene, size) if look.samples is None else look.samples
    grains = eye_grain_samples(scene.display, grainiest(scene, look))
    return grains * math.ceil(count / grains)


def grainiest(scene: Scene, look: Look) -> Look:
    """The look with the largest sigma_N of a pack's finishes: what its grain needs to be drawn."""
    if scene.pack is None:
        return look
    own = (finish.sigma_n_deg for finish in scene.pack.finishes)
    largest = max(look.sigma_n_deg if sigma is None else sigma for sigma in own)
    return look if largest == look.sigma_n_deg else dataclasses.replace(look, sigma_n_deg=largest)


def eye_grain_samples(display: Display, look: Look) -> int:
    """Draws of a grain of one size at the eye along each side of a pixel, 1 to MAX_SAMPLES.

    >>> eye_grain_samples(Display(), Look(1.0, grain="eye"))
    1
    >>> eye_grain_samples(Display(viewing_distance_m=1.5), Look(1.0, grain="eye", grain_arcmin=0.3))
    3
    """
    if look.sigma_n_deg == 0.0 or look.grain != "eye":
        return 1
    pixels = display.pixel_arcmin / look.grain_arcmin
    return 1 if pixels <= PIXELS_A_GRAIN else min(MAX_SAMPLES, math.ceil(pixels))


def pixels_a_grain(scene: Scene, look: Look, size: Size) -> float:
    """Side of a pixel in sides of a grain; of a surface grain, where the object is nearest."""
    if look.grain == "screen":
        return 1.0 / look.grain_px
    if look.grain == "eye":
        return scene.display.pixel_arcmin / look.grain_arcmin
    return footprint_m(scene, size) / (1e-3 * look.grain_mm)


def footprint_m(scene: Scene, size: Size) -> float:
    """Side of the surface that a pixel sees where the object is nearest and faces the eye."""
    return View.of(scene, size).pixel_step * _depth_m(scene)


def _depth_m(scene: Scene) -> float:
    """Distance from the eye to the nearest of the object."""
    eye, half = scene.eye.distance_m, scene.shape.half_extent_m()
    mesh = forms.mesh_of(scene.shape)
    if mesh is not None:
        nearest = float(np.max(mesh.outline_m @ scene.eye.position_m)) / eye
        return max(eye - nearest, 1e-3 * eye)
    return max(eye - float(half[0] if scene.shape.kind in CURVED else half[2]), 1e-3 * eye)


def samples_needed(scene: Scene, size: Size) -> int:
    """Samples along each side of a pixel that keep the energy of the narrowest lobe.

    From one pixel to the next the half-vector turns against the normal by the surface's curvature
    and by the change of both directions. The estimate is for the highlight, where the normal lies
    halfway between eye and lamp.
    """
    if not any(material.visible_lobes() for material in scene.materials):
        return 1
    return max(_needed(scene, size, lamp) for lamp in lamps_of(scene.setup))


def _needed(scene: Scene, size: Size, lamp: Lamp | FurtherLamp) -> int:
    """The same for the highlight of one lamp, whose size widens the lobe."""
    eye, away = scene.eye.distance_m, lamp.distance_m
    half = scene.shape.half_extent_m()
    depth = _depth_m(scene)
    across_m = footprint_m(scene, size)
    turn = 0.5 * across_m * (1.0 / depth + 1.0 / away)
    mesh = forms.mesh_of(scene.shape)
    bent = curvature(mesh) if mesh else 0.0
    if scene.shape.kind in CURVED or bent > 0.0:
        cosine = float(scene.eye.position_m @ lamp.position_m) / (eye * away)
        cos_half = math.sqrt(max(0.5 * (1.0 + cosine), 0.01))
        turn += across_m * bent / cos_half if mesh else across_m / (float(half[0]) * cos_half)
    narrowest = min(lobe.s for material in scene.materials for lobe in material.visible_lobes())
    if lamp.radius_m > 0.0:
        narrowest = math.hypot(narrowest, 0.25 * math.atan2(lamp.radius_m, away))
    needed = turn / (STEP_SD * narrowest)
    return max(1, min(MAX_SAMPLES, math.ceil(needed)))


@lru_cache(maxsize=16)
def curvature(mesh: Mesh) -> float:
    """How fast the normals of triangles turn along the surface, 1/m, at half of its area or less.

    The turn along the edge of a triangle that has most of it; of a cylinder 1 over its radius.
    """
    points, normals = mesh.points_m[mesh.triangles], mesh.normals[mesh.triangles]
    steps, turns = (np.linalg.norm(v - np.roll(v, 1, axis=1), axis=-1) for v in (points, normals))
    fastest = np.max(turns / np.maximum(steps, 1e-9), axis=1, initial=0.0)
    area = np.linalg.norm(plane_normal(points), axis=-1)
    order = np.argsort(fastest)
    share = np.cumsum(area[order])
    if len(share) == 0 or share[-1] <= 0.0:
        return 0.0
    return float(fastest[order][np.searchsorted(share, 0.01 * TURN_PERCENTILE * share[-1])])
