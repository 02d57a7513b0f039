"""The filter of artwork, against closed forms: constants, ramps, and patterns finer than pixels."""

from __future__ import annotations

import meshes
import numpy as np
import pytest

from relgloss_view.pack.layers import halved
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.model.sight import sight
from relgloss_view.picture.model.surface import label_steps
from relgloss_view.picture.model.texture import MOST_PROBES, filtered, footprint
from relgloss_view.picture.model.view import view_of
from relgloss_view.picture.scene.setup import Eye


def levels_of(picture):
    made = [picture[..., None].astype(np.float64)]
    while max(made[-1].shape[:2]) > 1:
        made.append(halved(made[-1]).astype(np.float64))
    return [(level,) for level in made]


def turned(across, tall, angle):
    """Steps right and down of a footprint with two axes, the first turned by an angle."""
    axis = np.array([np.cos(angle), np.sin(angle)])
    beside = np.array([-axis[1], axis[0]])
    count = 40
    return np.tile(across * axis, (count, 1)), np.tile(tall * beside, (count, 1))


def seen_in(levels, steps, share, **options):
    [values], on = filtered(levels, share, footprint(*steps, len(levels)), **options)
    return values[:, 0], on


def inner_places(seed=0, count=40):
    return np.random.default_rng(seed).uniform(0.35, 0.65, (count, 2))


@pytest.mark.parametrize("axes", [(0.3, 0.3), (1.0, 1.0), (6.0, 1.0), (11.0, 3.7), (90.0, 1.0)])
def test_a_constant_stays_constant(axes):
    levels = levels_of(np.full((130, 200), 0.37))
    values, on = seen_in(levels, turned(*axes, 0.7), inner_places())
    assert np.allclose(values, 0.37)
    assert np.allclose(on, 1.0)


@pytest.mark.parametrize("axes", [(0.5, 0.5), (3.0, 3.0), (8.0, 2.0)])
def test_a_linear_ramp_stays_linear(axes):
    """A footprint is symmetric, so the mean over it of a linear function is its value there."""
    width, height = 256, 128
    ramp = np.broadcast_to((np.arange(width) + 0.5) / width, (height, width))
    share = inner_places()
    values, _ = seen_in(levels_of(ramp), turned(*axes, 0.4), share)
    assert np.allclose(values, share[:, 0], atol=1e-12)


@pytest.mark.parametrize("axes", [(5.0, 5.0), (16.0, 4.0), (40.0, 8.0)])
@pytest.mark.parametrize("angle", [0.0, 0.6, 1.3])
def test_a_fine_checkerboard_becomes_its_mean_in_linear_light(axes, angle):
    board = np.indices((256, 256)).sum(axis=0) % 2 * 0.8
    share = inner_places()
    values, _ = seen_in(levels_of(board), turned(*axes, angle), share)
    assert np.allclose(values, 0.4, atol=1e-9)
    # Negative control: without the smaller levels single texels are seen.
    alone, _ = seen_in(levels_of(board)[:1], turned(*axes, angle), share)
    assert np.max(np.abs(alone - 0.4)) > 0.05


def test_the_probes_keep_what_lies_across_the_long_axis():
    """Stripes along the long axis of a footprint stay; one width for both axes would blur them."""
    stripes = np.broadcast_to(np.arange(256) // 4 % 2 * 1.0, (256, 256)).T
    share = np.stack([np.full(40, 0.5), (np.arange(40) + 110.0) / 256 + 0.5 / 256], axis=-1)
    along, _ = seen_in(
        levels_of(stripes), (np.tile([8.0, 0.0], (40, 1)), np.tile([0.0, 1.0], (40, 1))), share
    )
    assert set(np.round(along, 9)) == {0.0, 1.0}
    wide, _ = seen_in(levels_of(stripes), turned(8.0, 8.0, 0.0), share)
    assert np.ptp(wide) < 0.2


def test_a_footprint_turns_with_its_pixel():
    """Its axes are the singular values of the steps (numpy's), whatever the pixel's sides are."""
    rng = np.random.default_rng(3)
    right, down = rng.normal(scale=6.0, size=(2, 200, 2))
    seen = footprint(right, down, 12)
    u, size, _ = np.linalg.svd(np.stack([right, down], axis=-1))
    assert np.allclose(seen.length, size[:, 0])
    assert np.allclose(np.abs(np.sum(seen.axis * u[..., 0], axis=-1)), 1.0)
    radius = np.maximum(np.maximum(size[:, 1], size[:, 0] / MOST_PROBES), 1.0)
    assert np.allclose(seen.level, np.log2(radius))
    assert np.all(seen.probes * radius > 0.99 * size[:, 0] - 0.06 * radius)
    assert np.all((seen.probes >= 1) & (seen.probes <= MOST_PROBES))


def test_beside_the_picture_and_around_it():
    picture = np.ones((32, 32))
    share = np.array([[-0.2, 0.5], [0.5, 1.3], [0.0, 0.5], [0.5, 0.5]])
    still = footprint(np.tile([1.0, 0.0], (4, 1)), np.tile([0.0, 1.0], (4, 1)), 6)
    share[2, 0] = -0.25 / 32  # a quarter of a pixel beside it
    [values], on = filtered(levels_of(picture), share, still)
    assert np.allclose(values[:, 0], [0.0, 0.0, 0.75, 1.0])
    assert np.allclose(on, values[:, 0])
    [values], on = filtered(levels_of(picture), share, still, repeats=True)
    assert np.allclose(values[:, 0], [1.0, 0.0, 1.0, 1.0])
    ramp = np.broadcast_to(np.cos(2.0 * np.pi * (np.arange(64) + 0.5) / 64), (8, 64))
    ends = np.array([[-0.5 / 64, 0.5], [63.5 / 64, 0.5]])
    one = footprint(np.full((2, 2), 0.1), np.zeros((2, 2)), 7)
    [values], _ = filtered(levels_of(ramp), ends, one, repeats=True)
    assert np.allclose(values[0], values[1])


@pytest.mark.parametrize("kind", ["cylinder", "sphere", "plane", "box", "mesh"])
def test_steps_on_the_label_are_those_of_the_next_rays(monkeypatch, kind):
    """The derivatives that footprints come from, against what rays beside a place meet."""
    mesh = kind == "mesh"
    form = meshes.shape_of(monkeypatch, meshes.cylinder()) if mesh else Shape(kind)
    view = view_of(form, Eye(azimuth_deg=10.0, elevation_deg=8.0), (64, 64))
    columns, rows = (v.ravel() for v in np.meshgrid(np.arange(20.0, 44.0), np.arange(20.0, 44.0)))
    h = 1e-3
    here, right, down = (
        sight(form, view, columns + x, rows + y) for x, y in ((0.0, 0.0), (h, 0.0), (0.0, h))
    )
    steps = label_steps(form, view, here)
    for step, other in zip(steps, (right, down), strict=True):
        same = here.hit.found & other.hit.found & (here.triangle == other.triangle)
        same &= (here.hit.face == other.hit.face) & (here.hit.face == (4 if kind == "box" else 0))
        assert np.sum(same) > 100
        taken = (other.hit.surface_m - here.hit.surface_m) / h
        # Of triangles the plane is that of the shading normal, up to half a facet of half a degree
        # off: 0.0044 tan(70 degrees) of a step where the surface is seen that obliquely.
        limit = 1.2e-2 if mesh else 2e-3
        size = np.linalg.norm(taken[same], axis=-1)
        assert np.all(np.linalg.norm(step[same] - taken[same], axis=-1) < limit * size + 1e-7)
