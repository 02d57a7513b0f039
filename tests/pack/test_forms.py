"""The triangles of forms, against closed forms and against mitsuba's own shapes."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.pack.forms import mesh_of
from relgloss_view.pack.forms.outline import smooth_through
from relgloss_view.pack.forms.profile import arc, line, revolved
from relgloss_view.pack.shape import Shape

BOTTLE = (
    (30, 0),
    (33, 4),
    (33, 60),
    (30, 75),
    (33, 90),
    (33, 130),
    (28, 160),
    (14, 185),
    (13, 205),
)
FORMS = {
    "can": Shape("can"),
    "low can": Shape("can", diameter_m=0.1, height_m=0.03, neck_diameter_m=0.02),
    "very flat can": Shape("can", diameter_m=8.07, height_m=0.001, neck_diameter_m=1.036),
    "straight can": Shape("can", neck_diameter_m=0.2),
    "bottle": Shape("bottle"),
    "wide bottle": Shape("bottle", diameter_m=1.0, height_m=0.05),
    "profile": Shape("bottle", profile_mm=BOTTLE),
    "carton": Shape("carton"),
    "sharp carton": Shape("carton", edge_radius_m=0.0),
    "round carton": Shape("carton", edge_radius_m=0.05),
    "pouch": Shape("pouch"),
    "thick pouch": Shape("pouch", width_m=0.05, depth_m=0.5),
}


def corners_of(mesh):
    return mesh.points_m[mesh.triangles]


def areas(mesh, of=None):
    a, b, c = np.moveaxis(corners_of(mesh), 1, 0)
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return area if of is None else area[mesh.part[mesh.triangles[:, 0]] == mesh.parts.index(of)]


def volume(mesh):
    a, b, c = np.moveaxis(corners_of(mesh), 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def open_edges(mesh):
    """Edges between places that are not passed once in each direction."""
    places = np.ascontiguousarray(mesh.points_m + 0.0).view("V24").ravel()
    _, place = np.unique(places, return_inverse=True)
    corner = place.ravel()[mesh.triangles]
    start, end = corner.ravel(), corner[:, [1, 2, 0]].ravel()
    forth, back = start * len(mesh.points_m) + end, end * len(mesh.points_m) + start
    assert len(np.unique(forth)) == len(forth)
    return len(np.setdiff1d(forth, back))


@pytest.mark.parametrize("name", FORMS)
def test_a_form_is_closed_and_has_normals_outwards(name):
    shape = FORMS[name]
    mesh = mesh_of(shape)
    assert mesh_of(dataclasses.replace(shape)) is mesh
    assert open_edges(mesh) == 0
    assert areas(mesh).min() > 1e-16
    assert volume(mesh) > 0.0
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(mesh.points_m.min(axis=0), -mesh.points_m.max(axis=0), atol=1e-12)
    a, b, c = np.moveaxis(corners_of(mesh), 1, 0)
    facets = np.cross(b - a, c - a)
    assert np.einsum("tj,tkj->tk", facets, mesh.normals[mesh.triangles]).min() > 0.0
    assert (mesh.part[mesh.triangles] == mesh.part[mesh.triangles[:, :1]]).all()
    assert np.isfinite(mesh.label_m).all()
    label = mesh.label_m[mesh.triangles]
    e, f = label[:, 1] - label[:, 0], label[:, 2] - label[:, 0]
    printed = np.array(mesh.printed)[mesh.part[mesh.triangles[:, 0]]]
    assert (e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0])[printed].min() > 0.0  # nothing is mirrored


def test_a_crack_is_seen():
    mesh = mesh_of(FORMS["can"])
    moved = mesh.points_m.copy()
    moved[np.argmin(mesh.label_m[:, 0])] += 1e-9  # at the seam
    assert open_edges(dataclasses.replace(mesh, points_m=moved)) > 0


@pytest.mark.parametrize("kind", ["can", "bottle", "carton", "pouch"])
def test_sizes_are_those_of_the_shape(kind):
    shape = Shape(kind)
    width = shape.diameter_m if kind in ("can", "bottle") else shape.width_m
    depth = shape.diameter_m if kind in ("can", "bottle") else shape.depth_m
    expected = 0.5 * np.array([width, shape.height_m, depth])
    np.testing.assert_allclose(shape.half_extent_m(), expected, rtol=1e-9)
    assert shape.contains(np.zeros(3))
    assert not shape.contains(np.array([0.0, 0.0, 0.51 * depth]))


def test_a_can_holds_its_drink_and_has_hollow_ends():
    """330 ml and some headspace; dome and lid lie inside the box around the can."""
    shape = FORMS["can"]
    assert 340.0 < 1e6 * volume(mesh_of(shape)) < 365.0
    for y in (-0.0555, 0.0565):
        assert not shape.contains(np.array([0.0, y, 0.0]))
    assert shape.contains(np.array([0.0315, 0.0, 0.0]))
    assert not shape.contains(np.array([0.0315, 0.055, 0.0]))  # beside the neck


def test_a_carton_has_the_volume_and_the_area_of_a_box_with_round_edges():
    """Box, plates on it, quarter cylinders and eighths of a sphere (Steiner 1840)."""
    w, h, d, r = 0.07, 0.16, 0.04, 0.01
    mesh = mesh_of(Shape("carton", edge_radius_m=r))
    a, b, c = w - 2 * r, h - 2 * r, d - 2 * r
    flats = 2.0 * (a * b + b * c + c * a)
    edges = a + b + c
    expected = a * b * c + flats * r + np.pi * r * r * edges + 4.0 / 3.0 * np.pi * r**3
    assert volume(mesh) == pytest.approx(expected, rel=2e-4)
    expected = flats + 2.0 * np.pi * r * edges + 4.0 * np.pi * r * r
    assert areas(mesh).sum() == pytest.approx(expected, rel=2e-4)
    assert mesh.label_size_m[0] == pytest.approx(2.0 * (a + c) + 2.0 * np.pi * r)
    assert mesh.label_size_m[1] == pytest.approx(b + 2.0 * c + 1.5 * np.pi * r)


def test_areas_of_a_cylinder_a_sphere_and_a_cone():
    tube = revolved([line("body", (0.03, 0.0), (0.03, 0.1))])
    assert areas(tube).sum() == pytest.approx(2.0 * np.pi * 0.03 * 0.1, rel=1e-4)
    ball = revolved([arc("body", (0.0, 0.0), 0.05, -90.0, 90.0)])
    assert areas(ball).sum() == pytest.approx(4.0 * np.pi * 0.05**2, rel=1e-3)
    assert volume(ball) == pytest.approx(4.0 / 3.0 * np.pi * 0.05**3, rel=5e-4)
    np.testing.assert_allclose(ball.normals, ball.points_m / 0.05, atol=1e-9)
    cone = revolved([line("body", (0.03, 0.0), (0.0, 0.04))])
    assert areas(cone).sum() == pytest.approx(np.pi * 0.03 * 0.05, rel=1e-3)


def stretches(mesh, parts):
    """Singular values of the map from the label to the surface, (triangles, 2)."""
    chosen = np.isin(mesh.part[mesh.triangles[:, 0]], [mesh.parts.index(p) for p in parts])
    p, q = mesh.points_m[mesh.triangles[chosen]], mesh.label_m[mesh.triangles[chosen]]
    d = np.stack([q[:, 1] - q[:, 0], q[:, 2] - q[:, 0]], axis=-1)
    e = np.stack([p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]], axis=-1)
    return np.linalg.svd(e @ np.linalg.inv(d), compute_uv=False)


@pytest.mark.parametrize(
    ("name", "parts"),
    [("can", ["body"]), ("bottle", ["body"]), ("sharp carton", ["front", "left", "top"]),
     ("pouch", ["top seal"])],
)  # fmt: skip
def test_a_metre_on_the_label_is_one_on_the_surface(name, parts):
    values = stretches(mesh_of(FORMS[name]), parts)
    if name == "pouch":  # ridges are longer than what is above them, and the film lies over them
        values = values[:, 1:]
        assert values.min() > 0.8
        return
    np.testing.assert_allclose(values, 1.0, atol=0.005)


def test_artwork_narrows_with_the_neck():
    values = stretches(mesh_of(FORMS["can"]), ["neck"])
    assert values.min() == pytest.approx(52.0 / 66.0, abs=0.01)


@pytest.mark.parametrize("name", ["carton", "pouch"])
def test_panels_lie_apart_on_the_artwork(name):
    """The label's box is as large as it is declared, and panels do not cover each other."""
    mesh = mesh_of(FORMS[name])
    printed = np.isin(mesh.part, np.flatnonzero(mesh.printed))
    extent = np.ptp(mesh.label_m[printed], axis=0)
    np.testing.assert_allclose(extent, mesh.label_size_m, rtol=1e-6)
    front = mesh.label_m[mesh.part == mesh.parts.index("front")]
    np.testing.assert_allclose(front.max(axis=0), -front.min(axis=0), atol=1e-9)
    assert np.all(mesh.points_m[mesh.part == mesh.parts.index("front"), 2] >= -1e-9)


