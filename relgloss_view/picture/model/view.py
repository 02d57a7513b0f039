"""Pixels to rays. The twin of shaders/view.glsl."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array, Floats
from relgloss_view.base.errors import InputError
from relgloss_view.pack import forms
from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.shape import ANALYTIC, CURVED, Shape
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye

Size = tuple[int, int]  #: width, height in pixels
#: left, bottom, right, top in pixels, counted from the bottom left as OpenGL does
Box = tuple[int, int, int, int]

WIDE = (2.0, 2.0)  #: tangents of a wide angle, where the eye is among the object's points
NARROW = 0.02  #: tangent of a picture's height (1.1 degrees) below which from_afar
EDGE_ON = 1e-6  #: cosine
AFAR_RADII = 1000.0  #: distance in radii of a curved object above which from_afar
FILL = 0.8  #: share of the picture's height or width that a framed object takes
BOUNDS_MARGIN_PX = 2.0
ROUNDING = 1e-6  #: of the shader's rays, tangents
#: A polygon of 180 points on a circle spans 0.015 % less than the circle.
BOUNDS_EXCESS = 1e-3
MAX_SIDE_PX = 16384
MAX_PIXELS = 36 * 1024 * 1024  #: above 8K UHD; an EXR of it takes 2 GB of memory while written


def check_size(size: Size) -> Size:
    """The size, if a picture can have it; InputError otherwise."""
    width, height = size
    largest = max(size)
    if min(size) < 1 or largest > MAX_SIDE_PX or width * height > MAX_PIXELS:
        raise InputError(
            f"size {width}x{height}: expected 1 to {MAX_SIDE_PX} pixels a side and at most "
            f"{MAX_PIXELS} in all; give --size WxH"
        )
    return size


@dataclass(frozen=True)
class View:
    """The eye's frame, rounded to float32 so that every renderer starts from the same numbers."""

    eye_m: Array
    right: Array
    up: Array
    forward: Array
    pixel_step: float  #: tangent of a pixel's angle at the centre of the picture
    shift: tuple[float, float]  #: of the picture's centre to the right and up, tangents
    size: Size
    bounds: Box  #: no pixel outside shows the object

    @classmethod
    def of(cls, scene: Scene, size: Size) -> View:
        """The view of a scene: through the object's centre, upright, framing the object."""
        return view_of(scene.shape, scene.eye, size)

    def rays(self, rows: slice, place: tuple[float, float] = (0.5, 0.5)) -> Array:
        """Rays through a place inside each pixel of some rows, (R, W, 3), not of unit length."""
        width, height = self.size
        columns = np.arange(width) + (place[0] - 0.5)
        return self.rays_at(columns[None, :], np.arange(height)[rows, None] + (place[1] - 0.5))

    def rays_at(self, column: Floats, row: Floats) -> Array:
        """Rays through the centres of pixels, (..., 3), not of unit length."""
        width, height = self.size
        x = (column + 0.5 * (1 - width)) * self.pixel_step + self.shift[0]
        y = (row + 0.5 * (1 - height)) * self.pixel_step - self.shift[1]
        return np.asarray(self.forward + x[..., None] * self.right - y[..., None] * self.up)


def view_of(shape: Shape, eye: Eye, size: Size) -> View:
    """View.of, for a shape and an eye."""
    return _view_of(shape, eye, size, forms.mesh_of(shape))


@lru_cache(maxsize=64)
def _view_of(shape: Shape, eye: Eye, size: Size, _mesh: Mesh | None) -> View:
    """view_of; a mesh whose file was edited is another mesh of an equal shape."""
    place = eye.position_m
    forward = -place / np.linalg.norm(place)
    azimuth = np.radians(eye.azimuth_deg)
    right = np.array([np.cos(azimuth), 0.0, -np.sin(azimuth)])
    up = np.cross(right, forward)
    width, height = size
    extent = _extent(shape, place, right, up, forward)
    if eye.field_of_view_deg is None:
        across, tall = extent or WIDE
        step = max(across / width, tall / height) / FILL
    else:
        step = 2.0 * np.tan(0.5 * np.radians(eye.field_of_view_deg)) / height
    shift = (float(np.float32(eye.shift_right)), float(np.float32(eye.shift_up)))
    return View(
        eye_m=_round(place),
        right=_round(right),
        up=_round(up),
        forward=_round(forward),
        pixel_step=float(np.float32(step)),
        shift=shift,
        size=size,
        bounds=_bounds(shape, place, (right, up, forward), extent, step, shift, size),
    )


def at_one_scale(shapes: Iterable[Shape], eye: Eye, size: Size) -> Eye:
    """The eye that frames several objects: each is as large beside the others as it would be.

    An eye that has an angle of view, and one before objects of one form, stay as they are.

    >>> at_one_scale([Shape(), Shape()], Eye(), (64, 64)) == Eye()
    True
    >>> round(at_one_scale([Shape("sphere"), Shape()], Eye(), (64, 64)).field_of_view_deg, 1)
    12.8
    """
    forms_seen = set(shapes)
    if eye.field_of_view_deg is not None or len(forms_seen) == 1:
        return eye
    step = max(view_of(shape, eye, size).pixel_step for shape in forms_seen)
    angle_deg = float(np.degrees(2.0 * np.arctan(0.5 * size[1] * step)))
    return dataclasses.replace(eye, field_of_view_deg=angle_deg)


