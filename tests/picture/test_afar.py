"""Pictures from afar: a small object, a tiny angle of view, a thin cylinder from near."""

from __future__ import annotations

import dataclasses

import materials
import numpy as np
import pytest

from relgloss_view.pack.shape import Shape
from relgloss_view.picture.method import Method
from relgloss_view.picture.model.view import View, from_afar
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup

SIZE = (48, 40)
#: A ray that begins at the eye, as in usual scenes.
FROM_THE_EYE = Method(variant=(("afar", False),))


def sphere_seen(shape, eye, size):
    """Pixels whose centre sees a sphere, from angles alone: sin(angle) <= radius / distance.

    At tangents (x, y) the angle to the axis has tan^2 = x^2 + y^2; the eye looks at the centre.
    """
    view = View.of(Scene(materials.flat(), shape=shape, eye=eye), size)
    x = (np.arange(size[0]) + 0.5 * (1 - size[0])) * view.pixel_step
    y = (np.arange(size[1]) + 0.5 * (1 - size[1])) * view.pixel_step
    radius = 0.5 * shape.diameter_m
    limit2 = radius**2 / (eye.distance_m**2 - radius**2)
    return x[None, :] ** 2 + y[:, None] ** 2 <= limit2


@pytest.mark.parametrize("distance_m", [10.0, 100.0, 1000.0])
@pytest.mark.parametrize("azimuth_deg", [0.0, 90.0, -180.0])
def test_a_distant_sphere_is_a_disc(renderer, distance_m, azimuth_deg):
    """Axes of the world, where the eye's frame is exact in float32 too; 1 mm up to 1 km away."""
    shape, eye = Shape("sphere", 1e-3), Eye(azimuth_deg=azimuth_deg, distance_m=distance_m)
    assert from_afar(shape, eye)
    scene = Scene(materials.flat(), shape=shape, eye=eye, lamp=Lamp(azimuth_deg))
    seen = sphere_seen(shape, eye, SIZE)
    frame = renderer.render(scene, Look(), SIZE)
    np.testing.assert_array_equal(frame.on_object, seen)
    assert 0.2 < np.mean(seen) < 0.8


def test_rays_from_the_eye_lose_it(renderer, reference):
    """Control: begun at the eye, float32 rays draw another outline and other normals."""
    shape, eye = Shape("sphere", 1e-3), Eye(azimuth_deg=33.0, elevation_deg=21.0, distance_m=1e3)
    scene = Scene(materials.paper("art"), shape=shape, eye=eye, lamp=Lamp(50.0, 10.0))
    truth = reference.render(scene, Look(c=0.4), SIZE)
    drawn = {}
    for name, method in (("afar", Method()), ("eye", FROM_THE_EYE)):
        frame = renderer.render(scene, Look(c=0.4), SIZE, method)
        both = frame.on_object & truth.on_object
        wrong = np.sum(frame.on_object != truth.on_object)
        drawn[name] = wrong, np.max(np.abs(frame.normal - truth.normal)[both])
    assert drawn["afar"][0] == 0
    assert drawn["afar"][1] < 1e-3
    assert drawn["eye"][0] > 10
    assert drawn["eye"][1] > 0.1


@pytest.mark.parametrize("kind", ["cylinder", "sphere", "plane", "box"])
@pytest.mark.parametrize(
    "eye",
    [
        Eye(azimuth_deg=33.0, elevation_deg=41.0, distance_m=300.0),
        Eye(azimuth_deg=-70.0, elevation_deg=-25.0, distance_m=1000.0),
        Eye(azimuth_deg=20.0, elevation_deg=10.0, distance_m=5.0, field_of_view_deg=0.05),
        Eye(azimuth_deg=20.0, elevation_deg=70.0, distance_m=0.2, field_of_view_deg=1e-3),
    ],
)
@pytest.mark.parametrize("samples", [1, 2])
def test_every_form(renderer, reference, kind, eye, samples):
    shape = Shape(kind, diameter_m=0.004, height_m=0.003, width_m=0.002, depth_m=0.005)
    scene = Scene(
        materials.paper("matte"),
        shape=shape,
        eye=eye,
        lamp=Lamp(eye.azimuth_deg + 30.0, 40.0, 0.5),
    )
    assert from_afar(shape, eye)
    look = Look(c=0.4, samples=samples)
    frame, truth = renderer.render(scene, look, SIZE), reference.render(scene, look, SIZE)
    np.testing.assert_array_equal(frame.coverage, truth.coverage)
    assert np.any(truth.on_object)
    on = truth.on_object
    np.testing.assert_allclose(frame.point_m[on], truth.point_m[on], atol=1e-7)
    np.testing.assert_allclose(frame.normal[on], truth.normal[on], atol=1e-3)
    np.testing.assert_allclose(frame.diffuse[on], truth.diffuse[on], atol=1e-4)


def test_a_thin_cylinder_from_near(renderer, reference):
    """A wire of 1 mm and 10 m from 5 m."""
    shape, eye = Shape("cylinder", diameter_m=1e-3, height_m=10.0), Eye(distance_m=5.0)
    assert from_afar(shape, eye)
    near = dataclasses.replace(eye, field_of_view_deg=0.02)
    scene = Scene(materials.paper("art"), shape=shape, eye=near, lamp=Lamp(30.0))
    frame, truth = (r.render(scene, Look(c=0.3), SIZE) for r in (renderer, reference))
    np.testing.assert_array_equal(frame.coverage, truth.coverage)
    assert 0.1 < np.mean(truth.on_object) < 0.9
    np.testing.assert_allclose(frame.lab, truth.lab, atol=0.05)


def test_what_is_behind_the_eye_is_not_seen(renderer):
    """One step back is the eye: what a ray meets before it lies behind."""
    for shape in (Shape("plane"), Shape("box"), Shape("cylinder", diameter_m=1e-3, height_m=10.0)):
        turned = Eye(azimuth_deg=180.0, distance_m=2.0, field_of_view_deg=1.0)
        scene = Scene(materials.flat(), shape=shape, eye=turned)
        frame = renderer.render(scene, Look(), SIZE)
        assert np.any(frame.on_object) == (shape.kind != "plane")


def test_usual_scenes_begin_at_the_eye():
    """Their pixels are those of earlier versions to the last bit."""
    for setup in (Setup(), Setup(eye=Eye(distance_m=3.0)), Setup(shape=Shape("box", depth_m=1e-3))):
        assert not from_afar(setup.shape, setup.eye)
    inside = Shape("box", width_m=1.0, height_m=1.0, depth_m=1.0)
    assert not from_afar(inside, Eye(distance_m=0.1, field_of_view_deg=0.1))