def test_a_smooth_outline_goes_through_its_points_and_never_beyond():
    """The interpolant of scipy, which nobody here wrote, over the same lengths."""
    from scipy.interpolate import PchipInterpolator

    points = np.array(BOTTLE, dtype=float)
    curve, tangents = smooth_through(points)
    np.testing.assert_array_equal(curve[::64], points)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    places = np.interp(np.arange(len(curve)) / 64.0, np.arange(len(points)), along)
    for k in range(2):
        theirs = PchipInterpolator(along, points[:, k])
        np.testing.assert_allclose(curve[:, k], theirs(places), atol=1e-9)
        np.testing.assert_allclose(tangents[:, k], theirs.derivative()(places), atol=1e-9)
    lower = np.minimum(points[:-1], points[1:])[:, None] - 1e-9
    upper = np.maximum(points[:-1], points[1:])[:, None] + 1e-9
    between = curve[:-1].reshape(-1, 64, 2)
    assert np.all((between >= lower) & (between <= upper))


def test_profiles_that_make_no_form_are_refused():
    for points in ([[30, 0]], [[1, 2, 3], [1, 3]], "x", [[30, 0], [-1, 50]], [[0.1, 0], [0.1, 9]]):
        with pytest.raises(InputError, match=r"shape\.profile_mm"):
            Shape("bottle", profile_mm=points)
    crossing = ((30, 0), (30, 50), (10, 20), (40, 10), (5, 60))
    with pytest.raises(InputError, match="crosses itself near"):
        mesh_of(Shape("bottle", profile_mm=crossing))
    with pytest.raises(InputError, match=r"shape\.file"):
        Shape("mesh")


