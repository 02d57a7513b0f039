"""Surface: what is printed, and which finishes lie, where a picture sees a pack.

The twin of shaders/surface.frag and shaders/artwork.glsl, in float64 over arrays.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.pack import forms
from relgloss_view.pack.label import SAME_GIRTH, Label, label_of
from relgloss_view.pack.layers import REST, Layers, layers_of
from relgloss_view.pack.pack import Pack, Placement
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.model.sight import Sight, each_part, plane_normal
from relgloss_view.picture.model.texture import filtered, footprint
from relgloss_view.picture.model.view import View, float32

#: The least cosine between a ray and the surface that a footprint is reckoned with.
GRAZING = 1e-4


class Surface(NamedTuple):
    """What lies at points (...) of a pack; F finishes."""

    paint: Array  #: (..., 4), XYZ under D50 of the artwork times alpha, and alpha
    specular_shares: Array  #: (..., F), shares of the finishes' lobes; they add up to 1
    diffuse_shares: Array  #: (..., F), and of their diffuse parts


def surface_of(pack: Pack, view: View, seen: Sight, samples: int = 1) -> Surface:
    """What is printed where a view sees a pack, averaged over the footprint of each place.

    seen: from model.sight, of this view and the pack's shape. samples: along each side of a pixel,
    each of which has its own footprint. Raises InputError where a mask names what is not there.
    """
    layers, label = layers_of(pack), label_of(pack.shape)
    form, count = seen.hit.found.shape, len(pack.finishes)
    flat = Sight(
        each_part(seen.hit, lambda part: part.reshape(-1, *part.shape[len(form) :])),
        np.broadcast_to(seen.ray, (*form, 3)).reshape(-1, 3),
        seen.triangle.reshape(-1),
    )
    found = np.nonzero(flat.hit.found)[0]
    paint = np.zeros((len(flat.ray), 4))
    shares = np.zeros((2, len(flat.ray), count))
    if len(found):
        hit = each_part(flat.hit, lambda part: part[found])
        shown = Sight(hit, flat.ray[found], flat.triangle[found])
        paint[found], shares[:, found] = _printed(pack, layers, label, view, shown, samples)
    return Surface(paint.reshape(*form, 4), *(part.reshape(*form, count) for part in shares))


def _printed(
    pack: Pack, layers: Layers, label: Label, view: View, seen: Sight, samples: int
) -> tuple[Array, Array]:
    """Paint (N, 4), and specular and diffuse shares (2, N, F), of points that are seen."""
    part = np.clip(seen.hit.face, 0, len(layers.part_finish) - 1)
    steps = label_steps(pack.shape, view, seen, samples)
    return printed_at(pack, layers, label, part, seen.hit.surface_m, steps)


def printed_at(
    pack: Pack,
    layers: Layers,
    label: Label,
    part: Ints,
    label_m: Array,
    steps_m: tuple[Array, Array],
) -> tuple[Array, Array]:
    """Paint (N, 4), and specular and diffuse shares (2, N, F), of places on a pack's label.

    part: (N,), of the form. label_m: (N, 2). steps_m: (N, 2) each, to the next pixel on the right
    and below, over whose area the artwork is averaged.
    """
    to_share = ArtworkPlace.of(pack.placement, layers, label)
    height, width = layers.paint.shape[:2]
    size = np.array([width, height], dtype=np.float64)
    right, down = (to_share.turned(step) * size for step in steps_m)
    (paint, channels), on = filtered(
        layers.levels,
        to_share.of_label(label_m),
        footprint(right, down, len(layers.levels)),
        repeats=to_share.repeats,
    )
    printed = np.array(label.printed)[part]
    paint = np.where(printed[:, None], paint, 0.0)
    channels = channels / 255.0
    own = [
        _shares(channels, places, on, outside, np.array(covers)[part])
        for places, outside, covers in (
            (layers.specular_channel, layers.outside_finish, layers.part_finish),
            (layers.diffuse_channel, layers.outside_diffuse, layers.part_diffuse),
        )
    ]
    return paint, np.array(own)


def _shares(
    channels: Array, places: tuple[int, ...], on: Array, outside: int, cover: Array
) -> Array:
    """(N, F), shares of finishes: from channels where the artwork lies, the finish outside it where
    it does not, and the one that covers a part where one does (-1: none).
    """
    shares = np.zeros((len(channels), len(places)))
    for k, channel in enumerate(places):
        if channel >= 0:
            shares[:, k] = channels[:, channel]
    shares[:, places.index(REST)] = np.maximum(on - np.sum(shares, axis=1), 0.0)
    shares[:, outside] += 1.0 - on
    covered = np.nonzero(cover >= 0)[0]
    shares[covered] = 0.0
    shares[covered, cover[covered]] = 1.0
    return np.asarray(np.clip(shares, 0.0, 1.0))


class ArtworkPlace(NamedTuple):
    """From metres on the label to shares of the artwork's width and height, from its upper left."""

    matrix: Array  #: (2, 2)
    offset_m: Array  #: (2,), of the artwork's centre on the label
    girth_m: float  #: after which the label repeats; 0 where it ends
    repeats: bool  #: whether the artwork goes around without a seam

    @classmethod
    def of(cls, placement: Placement, layers: Layers, label: Label) -> ArtworkPlace:
        """The place of an artwork on a label, rounded to float32 as a GPU has it."""
        angle = np.radians(placement.turn_deg)
        width_m, height_m = (
            1e-3 * mm * placement.scale for mm in (layers.width_mm, layers.height_mm)
        )
        girth_m = label.size_m[0] if label.around else 0.0
        upright = abs(np.sin(angle)) < 1e-9
        repeats = bool(label.around and upright and abs(width_m - girth_m) <= SAME_GIRTH * girth_m)
        if repeats:
            width_m = girth_m
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        matrix = turn / np.array([[width_m], [-height_m]])
        offset = 1e-3 * np.array([placement.offset_x_mm, placement.offset_y_mm])
        return cls(float32(matrix), float32(offset), float(np.float32(girth_m)), repeats)

    def of_label(self, label_m: Array) -> Array:
        """Shares (N, 2) of places (N, 2) on the label; around it, of the nearest copy."""
        way = label_m - self.offset_m
        if self.girth_m > 0.0:
            way[:, 0] -= self.girth_m * np.round(way[:, 0] / self.girth_m)
        return self.turned(way) + 0.5

    def turned(self, step_m: Array) -> Array:
        """Shares (N, 2) of steps (N, 2) on the label."""
        return np.asarray(step_m @ self.matrix.T)


