"""Matched pairs: their ratio, that it holds in every view, and what the pictures then show."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest
from materials import paper
from PIL import Image

from relgloss_view.base.errors import InputError
from relgloss_view.gloss.comparison import factor_in_view
from relgloss_view.gloss.match import (
    LAMPS_DEG,
    SIGMAS_N_DEG,
    CurvePoint,
    Reference,
    _crossings,
    absolute_c,
    as_numbers,
    full_c,
    gloss_of,
    match_curve,
    matched,
    matched_point,
)
from relgloss_view.gloss.match_check import TIES, check_pose
from relgloss_view.gloss.match_plot import write_match_plot
from relgloss_view.gloss.meter.meter import hypothetical
from relgloss_view.gloss.pose import pose_of
from relgloss_view.gloss.samples import SampleLook
from relgloss_view.pack.shape import ANALYTIC as SHAPES
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup

SIZE = (256, 256)
NAMES = tuple(SAMPLES)


def published(name):
    return SampleLook(name, load_sample(name), Look().at(SAMPLES[name]))


def at_own_grain(name):
    return SampleLook(name, load_sample(name), Look(sigma_n_deg=SAMPLES[name].sigma_n_deg))


@pytest.fixture(scope="module")
def reference():
    return Reference.default()


@pytest.fixture(scope="module")
def papers(reference):
    """The four papers at their matched c."""
    return [reference.matched_look(at_own_grain(name)) for name in NAMES]


class TestRatio:
    def test_the_reference_is_cast_coated_at_c_max_of_the_papers_geometry(self, reference):
        assert reference.sample.label == "cast-coated"
        assert reference.c == full_c(load_sample("cast-coated"))

    @pytest.mark.parametrize("name", NAMES)
    def test_mean_of_the_displayed_gloss_has_the_ratio_of_the_readings(self, reference, name):
        """Worked out again from the poses' peaks, which tests/gloss/test_pose.py checks."""
        material, sigma = load_sample(name), SAMPLES[name].sigma_n_deg
        c = matched_point(reference, material, sigma).c
        ratios = []
        for lamp in LAMPS_DEG:
            pose = pose_of(Setup(lamp=Lamp(azimuth_deg=lamp)))
            shown = c * pose.peak(material, sigma)
            ratios.append(shown / (reference.c * pose.peak(reference.sample.material)))
        real = gloss_of(material) / gloss_of(reference.sample.material)
        assert np.exp(np.mean(np.log(ratios))) == pytest.approx(real, rel=1e-9)

    def test_the_reference_matches_itself(self, reference):
        point = matched_point(reference, reference.sample.material, 0.0)
        assert point.c == pytest.approx(reference.c, rel=1e-12)
        assert point.spread == pytest.approx(1.0)

    def test_a_share_of_the_reference_scales_all(self, reference):
        half = dataclasses.replace(reference.sample, look=Look(c_fraction=0.5))
        matte = load_sample("matte-coated")
        c = matched_point(Reference.of(half), matte, 2.0).c
        assert c == pytest.approx(0.5 * matched_point(reference, matte, 2.0).c)

    def test_the_ratio_follows_the_chosen_reading(self, reference):
        by_20 = Reference.of(reference.sample, "gloss-20")
        art = load_sample("art-coated")
        change = matched_point(by_20, art, 0.0).c / matched_point(reference, art, 0.0).c
        readings = {
            angle: gloss_of(art, angle) / gloss_of(reference.sample.material, angle)
            for angle in ("gloss-20", "gloss-75")
        }
        assert change == pytest.approx(readings["gloss-20"] / readings["gloss-75"])

    def test_published_settings_against_the_proposals(self, reference):
        """What docs/match.md reports: the observers chose more gloss than the readings' ratio."""
        shown = {}
        for name in NAMES[1:]:
            found = match_curve(reference, published(name), grain_deg=0.0, compare_setting=True)
            shown[name] = found.own_setting.ratio
        assert shown["art-coated"] == pytest.approx(0.862, abs=0.01)
        assert shown["matte-coated"] == pytest.approx(0.345, abs=0.01)
        assert shown["uncoated"] == pytest.approx(0.183, abs=0.01)


