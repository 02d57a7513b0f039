"""The window's pair: what keeps its ratio, what a chosen sample gets, and what never changes c."""

from __future__ import annotations

import dataclasses

import pytest
from materials import paper

from relgloss_view.gloss.match import Reference, full_c, matched
from relgloss_view.material.files import save_material
from relgloss_view.pack.shape import ANALYTIC as SHAPES
from relgloss_view.picture.scene.look import viewed_look
from relgloss_view.picture.scene.sample import SAMPLES, Sample
from relgloss_view.viewer.drawing.arrangement import arranged
from relgloss_view.viewer.drawing.pair_renderer import PairRenderer
from relgloss_view.viewer.state.matching import (
    as_displayed,
    new_match,
    pinned,
    rematched,
    share_of_match,
    swapped,
    taken_as_match,
    with_sample,
    with_setting,
    with_share,
    with_sigma_n,
)
from relgloss_view.viewer.state.state import SIDES, State
from relgloss_view.viewer.state.state_file import load_state, save_state

PANE = (420, 220)


def ratio(state):
    return state.test.look.c / state.reference.look.c


@pytest.fixture
def state():
    return State.initial()


class TestChosen:
    def test_the_first_pair_is_matched(self, state):
        expected = matched(Reference.default(), state.test.sample.material, 2.0)
        assert state.match == expected
        assert (state.reference.look.c, state.test.look.c) == (
            expected.reference_c,
            expected.test_c,
        )
        assert share_of_match(state, "test") == pytest.approx(1.0)
        assert share_of_match(state, "reference") == 1.0

    def test_cast_coated_as_the_test_looks_as_the_reference(self, state):
        chosen = with_sample(state, "test", Sample.built_in("cast-coated"))
        assert chosen.test.look == chosen.reference.look

    @pytest.mark.parametrize("name", SAMPLES)
    def test_a_built_in_paper_has_its_own_grain_and_the_matched_c(self, state, name):
        chosen = with_sample(state, "test", Sample.built_in(name))
        sigma = SAMPLES[name].sigma_n_deg
        assert chosen.test.look.sigma_n_deg == sigma
        match = matched(Reference.default(), chosen.test.sample.material, sigma)
        assert chosen.test.look.c == pytest.approx(match.test_c)

    def test_a_file_is_smooth_and_matched(self, state, tmp_path):
        save_material(paper("matte"), tmp_path / "mine.json")
        chosen = with_sample(state, "test", Sample.from_file(str(tmp_path / "mine.json")))
        assert chosen.test.look.sigma_n_deg == 0.0
        assert share_of_match(chosen, "test") == pytest.approx(1.0)
        assert chosen.reference == state.reference

    def test_a_slider_that_changes_the_sample_keeps_the_share(self, state):
        half = with_share(state, "test", 0.5)
        chosen = with_sample(half, "test", Sample.built_in("art-coated"), keep=True)
        assert share_of_match(chosen, "test") == pytest.approx(0.5)
        assert chosen.test.look.sigma_n_deg == state.test.look.sigma_n_deg

    def test_another_reference_is_at_its_own_full_c(self, state):
        chosen = with_sample(state, "reference", Sample.built_in("art-coated"))
        assert chosen.reference.look.c == full_c(chosen.reference.sample.material)
        assert share_of_match(chosen, "test") == pytest.approx(1.0)

    def test_a_reference_without_gloss_leaves_no_match(self, state):
        flat = dataclasses.replace(paper("cast"), specular=())
        chosen = with_sample(state, "reference", Sample(flat))
        assert chosen.match is None
        assert share_of_match(chosen, "test") is None
        assert with_share(chosen, "test", 0.5) == chosen


class TestSliders:
    def test_the_test_picture_alone(self, state):
        half = with_share(state, "test", 0.5)
        assert half.test.look.c == pytest.approx(0.5 * state.test.look.c)
        assert half.reference == state.reference

    def test_the_reference_takes_the_test_picture_along(self, state):
        dimmer = with_share(with_share(state, "test", 0.5), "reference", 0.25)
        assert dimmer.reference.look.c == pytest.approx(0.25 * state.reference.look.c)
        assert ratio(dimmer) == pytest.approx(0.5 * ratio(state))
        assert share_of_match(dimmer, "test") == pytest.approx(0.5)

    def test_graininess_keeps_the_share(self, state):
        rough = with_sigma_n(with_share(state, "test", 0.5), "test", 0.5)
        assert rough.test.look.sigma_n_deg == 0.5
        assert share_of_match(rough, "test") == pytest.approx(0.5)

    def test_a_published_setting_is_a_share_at_the_papers_geometry(self, state):
        setting = SAMPLES["matte-coated"]
        chosen = with_setting(state, "test", setting)
        assert chosen.test.look.c == pytest.approx(full_c(state.test.sample.material) * 2 / 6)
        assert chosen.match.made_by == "paper"
        assert share_of_match(chosen, "test") == 1.0

    def test_what_the_eye_found_becomes_the_match(self, state):
        found = taken_as_match(with_share(state, "test", 0.7))
        assert found.match.made_by == "hand"
        assert share_of_match(found, "test") == pytest.approx(1.0)
        assert rematched(found).test.look.c == pytest.approx(state.test.look.c)

    def test_swapping_twice_changes_nothing(self, state):
        once = swapped(state)
        assert (once.reference, once.test) == (state.test, state.reference)
        assert share_of_match(once, "test") == pytest.approx(1.0)
        assert swapped(once) == state


