"""PNG with 16 bits a channel, which Pillow does not write (PNG specification, third edition)."""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Iterator
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from relgloss_view.base.arrays import Bytes

SIGNATURE = b"\x89PNG\r\n\x1a\n"
PIXEL_BYTES = 6
COMPRESSION = 4  #: of zlib; higher levels take much longer for little gain
ROWS_BYTES = 1 << 19  #: filtered at a time
DATA_BYTES = 1 << 20  #: of one IDAT chunk, at most about


def write_png16(
    path: str | os.PathLike[str],
    rgb: NDArray[np.uint16],
    text: dict[str, str],
    profile: bytes | None = None,
) -> None:
    """Write RGB (H, W, 3), 0 to 65535, with text chunks and an ICC profile, if there is one."""
    height, width = rgb.shape[:2]
    with open(path, "wb") as file:
        file.write(SIGNATURE)
        # 16 bits, colour type 2 (RGB), deflate, adaptive filters, not interlaced.
        _chunk(file, b"IHDR", struct.pack(">IIBBBBB", width, height, 16, 2, 0, 0, 0))
        if profile is not None:
            _chunk(file, b"iCCP", b"ICC profile\0\0" + zlib.compress(profile))
        for key, value in text.items():
            # Not compressed, no language, no translated keyword.
            words = key.encode("latin-1") + b"\0\0\0\0\0" + value.encode("utf-8")
            _chunk(file, b"iTXt", words)
        for data in _compressed(rgb):
            _chunk(file, b"IDAT", data)
        _chunk(file, b"IEND", b"")


def _chunk(file: BinaryIO, kind: bytes, data: bytes) -> None:
    file.write(struct.pack(">I", len(data)) + kind + data)
    file.write(struct.pack(">I", zlib.crc32(kind + data)))


def _compressed(rgb: NDArray[np.uint16]) -> Iterator[bytes]:
    """The rows, filtered and deflated, in pieces."""
    height, width = rgb.shape[:2]
    squeeze = zlib.compressobj(COMPRESSION)
    step = max(1, ROWS_BYTES // (PIXEL_BYTES * width))
    above = np.zeros((1, PIXEL_BYTES * width), dtype=np.uint8)
    pending = b""
    for top in range(0, height, step):
        part = np.ascontiguousarray(rgb[top : top + step], dtype=">u2")
        rows = part.view(np.uint8).reshape(len(part), -1)
        pending += squeeze.compress(_filtered(rows, np.concatenate([above, rows[:-1]])).tobytes())
        above = rows[-1:]
        if len(pending) >= DATA_BYTES:
            yield pending
            pending = b""
    yield pending + squeeze.flush()


def _filtered(rows: Bytes, above: Bytes) -> Bytes:
    """Rows, each after the number of the filter that leaves the smallest sum of differences.

    The specification recommends that heuristic (section 12.7).
    """
    left, corner = (np.pad(b, ((0, 0), (PIXEL_BYTES, 0)))[:, :-PIXEL_BYTES] for b in (rows, above))
    mean = ((left.astype(np.uint16) + above) // 2).astype(np.uint8)
    predictions = (0, left, above, mean, _paeth(left, above, corner))
    candidates = [np.asarray(rows - predicted, dtype=np.uint8) for predicted in predictions]
    sums = [np.abs(t.view(np.int8).astype(np.int16)).sum(axis=1) for t in candidates]
    best = np.argmin(sums, axis=0)
    result = np.empty((len(rows), rows.shape[1] + 1), dtype=np.uint8)
    result[:, 0] = best
    for kind, candidate in enumerate(candidates):
        result[best == kind, 1:] = candidate[best == kind]
    return result


def _paeth(left: Bytes, above: Bytes, corner: Bytes) -> Bytes:
    """Of the three neighbours the one nearest to left + above - corner; ties in this order."""
    a, b, c = (v.astype(np.int16) for v in (left, above, corner))
    to_left, to_above, to_corner = np.abs(b - c), np.abs(a - c), np.abs(a + b - 2 * c)
    nearest_b = np.where(to_above <= to_corner, above, corner)
    chosen = np.where((to_left <= to_above) & (to_left <= to_corner), left, nearest_b)
    return np.asarray(chosen, dtype=np.uint8)