def label_steps(shape: Shape, view: View, seen: Sight, samples: int = 1) -> tuple[Array, Array]:
    """Steps on the label, (N, 2) each, from places that are seen to the next sample right and down.

    They follow from the plane that touches the surface there (Igehy 1999, ray differentials); of
    triangles, the plane of the interpolated normal, since the planes of two triangles would make
    two footprints at the edge between them.
    """
    normal = seen.hit.normal
    mesh = forms.mesh_of(shape)
    if mesh is not None:
        corners = mesh.triangles[seen.triangle]
        points, label = float32(mesh.points_m[corners]), float32(mesh.label_m[corners])
        facet = plane_normal(points)
        area2 = np.maximum(np.sum(facet * facet, axis=-1, keepdims=True), 1e-300)
        along_u = np.cross(points[:, 2] - points[:, 0], facet) / area2
        along_v = np.cross(facet, points[:, 1] - points[:, 0]) / area2
        du, dv = label[:, 1] - label[:, 0], label[:, 2] - label[:, 0]
        gradients = [along_u * du[:, [k]] + along_v * dv[:, [k]] for k in (0, 1)]
    else:
        gradients = _gradients(shape.kind, normal)
    travel = np.linalg.norm(seen.hit.point_m - view.eye_m, axis=-1) / np.linalg.norm(
        seen.ray, axis=-1
    )
    step = view.pixel_step / samples
    right, down = (
        _moved(turn, normal, seen.ray, travel) for turn in (step * view.right, -step * view.up)
    )
    first, second = (
        np.stack([np.sum(g * move, axis=-1) for g in gradients], axis=-1) for move in (right, down)
    )
    return first, second


def _moved(turn: Array, facet: Array, ray: Array, travel: Array) -> Array:
    """How a point moves along its plane as the ray turns."""
    along = np.sum(facet * ray, axis=-1)
    least = GRAZING * np.linalg.norm(facet, axis=-1) * np.linalg.norm(ray, axis=-1)
    along = np.where(np.abs(along) < least, np.where(along < 0.0, -least, least), along)
    along = np.where(along == 0.0, 1.0, along)
    back = (facet @ turn) / along
    return np.asarray(travel[:, None] * (turn - ray * back[:, None]))


def _gradients(kind: str, n: Array) -> list[Array]:
    """How Hit.surface_m of a printed analytic form changes along its surface, (N, 3) each."""
    zero, one = np.zeros(len(n)), np.ones(len(n))
    if kind == "cylinder":
        return [np.stack([n[:, 2], zero, -n[:, 0]], axis=-1), np.stack([zero, one, zero], axis=-1)]
    if kind == "sphere":
        cosine = np.sqrt(np.maximum(1.0 - n[:, 1] ** 2, 1e-12))
        east = np.stack([n[:, 2], zero, -n[:, 0]], axis=-1) / cosine[:, None] ** 2
        north = np.stack([-n[:, 1] * n[:, 0], cosine**2, -n[:, 1] * n[:, 2]], axis=-1)
        return [east, north / cosine[:, None]]
    return [np.stack([one, zero, zero], axis=-1), np.stack([zero, one, zero], axis=-1)]
