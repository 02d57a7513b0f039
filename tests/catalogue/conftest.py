"""One browser a worker process, started when a test first asks for it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from browsers import Browser, as_before, chromium

_started: list[Browser] = []


@pytest.fixture(scope="session")
def page_browser() -> Iterator[Browser]:
    """Chromium without a display; a catalogue's page draws nothing by WebGL."""
    with chromium("--headless=new", "--disable-gpu") as browser:
        _started.append(browser)
        yield browser
        _started.remove(browser)


@pytest.fixture(autouse=True)
def _page_browser_as_before() -> Iterator[None]:
    yield
    for browser in _started:
        as_before(browser)