@pytest.fixture
def pair(renderer):
    drawn = PairRenderer(renderer.ctx)
    yield lambda state, **how: drawn.draw(
        state, arranged(PANE, state.presentation, largest=drawn.largest), 1.0, None, **how
    )
    drawn.release()


def numbers(drawn):
    return {
        side: (p.frame.c, p.frame.c_max, p.frame.scaling.factor, p.frame.display.tobytes())
        for side, p in drawn.pictures.items()
    }


class TestHeld:
    @pytest.mark.parametrize(("part", "start", "step"), [("lamp", 50.0, 0.9), ("eye", 0.0, -0.9)])
    def test_there_and_back_every_number_is_as_before(self, state, pair, part, start, step):
        """100 steps of a lamp or an orbit to where highlights need to be scaled, and home again."""
        before = numbers(pair(state))
        turns = [state.with_part(part, azimuth_deg=start + step * k) for k in range(101)]
        factors = []
        for turned in [*turns, *turns[::-1]]:
            drawn = pair(turned, moving=True)
            frames = {side: p.frame for side, p in drawn.pictures.items()}
            assert frames["test"].c / frames["reference"].c == pytest.approx(ratio(state), rel=1e-6)
            assert [frames[side].clip_count for side in SIDES] == [0, 0]
            factors.append(drawn.factor)
        assert min(factors) < 0.5 < max(factors)
        assert numbers(pair(state)) == before

    @pytest.mark.parametrize("kind", SHAPES)
    def test_form_zoom_and_size_leave_c_alone(self, state, pair, kind):
        other = state.with_part("shape", kind=kind).with_part("eye", field_of_view_deg=30.0)
        drawn = pair(other)
        shown = {side: drawn.pictures[side].frame for side in SIDES}
        assert shown["test"].c / shown["reference"].c == pytest.approx(ratio(state), rel=1e-6)
        assert other.test.look.c == state.test.look.c

    def test_at_rest_the_factor_is_exact(self, state, pair):
        side = state.with_part("lamp", azimuth_deg=125.0)
        drawn = pair(side)
        limits = [drawn.pictures[s].frame.c_max / side.side(s).look.c for s in SIDES]
        assert drawn.factor == min(limits)
        assert drawn.factor < 0.6

    def test_if_asked_highlights_clip_and_are_counted(self, state, pair):
        side = state.with_part("lamp", azimuth_deg=125.0)
        drawn = pair(side.with_part("presentation", clip_highlights=True))
        assert drawn.factor == 1.0
        assert drawn.pictures["reference"].frame.clip_count > 0

    def test_a_lone_picture_is_drawn_with_the_scaled_c(self, state, pair, renderer):
        side = state.with_part("lamp", azimuth_deg=125.0)
        drawn = pair(side)
        frame = drawn.pictures["test"].frame
        look = as_displayed(side, drawn.factor).test.look
        alone = renderer.render(frame.scene, look, frame.size, frame.method)
        assert alone.display.tobytes() == frame.display.tobytes()


class TestOldFiles:
    def test_a_share_draws_the_same_pixels_and_is_kept_as_a_number(self, state, pair):
        old = dataclasses.replace(
            state.with_look("test", c=None, c_fraction=2 / 6, quality="exact").with_look(
                "reference", c=None, c_fraction=None, quality="exact"
            ),
            match=None,
        )
        drawn = pair(old)
        kept = pinned(old, {side: p.frame for side, p in drawn.pictures.items()})
        assert kept.test.look.c == drawn.pictures["test"].frame.c
        assert kept.match == new_match(kept)
        again = pair(kept)
        for side in SIDES:
            assert again.pictures[side].frame.display.tobytes() == (
                drawn.pictures[side].frame.display.tobytes()
            )
        turned = pair(kept.with_part("lamp", azimuth_deg=80.0))
        assert turned.pictures["test"].frame.look.c == kept.test.look.c

    def test_what_observers_found_stays_their_match(self, state, pair):
        """A report's scene holds shares of c_max, and the match that they are."""
        judged = dataclasses.replace(
            state.with_look("test", c=None, c_fraction=0.5).with_look(
                "reference", c=None, c_fraction=1.0
            ),
            match=dataclasses.replace(state.match, made_by="experiment"),
        )
        drawn = pair(judged)
        frames = {side: p.frame for side, p in drawn.pictures.items()}
        kept = pinned(judged, frames)
        assert kept.match.made_by == "experiment"
        assert kept.match.test_c == frames["test"].c
        assert share_of_match(kept, "test") == pytest.approx(1.0)

    def test_files_keep_the_match(self, state, tmp_path):
        found = taken_as_match(with_share(state, "test", 0.7))
        save_state(tmp_path / "pair.toml", found)
        assert load_state(tmp_path / "pair.toml") == found

    def test_a_file_without_a_match_is_read(self, state, tmp_path):
        save_state(tmp_path / "pair.toml", dataclasses.replace(state, match=None))
        assert load_state(tmp_path / "pair.toml").match is None


def test_looks_of_an_old_file_have_no_share_of_a_match(state):
    old = state.with_look("test", c=None, c_fraction=0.5)
    assert share_of_match(old, "test") is None
    assert old.test.look == viewed_look(
        sigma_n_deg=state.test.look.sigma_n_deg, c_fraction=0.5, quality="auto"
    )
