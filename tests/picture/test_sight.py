"""What is seen of triangles, against rays that meet the same form in closed form, and Mitsuba."""

from __future__ import annotations

import materials
import meshes
import numpy as np
import pytest
import scans

from relgloss_view import Look, Scene, load_sample, open_renderer
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.model import shape as shapes
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.model.highlight import best_mirror
from relgloss_view.picture.model.pixel_sampling import curvature, samples_needed
from relgloss_view.picture.model.sight import NOTHING, meet_ray, meet_view, sight
from relgloss_view.picture.model.silhouette import coverage, edge_tiles
from relgloss_view.picture.model.view import View, from_afar, view_of
from relgloss_view.picture.scene.sample import SAMPLES
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup

EYES = [
    Eye(),
    Eye(azimuth_deg=170.0, elevation_deg=40.0),
    Eye(distance_m=0.0455, field_of_view_deg=100.0),
]


def places(size):
    return np.meshgrid(np.arange(float(size[0])), np.arange(float(size[1])))


def degrees_between(a, b):
    return np.degrees(2.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(a - b, axis=-1), 0.0, 1.0)))


@pytest.mark.parametrize("eye", EYES, ids=["front", "above", "near"])
def test_a_tessellated_cylinder_is_seen_as_the_analytic_one(monkeypatch, eye):
    size = (90, 70)
    form = meshes.shape_of(monkeypatch, meshes.cylinder())
    view = view_of(Shape(), eye, size)
    assert view_of(form, eye, size).bounds == view.bounds
    true = meet_view(Shape(), view, *places(size))
    seen = meet_view(form, view, *places(size))
    assert np.sum(true.found != seen.found) <= 2
    both = true.found & seen.found & (true.face == seen.face)
    assert np.sum(both) > 0.98 * np.sum(true.found)
    sagitta_m = 0.5 * 0.085 * (1.0 - np.cos(np.pi / 720))
    cosine = -np.sum(true.normal * seen_direction(view, size), axis=-1)
    flat = both & (cosine > 0.2)
    assert np.max(np.abs(true.point_m - seen.point_m)[flat]) < 6.0 * sagitta_m
    assert np.max(degrees_between(true.normal, seen.normal)[flat]) < 0.05
    assert np.max(np.abs(true.surface_m - seen.surface_m)[flat]) < 6.0 * sagitta_m


def seen_direction(view, size):
    ray = view.rays_at(*places(size))
    return ray / np.linalg.norm(ray, axis=-1, keepdims=True)


def test_a_coarse_cylinder_is_seen_to_differ(monkeypatch):
    # Negative control of the comparison above: 40 facets lie 0.13 mm below the cylinder.
    form = meshes.shape_of(monkeypatch, meshes.cylinder(40))
    view = view_of(Shape(), Eye(), (60, 60))
    true, seen = (meet_view(s, view, *places((60, 60))) for s in (Shape(), form))
    both = true.found & seen.found
    assert np.max(np.abs(true.point_m - seen.point_m)[both]) > 1e-4


@pytest.mark.parametrize("sample", SAMPLES)
@pytest.mark.parametrize("pixels", [96, pytest.param(512, marks=pytest.mark.slow)])
def test_pictures_of_a_tessellated_cylinder(monkeypatch, sample, pixels):
    """All but pixels at an edge within dE2000 0.02, noise off."""
    form = meshes.shape_of(monkeypatch, meshes.cylinder())
    size = (pixels, pixels)
    with open_renderer("reference") as renderer:
        true, drawn = (
            renderer.render(Scene(load_sample(sample), shape=s), Look(samples=1), size)
            for s in (Shape(), form)
        )
    inside = coverage(Shape(), View.of(true.scene, size)) == 1.0
    assert np.array_equal(true.on_object[inside], drawn.on_object[inside])
    difference = delta_e_2000(true.lab, drawn.lab)[inside]
    assert np.max(difference) <= 0.02
    assert np.mean(inside) > 0.3


def test_a_picture_of_eight_sides_is_seen_to_differ(monkeypatch):
    # Negative control: interpolated normals alone do not make the light right.
    form = meshes.shape_of(monkeypatch, meshes.cylinder(8))
    with open_renderer("reference") as renderer:
        true, drawn = (
            renderer.render(Scene(load_sample("art-coated"), shape=s), Look(samples=1), (64, 64))
            for s in (Shape(), form)
        )
    both = true.on_object & drawn.on_object
    assert np.max(delta_e_2000(true.lab, drawn.lab)[both]) > 0.5


@pytest.fixture
def mitsuba():
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    return mi


