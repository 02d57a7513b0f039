import dataclasses
import itertools

import materials
import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.material.material import Diffuse
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.method import EXACT
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp
from relgloss_view.quality import planner
from relgloss_view.quality.domains import outside
from relgloss_view.quality.planner import (
    DEFAULT_TOLERANCE,
    SAVINGS,
    WHOLE,
    MethodChooser,
    Tolerance,
    advise,
)
from relgloss_view.quality.proxy import HIGHLIGHT_LSTAR, Proxy

SIZE = (640, 360)
WIDE = Shape(diameter_m=0.125, height_m=0.075)


def scene(sample="matte-coated", azimuth_deg=50.0):
    return Scene(load_sample(sample), shape=WIDE, lamp=Lamp(azimuth_deg=azimuth_deg))


def matched(sample):
    return Look(sigma_n_deg=SAMPLES[sample].sigma_n_deg, c_fraction=SAMPLES[sample].c_fraction)


def chosen(advice):
    return {choice.stage: choice.chosen for choice in advice.choices}


def shown_lab(frame):
    """Lab of what the display shows, gamut mapping included."""
    display = DisplayModel.of(frame.scene.display)
    xyz = frame.light.astype(np.float64) @ display.xyz_from_rgb.T
    return tone.lab_from_xyz(xyz, display.white)


@pytest.mark.parametrize("size", [SIZE, (256, 144)])
@pytest.mark.parametrize("azimuth_deg", [50.0, 110.0])
@pytest.mark.parametrize("sample", list(SAMPLES))
@pytest.mark.parametrize("c", ["matched", "c_max", "c of 1"])
def test_auto_is_inside_the_tolerance_over_the_whole_picture(
    renderer, sample, azimuth_deg, size, c
):
    """Measured on every pixel that is shown, each picture with the c that it finds itself."""
    drawn, look = scene(sample, azimuth_deg), matched(sample)
    if c != "matched":
        look = dataclasses.replace(look, c_fraction=None, c=1.0 if c == "c of 1" else None)
    frame = renderer.render(drawn, look, size)
    exact, on = shown_lab(frame), frame.on_object
    highlight = on & (frame.split[1] > HIGHLIGHT_LSTAR)
    auto = renderer.render(drawn, dataclasses.replace(look, quality="auto"), size)
    if azimuth_deg == 50.0 and c == "c of 1":
        assert auto.method.differences()  # or nothing is compared
    difference = delta_e_2000(exact, shown_lab(auto))
    assert np.percentile(difference[on], 95) <= DEFAULT_TOLERANCE.p95
    assert np.percentile(difference[highlight], 95) <= DEFAULT_TOLERANCE.p95
    # Where a highlight clips, single pixels at its edge change more than those that were looked at.
    share = 0.999 if c == "c of 1" else 1.0
    assert np.quantile(difference[on], share) <= DEFAULT_TOLERANCE.largest


