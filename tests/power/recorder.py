"""A file system of two files that keeps, in order, what a disk receives: writes, flushes, marks.

Run: python recorder.py FUSE IMAGE LOG, three open files as numbers. It answers the kernel on
/dev/fuse (the protocol of linux/fuse.h, version 7.31) until it is unmounted:

- `disk` is the image. A loop device on it is a disk with a volatile cache: the kernel's loop
  driver makes an fsync of this file out of each flush of the cache.
- `marks` takes what a program acknowledges: its standard output, for one. One process answers one
  request after another, so a mark lies in the log behind all that was written before it.

The log holds records of a kind, an offset, a length and so many bytes.
"""

from __future__ import annotations

import errno
import os
import struct
import sys

RECORD = struct.Struct("<cQI")
WRITE, FLUSH, MARK = b"W", b"F", b"M"

(LOOKUP, FORGET, GETATTR, SETATTR, OPEN, READ, WRITE_, STATFS, RELEASE, FSYNC) = (
    1, 2, 3, 4, 14, 15, 16, 17, 18, 20,
)  # fmt: skip
FLUSH_, INIT, INTERRUPT, DESTROY, BATCH_FORGET = 25, 26, 36, 38, 42
ROOT, DISK, MARKS = 1, 2, 3
FILES = {b"disk": DISK, b"marks": MARKS}
MOST_BYTES = 1 << 20
ASYNC_READ, BIG_WRITES, MAX_PAGES = 1 << 0, 1 << 5, 1 << 22
DIRECT_IO, STREAM = 1 << 0, 1 << 4


class Recorder:
    """The two files, and the log of what is written into them."""

    def __init__(self, image: int, log: int) -> None:
        self._image, self._log = image, log
        self._size = os.fstat(image).st_size

    def answer(self, opcode: int, node: int, body: memoryview) -> bytes | int:
        """What a request gets: bytes, or an error's number, negative."""
        if opcode == INIT:
            flags = ASYNC_READ | BIG_WRITES | MAX_PAGES
            pages = MOST_BYTES // os.sysconf("SC_PAGE_SIZE")
            return struct.pack(
                "<IIIIHHIIHH8I", 7, 31, MOST_BYTES, flags, 12, 9, MOST_BYTES, 1, pages, 0, *[0] * 8
            )
        if opcode == LOOKUP:
            found = FILES.get(bytes(body).rstrip(b"\0"))
            if found is None:
                return -errno.ENOENT
            return struct.pack("<QQQQII", found, 0, 3600, 3600, 0, 0) + self._attributes(found)
        if opcode in (GETATTR, SETATTR):
            return struct.pack("<QII", 3600, 0, 0) + self._attributes(node)
        if opcode == OPEN:
            return struct.pack("<QII", 0, DIRECT_IO | STREAM if node == MARKS else 0, 0)
        if opcode == READ:
            _, offset, size = struct.unpack_from("<QQI", body)
            return os.pread(self._image, size, offset) if node == DISK else b""
        if opcode == WRITE_:
            _, offset, size = struct.unpack_from("<QQI", body)
            data = body[40 : 40 + size]
            if node == DISK:
                os.pwrite(self._image, data, offset)
            self._keep(WRITE if node == DISK else MARK, offset, data)
            return struct.pack("<II", size, 0)
        if opcode == FSYNC:
            if node == DISK:
                self._keep(FLUSH, 0, b"")
            return b""
        if opcode == STATFS:
            return struct.pack("<QQQQQIIII6I", *[1 << 20] * 5, 4096, 255, 4096, 0, *[0] * 6)
        if opcode in (RELEASE, FLUSH_, DESTROY):
            return b""
        return -errno.ENOSYS

    def _attributes(self, node: int) -> bytes:
        mode = 0o040700 if node == ROOT else 0o100600
        size = self._size if node == DISK else 0
        return struct.pack(
            "<QQQQQQ10I", node, size, size // 512, *[0] * 6, mode, 1, *[0] * 3, 4096, 0
        )

    def _keep(self, kind: bytes, offset: int, data: bytes | memoryview) -> None:
        os.writev(self._log, [RECORD.pack(kind, offset, len(data)), data])


def main(fuse: int, image: int, log: int) -> None:
    recorder = Recorder(image, log)
    buffer = bytearray(MOST_BYTES + 65536)
    view = memoryview(buffer)
    while True:
        try:
            length = os.readv(fuse, [buffer])
        except OSError as error:
            if error.errno == errno.ENODEV:  # unmounted
                return
            if error.errno in (errno.EINTR, errno.ENOENT, errno.EAGAIN):
                continue
            raise
        _, opcode, unique, node = struct.unpack_from("<IIQQ", buffer)
        if opcode in (FORGET, BATCH_FORGET, INTERRUPT):
            continue  # these have no answer
        answer = recorder.answer(opcode, node, view[40:length])
        data, fault = (b"", answer) if isinstance(answer, int) else (answer, 0)
        os.writev(fuse, [struct.pack("<IiQ", 16 + len(data), fault, unique), data])


if __name__ == "__main__":
    main(*(int(number) for number in sys.argv[1:4]))
