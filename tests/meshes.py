"""Meshes that tests draw: forms with known numbers, no file between."""

from __future__ import annotations

import numpy as np

from relgloss_view.pack import forms
from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.shape import Shape


def cylinder(around: int = 720, shape: Shape = Shape()) -> Mesh:
    """The analytic cylinder as triangles: its side in strips, its caps as fans."""
    radius, half = 0.5 * shape.diameter_m, 0.5 * shape.height_m
    angle = np.linspace(-np.pi, np.pi, around + 1)
    out = np.stack([np.sin(angle), 0.0 * angle, np.cos(angle)], axis=-1)
    k, count = np.arange(around), around + 1
    points = [radius * out + (0.0, y, 0.0) for y in (-half, half)]
    normals = [out, out]
    label = [np.stack([radius * angle, 0.0 * angle + y], axis=-1) for y in (-half, half)]
    triangles = [
        np.stack([k, k + 1, count + k + 1], axis=-1),
        np.stack([k, count + k + 1, count + k], axis=-1),
    ]
    part = [np.zeros(2 * count, dtype=np.int64)]
    first = 2 * count
    for number, y in ((1, half), (2, -half)):
        fan = np.concatenate([[[0.0, y, 0.0]], radius * out + (0.0, y, 0.0)])
        points.append(fan)
        normals.append(np.tile((0.0, np.sign(y), 0.0), (count + 1, 1)))
        label.append(fan[:, [0, 2]])
        part.append(np.full(count + 1, number))
        turned = np.stack([np.full(around, first), first + 1 + k, first + 2 + k], axis=-1)
        triangles.append(turned if y > 0.0 else turned[:, ::-1])
        first += count + 1
    return Mesh(
        *(np.concatenate(parts) for parts in (points, normals, label, part, triangles)),
        parts=("side", "top", "bottom"),
        printed=(True, False, False),
        label_size_m=(2.0 * np.pi * radius, 2.0 * half),
        around=True,
    )


def soup(triangles: int, seed: int = 0) -> Mesh:
    """Triangles anywhere within 50 mm of the origin, some of them across the eye's plane."""
    points = np.random.default_rng(seed).uniform(-0.05, 0.05, (triangles, 3, 3))
    flat = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    flat /= np.linalg.norm(flat, axis=-1, keepdims=True)
    points = points.reshape(-1, 3)
    numbers = np.arange(len(points))
    return Mesh(
        points,
        np.repeat(flat, 3, axis=0),
        points[:, :2].copy(),
        0 * numbers,
        numbers.reshape(-1, 3),
    )


def shape_of(monkeypatch, mesh: Mesh) -> Shape:
    """A shape that has a mesh, as if it were read from a file."""
    shape = Shape("mesh", file=f"made by a test, {id(mesh)}")
    real = forms.mesh_of
    monkeypatch.setattr(forms, "mesh_of", lambda s: mesh if s == shape else real(s))
    return shape
