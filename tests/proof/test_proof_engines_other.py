"""The page in engines that are not Chromium's: Firefox and WebKitGTK."""

from __future__ import annotations

import base64

import numpy as np
import pytest
from listening import listening
from opened_proofs import SEEN, SIZE, page_of, paper_proof
from test_proof_requests import POLICY, USE, page_of_today

from relgloss_view import cli
from relgloss_view.picture.scene.sample import SAMPLES
from relgloss_view.proof.read import read_proof
from relgloss_view.proof.settings import SIDES
from relgloss_view.proof.unpack import opened
from relgloss_view.quality.backends import open_renderer

PAGE = '<!DOCTYPE html>\n<html><head><meta charset="utf-8">{}<title>t</title></head><body>{}</body>'


@pytest.fixture(params=["firefox", "webkit"])
def engine(request):
    return request.getfixturevalue(request.param)


def test_calls(engine, tmp_path):
    """Under the page's own policy, which lets no other script run."""
    path = tmp_path / "page.html"
    path.write_text(PAGE.format(POLICY.search(page_of_today())[0], "hello"), encoding="utf-8")
    engine.open(path)
    assert engine.call("() => document.body.textContent") == "hello"
    assert engine.call("async (a, b) => a + b.x", 1, {"x": 2}) == 3
    assert engine.call("() => undefined") is None
    with pytest.raises(AssertionError, match="so it is"):
        engine.call("async () => { throw new RangeError('so it is'); }")


def test_firefox_logs_errors_and_requests(firefox, tmp_path):
    path = tmp_path / "page.html"
    with listening() as server:
        address = f"http://127.0.0.1:{server.port}/x"
        words = f"<img src='{address}'><script>throw new Error('planted')</script>"
        path.write_text(PAGE.format("", words), encoding="utf-8")
        firefox.open(path)
        assert firefox.requests() == [address]
        assert server.paths == ["/x"]
    assert any("planted" in line for line in firefox.errors())
    path.write_text(PAGE.format("", "quiet"), encoding="utf-8")
    firefox.open(path)
    assert (firefox.requests(), firefox.errors()) == ([], [])


DRAWN = """async (side, size) => {
  const engine = relgloss.engine;
  await engine.draw(relgloss.settings(), size);
  const { data } = await engine.pixels(side);
  let text = "";
  for (let at = 0; at < data.length; at += 32768)
    text += String.fromCharCode(...data.subarray(at, at + 32768));
  return btoa(text);
}"""


def drawn(engine, size):
    """Both pictures of the page that is open, 8 bits, (H, W, 3) by side."""
    pictures = {}
    for side in SIDES:
        data = np.frombuffer(base64.b64decode(engine.call(DRAWN, side, list(size))), np.uint8)
        pictures[side] = data.reshape(size[1], size[0], 4)[..., :3]
    return pictures


def open_proof(engine, path, proof):
    path.write_text(page_of(proof), encoding="utf-8", newline="\n")
    engine.open(path)
    engine.call("async () => { await relgloss.ready; }")


def desktop(proof, size):
    with open_renderer() as renderer, opened(proof) as one:
        return {side: part.rgb for side, part in one.pair().drawn(renderer, size).items()}


def assert_as_the_desktop(pages, window):
    """Every pixel the same: the engines draw by the machine's own OpenGL, as the desktop does.

    The control: pictures of the two sides, which have another gloss, are not the same.
    """
    for side in SIDES:
        assert np.array_equal(pages[side], window[side]), _worst(pages[side], window[side])
    assert not np.array_equal(window["reference"], window["test"])


def _worst(one, other):
    difference = np.abs(one.astype(int) - other.astype(int)).max(axis=-1)
    return f"{np.count_nonzero(difference)} of {difference.size} pixels, by {difference.max()}"


def test_the_pictures_are_the_desktops(engine, paper, tmp_path):
    open_proof(engine, tmp_path / "proof.html", paper)
    seen = engine.call(SEEN)
    assert (seen["canvases"], seen["notice"]) == (1, "")
    assert_as_the_desktop(drawn(engine, SIZE), desktop(paper, SIZE))


@pytest.mark.slow
@pytest.mark.parametrize("sample", SAMPLES)
def test_the_four_papers_are_the_desktops(engine, sample, tmp_path):
    size = (320, 240)
    proof = paper_proof(sample, size)
    open_proof(engine, tmp_path / "proof.html", proof)
    assert_as_the_desktop(drawn(engine, size), desktop(proof, size))


@pytest.mark.slow
@pytest.mark.parametrize("pack", ["can", "carton"])
def test_packs_are_the_desktops(engine, pack, tmp_path):
    """With artwork and finishes, as the command makes them."""
    path = tmp_path / f"{pack}.html"
    assert cli.main(["proof", "make", pack, "-o", str(path), "--artwork-px", "512"]) == 0
    proof = read_proof(path)
    engine.open(path)
    engine.call("async () => { await relgloss.ready; }")
    size = (320, 240)
    assert_as_the_desktop(drawn(engine, size), desktop(proof, size))


@pytest.mark.slow
def test_firefox_asks_for_nothing(firefox, paper, tmp_path):
    open_proof(firefox, tmp_path / "proof.html", paper)
    assert firefox.call(USE, 1) > 20
    assert firefox.errors() == []
    assert firefox.requests() == []
