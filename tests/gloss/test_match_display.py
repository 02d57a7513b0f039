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
from relgloss_view.gloss.shown import measure
from relgloss_view.operators.split import Split
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Setup

#: What the gamut's tolerance, 1e-4 of white, may cut of an L* above 40 (slope at most 90 a white).
CUT_LSTAR = 0.01


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


class TestPicturesOnDisplays:
    """What a display shows of the papers at the published settings, in the float64 reference."""

    def measured(self, reference, names=tuple(SAMPLES), **display):
        setup = Setup().with_entries("display", **display)
        measures = {}
        for name in names:
            look = Look().at(SAMPLES[name])
            frame = reference.render(Scene(load_sample(name), setup), look, (48, 48))
            measures[name] = measure(frame, Split().draw(frame)).highlight, frame.c_max
        return measures

    def test_luminance_and_gamut_change_neither_order_nor_what_is_added(self, reference):
        first = self.measured(reference)
        p3 = ((0.68, 0.32), (0.265, 0.69), (0.15, 0.06))
        other = self.measured(
            reference, primaries_xy=p3, luminance_cd_m2=80.0, black_cd_m2=1.6
        )  # L* 15 at black: no body beside a highlight is as dark
        for name in SAMPLES:
            assert other[name] == pytest.approx(first[name], abs=CUT_LSTAR)
        added = [added for added, _ in other.values()]
        assert added == sorted(added, reverse=True)  # SAMPLES are in the order of their gloss

    def test_black_is_no_highlight(self, reference):
        """The unlit side is seen as black: L* 43, where uncoated's highlight adds 6."""
        (dark, _), (lit, _) = (
            self.measured(reference, ("uncoated",), black_cd_m2=black, luminance_cd_m2=100.0)[
                "uncoated"
            ]
            for black in (0.0, 13.0)
        )
        assert lit == pytest.approx(dark, abs=CUT_LSTAR)
        assert lightness(0.13) > dark + 10.0
        (hidden, _) = self.measured(
            reference, ("uncoated",), black_cd_m2=60.0, luminance_cd_m2=100.0
        )["uncoated"]
        assert hidden < dark - 1.0  # L* 82 hides some of it
