"""The blocks of an SSDD file: lines of properties, and the tables below them, text or binary."""

from __future__ import annotations

import itertools
import math
import re
from array import array
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import AnyArray, Array
from relgloss_view.base.cells import MAX_MAGNITUDE
from relgloss_view.base.decoding import decoded, wide_encoding
from relgloss_view.base.errors import InputError
from relgloss_view.base.foreign import HEAD_BYTES
from relgloss_view.base.reading import printable, read_bytes

MAX_BYTES = 300_000_000
EXPECTED = "an SSDD file of libbsdf"
MAX_WIDE = 50_000_000  #: bytes in UTF-16, of which further copies are made
MAX_PROPERTIES = 200  #: of one block; the format has 18
LONGEST_LINE = 2_000_000  #: bytes
MAX_LINES = 10_000  #: outside the tables
MOST_IN_LIST = 100_000
KINDS = ("brdf", "btdf", "specular_reflectance", "specular_transmittance")
_MARK = b"\xef\xbb\xbf"
_BEGINS = re.compile(rb"\n[ \t]*DATA_TYPE\b", re.IGNORECASE)  #: a block


@dataclass
class Block:
    """The properties of a table, and where in the file its numbers begin."""

    path: Path
    kind: str  #: one of KINDS
    properties: dict[str, str] = field(default_factory=dict)
    start: int = 0  #: byte at which the numbers begin
    binary: bool = False

    def text(self, name: str) -> str:
        """The value of a property on one line, '' where the block has none."""
        return printable(self.properties.get(name, ""), 2000)

    def list(self, name: str) -> Array:
        """The numbers of a property; InputError where it is missing or holds anything else."""
        words = self.properties.get(name, "").split(maxsplit=MOST_IN_LIST)
        if not words:
            raise InputError(f"{self.path}: {name} of the {self.kind} is missing; add it")
        if len(words) > MOST_IN_LIST:
            raise InputError(f"{self.path}: {name} has more than {MOST_IN_LIST} numbers")
        try:
            numbers = np.array([float(word.removesuffix("nm")) for word in words])
        except ValueError:
            numbers = np.array([np.nan])
        if not np.isfinite(numbers).all():
            raise InputError(
                f"{self.path}: {name}: {printable(' '.join(words[:20]), 60)!r}; expected numbers "
                "with a decimal point, separated by spaces"
            )
        return numbers

    def numbers(self, data: bytes, count: int, channels: int) -> AnyArray:
        """The table, (count, channels). Raises InputError where the file holds no such table."""
        if self.binary:
            size = 4 * count * channels
            if len(data) - self.start < size:
                raise InputError(
                    f"{self.path}: the file ends after {len(data) - self.start} of {size} bytes "
                    "of binary data; it is cut off, or its lists do not fit its table"
                )
            table: AnyArray = np.frombuffer(
                data, "<f4", count * channels, offset=self.start
            ).reshape(count, channels)
        else:
            table = self._text_numbers(data, count, channels)
        with np.errstate(invalid="ignore"):
            wrong = np.abs(table) > MAX_MAGNITUDE
        if wrong.any():
            row = int(np.argwhere(wrong)[0][0])
            raise InputError(
                f"{self.path}: row {row + 1} of the {self.kind} holds "
                f"{float(table[row][wrong[row]][0]):g}; the file is damaged"
            )
        return table

    def _text_numbers(self, data: bytes, count: int, channels: int) -> AnyArray:
        if len(data) - self.start < 2 * count * channels - 1:
            raise self._short(f"at most {(len(data) - self.start + 1) // 2} numbers", count)
        values, place, rows, lines = array("d"), self.start, 0, 0
        while rows < count:
            line, place = _line(self.path, data, place)
            lines += 1
            if line is None or _BEGINS.match(b"\n" + line[:80]) or lines > 3 * count + MAX_LINES:
                raise self._short(f"{rows} rows", count)
            words = line.split(b"#", 1)[0].split()
            if not words:
                continue
            try:
                values.extend(map(float, words))
            except ValueError:
                words = []
            if len(words) != channels:
                raise InputError(
                    f"{self.path}: row {rows + 1} of the {self.kind} is "
                    f"{printable(line[:200].decode('utf-8', 'replace'), 60)!r}; expected "
                    f"{channels} number{'s' if channels > 1 else ''}, with decimal points and "
                    "separated by spaces"
                )
            rows += 1
        return np.frombuffer(values, dtype=np.float64).reshape(count, channels)

    def _short(self, have: str, count: int) -> InputError:
        return InputError(
            f"{self.path}: the {self.kind} has {have}, its lists of angles ask for {count} rows; "
            "the file is cut off, or its lists do not fit its table"
        )


