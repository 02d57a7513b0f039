"""Geometry and shading of the diffuse pass against an independent renderer, ray for ray."""

from __future__ import annotations

import materials
import numpy as np
import pytest

from relgloss_view.pack.shape import Shape
from relgloss_view.picture.model.view import View
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp

mi = pytest.importorskip("mitsuba")

SIZE = (96, 96)
ALBEDO = 0.4


@pytest.fixture(scope="module", autouse=True)
def _variant():
    mi.set_variant("scalar_rgb")


def mitsuba_object(shape):
    bsdf = {"type": "diffuse", "reflectance": {"type": "spectrum", "value": ALBEDO}}
    radius, half_height = 0.5 * shape.diameter_m, 0.5 * shape.height_m
    if shape.kind == "cylinder":
        ends = [0, -half_height, 0], [0, half_height, 0]
        return {"type": "cylinder", "p0": ends[0], "p1": ends[1], "radius": radius, "bsdf": bsdf}
    if shape.kind == "sphere":
        return {"type": "sphere", "radius": radius, "bsdf": bsdf}
    scale = [float(v) for v in shape.half_extent_m()]
    if shape.kind == "plane":
        to_world = mi.ScalarTransform4f().scale([*scale[:2], 1.0])
        return {"type": "rectangle", "to_world": to_world, "bsdf": bsdf}
    return {"type": "cube", "to_world": mi.ScalarTransform4f().scale(scale), "bsdf": bsdf}


def mitsuba_picture(scene):
    """Found, point, normal and relative radiance at the centre of each pixel."""
    lamp = [float(v) for v in scene.lamp.position_m]
    world = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "direct"},
            "object": mitsuba_object(scene.shape),
            "lamp": {
                "type": "point",
                "position": lamp,
                "intensity": {"type": "spectrum", "value": 1.0},
            },
        }
    )
    view = View.of(scene, SIZE)
    rays = view.rays(slice(0, SIZE[1]))
    directions = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
    found = np.zeros(SIZE[::-1], dtype=bool)
    point, normal = np.zeros((*SIZE[::-1], 3)), np.zeros((*SIZE[::-1], 3))
    radiance = np.zeros(SIZE[::-1])
    sampler = mi.load_dict({"type": "independent"})
    eye = [float(v) for v in view.eye_m]
    for row in range(SIZE[1]):
        for column in range(SIZE[0]):
            ray = mi.Ray3f(eye, [float(v) for v in directions[row, column]])
            hit = world.ray_intersect(ray)
            if not hit.is_valid():
                continue
            found[row, column] = True
            point[row, column] = hit.p
            normal[row, column] = hit.n
            value, _, _ = world.integrator().sample(world, sampler, mi.RayDifferential3f(ray))
            radiance[row, column] = value[1]
    return found, point, normal, radiance


@pytest.mark.parametrize(
    "scene",
    [
        Scene(materials.flat(ALBEDO)),
        Scene(materials.flat(ALBEDO), lamp=Lamp(azimuth_deg=110.0, distance_m=0.2)),
        Scene(
            materials.flat(ALBEDO),
            shape=Shape(kind="sphere"),
            eye=Eye(azimuth_deg=-30.0, elevation_deg=40.0, distance_m=0.3),
            lamp=Lamp(azimuth_deg=20.0, elevation_deg=50.0),
        ),
        Scene(materials.flat(ALBEDO), shape=Shape(kind="plane"), eye=Eye(azimuth_deg=50.0)),
        Scene(
            materials.flat(ALBEDO),
            shape=Shape(kind="box", depth_m=0.04),
            eye=Eye(azimuth_deg=35.0, elevation_deg=25.0),
        ),
    ],
    ids=["cylinder", "cylinder-near-lamp", "sphere", "plane", "box"],
)
def test_same_object_and_same_light(renderer, scene):
    found, point, normal, radiance = mitsuba_picture(scene)
    frame = renderer.render(scene, Look(), SIZE)
    # Both are float32 with rays rounded separately: an edge pixel may differ.
    assert np.sum(frame.on_object != found) <= 4
    both = frame.on_object & found
    assert np.mean(both) > 0.15
    np.testing.assert_allclose(frame.point_m[both], point[both], atol=2e-5)
    facing = -np.sum(View.of(scene, SIZE).rays(slice(0, SIZE[1])) * normal, axis=-1) > 0.1
    np.testing.assert_allclose(frame.normal[both & facing], normal[both & facing], atol=1e-4)
    # Relative luminance: the perfect diffuser at its brightest is 1, so ours over the albedo is
    # the other's radiance over its own brightest.
    ours = frame.diffuse[..., 1] / ALBEDO
    theirs = radiance / np.max(radiance[both])
    np.testing.assert_allclose(ours[both & facing], theirs[both & facing], atol=2e-3)
    assert np.max(frame.specular) == 0.0


def test_a_lamp_elsewhere_is_seen():
    # Negative control: the comparison above tells a lamp that is moved by five degrees.
    here, there = (
        mitsuba_picture(Scene(materials.flat(ALBEDO), lamp=Lamp(azimuth_deg=a)))[3]
        for a in (50.0, 55.0)
    )
    assert np.max(np.abs(here / here.max() - there / there.max())) > 0.02
