"""The hand on the camera and the lamp: drags and wheel turns become Eye and Lamp."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from relgloss_view.pack.shape import ANALYTIC
from relgloss_view.picture.model.shape import meet
from relgloss_view.picture.model.view import Size, View
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp

DEGREES_ACROSS = 180.0  #: that a drag over the whole width turns
ZOOM_STEP = 1.15  #: of one notch of the wheel
WIDEST_DEG, NARROWEST_DEG = 120.0, 0.2  #: angle of view across the height that zooming reaches
#: What an eye can have: angles of view, and a shift.
ANGLES_DEG, FARTHEST_SHIFT = (1e-3, 170.0), 100.0
INNER = 0.9  #: share of the picture, each way, that some of the object stays in
BISECTIONS = 40

Point = tuple[float, float]  #: pixels from the top left


def orbited(eye: Eye, moved: Point, size: Size) -> Eye:
    """The eye after a drag: the object turns with the hand."""
    per_pixel = DEGREES_ACROSS / max(size[0], 1)
    return dataclasses.replace(
        eye,
        azimuth_deg=_wrapped(eye.azimuth_deg - moved[0] * per_pixel),
        elevation_deg=float(np.clip(eye.elevation_deg + moved[1] * per_pixel, -90.0, 90.0)),
    )


def zoomed(scene: Scene, notches: float, pointer: Point, size: Size) -> Eye:
    """The eye after turns of the wheel; what is under the pointer stays there."""
    view = View.of(scene, size)
    half_height = 0.5 * size[1]
    low, high, least, most = (
        math.tan(0.5 * math.radians(angle)) / half_height
        for angle in (NARROWEST_DEG, WIDEST_DEG, *ANGLES_DEG)
    )
    # A view that is beyond the limits of zooming is not drawn back to them.
    low, high = max(min(low, view.pixel_step), least), min(max(high, view.pixel_step), most)
    step = float(np.clip(view.pixel_step * ZOOM_STEP**-notches, low, high))
    # Under the pointer is shift + offset * step, to the right and up.
    right, up = pointer[0] - 0.5 * size[0], half_height - pointer[1]
    shift = (
        view.shift[0] + right * (view.pixel_step - step),
        view.shift[1] + up * (view.pixel_step - step),
    )
    eye = dataclasses.replace(scene.eye, field_of_view_deg=_angle_deg(step * half_height))
    return _shifted(eye, shift, scene, step, size)


def panned(scene: Scene, moved: Point, size: Size) -> Eye:
    """The eye after a drag that slides the picture."""
    view = View.of(scene, size)
    shift = (
        scene.eye.shift_right - moved[0] * view.pixel_step,
        scene.eye.shift_up + moved[1] * view.pixel_step,
    )
    return _shifted(scene.eye, shift, scene, view.pixel_step, size)


def framed(eye: Eye) -> Eye:
    """The eye in front of the object again, framing it; its distance stays."""
    return Eye(distance_m=eye.distance_m)


def life_sized(eye: Eye, pixel_pitch_m: float, size: Size) -> Eye:
    """The eye that shows the plane through the object's centre at its physical size."""
    tangent = 0.5 * size[1] * pixel_pitch_m / eye.distance_m
    return dataclasses.replace(eye, field_of_view_deg=_angle_deg(tangent))


def turned(lamp: Lamp, moved: Point, size: Size) -> Lamp:
    """The lamp after a drag in the picture: it goes where the hand goes."""
    per_pixel = DEGREES_ACROSS / max(size[0], 1)
    return placed(
        lamp, lamp.azimuth_deg + moved[0] * per_pixel, lamp.elevation_deg - moved[1] * per_pixel
    )


def placed(lamp: Lamp, azimuth_deg: float, elevation_deg: float) -> Lamp:
    """The lamp at an azimuth, any turn of it, and an elevation as near as there is."""
    return dataclasses.replace(
        lamp,
        azimuth_deg=_wrapped(azimuth_deg),
        elevation_deg=float(np.clip(elevation_deg, -90.0, 90.0)),
    )


def _wrapped(angle_deg: float) -> float:
    """The same direction, -180 to 180 degrees."""
    return (angle_deg + 180.0) % 360.0 - 180.0


def _angle_deg(tangent: float) -> float:
    """Angle of view whose half has a tangent, as near as there is."""
    return float(np.clip(math.degrees(2.0 * math.atan(tangent)), *ANGLES_DEG))


def _shifted(eye: Eye, shift: Point, scene: Scene, step: float, size: Size) -> Eye:
    """The eye with a shift, held so that some of the object stays in the picture.

    The point of the picture's inner part that is nearest to the object's centre shows the object;
    a shift that goes further is made as much shorter as that takes.
    """
    view = View.of(scene.placed(eye=eye), size)
    extent = scene.shape.half_extent_m()
    # A drag has no time for triangles: their bounding box stands for them.
    kind = scene.shape.kind if scene.shape.kind in ANALYTIC else "box"
    inner = [0.5 * INNER * count * step for count in size]

    def is_in_reach(share: float) -> bool:
        held = [share * tangent for tangent in shift]
        right, up = (t - np.clip(t, -most, most) for t, most in zip(held, inner, strict=True))
        if right == 0.0 and up == 0.0:
            return max(abs(t) for t in held) <= FARTHEST_SHIFT
        ray = view.forward + right * view.right + up * view.up
        meets = meet(kind, view.eye_m, ray[None], extent).found[0]
        return bool(meets) and max(abs(t) for t in held) <= FARTHEST_SHIFT

    share = 1.0
    if not is_in_reach(share):
        inside, outside = 0.0, 1.0
        for _ in range(BISECTIONS):
            share = 0.5 * (inside + outside)
            inside, outside = (share, outside) if is_in_reach(share) else (inside, share)
        share = inside
    return dataclasses.replace(eye, shift_right=share * shift[0], shift_up=share * shift[1])
