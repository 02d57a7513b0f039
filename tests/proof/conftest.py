"""One browser a worker process and lane, started when a test first asks for it."""

from __future__ import annotations

from collections.abc import Iterator

import other_engines
import pytest
from browsers import GL, SWIFTSHADER, Browser, as_before, chromium, screen

_started: list[Browser] = []


@pytest.fixture(scope="session")
def chromium_gl() -> Iterator[Browser]:
    """Chromium under Xvfb, on the OpenGL that the desktop's tests draw with (llvmpipe)."""
    with screen() as display, chromium(*GL, display=display, needs="llvmpipe") as browser:
        _started.append(browser)
        yield browser
        _started.remove(browser)


@pytest.fixture(scope="session")
def chromium_sw() -> Iterator[Browser]:
    """Chromium without a display, on SwiftShader: another driver than the desktop's."""
    with chromium(*SWIFTSHADER, needs="SwiftShader") as browser:
        _started.append(browser)
        yield browser
        _started.remove(browser)


@pytest.fixture(scope="session")
def other_screen() -> Iterator[str]:
    """The display of the other engines."""
    with screen() as display:
        yield display


@pytest.fixture(scope="session")
def firefox(other_screen: str) -> Iterator[other_engines.Firefox]:
    """Firefox, on llvmpipe."""
    with other_engines.firefox(other_screen) as browser:
        yield browser


@pytest.fixture(scope="session")
def webkit(other_screen: str) -> Iterator[other_engines.WebKit]:
    """WebKitGTK, on llvmpipe."""
    with other_engines.webkit(other_screen) as browser:
        yield browser


@pytest.fixture(autouse=True)
def _browsers_as_before() -> Iterator[None]:
    yield
    for browser in _started:
        as_before(browser)
