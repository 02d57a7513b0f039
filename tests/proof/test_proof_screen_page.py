"""The check of the screen on the page: by keyboard, narrow, scaled, in forced colours."""

from __future__ import annotations

import numpy as np
import pytest
from browsers import as_before, call, console, emulate
from screen_pages import open_screen
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys
from test_proof_check_grid import proof_of

from relgloss_view.base.errors import InputError
from relgloss_view.proof import screens
from relgloss_view.proof.screens import Screen

MOUNT = """(display) => {
  const proof = structuredClone(data.proof);
  Object.assign(proof.content.display, display);
  window.app = { engine, proof, announce() {} };
  engine.draw(proof.messages[0].settings, proof.content.size_px);
  const element = document.getElementById("screen");
  element.replaceChildren();
  window.mounted = mountScreen(element, app);
  return [document.documentElement.scrollWidth, innerWidth];
}"""
BRIGHT_IS_SEEN = "() => document.querySelector('.patches[data-ground=bright]').checkVisibility()"
KNOWN = {
    "luminance_cd_m2": 160.0,
    "luminance_known": True,
    "black_cd_m2": 0.16,
    "black_known": True,
}


@pytest.fixture(scope="module")
def proof():
    return proof_of("uncoated", "cast-coated", 0.0, (0.15, 1.0))


@pytest.fixture
def page(chromium_gl, proof):
    open_screen(chromium_gl, proof)
    call(chromium_gl, MOUNT, KNOWN)
    return chromium_gl


def text(browser):
    return call(browser, "() => document.getElementById('screen').textContent")


def test_nothing_is_known_at_first(page):
    assert call(page, "() => app.screen") is None
    assert "Nothing is known of your screen yet" in text(page)
    assert "nobody knows whether it shows this order" in text(page)
    assert "The designer's screen shows this order" in text(page)
    console(page)


def test_by_keyboard(page):
    def press(*keys):
        ActionChains(page.driver).send_keys(*keys).perform()

    press(Keys.TAB, Keys.SPACE, *[Keys.ARROW_RIGHT] * 4)
    assert call(page, "() => document.activeElement.getAttribute('aria-label')") == "Patch 5 of 12"
    assert not call(page, BRIGHT_IS_SEEN)  # a bright field waits until it is asked for
    press(Keys.TAB, Keys.ENTER, Keys.TAB, Keys.SPACE, Keys.TAB)  # white, then the slider of grays
    assert call(page, BRIGHT_IS_SEEN)
    press(*[Keys.ARROW_LEFT] * 8, Keys.TAB, Keys.ENTER)
    press(Keys.TAB, Keys.TAB, "80", Keys.TAB, "D")
    found = Screen.from_json(call(page, "() => app.screen"))
    signal = (188 - 8) / 255
    assert found.gamma == pytest.approx(screens.pattern_gamma(signal))
    bounds = screens.black_bounds(4, screens.possible_gammas(found.gamma))
    assert (found.black_least, found.black_most) == pytest.approx(bounds)
    assert (found.white_cd_m2, found.clipped, found.surround) == (80.0, 1.0, "dark")
    said = text(page)
    assert "Your white has 50 % of the luminance of the designer's" in said
    assert "Your grays are too bright (gamma 2 in the place of 2.3)" in said
    press(Keys.TAB, Keys.ENTER)  # forget
    assert call(page, "() => app.screen") is None


def test_a_luminance_that_is_none_is_refused(page):
    typed = """(value) => {
      const field = document.querySelector("#screen input[type=number]");
      field.value = value;
      field.dispatchEvent(new Event("change"));
      return [app.screen?.white_cd_m2 ?? null, field.getAttribute("aria-invalid"),
        document.getElementById("screen-white-wrong").hidden];
    }"""
    assert call(page, typed, "0.2") == [None, "true", False]
    assert call(page, typed, "123.5") == [123.5, "false", True]
    assert call(page, typed, "") == [None, "false", True]


