"""The hand on the camera and the lamp, held against the rays that pictures are drawn with.

Tolerances: a View rounds its step and its shift to float32, each by at most 2^-24 of its size; the
rest is float64, 1e-14 for the few sums behind a ray. `rounding` adds these up for a place.
"""

from __future__ import annotations

import dataclasses
import math

import materials
import numpy as np
import pytest
from hypothesis import HealthCheck, assume, example, given, settings
from hypothesis import strategies as st

from relgloss_view.pack.shape import Shape
from relgloss_view.picture.model.shape import meet
from relgloss_view.picture.model.view import View
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp
from relgloss_view.viewer.drawing import camera

SIZE = (200, 150)
HALF_ULP = 2.0**-24
MATERIAL = materials.flat()

azimuths = st.floats(-180.0, 180.0)
elevations = st.floats(-90.0, 90.0)
pixels = st.floats(-3000.0, 3000.0)
moves = st.tuples(pixels, pixels)
round_shapes = st.sampled_from([Shape(), Shape("sphere")])  # their outlines are symmetric


def scene_of(eye, shape=None):
    return Scene(MATERIAL, shape=shape or Shape(), eye=eye)


def ray_at(view, place):
    """The ray through a place of the picture, pixels from the top left; forward counts 1."""
    rest, row = math.modf(place[1])
    column_rest, column = math.modf(place[0])
    rays = view.rays(slice(int(row), int(row) + 1), (column_rest, rest))
    return rays[0, int(column)]


def rounding(view, place):
    """How far rounding may move the ray through a place, as a tangent; see the module."""
    offset = abs(place[0] - 0.5 * view.size[0]) + abs(place[1] - 0.5 * view.size[1])
    shift = sum(abs(s) for s in view.shift)
    return HALF_ULP * 1.01 * (offset * view.pixel_step + shift) + 1e-14


def object_pixels(eye, shape, size=SIZE):
    """How many pixels of a picture show the object."""
    view = View.of(scene_of(eye, shape), size)
    hit = meet(shape.kind, view.eye_m, view.rays(slice(None)), shape.half_extent_m())
    return int(np.count_nonzero(hit.found))


def turned_by(a, b):
    """Difference of two angles, degrees, 0 to 180."""
    return abs((a - b + 180.0) % 360.0 - 180.0)


class TestOrbit:
    @given(azimuths, elevations, moves)
    @example(180.0, 90.0, (-0.0, 1e-12))
    def test_turns_with_the_hand_wraps_and_clamps(self, azimuth, elevation, moved):
        eye = Eye(azimuth_deg=azimuth, elevation_deg=elevation, shift_up=0.1)
        got = camera.orbited(eye, moved, SIZE)  # an Eye checks its ranges itself
        per_pixel = 180.0 / SIZE[0]
        assert turned_by(got.azimuth_deg, azimuth - moved[0] * per_pixel) < 1e-9
        free = elevation + moved[1] * per_pixel
        assert got.elevation_deg == pytest.approx(min(max(free, -90.0), 90.0), abs=1e-9)
        untouched = {"azimuth_deg": azimuth, "elevation_deg": elevation}
        assert dataclasses.replace(got, **untouched) == eye

    def test_point_of_the_object_follows_the_hand(self):
        """The near point of the object goes right and down when the hand does."""
        got = camera.orbited(Eye(), (10.0, 10.0), SIZE)
        view = View.of(scene_of(got), SIZE)
        near = np.array([0.0, 0.0, 0.04]) - view.eye_m
        assert near @ view.right > 1e-3
        assert near @ view.up < -1e-3

    @pytest.mark.parametrize("width", [0, 1])
    def test_pane_of_no_width(self, width):
        assert camera.orbited(Eye(), (3.0, 0.0), (width, 1)).azimuth_deg == -180.0


