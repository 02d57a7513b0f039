"""How much of a form sees itself: closed forms, and forms with a known share."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.pack.concavity import concavity, concavity_note
from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.model.light import light_warnings
from relgloss_view.picture.scene.setup import Setup


def revolved(radius_m, height_m, turns=96):
    """A form of a profile about y, open at its ends; normals outwards (left of the profile)."""
    r, y = np.asarray(radius_m, dtype=float), np.asarray(height_m, dtype=float)
    phi = np.arange(turns) * 2.0 * np.pi / turns
    around = np.stack([np.sin(phi), np.cos(phi)], axis=-1)
    points = np.zeros((len(r), turns, 3))
    points[..., 0], points[..., 2] = (r[:, None, None] * around).transpose(2, 0, 1)
    points[..., 1] = y[:, None]
    dr, dy = np.gradient(r), np.gradient(y)
    normals = np.zeros_like(points)
    normals[..., 0], normals[..., 2] = (dy[:, None, None] * around).transpose(2, 0, 1)
    normals[..., 1] = -dr[:, None]
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    k = np.arange(len(r) * turns).reshape(len(r), turns)
    low, right = k[:-1].ravel(), np.roll(k, -1, axis=1)[:-1].ravel()
    high, across = k[1:].ravel(), np.roll(k, -1, axis=1)[1:].ravel()
    triangles = np.concatenate(
        [np.stack(t, -1) for t in ((low, right, high), (right, across, high))]
    )
    points, normals = points.reshape(-1, 3), normals.reshape(-1, 3)
    label = np.zeros((len(points), 2))
    return Mesh(points, normals, label, np.zeros(len(points), dtype=int), triangles)


def sphere(outwards=True):
    theta = np.linspace(-np.pi / 2, np.pi / 2, 60)
    ball = revolved(0.05 * np.cos(theta), 0.05 * np.sin(theta))
    if outwards:
        return ball
    return Mesh(ball.points_m, -ball.normals, ball.label_m, ball.part, ball.triangles)


def waisted():
    """Two cylinders of radius 50 mm with a groove of radius 10 mm and 20 mm of height between."""
    r = [0.05] * 20 + [0.01] * 20 + [0.05] * 20
    y = [
        *np.linspace(-0.06, -0.01, 20),
        *np.linspace(-0.01, 0.01, 20),
        *np.linspace(0.01, 0.06, 20),
    ]
    return revolved(r, y)


def test_convex_forms_see_nothing_of_themselves():
    y = np.linspace(-0.06, 0.06, 40)
    for mesh in (
        sphere(),
        revolved(np.full(40, 0.03), y),
        revolved(np.linspace(0.05, 0.01, 40), y),
    ):
        assert concavity(mesh) == 0.0
        assert concavity_note(mesh) is None


def test_the_inside_of_a_sphere_sees_nothing_else():
    """Negative control."""
    mesh = sphere(outwards=False)
    assert concavity(mesh) > 0.99
    assert "100 %" in concavity_note(mesh)


def test_a_groove_sees_its_walls():
    """The share of the area that lies in the groove: its floor and both walls."""
    wall = 2.0 * np.pi * (0.05**2 - 0.01**2)
    floor, outside = 2.0 * np.pi * 0.01 * 0.02, 2.0 * np.pi * 0.05 * 0.10
    mesh = waisted()
    assert concavity(mesh) == pytest.approx((wall + floor) / (wall + floor + outside), abs=0.06)


def test_nothing_has_no_concavity():
    empty = Mesh(
        np.zeros((3, 3)),
        np.zeros((3, 3)),
        np.zeros((3, 2)),
        np.zeros(3, int),
        np.array([[0, 1, 2]]),
    )
    assert concavity(empty) == 0.0


def test_a_picture_is_warned_about():
    """A bottle of a deep groove has the note, and the usual one has none."""
    groove = ((40.0, 0.0), (40.0, 40.0), (8.0, 42.0), (8.0, 58.0), (40.0, 60.0), (40.0, 100.0))
    deep = Setup(shape=Shape("bottle", profile_mm=groove))
    assert any("faces other parts" in text for text in light_warnings(deep, lit=True))
    assert light_warnings(Setup(shape=Shape("bottle")), lit=True) == []
