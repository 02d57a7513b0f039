"""Lamp placement: lamp, and for flat forms eye, turned so that a highlight lies on the form.

Geometry alone, whatever the material: a lamp in the mirror direction of a visible point puts the
middle of every lobe there. The paper's cylinder has its highlight at an incidence of 25 degrees.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.pack import forms
from relgloss_view.pack.mesh import Mesh
from relgloss_view.picture.model.highlight import SIZE, best_mirror
from relgloss_view.picture.model.sight import sight
from relgloss_view.picture.model.view import Size, view_of
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup

#: Degrees between normal and lamp; the lower end is a little below the paper's own 24.8.
INCIDENCE_DEG = (24.0, 35.0)
FLAT = ("plane", "box", "carton")  #: forms whose highlight needs the eye in the right place
NEAR_MIRROR_DEG = 1.0  #: a present highlight within this of the mirror direction is one
PLACES = 41  #: along each side of the searched part of the picture
#: Wanted distance from the edges, share of the deepest point of the form: the side of a curved form
#: is where the incidence is, and the highlight of a flat one is broad.
DEPTH, FLAT_DEPTH = 0.45, 0.8
EYE_TURNS_DEG = (0.0, *(sign * turn for turn in range(5, 61, 5) for sign in (-1.0, 1.0)))

# What a place costs, in degrees of change that it is worth.
TOO_STEEP, TOO_FLAT = 8.0, 1.0  #: a degree of incidence below and above the wanted ones
EDGE = 150.0  #: the edge itself, against the wanted depth
SMALL_FACE = 60.0  #: a face of no size, against the one with the deepest point
EYE = 3.0  #: a degree of the eye, against one of the lamp


@dataclass(frozen=True)
class _Places:
    """Visible points of a form, (N, ...) each."""

    point_m: Array
    normal: Array
    to_eye: Array  #: (N, 3), unit
    depth: Array  #: distance from the edges of its face, 0 to 1, of the deepest point of all
    face_depth: Array  #: the same of the deepest point of its face


def lit_for_gloss(setup: Setup, size: Size = SIZE, *, turn_eye: bool = True) -> Setup:
    """The setup with its lamp turned so that a highlight lies well on the form.

    setup: its lamp keeps its distance. size: of the picture, pixels, for its shape. turn_eye: on
    flat forms the eye may turn about y too; curved forms never need that.

    The highlight lies inside what the picture shows, away from edges, at an incidence of
    INCIDENCE_DEG where the form has such a place, with the smallest turn of lamp and eye. A setup
    that shows one already is returned as it is; so is one where no lamp at this distance would do,
    as where the eye sees nothing.

    >>> from relgloss_view.pack.shape import Shape
    >>> lit_for_gloss(Setup()) == Setup()
    True
    >>> turned = lit_for_gloss(Setup(Shape("plane")))
    >>> best_mirror(turned).tilt_deg < 0.1
    True
    """
    return _lit(setup, size, turn_eye, forms.mesh_of(setup.shape))


@lru_cache(maxsize=64)
def _lit(setup: Setup, size: Size, turn_eye: bool, _mesh: Mesh | None) -> Setup:
    if _lies_well(setup, size):
        return setup
    flat = setup.shape.kind in FLAT
    best, least = setup, math.inf
    for turn in EYE_TURNS_DEG if flat and turn_eye else (0.0,):
        if EYE * abs(turn) >= least:
            break
        eye = _turned(setup.eye, turn)
        found = _cheapest(setup.placed(eye=eye), size)
        if found is not None and found[0] + EYE * abs(turn) < least:
            least = found[0] + EYE * abs(turn)
            best = setup.placed(eye=eye, lamp=found[1])
    return best


def _lies_well(setup: Setup, size: Size) -> bool:
    """Whether the present highlight is where a better one would not be looked for."""
    highlight = best_mirror(setup, size)
    if highlight is None or highlight.tilt_deg > NEAR_MIRROR_DEG:
        return False
    low, high = INCIDENCE_DEG
    if not low <= highlight.incidence_deg <= high + 10.0:
        return False
    places = _visible(setup, size)
    if places is None:
        return False
    nearest = np.argmin(np.linalg.norm(places.point_m - highlight.point_m, axis=-1))
    return bool(places.depth[nearest] >= 0.5 * DEPTH)


def _cheapest(setup: Setup, size: Size) -> tuple[float, Lamp] | None:
    """The place that costs least under this eye, and the lamp that makes the highlight there."""
    places = _visible(setup, size)
    if places is None:
        return None
    mu = np.sum(places.normal * places.to_eye, axis=-1)
    mirrored = 2.0 * mu[:, None] * places.normal - places.to_eye
    # Along the mirrored ray, where the lamp's distance from the centre is kept.
    along = np.sum(places.point_m * mirrored, axis=-1)
    room = setup.lamp.distance_m**2 - np.sum(places.point_m**2, axis=-1)
    travel = -along + np.sqrt(np.maximum(along**2 + room, 0.0))
    lamp_m = places.point_m + travel[:, None] * mirrored
    present = setup.lamp.position_m / setup.lamp.distance_m
    turn = np.degrees(np.arccos(np.clip(lamp_m @ present / setup.lamp.distance_m, -1.0, 1.0)))
    incidence = np.degrees(np.arccos(np.clip(mu, -1.0, 1.0)))
    low, high = INCIDENCE_DEG
    depth = FLAT_DEPTH if setup.shape.kind in FLAT else DEPTH
    cost = (
        turn
        + TOO_STEEP * np.maximum(low + 1.0 - incidence, 0.0)
        + TOO_FLAT * np.maximum(incidence - high, 0.0)
        + EDGE * np.maximum(depth - places.depth, 0.0)
        + SMALL_FACE * (1.0 - places.face_depth)
    )
    cost = np.where((room > 0.0) & (mu > 0.0), cost, np.inf)
    k = int(np.argmin(cost))
    if not np.isfinite(cost[k]):
        return None
    x, y, z = lamp_m[k] / np.linalg.norm(lamp_m[k])
    elevation_deg = math.degrees(math.asin(min(max(float(y), -1.0), 1.0)))
    azimuth_deg = math.degrees(math.atan2(x, z))
    lamp = setup.with_entries(
        "lamp", azimuth_deg=round(azimuth_deg, 2) + 0.0, elevation_deg=round(elevation_deg, 2) + 0.0
    ).lamp
    return float(cost[k]), lamp


def _visible(setup: Setup, size: Size) -> _Places | None:
    """Places on a grid over the part of the picture that the form can reach; None without any."""
    view = view_of(setup.shape, setup.eye, size)
    left, bottom, right, top = view.bounds
    if right <= left or top <= bottom:
        return None
    columns = np.linspace(left, right, PLACES) - 0.5
    rows = np.linspace(size[1] - top, size[1] - bottom, PLACES) - 0.5
    hit, ray, _ = sight(setup.shape, view, *np.broadcast_arrays(columns, rows[:, None]))
    if not np.any(hit.found):
        return None
    steps = np.zeros(hit.found.shape)
    face_steps = np.zeros(hit.found.shape)
    for face in np.unique(hit.face[hit.found]):
        own = hit.found & (hit.face == face)
        within = _steps_inside(own)
        steps = np.where(own, within, steps)
        face_steps = np.where(own, np.max(within), face_steps)
    deepest = float(np.max(steps))
    to_eye = -ray / np.linalg.norm(ray, axis=-1, keepdims=True)
    seen = hit.found
    return _Places(
        hit.point_m[seen],
        hit.normal[seen],
        to_eye[seen],
        steps[seen] / deepest,
        face_steps[seen] / deepest,
    )


def _steps_inside(region: Mask) -> Array:
    """How many erosions by a cross each place of a region outlives, plus one."""
    count = np.zeros(region.shape)
    while np.any(region):
        count += region
        padded = np.pad(region, 1)
        neighbours = padded[2:, 1:-1] & padded[:-2, 1:-1] & padded[1:-1, 2:] & padded[1:-1, :-2]
        region = region & neighbours
    return count


def _turned(eye: Eye, turn_deg: float) -> Eye:
    """The eye after a turn about y."""
    if turn_deg == 0.0:
        return eye
    azimuth_deg = (eye.azimuth_deg + turn_deg + 180.0) % 360.0 - 180.0
    return Setup(eye=eye).with_entries("eye", azimuth_deg=azimuth_deg).eye