class TestZoom:
    # Many a pointer is beside the object.
    @settings(max_examples=50, suppress_health_check=[HealthCheck.filter_too_much])
    @given(
        round_shapes,
        azimuths,
        st.floats(1.0, 100.0) | st.none(),
        moves,
        st.floats(-30.0, 30.0),
        st.tuples(st.floats(11.0, 189.0), st.floats(8.5, 141.5)),
    )
    def test_point_of_the_object_under_the_pointer_stays(
        self, shape, azimuth, angle, moved, notches, pointer
    ):
        eye = Eye(azimuth_deg=azimuth, field_of_view_deg=angle)
        eye = camera.panned(scene_of(eye, shape), moved, SIZE)
        before = View.of(scene_of(eye, shape), SIZE)
        ray = ray_at(before, pointer)
        hit = meet(shape.kind, before.eye_m, ray[None], shape.half_extent_m())
        assume(hit.found[0])
        got = camera.zoomed(scene_of(eye, shape), notches, pointer, SIZE)
        after = View.of(scene_of(got, shape), SIZE)
        off = np.linalg.norm(ray_at(after, pointer) - ray)
        assert off <= rounding(before, pointer) + rounding(after, pointer)

    def test_pointer_that_is_left_out_would_be_noticed(self):
        """The control: zooming about the picture's middle moves what is under the pointer."""
        pointer = (150.0, 60.0)
        before, after = (
            View.of(scene_of(Eye(field_of_view_deg=a)), SIZE) for a in (15.0, 15.0 / 1.15)
        )
        off = np.linalg.norm(ray_at(after, pointer) - ray_at(before, pointer))
        assert off > 1e4 * (rounding(before, pointer) + rounding(after, pointer))

    def test_notch_enlarges_by_its_step_and_comes_back(self):
        eye = Eye(field_of_view_deg=20.0)
        one = camera.zoomed(scene_of(eye), 1.0, (90.0, 60.0), SIZE)
        step = View.of(scene_of(eye), SIZE).pixel_step / View.of(scene_of(one), SIZE).pixel_step
        assert step == pytest.approx(camera.ZOOM_STEP, rel=4 * HALF_ULP)
        back = camera.zoomed(scene_of(one), -1.0, (90.0, 60.0), SIZE)
        assert back.field_of_view_deg == pytest.approx(20.0, rel=8 * HALF_ULP)
        assert back.shift_right == pytest.approx(0.0, abs=1e-7)

    @pytest.mark.parametrize(("notches", "limit"), [(1e3, 0.2), (-1e3, 120.0)])
    def test_limits(self, notches, limit):
        got = camera.zoomed(scene_of(Eye()), notches, (100.0, 75.0), SIZE)
        assert got.field_of_view_deg == pytest.approx(limit, rel=1e-9)
        again = camera.zoomed(scene_of(got), notches, (100.0, 75.0), SIZE)
        assert again.field_of_view_deg == pytest.approx(limit, rel=1e-6)

    @pytest.mark.parametrize("angle", [0.05, 150.0])
    def test_view_beyond_the_limits_is_not_drawn_back(self, angle):
        """At life size a view can be narrower or wider than zooming reaches."""
        eye = Eye(field_of_view_deg=angle)
        outwards = -1.0 if angle > 100.0 else 1.0
        got = camera.zoomed(scene_of(eye), outwards, (100.0, 75.0), SIZE)
        assert got.field_of_view_deg == pytest.approx(angle, rel=1e-6)
        inwards = camera.zoomed(scene_of(eye), -outwards, (100.0, 75.0), SIZE)
        assert (inwards.field_of_view_deg - angle) * outwards > 0.0

    @settings(max_examples=50)
    @given(
        st.sampled_from([(1, 1), (1, 2000), (3, 1500), (8000, 1), (16384, 2), (700, 500)]),
        st.floats(1e-3, 1e3),
        st.lists(st.tuples(st.floats(-50.0, 50.0), moves), min_size=1, max_size=4),
    )
    @example((8000, 1), 0.6, [(-9.0, (3000.0, 0.0))])
    @example((1, 2000), 0.6, [(1.0, (0.0, 0.0))])
    def test_no_pane_makes_an_eye_that_cannot_be(self, size, distance, turns):
        """An Eye refuses values out of its ranges; so thin a pane reaches them by one notch."""
        eye = Eye(distance_m=distance)
        for notches, place in turns:
            eye = camera.zoomed(scene_of(eye), notches, place, size)
            eye = camera.panned(scene_of(eye), place, size)
            eye = camera.life_sized(eye, 2.5e-4, size)
        assert eye.field_of_view_deg is not None


class TestPan:
    @given(
        st.floats(2.0, 100.0) | st.none(),
        azimuths,
        st.tuples(st.floats(-60.0, 60.0), st.floats(-50.0, 50.0)),
    )
    def test_moves_by_exactly_the_pixels(self, angle, azimuth, moved):
        scene = scene_of(Eye(azimuth_deg=azimuth, field_of_view_deg=angle))
        got = camera.panned(scene, moved, SIZE)
        before, after = View.of(scene, SIZE), View.of(scene_of(got), SIZE)
        assume(angle is None or angle > 5.0)  # else the object's edge may hold it
        for place in ((100.0, 75.0), (70.0, 90.0)):
            there = (place[0] + moved[0], place[1] + moved[1])
            off = np.linalg.norm(ray_at(after, there) - ray_at(before, place))
            assert off <= rounding(before, place) + rounding(after, there)
            one_off = np.linalg.norm(
                ray_at(after, (there[0] + 1.0, there[1])) - ray_at(before, place)
            )
            assert one_off > 0.99 * before.pixel_step  # what a pixel too far would be

    @settings(max_examples=30, deadline=None)
    @given(
        st.sampled_from([Shape(), Shape("sphere"), Shape("box", width_m=0.3), Shape("plane")]),
        st.floats(-60.0, 60.0),
        st.floats(-60.0, 60.0),
        st.lists(st.tuples(moves, st.floats(-40.0, 40.0)), min_size=1, max_size=6),
    )
    def test_object_is_never_lost(self, shape, azimuth, elevation, hands):
        eye = Eye(azimuth_deg=azimuth, elevation_deg=elevation)
        for moved, notches in hands:
            eye = camera.panned(scene_of(eye, shape), moved, SIZE)
            assert object_pixels(eye, shape) > 0
            pointer = (100.0 + moved[0] % 100.0, 75.0 - moved[1] % 75.0)
            eye = camera.zoomed(scene_of(eye, shape), notches, pointer, SIZE)
            assert object_pixels(eye, shape) > 0

    @pytest.mark.parametrize("shift", [(0.12, 0.0), (0.0, 0.12), (0.075, 0.09)])
    def test_object_would_be_lost(self, shift):
        """The control: such shifts lose it, also within the ball around it (0.13)."""
        near = Eye(field_of_view_deg=0.5)
        lost = dataclasses.replace(near, shift_right=shift[0], shift_up=shift[1])
        assert object_pixels(lost, Shape()) == 0
        step = View.of(scene_of(near), SIZE).pixel_step
        held = camera.panned(scene_of(near), (-shift[0] / step, shift[1] / step), SIZE)
        assert object_pixels(held, Shape()) > 0
        # No nearer than it takes: there is surround in the picture, too.
        assert object_pixels(held, Shape()) < SIZE[0] * SIZE[1]


