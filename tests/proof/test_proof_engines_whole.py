"""A reader's whole way through a proof in Firefox and WebKitGTK: look, turn, answer, save."""

from __future__ import annotations

import base64
import io
import time

import numpy as np
import other_engines
import pytest
from browsers import LONGEST_S, call, open_page
from opened_proofs import AUTHOR, NOTE, SEEN, SIZE, page_of
from PIL import Image
from test_proof_page_looks import OVERFLOW

from relgloss_view import cli
from relgloss_view.proof import keys
from relgloss_view.proof.page.build import words
from relgloss_view.proof.proof import Message, Proof
from relgloss_view.proof.read import read_proof

pytestmark = pytest.mark.slow
WORDS = words()
RIGHT = "\ue014"  #: the key, as WebDriver names it
READY = """async () => {
  await relgloss.ready;
  await relgloss.idle();
  const end = performance.now() + 20000;
  const check = document.getElementById("check");
  const later = () => new Promise((done) => setTimeout(done, 20));
  while (!check.dataset.same && performance.now() < end) await later();
  return {
    state: document.getElementById("main").dataset.state, same: check.dataset.same,
    signed: [...document.querySelectorAll(".signed")].map((line) => line.textContent),
    messages: document.querySelectorAll("#thread .message").length,
    whose: document.getElementById("whose").textContent, engine: navigator.userAgent,
  };
}"""
SETTINGS = "async () => { await relgloss.idle(); return relgloss.settings() }"
#: The clock of an answer, and an ear for what is thrown or written as an error.
PREPARED = """() => {
  window.errors = [];
  window.addEventListener("error", (event) => errors.push(event.message));
  window.addEventListener("unhandledrejection", (event) => errors.push(String(event.reason)));
  console.error = (...all) => errors.push(all.join(" "));
  const then = "2026-11-27T14:05:00.000Z";
  window.Date = class extends Date { toISOString() { return then; } };
}"""
CENTRE = """(selector) => {
  const element = document.querySelector(selector);
  element.scrollIntoView({block: "center"});
  const box = element.getBoundingClientRect();
  return [Math.round(box.left + box.width / 2), Math.round(box.top + box.height / 2)];
}"""


@pytest.fixture(params=["firefox", "webkit"])
def engine(request):
    found = request.getfixturevalue(request.param)
    found.resize(1280, 800)
    return found


def opened_in(engine, path):
    engine.open(path)
    engine.call("async () => { await relgloss.ready; }")
    engine.call(PREPARED)
    return engine.call(READY)


def written(path, proof):
    path.write_text(page_of(proof), encoding="utf-8", newline="\n")
    return path


def pixels(engine, side):
    data = engine.call(
        """async (side) => {
          await relgloss.idle();
          const {data} = relgloss.engine.pixels(side);
          let text = "";
          for (let at = 0; at < data.length; at += 32768)
            text += String.fromCharCode(...data.subarray(at, at + 32768));
          return btoa(text);
        }""",
        side,
    )
    return np.frombuffer(base64.b64decode(data), np.uint8)


def press(engine, name, *presses):
    engine.call("(id) => document.getElementById(id).focus()", name)
    actions = [{"type": kind, "value": value} for value in presses for kind in ("keyDown", "keyUp")]
    engine.act("key", *actions)


def click(engine, selector):
    x, y = engine.call(CENTRE, selector)
    engine.act(
        "pointer",
        {"type": "pointerMove", "x": x, "y": y, "duration": 0},
        {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0},
    )  # fmt: skip


