"""Where an object mirrors the lamp, against closed forms and against drawn pictures."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.pack.shape import ANALYTIC as SHAPES
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.model.highlight import best_mirror
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup

FAR_M = 900.0  #: a lamp and an eye as good as at infinity: 0.05 m / 900 m is 0.003 degrees


@pytest.mark.parametrize(("azimuth", "elevation"), [(50.0, 0.0), (110.0, 0.0), (35.0, 40.0)])
def test_a_sphere_mirrors_where_its_normal_is_the_bisector(azimuth, elevation):
    lamp = Lamp(azimuth_deg=azimuth, elevation_deg=elevation, distance_m=FAR_M)
    found = best_mirror(Setup(Shape("sphere"), lamp, Eye(distance_m=FAR_M)))
    half = lamp.position_m / FAR_M + (0.0, 0.0, 1.0)
    normal = half / np.linalg.norm(half)
    np.testing.assert_allclose(found.point_m / np.linalg.norm(found.point_m), normal, atol=1e-3)
    assert found.tilt_deg < 0.01
    between = np.degrees(np.arccos(lamp.position_m[2] / FAR_M))
    assert found.incidence_deg == pytest.approx(0.5 * between, abs=0.02)


def test_a_plane_mirrors_at_the_point_where_the_mirrored_eye_sees_the_lamp():
    lamp, eye = Lamp(azimuth_deg=20.0, distance_m=0.5), Eye(azimuth_deg=-18.0, distance_m=0.45)
    found = best_mirror(Setup(Shape("plane", width_m=0.4, height_m=0.2), lamp, eye))
    a, b = lamp.position_m, eye.position_m
    crossing = a + (b * (1.0, 1.0, -1.0) - a) * a[2] / (a[2] + b[2])  # towards the image of the eye
    np.testing.assert_allclose(found.point_m, crossing, atol=1e-5)


def test_a_cylinder_under_a_raised_lamp_misses_by_the_half_of_its_elevation():
    lamp = Lamp(azimuth_deg=40.0, elevation_deg=30.0, distance_m=FAR_M)
    found = best_mirror(Setup(Shape("cylinder"), lamp, Eye(distance_m=FAR_M)))
    half = lamp.position_m / FAR_M + (0.0, 0.0, 1.0)
    missed = np.degrees(np.arcsin(half[1] / np.linalg.norm(half)))  # no normal leaves the horizon
    assert found.tilt_deg == pytest.approx(missed, abs=0.02)


@pytest.mark.parametrize("kind", SHAPES)
def test_nothing_lit_has_no_highlight(kind):
    assert best_mirror(Setup(Shape(kind), Lamp(azimuth_deg=180.0))) is None


@pytest.mark.parametrize("kind", ["cylinder", "sphere"])
def test_the_place_is_where_a_picture_is_brightest(kind):
    from relgloss_view import Look, Scene, load_sample, open_renderer

    setup, size = Setup(Shape(kind), Lamp(azimuth_deg=60.0)), (301, 201)
    found = best_mirror(setup, size)
    with open_renderer("reference") as renderer:
        frame = renderer.render(Scene(load_sample("cast-coated"), setup), Look(c=0.1), size)
        _, l_s = frame.split
    row, column = np.unravel_index(np.argmax(l_s), l_s.shape)
    assert found.place[0] * size[0] == pytest.approx(column + 0.5, abs=1.5)
    if kind == "sphere":  # a cylinder's highlight is an upright line
        assert found.place[1] * size[1] == pytest.approx(row + 0.5, abs=1.5)
