"""The profile of a monitor from Windows. Written from its manual, and never run: there was none.

Source: Microsoft, Windows GDI and WCS reference: MonitorFromRect, GetMonitorInfoW, CreateDCW,
GetICMProfileW.
"""

from __future__ import annotations

import ctypes
import os
import sys
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import read_bytes
from relgloss_view.display.system.answer import MOST_BYTES, Answer, Place, SystemProfile
from relgloss_view.display.system.asked import Asked

NEAREST = 2
LONGEST_PATH = 32768


class _Rect(ctypes.Structure):
    _fields_ = tuple((name, ctypes.c_long) for name in ("left", "top", "right", "bottom"))


class _MonitorInfo(ctypes.Structure):
    _fields_ = (
        ("size", ctypes.c_uint32),
        ("monitor", _Rect),
        ("work", _Rect),
        ("flags", ctypes.c_uint32),
        ("device", ctypes.c_wchar * 32),
    )


class WindowsScreens(Asked):
    """The monitors of Windows. Raises OSError elsewhere."""

    def __init__(self) -> None:
        super().__init__()
        self._user: Any
        self._gdi: Any
        if sys.platform != "win32":
            raise OSError("no Windows")
        library: Any = ctypes
        self._user, self._gdi = library.WinDLL("user32"), library.WinDLL("gdi32")
        handle = ctypes.c_void_p
        self._user.MonitorFromRect.restype = handle
        self._user.MonitorFromRect.argtypes = (handle, ctypes.c_uint32)
        self._user.GetMonitorInfoW.argtypes = (handle, handle)
        self._gdi.CreateDCW.restype = handle
        self._gdi.CreateDCW.argtypes = (ctypes.c_wchar_p, ctypes.c_wchar_p, handle, handle)
        self._gdi.GetICMProfileW.argtypes = (handle, handle, ctypes.c_wchar_p)
        self._gdi.DeleteDC.argtypes = (handle,)
        self._kept: tuple[str, tuple[int, int], Answer] | None = None

    def answer(self, place: Place | None) -> Answer:
        """The profile of the monitor at a place; its file is read again where it has changed."""
        file = self._file(place or Place(0, 0, 1, 1))
        if not file:
            return Answer()
        try:
            state = os.stat(file)
            stamp = state.st_mtime_ns, state.st_size
        except OSError:
            stamp = (0, 0)
        if self._kept is None or self._kept[:2] != (file, stamp):
            self._kept = file, stamp, _read(file)
        return self._kept[2]

    def _file(self, place: Place) -> str:
        """The file of a monitor's profile; empty where there is none."""
        rect = _Rect(place.left, place.top, place.left + place.width, place.top + place.height)
        monitor = self._user.MonitorFromRect(ctypes.byref(rect), NEAREST)
        info = _MonitorInfo(size=ctypes.sizeof(_MonitorInfo))
        if not monitor or not self._user.GetMonitorInfoW(monitor, ctypes.byref(info)):
            return ""
        context = self._gdi.CreateDCW(info.device, info.device, None, None)
        if not context:
            return ""
        try:
            length = ctypes.c_uint32(LONGEST_PATH)
            path = ctypes.create_unicode_buffer(LONGEST_PATH)
            found = self._gdi.GetICMProfileW(context, ctypes.byref(length), path)
            return path.value if found else ""
        finally:
            self._gdi.DeleteDC(context)


def _read(file: str) -> Answer:
    try:
        data = read_bytes(file, MOST_BYTES, "an ICC profile")
    except InputError as error:
        return Answer(None, f"Windows' profile: {error}", fault=True)
    return Answer(SystemProfile(data, os.path.basename(file), "Windows"))
