"""What a session keeps of the monitor that showed the pictures."""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass
from typing import Any

from imgui_bundle import hello_imgui  # first: it brings the GLFW that glfw finds; isort: skip
import glfw

from relgloss_view.base.errors import InputError
from relgloss_view.base.icc.header import parse_profile
from relgloss_view.base.reading import decoding, printable, read_bytes
from relgloss_view.viewer.shell.platform import monitor_of, pixel_pitch_m
from relgloss_view.viewer.shell.window import Window

MOST_BYTES = 16 * 1024 * 1024
EXPECTED = "the display's ICC profile (.icc or .icm)"
PLATFORMS = {
    "PLATFORM_WIN32": "Windows",
    "PLATFORM_COCOA": "macOS",
    "PLATFORM_WAYLAND": "Wayland",
    "PLATFORM_X11": "X11",
    "PLATFORM_NULL": "none",
}


@dataclass(frozen=True)
class Profile:
    """A display's ICC profile: what it says of itself, and the file."""

    description: str
    data: bytes


def read_profile(path: str | os.PathLike[str]) -> Profile:
    """The profile in a file; InputError where it is none, or not of a display in RGB."""
    data = read_bytes(path, MOST_BYTES, EXPECTED)
    with decoding(printable(path), EXPECTED):
        try:
            profile = parse_profile(data)
        except ValueError as error:
            raise InputError(f"{printable(path)}: {error}; give {EXPECTED}") from error
    space = profile.colour_space
    if space != "RGB":
        raise InputError(
            f"{printable(path)}: a profile of {printable(space, 20)}, expected RGB; give {EXPECTED}"
        )
    return Profile(printable(profile.description), data)


def full_screen(params: hello_imgui.RunnerParams) -> None:
    """Let a window fill its monitor, at the desktop's resolution; for Window's `tune`."""
    geometry = params.app_window_params.window_geometry
    geometry.full_screen_mode = hello_imgui.FullScreenMode.full_screen_desktop_resolution


def stay_open(window: Window) -> None:
    """Let a full screen stand when the experimenter clicks elsewhere, as on another monitor."""
    glfw.set_window_attrib(window.handle, glfw.AUTO_ICONIFY, glfw.FALSE)


def screen_of(window: Window, profile: Profile | None) -> dict[str, Any]:
    """Window, monitor and platform as they are now. What the window library can't tell is None."""
    handle = window.handle
    return {
        "window_px": [int(side) for side in glfw.get_framebuffer_size(handle)],
        "content_scale": [float(scale) for scale in glfw.get_window_content_scale(handle)],
        "full_screen": bool(glfw.get_window_monitor(handle)),
        "monitor": None if window.headless else _monitor(handle),
        "platform": sys.platform,
        "window_system": _window_system(),
        "profile": None if profile is None else profile.description,
    }


def _monitor(handle: Any) -> dict[str, Any] | None:
    monitor = monitor_of(handle)
    mode = None if monitor is None else glfw.get_video_mode(monitor)
    if mode is None:
        return None
    name = glfw.get_monitor_name(monitor)
    pitch_m = pixel_pitch_m(handle)
    return {
        "name": printable(name.decode("utf-8", "replace") if isinstance(name, bytes) else name),
        "resolution_px": [mode.size.width, mode.size.height],
        "refresh_hz": mode.refresh_rate or None,
        "bits": list(mode.bits),
        "size_mm": [side or None for side in glfw.get_monitor_physical_size(monitor)],
        "pixel_pitch_mm": None if pitch_m is None else 1e3 * pitch_m,
    }


def _window_system() -> str | None:
    present = glfw.get_platform()
    return next(
        (system for name, system in PLATFORMS.items() if getattr(glfw, name) == present), None
    )
