"""The page draws what the window draws: pixel for pixel on one driver, within a step elsewhere."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest
from browsers import call
from engine_cases import CASES, MATTE, look, pair_of, random_states
from engines import desktop, draw, open_engine, settings_of
from materials import PAPERS, paper

from relgloss_view import Scene
from relgloss_view.display.display import Display
from relgloss_view.pack.shape import Shape

LANES = ("chromium_gl", "chromium_sw")
SIZE = (160, 120)
#: Share of another driver's pixels that may differ by more than one digital value: its logarithms
#: and powers have other last bits, which count where a silhouette or a grain's cell is decided.
MOST_OFF = 1e-4
#: Share that may differ at all: those close to the middle between two digital values. Errors of
#: some 1e-6 of the light make 1e-6 * 255 * 3 channels of them, and steep highlights more.
MOST_ROUNDED = 2e-3
#: Of c_max on another driver: the brightest pixel's L* has an error of some 1e-6 there.
C_MAX_TOLERANCE = 1e-4
PAIRS = (("cast", "art"), ("matte", "uncoated"))
#: Cases of the fast suite; all of them are in the slow one.
FEW = ("eye grain", "sphere", "lamps", "ambient", "smooth edges", "samples")


def papers(names, **entries):
    reference, test = (Scene(paper(name)) for name in names)
    return {
        "reference": (reference, look(c=0.05, grain="eye", **entries)),
        "test": (test, look(sigma_n_deg=1.0, c=0.1, grain="eye", **entries)),
    }


def off(pictures, frames):
    """Largest difference of each pixel of both pictures, digital values."""
    apart = [
        np.abs(pictures[side].astype(int) - frames[side]["display"]).max(axis=-1)
        for side in pictures
    ]
    return np.concatenate([part.ravel() for part in apart])


def assert_same(browser, renderer, sides, settings, size=SIZE, exact=True):
    """Both pictures and what was found of them; returns how many pixels are off by more than 1."""
    report, pictures = draw(browser, settings, size)
    factor, frames = desktop(renderer, sides, settings, size)
    assert report["factor"] == pytest.approx(factor, rel=0.0 if exact else C_MAX_TOLERANCE)
    for side in pictures:
        found, c_max = report[side]["c_max"], frames[side]["c_max"]
        assert (found is None) == (c_max is None)
        if c_max is not None:
            assert found == pytest.approx(c_max, rel=0.0 if exact else C_MAX_TOLERANCE, abs=1e-9)
        assert report[side]["c"] == pytest.approx(frames[side]["c"], rel=1e-4)
    apart = off(pictures, frames)
    assert np.mean(apart > 0) <= (0.0 if exact else MOST_ROUNDED)
    return int(np.sum(apart > 1))


@pytest.mark.parametrize("lane", LANES)
@pytest.mark.parametrize("size", [SIZE, pytest.param((512, 512), marks=pytest.mark.slow)])
def test_papers(request, renderer, lane, size):
    browser = request.getfixturevalue(lane)
    wrong = 0
    for names in PAIRS:
        sides = papers(names)
        open_engine(browser, sides)
        wrong += assert_same(
            browser, renderer, sides, settings_of(sides), size, exact=lane == "chromium_gl"
        )
    # Four pictures in all.
    assert wrong <= MOST_OFF * 4 * size[0] * size[1]


def test_other_pictures_are_found(chromium_gl, renderer):
    """The negative controls: another seed, and a c that is 1 % off."""
    sides = papers(PAIRS[1])
    settings = settings_of(sides)
    open_engine(chromium_gl, papers(PAIRS[1], seed=1))
    _, pictures = draw(chromium_gl, settings, SIZE)
    _, frames = desktop(renderer, sides, settings, SIZE)
    assert np.mean(off(pictures, frames) > 1) > 0.05
    open_engine(chromium_gl, sides)
    c = settings.test.c
    brighter = dataclasses.replace(settings, test=dataclasses.replace(settings.test, c=1.01 * c))
    _, pictures = draw(chromium_gl, brighter, SIZE)
    assert np.mean(off(pictures, frames) > 0) > MOST_ROUNDED


@pytest.mark.parametrize(
    ("lane", "name"),
    [
        pytest.param(
            lane,
            name,
            marks=() if lane == "chromium_gl" and name in FEW else pytest.mark.slow,
        )
        for lane in LANES
        for name in CASES
    ],
)
def test_every_part_of_the_model(request, renderer, lane, name):
    browser, sides = request.getfixturevalue(lane), pair_of(*CASES[name])
    open_engine(browser, sides)
    wrong = assert_same(browser, renderer, sides, settings_of(sides), exact=lane == "chromium_gl")
    assert wrong <= MOST_OFF * 2 * SIZE[0] * SIZE[1]


@pytest.mark.parametrize("lane", LANES)
def test_states_at_random(request, renderer, lane):
    sides = papers(PAIRS[1])
    check_states(request.getfixturevalue(lane), renderer, sides, 4, 1, exact=lane == "chromium_gl")


@pytest.mark.slow
@pytest.mark.parametrize("lane", LANES)
@pytest.mark.parametrize("kind", ["cylinder", "sphere", "plane", "box"])
def test_many_states_at_random(request, renderer, lane, kind):
    display = Display(edges="smooth", dither="ordered")
    scenes = [Scene(paper(name), shape=Shape(kind), display=display) for name in PAPERS]
    browser = request.getfixturevalue(lane)
    for k, grain in enumerate(("screen", "surface", "eye")):
        drawn = look(grain=grain, samples=None if grain == "eye" else 1)
        sides = {"reference": (scenes[k], drawn), "test": (scenes[k + 1], drawn)}
        # 4 shapes of 3 kinds of grain with 17 states each: 204.
        check_states(browser, renderer, sides, 17, k, exact=lane == "chromium_gl")


def check_states(browser, renderer, sides, count, seed, *, exact):
    open_engine(browser, sides)
    states = random_states(count, seed)
    size = (96, 72)
    wrong = sum(assert_same(browser, renderer, sides, state, size, exact=exact) for state in states)
    assert wrong <= MOST_OFF * 2 * count * size[0] * size[1]
    assert call(browser, "() => engine.device.errors()") == []


def test_only_what_changed(chromium_gl):
    """A change of c draws the tone and the edges alone."""
    smooth = Scene(MATTE, display=Display(edges="smooth"))
    sides = pair_of(smooth, look())
    open_engine(chromium_gl, sides)
    counts = call(
        chromium_gl,
        """(s, size) => {
          const seen = [];
          const note = () => {
            engine.draw(s, size);
            seen.push({...engine.passes.reference.draws});
          };
          note();
          note();
          s.reference.c *= 0.9;
          note();
          s.reference.sigma_n_deg *= 0.9;
          note();
          s.lamp.azimuth_deg += 1;
          note();
          s.eye.azimuth_deg += 1;
          note();
          return seen;
        }""",
        settings_of(sides).as_json(),
        list(SIZE),
    )
    steps = [{k: b.get(k, 0) - a.get(k, 0) for k in b} for a, b in itertools.pairwise(counts)]
    drawn = [{name for name, count in step.items() if count} for step in steps]
    light = {"shade", "split", "tone", "edges"}
    assert drawn == [
        set(),
        {"tone", "edges"},
        light,
        light | {"white"},
        light | {"white", "coverage"},
    ]
