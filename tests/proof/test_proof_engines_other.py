"""The page in engines that are not Chromium's: Firefox and WebKitGTK."""

from __future__ import annotations

import pytest
from listening import listening
from test_proof_requests import POLICY, page_of_today

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
