"""The curve of settings: what it proposes is drawn, and measured on the picture that is shown."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest
from materials import paper
from PIL import Image

from relgloss_view.base.errors import InputError
from relgloss_view.gloss.match import (
    SIGMAS_N_DEG,
    Criterion,
    CurvePoint,
    DisplayedGloss,
    _crossings,
    as_numbers,
    match,
    reference_of,
)
from relgloss_view.gloss.match_plot import write_match_plot
from relgloss_view.gloss.samples import SampleLook, computed_gloss
from relgloss_view.gloss.shown import measure
from relgloss_view.operators.split import Split
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye

SIZE = (128, 128)
BY_METER = Criterion("gloss-75", "peak-contrast")


def paper_look(name):
    return SampleLook(name, load_sample(name), Look().at(SAMPLES[name]))


@pytest.fixture
def reference(renderer):
    first = paper_look("cast-coated")
    return reference_of(renderer, first, Scene(first.material), SIZE, BY_METER)


def matched(renderer, reference, sample, grain_deg=0.0, compare_setting=True):
    return match(
        renderer, reference, sample, Scene(sample.material), SIZE,
        grain_deg=grain_deg, compare_setting=compare_setting,
    )  # fmt: skip


class TestCurve:
    @pytest.mark.parametrize(("name", "sigma"), [("art-coated", 0.0), ("matte-coated", 2.0)])
    def test_proposal_shows_the_ratio(self, renderer, reference, name, sigma):
        found = matched(renderer, reference, paper_look(name), grain_deg=sigma)
        at = found.proposed
        assert at.sigma_n_deg == sigma

        def peak(sample, look):
            frame = renderer.render(Scene(sample.material), look, SIZE)
            return measure(frame, Split().draw(frame)).peak_contrast

        def above_body(sample, sigma_n_deg, c):
            with_highlight = peak(sample, Look(sigma_n_deg=sigma_n_deg, c=c))
            return with_highlight - peak(sample, Look(sigma_n_deg=sigma_n_deg, c=0.0))

        mine = above_body(found.sample, at.sigma_n_deg, at.c)
        theirs = above_body(reference.sample, 0.0, reference.c)
        real = [
            computed_gloss(sample.material)["gloss-75"]
            for sample in (found.sample, reference.sample)
        ]
        assert mine / theirs == pytest.approx(real[0] / real[1], rel=0.01)

    def test_reference_matches_itself_at_its_own_setting(self, renderer, reference):
        found = matched(renderer, reference, reference.sample)
        assert found.curve[0].c_fraction == pytest.approx(1.0, abs=1e-3)
        assert found.own_setting.c_distance == pytest.approx(0.0, abs=1e-3)

    def test_spans_the_papers_range_and_the_asked_for_grain(self, renderer, reference):
        found = matched(renderer, reference, paper_look("uncoated"), grain_deg=1.1)
        sigmas = [p.sigma_n_deg for p in found.curve]
        assert set(sigmas) == {*SIGMAS_N_DEG, 1.1}
        assert sigmas == sorted(sigmas)
        assert found.proposed.sigma_n_deg == 1.1
        assert found.own_setting.sigma_n_deg == 2.0

    def test_what_no_setting_shows(self, renderer, reference):
        # Contrast gloss c of materials hardly tells the papers apart: uncoated would have to show
        # more than the display can.
        scene = Scene(reference.sample.material)
        by_contrast = dataclasses.replace(BY_METER, gloss="contrast-gloss")
        first = reference_of(renderer, reference.sample, scene, SIZE, by_contrast)
        found = matched(renderer, first, paper_look("uncoated"))
        assert found.proposed is None
        assert all(p.c is None and 0.0 < p.most < found.wanted for p in found.curve)
        assert found.own_setting.c_distance is None

    def test_no_highlight_has_no_setting(self, renderer, reference):
        flat = dataclasses.replace(paper("cast"), specular=())
        found = matched(
            renderer, reference, SampleLook("flat", flat, Look()), compare_setting=False
        )
        assert found.proposed is None
        assert found.own_setting is None
        with pytest.raises(InputError, match="shows no gloss"):
            reference_of(renderer, found.sample, Scene(flat), SIZE, BY_METER)

    def test_published_settings_of_the_papers(self, renderer, reference):
        """Where the paper's observers lie: near the curve in c, with their grain undetermined."""
        size = (256, 256)
        scene = Scene(reference.sample.material)
        first = reference_of(renderer, reference.sample, scene, size, BY_METER)
        distance = {}
        for name in ("art-coated", "matte-coated", "uncoated"):
            sample = paper_look(name)
            found = match(
                renderer, first, sample, scene, size,
                grain_deg=sample.look.sigma_n_deg, compare_setting=True,
            )  # fmt: skip
            distance[name] = found.own_setting.fraction_distance
        assert distance["art-coated"] == pytest.approx(0.15, abs=0.03)
        assert abs(distance["matte-coated"]) < 0.03
        assert abs(distance["uncoated"]) < 0.05


class TestDisplayedGloss:
    @pytest.mark.parametrize("by", ["peak-contrast", "contrast-gloss"])
    def test_is_zero_without_highlight_and_grows(self, renderer, by):
        sample = paper_look("matte-coated")
        frame = renderer.render(Scene(sample.material), Look(sigma_n_deg=1.0), SIZE)
        gloss = DisplayedGloss(frame, by)
        values = [gloss(c) for c in np.linspace(0.0, frame.c_max, 9)]
        assert values[0] == 0.0
        assert np.all(np.diff(values) > 0.0)

    def test_nothing_seen(self, renderer):
        scene = Scene(paper("cast"), eye=Eye(shift_right=10.0))
        with pytest.raises(InputError, match="too little of the object is seen"):
            DisplayedGloss(renderer.render(scene, Look(), (32, 32)), "peak-contrast")


def test_crossings_between_neighbours():
    def curve(*cs):
        return [CurvePoint(0.5 * k, c, 1.0, 9.0) for k, c in enumerate(cs)]

    assert _crossings(curve(0.1, 0.2, 0.4), 0.3) == [pytest.approx(0.75)]
    assert _crossings(curve(0.1, None, 0.4), 0.3) == []
    assert _crossings(curve(0.1, 0.3, 0.1), 0.2) == [pytest.approx(0.25), pytest.approx(0.75)]


def test_plot_and_numbers(renderer, reference, tmp_path):
    flat = SampleLook("flat", dataclasses.replace(paper("cast"), specular=()), Look())
    found = [
        matched(renderer, reference, paper_look("art-coated")),
        matched(renderer, reference, flat, compare_setting=False),
    ]
    json.dumps(as_numbers(reference, found), allow_nan=False)
    write_match_plot(reference, found, tmp_path / "a.png")
    with Image.open(tmp_path / "a.png") as picture:
        assert min(picture.size) > 600
        assert len(picture.convert("RGB").getcolors(1 << 24)) > 50
