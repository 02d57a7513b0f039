"""What the check of the screen concludes, against published numbers, and the page's twin."""

from __future__ import annotations

import json
import re

import colour
import numpy as np
import pytest
from browsers import call
from screen_pages import open_screen

from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.material import cielab
from relgloss_view.proof import screen_words, screens
from relgloss_view.proof.page.build import FOLDER, words
from relgloss_view.proof.screens import Case, Highlight, Screen


class TestFormulas:
    def test_lightness_is_cie_l_star(self):
        light = np.concatenate([np.linspace(0.0, 0.02, 21), np.linspace(0.05, 1.0, 20)])
        expected = colour.lightness(100.0 * light, method="CIE 1976")
        drawn = [screens.lstar_of(y) for y in light]
        assert np.allclose(drawn, expected, atol=1e-9)
        assert np.allclose(drawn, cielab.lightness(light), atol=1e-12)
        back = [screens.light_of_lstar(lstar) for lstar in drawn]
        assert np.allclose(back, light, atol=1e-12)

    def test_signal_is_srgb(self):
        light = np.linspace(0.0, 1.0, 101)
        signals = [screens.signal_of(y) for y in light]
        # IEC 61966-2-1 rounds the joint of its two parts: both differ by 3e-8 around it.
        assert np.allclose(signals, colour.cctf_encoding(light, function="sRGB"), atol=1e-7)
        assert np.allclose([screens.pixel_light(s, 0.0) for s in signals], light, atol=1e-7)

    def test_shown_light_is_gain_offset_gamma_with_flare(self):
        """Berns 1996 as the display's own model has it: gain 1, offset 0, flare b / (1 - b)."""
        for gamma, black in ((1.8, 0.0), (2.2, 0.05), (2.6, 0.1)):
            own = Display(transfer="gain-offset-gamma", gamma=gamma, flare=black / (1.0 - black))
            digital = np.linspace(0.0, 1.0, 11)
            light = DisplayModel.of(own).light(np.repeat(digital[:, None], 3, axis=1))[:, 1]
            drawn = [screens.shown_light(d, Case(100.0, black, gamma, 1.0)) for d in digital]
            assert np.allclose(drawn, light, atol=1e-9)

    def test_pattern_finds_published_gammas(self):
        """ITU-R BT.1886 without black is a power of 2.4; 188 is sRGB's half (often published)."""
        signals = np.linspace(0.5, 0.95, 4501)
        light = colour.models.eotf_BT1886(signals, L_B=0.0, L_W=1.0)
        assert screens.pattern_gamma(float(np.interp(0.5, light, signals))) == pytest.approx(
            2.4, abs=1e-3
        )
        assert round(255 * screens.signal_of(0.5)) == 188
        assert round(255 * 0.5 ** (1.0 / 1.8)) == 174
        assert screens.pattern_gamma(174 / 255) == pytest.approx(1.8, abs=0.02)

    @pytest.mark.parametrize("black", [0.001, 0.01, 0.05, 0.2])
    @pytest.mark.parametrize("gamma", [0.0, 1.9, 2.4])
    def test_black_of_step_inverts_dark_step(self, black, gamma):
        for signal in (8 / 255, 27 / 255, 48 / 255):
            made = screens.dark_step(signal, black, gamma)
            assert screens.black_of_step(signal, made, gamma) == pytest.approx(black, rel=1e-6)
            steps = [screens.dark_step(signal, b, gamma) for b in np.linspace(0.0, 0.9, 50)]
            assert np.all(np.diff(steps) < 1e-12)  # the bisection's premise

    def test_black_bounds_hold_the_black_of_each_eye(self):
        for black in (0.0, 0.002, 0.01, 0.06, 0.3):
            for eye in (0.35, 0.7, 1.15):
                seen = [
                    k
                    for k, d in enumerate(screens.DARK_STEPS)
                    if screens.dark_step(d / 255, black, 0.0) >= eye
                ]
                least, most = screens.black_bounds(seen[0] if seen else 12, (0.0,))
                assert least <= black <= most, (black, eye)
        assert screens.black_bounds(12, (0.0,))[1] == screens.MOST_BLACK
        assert screens.black_bounds(0, (0.0,))[0] == 0.0
        # Negative control: an eye outside of the bounds gives another black.
        assert not screens.black_bounds(11, (0.0,))[0] <= 0.0

    def test_clipping_is_more_than_an_eye_misses(self):
        assert screens.clipped_from(0) == screens.clipped_from(2) == 1.0
        assert screens.clipped_from(8) == 240 / 255
        assert screens.clipped_from(12) == 207 / 255


