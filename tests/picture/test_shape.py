"""Grain cells on the surface of each shape, counted and measured; and what a miss looks like."""

from __future__ import annotations

import glsl
import numpy as np
import pytest

from relgloss_view.picture.model import shape

RADIUS, HALF_HEIGHT = 0.04, 0.05
HALF = np.array([RADIUS, HALF_HEIGHT, RADIUS])
CELL = 0.003
TURN = 2.0 * np.pi * RADIUS


def hit(surface_m, face=0):
    """A hit of which only what the cells depend on is filled in."""
    surface_m = np.asarray(surface_m, dtype=np.float64)
    nothing = np.zeros((len(surface_m), 3))
    faces = np.full(len(surface_m), face, dtype=np.int64)
    return shape.Hit(np.ones(len(surface_m), dtype=bool), nothing, nothing, surface_m, faces)


def around(count, height):
    """Points once around the axis, in steps of TURN / count, none on the border of a cell."""
    along = (np.arange(count) + 0.5) / count * TURN - TURN / 2
    return np.stack([along, np.full(count, height)], axis=-1)


def test_a_whole_number_of_equal_cells_goes_around_a_cylinder():
    points = around(100_000, 0.001)
    columns = shape.surface_cell("cylinder", hit(points), CELL, HALF)[:, 0]
    expected = round(TURN / CELL)
    assert np.all(np.diff(columns) >= 0)
    values, counts = np.unique(columns, return_counts=True)
    np.testing.assert_array_equal(values, np.arange(expected))
    # Equal widths: the border of a cell falls between two of the points.
    assert np.ptp(counts) <= 1


def test_cells_of_a_cylinder_in_y_are_rows():
    heights = np.linspace(-HALF_HEIGHT, HALF_HEIGHT, 999)
    points = np.stack([np.full(999, 0.01), heights], axis=-1)
    cells = shape.surface_cell("cylinder", hit(points), CELL, HALF)
    np.testing.assert_array_equal(cells[:, 1], np.floor(heights / CELL))
    assert np.all(cells[:, 2] == 0)


def test_rows_of_a_sphere_hold_fewer_cells_towards_the_poles():
    half = np.full(3, RADIUS)
    for row in range(-20, 20):
        height = (row + 0.5) * CELL  # along the meridian
        points = around(20_000, height)
        cells = shape.surface_cell("sphere", hit(points), CELL, half)
        assert np.all(cells[:, 1] == row)
        expected = max(1, round(TURN * np.cos(height / RADIUS) / CELL))
        np.testing.assert_array_equal(np.unique(cells[:, 0]), np.arange(expected))


def test_one_cell_at_the_pole():
    cell = RADIUS  # rows from the equator: the second one's middle is at 1.5 rad, 4 degrees short
    cells = shape.surface_cell("sphere", hit(around(50, 1.5 * RADIUS)), cell, np.full(3, RADIUS))
    assert np.all(cells[:, :2] == (0, 1))


@pytest.mark.parametrize(
    ("kind", "face"), [("plane", 0), ("box", 0), ("box", 5), ("cylinder", 1), ("cylinder", 2)]
)
def test_flat_faces_have_square_cells(kind, face):
    points = np.random.default_rng(1).uniform(-RADIUS, RADIUS, (2000, 2))
    cells = shape.surface_cell(kind, hit(points, face), CELL, HALF)
    np.testing.assert_array_equal(cells[:, :2], np.floor(points / CELL))
    assert np.all(cells[:, 2] == face)


@pytest.mark.parametrize(
    ("kind", "face"),
    [("cylinder", 0), ("cylinder", 1), ("sphere", 0), ("plane", 0), ("box", 0), ("box", 3)],
)
def test_the_shader_has_the_same_cells(ctx, kind, face):
    half = np.array([RADIUS, RADIUS, RADIUS]) if kind == "sphere" else HALF
    half = half.astype(np.float32).astype(np.float64)
    cell = float(np.float32(CELL))
    rng = np.random.default_rng(2)
    low, high = [-TURN / 2, -1.5 * RADIUS], [TURN / 2, 1.5 * RADIUS]
    points = rng.uniform(low, high, (40_000, 2)).astype(np.float32)
    extent = f"vec3{tuple(half.tolist())}"
    body = (
        f"Hit hit = Hit(true, vec3(0.0), vec3(0.0), p.xy, {face});"
        f"result = vec4(surface_cell(SHAPE_{kind.upper()}, hit, {cell!r}, {extent}), 0.0);"
    )
    got = glsl.evaluate(ctx, ["shape.glsl"], body, {"p": points})[:, :3]
    expected = shape.surface_cell(kind, hit(points, face), cell, half)
    # A point within float32 of a border may fall to either side: some 60 borders, 1e-6 of a cell
    # each.
    differs = np.any(got != expected, axis=-1)
    assert np.mean(differs) < 2e-4
    assert np.all(np.abs(got - expected)[differs] <= 1)
    assert len(np.unique(expected[:, 0])) > 20


@pytest.mark.parametrize("kind", ["cylinder", "sphere", "plane", "box"])
def test_a_miss_is_finite(kind):
    """Later stages compute at every pixel and choose by `found`, so a miss must be numbers."""
    eye = np.array([0.3, 0.25, 0.4])
    away = np.random.default_rng(3).normal(0.0, 0.1, (500, 3)) + eye
    missed = shape.meet(kind, eye, away, HALF)
    assert not np.any(missed.found)
    assert np.all(missed.point_m == 0.0)
    np.testing.assert_allclose(np.linalg.norm(missed.normal, axis=-1), 1.0, rtol=1e-12)
    assert np.all(np.isfinite(missed.surface_m))
    assert np.all(missed.face == 0)


def test_a_level_ray_above_a_cap_meets_nothing(ctx):
    """Seen from above its rim, a cylinder has a cap; a level ray runs along it and misses."""
    eye, ray = np.array([0.3, 0.2, 0.0]), np.array([[-0.3, 0.0, 0.0]])
    assert not np.any(shape.meet("cylinder", eye, ray, HALF).found)
    assert np.all(shape.meet("cylinder", eye, ray - [0.0, 0.15, 0.0], HALF).found)
    body = (
        f"Hit hit = meet(SHAPE_CYLINDER, vec3(0.3, 0.2, 0.0), r.xyz, vec3{tuple(HALF.tolist())});"
    )
    rays = np.concatenate([ray, ray - [0.0, 0.15, 0.0]]).astype(np.float32)
    got = glsl.evaluate(
        ctx, ["shape.glsl"], body + "result = vec4(hit.found ? 1 : 0);", {"r": rays}
    )
    assert got[:, 0].tolist() == [0.0, 1.0]