@pytest.mark.parametrize("forced", [False, True])
def test_narrow_and_forced_colours(chromium_gl, proof, forced):
    emulate(chromium_gl, 390, 844, 2, forced_colours=forced)
    open_screen(chromium_gl, proof)
    wide, inner = call(chromium_gl, MOUNT, KNOWN)
    assert wide <= inner
    call(chromium_gl, "() => { document.querySelector('#screen details').open = true; }")
    # Patches keep their light where the reader's colours replace the page's.
    assert call(
        chromium_gl,
        """() => [...document.querySelectorAll(".patches")].map(
          (p) => getComputedStyle(p).backgroundColor)""",
    ) == ["rgb(0, 0, 0)", "rgb(255, 255, 255)"]
    least = call(
        chromium_gl,
        """() => Math.min(...[...document.querySelectorAll(".patch, .choice, #screen button")]
          .map((e) => e.getBoundingClientRect().height))""",
    )
    assert least >= 36  # of a finger's target (WCAG 2.2, 2.5.8: 24)


@pytest.mark.parametrize("scale", [1, 1.25, 2])
def test_lines_are_pixels(chromium_gl, proof, scale):
    emulate(chromium_gl, 800, 900, scale)
    open_screen(chromium_gl, proof)
    call(chromium_gl, MOUNT, KNOWN)
    rows, place, warned = call(
        chromium_gl,
        """async () => {
          await new Promise((done) => setTimeout(done, 200));
          for (let k = 0; k < 3; k++) await new Promise((done) => requestAnimationFrame(done));
          const canvas = document.querySelector(".lines");
          const data = canvas.getContext("2d").getImageData(0, 0, 1, canvas.height).data;
          const box = canvas.getBoundingClientRect();
          return [[...data].filter((_, k) => k % 4 === 0),
            [box.width * devicePixelRatio - canvas.width,
              box.height * devicePixelRatio - canvas.height],
            !document.querySelector("#screen fieldset:nth-of-type(3) > .quiet").hidden];
        }""",
    )
    assert np.array_equal(rows, 255 * (np.arange(len(rows)) % 2))
    assert np.abs(place).max() < 0.05  # of a device pixel: layouts count in 64ths
    assert warned == (scale == 1.25)


def test_order_of_gloss_follows_the_screen(page):
    answer = """(dark) => {
      document.querySelectorAll("input[name=screen-dark]")[dark].click();
      return [...document.querySelectorAll("#screen [role=status] p")].map((p) => p.textContent);
    }"""
    assert any("Your screen shows this order" in line for line in call(page, answer, 1))
    bright = call(page, answer, 12)
    assert any(line.startswith("Your screen may") for line in bright)
    assert not any("Your screen shows this order" in line for line in bright)


def test_an_object_out_of_the_picture_has_no_order(page):
    lines = """() => {
      mounted.update();
      return [...document.querySelectorAll("#screen [role=status] p")].map((p) => p.textContent);
    }"""
    assert any("glossier" in line for line in call(page, lines))
    call(
        page,
        """() => {
          const own = app.engine.split.bind(app.engine);
          const off = app.engine.drawing.numbers.OFF_OBJECT;
          app.engine.split = (side) => (side === "test" ? own(side).fill(off) : own(side));
        }""",
    )
    assert not any("glossier" in line for line in call(page, lines))  # and it does not throw


def test_what_is_stored_is_refused_where_no_page_wrote_it(page):
    call(page, "() => document.querySelectorAll('input[name=screen-dark]')[3].click()")
    stored = call(page, "() => app.screen")
    assert Screen.from_json(stored).black_most > 0.0
    with pytest.raises(InputError, match="black_most"):
        Screen.from_json({**stored, "black_most": 7})


def test_sizes_are_undone(chromium_gl):
    as_before(chromium_gl)
    assert call(chromium_gl, "() => devicePixelRatio") == 1
