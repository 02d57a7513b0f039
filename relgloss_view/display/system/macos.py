"""The profile of a monitor from macOS. Written from its manual, and never run: there was none.

Source: Apple, Quartz Display Services (CGGetDisplaysWithPoint, CGDisplayCopyColorSpace),
CGColorSpace (CGColorSpaceCopyICCData), Core Foundation (CFData).
"""

from __future__ import annotations

import ctypes
import sys
from typing import Any

from relgloss_view.display.system.answer import MOST_BYTES, Answer, Place, SystemProfile
from relgloss_view.display.system.asked import Asked

FRAMEWORKS = "/System/Library/Frameworks"


class _Point(ctypes.Structure):
    _fields_ = (("x", ctypes.c_double), ("y", ctypes.c_double))


class MacScreens(Asked):
    """The monitors of macOS. Raises OSError elsewhere."""

    def __init__(self) -> None:
        super().__init__()
        self._graphics: Any
        self._base: Any
        if sys.platform != "darwin":
            raise OSError("no macOS")
        self._graphics = ctypes.CDLL(f"{FRAMEWORKS}/CoreGraphics.framework/CoreGraphics")
        self._base = ctypes.CDLL(f"{FRAMEWORKS}/CoreFoundation.framework/CoreFoundation")
        pointer, number = ctypes.c_void_p, ctypes.c_uint32
        self._graphics.CGMainDisplayID.restype = number
        self._graphics.CGGetDisplaysWithPoint.argtypes = (_Point, number, pointer, pointer)
        self._graphics.CGDisplayCopyColorSpace.restype = pointer
        self._graphics.CGDisplayCopyColorSpace.argtypes = (number,)
        self._graphics.CGColorSpaceCopyICCData.restype = pointer
        self._graphics.CGColorSpaceCopyICCData.argtypes = (pointer,)
        self._base.CFDataGetLength.restype = ctypes.c_long
        self._base.CFDataGetLength.argtypes = (pointer,)
        self._base.CFDataGetBytePtr.restype = pointer
        self._base.CFDataGetBytePtr.argtypes = (pointer,)
        self._base.CFRelease.argtypes = (pointer,)

    def answer(self, place: Place | None) -> Answer:
        """The profile of the monitor at a place; of the main one where the place is None."""
        space = self._graphics.CGDisplayCopyColorSpace(self._display(place))
        if not space:
            return Answer()
        data = self._graphics.CGColorSpaceCopyICCData(space)
        self._base.CFRelease(space)
        if not data:
            return Answer()
        try:
            length = self._base.CFDataGetLength(data)
            if length > MOST_BYTES:
                reason = f"macOS' profile is larger than {MOST_BYTES} bytes"
                return Answer(None, reason, fault=True)
            content = ctypes.string_at(self._base.CFDataGetBytePtr(data), length)
            return Answer(SystemProfile(content, "", "macOS"))
        finally:
            self._base.CFRelease(data)

    def _display(self, place: Place | None) -> int:
        if place is not None:
            centre = _Point(place.left + 0.5 * place.width, place.top + 0.5 * place.height)
            found, count = ctypes.c_uint32(), ctypes.c_uint32()
            failed = self._graphics.CGGetDisplaysWithPoint(
                centre, 1, ctypes.byref(found), ctypes.byref(count)
            )
            if not failed and count.value:
                return found.value
        return int(self._graphics.CGMainDisplayID())