class TestChoices:
    def test_the_next_simpler_one_is_refused_for_a_reason(self):
        advice = advise(scene("uncoated", 110.0), matched("uncoated"), SIZE)
        for choice in advice.choices:
            order = list(SAVINGS[choice.stage])
            if choice.simpler is None:
                assert choice.reason or choice.chosen == order[0]
                continue
            assert order.index(choice.simpler) < order.index(choice.chosen)
            inside = DEFAULT_TOLERANCE.holds(choice.simpler_error, *planner.USED)
            assert choice.reason if inside else True
        assert any(choice.simpler is not None for choice in advice.choices)

    def test_its_error_is_measured_on_the_whole(self):
        drawn, look = scene("uncoated"), matched("uncoated")
        advice = advise(drawn, look, SIZE)
        assert advice.error == Proxy(drawn, look, SIZE).error(advice.method)
        assert DEFAULT_TOLERANCE.holds(advice.error)

    def test_no_choice_leaves_its_domain(self):
        for sample in SAMPLES:
            drawn, look = scene(sample, 110.0), matched(sample)
            left = outside(drawn, look, advise(drawn, look, SIZE).method)
            assert not [name for name in left if not name.endswith(tuple(_exact_names()))]

    def test_single_pixels_that_set_c_are_drawn(self):
        """Grain and the highlight's top decide on c_max; where c is given they do not."""
        drawn = scene("cast-coated")
        for look in (Look(), Look(sigma_n_deg=0.02)):
            differences = advise(drawn, look, SIZE).method.differences()
            assert not {"c_max", "noise"} & set(differences)
        assert advise(drawn, Look(c=0.1), SIZE).method.c_max == "exact"
        assert advise(drawn, Look(c=0.1, sigma_n_deg=0.01), SIZE).method.noise != "drawn"

    @pytest.mark.parametrize(
        ("changes", "look"),
        [
            ({"lamp": Lamp(azimuth_deg=178.0)}, Look()),
            ({}, Look(samples=2)),
            ({"shape": Shape("plane"), "lamp": Lamp(0.0, 58.0)}, Look(sigma_n_deg=2.0)),
        ],
        ids=["hardly lit", "supersampled", "weak"],
    )
    def test_what_hangs_on_few_pixels_is_drawn_exactly(self, changes, look):
        advice = advise(dataclasses.replace(scene(), **changes), look, SIZE)
        assert advice.method == WHOLE
        assert advice.note

    def test_more_is_drawn_for_a_smaller_tolerance(self):
        drawn, look = scene("uncoated"), matched("uncoated")
        loose = advise(drawn, look, SIZE, Tolerance(p95=2.0, largest=8.0))
        tight = advise(drawn, look, SIZE, Tolerance(p95=0.02, largest=0.1))
        assert loose.saved_percent > tight.saved_percent
        assert loose.method.diffuse != "fitted"
        assert tight.method.diffuse == "fitted"

    def test_nothing_but_what_is_free_at_no_tolerance(self):
        advice = advise(scene("uncoated"), matched("uncoated"), SIZE, Tolerance(0.0, 0.0))
        assert advice.error == planner.NO_ERROR
        assert set(advice.method.differences()) <= {"gamut", "c_max"}

    def test_what_a_scene_has_not_is_no_stage(self):
        without = Scene(materials.flat(), shape=WIDE)
        assert not {"lobes", "fresnel", "shadowing", "c_max", "diffuse", "noise"} & set(
            chosen(advise(without, Look(), SIZE))
        )
        assert "noise" not in chosen(advise(scene(), Look(), SIZE))
        assert chosen(advise(scene(), Look(sigma_n_deg=2.0), SIZE))["noise"] == "drawn"

    def test_roughness_that_is_not_seen_is_not_drawn(self):
        paper = materials.paper("matte")
        seen = Scene(
            dataclasses.replace(paper, diffuse=Diffuse("oren-nayar", paper.diffuse.albedo, 25.0)),
            shape=WIDE,
            lamp=Lamp(azimuth_deg=110.0),
        )
        unseen = dataclasses.replace(
            seen,
            material=dataclasses.replace(
                paper, diffuse=Diffuse("oren-nayar", paper.diffuse.albedo, 1.0)
            ),
        )
        assert chosen(advise(unseen, Look(), SIZE))["diffuse"] == "lambert"
        assert chosen(advise(seen, Look(), SIZE))["diffuse"] == "fitted"

    def test_colours_out_of_gamut_keep_their_mapping(self, renderer):
        drawn, look = scene("cast-coated"), Look()
        assert renderer.render(drawn, look, SIZE).out_of_gamut_count > 0
        assert chosen(advise(drawn, look, SIZE))["gamut"] == "as asked"
        dim = Look(c=0.01)
        assert renderer.render(drawn, dim, SIZE).out_of_gamut_count == 0
        assert chosen(advise(drawn, dim, SIZE))["gamut"] == "clip"

    def test_nothing_seen(self):
        away = dataclasses.replace(scene(), eye=Eye(shift_right=50.0))
        advice = advise(away, Look(), SIZE)
        assert (advice.method, advice.choices) == (WHOLE, ())
        assert advice.note

    def test_what_no_c_can_show_is_refused(self):
        with pytest.raises(InputError, match="c_max"):
            advise(Scene(materials.flat(1.5), shape=WIDE), Look(), SIZE)

    @pytest.mark.parametrize("shape", ["sphere", "plane", "box"])
    def test_every_shape(self, shape):
        drawn = Scene(load_sample("uncoated"), shape=Shape(kind=shape))
        assert DEFAULT_TOLERANCE.holds(advise(drawn, Look(sigma_n_deg=1.0), (200, 150)).error)


def _exact_names():
    return {str(value) for value in dataclasses.asdict(EXACT).values()}