class TestScreen:
    def test_json_and_back(self):
        screen = Screen(120.0, 0.01, 0.02, 2.2, (2.1, 2.2, 2.3), 0.98, "office")
        assert Screen.from_json(json.loads(json.dumps(screen.as_json()))) == screen
        assert Screen.from_json({}) == Screen()

    @pytest.mark.parametrize(
        "content",
        [
            None, [], "dark", {"white": 1}, {"white_cd_m2": "120"}, {"white_cd_m2": 0},
            {"white_cd_m2": True}, {"black_least": 0.5, "black_most": 0.1}, {"black_most": 2},
            {"gamma": 9}, {"gamma": float("nan")}, {"channels": [2, 2]}, {"channels": "222"},
            {"channels": [2, 2, "2"]}, {"surround": "<script>"}, {"surround": 3}, {"clipped": 0.1},
        ],
    )  # fmt: skip
    def test_what_no_page_wrote_is_refused(self, content):
        with pytest.raises(InputError, match="screen"):
            Screen.from_json(content)

    def test_designers_screen(self):
        display = {
            "luminance_cd_m2": 161.0,
            "luminance_known": True,
            "black_cd_m2": 1.61,
            "black_known": True,
        }
        screen = screens.designers_screen(display)
        assert screen.white_cd_m2 == 161.0
        assert screen.black_least == screen.black_most == pytest.approx(0.01)
        unknown = screens.designers_screen(
            {**display, "luminance_known": False, "black_known": False}
        )
        assert unknown == Screen()


MINE = [
    Screen(),
    Screen(80.0, 0.01, 0.03, 2.25, (2.2, 2.2, 2.3), 1.0, "bright"),
    Screen(300.0, 0.0, 0.002, 1.8, (1.8, 2.2, 2.1), 0.9, "dark"),
    Screen(160.0, 0.02, 0.09, 2.6, None, None, "office"),
    Screen(150.0, 0.009, 0.012),
]
THEIRS = [Screen(), Screen(160.0, 0.01, 0.01), Screen(None, 0.05, 0.05)]


def orders():
    kinds = [screens.Order(k) for k in (screens.KEPT, screens.ALIKE, screens.UNKNOWN)]
    for kind in (screens.HIDDEN, screens.REVERSED):
        for cause in ("black", "white", "gamma", "clipped"):
            kinds += [screens.Order(kind, side, cause, 0.08) for side in ("reference", "test")]
    return kinds


class TestWords:
    def test_half_as_bright_and_a_lighter_black(self):
        said = dict(screen_words.differences(MINE[1], Screen(160.0, 0.001, 0.001)))
        assert said["screen.white.dimmer"] == {"share": 50.0}
        assert said["screen.black.lighter"] == {"designer": 0.1}
        assert "screen.white.unknown" in dict(screen_words.differences(Screen(), Screen()))

    def test_every_sentence_is_there_and_filled(self):
        table = words()
        said = [
            w for mine in MINE for theirs in THEIRS for w in screen_words.differences(mine, theirs)
        ]
        said += [
            screen_words.order_words(o, who) for o in orders() for who in ("yours", "designer")
        ]
        for key, values in said:
            assert set(re.findall(r"\{(\w+)\}", table[key])) <= set(values), key
            for value in values.values():
                if isinstance(value, str):
                    assert value in table or f"screen.channel.{value}" in table
        assert len({key for key, _ in said}) > 25

    def test_keys_that_the_modules_name_are_there(self):
        table = words()
        for name in ("check.js", "screen.js", "screens.js"):
            text = (FOLDER / "js" / name).read_text(encoding="utf-8")
            for key in re.findall(r'"((?:check|screen)\.[a-z.-]+)"', text):
                assert key in table or key in ("screen.",), key
        own = [key for key in table if key.startswith(("check.place.", "screen.surround.choose"))]
        assert len(own) == 9 + 4

    def test_in_short(self):
        said = screen_words.screen_words(Screen(120.0, 0.01, 0.031, 2.2, None, None, "dark"))
        assert said == ("white 120 cd/m2", "black 1 to 3.1 % of white", "gamma 2.2", "dark room")
        assert screen_words.screen_words(Screen()) == ()


