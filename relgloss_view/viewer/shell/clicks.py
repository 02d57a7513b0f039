"""Double clicks by the times at which a hand has clicked, however long frames take.

The interface measures from frame to frame, and gives each press and each release a frame of its
own: where frames take 150 ms, two clicks 200 ms apart reach it 300 ms apart, and are two single
ones. Here a press has the time at which it was noticed, and the time at which nothing had been
pressed yet. Two presses are a double click where they can have come within DOUBLE_CLICK_S. The
interface then takes this answer for the frame in which it takes the press.
"""

from __future__ import annotations

import contextlib
import time
from collections import deque
from collections.abc import Iterator
from typing import Any

import imgui_bundle  # noqa: F401 - brings the GLFW that the glfw module then finds; isort: skip
import glfw
from imgui_bundle import imgui

DOUBLE_CLICK_S = 0.30  #: between two presses; the interface's own limit
#: An event that ends a wait sooner may have come before it, while a frame was drawn.
QUEUED_S = 0.002
ALWAYS_S, NEVER_S = 1e6, 0.0  #: limits by which the interface takes a press as we do
BUTTONS = 5


class Clicks:
    """Notes the presses of a mouse's buttons, and which of them end a double click."""

    def __init__(self) -> None:
        #: Of each button: whether the presses that no frame has taken yet follow another quickly.
        self._coming: dict[int, deque[bool]] = {}
        self._last_s: dict[int, float] = {}
        self._looked_s = -ALWAYS_S
        self._waits_since_s: float | None = None

    def looked(self, now_s: float) -> None:
        """All events until now have been noticed."""
        self._looked_s, self._waits_since_s = now_s, None

    def wait(self, now_s: float) -> None:
        """From now on an event is noticed when it comes."""
        self._waits_since_s = now_s

    def press(self, button: int, now_s: float) -> None:
        """A button went down, and was noticed now."""
        waits_s = self._waits_since_s
        exact = waits_s is not None and now_s - waits_s > QUEUED_S
        earliest_s = now_s if exact else min(self._looked_s, now_s)
        last_s = self._last_s.get(button)
        quick = last_s is not None and earliest_s - last_s < DOUBLE_CLICK_S
        self._last_s[button] = now_s
        self._coming.setdefault(button, deque()).append(quick)

    def take(self, button: int) -> None:
        """A frame has taken the next press of a button."""
        if self._coming.get(button):
            self._coming[button].popleft()

    @property
    def limit_s(self) -> float | None:
        """The limit for the next frame; None for the interface's own, where no press is coming."""
        heads = [coming[0] for coming in self._coming.values() if coming]
        if not heads:
            return None
        return ALWAYS_S if any(heads) else NEVER_S


class Mouse:
    """Clicks between GLFW's window and the interface."""

    def __init__(self) -> None:
        self.clicks = Clicks()
        #: The interface's own limits, for two clicks and for one, while others hold.
        self._usual_s: tuple[float, float] | None = None

    @contextlib.contextmanager
    def waiting(self) -> Iterator[None]:
        """For the length of a block that waits for events."""
        self.clicks.wait(time.monotonic())
        yield
        self.clicks.looked(time.monotonic())

    def begin_frame(self) -> None:
        """The interface has taken the events of a frame."""
        self.clicks.looked(time.monotonic())
        io = imgui.get_io()
        for button in range(BUTTONS):
            if io.mouse_clicked[button]:
                self.clicks.take(button)
        if self._usual_s is not None:
            io.mouse_double_click_time, io.mouse_single_click_delay = self._usual_s
            self._usual_s = None

    def end_frame(self) -> None:
        """The frame is over: what it has not taken is for the next one."""
        self._set_limit()

    def press(self, button: int) -> None:
        """A button went down."""
        self.clicks.press(button, time.monotonic())
        self._set_limit()

    def _set_limit(self) -> None:
        limit_s, io = self.clicks.limit_s, imgui.get_io()
        if limit_s is None:
            return
        if self._usual_s is None:
            self._usual_s = io.mouse_double_click_time, io.mouse_single_click_delay
        # The interface asserts that the delay of a single click is longer.
        io.mouse_double_click_time, io.mouse_single_click_delay = limit_s, limit_s + 1.0


def listen(window: Any, address: int) -> Mouse:
    """Put a mouse between GLFW's window and the interface, whose callback it replaces."""
    backend: Any = imgui.backends
    mouse = Mouse()

    def on_button(_: Any, button: int, action: int, mods: int) -> None:
        backend.glfw_mouse_button_callback(address, button, action, mods)
        if action == glfw.PRESS and button < BUTTONS:
            mouse.press(button)

    callback: Any = on_button  # annotated wrongly
    glfw.set_mouse_button_callback(window, callback)
    return mouse