def test_the_neck_gives_way_and_is_noted():
    assert mesh_of(Shape("can")).notes == ()
    assert "narrower" in mesh_of(FORMS["straight can"]).notes[0]
    assert "flatter" in mesh_of(FORMS["thick pouch"]).notes[0]


# Against mitsuba


@pytest.fixture(scope="module")
def mi():
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    return mitsuba


def met(mi, shape, rays):
    """Points and shading normals where rays (origin, direction) meet a shape of mitsuba."""
    scene = mi.load_dict({"type": "scene", "object": shape})
    points, normals = np.full((len(rays), 3), np.nan), np.full((len(rays), 3), np.nan)
    for k, (origin, direction) in enumerate(rays):
        hit = scene.ray_intersect(mi.Ray3f(mi.Point3f(*origin), mi.Vector3f(*direction)))
        if hit.is_valid():
            points[k], normals[k] = np.array(hit.p), np.array(hit.sh_frame.n)
    return points, normals


def mitsuba_mesh(mi, mesh, folder):
    made = mi.Mesh("m", len(mesh.points_m), len(mesh.triangles), has_vertex_normals=True)
    values = mi.traverse(made)
    values["vertex_positions"] = mesh.points_m.astype(np.float32).ravel()
    values["vertex_normals"] = mesh.normals.astype(np.float32).ravel()
    values["faces"] = mesh.triangles.astype(np.uint32).ravel()
    values.update()
    made.write_ply(str(folder / "m.ply"))
    return {"type": "ply", "filename": str(folder / "m.ply")}


def rays_around(count, target_m, seed=0):
    rng = np.random.default_rng(seed)
    origins = rng.normal(size=(count, 3))
    origins *= 0.5 / np.linalg.norm(origins, axis=1, keepdims=True)
    directions = rng.uniform(-1.0, 1.0, (count, 3)) * target_m - origins
    return list(zip(origins, directions / np.linalg.norm(directions, axis=1, keepdims=True),
                    strict=True))  # fmt: skip


@pytest.mark.parametrize("kind", ["cylinder", "sphere", "edge"])
def test_points_and_normals_of_mitsubas_own_shapes(mi, tmp_path, kind):
    """Normals within 0.05 degrees, away from where a ray only grazes the surface."""
    if kind == "cylinder":
        mesh = revolved([line("body", (0.03, -0.05), (0.03, 0.05))])
        own = {"type": "cylinder", "p0": [0, -0.05, 0], "p1": [0, 0.05, 0], "radius": 0.03}
    elif kind == "sphere":
        mesh = revolved([arc("body", (0.0, 0.0), 0.05, -90.0, 90.0)])
        own = {"type": "sphere", "radius": 0.05}
    else:  # an edge of a carton
        mesh = mesh_of(Shape("carton", edge_radius_m=0.01))
        own = {"type": "cylinder", "p0": [0.025, -0.07, 0.01], "p1": [0.025, 0.07, 0.01],
               "radius": 0.01}  # fmt: skip
    rays = rays_around(800, np.array([0.03, 0.05, 0.03]))
    points, normals = met(mi, mitsuba_mesh(mi, mesh, tmp_path), rays)
    own_points, own_normals = met(mi, own, rays)
    cosine = np.abs(np.einsum("ij,ij->i", own_normals, [d for _, d in rays]))
    same = np.linalg.norm(points - own_points, axis=1) < 5e-5
    if kind == "edge":
        x, y, z = np.nan_to_num(own_points).T
        cosine = np.where((x > 0.0251) & (z > 0.0101) & (np.abs(y) < 0.069), cosine, 0.0)
    seen = same & (cosine > 0.3)
    assert seen.sum() > (20 if kind == "edge" else 200)
    error = np.degrees(np.linalg.norm(normals[seen] - own_normals[seen], axis=1))
    assert error.max() < 0.05
    # Negative control: facets alone turn by more.
    assert np.degrees(2.0 * np.pi / 512 / 2.0) > 0.05


@pytest.mark.parametrize("name", ["can", "bottle", "carton", "pouch"])
def test_closed_forms_are_known(name):
    """So that triangles seen from behind need not be drawn."""
    mesh = mesh_of(Shape(name))
    assert mesh.is_closed
    assert not dataclasses.replace(mesh, triangles=mesh.triangles[1:]).is_closed
    assert not dataclasses.replace(mesh, triangles=mesh.triangles[:, ::-1]).is_closed
