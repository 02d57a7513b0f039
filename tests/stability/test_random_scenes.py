"""Random valid scenes over the whole declared ranges: the shaders draw what the reference draws.

The reference computes in float64 and shares nothing with the shaders but the scene. Both methods of
the split are tried in turns. `make test-all` tries thousands.
"""

from __future__ import annotations

import numpy as np
import pytest
from random_scenes import SIZE, Difference, random_scene

from relgloss_view.base.errors import InputError
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.method import Method
from relgloss_view.picture.reference import ReferenceRenderer

QUICK, LONG = range(30), range(30, 3000)
SPLITS = (Method(), Method(split="first pass"))
VISIBLE = 0.5  #: dE2000
#: c differs by what the highlight does; 0.3 % of a highlight's L* is not seen.
SAME_C = 0.005
#: Programs of a software driver take a megabyte or two each, and a search compiles thousands.
MOST_PROGRAMS = 100


@pytest.fixture(scope="module")
def drawer(_session_ctx):
    made = Renderer(_session_ctx)
    yield made
    made.release()


def difference(drawer, seed, method, grain=None):
    """Difference of a random scene's pictures, or None where both renderers refuse it."""
    if len(drawer.programs._arrays) > MOST_PROGRAMS:
        drawer.programs.release()
    scene, look = random_scene(seed, grain=grain)
    drawn, refusals = [], []
    for render in (lambda: drawer.render(scene, look, SIZE, method), None):
        try:
            drawn.append(render() if render else ReferenceRenderer().render(scene, look, SIZE))
        except InputError as error:
            refusals.append(str(error))
    assert len(refusals) in (0, 2), f"seed {seed}: one renderer alone refuses: {refusals[0]}"
    return Difference.of(*drawn) if drawn else None


def faults(drawer, seeds, grain=None):
    """The seeds whose picture is wrong, and how many pictures show the object."""
    wrong, seen = {}, 0
    for seed in seeds:
        found = difference(drawer, seed, SPLITS[seed % 2], grain)
        if found is None:
            continue
        seen += found.seen > 0
        same = found.silhouette == 0 and found.darkest >= 0.0
        if grain != "surface":  # a grain's cell is lost where it is smaller than float32 resolves
            same = same and found.delta_e <= VISIBLE and found.c <= SAME_C
        if not same:
            wrong[seed] = found
    return wrong, seen


@pytest.mark.parametrize("grain", [None, "eye", "surface"])
def test_the_shaders_draw_what_the_reference_draws(drawer, grain):
    seeds = QUICK if grain is None else QUICK[::6]
    wrong, seen = faults(drawer, seeds, grain)
    assert wrong == {}
    assert seen > 0.25 * len(seeds)


@pytest.mark.slow
@pytest.mark.parametrize("grain", [None, "eye", "surface"])
def test_the_shaders_draw_what_the_reference_draws_at_length(drawer, grain):
    seeds = LONG if grain is None else LONG[::6]
    wrong, seen = faults(drawer, seeds, grain)
    assert wrong == {}
    assert seen > 0.25 * len(seeds)


def test_another_picture_is_noticed(drawer):
    """Control: with a lamp that the shaders take to be far off, pictures differ."""
    wrong = {}
    for seed in QUICK[::3]:
        found = difference(drawer, seed, Method(lamp="distant"))
        if found is not None and found.delta_e > VISIBLE:
            wrong[seed] = found
    assert len(wrong) > 1


def test_equal_seeds_give_equal_scenes():
    assert random_scene(5) == random_scene(5)
    assert random_scene(5) != random_scene(6)
    sizes = [random_scene(seed)[0].shape.diameter_m for seed in range(200)]
    assert min(sizes) == 1e-3
    assert max(sizes) == 10.0
    assert np.mean(np.array(sizes) < 0.1) > 0.2  # decades are tried alike
