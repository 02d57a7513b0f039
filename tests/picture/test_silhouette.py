"""Smooth silhouettes and dither: what the display shows, and that all else stays as it was."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from relgloss_view import Look, Scene, load_sample, open_renderer
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.operators.clip import Clip
from relgloss_view.pack.shape import ANALYTIC as SHAPES
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.lamp_placement import lit_for_gloss
from relgloss_view.picture.model.silhouette import coverage, edge_pixels, edge_place, edge_tiles
from relgloss_view.picture.model.view import view_of
from relgloss_view.picture.output.png import digital
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup

SIZE = (150, 110)
SMOOTH = Display(edges="smooth")
EYE = Eye(azimuth_deg=20.0, elevation_deg=15.0)


def setup_of(kind, display, eye=EYE):
    return lit_for_gloss(Setup(Shape(kind), eye=eye), SIZE).placed(display=display)


LOOK = Look()


def drawn(renderer, display, kind="cylinder", look=LOOK, sample="cast-coated"):
    return renderer.render(Scene(load_sample(sample), setup_of(kind, display)), look, SIZE)


@pytest.fixture(scope="module")
def gpu():
    with open_renderer() as renderer:
        yield renderer


@pytest.fixture(scope="module")
def truth():
    with open_renderer("reference") as renderer:
        yield renderer


# --- the share of a pixel ---------------------------------------------------------------------


def row_widths(share):
    return np.sum(share, axis=1)


def test_a_sphere_covers_the_area_of_its_circle():
    """Seen from a distance D its outline is a circle of tangent R / sqrt(D^2 - R^2)."""
    form, eye = Shape("sphere"), Eye()
    view = view_of(form, eye, (101, 101))
    radius = 0.5 * form.diameter_m
    radius_px = radius / np.sqrt(eye.distance_m**2 - radius**2) / view.pixel_step
    share = coverage(form, view)
    assert np.sum(share) == pytest.approx(np.pi * radius_px**2, rel=5e-4)
    rows = np.arange(101) - 50.0
    rays = np.linspace(-0.5, 0.5, 2001)
    within = np.maximum(radius_px**2 - (rows[:, None] + rays) ** 2, 0.0)
    chords = np.mean(2.0 * np.sqrt(within), axis=1)
    np.testing.assert_allclose(row_widths(share), chords, atol=0.25)
    # The control: one sample a pixel makes stairs.
    assert np.max(np.abs(row_widths(share > 0.5) - chords)) > 0.8


@pytest.mark.parametrize("kind", ["plane", "box"])
def test_a_flat_form_covers_the_area_of_its_outline(kind):
    """By the shoelace formula over the hull of the projected corners."""
    from scipy.spatial import ConvexHull

    form = Shape(kind, depth_m=0.05)
    view = view_of(form, EYE, SIZE)
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
    corners = signs * form.half_extent_m() - view.eye_m
    depth = corners @ view.forward
    flat = np.stack([corners @ view.right / depth, corners @ view.up / depth], axis=-1)
    area = ConvexHull(flat / view.pixel_step, qhull_options="QJ").volume
    assert np.sum(coverage(form, view)) == pytest.approx(area, rel=1e-3)


def test_the_rays_have_64_columns_and_rows():
    x, y = edge_place(np.arange(64))
    assert len(np.unique(x)) == len(np.unique(y)) == 64
    assert abs(np.mean(x) - 0.5) < 1e-9 > abs(np.mean(y) - 0.5)


@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize(
    "eye",
    [
        EYE,
        Eye(elevation_deg=85.0),
        Eye(field_of_view_deg=2.0, shift_right=0.05),
        Eye(azimuth_deg=89.0),
        Eye(field_of_view_deg=60.0, distance_m=3.0),  # smaller than a tile
        Eye(distance_m=0.08, field_of_view_deg=100.0),
    ],
)
def test_no_pixel_of_the_silhouette_lies_outside_its_tiles(kind, eye):
    form = Shape(kind)
    view = view_of(form, eye, SIZE)
    inside = np.zeros((SIZE[1] + 20, SIZE[0] + 20), dtype=bool)
    for left, top, side in edge_tiles(form, view).astype(int):
        inside[top : top + side, left : left + side] = True
    for column, row, _ in edge_pixels(coverage(form, view)):
        assert inside[int(row), int(column)]


def test_the_tiles_are_a_small_part_of_the_picture():
    view = view_of(Shape(), EYE, (1000, 1000))
    assert 64 * len(edge_tiles(Shape(), view)) < 0.08 * 1000 * 1000


# --- what is shown ----------------------------------------------------------------------------


@pytest.mark.parametrize("kind", SHAPES)
def test_both_renderers_show_the_same_edges(kind, gpu, truth):
    frames = [drawn(r, Display().for_the_eye(), kind) for r in (gpu, truth)]
    ours, theirs = (f.edges for f in frames)
    np.testing.assert_array_equal(ours[:, :2], theirs[:, :2])
    assert np.max(np.abs(ours[:, 2] - theirs[:, 2])) <= 1.5 / 64
    assert len(ours) > 100
    first, second = (f.display.astype(int) for f in frames)
    assert np.max(np.abs(first - second)) <= 2
    assert np.mean(first != second) < 1e-3
    # The control: without smooth edges the pictures differ by far more.
    plain = drawn(truth, Display(), kind).display.astype(int)
    assert np.max(np.abs(plain - second)) > 20


@pytest.mark.parametrize("kind", SHAPES)
def test_an_edge_is_mixed_in_linear_light(kind, truth):
    """Recomputed from the frame's own light, pixel by pixel."""
    frame = drawn(truth, SMOOTH, kind)
    model = DisplayModel.of(SMOOTH)
    light, on = frame.light, frame.on_object
    checked = 0
    for column, row, share in frame.edges:
        x, y = int(column), int(row)
        if not on[y, x]:
            continue
        mixed = share * light[y, x] + (1.0 - share) * model.background_light
        assert (
            frame.display[y, x].tolist()
            == np.floor(255.0 * tone.encode(mixed, model) + 0.5).astype(int).tolist()
        )
        checked += 1
    assert checked > 40


