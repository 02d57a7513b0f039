"""What can't be drawn, in every engine: the stored pictures, all words and the reason."""

from __future__ import annotations

import contextlib
import time

import other_engines
import pytest
from browsers import LONGEST_S, before_pages, call, console, emulate, open_page
from opened_proofs import SEEN, SIZE, page_of

from relgloss_view import cli
from relgloss_view.proof.page.build import words

WORDS = words()
NO_INFLATION = "delete window.DecompressionStream;"
FEW_TARGETS = """{
  const get = WebGL2RenderingContext.prototype.getParameter;
  WebGL2RenderingContext.prototype.getParameter = function (name) {
    return name === this.MAX_DRAW_BUFFERS ? 4 : get.call(this, name);
  };
}"""
LOSE = """async () => {
  await relgloss.ready;
  await relgloss.idle();
  window.lose = relgloss.engine.device.gl.getExtension("WEBGL_lose_context");
  lose.loseContext();
}"""
BACK = """async () => {
  lose.restoreContext();
  await new Promise((done) => { const end = performance.now() + 20000, look = () =>
    document.getElementById("main").dataset.state === "ready" || performance.now() > end
      ? done() : setTimeout(look, 50); look(); });
}"""
#: Whether sliders can still be moved, and an answer saved.
LIVE = """() => ["controls", "tools", "reply"].map((id) =>
  Boolean(document.getElementById(id).closest("[inert]")))"""


@pytest.fixture(scope="module")
def paper_file(paper, tmp_path_factory):
    path = tmp_path_factory.mktemp("lost") / "proof.html"
    path.write_text(page_of(paper), encoding="utf-8", newline="\n")
    return path


@pytest.fixture(scope="module")
def pack_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("packs") / "can.html"
    assert cli.main(["proof", "make", "can", "-o", str(path), "--artwork-px", "256"]) == 0
    return path


def assert_stored(seen, reason, sides=2):
    assert len(seen["pictures"]) == sides
    assert seen["canvases"] == 0
    assert reason in seen["notice"]


def in_time(see, state):
    end = time.monotonic() + LONGEST_S
    while (seen := see())["state"] != state:
        assert time.monotonic() < end, seen["state"]
        time.sleep(0.05)
    return seen


def a_context_that_does_not_come_back(run):
    """run(function): of the page that is open."""
    assert run(LIVE) == [False, False, False]
    run(LOSE)
    in_time(lambda: run(SEEN), "lost")
    seen = in_time(lambda: run(SEEN), "stored")
    assert_stored(seen, WORDS["state.stored"])
    assert seen["pictures"] == [list(SIZE)] * 2
    assert run(LIVE) == [True, True, False]
    run(BACK)  # the control: should it come at last, the page draws again
    seen = run(SEEN)
    assert (seen["state"], seen["canvases"], seen["pictures"]) == ("ready", 1, [])
    assert seen["notice"] == ""
    assert run(LIVE) == [False, False, False]


@pytest.mark.slow
def test_a_context_lost_for_good(chromium_gl, paper_file):
    emulate(chromium_gl, 1280, 800)
    open_page(chromium_gl, paper_file)
    a_context_that_does_not_come_back(lambda function: call(chromium_gl, function))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["firefox", "webkit"])
def test_a_context_lost_for_good_elsewhere(request, name, paper_file):
    engine = request.getfixturevalue(name)
    engine.resize(1280, 800)
    engine.open(paper_file)
    engine.call("async () => { await relgloss.ready; }")
    a_context_that_does_not_come_back(engine.call)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("script", "reason"),
    [(NO_INFLATION, "unsupported.inflation"), (FEW_TARGETS, "unsupported.targets")],
    ids=["no inflation", "few targets"],
)
def test_packs_that_can_not_be_drawn(chromium_gl, firefox, pack_file, script, reason):
    open_page(chromium_gl, pack_file)
    assert call(chromium_gl, SEEN)["canvases"] == 1  # the control
    before_pages(chromium_gl, script)
    open_page(chromium_gl, pack_file)
    seen = call(chromium_gl, SEEN)
    assert_stored(seen, WORDS[reason])
    assert seen["state"] == "unsupported"
    console(chromium_gl)
    with firefox.before_pages(script):
        firefox.open(pack_file)
        firefox.call("async () => { await relgloss.ready; }")
        assert_stored(firefox.call(SEEN), WORDS[reason])
        assert firefox.errors() == []


@pytest.mark.slow
@pytest.mark.parametrize("name", ["firefox", "webkit"])
def test_no_webgl_elsewhere(other_screen, name, paper_file):
    """By the switch of the engine itself."""
    with contextlib.ExitStack() as stack:
        started = (
            other_engines.firefox(other_screen, {"webgl.disabled": True})
            if name == "firefox"
            else other_engines.webkit(other_screen, "--enable-webgl=false")
        )
        engine = stack.enter_context(started)
        engine.open(paper_file)
        engine.call("async () => { await relgloss.ready; }")
        seen = engine.call(SEEN)
        assert_stored(seen, WORDS["unsupported.webgl"])
        assert seen["sliders"] == 0
