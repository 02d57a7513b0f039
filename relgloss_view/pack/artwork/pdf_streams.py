"""The bytes of a PDF's streams within bounds: a stream of a megabyte may unpack to a gigabyte.

Source: ISO 32000-2:2020, 7.4 (filters).
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from typing import Any

AT_ONCE = 1 << 20  #: bytes
#: How many times longer a filter makes its input at most; deflate is unpacked in steps instead.
_LONGEST = {"/LZWDecode": 1400, "/RunLengthDecode": 64, "/ASCII85Decode": 4, "/ASCIIHexDecode": 1}


def stream_bytes(stream: Any, most: int) -> bytes:
    """The unpacked bytes of a stream; ValueError where they are more than `most`."""
    return b"".join(pieces(stream, most))


def pieces(stream: Any, most: int) -> Iterator[bytes]:
    """The unpacked bytes of a stream in pieces; ValueError where they are more than `most`."""
    filters = stream.get("/Filter", [])
    names = [str(filters)] if not isinstance(filters, list) and _is_name(filters) else filters
    names = [str(name) for name in names]
    raw = stream.read_raw_bytes()
    if names in (["/FlateDecode"], ["/Fl"]) and "/DecodeParms" not in stream:
        yield from _inflated(raw, most)
        return
    longest = len(raw)
    for name in names:
        longest *= _LONGEST.get(name, 1100)
    if longest > most:
        raise ValueError("a stream that may unpack to too much")
    yield stream.read_bytes()


def _is_name(value: Any) -> bool:
    import pikepdf

    return isinstance(value, pikepdf.Name)


def _inflated(raw: bytes, most: int) -> Iterator[bytes]:
    unpack = zlib.decompressobj()
    left, data = most, raw
    while data and not unpack.eof:
        try:
            piece = unpack.decompress(data, AT_ONCE)
        except zlib.error:  # cut off or damaged: as far as it goes
            return
        left -= len(piece)
        if left < 0:
            raise ValueError("a stream that unpacks to too much")
        yield piece
        data = unpack.unconsumed_tail
        if not piece and not data:
            return
