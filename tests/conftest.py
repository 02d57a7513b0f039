"""Fixtures that every room's tests share. OpenGL errors and stray numpy warnings fail a test."""

from __future__ import annotations

import gc
import os
import signal
from collections.abc import Iterator

# A thread for each processor, in each of the processes of the tests, would wait for the others by
# spinning: a fit of small matrices then takes three times as long. Read when numpy is imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import hypothesis
import moderngl
import numpy as np
import pytest

from relgloss_view.base import decoration
from relgloss_view.picture.gpu.context import make_current, open_context
from relgloss_view.picture.gpu.programs import Programs
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.reference import ReferenceRenderer
from relgloss_view.quality.planner import MethodChooser

# How long an example takes says something of the machine, and nothing of the program.
hypothesis.settings.register_profile("relgloss", deadline=None)
hypothesis.settings.load_profile("relgloss")


# A shell ignores these for what it runs in the background, and so would every program that a test
# starts and interrupts: a program keeps what its parent ignores.
for _name in ("SIGINT", "SIGHUP"):
    if hasattr(signal, _name) and signal.getsignal(getattr(signal, _name)) == signal.SIG_IGN:
        signal.signal(
            getattr(signal, _name),
            signal.default_int_handler if _name == "SIGINT" else signal.SIG_DFL,
        )

# A decoration that fails is a warning for a user, and a failure for a test, in processes that the
# tests start too.
os.environ[decoration.VARIABLE] = decoration.RAISE


def pytest_collection(session: pytest.Session) -> None:
    """What collecting makes stays; to look for garbage in it takes a third of its time."""
    gc.disable()


def pytest_collection_finish(session: pytest.Session) -> None:
    """Tests collect their own garbage, without a look at what was there before them."""
    gc.freeze()
    gc.enable()


#: Compiled shaders that a process keeps from test to test, 1 to 3 MB each.
KEPT_PROGRAMS = 100


@pytest.fixture
def forgiving(monkeypatch: pytest.MonkeyPatch) -> None:
    """Decorations fail as they do for a user."""
    monkeypatch.delenv(decoration.VARIABLE)


@pytest.fixture(autouse=True)
def _numpy_faults() -> Iterator[None]:
    with np.errstate(divide="raise", over="raise", invalid="raise", under="ignore"):
        yield


@pytest.fixture(scope="session")
def _session_ctx() -> Iterator[moderngl.Context]:
    ctx = open_context("egl")
    yield ctx
    ctx.release()


@pytest.fixture
def ctx(_session_ctx: moderngl.Context) -> Iterator[moderngl.Context]:
    """The session's EGL context, held against GL errors before and after each test."""
    make_current(_session_ctx)
    assert _session_ctx.error == "GL_NO_ERROR", "a test before this one left a GL error"
    yield _session_ctx
    make_current(_session_ctx)  # whatever context the test itself used
    assert _session_ctx.error == "GL_NO_ERROR", "this test left a GL error"


@pytest.fixture(scope="session")
def _session_programs(_session_ctx: moderngl.Context) -> Programs:
    return Programs(_session_ctx, KEPT_PROGRAMS)


@pytest.fixture
def renderer(ctx: moderngl.Context, _session_programs: Programs) -> Iterator[Renderer]:
    """A new renderer; what it compiles is there for the tests after it."""
    made = Renderer(ctx, _session_programs, choose=MethodChooser().method)
    yield made
    made.release()


@pytest.fixture(scope="session")
def reference() -> ReferenceRenderer:
    return ReferenceRenderer()
