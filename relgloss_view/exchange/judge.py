"""Judge: what two surfaces differ by in the paper's picture, without OpenGL.

The picture is that of the paper's cylinder and lamp, in Lab after the split and the scaling, before
a display's gamut: what fits and proxies are judged by too. Programs that draw RGB have a lamp that
is white in sRGB, so both surfaces are seen under D65. Points are spread as the pixels of a picture
of 512 columns are; rows are fewer, since a cylinder's highlight hardly changes along its axis.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.exchange.loss import LAMP, Loss, Surface
from relgloss_view.exchange.metered import gloss_units
from relgloss_view.material import brdf, cielab
from relgloss_view.material.difference import delta_e_2000
from relgloss_view.material.material import Material
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.measure.bands import RGB
from relgloss_view.picture.model import lights
from relgloss_view.picture.model.sight import sight
from relgloss_view.picture.model.view import view_of
from relgloss_view.picture.scene.setup import Lamp, Setup

SIZE = (512, 512)
#: Rows of the picture's upper half that are looked at; the lower half is its mirror image.
ROWS = 16
LEAST_LSTAR = 1.0  #: L_s* of a pixel of the highlight
LEAST_C = 0.01
AZIMUTH_DEG = 50.0  #: the paper's lamp
PERCENTILE = 95.0


class Points(NamedTuple):
    """Points of an object, as surfaces are asked about them, (P,) each."""

    i: Array  #: (P, 3), unit vectors to the lamp in the sample frame
    o: Array
    facing: brdf.Facing
    arriving: Array  #: irradiance over that of Y_n, times pi: BRDFs times it are relative to Y_n


class Seen(NamedTuple):
    """XYZ (P, 3) of the parts of a surface at points, relative to Y_n."""

    diffuse: Array
    specular: Array


class Picture(NamedTuple):
    """A picture to compare with: Lab with the specular part scaled, and where the highlight is."""

    lab: Array
    l_d: Array
    highlight: Mask  #: (P,)
    c: float


def compare(ours: Surface, theirs: Surface) -> Loss:
    """The loss of a surface that stands for ours: highlight in the paper's picture, gloss units.

    >>> from relgloss_view import load_sample
    >>> paper = load_sample("matte-coated")
    >>> compare(paper, paper).de2000_max
    0.0
    """
    points = points_of(AZIMUTH_DEG)
    p95, largest = difference(picture_of(seen(ours, points)), seen(theirs, points))
    first, second = gloss_units(ours), gloss_units(theirs)
    return Loss(p95, largest, {key: (first[key], second[key]) for key in first})


def difference(picture: Picture, other: Seen) -> tuple[float, float]:
    """CIEDE2000 over a picture's highlight: the 95th percentile and the largest; 0 without one."""
    if not np.any(picture.highlight):
        return 0.0, 0.0
    lab = scaled(picture, other)[picture.highlight]
    apart = delta_e_2000(picture.lab[picture.highlight], lab)
    return float(np.percentile(apart, PERCENTILE)), float(np.max(apart))


def picture_of(own: Seen) -> Picture:
    """The picture of a surface, at the largest c that cuts nothing (eq. 4), at most 1.

    A body as light as white leaves no such c: its highlight is judged at 1 then, beyond white,
    because at 0 nothing would ever be lost.
    """
    l_d = cielab.lightness(own.diffuse[:, 1])
    l_s = cielab.lightness(own.diffuse[:, 1] + own.specular[:, 1]) - l_d
    bright = l_s > 1e-6
    limits = (100.0 - l_d[bright]) / l_s[bright]
    c = float(min(np.min(limits, initial=1.0), 1.0))
    c = c if c >= LEAST_C else 1.0
    picture = Picture(np.zeros((len(l_d), 3)), l_d, l_s > LEAST_LSTAR, c)
    return picture._replace(lab=scaled(picture, own))


def scaled(picture: Picture, other: Seen) -> Array:
    """Lab (P, 3) of a surface, split and scaled with the diffuse part and the c of a picture."""
    lab = cielab.lab_from_xyz(other.diffuse + other.specular, illuminant(LAMP).white_xyz())
    lab[:, 0] = picture.l_d + picture.c * (lab[:, 0] - picture.l_d)
    return lab


def seen(surface: Surface, points: Points) -> Seen:
    """What a surface shows at points: a Material by its spectra, any other as linear sRGB."""
    lamp = illuminant(LAMP)
    if isinstance(surface, Material):
        parts, weights = surface.evaluate_facing(points.facing), surface.xyz_weights(lamp)
    else:
        parts, weights = surface.evaluate(points.i, points.o), xyz_weights(RGB, lamp)
    diffuse, specular = (points.arriving[:, None] * (part @ weights) for part in parts)
    return Seen(diffuse, specular)


@lru_cache(maxsize=8)
def points_of(azimuth_deg: float, columns: int = SIZE[0], rows: int = ROWS) -> Points:
    """The points of the paper's cylinder under a lamp at an azimuth."""
    column = (np.arange(columns) + 0.5) * (SIZE[0] / columns) - 0.5
    row = (np.arange(rows) + 0.5) * (0.5 * SIZE[1] / rows) - 0.5
    return points_at(azimuth_deg, *np.broadcast_arrays(column[None], row[:, None]))


def points_at(azimuth_deg: float, columns: Array, rows: Array) -> Points:
    """The lit points of the paper's cylinder at places of a picture of SIZE, in their order.

    columns, rows: of the same shape, in pixels from the centre of the upper left one.
    """
    setup = Setup(lamp=Lamp(azimuth_deg=azimuth_deg))
    view = view_of(setup.shape, setup.eye, SIZE)
    hit, ray, _ = sight(setup.shape, view, columns, rows)
    ray, point, normal = ray[hit.found], hit.point_m[hit.found], hit.normal[hit.found]
    o = -ray / np.linalg.norm(ray, axis=-1, keepdims=True)
    [light] = lights.lit(setup, point)
    facing = brdf.facing(normal, light.i, o)
    lit = np.maximum(facing.mu_i, 0.0) / light.distance2
    white = white_of(azimuth_deg)
    kept = lit > 0.0
    frames = _frames(normal[kept])
    i, o = (np.einsum("pab,pb->pa", frames, v[kept]) for v in (light.i, o))
    facing = brdf.Facing(*(part[kept] for part in facing))
    return Points(i, o, facing, np.pi * lit[kept] / white)


@lru_cache(maxsize=8)
def white_of(azimuth_deg: float) -> float:
    """The largest of cos_i / d^2 in the picture, 1/m^2, where the perfect diffuser shows Y_n."""
    setup = Setup(lamp=Lamp(azimuth_deg=azimuth_deg))
    column = np.arange(SIZE[0], dtype=np.float64)
    row = np.full_like(column, 0.5 * (SIZE[1] - 1))
    hit, _, _ = sight(setup.shape, view_of(setup.shape, setup.eye, SIZE), column, row)
    return float(np.max(lights.white_seen(setup, hit.point_m[hit.found], hit.normal[hit.found])))


def _frames(normal: Array) -> Array:
    """(P, 3, 3), rows: two tangents and the normal of points."""
    up = np.broadcast_to(np.array([0.0, 1.0, 0.0]), normal.shape)
    along = np.broadcast_to(np.array([1.0, 0.0, 0.0]), normal.shape)
    first = np.cross(np.where(np.abs(normal[:, 1:2]) < 0.9, up, along), normal)
    first = first / np.linalg.norm(first, axis=-1, keepdims=True)
    return np.stack([first, np.cross(normal, first), normal], axis=1)