def test_a_missed_pixel_takes_the_nearest_colour(truth):
    frame = drawn(truth, SMOOTH, "plane", sample="uncoated")
    on, light = frame.on_object, frame.light
    background = DisplayModel.of(SMOOTH).background_light
    seen = 0
    for column, row, share in frame.edges:
        x, y = int(column), int(row)
        if on[y, x] or share < 0.2:
            continue
        code = frame.display[y, x] / 255.0
        linear = np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)
        colour = (linear - (1.0 - share) * background) / share
        near = light[y - 1 : y + 2, x - 1 : x + 2][on[y - 1 : y + 2, x - 1 : x + 2]]
        assert np.min(np.max(np.abs(near - colour), axis=-1)) < 0.02
        seen += 1
    assert seen > 20


@pytest.mark.parametrize("look", [Look(), Look(sigma_n_deg=2.0, c=0.4), Look(c=2.0)])
def test_no_number_of_a_picture_changes(look, gpu, truth):
    for renderer in (gpu, truth):
        plain = drawn(renderer, Display(), "box", look)
        kept = {
            name: np.array(getattr(plain, name))
            for name in ("diffuse", "specular", "light", "lab", "coverage", "normal")
        }
        counts = plain.c, plain.c_max, plain.clip_count, plain.out_of_gamut_count
        flags = plain.clipped.copy(), plain.out_of_gamut.copy()
        shown = plain.display.copy()
        eyed = drawn(renderer, Display().for_the_eye(), "box", look)
        for name, values in kept.items():
            np.testing.assert_array_equal(getattr(eyed, name), values)
        assert (eyed.c, eyed.c_max, eyed.clip_count, eyed.out_of_gamut_count) == counts
        np.testing.assert_array_equal(eyed.clipped, flags[0])
        np.testing.assert_array_equal(eyed.out_of_gamut, flags[1])
        assert np.any(eyed.display != shown)


def test_the_plain_display_is_as_it_always_was(truth):
    frame = drawn(truth, Display())
    model = DisplayModel.of(Display())
    expected = np.floor(255.0 * tone.encode(frame.light, model) + 0.5)
    np.testing.assert_array_equal(frame.display, expected)
    assert frame.edges is None


def test_several_samples_have_shares_of_their_own(gpu):
    look = Look(samples=4)
    smooth, plain = (drawn(gpu, d, look=look) for d in (SMOOTH, Display()))
    assert smooth.edges is None
    np.testing.assert_array_equal(smooth.display, plain.display)


def test_operators_and_16_bits_are_smooth_too(truth):
    frame = drawn(truth, Display().for_the_eye(), "sphere")
    plain = drawn(truth, Display(), "sphere")
    for displayed, before in ((None, None), (Clip().draw(frame), Clip().draw(plain))):
        for bits, top in ((8, 255), (16, 65535)):
            ours, old = digital(frame, displayed, bits), digital(plain, before, bits)
            changed = np.max(np.abs(ours.astype(int) - old), axis=-1) > 0.02 * top
            at_edge = np.zeros(changed.shape, dtype=bool)
            column, row = frame.edges[:, :2].astype(int).T
            at_edge[row, column] = True
            assert np.any(changed)
            assert not np.any(changed & ~at_edge)
    # An operator's measured light stays.
    np.testing.assert_array_equal(Clip().draw(frame).light, Clip().draw(plain).light)


