"""Sight: what of an object is seen at places of a picture, whatever its form.

Analytic forms are met by rays (model/shape.py). Of forms made of triangles, each triangle is
projected; places are binned on a grid, and each triangle is tested against the places of the cells
that it reaches. A ray meets a triangle where the three determinants of its edges have one sign
(Olano, Greer 1997, homogeneous edge functions): triangles that cross the eye's plane need no
clipping, and no place between two triangles that share an edge is missed. All is in float64 from
vertices rounded to float32, the numbers that a GPU starts from.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array, Floats, Ints, Mask
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.pack import forms
from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.model import shape as analytic
from relgloss_view.picture.model.shape import Hit
from relgloss_view.picture.model.view import View, float32

PAIRS = 1 << 20  #: of a triangle and a place that are tested at once
PLACES_A_CELL = 2.0
#: A triangle's projected box is widened by this share of its size and distance, for rounding.
ROUNDING = 1e-9
#: Cosine to the eye below which an interpolated normal is bent towards it.
LEAST_COSINE = 1e-4
NOTHING = -1  #: number of the triangle where none is met


class Sight(NamedTuple):
    """What is seen, and along which rays."""

    hit: Hit
    ray: Array  #: (..., 3), not of unit length
    triangle: Ints  #: (...), its number; NOTHING where none is met and of analytic forms


def meet_view(shape: Shape, view: View, columns: Floats, rows: Floats) -> Hit:
    """The first points of an object along the rays through places of a picture.

    columns, rows: arrays of one shape, pixels; whole numbers are the centres of pixels, row 0 the
    top. A triangle blocks the ray from both sides; seen from behind it shows its normal flipped.
    Hit.face is the mesh's part, Hit.surface_m the place on the label.
    """
    return sight(shape, view, columns, rows).hit


def sight(shape: Shape, view: View, columns: Floats, rows: Floats) -> Sight:
    """As meet_view, with the rays and the numbers of the triangles."""
    ray = view.rays_at(columns, rows)
    mesh = forms.mesh_of(shape)
    if mesh is None:
        half_extent_m = float32(shape.half_extent_m())
        hit = analytic.meet(shape.kind, view.eye_m, ray, half_extent_m)
        return Sight(hit, ray, np.full(hit.found.shape, NOTHING))
    places = np.broadcast_arrays(columns, rows)
    flat = [np.asarray(v, dtype=np.float64).ravel() for v in places]
    shown = _Shown.of(mesh, view)
    triangle = _nearest(shown, flat[0], flat[1], ray.reshape(-1, 3))
    hit = _hit(mesh, shown, ray.reshape(-1, 3), triangle, view.eye_m)
    form = ray.shape[:-1]
    shaped = each_part(hit, lambda part: part.reshape(*form, *part.shape[1:]))
    return Sight(shaped, ray, triangle.reshape(form))


def each_part(hit: Hit, change: Callable[[Any], Any]) -> Hit:
    """A hit with each of its arrays changed alike."""
    return Hit(
        change(hit.found),
        change(hit.point_m),
        change(hit.normal),
        change(hit.surface_m),
        change(hit.face),
    )


def meet_ray(shape: Shape, eye_m: Array, ray: Array) -> Hit:
    """As meet_view, along single rays (N, 3) from the eye: each is tried against every triangle."""
    mesh = forms.mesh_of(shape)
    if mesh is None:
        return analytic.meet(shape.kind, eye_m, ray, shape.half_extent_m())
    shown = _Shown.from_eye(mesh, eye_m)
    number = np.full(len(ray), NOTHING)
    for k, direction in enumerate(ray):
        t = _distance(shown.edges, shown.volume, direction)
        best = int(np.argmin(t)) if len(t) else 0
        if len(t) and np.isfinite(t[best]):
            number[k] = best
    return _hit(mesh, shown, ray, number, eye_m)


class _Shown(NamedTuple):
    """The triangles of a mesh as an eye sees them."""

    corners: Array  #: (T, 3, 3), from the eye to each corner
    #: (T, 3, 3), cross products of the other two corners, signed so that a ray that meets the
    #: triangle has no negative product with any; 0 where the eye is in the triangle's plane
    edges: Array
    volume: Array  #: (T,), the triple product of the three, without its sign
    #: (4, T), lowest column and row, highest column and row; empty where nothing is in front
    box: Array

    @classmethod
    def from_eye(cls, mesh: Mesh, eye_m: Array) -> _Shown:
        corners = float32(mesh.points_m)[mesh.triangles] - eye_m
        edges = np.cross(np.roll(corners, -1, axis=1), np.roll(corners, -2, axis=1))
        volume = np.sum(corners[:, 0] * edges[:, 0], axis=-1)
        edges *= np.sign(volume)[:, None, None]
        return cls(corners, edges, np.abs(volume), np.zeros((4, len(corners))))

    @classmethod
    def of(cls, mesh: Mesh, view: View) -> _Shown:
        frame = tuple(
            tuple(float(x) for x in v) for v in (view.eye_m, view.right, view.up, view.forward)
        )
        return _shown(mesh, frame, view.pixel_step, view.shift, view.size)


Frame = tuple[tuple[float, ...], ...]


@lru_cache(maxsize=4)
def _shown(
    mesh: Mesh, frame: Frame, step: float, shift: tuple[float, float], size: tuple[int, int]
) -> _Shown:
    eye, right, up, forward = (np.array(v) for v in frame)
    shown = _Shown.from_eye(mesh, eye)
    # The rounded frame is not quite orthonormal: its inverse gives the coordinates along it.
    inverse = np.linalg.inv(np.stack([right, up, forward], axis=-1))
    across, tall, depth = np.moveaxis(shown.corners @ inverse.T, -1, 0)  # (T, 3) each
    column = _span(across, depth, lambda x: (x - shift[0]) / step - 0.5 * (1 - size[0]))
    row = _span(-tall, depth, lambda y: (y + shift[1]) / step - 0.5 * (1 - size[1]))
    return shown._replace(box=np.stack([column[0], row[0], column[1], row[1]]))


def _span(side: Array, depth: Array, place: Callable[[Array], Array]) -> tuple[Array, Array]:
    """Lowest and highest place (T,) of triangles whose corners lie `side` beside the axis (T, 3).

    Of a triangle that crosses the eye's plane, what comes near that plane projects to infinity on
    the side where it crosses. Without a corner in front the span is empty.
    """
    front = depth > 0.0
    at = place(side / np.where(front, depth, 1.0))
    low = np.min(np.where(front, at, np.inf), axis=1)
    high = np.max(np.where(front, at, -np.inf), axis=1)
    for k in range(3):
        near, far = (k + 1) % 3, (k + 2) % 3
        crosses = front[:, near] != front[:, far]
        # The sign of the place where the edge crosses, times a depth that is above 0.
        apart = np.where(front[:, near], 1.0, -1.0)
        crossing = apart * (side[:, far] * depth[:, near] - side[:, near] * depth[:, far])
        tiny = ROUNDING * (
            np.abs(side[:, far] * depth[:, near]) + np.abs(side[:, near] * depth[:, far])
        )
        low = np.where(crosses & (crossing <= tiny), -np.inf, low)
        high = np.where(crosses & (crossing >= -tiny), np.inf, high)
    with np.errstate(invalid="ignore"):
        margin = ROUNDING * (1.0 + np.abs(low) + np.abs(high))
        return np.where(np.isfinite(low), low - margin, low), np.where(
            np.isfinite(high), high + margin, high
        )


def _nearest(shown: _Shown, columns: Array, rows: Array, ray: Array) -> Ints:
    """(N,), the triangle that each place sees first, or NOTHING."""
    number = np.full(len(columns), NOTHING)
    if len(columns) == 0 or len(shown.volume) == 0:
        return number
    nearest = np.full(len(columns), np.inf)
    at = np.stack([columns, rows], axis=-1)
    low, high = np.min(at, axis=0), np.max(at, axis=0)
    left, top, right, bottom = shown.box
    beside = (left > high[0]) | (right < low[0]) | (top > high[1]) | (bottom < low[1])
    reached = np.nonzero(~beside)[0]
    if len(reached) == 0:
        return number
    cells = _Cells(at, low, high)
    box = shown.box[:, reached].T
    first = cells.of(np.maximum(box[:, :2], low))
    last = cells.of(np.minimum(box[:, 2:], high))
    # Rows of cells: those of one row lie one after the other among the sorted places.
    lines = last[:, 1] - first[:, 1] + 1
    for part in _chunks(lines, PAIRS):
        checkpoint()
        own = np.repeat(part, lines[part])
        line = first[own, 1] + _counted(lines[part])
        begin = cells.start[line * cells.across + first[own, 0]]
        end = cells.start[line * cells.across + last[own, 0] + 1]
        own, begin, held = own[end > begin], begin[end > begin], (end - begin)[end > begin]
        for some in _chunks(held, PAIRS):
            place = cells.order[np.repeat(begin[some], held[some]) + _counted(held[some])]
            triangle = reached[np.repeat(own[some], held[some])]
            _keep_nearest(shown, at, ray, place, triangle, nearest, number)
    return number


def _keep_nearest(
    shown: _Shown,
    at: Array,
    ray: Array,
    place: Ints,
    triangle: Ints,
    nearest: Array,
    number: Ints,
) -> None:
    """Test pairs of a place and a triangle; of equally near triangles the first one counts."""
    left, top, right, bottom = shown.box
    column, row = at[place, 0], at[place, 1]
    inside = (column >= left[triangle]) & (column <= right[triangle])
    inside &= (row >= top[triangle]) & (row <= bottom[triangle])
    place, triangle = place[inside], triangle[inside]
    total = np.zeros(len(place))
    for k in range(3):  # most pairs fail at the first or second edge
        side = np.sum(shown.edges[triangle, k] * ray[place], axis=-1)
        total = total + side
        met = side >= 0.0
        place, triangle, total = place[met], triangle[met], total[met]
    met = total > 0.0
    place, triangle = place[met], triangle[met]
    t = shown.volume[triangle] / total[met]
    order = np.lexsort((triangle, t, place))
    place, triangle, t = place[order], triangle[order], t[order]
    leads = np.ones(len(place), dtype=bool)
    leads[1:] = place[1:] != place[:-1]
    place, triangle, t = place[leads], triangle[leads], t[leads]
    nearer = (t < nearest[place]) | ((t == nearest[place]) & (triangle < number[place]))
    nearest[place[nearer]] = t[nearer]
    number[place[nearer]] = triangle[nearer]


def _distance(edges: Array, volume: Array, ray: Array) -> Array:
    """(T,), how far along a ray triangles are met, in lengths of the ray; inf where it is not."""
    sides = edges @ ray
    total = np.sum(sides, axis=-1)
    met = np.all(sides >= 0.0, axis=-1) & (total > 0.0)
    return np.where(met, volume / np.where(met, total, 1.0), np.inf)


class _Cells:
    """Places sorted by the cells of a grid, row by row."""

    def __init__(self, at: Array, low: Array, high: Array) -> None:
        span = np.maximum(high - low, 1e-300)
        count = max(len(at) / PLACES_A_CELL, 1.0)
        # Square cells where the places allow it; a row of places has one row of cells.
        shape = np.sqrt(count * span / span[::-1]) if np.all(high > low) else count * (high > low)
        self._count = np.clip(np.round(shape), 1, 4096).astype(np.int64)
        self.across = int(self._count[0])
        self._low, self._scale = low, self._count / span
        cell = self.of(at)
        flat = cell[:, 1] * self.across + cell[:, 0]
        self.order = np.argsort(flat, kind="stable")
        cells = int(np.prod(self._count))
        self.start = np.concatenate([[0], np.cumsum(np.bincount(flat, minlength=cells))])

    def of(self, at: Array) -> Ints:
        """(N, 2), column and row of the cell of each place."""
        cell = np.floor((at - self._low) * self._scale)
        return np.asarray(np.clip(cell, 0, self._count - 1), dtype=np.int64)


def _chunks(counts: Ints, most: int) -> list[Ints]:
    """Numbers of the counts in runs whose sums are at most `most`, but for single larger ones."""
    if len(counts) == 0:
        return []
    run = np.cumsum(counts) // most
    return np.split(np.arange(len(counts)), np.nonzero(np.diff(run))[0] + 1)


def _counted(counts: Ints) -> Ints:
    """0, 1, ... for each count, one after the other.

    >>> _counted(np.array([2, 3])).tolist()
    [0, 1, 0, 1, 2]
    """
    ends = np.cumsum(counts)
    counted: Ints = np.arange(int(np.sum(counts))) - np.repeat(ends - counts, counts)
    return counted


def _hit(mesh: Mesh, shown: _Shown, ray: Array, triangle: Ints, eye_m: Array) -> Hit:
    """The points of known triangles along rays (N, 3)."""
    found = triangle != NOTHING
    point = np.zeros((len(ray), 3))
    normal = np.tile((0.0, 0.0, 1.0), (len(ray), 1))
    label, face = np.zeros((len(ray), 2)), np.zeros(len(ray), dtype=np.int64)
    at, d = triangle[found], ray[found]
    if len(at):
        sides = np.sum(shown.edges[at] * d[:, None, :], axis=-1)
        total = np.sum(sides, axis=-1, keepdims=True)
        weights = (sides / total)[..., None]
        corners = mesh.triangles[at]
        point[found] = eye_m + shown.volume[at, None] / total * d
        normal[found] = _seen_normal(mesh, shown.corners[at], corners, weights, d)
        label[found] = np.sum(weights * float32(mesh.label_m[corners]), axis=1)
        face[found] = mesh.part[corners[:, 0]]
    return Hit(found, point, normal, label, face)


def plane_normal(corners: Array) -> Array:
    """(N, 3), along the outward normals of triangles (N, 3, 3), twice as long as their areas."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _seen_normal(mesh: Mesh, corners: Array, numbers: Ints, weights: Array, ray: Array) -> Array:
    """Interpolated unit normals (N, 3), on the side that is seen and not turned from the eye."""
    flat = plane_normal(corners)
    n = np.sum(weights * float32(mesh.normals[numbers]), axis=1)
    length = np.linalg.norm(n, axis=-1, keepdims=True)
    n = np.where(length > 1e-12, n, flat)
    n = n / np.maximum(np.linalg.norm(n, axis=-1, keepdims=True), 1e-300)
    behind: Mask = np.sum(flat * ray, axis=-1) > 0.0
    n = np.where(behind[:, None], -n, n)
    o = -ray / np.linalg.norm(ray, axis=-1, keepdims=True)
    cosine = np.sum(n * o, axis=-1, keepdims=True)
    bent = n + (LEAST_COSINE - cosine) * o
    n = np.where(cosine < LEAST_COSINE, bent, n)
    return np.asarray(n / np.linalg.norm(n, axis=-1, keepdims=True))
