"""The log of a session file that an earlier version has written, checked frame by frame.

SQLite reads a write-ahead log up to its first damaged frame and passes over the rest in silence.
Format: "WAL-mode File Format" of SQLite's documentation; all its numbers are big-endian.
"""

from __future__ import annotations

import contextlib
import filecmp
import functools
import os
import shutil
import struct
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt

from relgloss_view.base.reading import open_regular
from relgloss_view.base.writing import fresh_file
from relgloss_view.experiment.session.file_checks import LOG
from relgloss_view.experiment.session.losses import (
    LOG_DAMAGED,
    LOG_MISSING,
    Loss,
    former_copies,
    former_name,
)

EXPECTED = "the log of a session file"
HEADER_BYTES, FRAME_BYTES = 32, 24
Words = npt.NDArray[np.uint64]
MAGIC = 0x377F0682  #: the lowest bit: checksums of big-endian words


@contextlib.contextmanager
def kept(file: Path, log: Path) -> Iterator[None]:
    """Keep a file as it is, with its log, before the block turns it into a present one.

    Should its log turn up later, the two belong together, and no other version reads them as one.
    On any exception the copies go. Raises InputError where there is no room for them.
    """
    made: list[Path] = []
    try:
        copy = _free_place(file)
        if copy is not None:
            for source, suffix in ((log, LOG), (file, "")):  # the file last: it is what counts
                place = copy.with_name(copy.name + suffix)
                if source.exists() and source.stat().st_size > 0:
                    with fresh_file(place, private=True) as temporary:
                        shutil.copyfile(source, temporary)
                    made.append(place)
        yield
    except BaseException:
        for place in made:
            place.unlink(missing_ok=True)
        raise


def _free_place(file: Path) -> Path | None:
    """Where a copy goes; None where there is one already, of a program that was killed."""
    copies = former_copies(file)
    if any(copy.is_file() and filecmp.cmp(file, copy, shallow=False) for copy in copies):
        return None
    return former_name(file, len(copies) + 1)


def lost_with(log: Path) -> Loss | None:
    """What may be lost with the log of a file that says that it has one; None for a whole log.

    The last frame of a killed program may be cut, though no answer is in it: that is reported too.
    """
    try:
        size = os.path.getsize(log)
    except OSError:
        size = 0
    if size == 0:
        return Loss(LOG_MISSING)
    return None if _is_whole(log, size) else Loss(LOG_DAMAGED)


def _is_whole(log: Path, size: int) -> bool:
    with open_regular(log, EXPECTED) as file:
        header = file.read(HEADER_BYTES)
        if len(header) < HEADER_BYTES:
            return False
        magic, _, page, _, salt1, salt2, *end = struct.unpack(">8I", header)
        if magic & ~1 != MAGIC or not (512 <= page <= 65536 and page & (page - 1) == 0):
            return False
        word = ">u4" if magic & 1 else "<u4"
        if _checksum((0, 0), header[:24], word) != tuple(end):
            return False
        checksum, committed, ended = (end[0], end[1]), True, False
        for _ in range((size - HEADER_BYTES) // (FRAME_BYTES + page)):
            frame = file.read(FRAME_BYTES + page)
            if len(frame) < FRAME_BYTES + page:
                return False
            _, in_file, own1, own2, *stored = struct.unpack(">6I", frame[:FRAME_BYTES])
            if own1 != salt1 and own2 != salt2:
                ended = True  # what follows is of an earlier use of the log
                continue
            if ended or (own1, own2) != (salt1, salt2):
                return False
            checksum = _checksum(checksum, frame[:8] + frame[FRAME_BYTES:], word)
            if checksum != tuple(stored):
                return False
            committed = in_file > 0
        rest = file.read(FRAME_BYTES)
        if rest and not ended:
            return False
        return committed


def _checksum(start: tuple[int, int], data: bytes, word: str) -> tuple[int, int]:
    """SQLite's sum: for each pair of words s0 += x0 + s1, s1 += x1 + s0, modulo 2^32."""
    words = np.frombuffer(data, dtype=word).astype(np.uint64)
    first, second, ahead = _weights(len(words) // 2)
    sums = []
    for k in range(2):
        parts = first[k] * words[0::2] + second[k] * words[1::2]
        total = int(parts.sum(dtype=np.uint64)) + ahead[k][0] * start[0] + ahead[k][1] * start[1]
        sums.append(total % 2**32)
    return sums[0], sums[1]


@functools.lru_cache(maxsize=4)
def _weights(pairs: int) -> tuple[Words, Words, list[tuple[int, int]]]:
    """How much each word counts in either sum, and each sum before: the recursion unrolled.

    Returns (2, pairs) for the first and for the second words, and the 2x2 weights of the start.
    """
    first = np.empty((2, pairs), dtype=np.uint64)
    second = np.empty((2, pairs), dtype=np.uint64)
    power = [(1, 0), (0, 1)]  # the step's matrix [[1, 1], [1, 2]] to the power of what follows
    for k in range(pairs - 1, -1, -1):
        for row, (a, b) in enumerate(power):
            first[row, k] = (a + b) % 2**32
            second[row, k] = b
        power = [((a + b) % 2**32, (a + 2 * b) % 2**32) for a, b in power]
    return first, second, power