@lru_cache(maxsize=64)
def from_afar(shape: Shape, eye: Eye) -> bool:
    """Whether float32 rays from the eye would blur the object by a visible share of a pixel.

    A ray from an eye at a distance d misses its point by about 6e-8 d. That is much for a picture
    that spans a small angle, and for the normals of a thin curved object. There the shaders begin
    their rays beside the object (view.glsl); elsewhere they begin at the eye, as they always did,
    so that the pixels of usual scenes stay the same to the last bit.

    >>> from_afar(Shape(), Eye()), from_afar(Shape(), Eye(distance_m=100.0))
    (False, True)

    Triangles are met relative to the eye (model/sight.py), so this question is not theirs.
    """
    if shape.kind not in ANALYTIC:
        return False
    place = eye.position_m
    # A plane that is seen edge-on has no point where a ray passes its centre.
    edge_on = shape.kind == "plane" and abs(place[2]) < EDGE_ON * eye.distance_m
    if edge_on or shape.contains(place):
        return False
    if shape.kind in CURVED and eye.distance_m > AFAR_RADII * float(shape.half_extent_m()[0]):
        return True
    view = view_of(shape, eye, (1, 1))
    return view.pixel_step < NARROW


def _bounds(
    shape: Shape,
    place: Array,
    frame: tuple[Array, Array, Array],
    extent: tuple[float, float] | None,
    step: float,
    shift: tuple[float, float],
    size: Size,
) -> Box:
    """The pixels that an object can reach; the margins cover all rounding."""
    if extent is None or _close(shape, place, frame[2]):
        return 0, 0, *size
    right, up, forward = (_round(v) for v in frame)
    # Rounding turns the eye's frame a little, by many pixels of a tiny and distant object.
    depth = -_round(place) @ forward
    centres = (-_round(place) @ right / depth, -_round(place) @ up / depth)
    box = []
    for tangents, at, moved, count in zip(extent, centres, shift, size, strict=True):
        centre, half = 0.5 * count + (at - moved) / step, 0.5 * tangents / step
        reach = half * (1.0 + BOUNDS_EXCESS) + BOUNDS_MARGIN_PX + ROUNDING / step
        low, high = np.clip([centre - reach, centre + reach], 0, count)
        box.append((int(np.floor(low)), int(np.ceil(high))))
    (left, right_px), (bottom, top) = box
    return left, bottom, right_px, top


def _close(shape: Shape, place: Array, forward: Array) -> bool:
    """Whether a rim comes so near the eye that its 180 points no longer bound its outline."""
    if shape.kind != "cylinder":
        return False
    return bool(np.min((_outline(shape) - place) @ forward) < 0.25 * shape.half_extent_m()[0])


def float32(vector: Array) -> Array:
    """The numbers that a GPU starts from, so that all draw the same scene."""
    return vector.astype(np.float32).astype(np.float64)


def _round(vector: Array) -> Array:
    """Those numbers, not to be written to, since views are shared."""
    rounded = float32(vector)
    rounded.setflags(write=False)
    return rounded


def _extent(
    shape: Shape, eye: Array, right: Array, up: Array, forward: Array
) -> tuple[float, float] | None:
    """Tangents of the angles that the object spans across and up, symmetrically about the axis.

    None where the eye is among the object's points, so that any angle serves.
    """
    distance = float(np.linalg.norm(eye))
    if shape.kind == "sphere":
        radius = 0.5 * shape.diameter_m
        if distance <= radius:
            return None
        angle = 2.0 * radius / np.sqrt(distance**2 - radius**2)
        return angle, angle
    outline = _outline(shape)
    depth = (outline - eye) @ forward
    if np.min(depth) <= 1e-6:
        return None
    across = np.abs((outline - eye) @ right) / depth
    tall = np.abs((outline - eye) @ up) / depth
    return 2.0 * float(np.max(across)), 2.0 * float(np.max(tall))


def _outline(shape: Shape) -> Array:
    """Points whose hull is the object: a box's corners, a cylinder's rims, those of triangles."""
    mesh = forms.mesh_of(shape)
    if mesh is not None:
        return mesh.outline_m
    half = shape.half_extent_m()
    if shape.kind == "cylinder":
        turn = np.linspace(0.0, 2.0 * np.pi, 180, endpoint=False)
        rim = np.stack([np.sin(turn), np.ones_like(turn), np.cos(turn)], axis=-1)
        return np.concatenate([rim * half, rim * half * (1.0, -1.0, 1.0)])
    signs = (-1.0, 1.0)
    return np.array([[sx, sy, sz] for sx in signs for sy in signs for sz in signs]) * half
