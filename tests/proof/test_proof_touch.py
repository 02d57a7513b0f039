"""Fingers, screens of other densities, zoom and windows that change, in Chromium."""

from __future__ import annotations

import time

import numpy as np
import pytest
from browsers import call, call_array, console, emulate, open_page, requests
from page_samples import SECOND, sample_page

from relgloss_view.viewer.drawing import camera

PHONE = (390, 844)
BOX = """() => {
  const {left, top, width, height} = document.getElementById("canvas").getBoundingClientRect();
  return [left, top, width, height];
}"""
READOUT = "() => document.getElementById('readout').textContent"
#: What is read when the next finger has come down, and after the page's own 0.5 s: in the page's
#: time, as a busy machine hands over a touch, or this program's question, late.
DOWN = """() => { window.rested = new Promise((done) => addEventListener("pointerdown", () => {
  const read = () => document.getElementById("readout").textContent, atOnce = read();
  setTimeout(() => done([atOnce, read()]), 700);
}, {once: true})); }"""
RESTED = "() => window.rested"
STATE = "() => document.getElementById('main').dataset.state"
#: Tangent of a CSS pixel of the first picture.
STEP = """async () => {
  await relgloss.idle();
  const {app} = relgloss;
  return app.report().reference.view.pixel_step * app.drawn.size[1] / app.paneAt().box[3];
}"""
SIZES = """async () => {
  await relgloss.idle();
  const {canvas, drawn} = relgloss.app;
  return [canvas.width, canvas.height, canvas.clientWidth, canvas.clientHeight, ...drawn.size];
}"""


@pytest.fixture(scope="module")
def page_file(tmp_path_factory):
    return sample_page(tmp_path_factory.mktemp("touch") / "proof.html")


@pytest.fixture
def phone(chromium_gl, page_file):
    """The page as it was opened, on a phone; it is opened once for all tests of this file."""
    emulate(chromium_gl, *PHONE, 2, touch=True)
    if chromium_gl.address != page_file.resolve().as_uri():
        open_page(chromium_gl, page_file)
    call(chromium_gl, "() => { scrollTo(0, 0); relgloss.app.lookAt(1); return relgloss.idle(); }")
    yield chromium_gl
    assert console(chromium_gl) == []
    assert requests(chromium_gl) == []


def settings(browser):
    return call(browser, "async () => { await relgloss.idle(); return relgloss.settings() }")


def touch(browser, kind, *points):
    places = [{"x": x, "y": y, "id": k} for k, (x, y) in enumerate(points)]
    browser.cdp("Input.dispatchTouchEvent", type=kind, touchPoints=places)


def drag(browser, *ways, steps=8):
    """Fingers that go from one place to another together; each way is (from, to)."""
    starts = [np.array(start, float) for start, _ in ways]
    moves = [np.array(end, float) - start for (_, end), start in zip(ways, starts, strict=True)]
    touch(browser, "touchStart", *starts)
    for k in range(1, steps + 1):
        here = [start + move * k / steps for start, move in zip(starts, moves, strict=True)]
        touch(browser, "touchMove", *here)
    touch(browser, "touchEnd")


def on_object(browser):
    """The middle of the first picture, in CSS pixels of the window."""
    left, top, _, _ = call(browser, BOX)
    x, y, width, height = call(browser, "() => relgloss.app.paneAt().box")
    return left + x + width / 2, top + y + height / 2


def test_one_finger_turns_and_does_not_scroll(phone):
    x, y = on_object(phone)
    width = call(phone, "() => relgloss.app.paneAt().box[2]")
    drag(phone, ((x, y), (x + 40, y - 120)))
    wanted = camera.orbited(SECOND.eye, (40, -120), (width, 1))
    eye = settings(phone)["eye"]
    assert eye["azimuth_deg"] == pytest.approx(wanted.azimuth_deg, abs=1e-9)
    assert eye["elevation_deg"] == pytest.approx(wanted.elevation_deg, abs=1e-9)
    assert call(phone, "() => scrollY") == 0


def test_beside_the_picture_a_finger_scrolls(phone):
    """The control: there the same drag scrolls the page and turns nothing."""
    before = settings(phone)
    drag(phone, ((200, 800), (200, 640)))
    deadline = time.monotonic() + 60
    while call(phone, "() => scrollY") < 50:
        assert time.monotonic() < deadline, "it does not scroll"
        time.sleep(0.02)
    assert settings(phone) == before


def test_two_fingers_zoom_and_move(phone):
    x, y = on_object(phone)
    framed = call(phone, STEP)
    drag(phone, ((x - 30, y), (x - 60, y)), ((x + 30, y), (x + 60, y)), steps=12)
    eye = settings(phone)["eye"]
    height = call(phone, "() => relgloss.app.paneAt().box[3]")
    step = np.tan(np.radians(eye["field_of_view_deg"]) / 2) / (0.5 * height)
    # Twice as far apart shows all twice as large; fingers move one after the other, so that what
    # is between them slides by half a step at most.
    assert step == pytest.approx(0.5 * framed, rel=1e-6)
    assert eye["shift_right"] == pytest.approx(0.0, abs=5 * framed)
    assert eye["azimuth_deg"] == SECOND.eye.azimuth_deg
    assert call(phone, "() => visualViewport.scale") == 1
    drag(phone, ((x - 30, y), (x - 30, y + 50)), ((x + 30, y), (x + 30, y + 50)))
    assert settings(phone)["eye"]["shift_up"] > eye["shift_up"] + 10 * step


