"""The window: one OpenGL context, one loop that draws only when something happened.

With a display it is a real window; without one it is the same program on GLFW's null platform,
where nothing is seen but everything is drawn: for screenshots and tests.
"""

from __future__ import annotations

import contextlib
import ctypes
import sys
import time
from collections.abc import Callable
from typing import Any, Protocol

from relgloss_view.base.allocator import keep_large_apart
from relgloss_view.base.arrays import Array, Bytes, Rgb
from relgloss_view.base.interruptions import SIGNALS, checkpoint, uninterrupted

# imgui_bundle first: it brings the GLFW that the glfw module then finds, so that both use one.
from imgui_bundle import hello_imgui, imgui, immapp  # isort: skip
import glfw
import numpy as np

from relgloss_view.display.system.answer import Place
from relgloss_view.picture.gpu.context import (
    Blitter,
    Offscreen,
    attach,
    copied_pixels,
    texture_probe,
)
from relgloss_view.viewer.drawing.canvas import Canvas
from relgloss_view.viewer.shell import clicks, keyboard, theme
from relgloss_view.viewer.shell.platform import (
    gamma_ramp,
    held_size,
    load,
    monitor_place,
    no_window,
    open_platform,
    pixel_pitch_m,
    quiet_errors,
    system_name,
    terminating,
)

TITLE = "relgloss"
#: After an event: frames at once, for the interface to settle, then some for tooltips, then none.
SETTLING_FRAMES = 4
TOOLTIP_S, TOOLTIP_STEP_S = 1.2, 0.1
CURSOR_STEP_S = 0.4  #: while a text is being typed
LONGEST_WAIT_S = 0.5  #: a signal, such as Ctrl-C, is noticed between waits
NULL_STEP_S = 0.01  #: the null platform has no events to wait for


class Program(Protocol):
    """A program that a window runs."""

    def start(self, ctx: Any, window: Window) -> None:
        """The context is there; called once, before the first frame."""

    def frame(self) -> None:
        """Build the interface and draw the pictures."""

    def after_frame(self, frame_s: float) -> bool:
        """Called after each frame with the time it took; whether another is needed at once."""

    def wait_s(self) -> float | None:
        """How long nothing needs to be drawn if no event comes; None for as long as it likes."""

    def dropped(self, paths: list[str]) -> None:
        """Files were dropped on the window."""

    def finish(self) -> None:
        """The context is about to go."""


