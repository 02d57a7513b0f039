"""Reference and design at one scale: in Python, in the page, and under the hand."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from browsers import call
from engine_cases import ART, MATTE, SMOOTH, TURNED, look
from engines import desktop, draw, open_engine, settings_of

from relgloss_view import Scene
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.model.view import View, at_one_scale
from relgloss_view.picture.scene.setup import Eye
from relgloss_view.proof.drawing import drawing_of
from relgloss_view.proof.pair import Pair
from relgloss_view.viewer.drawing import camera

SIZE = (96, 80)
SPHERE = Shape("sphere", diameter_m=0.03)
EYE = Eye(azimuth_deg=15.0, elevation_deg=10.0)


def two_forms():
    return {
        "reference": (Scene(MATTE, eye=EYE), look(c=0.1)),
        "test": (Scene(ART, eye=EYE, shape=SPHERE), look(c=0.1)),
    }


def height_px(on_object):
    rows = np.flatnonzero(on_object.any(axis=1))
    return rows[-1] - rows[0] + 1


def test_pictures_of_a_proof_are_at_one_scale(renderer):
    sides = two_forms()
    pair = Pair(
        {s: one for s, (one, _) in sides.items()}, {s: one for s, (_, one) in sides.items()}
    )
    drawn = pair.drawn(renderer, SIZE)
    step = View.of(pair.scenes["reference"], SIZE).pixel_step  # the larger object fills the frame
    # A silhouette lies within half a pixel at each end.
    across = 0.03 / np.sqrt(0.6**2 - 0.015**2) / step
    assert height_px(drawn["test"].on_object) == pytest.approx(across, abs=1.0)
    alone = renderer.render(pair.scenes["test"], pair.looks["test"], SIZE)
    assert height_px(alone.on_object) > 1.5 * across  # the negative control: framed by itself


def test_an_eye_with_an_angle_and_one_form_stay():
    eye = Eye(field_of_view_deg=9.0)
    assert at_one_scale((Shape(), SPHERE), eye, SIZE) == eye
    assert at_one_scale((Shape(), Shape()), EYE, SIZE) == EYE
    assert at_one_scale((Shape(), SPHERE), EYE, SIZE) != EYE


def test_the_page_frames_as_python(chromium_gl):
    """40 eyes and sizes: the same angle, and the same step of a pixel in float32."""
    rng = np.random.default_rng(7)
    shapes = [Shape(), SPHERE, Shape("box"), Shape("plane")]
    for first, second in ((0, 1), (1, 2), (3, 0), (2, 2)):
        pair = (shapes[first], shapes[second])
        scenes = [Scene(MATTE, shape=shape) for shape in pair]
        open_engine(chromium_gl, {"reference": (scenes[0], look()), "test": (scenes[1], look())})
        eyes = [
            Eye(rng.uniform(-180, 180), rng.uniform(-80, 80), rng.uniform(0.15, 2.0))
            for _ in range(10)
        ]
        sizes = rng.integers(40, 900, (10, 2)).tolist()
        found = call(
            chromium_gl,
            """(eyes, sizes) => eyes.map((eye, k) => {
              const {drawing} = engine, seen = atOneScale(drawing, eye, sizes[k]);
              const steps = Object.values(drawing.sides).map(({shape}) =>
                View.of(shape, seen, sizes[k], drawing.numbers).pixelStep);
              return [seen.field_of_view_deg ?? null, ...steps];
            })""",
            [{k: v for k, v in vars(eye).items() if v is not None} for eye in eyes], sizes,
        )  # fmt: skip
        for eye, size, (angle, *steps) in zip(eyes, map(tuple, sizes), found, strict=True):
            expected = at_one_scale(pair, eye, size)
            if first == second:
                assert angle is None  # the negative control
                continue
            # Double precision on both sides, through one tangent and its inverse.
            assert angle == pytest.approx(expected.field_of_view_deg, rel=1e-12)
            step = View.of(scenes[0].placed(eye=expected), size).pixel_step
            assert steps == [step, step]


def test_the_page_draws_two_forms_as_the_window(chromium_gl, renderer):
    sides = two_forms()
    open_engine(chromium_gl, sides)
    settings = settings_of(sides)
    report, pictures = draw(chromium_gl, settings, SIZE)
    factor, frames = desktop(renderer, sides, settings, SIZE)
    assert report["factor"] == factor
    for side, picture in pictures.items():
        assert np.array_equal(picture, frames[side]["display"]), side
    eye = dataclasses.replace(settings.eye, field_of_view_deg=8.0)
    _, closer = draw(chromium_gl, dataclasses.replace(settings, eye=eye), SIZE)
    assert not np.array_equal(closer["test"], pictures["test"])  # the negative control


def test_smooth_silhouettes_wait_for_the_rest(chromium_gl):
    """Where they lie is looked for once a view, which a moving hand has no time for."""
    scene = Scene(ART, eye=TURNED, display=SMOOTH)
    sides = {"reference": (scene, look()), "test": (scene, look())}
    open_engine(chromium_gl, sides)
    drawn = call(
        chromium_gl,
        """(s) => {
          const counts = [], turned = {...s, eye: {...s.eye, azimuth_deg: 3}};
          const count = (settings, moving) => {
            engine.draw(settings, [64, 64], {moving});
            const {draws} = engine.passes.test;
            counts.push([draws.coverage ?? 0, draws.edges ?? 0]);
          };
          count(s, false);
          count(turned, true);
          count(turned, false);
          count({...turned, test: {...turned.test, c: 0.5 * s.test.c}}, true);
          return counts;
        }""",
        settings_of(sides).as_json(),
    )
    # c changes no view, so its silhouettes stay smooth while it moves.
    assert drawn == [[1, 1], [1, 1], [2, 2], [2, 3]]


#: The hand of the page on a shape, as the window's of camera.py.
HAND = """(asked) => {
  const {zoomed, panned} = relgloss.hand, {numbers} = relgloss.engine.drawing;
  return asked.map(({shape, eye, size, pointer, notches, moved}) => {
    const seen = {shape, eye, numbers};
    return [zoomed(seen, notches, pointer, size), panned(seen, moved, size)];
  });
}"""


def test_zooming_and_shifting_are_those_of_the_window(sample_in_page):
    rng = np.random.default_rng(11)
    asked, expected, stopped = [], [], 0
    for shape in (Shape(), SPHERE, Shape("box"), Shape("plane")):
        scene = Scene(MATTE, shape=shape)
        form = drawing_of({"test": (scene, look())}, ())["sides"]["test"]["shape"]
        for _ in range(25):
            angle = None if rng.random() < 0.5 else rng.uniform(0.1, 150.0)
            eye = Eye(
                rng.uniform(-180, 180), rng.uniform(-60, 60), rng.uniform(0.1, 2.0), angle,
                *rng.uniform(-0.02, 0.02, 2),
            )  # fmt: skip
            size = tuple(rng.integers(50, 900, 2).tolist())
            pointer = tuple((rng.random(2) * size).tolist())
            moved = tuple(rng.uniform(-1.5, 1.5, 2) * size)
            notches = float(rng.uniform(-9, 9))
            placed = scene.placed(eye=eye)
            given = {k: v for k, v in vars(eye).items() if v is not None}
            asked.append(
                {"shape": form, "eye": given, "size": size, "pointer": pointer,
                 "notches": notches, "moved": moved}
            )  # fmt: skip
            zoom, pan = (
                camera.zoomed(placed, notches, pointer, size),
                camera.panned(placed, moved, size),
            )
            expected.append((zoom, pan))
            step = View.of(placed, size).pixel_step
            free = eye.shift_right - moved[0] * step, eye.shift_up + moved[1] * step
            stopped += (pan.shift_right, pan.shift_up) != free
    found = call(sample_in_page, HAND, asked)
    for one, other in zip(found, expected, strict=True):
        for eye, wanted in zip(one, other, strict=True):
            for name in ("field_of_view_deg", "shift_right", "shift_up"):
                value, goal = eye.get(name), getattr(wanted, name)
                # 40 halvings leave 1e-12 of a shift; sums of a few doubles less.
                assert value == (None if goal is None else pytest.approx(goal, rel=1e-9, abs=1e-11))
    assert 20 < stopped < 100  # some drags would lose the object, some would not