class TestTwins:
    """page/js/screens.js beside proof/screens.py, on the same numbers."""

    @pytest.fixture(autouse=True)
    def _page(self, chromium_gl):
        self.browser = chromium_gl
        if not call(chromium_gl, "() => typeof lstarOf === 'function'"):
            open_screen(chromium_gl, None)

    def both(self, name, function, rows):
        """The largest difference of two twins over rows of arguments."""
        drawn = call(self.browser, f"(rows) => rows.map((row) => {name}(...row))", rows)
        expected = [function(*row) for row in rows]
        return float(np.max(np.abs(np.array(drawn, float) - np.array(expected, float))))

    def test_functions_of_numbers(self):
        light = [[float(v)] for v in np.linspace(0.0, 1.0, 41) ** 2]
        lstar = [[float(v)] for v in np.linspace(0.0, 100.0, 41)]
        pairs = [[s, g] for (s,) in light for g in (0.0, 1.8, 2.4)]
        dark = [
            [d / 255, b, g]
            for d in screens.DARK_STEPS
            for b in (0.0, 0.01, 0.2)
            for g in (0.0, 2.2)
        ]
        for name, function, rows in (
            ("lstarOf", screens.lstar_of, light),
            ("lightOfLstar", screens.light_of_lstar, lstar),
            ("signalOf", screens.signal_of, light),
            ("pixelLight", screens.pixel_light, pairs),
            ("patternGamma", screens.pattern_gamma, [[d / 255] for d in range(96, 241)]),
            ("darkStep", screens.dark_step, dark),
            ("blackOfStep", screens.black_of_step, [[s, t, g] for s, t, g in dark if t > 0.0]),
            ("clippedFrom", screens.clipped_from, [[k] for k in range(13)]),
            ("blackBounds", screens.black_bounds, [[k, [0.0, 2.1, 2.3]] for k in range(13)]),
            (
                "significant",
                screen_words.significant,
                [[v] for v in (0.0, 0.0123, 5.55, 137.0, 99.6)],
            ),
        ):
            assert self.both(name, function, rows) <= 1e-9, name  # of values up to 100
        # Negative control: another curve is seen.
        assert self.both("pixelLight", lambda s, g: screens.pixel_light(s, g + 0.01), pairs) > 1e-4

    def test_highlights(self):
        rng = np.random.default_rng(3)
        for count in (0, 1, 250, 251, 5000):
            l_d, l_s = rng.uniform(0, 60, count), rng.integers(0, 90, count).astype(float)
            drawn = call(
                self.browser, "(d, s, c) => highlightsOf(d, s, c)", l_d.tolist(), l_s.tolist(), 0.7
            )
            expected = screens.highlights_of(l_d, l_s, 0.7)
            assert len(drawn) == len(expected)
            for one, other in zip(drawn, expected, strict=True):
                assert one["body"] == pytest.approx(other.body, abs=1e-9)
                assert one["peak"] == pytest.approx(other.peak, abs=1e-9)

    def test_verdicts(self):
        rng = np.random.default_rng(4)
        kinds = set()
        for _ in range(60):
            pairs = [
                [
                    Highlight(b, b + s)
                    for b, s in zip(rng.uniform(2, 60, 2), rng.uniform(0, 35, 2), strict=True)
                ]
                for _ in ("reference", "test")
            ]
            screen = MINE[int(rng.integers(len(MINE)))]
            order = screens.order_of_gloss(*pairs, screen)
            kinds.add(order.kind)
            drawn = call(
                self.browser,
                "(a, b, s) => orderOfGloss(a, b, s)",
                *([h._asdict() for h in side] for side in pairs),
                screen.as_json(),
            )
            assert drawn["kind"] == order.kind
            assert (drawn["side"], drawn["cause"]) == (order.side, order.cause)
            assert drawn["black"] == pytest.approx(order.black)
        assert kinds >= {screens.KEPT, screens.REVERSED, screens.HIDDEN, screens.UNKNOWN}

    def test_words(self):
        for mine in MINE:
            for theirs in THEIRS:
                drawn = call(
                    self.browser, "(a, b) => differences(a, b)", mine.as_json(), theirs.as_json()
                )
                expected = [list(w) for w in screen_words.differences(mine, theirs)]
                assert drawn == json.loads(json.dumps(expected))
        for order in orders():
            drawn = call(self.browser, "(o) => orderWords(o, 'yours')", order._asdict())
            assert drawn == json.loads(json.dumps(list(screen_words.order_words(order, "yours"))))
