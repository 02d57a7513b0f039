"""The container of the RGL material database: named arrays in one little-endian file."""

from __future__ import annotations

import math
import os
import struct
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from relgloss_view.base.arrays import AnyArray
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import open_regular

MAGIC = b"tensor_file\x00"
#: The largest files of the database (anisotropic, spectral) stay below this.
MAX_BYTES = 1_000_000_000
MAX_FIELDS = 1000
EXPECTED = "an RGL .bsdf"
MAX_DIMENSIONS = 16
PART_BYTES = 4 << 20  #: of a field that is read in parts

#: Name, type, offset in the file and shape of a field.
_Field = tuple[str, np.dtype[Any], int, tuple[int, ...]]

_TYPES = {
    1: "<u1", 2: "<i1", 3: "<u2", 4: "<i2", 5: "<u4", 6: "<i4", 7: "<u8", 8: "<i8",
    9: "<f2", 10: "<f4", 11: "<f8",
}  # fmt: skip


def read(
    path: Path, wanted: Collection[str], most_numbers: int = MAX_BYTES
) -> tuple[dict[str, AnyArray], frozenset[str]]:
    """The wanted arrays by name, and the names of all (Dupuy and Jakob 2018, their file format).

    most_numbers: of a wanted field. Every field is checked against it and the size of the file
    before memory is allocated for it. Raises InputError.
    """
    with _opened(path) as reader:
        layout = reader.layout()
        for name, _, _, shape in layout:
            if name in wanted:
                reader.check_count(name, math.prod(shape), most_numbers)
        arrays = {field[0]: reader.array(*field) for field in layout if field[0] in wanted}
        return arrays, frozenset(name for name, *_ in layout)


def read_element(
    path: Path, name: str, element: tuple[int, ...], most_numbers: int
) -> AnyArray | None:
    """One element of the last axes of a field, as (0, 0) of matrices; None without such a field.

    The field is read in parts, so that a file larger than memory takes what is kept of it.
    most_numbers: of the element. Raises InputError, also for a field of too few or short axes.
    """
    with _opened(path) as reader:
        fields = {field[0]: field for field in reader.layout()}
        if name not in fields:
            return None
        _, dtype, offset, shape = fields[name]
        outer, inner = shape[: -len(element)], shape[-len(element) :]
        if len(inner) < len(element) or any(k >= n for k, n in zip(element, inner, strict=True)):
            reader.fail(f"field {name[:40]!r} has shape {'x'.join(map(str, shape))}")
        count, block = math.prod(outer), math.prod(inner)
        reader.check_count(name, count, most_numbers)
        kept = np.empty(count, dtype)
        place = int(np.ravel_multi_index(element, inner))
        rows = max(1, PART_BYTES // (block * dtype.itemsize))
        reader.file.seek(offset)
        for top in range(0, count, rows):
            part = kept[top : top + rows]
            data = reader.take(len(part) * block * dtype.itemsize, f"field {name[:40]!r}")
            part[:] = np.frombuffer(data, dtype).reshape(-1, block)[:, place]
        return kept.reshape(outer)


@contextmanager
def _opened(path: Path) -> Iterator[_Reader]:
    with open_regular(path, EXPECTED) as file:
        size = os.fstat(file.fileno()).st_size
        if size > MAX_BYTES:
            raise InputError(
                f"{path}: {size} bytes, at most {MAX_BYTES} are read from a .bsdf file"
            )
        yield _Reader(path, file, size)


class _Reader:
    """Reads forward; its faults name the offset in the file."""

    def __init__(self, path: Path, file: BinaryIO, size: int) -> None:
        self.path, self.file, self.size = path, file, size

    def fail(self, what: str) -> None:
        raise InputError(
            f"{self.path}: offset {self.file.tell()}: {what}; "
            "the file is damaged, download it again"
        )

    def layout(self) -> list[_Field]:
        """The directory: name, type, offset and shape of each field."""
        self.take(len(MAGIC) + 2, "the file header")
        (count,) = self.unpack("<I", "the number of fields")
        if count > MAX_FIELDS:
            self.fail(f"{count} fields claimed, expected about 11")
        layout = [self.field(f"field {k + 1} of {count}") for k in range(count)]
        # Fields that overlap could claim the whole file a thousand times over.
        claimed = sum(math.prod(shape) * dtype.itemsize for _, dtype, _, shape in layout)
        if claimed > self.size:
            self.fail(f"the fields claim {claimed} bytes, the file has {self.size}")
        if len({name for name, *_ in layout}) < count:
            self.fail("two fields have the same name")
        return layout

    def check_count(self, name: str, count: int, most: int) -> None:
        """Refuse a field of more numbers than are read."""
        if count > most:
            self.fail(f"field {name[:40]!r} has {count} numbers, at most {most} are read")

    def take(self, count: int, what: str) -> bytes:
        data = self.file.read(count)
        if len(data) != count:
            self.fail(f"the file ends ({self.size} bytes) inside {what}")
        return data

    def unpack(self, layout: str, what: str) -> tuple[Any, ...]:
        return struct.unpack(layout, self.take(struct.calcsize(layout), what))

    def field(self, what: str) -> _Field:
        """The name, type, offset and shape of the next field of the directory."""
        (length,) = self.unpack("<H", what)
        name = self.take(length, what).decode("ascii", "backslashreplace")
        dimensions, code, offset = self.unpack("<HBQ", what)
        if dimensions > MAX_DIMENSIONS or code not in _TYPES:
            self.fail(f"{what} has {dimensions} dimensions and type {code}, which nothing has")
        shape = self.unpack(f"<{dimensions}Q", what)
        if 0 in shape and dimensions > 1:
            self.fail(f"field {name[:40]!r} claims shape {'x'.join(map(str, shape))}")
        dtype = np.dtype(_TYPES[code])
        if offset + math.prod(shape) * dtype.itemsize > self.size:
            self.fail(
                f"field {name[:40]!r} claims shape {'x'.join(map(str, shape))} at {offset}, "
                f"beyond the end of the file ({self.size} bytes)"
            )
        return name, dtype, offset, shape

    def array(
        self, name: str, dtype: np.dtype[Any], offset: int, shape: tuple[int, ...]
    ) -> AnyArray:
        self.file.seek(offset)
        data = self.take(math.prod(shape) * dtype.itemsize, f"field {name[:40]!r}")
        return np.frombuffer(data, dtype).reshape(shape)
