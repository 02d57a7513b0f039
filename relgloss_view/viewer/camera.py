"""The hand on the camera and the lamp: drags and wheel turns become Eye and Lamp."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from relgloss_view.picture.scene import Eye, Lamp, Scene
from relgloss_view.picture.view import Size, View

DEGREES_ACROSS = 180.0  #: that a drag over the whole width turns
ZOOM_STEP = 1.15  #: of one notch of the wheel
WIDEST_DEG, NARROWEST_DEG = 120.0, 0.2  #: angle of view across the height that zooming reaches

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
    step = view.pixel_step * ZOOM_STEP**-notches
    half_height = 0.5 * size[1]
    low, high = (math.tan(0.5 * math.radians(a)) / half_height for a in (NARROWEST_DEG, WIDEST_DEG))
    step = float(np.clip(step, min(low, view.pixel_step), max(high, view.pixel_step)))
    # Under the pointer is shift + offset * step, to the right and up.
    right, up = pointer[0] - 0.5 * size[0], half_height - pointer[1]
    eye = dataclasses.replace(
        scene.eye,
        field_of_view_deg=math.degrees(2.0 * math.atan(step * half_height)),
        shift_right=view.shift[0] + right * (view.pixel_step - step),
        shift_up=view.shift[1] + up * (view.pixel_step - step),
    )
    return _in_reach(eye, scene, step, size)


def panned(scene: Scene, moved: Point, size: Size) -> Eye:
    """The eye after a drag that slides the picture."""
    view = View.of(scene, size)
    eye = dataclasses.replace(
        scene.eye,
        shift_right=scene.eye.shift_right - moved[0] * view.pixel_step,
        shift_up=scene.eye.shift_up + moved[1] * view.pixel_step,
    )
    return _in_reach(eye, scene, view.pixel_step, size)


def framed(eye: Eye) -> Eye:
    """The eye in front of the object again, framing it; its distance stays."""
    return Eye(distance_m=eye.distance_m)


def life_sized(eye: Eye, pixel_pitch_m: float, size: Size) -> Eye:
    """The eye that shows the plane through the object's centre at its physical size."""
    step = pixel_pitch_m / eye.distance_m
    angle = math.degrees(2.0 * math.atan(0.5 * size[1] * step))
    return dataclasses.replace(eye, field_of_view_deg=float(np.clip(angle, 1e-3, 170.0)))


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


def _in_reach(eye: Eye, scene: Scene, step: float, size: Size) -> Eye:
    """The eye with its shift held so that some of the object stays in the picture."""
    radius = float(np.linalg.norm(scene.shape.half_extent_m())) / eye.distance_m
    limits = [min(max(0.5 * count * step, radius), 100.0) for count in size]
    return dataclasses.replace(
        eye,
        shift_right=float(np.clip(eye.shift_right, -limits[0], limits[0])),
        shift_up=float(np.clip(eye.shift_up, -limits[1], limits[1])),
    )
