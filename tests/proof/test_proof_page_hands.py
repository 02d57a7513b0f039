"""The page under the hand: pinches, slow drags, life size, answers by touch, other versions."""

from __future__ import annotations

import time

import pytest
from browsers import call, console, emulate, open_page, requests, until
from page_samples import SECOND, drawing, sample_page, sample_proof
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

from relgloss_view.proof.page import build, static
from relgloss_view.proof.page.whole import page_of
from relgloss_view.proof.read import read_proof

CARD_MM = 85.6


def settings(browser):
    return call(browser, "async () => { await relgloss.idle(); return relgloss.settings() }")


def fingers(browser, kind, *places):
    points = [{"x": x, "y": y, "id": k} for k, (x, y) in enumerate(places)]
    browser.cdp("Input.dispatchTouchEvent", type=kind, touchPoints=points)


def middle(browser):
    """Centre of the first picture in the page, CSS pixels."""
    return call(
        browser,
        """() => { const [x, y, w, h] = relgloss.app.paneAt().box;
      const {left, top} = document.getElementById("canvas").getBoundingClientRect();
      return [left + x + w / 2, top + y + h / 2]; }""",
    )


def test_two_fingers_zoom_and_one_turns(chromium_gl, tmp_path):
    emulate(chromium_gl, 390, 844, 2, touch=True)
    open_page(chromium_gl, sample_page(tmp_path / "proof.html"))
    x, y = middle(chromium_gl)
    step = "() => relgloss.app.report().test.view.pixel_step"
    settings(chromium_gl)
    before = call(chromium_gl, step)
    fingers(chromium_gl, "touchStart", (x - 20, y), (x + 20, y))
    for k in range(1, 6):
        fingers(chromium_gl, "touchMove", (x - 20 - 4 * k, y), (x + 20 + 4 * k, y))
    fingers(chromium_gl, "touchEnd")
    eye = settings(chromium_gl)["eye"]
    # Twice as far apart is twice as large; both fingers went alike, so nothing is shifted by more
    # than a finger's last step.
    assert call(chromium_gl, step) == pytest.approx(0.5 * before, rel=0.02)
    assert abs(eye["shift_right"]) < 5 * before
    assert eye["azimuth_deg"] == SECOND.eye.azimuth_deg  # a pinch turns nothing
    fingers(chromium_gl, "touchStart", (x, y))
    fingers(chromium_gl, "touchMove", (x + 30, y))
    fingers(chromium_gl, "touchEnd")
    turned = settings(chromium_gl)["eye"]
    assert turned["azimuth_deg"] < eye["azimuth_deg"]
    assert turned["field_of_view_deg"] == eye["field_of_view_deg"]
    words = call(chromium_gl, "() => document.getElementById('keys').textContent")
    assert "arrow keys" not in words  # which a phone does not have
    assert console(chromium_gl) == []


def test_a_slow_machine_draws_a_dragged_picture_smaller(chromium_gl, tmp_path):
    emulate(chromium_gl, 1000, 700)
    open_page(chromium_gl, sample_page(tmp_path / "proof.html"))
    settings(chromium_gl)
    sizes = call(
        chromium_gl,
        """async (slow) => {
          const {app, engine} = relgloss, draw = engine.draw.bind(engine), sizes = [];
          engine.draw = (settings, size, more) => {
            const end = performance.now() + slow * size[0] * size[1] / 1e6;
            const report = draw(settings, size, more);
            while (performance.now() < end);
            sizes.push([size[0], more.moving]);
            return report;
          };
          for (let k = 0; k < 6; k++) {
            const now = relgloss.settings();
            app.set({...now, eye: {...now.eye, azimuth_deg: k}}, true);
            app.moved = Infinity; // a drag, however late its frame comes
            await new Promise((done) => requestAnimationFrame(done));
            await new Promise((done) => requestAnimationFrame(done));
          }
          app.moved = -Infinity;
          await relgloss.idle();
          return sizes;
        }""",
        2000,
    )
    full = sizes[-1][0]
    assert sizes[-1][1] is False  # at rest, and in full
    moving = [width for width, moves in sizes if moves]
    assert moving[0] == full
    assert min(moving) < 0.8 * full
    assert min(moving) >= 0.3 * full - 1