class TestPlanner:
    AUTO = Look(sigma_n_deg=2.0, c_fraction=0.5, quality="auto")

    def test_exact_is_not_planned(self, monkeypatch):
        monkeypatch.setattr(planner, "advise", None)
        assert MethodChooser().method(scene(), Look(), SIZE) == EXACT

    def test_a_plan_is_made_once_a_scene(self, monkeypatch):
        made = []
        monkeypatch.setattr(planner, "advise", lambda *args: made.append(args) or advise(*args))
        one = MethodChooser()
        drawn = scene()
        first = one.method(drawn, self.AUTO, SIZE)
        assert one.method(drawn, self.AUTO, SIZE) == first
        assert len(made) == 1
        other = dataclasses.replace(drawn, lamp=Lamp(azimuth_deg=110.0))
        assert one.method(other, self.AUTO, SIZE) != first
        assert len(made) == 2

    def test_another_display_is_another_picture(self):
        one, drawn = MethodChooser(), scene()
        one.method(drawn, self.AUTO, SIZE)
        clipped = dataclasses.replace(drawn, display=Display(gamut="clip"))
        assert one.advice(clipped, self.AUTO, SIZE) == advise(clipped, self.AUTO, SIZE)

    @pytest.mark.parametrize("eye", [Eye(shift_right=50.0), Eye(distance_m=0.01)])
    def test_what_moves_out_of_sight_is_no_fault(self, eye):
        seconds = iter(range(1000))
        held = MethodChooser(clock=lambda: float(next(seconds)))
        assert held.method(scene(), self.AUTO, SIZE) != WHOLE
        held.moving = True
        gone = dataclasses.replace(scene(), eye=eye)
        assert held.method(gone, self.AUTO, SIZE) == WHOLE

    def test_the_same_scene_has_the_same_plan(self):
        assert advise(scene(), self.AUTO, SIZE) == advise(scene(), self.AUTO, SIZE)

    def test_what_cannot_be_shown_is_left_to_the_drawing(self):
        white = Scene(materials.flat(1.5), shape=WIDE)
        assert MethodChooser().method(white, Look(quality="auto"), SIZE) == WHOLE

    def test_a_picture_that_stands_still_is_checked_once(self, monkeypatch):
        """Beside one that moves, and after another was advised in between."""
        looks = []
        seconds = iter(range(1000))
        held = MethodChooser(clock=lambda: float(next(seconds)))
        first, second = scene(), scene(azimuth_deg=51.0)
        held.method(first, self.AUTO, SIZE)
        monkeypatch.setattr(planner, "Proxy", lambda *words: looks.append(words) or Proxy(*words))
        held.moving = True
        for _ in range(3):
            held.method(first, self.AUTO, SIZE)
        assert not looks
        for _ in range(3):
            held.method(second, self.AUTO, SIZE)
        assert len(looks) == 1
        held.moving = False
        held.method(first, self.AUTO, SIZE)
        held.moving = True
        held.method(second, self.AUTO, SIZE)
        assert len(looks) == 2

    def test_a_moving_slider_does_not_flicker(self):
        """The lamp trembles about where Lambert ceases to do: at most one change until it rests.

        Negative control: planned anew at each step, the picture changes its method many times.
        """
        limit = _where_diffuse_changes()
        places = [limit + (0.4 if k % 2 else -0.4) for k in range(12)]
        scenes = [scene("uncoated", azimuth_deg) for azimuth_deg in places]
        anew = [advise(s, self.AUTO, SIZE).method.diffuse for s in scenes]
        assert _changes(anew) >= 6

        seconds = iter(range(1000))
        held = MethodChooser(clock=lambda: float(next(seconds)))
        held.method(scenes[0], self.AUTO, SIZE)
        held.moving = True
        moved = [held.method(s, self.AUTO, SIZE) for s in scenes]
        assert _changes(moved) <= 1
        for s, method in zip(scenes, moved, strict=True):
            assert DEFAULT_TOLERANCE.holds(Proxy(s, self.AUTO, SIZE).error(method))
        held.moving = False
        assert held.method(scenes[0], self.AUTO, SIZE) == advise(scenes[0], self.AUTO, SIZE).method

    def test_it_looks_at_a_moving_picture_ten_times_a_second_at_most(self, monkeypatch):
        now = [0.0]
        held = MethodChooser(clock=lambda: now[0])
        held.method(scene(), self.AUTO, SIZE)
        held.moving = True
        looked = []
        monkeypatch.setattr(planner, "Proxy", lambda *args: looked.append(args) or Proxy(*args))
        for k in range(30):
            now[0] = 0.01 * k
            held.method(scene(azimuth_deg=50.0 + 0.01 * k), self.AUTO, SIZE)
        assert 2 <= len(looked) <= 4


def _changes(values):
    return sum(a != b for a, b in itertools.pairwise(values))


def _where_diffuse_changes():
    low, high = 20.0, 110.0
    at = advise(scene("uncoated", low), TestPlanner.AUTO, SIZE).method.diffuse
    for _ in range(9):
        middle = 0.5 * (low + high)
        same = advise(scene("uncoated", middle), TestPlanner.AUTO, SIZE).method.diffuse == at
        low, high = (middle, high) if same else (low, middle)
    return 0.5 * (low + high)