def mirrored_setup(kind, rng):
    """A random pose of the issue's ranges in which the form mirrors the lamp to the eye."""
    while True:
        lamp = Lamp(
            azimuth_deg=float(rng.uniform(20, 140)), elevation_deg=float(rng.uniform(-30, 60))
        )
        towards = lamp.position_m / np.linalg.norm(lamp.position_m)
        if kind == "plane":
            normal = np.array([0.0, 0.0, 1.0])
        elif kind == "box":
            normal = np.eye(3)[rng.integers(3)]
        elif kind == "cylinder":
            turn = rng.uniform(0, 2 * np.pi)
            normal = np.array([np.sin(turn), 0.0, np.cos(turn)])
        else:
            normal = rng.normal(size=3)
            normal /= np.linalg.norm(normal)
        out = 2.0 * (normal @ towards) * normal - towards
        elevation = float(np.degrees(np.arcsin(np.clip(out[1], -1, 1))))
        if normal @ towards < 0.15 or abs(elevation) > 75.0:
            continue
        eye = Eye(
            azimuth_deg=float(np.degrees(np.arctan2(out[0], out[2]))),
            elevation_deg=elevation,
            distance_m=float(rng.uniform(0.4, 2.0)),
        )
        setup = Setup(Shape(kind), lamp, eye)
        pose = pose_of(setup)
        if all(pose.peak(load_sample(n), SAMPLES[n].sigma_n_deg) is not None for n in NAMES):
            return setup


def hold_in(renderer, papers, count, seed):
    """The c and c_max of the four pictures, and clipped pixels, in random poses; see the test."""
    rng = np.random.default_rng(seed)
    for k in range(count):
        setup = mirrored_setup(SHAPES[k % len(SHAPES)], rng)
        scene = Scene(papers[0].material, setup)
        factor = factor_in_view(renderer, papers, scene, SIZE)
        frames = [
            renderer.render(
                dataclasses.replace(scene, material=s.material), s.look, SIZE, factor=factor
            )
            for s in papers
        ]
        yield setup, factor, frames


def check_poses(renderer, papers, count, seed):
    scaled = 0
    for setup, factor, frames in hold_in(renderer, papers, count, seed):
        pose = pose_of(setup)
        shown = [
            frame.c * pose.peak(s.material, s.look.sigma_n_deg)
            for frame, s in zip(frames, papers, strict=True)
        ]
        assert np.all(np.diff(shown) < 0.0), setup  # cast > art > matte > uncoated, as the meter
        assert [frame.clip_count for frame in frames] == [0, 0, 0, 0]
        ratios = [frame.c / frames[0].c for frame in frames]
        wanted = [s.look.c / papers[0].look.c for s in papers]
        np.testing.assert_allclose(ratios, wanted, rtol=1e-6)
        scaled += factor < 1.0
    assert scaled > count // 4  # the factor was needed


class TestInEveryView:
    def test_order_ratio_and_no_clipping(self, renderer, papers):
        check_poses(renderer, papers, 16, seed=1)

    @pytest.mark.slow
    def test_order_ratio_and_no_clipping_in_200_poses(self, renderer, papers):
        check_poses(renderer, papers, 200, seed=2)

    def test_shares_of_c_max_do_not_hold_the_ratio(self):
        """The control: what pictures had before, each c a share of its own picture's c_max."""
        ratios = []
        for lamp in (50.0, 140.0):
            pose = pose_of(Setup(lamp=Lamp(azimuth_deg=lamp)))
            cast, uncoated = (
                SAMPLES[name].c_fraction * pose.extremes(load_sample(name)).smallest_ratio
                for name in ("cast-coated", "uncoated")
            )
            ratios.append(uncoated / cast)
        assert ratios[0] > 3.0 * ratios[1]

    @pytest.mark.parametrize("number", range(8))
    def test_gloss_rises_with_the_reading_of_a_hypothetical_sample(self, reference, number):
        """The Gloss panel's slider: 5 to 95 units, the width of the lobe changes; any pose."""
        lamps = (20.0, 50.0, 110.0, 140.0)
        if number < len(lamps):
            setup = Setup(lamp=Lamp(azimuth_deg=lamps[number]))
        else:
            setup = mirrored_setup(SHAPES[number % len(SHAPES)], np.random.default_rng(number))
        pose = pose_of(setup)
        matte = load_sample("matte-coated")
        most = pose.extremes(reference.sample.material).smallest_ratio
        shown = []
        for reading in np.linspace(5.0, 95.0, 25):
            material = hypothetical(matte, 75.0, float(reading))
            c = matched_point(reference, material, 0.0).c
            limit = pose.extremes(material).smallest_ratio
            factor = min(1.0, limit / c, most / reference.c)
            shown.append(factor * c * pose.peak(material))
        assert np.all(np.diff(shown) > 0.0)

    def test_at_c_max_of_each_it_does_not_rise(self):
        """The control: c = c_max shows about as much of any lobe."""
        pose, matte = pose_of(Setup()), load_sample("matte-coated")
        shown = []
        for reading in (10.0, 40.0, 90.0):
            material = hypothetical(matte, 75.0, reading)
            shown.append(pose.extremes(material).smallest_ratio * pose.peak(material))
        assert np.ptp(shown) < 0.1 * shown[0]