def as_mitsuba(mi, mesh):
    """The same points, triangles and normals in the other renderer."""
    params = mi.Properties()
    params["bsdf"] = mi.load_dict(
        {"type": "diffuse", "reflectance": {"type": "spectrum", "value": 0.4}}
    )
    theirs = mi.Mesh("mesh", len(mesh.points_m), len(mesh.triangles), params, True, False)
    held = mi.traverse(theirs)
    held["vertex_positions"] = np.float32(mesh.points_m).ravel()
    held["vertex_normals"] = np.float32(mesh.normals).ravel()
    held["faces"] = np.uint32(mesh.triangles).ravel()
    held.update()
    return theirs


def rays_of(mi, view, size):
    eye = [float(v) for v in view.eye_m]
    for direction in seen_direction(view, size).reshape(-1, 3):
        yield mi.Ray3f(eye, [float(v) for v in direction])


@pytest.mark.parametrize("distance_m", [0.3, 0.02], ids=["before", "among"])
def test_any_triangles_are_met_as_mitsuba_meets_them(monkeypatch, mitsuba, distance_m):
    """From among them some cross the eye's plane and some lie behind it."""
    size = (48, 40)
    mesh = meshes.soup(60)
    form = meshes.shape_of(monkeypatch, mesh)
    view = view_of(form, Eye(distance_m=distance_m, field_of_view_deg=50.0), size)
    seen = sight(form, view, *places(size))
    world = mitsuba.load_dict({"type": "scene", "object": as_mitsuba(mitsuba, mesh)})
    hits = [world.ray_intersect(ray) for ray in rays_of(mitsuba, view, size)]
    found = np.array([hit.is_valid() for hit in hits]).reshape(size[::-1])
    number = np.array([int(hit.prim_index) if hit.is_valid() else NOTHING for hit in hits])
    number = number.reshape(size[::-1])
    assert np.sum(found != seen.hit.found) <= 3  # theirs is in float32
    assert np.sum(number != seen.triangle) <= 6
    same = (number == seen.triangle) & found
    assert np.mean(same) > 0.05
    point = np.array([hit.p for hit in hits]).reshape(*size[::-1], 3)
    # The distance along a ray that grazes a triangle is theirs in float32.
    assert np.percentile(np.abs(point - seen.hit.point_m)[same], 99) < 2e-5
    assert np.all(np.sum(seen.hit.normal * seen.ray, axis=-1)[same] < 0.0)


def test_rays_one_by_one_meet_what_a_view_meets(monkeypatch):
    form = meshes.shape_of(monkeypatch, meshes.soup(30, seed=2))
    view = view_of(form, Eye(distance_m=0.2), (9, 7))
    seen = sight(form, view, *places((9, 7)))
    alone = meet_ray(form, view.eye_m, seen.ray.reshape(-1, 3))
    for ours, theirs in zip(seen.hit, alone, strict=True):
        assert np.array_equal(ours.reshape(theirs.shape), theirs)


def test_scattered_places_see_what_a_grid_sees(monkeypatch):
    form = meshes.shape_of(monkeypatch, meshes.soup(30, seed=3))
    view = view_of(form, Eye(distance_m=0.2), (40, 40))
    columns, rows = places((40, 40))
    grid = sight(form, view, columns, rows).triangle
    order = np.random.default_rng(1).permutation(1600)
    mixed = sight(form, view, columns.ravel()[order], rows.ravel()[order]).triangle
    assert np.array_equal(grid.ravel()[order], mixed)
    one = sight(form, view, np.array([[20.0]]), np.array([[17.0]])).triangle
    assert one.shape == (1, 1)
    assert one[0, 0] == grid[17, 20]
    assert sight(form, view, np.zeros((0, 3)), np.zeros((0, 3))).hit.point_m.shape == (0, 3, 3)


