"""A disk that is recorded, and the images that a power cut may leave of it."""

from __future__ import annotations

import contextlib
import dataclasses
import os
import random
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import kernel
import recorder

SECTOR = 512  #: bytes that a disk writes whole or not at all
CHUNK = 16384
MIB = 1 << 20


@dataclasses.dataclass(frozen=True)
class FileSystem:
    """How a file system is made and mounted."""

    kind: str
    size: int
    make: tuple[str, ...]
    options: str = ""

    def missing(self) -> str | None:
        """Why it can't be made here; None where it can."""
        if kernel.tool(self.make[0]) is None:
            return f"needs {self.make[0]}"
        with open("/proc/filesystems") as file:
            return None if self.kind in file.read().split() else f"needs {self.kind} in the kernel"


_EXT4 = ("mkfs.ext4", "-q", "-F", "-E", "nodiscard,lazy_itable_init=0,lazy_journal_init=0")
_XFS = ("mkfs.xfs", "-q", "-K", "-f")
_BTRFS = ("mkfs.btrfs", "-q", "-K", "-f")
FILE_SYSTEMS = {
    "ext4": FileSystem("ext4", 24 * MIB, _EXT4),
    # Neither the order of data before names nor the rescue of renamed files.
    "ext4-writeback": FileSystem("ext4", 24 * MIB, _EXT4, "data=writeback,noauto_da_alloc"),
    # The control of the disk itself: a file system that never flushes it.
    "ext4-nobarrier": FileSystem("ext4", 24 * MIB, _EXT4, "nobarrier"),
    "xfs": FileSystem("xfs", 320 * MIB, _XFS),
    "btrfs": FileSystem("btrfs", 128 * MIB, _BTRFS),
}


class RecordedDisk:
    """A file system on a disk that is recorded; use it as a context, in a private room."""

    def __init__(self, system: FileSystem, place: Path, left: Image | None = None) -> None:
        """place: an empty folder, which holds all that is mounted. left: what a cut has left."""
        self.system, self._place, self._start = system, place, left
        self.root = place / "disk"
        self._image, self._log = place / "image", place / "log"
        self.marks = place / "fuse" / "marks"
        self._stack = self._mounted = contextlib.ExitStack()

    def __enter__(self) -> RecordedDisk:
        with contextlib.ExitStack() as stack:
            kernel.mount("none", self._place, "tmpfs", "mode=0700")
            stack.callback(kernel.unmount, self._place)
            for name in ("fuse", "disk", "cut"):
                (self._place / name).mkdir()
            if self._start is None:
                self._start = self._made()
            else:
                self._start.write(self._image)
            stack.callback(kernel.unmount, self._place / "fuse")
            self._record(stack)
            self._mounted = stack.enter_context(contextlib.ExitStack())
            self._mounted.enter_context(
                kernel.mounted(
                    self._place / "fuse" / "disk", self.root, self.system.kind, self.system.options
                )
            )
            self._stack = stack.pop_all()
        return self

    def _made(self) -> Image:
        with open(self._image, "wb") as file:
            file.truncate(self.system.size)
        tool = kernel.tool(self.system.make[0])
        assert tool is not None
        words = [tool, *self.system.make[1:], str(self._image)]
        subprocess.run(words, check=True, capture_output=True)
        return Image.of(self._image.read_bytes())

    def stop(self) -> None:
        """Unmount the recorded disk: some systems mount no two disks that are copies."""
        self._mounted.close()

    def _record(self, stack: contextlib.ExitStack) -> None:
        fuse = os.open("/dev/fuse", os.O_RDWR)
        stack.callback(os.close, fuse)
        with open(self._image, "r+b") as image, open(self._log, "wb") as log:
            files = (fuse, image.fileno(), log.fileno())
            process = subprocess.Popen(
                [sys.executable, recorder.__file__, *map(str, files)],
                pass_fds=files,
            )
        stack.callback(process.wait)
        stack.callback(process.kill)
        kernel.mount(
            "recorder",
            self._place / "fuse",
            "fuse",
            f"fd={fuse},rootmode=40000,user_id=0,group_id=0",
        )

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def mark(self, text: str) -> None:
        """Put a line into the log."""
        with open(self.marks, "wb", buffering=0) as file:
            file.write(text.encode() + b"\n")

    def log(self) -> Log:
        """What the disk has received so far."""
        assert self._start is not None
        return Log.parsed(self._start, self._log.read_bytes())

    def examined(self, image: Image) -> contextlib.AbstractContextManager[Path]:
        """What the next start of the machine finds in an image."""
        file = self._place / "after"
        image.write(file)
        return kernel.mounted(file, self._place / "cut", self.system.kind, self.system.options)


@dataclasses.dataclass(frozen=True)
class Record:
    kind: bytes
    offset: int
    data: bytes


