"""Tables of a font file: which characters have a glyph, and how high a line is.

They are read within bounds: a table of a few bytes may claim every character a hundred thousand
times over, and the compressed kinds of fonts may hold a gigabyte.

Source: OpenType 1.9, ISO/IEC 14496-22 (Microsoft and Apple), chapters "Font file", "cmap", "head",
"hhea".
"""

from __future__ import annotations

import contextlib
import struct
from collections.abc import Iterator
from typing import BinaryIO

import numpy as np

from relgloss_view.base.arrays import Ints
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import decoding, open_regular

MOST_TABLES = 512
MOST_FACES = 512  #: of a collection
MOST_MAPS = 64  #: from characters to glyphs
MOST_BYTES = 16 << 20  #: of one table
MOST_CHARACTERS = 0x110000  #: of Unicode
_PLAIN = (b"\0\1\0\0", b"OTTO", b"true")
_COLLECTION = b"ttcf"
_MAGIC = 0x5F0F3CF5  #: of the table "head"
#: (platform, encoding) of the maps from Unicode, those of all planes first.
_UNICODE = ((3, 10), (0, 6), (0, 4), (3, 1), (0, 3), (0, 2), (0, 1), (0, 0))


def characters(path: str, index: int, expected: str) -> frozenset[int]:
    """The code points that a face has a glyph for; `index` counts the faces from 0.

    expected: the wanted kind of file for the message. Raises InputError where it is no font.
    """
    with _face(path, index, expected) as face:
        data = face.table(b"cmap")
        _, count = struct.unpack_from(">HH", data)
        maps = {
            (platform, encoding): offset
            for platform, encoding, offset in struct.iter_unpack(
                ">HHI", data[4 : 4 + 8 * min(count, MOST_MAPS)]
            )
        }
        best = next((maps[kind] for kind in _UNICODE if kind in maps), None)
        return frozenset() if best is None else frozenset(_mapped(data[best:]).tolist())


def height_em(path: str, index: int, expected: str) -> float:
    """From the highest to the lowest letter of a face, in sizes of its em. Raises InputError."""
    with _face(path, index, expected) as face:
        head = face.table(b"head")
        (magic,), (units,) = struct.unpack_from(">I", head, 12), struct.unpack_from(">H", head, 18)
        if magic != _MAGIC or not 16 <= units <= 16384:
            raise ValueError
        ascent, descent = struct.unpack_from(">hh", face.table(b"hhea"), 4)
        if ascent <= descent:
            raise ValueError
        return float((ascent - descent) / units)


class _Face:
    """The directory of one face of an opened font file."""

    def __init__(self, file: BinaryIO, index: int) -> None:
        self._file = file
        start = 0
        kind = self._read(0, 4)
        if kind == _COLLECTION:
            (faces,) = struct.unpack(">I", self._read(8, 4))
            if not index < min(faces, MOST_FACES):
                raise ValueError
            (start,) = struct.unpack(">I", self._read(12 + 4 * index, 4))
            kind = self._read(start, 4)
        elif index:
            raise ValueError
        if kind not in _PLAIN:
            raise ValueError
        (count,) = struct.unpack(">H", self._read(start + 4, 2))
        if count > MOST_TABLES:
            raise ValueError
        records = struct.iter_unpack(">4sIII", self._read(start + 12, 16 * count))
        self._places = {tag: (offset, length) for tag, _, offset, length in records}

    def table(self, tag: bytes) -> bytes:
        """A table's bytes. KeyError where the face has none of that name."""
        offset, length = self._places[tag]
        if length > MOST_BYTES:
            raise ValueError
        return self._read(offset, length)

    def _read(self, offset: int, count: int) -> bytes:
        self._file.seek(offset)
        data = self._file.read(count)
        if len(data) != count:
            raise ValueError
        return data


@contextlib.contextmanager
def _face(path: str, index: int, expected: str) -> Iterator[_Face]:
    """A face of a font file; whatever is wrong inside becomes one InputError."""
    with open_regular(path, expected) as file, decoding(path, expected):
        try:
            yield _Face(file, index)
        except (ValueError, LookupError, struct.error):
            raise InputError(f"{path}: not a font that can be read; give {expected}") from None


def _mapped(data: bytes) -> Ints:
    """The characters of a map (a subtable of "cmap") that have a glyph other than the missing one.

    Maps of other formats than those of Unicode (0, 4, 6, 10, 12, 13) raise ValueError.
    """
    (form,) = struct.unpack_from(">H", data)
    if form == 0:
        return np.flatnonzero(np.frombuffer(data, np.uint8, 256, 6)).astype(np.int64)
    if form == 4:
        return _of_segments(data)
    if form in (6, 10):
        first, count = struct.unpack_from(*((">HH", data, 6) if form == 6 else (">II", data, 12)))
        glyphs = np.frombuffer(data, ">u2", count, 10 if form == 6 else 20)
        return np.asarray(first + np.flatnonzero(glyphs).astype(np.int64))
    if form not in (12, 13):
        raise ValueError
    (count,) = struct.unpack_from(">I", data, 12)
    groups = np.frombuffer(data, ">u4", 3 * count, 16).astype(np.int64).reshape(-1, 3)
    codes, which = _ranges(groups[:, 0], groups[:, 1])
    start, _, glyph = groups.T
    glyphs = glyph[which] + (codes - start[which] if form == 12 else 0)
    return np.asarray(codes[glyphs != 0])


def _of_segments(data: bytes) -> Ints:
    """The characters of a map of format 4, segments of the basic plane."""
    (twice,) = struct.unpack_from(">H", data, 6)
    count = twice // 2
    words = np.frombuffer(data, ">u2", len(data) // 2).astype(np.int64)
    if 8 + 4 * count > len(words):
        raise ValueError
    end, start, delta, offset = (
        words[at : at + count] for at in (7, 8 + count, 8 + 2 * count, 8 + 3 * count)
    )
    codes, which = _ranges(start, end)
    glyphs = codes + delta[which]
    far = offset[which] != 0
    # Offsets count from their own place in the table to the glyph of the segment's first character.
    place = 8 + 3 * count + which + offset[which] // 2 + codes - start[which]
    inside = far & (place < len(words))
    listed = words[np.where(inside, place, 0)]
    glyphs = np.where(far, np.where(listed == 0, 0, listed + delta[which]), glyphs)
    return np.asarray(codes[((glyphs & 0xFFFF) != 0) & (inside | ~far) & (codes != 0xFFFF)])


def _ranges(start: Ints, end: Ints) -> tuple[Ints, Ints]:
    """All numbers of the ranges `start` to `end`, and the range of each; those that end early too.

    ValueError where they are more than there are characters, or beyond them.
    """
    lengths = np.maximum(end - start + 1, 0)
    total = int(lengths.sum())
    if total > MOST_CHARACTERS or (len(end) and int(end.max()) >= MOST_CHARACTERS):
        raise ValueError
    which = np.repeat(np.arange(len(start)), lengths)
    first = np.cumsum(lengths) - lengths
    return start[which] + np.arange(total) - first[which], which
