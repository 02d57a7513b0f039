"""The lamp turned to the highlight, on every form, from any lamp; pictures without gloss."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from relgloss_view import Look, Scene, load_sample, open_renderer
from relgloss_view.pack.shape import ANALYTIC as SHAPES
from relgloss_view.pack.shape import CURVED, Shape
from relgloss_view.picture.frame import BLACK, NO_GLOSS
from relgloss_view.picture.model.highlight import best_mirror, peak_share
from relgloss_view.picture.model.lamp_placement import lit_for_gloss
from relgloss_view.picture.model.shape import meet
from relgloss_view.picture.model.view import view_of
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup

SIZE = (400, 300)


def random_lamps(count, seed=4):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        azimuth, elevation = rng.uniform(-180.0, 180.0), rng.uniform(-60.0, 60.0)
        yield Lamp(azimuth, elevation, distance_m=rng.uniform(0.4, 3.0))


def stays_inside(setup, place, share=0.06):
    """Whether the form goes on around a place of the picture, a share of its height each way."""
    view = view_of(setup.shape, setup.eye, SIZE)
    reach = share * SIZE[1]
    turns = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    columns = place[0] * SIZE[0] - 0.5 + reach * np.cos(turns)
    rows = place[1] * SIZE[1] - 0.5 + reach * np.sin(turns)
    half = setup.shape.half_extent_m()
    hit = meet(setup.shape.kind, view.eye_m, view.rays_at(columns, rows), half)
    inside = (columns > 0) & (columns < SIZE[0]) & (rows > 0) & (rows < SIZE[1])
    return bool(np.all(hit.found & inside)) and len(np.unique(hit.face)) == 1


@pytest.mark.parametrize("kind", SHAPES)
def test_from_any_lamp_the_highlight_lies_on_the_form(kind):
    """By the law of reflection, of rays drawn here: normal, lamp and eye at the point."""
    for lamp in random_lamps(30):
        setup = lit_for_gloss(Setup(Shape(kind), lamp), SIZE)
        found = best_mirror(setup, SIZE)
        assert found.tilt_deg < 0.5
        to_lamp, to_eye = (p - found.point_m for p in (setup.lamp.position_m, setup.eye.position_m))
        half = to_lamp / np.linalg.norm(to_lamp) + to_eye / np.linalg.norm(to_eye)
        half /= np.linalg.norm(half)
        if kind == "sphere":
            assert half @ found.point_m / np.linalg.norm(found.point_m) > np.cos(np.radians(1.0))
        assert stays_inside(setup, found.place)
        assert 20.0 <= found.incidence_deg <= 55.0
        assert setup.lamp.distance_m == lamp.distance_m
        assert kind not in CURVED or setup.eye == Eye()


def test_without_the_turn_most_of_these_lamps_show_none():
    """The control: the same measure on lamps that were left where they are."""
    good = 0
    lamps = list(random_lamps(30))
    for lamp in lamps:
        found = best_mirror(Setup(Shape("box"), lamp), SIZE)
        good += found is not None and found.tilt_deg < 0.5
    assert good < len(lamps) / 4


@pytest.mark.parametrize("kind", SHAPES)
def test_what_is_placed_stays(kind):
    once = lit_for_gloss(Setup(Shape(kind), Lamp(azimuth_deg=170.0)), SIZE)
    assert lit_for_gloss(once, SIZE) == once


def test_the_papers_own_geometry_stays():
    assert lit_for_gloss(Setup()) == Setup()


def test_the_turn_is_no_larger_than_one_that_the_eye_could_ask_for():
    """A sphere under a lamp behind it: the nearest lamp in front, not any."""
    lamp = Lamp(azimuth_deg=150.0)
    placed = lit_for_gloss(Setup(Shape("sphere"), lamp), SIZE).lamp
    assert 40.0 < placed.azimuth_deg < 90.0  # on the same side
    mirrored = lit_for_gloss(Setup(Shape("sphere"), Lamp(azimuth_deg=-150.0)), SIZE).lamp
    assert -90.0 < mirrored.azimuth_deg < -40.0


def test_an_eye_that_is_placed_is_not_turned():
    eye = Eye(azimuth_deg=35.0, elevation_deg=15.0)
    setup = lit_for_gloss(Setup(Shape("box"), eye=eye), SIZE, turn_eye=False)
    assert setup.eye == eye
    assert best_mirror(setup, SIZE).tilt_deg < 0.5


@pytest.mark.parametrize(
    "setup",
    [
        Setup(Shape("plane"), eye=Eye(azimuth_deg=180.0)),  # seen from behind
        Setup(eye=Eye(distance_m=0.02)),  # from inside
        Setup(Shape("sphere"), Lamp(distance_m=0.01)),  # a lamp inside
    ],
)
def test_where_no_lamp_helps_nothing_changes(setup):
    assert lit_for_gloss(setup, SIZE) == setup


def test_share_of_the_peak_follows_the_lobes():
    material = load_sample("art-coated")
    narrow = dataclasses.replace(material, specular=material.specular[:1])
    s_deg = narrow.specular[0].s_deg
    assert peak_share(narrow, 0.0, 0.0) == 1.0
    assert peak_share(narrow, 0.0, s_deg) == pytest.approx(np.exp(-0.5))
    # Grain adds its variance (the mean over independent Gaussian tilts).
    assert peak_share(narrow, s_deg, s_deg) == pytest.approx(np.exp(-0.25))


class TestWarning:
    @pytest.mark.parametrize("backend", ["reference", "auto"])
    @pytest.mark.parametrize("kind", SHAPES)
    def test_a_picture_without_gloss_warns_and_the_step_mends_it(self, kind, backend):
        lamp = Lamp(azimuth_deg=50.0, elevation_deg=-70.0 if kind == "cylinder" else 0.0)
        lamp = Lamp(azimuth_deg=179.0) if kind == "sphere" else lamp
        bare = Setup(Shape(kind), lamp)
        mended = lit_for_gloss(bare, SIZE)
        with open_renderer(backend) as renderer:
            scene = Scene(load_sample("cast-coated"), bare)
            frame = renderer.render(scene, Look(), (64, 48))
            assert {NO_GLOSS, BLACK} & set(frame.warnings)
            assert frame.lacks_gloss
            frame = renderer.render(Scene(scene.material, mended), Look(), (64, 48))
            assert not {NO_GLOSS, BLACK} & set(frame.warnings)
            assert not frame.lacks_gloss

    def test_a_faint_haze_beside_the_highlight_is_no_gloss(self):
        """The reference seen from 15 degrees: L_s* is 0.9, and c_max 51.7 in place of 0.15."""
        setup = Setup(eye=Eye(elevation_deg=15.0))
        with open_renderer("reference") as renderer:
            frame = renderer.render(Scene(load_sample("cast-coated"), setup), Look(), (64, 64))
            assert frame.l_s_max > 0.5
            assert NO_GLOSS in frame.warnings
            # The control: uncoated paper of the same L_s* order shows its broad highlight there.
            frame = renderer.render(Scene(load_sample("uncoated"), setup), Look(), (64, 64))
            assert NO_GLOSS not in frame.warnings

    def test_a_sample_without_a_lobe_is_not_warned_of(self):
        material = dataclasses.replace(load_sample("cast-coated"), specular=())
        with open_renderer("reference") as renderer:
            frame = renderer.render(Scene(material, shape=Shape("plane")), Look(), (32, 32))
            assert not frame.lacks_gloss