class Window:
    """Runs a program until it or its user ends it."""

    def __init__(
        self,
        program: Program,
        size: tuple[int, int] = (1280, 800),
        *,
        headless: bool = False,
        font_scale: float = 1.0,
        tune: Callable[[hello_imgui.RunnerParams], None] | None = None,
    ) -> None:
        """size: in pixels, held to what can be drawn. tune: a last word on the parameters."""
        self.program = program
        self.size = held_size(size)
        self.headless = headless
        self.font_scale = font_scale
        self._tune = tune
        #: The canvas below the interface, and the surround's digital values. It is cleared and
        #: copied: to blend it as the interface does takes a software driver several times as long.
        self.canvas = Canvas()
        self.surround: Rgb = (0.0, 0.0, 0.0)
        #: Called when all but the interface is painted: `pixels` then reads the canvas.
        self.below: Callable[[], None] | None = None
        self._ctx: Any = None
        self._blitter: Blitter | None = None
        self._keyboard: keyboard.Keyboard | None = None
        self._mouse = clicks.Mouse()
        #: Whether the device still knows a texture by this name.
        self.is_texture: Callable[[int], bool] = lambda name: True
        self.handle: Any = None  #: of GLFW
        self._screen: Any = None  #: the surface that the interface is drawn on
        self._drawn = 0
        self._awake_until = 0.0
        self._settling = SETTLING_FRAMES
        self._started = False
        self._error: BaseException | None = None

    def run(self, frames: int | None = None) -> Bytes:
        """Draw so many frames, or until the window is closed; returns the last one, (H, W, 3).

        A signal closes the window between two frames; the caller's next checkpoint raises it.
        Raises GLUnavailableError where no window can be opened.
        """
        checkpoint()
        with uninterrupted(may_leave=True):
            return self._run(frames)

    def _run(self, frames: int | None) -> Bytes:
        keep_large_apart()
        open_platform(self.headless)
        params = self._params()
        try:
            with quiet_errors() as messages:
                immapp.manual_render.setup_from_runner_params(
                    params, immapp.AddOnsParams(with_implot=True)
                )
        except (RuntimeError, SystemError) as error:
            raise no_window(messages, self.headless) from error
        try:
            with terminating(self.close):
                self._loop(params, frames)
        except BaseException as error:
            # After an error the interface asserts that what it cut short was not finished: the
            # first one is the cause.
            self._error = self._error or error
        finally:
            if self._started:
                self.program.finish()
                self.to_screen()  # the last picture of the window is read from it
            with contextlib.suppress(*((RuntimeError,) if self._error is not None else ())):
                immapp.manual_render.tear_down()
        if self._error is not None:
            raise self._error
        if not self._started:  # a signal has come first
            return np.zeros((0, 0, 3), np.uint8)
        return np.asarray(hello_imgui.final_app_window_screenshot())

    def to_screen(self) -> None:
        """Direct drawing to the window again after pictures were drawn."""
        self._screen.use()

    def pixels(self, left: int, top: int, width: int, height: int) -> Bytes:
        """What a box of the window shows now, (H, W, 3); its place from the upper left corner."""
        bottom = self.size_now()[1] - top - height
        box = (left, bottom, left + width, bottom + height)
        assert self._blitter is not None
        return copied_pixels(self._ctx, self._blitter, self._screen.glo, box)

    def close(self) -> None:
        """End the loop after this frame."""
        hello_imgui.get_runner_params().app_shall_exit = True

    def wake(self) -> None:
        """Have a frame drawn soon; may be called from any thread."""
        self._settling = max(self._settling, 1)
        if not self.headless:
            glfw.post_empty_event()

    def size_now(self) -> tuple[int, int]:
        """Width and height of the window, pixels."""
        size = imgui.get_io().display_size
        return int(size.x), int(size.y)

    def set_font_scale(self, scale: float) -> None:
        """Show text, and all that is measured by it, at another size."""
        style = imgui.get_style()
        style.font_scale_main = scale
        theme.apply(scale)
        self.font_scale = scale

    def pixel_pitch_m(self) -> float | None:
        """Size of a pixel of the monitor that the window is on, as the monitor reports it."""
        if self.headless:
            return None
        return pixel_pitch_m(self.handle)

    @property
    def system(self) -> str:
        """The window system; "null" where there is no display."""
        return "null" if self.headless else system_name()

    def monitor_place(self) -> Place | None:
        """Where the monitor lies that the window is on."""
        return None if self.headless else monitor_place(self.handle)

    def gamma_ramp(self) -> Array | None:
        """The graphics card's curves of that monitor, 0 to 1, (3, n)."""
        return None if self.headless else gamma_ramp(self.handle)

    def _loop(self, params: hello_imgui.RunnerParams, frames: int | None) -> None:
        while not (params.app_shall_exit or self._error is not None or SIGNALS.noted):
            if frames is not None and self._drawn >= frames:
                break
            if frames is None and not self._wait():
                continue
            began = time.perf_counter()
            immapp.manual_render.render()
            if self._started and self._error is None:
                again = self.program.after_frame(time.perf_counter() - began)
                self._settling = max(self._settling - 1, int(again))
            if self._keyboard is not None and self._keyboard.next_frame():
                self._settling = SETTLING_FRAMES
            self._mouse.end_frame()
            self._drawn += 1

    def _wait(self) -> bool:
        """Sleep for a while, or until something happens; returns whether a frame is needed."""
        if self._settling > 0:
            return True
        now = time.monotonic()
        needed_in = [self.program.wait_s()]
        if now < self._awake_until:
            needed_in.append(TOOLTIP_STEP_S)
        if imgui.get_io().want_text_input:
            needed_in.append(CURSOR_STEP_S)
        due = min((max(wait, 1e-3) for wait in needed_in if wait is not None), default=None)
        limit = LONGEST_WAIT_S if due is None else min(due, LONGEST_WAIT_S)
        if self.headless:
            time.sleep(min(limit, NULL_STEP_S))
            return True
        with self._mouse.waiting():
            glfw.wait_events_timeout(limit)
        if time.monotonic() - now < 0.98 * limit:  # an event ended the wait
            self._settling = SETTLING_FRAMES
            self._awake_until = time.monotonic() + TOOLTIP_S
            return True
        return due is not None and due <= limit

    def _params(self) -> hello_imgui.RunnerParams:
        params = hello_imgui.RunnerParams()
        params.app_window_params.window_title = TITLE
        geometry = params.app_window_params.window_geometry
        geometry.size = self.size
        geometry.window_size_measure_mode = hello_imgui.WindowSizeMeasureMode.screen_coords
        params.imgui_window_params.default_imgui_window_type = (
            hello_imgui.DefaultImGuiWindowType.no_default_window
        )
        params.imgui_window_params.background_color = theme.gray(theme.PANEL)
        params.ini_disable = True  # the program keeps its own, never in the working directory
        params.fps_idling.enable_idling = False
        params.fps_idling.vsync_to_monitor = not self.headless
        options = params.renderer_backend_options.open_gl_options
        options.major_version, options.minor_version = 3, 3
        options.glsl_version = "330"
        options.use_core_profile = True
        options.use_forward_compat = sys.platform == "darwin"
        options.anti_aliasing_samples = 0  # the interface smooths its own lines
        callbacks = params.callbacks
        callbacks.load_additional_fonts = self._load_font
        callbacks.setup_imgui_style = lambda: theme.apply(self.font_scale)
        callbacks.post_init = self._start
        callbacks.show_gui = self._frame
        callbacks.before_imgui_render = lambda: self._guarded(self._fill)
        if self._tune is not None:
            self._tune(params)
        return params

    def _load_font(self) -> None:
        self._guarded(theme.load_fonts)

    def _start(self) -> None:
        self._guarded(self._attach)

    def _attach(self) -> None:
        self.set_font_scale(self.font_scale)
        library: Any = hello_imgui  # its annotations leave the address out
        address = library.get_glfw_window_address()
        handle = ctypes.cast(address, ctypes.POINTER(glfw._GLFWwindow))
        self.handle = handle
        if self.headless:  # the library holds windows to the size of a monitor, which is not there
            glfw.set_window_size(handle, *self.size)
        on_drop: Any = lambda _, paths: self._dropped(list(paths))  # noqa: E731 - annotated wrongly
        glfw.set_drop_callback(handle, on_drop)
        self._keyboard = keyboard.listen(handle, address)
        self._mouse = clicks.listen(handle, address)
        ctx = self._ctx = attach(load)
        self.is_texture = texture_probe(load)
        self._screen = Offscreen(ctx) if self.headless else ctx.screen
        self._blitter = Blitter(load)
        self._fit_screen()
        if not SIGNALS.noted:
            self.program.start(ctx, self)
            self._started = True

    def _dropped(self, paths: list[str]) -> None:
        self._guarded(lambda: self.program.dropped(paths))

    def _frame(self) -> None:
        if self._started and self._error is None:
            self._mouse.begin_frame()
            self._fit_screen()
            self._guarded(self.program.frame)

    def _fit_screen(self) -> None:
        """Where there is no display, give the surface the window's size: its own may be smaller."""
        if self.headless and self._screen.resize(self.size_now()):
            self._screen.clear(theme.PANEL, theme.PANEL, theme.PANEL, 1.0)

    def _fill(self) -> None:
        height = self.size_now()[1]
        for left, top, width, tall in self.canvas.surround:
            if width > 0 and tall > 0:
                place = left, height - top - tall, width, tall
                self._screen.clear(*self.surround, 1.0, viewport=place)
        assert self._blitter is not None
        for copy in self.canvas.copies:
            left, top, width, tall = copy.place
            place = (left, height - top - tall, left + width, height - top)
            self._blitter.copy(
                copy.framebuffer, copy.box, self._screen.glo, place, smooth=copy.scaled
            )
        self.to_screen()
        self.canvas = Canvas()
        if self.below is not None:
            self.below()
            self.to_screen()

    def _guarded(self, action: Callable[[], None]) -> None:
        """An exception must not pass through the window library; the loop raises it instead."""
        try:
            action()
        except BaseException as error:
            self._error = error
