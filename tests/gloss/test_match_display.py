"""The c that keeps a ratio of gloss on a display with black, against light that is shown there."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.commands.match_display import display_lines
from relgloss_view.display.display import Display
from relgloss_view.gloss.match import Reference, match_curve
from relgloss_view.gloss.match_display import (
    Screen,
    added_lstar,
    kept_c,
    on_screen,
    screen_numbers,
    screens_of,
)
from relgloss_view.gloss.samples import SampleLook
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, load_sample


def lightness(y: float) -> float:
    """CIE 15:2004, from its text."""
    return 116.0 * y ** (1 / 3) - 16.0 if y > 216 / 24389 else 24389 / 27 * y


def light(lstar: float) -> float:
    return ((lstar + 16.0) / 116.0) ** 3 if lstar > 8.0 else lstar * 27 / 24389


@pytest.fixture(scope="module")
def pair():
    """Cast-coated, and matte-coated at its published graininess."""
    look = Look().at(SAMPLES["matte-coated"])
    sample = SampleLook("matte-coated", load_sample("matte-coated"), look)
    reference = Reference.default()
    grain = look.sigma_n_deg
    return reference, match_curve(reference, sample, grain_deg=grain, compare_setting=False)


@pytest.mark.parametrize("black", [0.0, 0.004, 0.02, 0.2])
def test_what_a_highlight_adds_is_that_of_the_light(black):
    body, peak = light(40.0), light(40.0 + 0.3 * 120.0)
    lifted = lightness(black + (1 - black) * peak) - lightness(black + (1 - black) * body)
    assert added_lstar(40.0, 120.0, 0.3, black, opened=True) == pytest.approx(lifted)
    floored = 76.0 - max(40.0, lightness(black))
    assert added_lstar(40.0, 120.0, 0.3, black, opened=False) == pytest.approx(floored)


def test_kept_c_is_its_inverse_and_knows_its_end():
    for opened in (False, True):
        for l_d in (2.0, 30.0, 60.0):
            added = added_lstar(l_d, 90.0, 0.4, 0.03, opened=opened)
            assert kept_c(added, l_d, 90.0, 0.03, opened=opened) == pytest.approx(0.4)
        assert kept_c(60.0, 50.0, 90.0, 0.0, opened=opened) is None


def test_without_black_nothing_changes(pair):
    reference, m = pair
    none = on_screen(Screen("none", 100.0, 0.0, True), reference, m)
    assert none is not None
    assert (none.drawn_share, none.opened_share) == (pytest.approx(1.0), pytest.approx(1.0))
    assert (none.drawn_c, none.opened_c) == (
        pytest.approx(m.proposed.c),
        pytest.approx(m.proposed.c),
    )


def test_black_weakens_the_dull_sample_more_where_pictures_are_lifted(pair):
    reference, m = pair
    at_2, at_10 = (on_screen(Screen("", None, b, True), reference, m) for b in (0.02, 0.1))
    assert at_2 is not None
    assert at_10 is not None
    assert at_10.opened_share < at_2.opened_share < 1.0
    assert at_10.opened_c > at_2.opened_c > m.proposed.c
    assert at_10.drawn_share == pytest.approx(1.0)  # its body is brighter than the black
    high = on_screen(Screen("", None, 0.25, True), reference, m)  # L* 57, above some bodies
    assert high is not None
    assert abs(high.drawn_share - 1.0) > 0.02


def test_the_screens_of_a_display():
    assert screens_of(Display()) == ()
    lit = Display(luminance_cd_m2=160.0, reflected_cd_m2=40.0)
    (screen,) = screens_of(lit)
    assert screen.cd_m2 == pytest.approx(200.0)
    assert screen.black == pytest.approx(0.2)
    assert screen.black_lstar == pytest.approx(lightness(0.2))


def test_words_and_numbers(pair):
    reference, m = pair
    slight, strong = (Display(luminance_cd_m2=160.0, black_cd_m2=black) for black in (0.16, 32.0))
    text = "\n".join(display_lines(slight, reference, [m]))
    assert "black 0.10% of it" in text
    assert text.count("nothing has to change for matte-coated") == 2
    text = "\n".join(display_lines(strong, reference, [m]))
    assert "opened there: matte-coated would show 0." in text
    assert "keeps it" in text
    assert display_lines(Display(), reference, [m]) == []
    numbers = screen_numbers(screens_of(strong)[0], reference, [m])
    assert numbers["black"] == pytest.approx(0.2)
    assert np.isfinite(numbers["samples"][0]["opened_c"])
