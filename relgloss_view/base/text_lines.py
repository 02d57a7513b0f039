"""Large text files, line by line: the encoding is found first, and no more than a line is held."""

from __future__ import annotations

import codecs
import io
import os
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType

from relgloss_view.base.decoding import MOST_BEYOND_ASCII, wide_encoding
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import open_regular, unreadable

CHUNK = 1 << 18  #: bytes that are looked at at once
LONGEST_LINE = 2_000_000  #: characters; 6,000 columns of 300
_END_OF_DOS_FILE = "\x1a"
_NOT_IN_CP1252 = b"\x81\x8d\x8f\x90\x9d"  #: bytes that Windows-1252 leaves open
_ASCII = bytes(range(128))


class TextLines:
    """The lines of a text file in the encodings of decoding.py; a context that keeps it open.

    path: a regular file. expected: the wanted kind of file for messages. most_bytes, most_lines,
    longest_line: InputError beyond them; a line's length is in characters.

    The file is read once when the context begins, which finds its encoding and counts its lines,
    and once more for each `lines()`. All passes read the same opened file.
    """

    def __init__(
        self,
        path: Path,
        expected: str,
        *,
        most_bytes: int,
        most_lines: int,
        longest_line: int = LONGEST_LINE,
    ) -> None:
        self.path, self.expected = path, expected
        self.most_bytes, self.most_lines = most_bytes, most_lines
        self.longest_line = longest_line
        self.encoding = "utf-8-sig"
        self.note: str | None = None  #: where the encoding is only likely
        self.empty = True  #: whether there is nothing but white space
        self.has_quotes = False

    def __enter__(self) -> TextLines:
        self._file = open_regular(self.path, self.expected)
        try:
            self._survey()
        except BaseException:
            self._file.close()
            raise
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._file.close()

    def lines(self) -> Iterator[str]:
        """Each line without its end, from the first; \\n, \\r\\n and \\r end one.

        Passes know their own places, so that several may be under way.
        """
        decoder = io.IncrementalNewlineDecoder(
            codecs.getincrementaldecoder(self.encoding)(), translate=True
        )
        number, offset, pending = 0, 0, ""
        while True:
            chunk = self._chunk(offset)
            offset += len(chunk)
            try:
                text = decoder.decode(chunk, final=not chunk)
            except UnicodeDecodeError:  # the file was changed since it was surveyed
                raise InputError(f"{self.path}: changes while it is read; give it again") from None
            if number == 0 and not pending:
                text = text.removeprefix("\ufeff")  # a mark that the encoding keeps
            *whole, pending = (pending + text).split("\n")
            for line in whole:
                number += 1
                if len(line) > self.longest_line:
                    raise self._too_long(number)
                yield line
            if len(pending) > self.longest_line:
                raise self._too_long(number + 1)
            if not chunk:
                break
        last = pending.rstrip(_END_OF_DOS_FILE)
        if last:
            yield last

    def _chunk(self, offset: int) -> bytes:
        try:
            self._file.seek(offset)
            return self._file.read(CHUNK)
        except OSError as error:
            raise unreadable(self.path, error, self.expected) from None

    def _too_long(self, number: int) -> InputError:
        return InputError(
            f"{self.path}: line {number}: longer than {self.longest_line} characters; "
            f"give {self.expected}"
        )

    def _survey(self) -> None:
        """One pass over the bytes: size, lines, encoding."""
        size = os.fstat(self._file.fileno()).st_size
        if size > self.most_bytes:
            raise self._too_large()
        head = self._chunk(0)
        wide = wide_encoding(head)
        decoder = codecs.getincrementaldecoder(wide or "utf-8")()
        fault: int | None = None  #: the first byte that the encoding does not have
        fault_line = total = beyond = returns = ends = 0
        open_bytes = False
        chunk = head
        while True:
            if fault is None:
                try:
                    decoder.decode(chunk, final=not chunk)
                except UnicodeDecodeError as error:
                    fault = total + len(chunk) - len(error.object) + error.start
                    within = max(fault - total, 0)
                    fault_line = ends + chunk.count(b"\n", 0, within) + 1
            if not chunk:
                break
            total += len(chunk)
            ends += chunk.count(b"\n")
            returns += chunk.count(b"\r")
            if not chunk.isascii():
                beyond += len(chunk.translate(None, _ASCII))
                open_bytes = open_bytes or any(byte in chunk for byte in _NOT_IN_CP1252)
            self.empty = self.empty and not chunk.strip()
            self.has_quotes = self.has_quotes or b'"' in chunk
            if total > self.most_bytes:
                raise self._too_large()
            if max(ends, returns) > self.most_lines:
                raise InputError(
                    f"{self.path}: more than {self.most_lines} lines; split the table or thin it "
                    "out"
                )
            chunk = self._chunk(total)
        if wide is not None:
            self.encoding = wide
            if fault is not None:
                raise InputError(
                    f"{self.path}: byte {fault}: the text is {wide[:6].upper()}, but damaged or "
                    "cut off; save it as UTF-8"
                )
        elif fault is not None:
            if beyond > MOST_BEYOND_ASCII * total + 2:
                raise InputError(
                    f"{self.path}: byte {fault}: neither UTF-8 text nor a known binary format; "
                    "save it as UTF-8"
                )
            self.encoding = "latin-1" if open_bytes else "cp1252"
            self.note = (
                f"line {fault_line} is not UTF-8; the text is read as Windows-1252, so names may "
                "show wrong letters: save it as UTF-8"
            )

    def _too_large(self) -> InputError:
        return InputError(
            f"{self.path}: larger than {self.most_bytes} bytes; split it or thin it out, or give "
            f"{self.expected}"
        )
