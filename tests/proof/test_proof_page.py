"""The page in a real browser: what hands, keys and buttons do to the pictures."""

from __future__ import annotations

import numpy as np
import pytest
from browsers import (
    before_pages,
    call,
    call_array,
    console,
    emulate,
    open_page,
    requests,
    until,
)
from page_samples import FIRST, SECOND, sample_page, sample_proof
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

from relgloss_view.picture.scene.setup import Eye, Lamp
from relgloss_view.proof.page.parts import Page
from relgloss_view.viewer.drawing import camera


@pytest.fixture(scope="session")
def page_file(tmp_path_factory):
    return sample_page(tmp_path_factory.mktemp("page") / "proof.html")


@pytest.fixture
def page(chromium_gl, page_file):
    emulate(chromium_gl, 640, 480)  # small, as every step draws
    open_page(chromium_gl, page_file)
    yield chromium_gl
    assert requests(chromium_gl) == []


def pixels(browser, side):
    return call_array(
        browser,
        "async (side) => { await relgloss.idle(); return relgloss.engine.pixels(side).data }",
        side,
    )


def settings(browser):
    return call(browser, "async () => { await relgloss.idle(); return relgloss.settings() }")


def press(browser, element, *keys):
    call(browser, "(id) => document.getElementById(id).focus()", element)
    ActionChains(browser.driver).send_keys(*keys).perform()


def state(browser):
    return call(browser, "() => document.getElementById('main').dataset.state")


def whose(browser):
    return call(browser, "() => document.getElementById('whose').textContent")


@pytest.mark.parametrize("what", ["grain", "contrast"])
def test_sliders_move_their_own_picture_and_as_sent_brings_it_back(page, what):
    before = {side: pixels(page, side) for side in ("reference", "test")}
    assert whose(page).startswith("As sent")
    press(page, f"test-{what}", Keys.ARROW_RIGHT * 8)
    after = {side: pixels(page, side) for side in before}
    assert not np.array_equal(after["test"], before["test"])
    assert np.array_equal(after["reference"], before["reference"])  # the negative control
    assert whose(page).startswith("Changed by you")
    press(page, "as-sent", Keys.ENTER)
    assert settings(page) == SECOND.as_json()
    assert whose(page).startswith("As sent")
    for side, sent in before.items():
        assert np.array_equal(pixels(page, side), sent), side
    assert console(page) == []


def test_backspace_and_a_double_click_bring_one_sent_value_back(page):
    press(page, "test-contrast", Keys.ARROW_LEFT * 9)
    press(page, "test-grain", Keys.ARROW_RIGHT * 9)
    changed = settings(page)["test"]
    assert changed["c"] < SECOND.test.c
    assert changed["sigma_n_deg"] > SECOND.test.sigma_n_deg
    press(page, "test-contrast", Keys.BACKSPACE)
    assert settings(page)["test"] == {"sigma_n_deg": changed["sigma_n_deg"], "c": SECOND.test.c}
    slider = page.driver.find_element("id", "test-grain")
    ActionChains(page.driver).double_click(slider).perform()
    assert settings(page)["test"] == SECOND.as_json()["test"]


def test_a_number_is_typed(page):
    number = "reference-grain-number"
    press(page, number, Keys.END, Keys.BACKSPACE * 9, "1.25", Keys.ENTER)
    assert settings(page)["reference"]["sigma_n_deg"] == 1.25
    press(page, number, Keys.END, Keys.BACKSPACE * 9, "77", Keys.ENTER)
    assert settings(page)["reference"]["sigma_n_deg"] == 10.0


def test_drags_turn_the_object_and_with_shift_the_lamp(page):
    canvas = page.driver.find_element("id", "canvas")
    width = call(page, "() => relgloss.app.paneAt().box[2]")
    actions = ActionChains(page.driver, duration=20).move_to_element_with_offset(canvas, -100, 0)
    actions.click_and_hold().move_by_offset(40, 20).release().perform()
    eye = camera.orbited(SECOND.eye, (40, 20), (width, 1))
    got = settings(page)
    assert got["eye"]["azimuth_deg"] == pytest.approx(eye.azimuth_deg, abs=1e-9)
    assert got["eye"]["elevation_deg"] == pytest.approx(eye.elevation_deg, abs=1e-9)
    assert got["lamp"] == SECOND.as_json()["lamp"]
    actions = ActionChains(page.driver, duration=20).move_to_element_with_offset(canvas, -100, 0)
    actions.key_down(Keys.SHIFT).click_and_hold().move_by_offset(-30, 0).release()
    actions.key_up(Keys.SHIFT).perform()
    lamp = camera.turned(Lamp(azimuth_deg=30.0), (-30, 0), (width, 1))
    assert settings(page)["lamp"]["azimuth_deg"] == pytest.approx(lamp.azimuth_deg, abs=1e-9)


