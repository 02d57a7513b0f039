"""The common factor of a pair's c: no picture clips, the ratio stays, a moving hand sees calm."""

from __future__ import annotations

import numpy as np
import pytest
from materials import paper

from relgloss_view.picture.pair import RESERVE, SLACK, common_factor, held_factor, ratio_words
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Lamp

SIZE = (96, 96)
AT_THE_SIDE = Lamp(azimuth_deg=120.0)  #: where c_max is half of that at 50 degrees


def test_the_factor_brings_the_tightest_picture_to_its_c_max():
    assert common_factor([(0.4, 0.2), (0.3, 0.1), (5.0, None)]) == pytest.approx(1 / 3)
    assert common_factor([(0.1, 0.2)]) == 1.0
    assert common_factor([]) == 1.0


def test_a_picture_at_the_factor_does_not_clip_and_without_it_does(renderer):
    scene, look = Scene(paper("matte"), lamp=AT_THE_SIDE), Look(c=1.2)
    plain = renderer.render(scene, look, SIZE)
    assert plain.clip_count > 0  # the control
    factor = common_factor([(plain.c, plain.c_max)])
    frame = renderer.render(scene, look, SIZE, factor=factor)
    assert frame.clip_count == 0
    assert frame.c == pytest.approx(plain.c_max, rel=1e-12)
    assert frame.look is look
    assert not [text for text in frame.warnings if "clipped" in text]


def test_the_factor_draws_what_the_scaled_c_draws(renderer):
    scene = Scene(paper("matte"), lamp=AT_THE_SIDE)
    scaled = renderer.render(scene, Look(sigma_n_deg=1.0, c=0.4), SIZE, factor=0.5).display
    np.testing.assert_array_equal(
        scaled, renderer.render(scene, Look(sigma_n_deg=1.0, c=0.2), SIZE).display
    )


def test_the_float64_reference_takes_the_factor_too(renderer):
    from relgloss_view.picture.reference import ReferenceRenderer

    scene, look = Scene(paper("matte")), Look(c=0.4)
    truth = ReferenceRenderer().render(scene, look, (48, 48), factor=0.5)
    assert truth.c == 0.2
    drawn = renderer.render(scene, look, (48, 48), factor=0.5)
    assert np.max(np.abs(truth.display.astype(int) - drawn.display.astype(int))) <= 1


def test_only_another_factor_draws_pass_2_again(renderer):
    scene, look = Scene(paper("matte")), Look(c=0.3)
    renderer.render(scene, look, SIZE)
    before = dict(renderer.draws)
    renderer.render(scene, look, SIZE, factor=0.7)
    drawn = {name for name, count in renderer.draws.items() if count > before[name]}
    assert drawn == {"tone"}


def test_a_share_of_c_max_is_not_scaled(renderer):
    """A share never clips, and it is no setting of a pair."""
    frame = renderer.render(Scene(paper("matte")), Look(c_fraction=0.5), SIZE, factor=0.3)
    assert frame.c == pytest.approx(0.5 * frame.c_max)


def test_a_moving_hand_changes_the_factor_seldom_and_never_clips():
    rng = np.random.default_rng(5)
    needed = np.clip(0.6 + 0.3 * np.sin(np.linspace(0, 6, 400)) + rng.normal(0, 0.01, 400), 0, 1)
    present, changes = 1.0, 0
    for want in needed:
        factor = held_factor(want, present)
        assert factor <= want + 1e-15 or factor == want
        assert factor >= want / SLACK / RESERVE
        changes += factor != present
        present = factor
    assert changes < 40  # without holding, every step would change it
    assert held_factor(1.0, 1.0) == 1.0


def test_words_appear_only_where_r_changes():
    assert ratio_words(1.0) == ""
    assert "1.8 times" in ratio_words(1 / 1.8)
    assert "1.04 times" in ratio_words(1 / 1.04)