def read_blocks(path: Path) -> tuple[list[Block], bytes]:
    """The blocks of a file in their order, and its bytes. Raises InputError."""
    data = _with_line_feeds(path, read_bytes(path, MAX_BYTES, EXPECTED))
    place = len(_MARK) if data.startswith(_MARK) else 0
    blocks: list[Block] = []
    properties: dict[str, str] = {}  # of the file's own header
    for count in itertools.count():
        line, place = _line(path, data, place)
        if line is None:
            break
        if count > MAX_LINES:
            raise InputError(f"{path}: more than {MAX_LINES} lines of properties; give {EXPECTED}")
        name, value = _property(line.decode("utf-8", "replace"))
        if not name or name.startswith("#"):
            continue
        if name == "DATA_TYPE":
            if value.lower() not in KINDS or len(blocks) >= len(KINDS):
                raise InputError(
                    f"{path}: DATA_TYPE {printable(value, 40)!r}; a file has one of each of "
                    f"{', '.join(KINDS)}"
                )
            # What precedes it belongs to it too, where a writer has another order.
            blocks.append(Block(path, value.lower(), dict(properties)))
            properties = blocks[-1].properties
        elif name == "DATA" and blocks:
            place = _skip(blocks[-1], value.lower(), data, place)
            properties = {}
        elif len(properties) < MAX_PROPERTIES:
            properties[name] = value
    sound = [block for block in blocks if block.start]
    if len({block.kind for block in sound}) < len(blocks):
        raise InputError(
            f"{path}: a block without 'DATA ascii' or 'DATA binary', or two of one DATA_TYPE; "
            f"give {EXPECTED} of one sample"
        )
    if not blocks:
        raise InputError(f"{path}: no line 'DATA_TYPE ...'; give {EXPECTED}")
    return blocks, data


def _with_line_feeds(path: Path, data: bytes) -> bytes:
    """The bytes of a text in UTF-16, or of one without line feeds, as the format has them."""
    if b"DATA_TYPE" not in data[:HEAD_BYTES] and wide_encoding(data[:4096]) is not None:
        if len(data) > MAX_WIDE:
            raise InputError(f"{path}: a file in UTF-16 of {len(data)} bytes; save it as UTF-8")
        data = decoded(data, str(path)).text.encode()
    if b"\n" not in data[:HEAD_BYTES] and b"\r" in data[:HEAD_BYTES]:
        data = data.replace(b"\r", b"\n")
    return data


def _skip(block: Block, mode: str, data: bytes, place: int) -> int:
    """Note where the numbers begin; the place of the next block."""
    if mode not in ("ascii", "binary"):
        raise InputError(f"{block.path}: DATA {printable(mode, 40)!r}; expected ascii or binary")
    block.start, block.binary = place, mode == "binary"
    if block.binary:
        lists = [f"PARAM{k}_LIST" for k in range(4)]
        sizes = [max(len(block.properties.get(name, "").split()), 1) for name in lists]
        model = block.text("COLOR_MODEL").lower()
        channels = {"rgb": 3, "xyz": 3}.get(model, 1)
        if model == "spectrum":
            channels = max(len(block.properties.get("WAVELENGTH_LIST", "").split()), 1)
        place = min(place + 4 * math.prod(sizes) * channels, len(data))
    following = _BEGINS.search(data, max(place - 1, 0))
    return following.start() + 1 if following else len(data)


def _property(line: str) -> tuple[str, str]:
    """Name in capitals and value of a line; a remark is no part of a keyword or of a list."""
    name, *rest = re.split(r"\s*[:=\s]\s*", line.strip(), maxsplit=1)
    value = rest[0].strip() if rest else ""
    name = name.upper()
    if name.endswith(("_TYPE", "_MODEL", "_LIST", "DATA")):
        value = value.partition("#")[0].strip()
    return name, value


def _line(path: Path, data: bytes, place: int) -> tuple[bytes | None, int]:
    """The line that begins at `place` and the place behind it; None at the end of the file."""
    if place >= len(data):
        return None, place
    end = data.find(b"\n", place)
    end = len(data) if end < 0 else end
    if end - place > LONGEST_LINE:
        raise InputError(f"{path}: a line of {end - place} bytes; give {EXPECTED}")
    return data[place:end], end + 1