def test_keys_of_the_canvas(page):
    press(page, "canvas", Keys.ARROW_RIGHT)
    assert settings(page)["eye"]["azimuth_deg"] == pytest.approx(15.0)
    press(page, "canvas", "l", Keys.ARROW_RIGHT)
    assert settings(page)["lamp"]["azimuth_deg"] == pytest.approx(35.0)
    press(page, "canvas", "+")
    assert "field_of_view_deg" in settings(page)["eye"]
    press(page, "canvas", "0")
    assert "field_of_view_deg" not in settings(page)["eye"]
    press(page, "canvas", Keys.HOME)
    assert settings(page) == SECOND.as_json()
    described = "() => document.getElementById('canvas').getAttribute('aria-label')"
    before = call(page, described)
    assert "0.60" in before
    press(page, "test-grain", Keys.ARROW_RIGHT * 5)
    settings(page)
    assert call(page, described) != before


def test_the_hand_is_that_of_the_window(page):
    """orbited, turned and the angle of life size, against viewer/drawing/camera.py."""
    rng = np.random.default_rng(5)
    for _ in range(20):
        eye = Eye(rng.uniform(-180, 180), rng.uniform(-90, 90), rng.uniform(0.2, 3))
        lamp = Lamp(rng.uniform(-180, 180), rng.uniform(-90, 90))
        moved = tuple(rng.uniform(-500, 500, 2).tolist())
        width, pitch = int(rng.integers(100, 1000)), rng.uniform(1e-4, 1e-3)
        got = call(
            page,
            """(eye, lamp, moved, width, height) => {
              const hand = relgloss.hand;
              return [hand.orbited(eye, moved, width), hand.turned(lamp, moved, width),
                hand.lifeSized(eye, height)];
            }""",
            vars(eye), vars(lamp), moved, width, 300 * pitch,
        )  # fmt: skip
        size = (width, 300)
        wanted = (camera.orbited(eye, moved, size), camera.turned(lamp, moved, size),
                  camera.life_sized(eye, pitch, size))  # fmt: skip
        for one, other in zip(got, wanted, strict=True):
            for name, value in one.items():
                expected = getattr(other, name)
                # Both work in double precision; sums of a few terms differ in the last digits.
                assert value == (
                    expected
                    if not isinstance(expected, float)
                    else pytest.approx(expected, abs=1e-9)
                ), name


def test_wipe_and_flip_show_parts_of_both(page):
    record = """() => { const {engine} = relgloss, show = engine.show.bind(engine);
      window.boxes = []; engine.show = (list) => { window.boxes = list; show(list); }; }"""
    call(page, record)
    shown = "async () => { await relgloss.idle(); return window.boxes }"
    both = call(page, shown)
    assert [box["side"] for box in both] == ["reference", "test"]
    call(page, "() => document.querySelector('[data-key=wipe]').click()")
    first, second = call(page, shown)
    assert first["to"][0] + first["to"][2] == second["to"][0]
    assert first["to"][2] == pytest.approx(second["to"][2], abs=1)  # of an odd width
    press(page, "wipe", Keys.ARROW_LEFT * 5)
    moved, _ = call(page, shown)
    assert moved["to"][2] == pytest.approx(first["to"][2] * 0.8, abs=1)
    press(page, "wipe", Keys.END)
    assert [box["side"] for box in call(page, shown)] == ["reference"]
    call(page, "() => document.querySelector('[data-key=flip]').click()")
    sides = []
    for _ in range(2):
        sides += [box["side"] for box in call(page, shown)]
        press(page, "flip", Keys.ENTER)
    assert sorted(sides) == ["reference", "test"]
    assert console(page) == []


def test_the_readout_is_that_of_the_pixel(page):
    call(page, "() => document.querySelector('[data-key=read]').click()")
    press(page, "canvas", Keys.ARROW_RIGHT)
    press(page, "canvas", Keys.ARROW_RIGHT)
    wanted, side, text = call(
        page,
        """() => {
      const app = relgloss.app;
      const {left, top} = document.getElementById("mark").style;
      const at = app.pictureAt(parseFloat(left), parseFloat(top));
      return [relgloss.engine.lab_at(at.side, at.x, at.y), at.side,
        document.getElementById("readout").textContent];
    }""",
    )
    assert text.startswith({"reference": "Reference sample", "test": "The design"}[side])
    for number in (*wanted["lab"], wanted["l_d"], wanted["l_s"]):
        assert f"{abs(number):.1f}" in text


def test_settings_of_each_message_are_one_click_away(page):
    buttons = page.driver.find_elements("css selector", "#thread .message .button")
    assert len(buttons) == 2
    call(page, "() => document.querySelector('#thread .message .button').click()")
    assert settings(page) == FIRST.as_json()
    assert "Message 1 of 2" in whose(page)
    assert whose(page).startswith("As sent earlier")


