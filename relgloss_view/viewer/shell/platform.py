"""The platform below the window: a display, or none; what ends the program from outside."""

from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any

import imgui_bundle  # noqa: F401 - brings the GLFW that the glfw module then finds; isort: skip
import glfw
import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import GLUnavailableError
from relgloss_view.base.interruptions import SIGNALS
from relgloss_view.base.temporaries import scratch_file
from relgloss_view.display.system.answer import Place
from relgloss_view.picture.gpu import probe
from relgloss_view.picture.gpu.context import REMEDY as NO_GL_REMEDY

SMALLEST_PX, LARGEST_PX = 1, 8192
MOST_PIXELS = 16 * 1024 * 1024  #: two pictures and a window of so many take about 1 GB

CLOSING = ("SIGTERM", "SIGHUP")  #: by which a system or a closed terminal ends programs
REMEDY = (
    "start it on a desktop or over `ssh -X`, or draw without a display: "
    "`relgloss view --screenshot OUT.png`, `relgloss snapshot -o OUT.png`"
)


@contextlib.contextmanager
def terminating(close: Callable[[], None]) -> Iterator[None]:
    """Let the request to terminate close the window as its user would, so that all is kept.

    The command itself has handlers, and the window asks them.
    """
    if SIGNALS.caught or threading.current_thread() is not threading.main_thread():
        yield
        return
    numbers = [getattr(signal, name) for name in CLOSING if hasattr(signal, name)]
    # One that is ignored, as under nohup, stays so.
    numbers = [number for number in numbers if signal.getsignal(number) != signal.SIG_IGN]
    before = {number: signal.signal(number, lambda *_: close()) for number in numbers}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextlib.contextmanager
def quiet_errors() -> Iterator[list[str]]:
    """Catch what libraries below Python print on standard error; the list holds it afterwards."""
    messages: list[str] = []
    try:
        kept = os.dup(2)
    except OSError:  # closed: nothing can be printed there
        yield messages
        return
    with scratch_file() as caught:
        os.dup2(caught.fileno(), 2)
        try:
            yield messages
        finally:
            os.dup2(kept, 2)
            os.close(kept)
            caught.seek(0)
            messages.extend(caught.read().decode("utf-8", "replace").splitlines())


def no_window(messages: list[str], headless: bool) -> GLUnavailableError:
    """The fault of a window that could not be opened, by the libraries' messages."""
    reasons = "; ".join(dict.fromkeys(line.strip() for line in messages if "Glfw Error" in line))
    remedy = NO_GL_REMEDY if headless else f"{NO_GL_REMEDY}; or {REMEDY}"
    return GLUnavailableError(
        f"no window with OpenGL 3.3 ({reasons or 'no reason given'}); {remedy}"
    )


def check_display() -> None:
    """Raises GLUnavailableError where no window can show, before anything long is done."""
    named = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if sys.platform.startswith("linux") and not named:
        raise GLUnavailableError(f"there is no display; {REMEDY}")


def open_platform(headless: bool) -> None:
    """Start GLFW on a display, or on its null platform, with the hints of the next window."""
    if not headless:
        check_display()
    probe.check("egl")
    faults: list[str] = []
    on_error: Any = lambda code, text: faults.append(_text(text))  # noqa: E731
    glfw.set_error_callback(on_error)
    platform = glfw.PLATFORM_NULL if headless else glfw.ANY_PLATFORM
    glfw.init_hint(glfw.PLATFORM, platform)
    if not glfw.init():
        raise GLUnavailableError(f"no window can be opened: {'; '.join(faults)}; {REMEDY}")
    glfw.default_window_hints()
    if headless:
        glfw.window_hint(glfw.CONTEXT_CREATION_API, glfw.EGL_CONTEXT_API)


def _text(words: bytes | str) -> str:
    return words.decode("utf-8", "replace") if isinstance(words, bytes) else words


def load(name: str) -> int:
    """Address of an OpenGL function."""
    return ctypes.cast(glfw.get_proc_address(name), ctypes.c_void_p).value or 0


def pixel_pitch_m(window: Any) -> float | None:
    """Size of a pixel of the monitor that shows most of a window, as the monitor reports it."""
    monitor = monitor_of(window)
    if monitor is None:
        return None
    mode = glfw.get_video_mode(monitor)
    width_mm, _ = glfw.get_monitor_physical_size(monitor)
    if mode is None or width_mm <= 0:
        return None
    return 1e-3 * width_mm / float(mode.size.width)


def system_name() -> str:
    """The window system below GLFW, as display.system names it; "null" without one."""
    names = {
        glfw.PLATFORM_X11: "x11",
        glfw.PLATFORM_WAYLAND: "wayland",
        glfw.PLATFORM_WIN32: "win32",
        glfw.PLATFORM_COCOA: "cocoa",
    }
    return names.get(glfw.get_platform(), "null")


def monitor_place(window: Any) -> Place | None:
    """Where the monitor lies that shows most of a window; None where there is none."""
    monitor = monitor_of(window)
    mode = None if monitor is None else glfw.get_video_mode(monitor)
    if mode is None:
        return None
    return Place(*glfw.get_monitor_pos(monitor), mode.size.width, mode.size.height)


def gamma_ramp(window: Any) -> Array | None:
    """The graphics card's curves of the monitor that shows most of a window, 0 to 1, (3, n)."""
    monitor = monitor_of(window)
    ramp: Any = None if monitor is None else glfw.get_gamma_ramp(monitor)
    if ramp is None or len(ramp.red) < 2:
        return None
    return np.array([ramp.red, ramp.green, ramp.blue], dtype=np.float64)


def held_size(size: tuple[int, int]) -> tuple[int, int]:
    """The size of a window that can be drawn, nearest to the one that is asked for."""
    width, height = (int(np.clip(side, SMALLEST_PX, LARGEST_PX)) for side in size)
    excess = width * height / MOST_PIXELS
    if excess > 1.0:
        width, height = int(width / excess**0.5), int(height / excess**0.5)
    return width, height


def monitor_of(window: Any) -> Any:
    """The monitor that shows most of a window; None where there is none."""
    place, size = glfw.get_window_pos(window), glfw.get_window_size(window)

    def shared(monitor: Any) -> int:
        mode = glfw.get_video_mode(monitor)
        if mode is None:
            return 0
        left, top = glfw.get_monitor_pos(monitor)
        right = min(left + mode.size.width, place[0] + size[0])
        bottom = min(top + mode.size.height, place[1] + size[1])
        return max(right - max(left, place[0]), 0) * max(bottom - max(top, place[1]), 0)

    return max(glfw.get_monitors() or [], key=shared, default=None)
