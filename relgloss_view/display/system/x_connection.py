"""A connection to an X server of its own, by libxcb alone.

libX11 ends the program where a request fails or the server goes; libxcb returns both as values.
So requests are written here byte by byte, as the protocol has them, in this machine's byte order.

Source: X Window System Protocol, X Version 11 (Scheifler 2004), appendix B.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import os
import select
import struct
from typing import Any

LIBRARIES = ("libxcb.so.1", "xcb")
CHECKED = 1  #: an error comes in place of the reply, not as an event
MOST_EVENTS = 10_000  #: that are read at once
CHANGE_ATTRIBUTES, INTERN_ATOM, GET_PROPERTY, QUERY_EXTENSION = 2, 16, 20, 98
EVENT_MASK, PROPERTY_CHANGES = 1 << 11, 1 << 22
PROPERTY_NOTIFY = 28


class _Part(ctypes.Structure):
    _fields_ = (("base", ctypes.c_void_p), ("length", ctypes.c_size_t))


class _Request(ctypes.Structure):
    _fields_ = (
        ("count", ctypes.c_size_t),
        ("extension", ctypes.c_void_p),
        ("opcode", ctypes.c_uint8),
        ("isvoid", ctypes.c_uint8),
    )


class _Roots(ctypes.Structure):
    _fields_ = (("data", ctypes.c_void_p), ("rem", ctypes.c_int), ("index", ctypes.c_int))


class Connection:
    """Requests and events of a display, by default the one that DISPLAY names.

    OSError where there is none.
    """

    def __init__(self, display: str | None = None) -> None:
        self._xcb = _library()
        number = ctypes.c_int()
        self._c = self._xcb.xcb_connect(display and display.encode(), ctypes.byref(number))
        if self._xcb.xcb_connection_has_error(self._c):
            self._xcb.xcb_disconnect(self._c)
            raise OSError("no X server can be reached")
        self.root = self._root_of(number.value)
        self._atoms: dict[str, int] = {}
        reading, self._rousing = os.pipe()
        os.set_blocking(self._rousing, False)
        self._roused = reading
        self._poll = select.poll()
        self._poll.register(reading, select.POLLIN)
        self._poll.register(self._xcb.xcb_get_file_descriptor(self._c), select.POLLIN)

    @property
    def gone(self) -> bool:
        """Whether the server has gone away."""
        return bool(self._xcb.xcb_connection_has_error(self._c))

    def reply(self, opcode: int, minor: int, body: bytes = b"") -> bytes | None:
        """The server's reply to a request; None for an error, or where the server is gone.

        opcode: of a core request, or an extension's. minor: the second byte. body: what follows the
        length, a multiple of four bytes.
        """
        sequence = self._send(opcode, minor, body, isvoid=False)
        error = ctypes.c_void_p()
        found = self._xcb.xcb_wait_for_reply(self._c, sequence, ctypes.byref(error))
        if error.value:
            _free(error.value)
        if not found:
            return None
        try:
            more: int = struct.unpack("=I", ctypes.string_at(found + 4, 4))[0]
            return ctypes.string_at(found, 32 + 4 * more)
        finally:
            _free(found)

    def send(self, opcode: int, minor: int, body: bytes) -> None:
        """Send a request that has no reply; its failure is no event that anybody waits for."""
        self._send(opcode, minor, body, isvoid=True)
        self._xcb.xcb_flush(self._c)

    def atom(self, name: str) -> int:
        """The number of a name, which is made where there is none; 0 where that fails."""
        if name not in self._atoms:
            text = name.encode("ascii")
            body = struct.pack("=HH", len(text), 0) + text + bytes(-len(text) % 4)
            found = self.reply(INTERN_ATOM, 0, body)
            self._atoms[name] = 0 if found is None else struct.unpack_from("=I", found, 8)[0]
        return self._atoms[name]

    def extension(self, name: str) -> tuple[int, int]:
        """Opcode and first event of an extension; zeros where the server has none."""
        text = name.encode("ascii")
        body = struct.pack("=HH", len(text), 0) + text + bytes(-len(text) % 4)
        found = self.reply(QUERY_EXTENSION, 0, body)
        if found is None or not found[8]:
            return 0, 0
        return found[9], found[10]

    def property_of_root(self, atom: int, most_bytes: int) -> tuple[bytes, int, int] | None:
        """Value, bits of its items, bytes beyond `most_bytes`; None without the property."""
        body = struct.pack("=5I", self.root, atom, 0, 0, most_bytes // 4)
        return value_of(self.reply(GET_PROPERTY, 0, body))

    def watch_root(self) -> None:
        """Have an event for each property of the root window that changes."""
        body = struct.pack("=3I", self.root, EVENT_MASK, PROPERTY_CHANGES)
        self.send(CHANGE_ATTRIBUTES, 0, body)

    def events(self) -> list[bytes]:
        """The events that have come, 32 bytes each."""
        events = []
        for _ in range(MOST_EVENTS):
            found = self._xcb.xcb_poll_for_event(self._c)
            if not found:
                break
            events.append(ctypes.string_at(found, 32))
            _free(found)
        return events

    def wait(self, longest_s: float) -> None:
        """Sleep until something comes, or `rouse` is called."""
        ready = self._poll.poll(1e3 * longest_s)
        if any(place == self._roused for place, _ in ready):
            os.read(self._roused, 4096)

    def rouse(self) -> None:
        """End a wait now; from any thread."""
        try:
            os.write(self._rousing, b"!")
        except OSError:  # it is full, so that nobody sleeps
            return

    def close(self) -> None:
        """Leave the server."""
        self._xcb.xcb_disconnect(self._c)
        os.close(self._roused)
        os.close(self._rousing)

    def _send(self, opcode: int, minor: int, body: bytes, *, isvoid: bool) -> int:
        data = struct.pack("=BBH", opcode, minor, 1 + len(body) // 4) + body
        buffer = ctypes.create_string_buffer(data, len(data))
        parts = (_Part * 3)()  # the library writes into the two before the first
        parts[2] = _Part(ctypes.cast(buffer, ctypes.c_void_p), len(data))
        first = ctypes.byref(parts, 2 * ctypes.sizeof(_Part))
        request = _Request(1, None, opcode, int(isvoid))
        flags = 0 if isvoid else CHECKED
        return int(self._xcb.xcb_send_request(self._c, flags, first, ctypes.byref(request)))

    def _root_of(self, number: int) -> int:
        """The root window of a screen."""
        roots = self._xcb.xcb_setup_roots_iterator(self._xcb.xcb_get_setup(self._c))
        while number > 0 and roots.rem > 1:
            self._xcb.xcb_screen_next(ctypes.byref(roots))
            number -= 1
        return int(ctypes.c_uint32.from_address(roots.data).value)


def value_of(reply: bytes | None) -> tuple[bytes, int, int] | None:
    """Value, bits of its items, bytes that were left out, of a reply to GetProperty or RandR's."""
    if reply is None or not reply[1]:
        return None
    left_out, count = struct.unpack_from("=II", reply, 12)
    return reply[32 : 32 + count * reply[1] // 8], reply[1], left_out


def _library() -> Any:
    for name in (LIBRARIES[0], ctypes.util.find_library(LIBRARIES[1])):
        try:
            xcb = ctypes.CDLL(name) if name else None
        except OSError:
            continue
        if xcb is not None:
            return _declared(xcb)
    raise OSError(f"{LIBRARIES[0]} is not there")


def _declared(xcb: Any) -> Any:
    """The library with the types of what is called; ctypes takes all for int."""
    pointer = ctypes.c_void_p
    for name, result, arguments in (
        ("xcb_connect", pointer, (ctypes.c_char_p, pointer)),
        ("xcb_connection_has_error", ctypes.c_int, (pointer,)),
        ("xcb_disconnect", None, (pointer,)),
        ("xcb_flush", ctypes.c_int, (pointer,)),
        ("xcb_get_file_descriptor", ctypes.c_int, (pointer,)),
        ("xcb_get_setup", pointer, (pointer,)),
        ("xcb_setup_roots_iterator", _Roots, (pointer,)),
        ("xcb_screen_next", None, (pointer,)),
        ("xcb_poll_for_event", pointer, (pointer,)),
        ("xcb_send_request", ctypes.c_uint, (pointer, ctypes.c_int, pointer, pointer)),
        ("xcb_wait_for_reply", pointer, (pointer, ctypes.c_uint, pointer)),
    ):
        function = getattr(xcb, name)
        function.restype, function.argtypes = result, arguments
    return xcb


_libc = ctypes.CDLL(None) if os.name == "posix" else None


def _free(pointer: int) -> None:
    """Give back what the library has allocated."""
    assert _libc is not None
    _libc.free(ctypes.c_void_p(pointer))