@dataclasses.dataclass(frozen=True)
class Log:
    """What a disk held at the start, and what it received since, in order."""

    start: Image
    records: tuple[Record, ...]

    @classmethod
    def parsed(cls, start: Image, log: bytes) -> Log:
        records, at = [], 0
        while at < len(log):
            kind, offset, length = recorder.RECORD.unpack_from(log, at)
            at += recorder.RECORD.size
            records.append(Record(kind, offset, log[at : at + length]))
            at += length
        return cls(start, tuple(records))

    def count(self, kind: bytes) -> int:
        return sum(record.kind == kind for record in self.records)

    def marks(self, end: int) -> list[str]:
        """The whole lines of marks before a position."""
        text = b"".join(r.data for r in self.records[:end] if r.kind == recorder.MARK)
        return text.decode().split("\n")[:-1]

    def position(self, mark: str) -> int:
        """The position behind the first mark of a text."""
        for at, record in enumerate(self.records):
            if record.kind == recorder.MARK and mark in record.data.decode().split("\n"):
                return at + 1
        raise ValueError(f"no mark {mark!r}")


class Image:
    """The content of a disk, in chunks; chunks of zeros are left out."""

    def __init__(self, size: int, chunks: dict[int, bytes]) -> None:
        self._size, self._chunks = size, chunks

    @classmethod
    def of(cls, content: bytes) -> Image:
        starts = range(0, len(content), CHUNK)
        chunks = {at: content[at : at + CHUNK] for at in starts}
        return cls(len(content), {at: c for at, c in chunks.items() if c.strip(b"\0")})

    def put(self, offset: int, data: bytes) -> None:
        at = offset
        while at < offset + len(data):
            start = at // CHUNK * CHUNK
            stop = min(start + CHUNK, offset + len(data))
            old = self._chunks.get(start, bytes(CHUNK))
            new = data[at - offset : stop - offset]
            self._chunks[start] = old[: at - start] + new + old[stop - start :]
            at = stop

    def copy(self) -> Image:
        return Image(self._size, dict(self._chunks))

    def write(self, file: Path) -> None:
        with open(file, "wb") as out:
            out.truncate(self._size)
            for at, chunk in sorted(self._chunks.items()):
                os.pwrite(out.fileno(), chunk, at)


@dataclasses.dataclass(frozen=True)
class Cut:
    """A power cut: after how many records, and which unflushed writes had reached the disk."""

    position: int
    survivors: str  #: "none", "all", "some" (each by chance), "torn" (some, and one in part)
    seed: int

    def __str__(self) -> str:
        return f"cut at {self.position}, {self.survivors} of the unflushed writes ({self.seed})"


SURVIVORS = ("none", "all", "some", "torn")


def chosen_cuts(begin: int, end: int, count: int, seed: int) -> list[Cut]:
    """Cuts spread evenly over begin..end; the last is at the end, with nothing unflushed."""
    hand = random.Random(seed)
    positions = [begin + round((end - begin) * k / max(1, count - 1)) for k in range(count)]
    cuts = [
        Cut(p, SURVIVORS[hand.randrange(len(SURVIVORS))], hand.randrange(1 << 30))
        for p in positions
    ]
    cuts[-1] = Cut(end, "none", 0)
    return cuts


def images(log: Log, cuts: Sequence[Cut]) -> Iterator[tuple[Cut, Image]]:
    """Each cut with the image that it leaves, in the order of positions."""
    durable = log.start.copy()
    pending: list[Record] = []
    at = 0
    for cut in sorted(cuts, key=lambda c: (c.position, c.seed)):
        for record in log.records[at : cut.position]:
            if record.kind == recorder.WRITE:
                pending.append(record)
            elif record.kind == recorder.FLUSH:
                for written in pending:
                    durable.put(written.offset, written.data)
                pending.clear()
        at = max(at, cut.position)
        image = durable.copy()
        for record in surviving(pending, cut):
            image.put(record.offset, record.data)
        yield cut, image


def surviving(pending: Sequence[Record], cut: Cut) -> list[Record]:
    """The unflushed writes that had reached the disk."""
    if cut.survivors in ("none", "all"):
        return list(pending) if cut.survivors == "all" else []
    hand = random.Random(cut.seed)
    share = hand.choice((0.1, 0.5, 0.9))
    kept = [record for record in pending if hand.random() < share]
    if cut.survivors == "torn" and kept:
        k = hand.randrange(len(kept))
        whole = kept[k]
        sectors = len(whole.data) // SECTOR
        first = hand.randrange(sectors + 1) * SECTOR
        part = (
            Record(whole.kind, whole.offset, whole.data[:first])
            if hand.random() < 0.5
            else Record(whole.kind, whole.offset + first, whole.data[first:])
        )
        kept[k] = part
    return kept


Check = Callable[[Path, list[str]], list[str]]


@dataclasses.dataclass
class Outcome:
    """What the cuts of one recording showed."""

    writes: int
    flushes: int
    cuts: int = 0
    faults: list[str] = dataclasses.field(default_factory=list)


def examine(disk: RecordedDisk, check: Check, cuts: Sequence[Cut], log: Log) -> Outcome:
    """Start the machine again after each cut; `check` gets the disk and the marks so far."""
    outcome = Outcome(log.count(recorder.WRITE), log.count(recorder.FLUSH))
    for cut, image in images(log, cuts):
        outcome.cuts += 1
        try:
            with disk.examined(image) as root:
                found = check(root, log.marks(cut.position))
        except OSError as error:
            found = [f"file system: {error}"]
        outcome.faults += [f"{cut}: {fault}" for fault in found]
    return outcome