def test_a_finger_that_rests_reads_a_colour(phone):
    before, idle = settings(phone), call(phone, READOUT)
    x, y = on_object(phone)
    call(phone, DOWN)
    touch(phone, "touchStart", (x, y))
    at_once, first = call(phone, RESTED)
    assert at_once == idle
    assert "L*" in first
    touch(phone, "touchMove", (x + 30, y))
    second = call(phone, READOUT)
    assert "L*" in second
    assert second != first
    touch(phone, "touchEnd")
    assert call(phone, READOUT) == second  # it stays when the finger no longer hides it
    assert settings(phone) == before
    drag(phone, ((x, y), (x + 40, y)))  # the control: one that does not rest turns
    assert call(phone, READOUT) == idle
    assert settings(phone)["eye"] != before["eye"]


@pytest.mark.slow
def test_a_finger_moves_sliders_and_wipe(phone):
    across, down = _centre(phone, "test-grain")
    phone.cdp("Input.synthesizeTapGesture", x=across, y=down)
    assert settings(phone)["test"]["sigma_n_deg"] == pytest.approx(1.5, abs=0.02)
    call(phone, "() => { scrollTo(0, 0); document.querySelector('[data-key=wipe]').click(); }")
    settings(phone)
    x, y = _centre(phone, "wipe")
    drag(phone, ((x, y), (x - 60, y)))
    width = call(phone, BOX)[2]
    assert call(phone, "() => relgloss.app.shown.share") == pytest.approx(
        0.5 - 60 / width, abs=0.02
    )


def _centre(browser, name):
    return call(
        browser,
        """(name) => {
          const element = document.getElementById(name);
          element.scrollIntoView({block: "center"});
          const box = element.getBoundingClientRect();
          return [box.left + box.width / 2, box.top + box.height / 2];
        }""",
        name,
    )


@pytest.mark.parametrize(
    "scale", [1.5, *(pytest.param(scale, marks=pytest.mark.slow) for scale in (1, 2, 3))]
)
def test_pixels_are_the_screens(chromium_gl, page_file, scale):
    """Of any density: the canvas has a pixel for each of the screen's."""
    emulate(chromium_gl, *PHONE, scale)
    open_page(chromium_gl, page_file)
    width, height, wide, high, columns, rows = call(chromium_gl, SIZES)
    assert (width, height) == (int(wide * scale + 0.5), int(high * scale + 0.5))
    pane = call(chromium_gl, "() => relgloss.app.panes[0].box")
    assert columns == min(1024, int(pane[2] * scale))
    assert rows == min(1024, int(pane[3] * scale))
    assert call(chromium_gl, STATE) == "ready"


@pytest.mark.slow
def test_a_screen_that_is_turned(phone):
    upright = call(phone, SIZES)
    emulate(phone, *PHONE[::-1], 2, touch=True)
    phone.cdp("Emulation.setDeviceMetricsOverride", width=844, height=390, deviceScaleFactor=2,
              mobile=True, screenOrientation={"type": "landscapePrimary", "angle": 90})  # fmt: skip
    call(phone, "() => new Promise(requestAnimationFrame)")
    lying = call(phone, SIZES)
    assert lying[2] > upright[2]
    assert lying[0] == 2 * lying[2]
    boxes = call(phone, "() => relgloss.app.panes.map(pane => pane.box[1])")
    assert boxes == [0, 0]  # side by side
    assert call(phone, "() => document.documentElement.scrollWidth <= innerWidth")


@pytest.mark.slow
def test_a_stage_without_a_size(chromium_gl, page_file):
    """Opened so, as in a window of 0 x 0, and later: nothing is drawn, and then all is there."""
    emulate(chromium_gl, 1000, 700)
    open_page(chromium_gl, page_file)
    data = "async () => { await relgloss.idle(); return relgloss.engine.pixels('test').data }"
    before = call_array(chromium_gl, data)
    call(chromium_gl, "() => { document.getElementById('stage').style.height = '0'; }")
    call(chromium_gl, "() => relgloss.idle()")
    call(chromium_gl, """() => {
      const now = relgloss.settings();
      relgloss.set({...now, eye: {...now.eye, azimuth_deg: 1}});
      relgloss.set(now);
    }""")  # fmt: skip
    call(chromium_gl, "() => relgloss.idle()")
    call(chromium_gl, "() => { document.getElementById('stage').style.height = ''; }")
    assert np.array_equal(call_array(chromium_gl, data), before)
    assert call(chromium_gl, STATE) == "ready"
    assert console(chromium_gl) == []


@pytest.mark.slow
def test_a_tab_that_is_hidden(chromium_gl, page_file):
    """Nothing is drawn behind another tab; in front, the newest settings show."""
    emulate(chromium_gl, 1000, 700)
    open_page(chromium_gl, page_file)
    first = chromium_gl.driver.current_window_handle
    call(chromium_gl, "() => relgloss.idle()")
    shown = "() => relgloss.app.drawn.settings.eye.azimuth_deg"
    before = call(chromium_gl, shown)
    chromium_gl.driver.switch_to.new_window("tab")
    second = chromium_gl.driver.current_window_handle
    chromium_gl.driver.switch_to.window(first)
    chromium_gl.cdp("Target.activateTarget", targetId=second)
    hidden = call(chromium_gl, "() => document.visibilityState")
    call(chromium_gl, """() => {
      const now = relgloss.settings();
      relgloss.set({...now, eye: {...now.eye, azimuth_deg: 1}});
    }""")  # fmt: skip
    time.sleep(0.2)
    chromium_gl.emulated = True
    assert hidden == "hidden"
    assert call(chromium_gl, shown) == before != 1
    chromium_gl.cdp("Page.bringToFront")
    assert settings(chromium_gl)["eye"]["azimuth_deg"] == 1
    assert call(chromium_gl, shown) == 1