@pytest.mark.parametrize("form", ["can", "bottle", "carton", *scans.NAMES])
@pytest.mark.slow
def test_forms_are_lit_as_in_mitsuba(mitsuba, form):
    """Normals within 0.05 degrees, diffuse light within 0.3 % (p99), outlines within a pixel."""
    size, albedo = (96, 96), 0.4
    scanned = form in scans.NAMES
    shape = Shape("mesh", file=scans.scanned_pack(form)) if scanned else Shape(form)
    lamp = Lamp(azimuth_deg=40.0, elevation_deg=20.0)
    scene = Scene(materials.flat(albedo), shape=shape, eye=Eye(20.0, 15.0), lamp=lamp)
    mesh = meshes.forms.mesh_of(shape)
    world = mitsuba.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "direct"},
            "object": as_mitsuba(mitsuba, mesh),
            "lamp": {
                "type": "point",
                "position": [float(v) for v in lamp.position_m],
                "intensity": {"type": "spectrum", "value": 1.0},
            },
        }
    )
    view = View.of(scene, size)
    rays = list(rays_of(mitsuba, view, size))
    hits = [world.ray_intersect(ray) for ray in rays]
    found = np.array([hit.is_valid() for hit in hits]).reshape(size[::-1])
    normal = np.array([hit.sh_frame.n for hit in hits]).reshape(*size[::-1], 3)
    sampler = mitsuba.load_dict({"type": "independent"})
    light = np.array(
        [
            world.integrator().sample(world, sampler, mitsuba.RayDifferential3f(ray))[0][1]
            for ray in rays
        ]
    ).reshape(size[::-1])
    with open_renderer("reference") as renderer:
        frame = renderer.render(scene, Look(samples=1), size)
    share = coverage(shape, view)
    assert np.all(frame.on_object[share == 1.0])
    assert not np.any((found != frame.on_object) & ((share == 1.0) | (share == 0.0)))
    both = found & frame.on_object
    facing = both & (-np.sum(normal * seen_direction(view, size), axis=-1) > 0.05)
    assert np.percentile(degrees_between(frame.normal, normal)[facing], 99) < 0.05
    # Theirs casts shadows and knows the lamp's side of each facet: where it is lit, it is as ours.
    lit = facing & (light > 1e-3 * np.max(light)) & (frame.diffuse[..., 1] > 0.0)
    ratio = frame.diffuse[..., 1][lit] / light[lit]
    ratio /= np.median(ratio)
    assert np.percentile(np.abs(ratio - 1.0), 99) < 3e-3
    assert np.mean(lit) > 0.02


def test_silhouettes_of_triangles(monkeypatch):
    """The share that is covered, and the tiles where it is looked for, are the analytic form's."""
    size = (64, 64)
    form = meshes.shape_of(monkeypatch, meshes.cylinder())
    view = view_of(Shape(), Eye(elevation_deg=20.0), size)
    true, seen = coverage(Shape(), view), coverage(form, view)
    assert np.max(np.abs(true - seen)) <= 2 / 64
    wanted = {tuple(tile) for tile in edge_tiles(form, view)}
    for row, column in np.argwhere((seen > 0.0) & (seen < 1.0)):
        assert any(x <= column < x + s and y <= row < y + s for x, y, s in wanted)


def test_where_a_lamp_is_mirrored_and_samples(monkeypatch):
    form = meshes.shape_of(monkeypatch, meshes.cylinder())
    true, seen = best_mirror(Setup()), best_mirror(Setup(form))
    assert np.allclose(true.point_m, seen.point_m, atol=2e-4)
    assert abs(true.tilt_deg - seen.tilt_deg) < 0.05
    for size in ((64, 64), (256, 256)):
        scenes = [Scene(load_sample("cast-coated"), shape=s) for s in (Shape(), form)]
        assert abs(samples_needed(scenes[0], size) - samples_needed(scenes[1], size)) <= 1
    assert curvature(meshes.cylinder()) == pytest.approx(1.0 / 0.0425, rel=1e-4)
    assert not from_afar(form, Eye(distance_m=100.0))


def test_inside_and_outside_of_triangles(monkeypatch):
    form = meshes.shape_of(monkeypatch, meshes.cylinder(60))
    for point in ([0.0, 0.0, 0.0], [0.03, 0.04, 0.0], [0.0, -0.049, 0.03]):
        assert form.contains(np.array(point))
    for point in ([0.0, 0.051, 0.0], [0.041, 0.0, 0.04], [1.0, 0.0, 0.0]):
        assert not form.contains(np.array(point))


@pytest.mark.slow
def test_cells_of_surface_grain_have_the_area_that_is_asked_for():
    """Cells that a plane cuts out of the lattice cover a square's area on average, on any plane."""
    cell_m, side_m = 1e-3, 0.06
    u, v = np.meshgrid(*[np.linspace(0.0, side_m, 900)] * 2)
    for axis in range(3):
        point = np.insert(np.stack([u, v], axis=-1), axis, 0.0123, axis=-1)
        cells = shapes.solid_cell(point, cell_m).reshape(-1, 3)
        count = len(np.unique(cells, axis=0))
        assert side_m**2 / count == pytest.approx(cell_m**2, rel=0.12)
    assert np.allclose(shapes.LATTICE @ shapes.LATTICE.T, np.eye(3))
    # Negative control: without the turn a plane along the lattice is cut in larger squares.
    straight = np.floor(np.stack([u, v], axis=-1) / (shapes.SECTION * cell_m)).reshape(-1, 2)
    assert side_m**2 / len(np.unique(straight, axis=0)) > 1.35 * cell_m**2
