"""One OpenEXR file of scan lines from parts that OpenEXR has packed each as a file of its own.

OpenEXR's own interface for Python takes a picture whole. Here it packs some rows at a time, and
their chunks are put together, so the file is the one that it would write, to the last byte. The
layout is that of "OpenEXR File Layout" (Academy Software Foundation): magic number and version,
attributes, a table of where each chunk begins, chunks of 16 rows.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO

from relgloss_view.base.errors import RelglossError
from relgloss_view.base.temporaries import held_folder
from relgloss_view.base.writing import utf8_path
from relgloss_view.picture.stages import BLOCK_ROWS

MAGIC = struct.pack("<i", 20000630)
WINDOWS = (b"dataWindow", b"displayWindow")  #: the attributes that hold the picture's size
COPIED_BYTES = 1 << 20  #: at a time


class PartsWriter:
    """Writes the rows of a picture, from the top; `close` when the last one is written.

    Parts have multiples of BLOCK_ROWS rows, but for the last one. Raises OSError where the file
    can't be written.
    """

    def __init__(self, file: BinaryIO, path: Path, size: tuple[int, int]) -> None:
        """file: open at `path` to read and write, empty. size: of the whole picture."""
        self._file = file
        self._folder = path.parent
        self._size = size
        self._rows = 0
        self._starts: list[int] = []
        self._table_at = 0

    def write(self, header: Mapping[str, Any], channels: dict[str, Any]) -> None:
        """Append rows; channels as OpenEXR.File takes them, which may change the dictionary."""
        import OpenEXR

        rows = len(next(iter(channels.values())))
        with held_folder(self._folder) as folder:
            file = folder / "part.exr"
            try:
                with OpenEXR.File(dict(header), channels) as part, utf8_path(file) as written:
                    part.write(str(written))
            except RuntimeError as error:  # what OpenEXR raises where the disk is full
                raise OSError(str(error)) from error
            with open(file, "rb") as packed:
                self._append(packed, rows)
        self._rows += rows

    def close(self) -> None:
        """Write where each chunk begins."""
        assert len(self._starts) == self._chunks(self._size[1])
        self._file.seek(self._table_at)
        self._file.write(struct.pack(f"<{len(self._starts)}Q", *self._starts))
        self._file.flush()

    def _append(self, packed: BinaryIO, rows: int) -> None:
        header = _header(packed, self._size)
        if not self._starts:
            self._file.write(header)
            self._table_at = self._file.tell()
            self._file.write(bytes(8 * self._chunks(self._size[1])))
        packed.seek(8 * self._chunks(rows), 1)
        for _ in range(self._chunks(rows)):
            row, count = struct.unpack("<ii", packed.read(8))
            self._starts.append(self._file.tell())
            self._file.write(struct.pack("<ii", row + self._rows, count))
            self._copy(packed, count)

    def _copy(self, packed: BinaryIO, count: int) -> None:
        while count > 0:
            data = packed.read(min(count, COPIED_BYTES))
            if not data:
                raise _unexpected("a chunk ends early")
            self._file.write(data)
            count -= len(data)

    def _chunks(self, rows: int) -> int:
        return -(-rows // BLOCK_ROWS)


def _header(file: BinaryIO, size: tuple[int, int]) -> bytes:
    """The bytes before the table of chunks, for a picture of a size; the file is read up to it."""
    header = file.read(8)
    if header[:4] != MAGIC:
        raise _unexpected("it begins otherwise")
    windows = 0
    while name := _word(file):
        kind, length = _word(file), file.read(4)
        data = file.read(*struct.unpack("<i", length))
        if name in WINDOWS:
            data = struct.pack("<4i", 0, 0, size[0] - 1, size[1] - 1)
            windows += 1
        header += name + b"\0" + kind + b"\0" + length + data
    if windows != len(WINDOWS):
        raise _unexpected("its header lacks a size")
    return header + b"\0"


def _word(file: BinaryIO) -> bytes:
    """Bytes up to a NUL, which is read too."""
    word = b""
    while (byte := file.read(1)) != b"\0":
        if not byte:
            raise _unexpected("its header ends early")
        word += byte
    return word


def _unexpected(fault: str) -> RelglossError:
    return RelglossError(f"OpenEXR packed a picture in an unexpected way: {fault}; update it")