def test_life_size_is_that_of_a_card(chromium_gl, tmp_path):
    """A sheet as wide as a bank card takes as many pixels as the card on the screen."""
    emulate(chromium_gl, 1000, 700)
    open_page(chromium_gl, sample_page(tmp_path / "proof.html"))
    settings(chromium_gl)
    card_px = 300.0  # so wide is the card on this screen
    call(
        chromium_gl,
        """async (card) => {
          document.getElementById("life-size").click();
          const size = document.getElementById("card-size");
          size.value = card;
          size.dispatchEvent(new Event("input"));
          document.querySelector("#life .first").click();
          await relgloss.idle();
        }""",
        card_px,
    )
    measured = """async () => {
      await relgloss.idle();
      const {app} = relgloss, {size} = app.drawn, pixel = app.paneAt().box[3] / size[1];
      return [app.report().test.view.pixel_step * app.present.eye.distance_m / pixel,
        app.paneAt().box[3]];
    }"""
    metres, height = call(chromium_gl, measured)
    # A CSS pixel shows so many metres of the plane through the object's centre; float32 keeps 7
    # digits.
    assert metres == pytest.approx(CARD_MM / 1000 / card_px, rel=1e-6)
    emulate(chromium_gl, 900, 560)
    until(chromium_gl, f"relgloss.app.paneAt().box[3] !== {height}")
    again, other = call(chromium_gl, measured)
    assert other != height  # the picture has got another height
    assert again == pytest.approx(metres, rel=1e-6)
    call(chromium_gl, "() => document.getElementById('frame').click()")
    assert call(chromium_gl, measured)[0] != pytest.approx(metres, rel=0.01)  # negative control


def test_a_card_lies_upright_on_a_phone(chromium_gl, tmp_path):
    emulate(chromium_gl, 390, 844, 2, touch=True)
    open_page(chromium_gl, sample_page(tmp_path / "proof.html"))
    width, height, right = call(
        chromium_gl,
        """() => { document.getElementById("life-size").click();
      const box = document.querySelector("#life .card").getBoundingClientRect();
      return [box.width, box.height, box.right]; }""",
    )
    assert height / width == pytest.approx(CARD_MM / 53.98, rel=0.01)
    assert right < 390


def test_an_answer_by_touch_is_a_page_that_opens(chromium_gl, tmp_path):
    file = tmp_path / "proof.html"
    file.write_bytes(page_of(sample_proof(replies=3)).encode("utf-8"))
    emulate(chromium_gl, 390, 844, 2, touch=True)
    open_page(chromium_gl, file)
    chromium_gl.cdp(
        "Browser.setDownloadBehavior", behavior="allow", downloadPath=str(tmp_path / "saved")
    )
    call(chromium_gl, "() => document.getElementById('reply-file').select()")
    ActionChains(chromium_gl.driver).send_keys(Keys.BACKSPACE, "My answer. ").perform()
    call(chromium_gl, "() => document.getElementById('reply-note').focus()")
    chromium_gl.cdp("Input.insertText", text="Zu matt \U0001f642\nSieh die Kante an.")  # as a phone
    call(chromium_gl, "() => document.getElementById('reply-save').click()")
    answer = tmp_path / "saved" / "My answer.html"
    end_s = time.monotonic() + 120.0
    while not answer.exists() and time.monotonic() < end_s:
        time.sleep(0.05)
    assert answer.exists(), list((tmp_path / "saved").glob("*"))
    proof = read_proof(answer)
    assert proof.messages[-1].note == "Zu matt \U0001f642\nSieh die Kante an."
    open_page(chromium_gl, answer)
    state = call(
        chromium_gl,
        """async () => { await relgloss.ready; return [
      document.getElementById("main").dataset.state, document.getElementById("whose").textContent,
      document.querySelector("blockquote").textContent,
      document.querySelectorAll("#thread .message").length]; }""",
    )
    assert state[0] == "ready"
    assert "Message 5 of 5, the newest" in state[1]
    assert state[2].endswith("Sieh die Kante an.")
    assert state[3] == 5


def test_each_name_of_an_answer_is_that_of_a_page(chromium_gl, tmp_path):
    """A browser shows the text of a file whose name does not end so."""
    open_page(chromium_gl, sample_page(tmp_path / "proof.html"))
    names = call(
        chromium_gl,
        """(all) => {
          URL.createObjectURL = () => "#";
          const file = document.getElementById("reply-file");
          return all.map((name) => {
            file.value = name;
            document.getElementById("reply-save").click();
            return file.value;
          });
        }""",
        ["answer", "a.HTM", " ", "v1.2", "b.html"],
    )
    assert names == ["answer.html", "a.HTM", "proof.html", "v1.2.html", "b.html"]


def test_each_message_brings_its_own_note(chromium_gl, tmp_path):
    open_page(chromium_gl, sample_page(tmp_path / "proof.html", replies=2))
    beside = """async (k) => { document.querySelectorAll("#thread .message .button")[k].click();
      await relgloss.idle();
      return document.getElementById("panel").innerText
        + document.getElementById("whose").innerText; }"""
    for k, note in enumerate(("Please look at the edge.", "Answer 1", "Answer 2")):
        shown = call(chromium_gl, beside, k)
        assert note in shown
        assert f"Message {k + 1}, from" in shown
        assert f"Message {k + 1} of 3" in shown
        assert shown.count("Answer") == (k > 0)
    assert console(chromium_gl) == []


