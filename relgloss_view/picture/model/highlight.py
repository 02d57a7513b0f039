"""Highlight: where a picture's object mirrors the lamp best, and how nearly it does.

Geometry alone: every lobe here is widest about the direction where the surface normal halves the
angle between lamp and eye (Torrance, Sparrow 1967), whatever the material.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.material import brdf
from relgloss_view.material.material import Material
from relgloss_view.pack import forms
from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.shape import ANALYTIC
from relgloss_view.picture.model.shape import Hit
from relgloss_view.picture.model.sight import sight
from relgloss_view.picture.model.tone import NO_LOBE_LSTAR
from relgloss_view.picture.model.view import Size, view_of
from relgloss_view.picture.scene.setup import Setup

SIZE: Size = (512, 512)
PLACES = 17  #: along each side of the searched part of the picture
TRIANGLE_PLACES = 65  #: of forms made of triangles, which may have small parts
NARROWER = 0.2  #: what each look searches of the one before
LOOKS = 9  #: the last one is 2.6e-6 of the first: 0.001 px
#: A view shows gloss where it reaches this share of the highlight's peak, or this L_s* anyway.
LEAST_SHARE, GLOW_LSTAR = 0.03, 3.0


@dataclass(frozen=True)
class Highlight:
    """The visible, lit point of an object that mirrors the lamp best."""

    tilt_deg: float  #: of the surface normal against the half-vector, degrees; 0 mirrors
    incidence_deg: float  #: angle between the normal and the lamp there, degrees
    point_m: Array  #: (3,), world axes
    place: tuple[float, float]  #: in the picture, shares of its width and height from the top left


def best_mirror(setup: Setup, size: Size = SIZE) -> Highlight | None:
    """The highlight of a setup, in the part of it that a picture of this shape shows.

    None where the lamp lights nothing that is seen. The place is exact to a hundredth of a pixel of
    `SIZE` on curved forms and inside flat ones.

    >>> from relgloss_view.picture.scene.setup import Lamp
    >>> found = best_mirror(Setup(lamp=Lamp(azimuth_deg=60.0)))
    >>> found.tilt_deg < 0.01, round(found.incidence_deg)
    (True, 32)
    >>> best_mirror(Setup(lamp=Lamp(azimuth_deg=180.0))) is None
    True
    """
    return _best_mirror(setup, size, forms.mesh_of(setup.shape))


@lru_cache(maxsize=64)
def _best_mirror(setup: Setup, size: Size, _mesh: Mesh | None) -> Highlight | None:
    view = view_of(setup.shape, setup.eye, size)
    left, bottom, right, top = view.bounds
    places = PLACES if setup.shape.kind in ANALYTIC else TRIANGLE_PLACES
    columns = np.linspace(left, right, places) - 0.5
    rows = np.linspace(size[1] - top, size[1] - bottom, places) - 0.5

    def look(columns: Array, rows: Array) -> tuple[Array, brdf.Facing, Hit]:
        hit, ray, _ = sight(setup.shape, view, *np.broadcast_arrays(columns, rows[:, None]))
        i = setup.lamp.position_m - hit.point_m
        i = i / np.maximum(np.linalg.norm(i, axis=-1, keepdims=True), 1e-30)
        o = -ray / np.linalg.norm(ray, axis=-1, keepdims=True)
        seen = brdf.facing(hit.normal, i, o)
        lit = hit.found & (seen.mu_i > 0.0) & (seen.mu_o > 0.0)
        return np.where(lit, seen.delta2, np.inf), seen, hit

    def searched(delta2: Array, columns: Array, rows: Array) -> Highlight:
        """Look again and again about the best place so far."""
        wide, tall = columns[-1] - columns[0], rows[-1] - rows[0]
        best: Highlight | None = None
        for _ in range(LOOKS):
            row, column = np.unravel_index(np.argmin(delta2), delta2.shape)
            at = columns[column], rows[row]
            wide, tall = NARROWER * wide, NARROWER * tall
            columns = np.linspace(at[0] - 0.5 * wide, at[0] + 0.5 * wide, PLACES)
            rows = np.linspace(at[1] - 0.5 * tall, at[1] + 0.5 * tall, PLACES)
            delta2, seen, hit = look(columns, rows)
            k = np.unravel_index(np.argmin(delta2), delta2.shape)
            tilt = float(np.degrees(np.sqrt(delta2[k])))
            if best is None or tilt <= best.tilt_deg:
                place = ((columns[k[1]] + 0.5) / size[0], (rows[k[0]] + 0.5) / size[1])
                incidence = float(np.degrees(np.arccos(np.clip(seen.mu_i[k], -1.0, 1.0))))
                best = Highlight(tilt, incidence, hit.point_m[k], place)
        assert best is not None
        return best

    delta2, _, hit = look(columns, rows)
    # Each face of a box and each cap has a best place of its own.
    faces = np.unique(hit.face[np.isfinite(delta2)])
    found = [searched(np.where(hit.face == k, delta2, np.inf), columns, rows) for k in faces]
    return min(found, key=lambda highlight: highlight.tilt_deg, default=None)


def each_lamp(setup: Setup) -> tuple[Setup, ...]:
    """The setup under each of its lamps by itself, the main one first.

    >>> from relgloss_view.picture.scene.setup import FurtherLamp
    >>> two = Setup(further_lamps=(FurtherLamp(azimuth_deg=-40.0),))
    >>> [by_itself.lamp.azimuth_deg for by_itself in each_lamp(two)]
    [50.0, -40.0]
    """
    if not setup.further_lamps:
        return (setup,)
    alone = dataclasses.replace(setup, further_lamps=())
    names = ("azimuth_deg", "elevation_deg", "distance_m", "radius_m")
    return (
        alone,
        *(
            alone.with_entries("lamp", **{name: getattr(lamp, name) for name in names})
            for lamp in setup.further_lamps
            if lamp.share > 0.0
        ),
    )


def peak_share(material: Material, sigma_n_deg: float, tilt_deg: float) -> float:
    """Share of the highlight's peak that a sample shows at a tilt from the mirror direction.

    material: its lobes are Gaussians of the facets' tilt (Torrance, Sparrow 1967), each as high as
    its strength over its variance; grain of sigma_n_deg widens them. tilt_deg: as in Highlight.
    0 for a sample without lobes. Geometry and Fresnel's factor are left out.

    >>> from relgloss_view import load_sample
    >>> round(peak_share(load_sample("uncoated"), 0.0, 15.0), 2)
    0.61
    """
    peak = shown = 0.0
    for lobe in material.visible_lobes():
        variance = lobe.s**2 + np.radians(sigma_n_deg) ** 2
        height = float(np.mean(lobe.height)) / variance
        peak += height
        shown += height * float(np.exp(-0.5 * np.radians(tilt_deg) ** 2 / variance))
    return float(shown / peak) if peak > 0.0 else 0.0


def shows_gloss(
    material: Material, sigma_n_deg: float, setup: Setup, size: Size, l_s_max: float
) -> bool:
    """Whether gloss can be judged in a picture whose largest L_s* is `l_s_max`."""
    if l_s_max >= GLOW_LSTAR:
        return True
    highlights = (best_mirror(by_itself, size) for by_itself in each_lamp(setup))
    tilts = [highlight.tilt_deg for highlight in highlights if highlight is not None]
    if not tilts:
        return False
    narrowest = min((lobe.s_deg for lobe in material.visible_lobes()), default=0.0)
    if min(tilts) <= math.hypot(narrowest, sigma_n_deg):
        return True  # it is there; where it falls between pixels, more samples show it
    if l_s_max < NO_LOBE_LSTAR:
        return False
    return peak_share(material, sigma_n_deg, min(tilts)) >= LEAST_SHARE
