"""One browser a worker process and lane, started when a test first asks for it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import other_engines
import pytest
from browsers import GL, SWIFTSHADER, Browser, as_before, chromium, open_page, screen
from opened_proofs import paper_proof
from page_samples import sample_page

from relgloss_view.proof.proof import Proof

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


@pytest.fixture(scope="session")
def paper() -> Proof:
    """A proof of matte-coated paper beside the reference, small."""
    return paper_proof()


@pytest.fixture(autouse=True)
def _browsers_as_before() -> Iterator[None]:
    yield
    for browser in _started:
        as_before(browser)


@pytest.fixture
def sample_in_page(chromium_gl: Browser, tmp_path: Path) -> Browser:
    """Chromium with a small proof opened and drawn."""
    open_page(chromium_gl, sample_page(tmp_path / "proof.html"))
    return chromium_gl