def test_nothing_is_drawn_while_nothing_changes(page):
    count = """async (change) => {
      await relgloss.idle();
      const {engine} = relgloss, draw = engine.draw.bind(engine);
      let calls = 0;
      engine.draw = (...all) => { calls++; return draw(...all); };
      const now = relgloss.settings();
      if (change) relgloss.set({...now, eye: {...now.eye, azimuth_deg: 3}});
      while (change && calls === 0) await new Promise(requestAnimationFrame);
      await new Promise((done) => setTimeout(done, 250));
      return calls;
    }"""
    assert call(page, count, False) == 0
    assert call(page, count, True) == 1


def test_a_lost_context_comes_back(page):
    before = pixels(page, "test")
    call(
        page,
        """() => { window.lose = document.getElementById("canvas").getContext("webgl2")
      .getExtension("WEBGL_lose_context"); lose.loseContext(); }""",
    )
    until(page, "relgloss.app.lost")
    assert state(page) == "lost"
    assert "driver" in call(page, "() => document.getElementById('notice').textContent")
    call(page, "() => lose.restoreContext()")
    until(page, "!relgloss.app.lost")
    assert np.array_equal(pixels(page, "test"), before)
    assert state(page) == "ready"
    assert call(page, "() => document.getElementById('notice').hidden")


def test_an_answer_is_a_file_that_python_reads(page, page_file, tmp_path):
    call(
        page, """() => { URL.createObjectURL = (blob) => { window.saved = blob; return "#"; }; }"""
    )
    press(page, "test-grain", Keys.ARROW_RIGHT * 7)
    press(page, "reply-note", "Too dull & <b>grainy</b>.")
    press(page, "reply-name", "Zoë")
    unload = "() => !window.dispatchEvent(new Event('beforeunload', {cancelable: true}))"
    assert call(page, unload)  # which a browser asks about
    assert (
        call(page, "() => document.getElementById('reply-file').value")
        == "Sample-box-autumn-edition-3.html"
    )
    press(page, "reply-save", Keys.ENTER)
    assert not call(page, unload)
    html = call(page, "() => window.saved.text()")
    answer, sent = Page(html), Page(page_file.read_text(encoding="utf-8"))
    assert answer.changes == ()
    messages = answer.block("proof")["messages"]
    assert messages[:2] == sent.block("proof")["messages"]
    assert messages[2]["note"] == "Too dull & <b>grainy</b>."
    assert messages[2]["author"] == "Zoë"
    assert messages[2]["settings"] == settings(page)
    assert messages[2]["parent"] == sent.named
    (tmp_path / "answer.html").write_bytes(html.encode("utf-8"))
    open_page(page, tmp_path / "answer.html")
    assert state(page) == "ready"
    assert "Message 3 of 3, the newest, by Zoë" in whose(page)


def test_the_static_body_of_an_answer_is_that_of_python(page):
    """With JavaScript off, a reply made by the page reads as one made by Python."""
    from relgloss_view.proof.page import static

    proof = sample_proof(replies=2)
    newest = proof.as_json()["messages"][-1]
    call(
        page,
        """() => { URL.createObjectURL = (blob) => { window.saved = blob; return "#"; };
      const then = "2026-11-27T14:05:00.000Z";
      window.Date = class extends Date { toISOString() { return then; } }; }""",
    )
    press(page, "reply-note", newest["note"])
    press(page, "reply-name", newest["author"])
    press(page, "reply-save", Keys.ENTER)
    answer = Page(call(page, "() => window.saved.text()"))
    assert answer.texts["static"] == static.body(proof)


def test_a_changed_page_shows_nothing(chromium_gl, page_file, tmp_path):
    html = page_file.read_text(encoding="utf-8")
    for old, new, named in (
        ("autumn edition", "winter edition", "words of the page"),
        ('"note":"Answer 1"', '"note":"Answer 2"', "note of message 2"),
    ):
        assert old in html
        changed = tmp_path / "changed.html"
        changed.write_bytes(html.replace(old, new).encode("utf-8"))
        open_page(chromium_gl, changed)
        assert state(chromium_gl) == "changed"
        assert named in call(chromium_gl, "() => document.getElementById('notice').textContent")
        assert call(chromium_gl, "() => document.getElementById('canvas')") is None
        assert call(chromium_gl, "() => document.getElementById('main').offsetHeight") == 0


def test_without_webgl_stored_pictures_and_words_stay(chromium_gl, page_file):
    before_pages(chromium_gl, "HTMLCanvasElement.prototype.getContext = () => null;")
    open_page(chromium_gl, page_file)
    assert state(chromium_gl) == "unsupported"
    assert "WebGL" in call(chromium_gl, "() => document.getElementById('notice').textContent")
    heights = "() => [...document.querySelectorAll('#stage img')].map((i) => i.offsetHeight)"
    assert min(call(chromium_gl, heights)) > 50
    assert call(chromium_gl, "() => document.querySelectorAll('input, canvas').length") == 0
    assert console(chromium_gl) == []