class TestFramed:
    @given(azimuths, elevations, st.floats(0.1, 10.0), st.floats(-5.0, 5.0))
    def test_resets_all_but_the_distance(self, azimuth, elevation, distance, shift):
        eye = Eye(azimuth, elevation, distance, 33.0, shift, -shift)
        assert camera.framed(eye) == Eye(distance_m=distance)
        assert camera.framed(eye).field_of_view_deg is None


class TestLifeSize:
    @given(
        st.floats(1e-4, 5e-4),
        st.floats(0.2, 3.0),
        azimuths,
        st.sampled_from([SIZE, (640, 640), (1, 1), (300, 2000)]),
    )
    def test_length_covers_its_pixels(self, pitch, distance, azimuth, size):
        """A bar of length L across the sight at the centre covers L / pitch pixels."""
        eye = camera.life_sized(Eye(azimuth, 0.0, distance), pitch, size)
        view = View.of(scene_of(eye), size)
        length = 0.05
        ends = [sign * 0.5 * length * view.right - view.eye_m for sign in (-1.0, 1.0)]
        columns = [(e @ view.right) / (e @ view.forward) / view.pixel_step for e in ends]
        # The step's rounding, and those of the eye and the three directions.
        assert columns[1] - columns[0] == pytest.approx(length / pitch, rel=8 * HALF_ULP)

    def test_monitor_of_other_pitch_shows_another_size(self):
        """The control: a hundredth of the pitch is seen."""
        angles = [camera.life_sized(Eye(), p, SIZE).field_of_view_deg for p in (2.5e-4, 2.525e-4)]
        assert angles[1] / angles[0] == pytest.approx(1.01, rel=1e-3)

    def test_keeps_where_it_looks(self):
        eye = Eye(20.0, 10.0, 0.7, 12.0, 0.01, -0.02)
        got = camera.life_sized(eye, 2.5e-4, SIZE)
        assert dataclasses.replace(got, field_of_view_deg=12.0) == eye

    @pytest.mark.parametrize(("distance", "pitch"), [(1e-3, 1.0), (1e3, 1e-9)])
    def test_stays_an_eye(self, distance, pitch):
        angle = camera.life_sized(Eye(distance_m=distance), pitch, SIZE).field_of_view_deg
        assert angle in camera.ANGLES_DEG


class TestLamp:
    @given(azimuths, elevations, moves)
    def test_goes_where_the_hand_goes(self, azimuth, elevation, moved):
        lamp = Lamp(azimuth_deg=azimuth, elevation_deg=elevation, distance_m=2.0)
        got = camera.turned(lamp, moved, SIZE)
        per_pixel = 180.0 / SIZE[0]
        assert turned_by(got.azimuth_deg, azimuth + moved[0] * per_pixel) < 1e-9
        free = elevation - moved[1] * per_pixel
        assert got.elevation_deg == pytest.approx(min(max(free, -90.0), 90.0), abs=1e-9)
        rest = {"azimuth_deg": azimuth, "elevation_deg": elevation}
        assert dataclasses.replace(got, **rest) == lamp

    @pytest.mark.parametrize(
        ("asked", "got"),
        [
            ((190.0, 0.0), (-170.0, 0.0)),
            ((-190.0, 100.0), (170.0, 90.0)),
            ((725.0, -95.0), (5.0, -90.0)),
            ((180.0, 12.5), (-180.0, 12.5)),
        ],
    )
    def test_placed(self, asked, got):
        lamp = camera.placed(Lamp(), *asked)
        assert (lamp.azimuth_deg, lamp.elevation_deg) == got
