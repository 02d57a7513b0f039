"""Browsers that can't draw: the stored pictures and all words are there, and the reason."""

from __future__ import annotations

import base64
import subprocess
import time

import pytest
from browsers import (
    ELSEWHERE,
    LONGEST_S,
    before_pages,
    call,
    chromium,
    console,
    open_page,
    requests,
)
from listening import listening
from opened_proofs import AUTHOR, NOTE, SEEN, SIZE, page_of

from relgloss_view.proof.page.build import words

WORDS = words()
NO_FLOAT = """{
  const get = WebGL2RenderingContext.prototype.getExtension;
  WebGL2RenderingContext.prototype.getExtension = function (name) {
    return name === "EXT_color_buffer_float" ? null : get.call(this, name);
  };
}"""
NO_INFLATION = "delete window.DecompressionStream;"
NO_SUBTLE = "Object.defineProperty(crypto, 'subtle', {value: undefined});"


@pytest.fixture(scope="module")
def html(paper):
    return page_of(paper)


def assert_only_stored(seen, reason):
    """Pictures in their size and the words; no canvas, nothing to move, and why."""
    assert seen["pictures"] == [list(SIZE)] * 2
    assert (seen["sliders"], seen["canvases"]) == (0, 0)
    for text in (NOTE, AUTHOR, WORDS["side.reference"], WORDS["side.test"]):
        assert text in seen["text"]
    assert reason in seen["notice"]


def test_what_a_whole_browser_shows(chromium_gl, html):
    """The control of all others here: there the page draws and has its sliders."""
    open_page(chromium_gl, html)
    seen = call(chromium_gl, SEEN)
    assert seen["canvases"] == 1
    assert seen["sliders"] >= 4
    assert seen["notice"] == ""
    assert console(chromium_gl) is not None


NO_SOFTWARE = ("--disable-gpu", "--disable-software-rasterizer")


@pytest.mark.parametrize(
    "flags", [NO_SOFTWARE, pytest.param(("--disable-3d-apis",), marks=pytest.mark.slow)]
)
def test_no_webgl(html, flags):
    with chromium("--headless=new", *flags) as browser:
        open_page(browser, html)
        assert_only_stored(call(browser, SEEN), WORDS["unsupported.webgl"])
        console(browser)
        assert requests(browser) == []


def test_no_float_targets(chromium_gl, html):
    before_pages(chromium_gl, NO_FLOAT)
    open_page(chromium_gl, html)
    assert_only_stored(call(chromium_gl, SEEN), WORDS["unsupported.float"])
    console(chromium_gl)


def test_no_javascript(chromium_gl, html):
    """The line comes by the style alone, after the time that a script would need to remove it."""
    chromium_gl.emulated = True
    chromium_gl.cdp("Emulation.setScriptExecutionDisabled", value=True)
    open_page(chromium_gl, html, wait=False)
    end = time.monotonic() + LONGEST_S
    while not (seen := call(chromium_gl, SEEN))["notice"]:
        assert time.monotonic() < end, "no word of JavaScript"
        time.sleep(0.05)
    assert seen["state"] is None
    assert_only_stored(seen, WORDS["state.unchecked"])
    assert requests(chromium_gl) == []


def test_an_old_browser_that_can_not_inflate(chromium_gl, html):
    """A paper has no compressed arrays and is drawn all the same."""
    before_pages(chromium_gl, NO_INFLATION)
    open_page(chromium_gl, html)
    assert call(chromium_gl, "() => typeof DecompressionStream") == "undefined"
    assert call(chromium_gl, SEEN)["canvases"] == 1


def test_a_page_from_a_server(chromium_gl, html):
    """By http:// and a name, where browsers have no crypto.subtle; it draws all the same."""
    with listening({"/proof.html": html.encode()}) as server:
        open_page(chromium_gl, f"http://{ELSEWHERE}:{server.port}/proof.html")
        assert not call(chromium_gl, "() => isSecureContext || Boolean(crypto.subtle)")
        seen = call(chromium_gl, SEEN)
        assert (seen["canvases"], seen["notice"]) == (1, "")
        console(chromium_gl)
        assert requests(chromium_gl) == []
        assert server.paths == ["/proof.html"]


def test_a_second_tab(chromium_gl, html):
    """Two windows of one proof draw side by side; each has its own context."""
    address = open_page(chromium_gl, html)
    chromium_gl.driver.switch_to.new_window("tab")
    chromium_gl.driver.get(address)
    call(chromium_gl, "async () => await relgloss.ready")
    assert call(chromium_gl, SEEN)["canvases"] == 1
    first = chromium_gl.driver.window_handles[0]
    chromium_gl.driver.switch_to.window(first)
    assert call(chromium_gl, SEEN)["canvases"] == 1


def test_on_paper(chromium_gl, html, tmp_path):
    """What is printed is not empty: the words are there, and pictures."""
    open_page(chromium_gl, html)
    made = chromium_gl.cdp("Page.printToPDF", printBackground=True)
    path = tmp_path / "proof.pdf"
    path.write_bytes(base64.b64decode(made["data"]))
    command = ["gs", "-q", "-dSAFER", "-dBATCH", "-dNOPAUSE", "-sDEVICE=txtwrite", "-o", "-"]
    done = subprocess.run([*command, str(path)], capture_output=True, text=True, check=True)
    text = " ".join(done.stdout.split())
    assert NOTE in text
    assert WORDS["side.reference"] in text
    command = ["gs", "-q", "-dSAFER", "-dBATCH", "-dNOPAUSE", "-sDEVICE=inkcov", "-o", "-"]
    done = subprocess.run([*command, str(path)], capture_output=True, text=True, check=True)
    ink = [sum(float(word) for word in line.split()[:4]) for line in done.stdout.splitlines()]
    assert max(ink) > 0.1  # two pictures of paper before gray; words alone are 0.05 of a page