def test_a_newer_version_draws_nothing(chromium_gl, tmp_path, monkeypatch):
    proof = sample_proof()
    data = {**proof.as_json(), "version": 99}
    monkeypatch.setattr(type(proof), "as_json", lambda self: data)
    html = build.page(proof, drawing()[1], static.body(proof))
    file = tmp_path / "newer.html"
    file.write_bytes(html.encode("utf-8"))
    open_page(chromium_gl, file)
    shown = call(
        chromium_gl,
        """() => [document.getElementById("main").dataset.state, document.querySelector("canvas"),
      document.getElementById("notice").textContent, document.getElementById("all-the-same")]""",
    )
    assert shown[0] == "changed"
    assert shown[1] is None
    assert "newer version" in shown[2]
    assert shown[3] is None  # there is nothing that this page could read


def test_a_changed_page_is_shown_all_the_same_where_its_proof_is_whole(chromium_gl, tmp_path):
    html = sample_page(tmp_path / "proof.html").read_text(encoding="utf-8")
    for old, new, offered in (
        (">Messages<", ">Massages<", True),
        ('"note":"Answer 1"', '"note":"Answer 2"', False),
    ):
        assert old in html
        file = tmp_path / "changed.html"
        file.write_bytes(html.replace(old, new, 1).encode("utf-8"))
        open_page(chromium_gl, file)
        button = "() => document.getElementById('all-the-same') !== null"
        assert call(chromium_gl, button) is offered
        if not offered:
            continue
        call(chromium_gl, "() => document.getElementById('all-the-same').focus()")
        ActionChains(chromium_gl.driver).send_keys(Keys.ENTER).perform()
        state = call(
            chromium_gl,
            """async () => { await relgloss.ready; await relgloss.idle();
          return [document.getElementById("main").dataset.state,
            document.getElementById("notice").textContent]; }""",
        )
        assert state[0] == "ready"
        assert "not as it was sealed" in state[1]  # which stays
    assert requests(chromium_gl) == []


def test_a_pair_beyond_its_view_says_what_shows(chromium_gl, tmp_path):
    open_page(chromium_gl, sample_page(tmp_path / "proof.html"))
    shown = """async (c) => {
      const now = relgloss.settings();
      relgloss.set({...now, test: {...now.test, c: c * relgloss.app.report().test.c_max}});
      await relgloss.idle();
      const text = (id) => document.getElementById(id).hidden ? null
        : document.getElementById(id).textContent;
      const range = document.getElementById("test-contrast");
      return [text("dimmed"), text("test-contrast-shown"), Number(range.max), Number(range.value)];
    }"""
    settings(chromium_gl)
    dimmed, below, most, value = call(chromium_gl, shown, 2.1)
    assert "the design" in dimmed
    assert "48\u00a0%" in dimmed  # 1 / 2.1
    assert below.endswith("This view shows 1.00.")
    assert most == 2.5
    assert value == pytest.approx(2.1, abs=0.01)
    assert call(chromium_gl, shown, 0.5)[0] is None  # the negative control
    assert call(chromium_gl, shown, 0.5)[1].startswith("c = 0.")
    assert call(chromium_gl, shown, 0.5)[2] == 1


def test_paper_gets_pictures_and_words_alone(chromium_gl, tmp_path):
    emulate(chromium_gl, 1280, 800)
    open_page(chromium_gl, sample_page(tmp_path / "proof.html"))
    settings(chromium_gl)
    seen = """() => {
      const shown = (selector) => [...document.querySelectorAll(selector)].some((e) =>
        e.getBoundingClientRect().height > 0);
      const {width, height} = document.getElementById("canvas").getBoundingClientRect();
      return [["h1", "blockquote", ".message", "#readings", "#whose", "canvas"].every(shown),
        ["button", "#controls input", "#screen", "#reply"].some(shown), width, width / height]; }"""
    words, controls, wide, shape = call(chromium_gl, seen)
    assert (words, controls) == (True, True)  # the negative control
    chromium_gl.cdp("Emulation.setEmulatedMedia", media="print")
    call(chromium_gl, "() => { window.dispatchEvent(new Event('beforeprint')); }")
    words, controls, narrow, same = call(chromium_gl, seen)
    assert (words, controls) == (True, False)
    assert narrow < 700 < wide
    assert same == pytest.approx(shape, rel=0.01)
    chromium_gl.cdp("Emulation.setEmulatedMedia", media="")
    call(chromium_gl, "() => { window.dispatchEvent(new Event('afterprint')); }")
    assert call(chromium_gl, seen)[2] == wide


def test_pictures_lie_where_the_objects_are_larger(chromium_gl, tmp_path):
    emulate(chromium_gl, 390, 844, touch=True)
    open_page(chromium_gl, sample_page(tmp_path / "proof.html"))
    settings(chromium_gl)
    boxes = """async (room) => { const {app} = relgloss;
      if (room) { app.room = room; app.redraw(); await app.idle(); }
      return [app.room, ...app.panes.map(({box}) => box)]; }"""
    room, first, second = call(chromium_gl, boxes, None)
    assert room[0] < room[1]  # an upright cylinder
    assert first[1] == second[1]  # beside each other on a phone
    _, first, second = call(chromium_gl, boxes, [3, 1])
    assert first[0] == second[0]  # the negative control: what is wide lies one above the other