def test_a_change_of_c_draws_pass_2_and_the_edges_alone(gpu):
    drawn(gpu, SMOOTH, look=Look(c=0.2))
    before = dict(gpu.draws)
    frame = drawn(gpu, SMOOTH, look=Look(c=0.3))
    after = {name: gpu.draws[name] - before[name] for name in before}
    assert {name for name, count in after.items() if count} == {"tone", "edges"}
    again = frame.display.copy()
    drawn(gpu, Display(), look=Look(c=0.3))
    np.testing.assert_array_equal(drawn(gpu, SMOOTH, look=Look(c=0.3)).display, again)


# --- dither -----------------------------------------------------------------------------------


def test_the_steps_are_spread_evenly():
    rows, columns = np.mgrid[0:256, 0:256]
    steps = tone.dither_step(columns, rows)
    assert -0.5 < steps.min() < -0.4999
    assert 0.4999 < steps.max() < 0.5
    counts, _ = np.histogram(steps, bins=16, range=(-0.5, 0.5))
    assert np.max(np.abs(counts / counts.mean() - 1.0)) < 0.01
    # No coarse pattern: means of 8 x 8 pixels stay close to zero; white noise has 0.036.
    blocks = steps.reshape(32, 8, 32, 8).mean(axis=(1, 3))
    assert np.std(blocks) < 0.012
    noise = np.random.default_rng(1).uniform(-0.5, 0.5, (256, 256))
    assert np.std(noise.reshape(32, 8, 32, 8).mean(axis=(1, 3))) > 0.03


@pytest.mark.parametrize("backend", ["gpu", "truth"])
def test_a_gradient_shows_no_bands(backend, request):
    """Means over 9 x 9 pixels follow the light within a part of a step, by dither alone."""
    from scipy.ndimage import uniform_filter

    renderer = request.getfixturevalue(backend)

    def error(display):
        setup = setup_of("plane", display, dataclasses.replace(EYE, field_of_view_deg=2.0))
        frame = renderer.render(Scene(load_sample("cast-coated"), setup), Look(c=0.0), SIZE)
        model = DisplayModel.of(display)
        exact = 255.0 * tone.encode(frame.light.astype(np.float64), model)[..., 1]
        whole = uniform_filter(frame.on_object.astype(float), 9) > 0.999
        difference = uniform_filter(frame.display[..., 1] - exact, 9)[whole]
        return np.max(np.abs(difference))

    assert error(Display(dither="ordered")) < 0.2
    assert error(Display()) > 0.4


def test_the_surround_stays_one_value(gpu, truth):
    for renderer in (gpu, truth):
        frame = drawn(renderer, Display().for_the_eye())
        touched = frame.on_object.copy()
        column, row = frame.edges[:, :2].astype(int).T
        touched[row, column] = True
        assert len(np.unique(frame.display[~touched].reshape(-1, 3), axis=0)) == 1
        assert len(np.unique(frame.display[touched].reshape(-1, 3), axis=0)) > 20


def test_dither_is_the_same_each_time_and_keeps_whole_values(gpu):
    display = Display(dither="ordered")
    once = drawn(gpu, display).display.copy()
    drawn(gpu, Display())
    np.testing.assert_array_equal(drawn(gpu, display).display, once)
    plain = drawn(gpu, Display()).display.astype(int)
    assert np.max(np.abs(once - plain)) == 1
    model = DisplayModel.of(display)
    white = tone.digital_steps(np.ones((4, 4, 3)), model, np.ones((4, 4), dtype=bool))
    assert np.all(white == 255.0)


def test_another_display_dithers_too(gpu, truth):
    display = dataclasses.replace(
        Display(transfer="gain-offset-gamma", gamma=1.8, flare=0.01).for_the_eye()
    )
    lamp = Lamp(azimuth_deg=60.0)
    scene = Scene(load_sample("matte-coated"), Setup(lamp=lamp, display=display))
    first, second = (r.render(scene, Look(c=0.3), SIZE).display.astype(int) for r in (gpu, truth))
    assert np.max(np.abs(first - second)) <= 2
    assert np.mean(first != second) < 5e-3


def test_a_picture_without_a_silhouette_keeps_none_of_the_one_before():
    """The eye so close that the object fills the picture, after one with an outline."""
    look, close = Look(sigma_n_deg=0.0), Eye(distance_m=0.05, field_of_view_deg=2.0)
    with open_renderer() as renderer:
        assert len(drawn(renderer, SMOOTH, look=look).edges) > 0
        scene = Scene(load_sample("cast-coated"), setup_of("cylinder", SMOOTH, close))
        after = renderer.render(scene, look, SIZE)
        after_display, after_edges = after.display, after.edges
    with open_renderer() as renderer:
        alone = renderer.render(scene, look, SIZE)
        assert np.all(alone.on_object)
        np.testing.assert_array_equal(after_display, alone.display)
    assert len(after_edges) == 0