def drag(engine, selector, right, down, aside=0):
    x, y = engine.call(CENTRE, selector)
    place = {"type": "pointerMove", "duration": 0}
    engine.act(
        "pointer",
        {**place, "x": x + aside, "y": y}, {"type": "pointerDown", "button": 0},
        {**place, "x": x + aside + right // 2, "y": y + down // 2},
        {**place, "x": x + aside + right, "y": y + down},
        {"type": "pointerUp", "button": 0},
    )  # fmt: skip


def in_time(condition, what):
    end = time.monotonic() + LONGEST_S
    while not (found := condition()):
        assert time.monotonic() < end, what
        time.sleep(0.05)
    return found


def test_a_readers_way(engine, paper, tmp_path):
    """Check, sliders, turn, wipe, screen check, thread: each does what it does in Chromium."""
    newer = Message(paper.messages[0].settings, "And so?", "Bo", "2026-11-27T09:30:00Z", "p 1")
    found = opened_in(engine, written(tmp_path / "proof.html", paper.answered(newer)))
    assert (found["state"], found["same"], found["messages"]) == ("ready", "true", 2)
    sent = engine.call(SETTINGS)
    before = {side: pixels(engine, side) for side in ("reference", "test")}
    press(engine, "test-grain", *[RIGHT] * 5)
    assert engine.call(SETTINGS)["test"]["sigma_n_deg"] > sent["test"]["sigma_n_deg"]
    assert not np.array_equal(pixels(engine, "test"), before["test"])
    assert np.array_equal(pixels(engine, "reference"), before["reference"])  # the control
    click(engine, "#as-sent")
    assert engine.call(SETTINGS) == sent
    assert np.array_equal(pixels(engine, "test"), before["test"])
    drag(engine, "#canvas", 40, 20, aside=-100)
    turned = engine.call(SETTINGS)
    assert turned["eye"]["azimuth_deg"] < sent["eye"]["azimuth_deg"]
    assert turned["lamp"] == sent["lamp"]
    click(engine, "[data-key=wipe]")
    engine.call(SETTINGS)  # which waits until the handle is at its place
    drag(engine, "#wipe", -60, 0)
    assert 0.2 < engine.call("() => relgloss.app.shown.share") < 0.48
    click(engine, "[data-key=read]")
    click(engine, "#canvas")
    assert "L*" in engine.call("() => document.getElementById('readout').textContent")
    click(engine, "#thread .message .button")
    assert "1" in engine.call("() => document.getElementById('whose').textContent")
    assert engine.call(SETTINGS) == sent
    click(engine, "[data-ground=dark] .patch:nth-child(3) input")
    click(engine, "#screen details summary")  # the white field, which is bright
    click(engine, "[data-ground=bright] .patch:nth-child(2) input")
    assert engine.call("() => relgloss.app.screen.black_most") is not None
    assert engine.call("() => window.errors") == []


def _saved(engine, proof, path):
    """The bytes of an answer that the engine saves as a file."""
    opened_in(engine, written(path, proof))
    press(engine, "test-grain", *[RIGHT] * 3)
    engine.call(SETTINGS)
    press(engine, "reply-note", *"Duller & <b>rough</b>.")
    press(engine, "reply-name", *"Bo")
    name = engine.call("() => document.getElementById('reply-file').value")
    click(engine, "#reply-save")
    file = engine.saved / name
    in_time(file.exists, "no file is saved")
    # Firefox makes the file before it writes into it, and WebKitGTK writes it in parts.
    in_time(lambda: file.read_bytes().rstrip().endswith(b"</html>"), "it is not whole")
    return file


def test_an_answer_is_chromiums_byte_for_byte(engine, chromium_gl, paper, tmp_path):
    file = _saved(engine, paper, tmp_path / "proof.html")
    answer = read_proof(file)
    newest = answer.messages[-1]
    assert (newest.note, newest.author) == ("Duller & <b>rough</b>.", "Bo")
    assert newest.parent == paper.digests[-1]
    open_page(chromium_gl, tmp_path / "proof.html")
    call(chromium_gl, PREPARED)
    other = call(
        chromium_gl,
        """async (settings, note, author) => {
          relgloss.set(settings);
          await relgloss.idle();
          return relgloss.app.answered({note, author});
        }""",
        newest.settings.as_json(), newest.note, newest.author,
    )  # fmt: skip
    written_here = file.read_bytes()
    assert written_here == other.encode("utf-8")
    assert written_here != (tmp_path / "proof.html").read_bytes()  # the control
    file.unlink()
    again = opened_in(engine, written(tmp_path / "answer.html", answer))
    assert (again["state"], again["same"], again["messages"]) == ("ready", "true", 2)


def test_signatures(engine, paper, tmp_path):
    """A right one, and one that belongs to another message."""
    path = tmp_path / "a.key"
    keys.make_key(path)
    key = keys.read_private(path)
    signed = keys.signed(paper, key)
    found = opened_in(engine, written(tmp_path / "signed.html", signed))
    (line,) = found["signed"]
    assert line.startswith(WORDS["signed.right"].partition("{key}")[0]), line
    other = keys.signed(Proof(paper.content, (Message(paper.messages[0].settings, "x"),)), key)
    (signature,) = other.signatures
    forged = Proof(paper.content, paper.messages, (signature,))
    (line,) = opened_in(engine, written(tmp_path / "forged.html", forged))["signed"]
    assert line == WORDS["signed.wrong"]


def test_a_chain_of_20(engine, paper, tmp_path):
    proof = paper
    for k in range(19):
        note = f"Answer {k} \u00e4\u4e2d\U0001f642 <i>"
        proof = proof.answered(Message(paper.messages[0].settings, note, f"P{k}"))
    found = opened_in(engine, written(tmp_path / "chain.html", proof))
    assert (found["state"], found["same"], found["messages"]) == ("ready", "true", 20)
    assert "P18" in found["whose"]
    assert engine.call("() => relgloss.page.digests") == list(proof.digests)
    notes = engine.call("() => [...document.querySelectorAll('.said')].map((p) => p.textContent)")
    assert notes == [message.note for message in proof.messages]


@pytest.mark.parametrize("size", [(390, 844), (1280, 800)], ids=["narrow", "wide"])
def test_nothing_reaches_beyond_the_page(engine, paper, size, tmp_path):
    engine.resize(*size)
    found = opened_in(engine, written(tmp_path / "proof.html", paper))
    assert found["state"] == "ready"
    scrolled, wide, out = engine.call(OVERFLOW)
    assert out == []
    assert scrolled <= wide
    shown = np.asarray(Image.open(io.BytesIO(engine.screenshot())).convert("RGB"), int)
    green = (shown[..., 1] > shown[..., 0] + 40) & (shown[..., 1] > shown[..., 2] + 40)
    assert green.mean() > 0.02  # the pictures' ink: what is drawn is seen, too
    engine.call("() => { document.getElementById('canvas').style.opacity = 0; }")
    engine.call("() => new Promise((d) => requestAnimationFrame(() => requestAnimationFrame(d)))")
    empty = np.asarray(Image.open(io.BytesIO(engine.screenshot())).convert("RGB"), int)
    assert (empty[..., 1] > empty[..., 0] + 40).mean() < 0.001  # the negative control
    assert engine.call("() => window.errors") == []


def test_packs_are_checked_in_the_page(engine, tmp_path):
    path = tmp_path / "can.html"
    assert cli.main(["proof", "make", "can", "-o", str(path), "--artwork-px", "256"]) == 0
    found = opened_in(engine, path)
    assert (found["state"], found["same"]) == ("ready", "true")
    assert engine.call("() => window.errors") == []


NO_SCRIPTS = '<!DOCTYPE html><meta charset="utf-8"><title>t</title><body><iframe sandbox="allow-same-origin" width="800" height="2000" src="{}"></iframe>'  # noqa: E501


def test_no_javascript(request, other_screen, paper, tmp_path):
    """Firefox in a frame that runs no scripts; WebKitGTK with JavaScript off."""
    path = written(tmp_path / "proof.html", paper)
    frame = tmp_path / "frame.html"
    frame.write_text(NO_SCRIPTS.format(path.name), encoding="utf-8")
    firefox = request.getfixturevalue("firefox")
    firefox.open(frame)
    top = firefox.tab
    (child,) = firefox.command("browsingContext.getTree", root=top)["contexts"][0]["children"]
    try:
        firefox.tab = child["context"]
        _looks_stored(firefox)
    finally:
        firefox.tab = top
    with other_engines.webkit(other_screen, "--enable-javascript=false") as webkit:
        webkit.open(path)
        _looks_stored(webkit)
        bright = np.asarray(Image.open(io.BytesIO(webkit.screenshot())).convert("L"))[70:170]
        assert (bright > 200).mean() > 0.3  # the notice is painted, and not only there


def _looks_stored(engine):
    seen = in_time(lambda: (s := engine.call(SEEN))["notice"] and s, "no word of JavaScript")
    assert seen["state"] is None
    assert seen["pictures"] == [list(SIZE)] * 2
    assert (seen["sliders"], seen["canvases"]) == (0, 0)
    assert WORDS["state.unchecked"] in seen["notice"]
    for text in (NOTE, AUTHOR):
        assert text in seen["text"]


def test_scripts_before_pages_are_undone(firefox, paper, tmp_path):
    path = written(tmp_path / "proof.html", paper)
    with firefox.before_pages("window.planted = 1;"):
        firefox.open(path)
        assert firefox.call("() => window.planted ?? null") == 1
    firefox.open(path)
    assert firefox.call("() => window.planted ?? null") is None