class TestCurve:
    def test_spans_the_papers_range_and_the_asked_for_grain(self, reference):
        found = match_curve(reference, published("uncoated"), grain_deg=1.1, compare_setting=True)
        sigmas = [p.sigma_n_deg for p in found.curve]
        assert set(sigmas) == {*SIGMAS_N_DEG, 1.1}
        assert sigmas == sorted(sigmas)
        assert found.proposed.sigma_n_deg == 1.1
        assert found.own_setting.sigma_n_deg == 2.0

    def test_one_pose_has_no_spread(self, reference):
        here = Reference.of(reference.sample, setup=Setup(lamp=Lamp(azimuth_deg=80.0)))
        point = matched_point(here, load_sample("matte-coated"), 2.0)
        mean = matched_point(reference, load_sample("matte-coated"), 2.0)
        assert point.spread == 1.0
        assert mean.low < point.c < mean.high

    def test_a_pose_without_a_highlight_is_left_out(self, reference):
        flat = Setup(Shape("plane"), Lamp(azimuth_deg=50.0))
        with pytest.raises(InputError, match="shows no gloss in this view"):
            Reference.of(reference.sample, setup=flat)

    def test_no_highlight_has_no_setting(self, reference):
        flat = dataclasses.replace(paper("cast"), specular=())
        sample = SampleLook("flat", flat, Look())
        found = match_curve(reference, sample, grain_deg=0.0, compare_setting=False)
        assert found.proposed is None
        assert found.own_setting is None
        assert matched(reference, flat, 0.0).test_c == reference.c
        with pytest.raises(InputError, match="no specular lobe"):
            Reference.of(sample)

    def test_a_share_is_of_c_max_at_the_papers_geometry(self):
        matte = load_sample("matte-coated")
        share = absolute_c(Look().at(Setting(0.0, 0.5)), matte)
        assert share == pytest.approx(0.5 * full_c(matte))
        assert absolute_c(Look(c=0.3), matte) == 0.3


class TestCheckedOnPictures:
    def test_measures_disagree_where_they_are_known_to(self, renderer, papers):
        """The 99th percentile and coverage break the order that highlight and sharpness keep."""
        readings = {s.label: gloss_of(s.material) for s in papers}
        checked = check_pose(renderer, papers, readings, Setup())
        assert set(checked.orders) == set(TIES)
        verdicts = {name: order.verdict for name, order in checked.orders.items()}
        assert verdicts["highlight"] == verdicts["peak_contrast"] == "kept"
        assert verdicts["sharpness"] == "kept"  # matte's grain of 2 degrees is no sharpness
        assert verdicts["contrast_gloss"] == verdicts["coverage"] == "broken"
        assert checked.refused == ()

    def test_a_sample_without_a_highlight_is_refused_and_not_ranked(self, renderer, papers):
        readings = {s.label: gloss_of(s.material) for s in papers}
        setup = Setup(Shape("plane"), Lamp(azimuth_deg=50.0), Eye(azimuth_deg=-30.0))
        checked = check_pose(renderer, papers, readings, setup)
        assert "cast-coated" in checked.refused
        assert "cast-coated" not in checked.values["highlight"]


def test_crossings_between_neighbours():
    def curve(*cs):
        return [CurvePoint(0.5 * k, c) for k, c in enumerate(cs)]

    assert _crossings(curve(0.1, 0.2, 0.4), 0.3) == [pytest.approx(0.75)]
    assert _crossings(curve(0.1, None, 0.4), 0.3) == []
    assert _crossings(curve(0.1, 0.3, 0.1), 0.2) == [pytest.approx(0.25), pytest.approx(0.75)]


def test_plot_and_numbers(reference, tmp_path):
    flat = SampleLook("flat", dataclasses.replace(paper("cast"), specular=()), Look())
    found = [
        match_curve(reference, published("art-coated"), grain_deg=0.0, compare_setting=True),
        match_curve(reference, flat, grain_deg=0.0, compare_setting=False),
    ]
    json.dumps(as_numbers(reference, found), allow_nan=False)
    write_match_plot(reference, found, tmp_path / "a.png")
    with Image.open(tmp_path / "a.png") as picture:
        assert min(picture.size) > 600
        assert len(picture.convert("RGB").getcolors(1 << 24)) > 50
