"""What a glTF 2.0 file holds (Khronos 2021), .glb and .gltf: entries, numbers, bytes, in bounds.

Buffers and pictures lie in the file itself or in files beside it; nothing outside its folder is
opened.
"""

from __future__ import annotations

import base64
import binascii
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import unquote

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.beside import path_beside
from relgloss_view.base.errors import InputError
from relgloss_view.base.json_files import parse_json
from relgloss_view.base.reading import printable, read_bytes

MOST_BUFFER = 100 * 1024 * 1024
MOST_VALUES = 500_000  #: of the JSON part


class Source(NamedTuple):
    """The JSON of a file, the folder of its buffers where it may name some, and its binary part."""

    content: dict[str, Any]
    folder: Path | None
    binary: bytes | None


def source_of_glb(data: bytes) -> Source:
    """The content of a .glb file. Raises InputError."""
    if data[:4] != b"glTF" or len(data) < 20:
        raise InputError("no header of a .glb file; export it again")
    if int.from_bytes(data[4:8], "little") != 2:
        raise InputError("not of glTF version 2; export it as glTF 2.0")
    at, text, binary = 12, None, None
    while at + 8 <= len(data):
        length, kind = int.from_bytes(data[at : at + 4], "little"), data[at + 4 : at + 8]
        if at + 8 + length > len(data):
            raise InputError("the file ends before its parts do; export it again")
        chunk = data[at + 8 : at + 8 + length]
        if kind == b"JSON" and text is None:
            text = chunk
        elif kind == b"BIN\0" and binary is None:
            binary = chunk
        at += 8 + length
    if text is None:
        raise InputError("no JSON part in the .glb file; export it again")
    return Source(_parsed(text), None, binary)


def source_of_gltf(data: bytes, folder: Path) -> Source:
    """The content of a .gltf file, whose buffers lie in `folder`. Raises InputError."""
    return Source(_parsed(data), folder, None)


def _parsed(text: bytes) -> dict[str, Any]:
    try:
        content = parse_json(text.decode("utf-8-sig"), MOST_VALUES)
    except UnicodeDecodeError:
        raise InputError("its JSON part is not UTF-8; export it again") from None
    if not isinstance(content, dict):
        raise InputError("its JSON part is no object; export it again")
    return content


def list_of(holder: Any, key: str) -> list[Any]:
    """The list of a name; an empty one where there is none. Raises InputError."""
    value = holder.get(key, []) if isinstance(holder, dict) else []
    if not isinstance(value, list):
        raise InputError(f"{key}: expected a list; export it again")
    return value


class Document:
    """A file whose entries are asked for by number."""

    def __init__(self, source: Source) -> None:
        self.content, self._folder, self._binary = source
        self._buffers: dict[int, bytes] = {}
        self.files: list[str] = []  #: that were read beside it

    def numbers(self, holder: dict[str, Any], key: str, count: int) -> Array:
        """A list of so many numbers. Raises InputError."""
        values = list_of(holder, key)
        usable = all(isinstance(v, int | float) and not isinstance(v, bool) for v in values)
        if len(values) != count or not usable or not all(abs(v) < 1e30 for v in values):
            raise InputError(f"{key}: expected {count} numbers; export it again")
        return np.array(values, dtype=float)

    def entry(self, key: str, number: Any) -> dict[str, Any]:
        """An entry of a list such as 'nodes', by its number. Raises InputError."""
        entries = list_of(self.content, key)
        whole = isinstance(number, int) and not isinstance(number, bool)
        if not whole or not 0 <= number < len(entries) or not isinstance(entries[number], dict):
            shown = printable(number, 20)
            raise InputError(f"{key}[{shown}]: there is no such entry; export it again")
        return dict(entries[number])

    def buffer(self, number: Any) -> bytes:
        """The bytes of a buffer. Raises InputError."""
        entry = self.entry("buffers", number)
        if number not in self._buffers:
            self._buffers[number] = self._read(entry, number)
        return self._buffers[number]

    def picture(self, number: Any) -> bytes:
        """The bytes of an entry of 'images'. Raises InputError."""
        entry = self.entry("images", number)
        if "bufferView" not in entry:
            return self._named(entry.get("uri"), f"images[{number}]")
        view = self.entry("bufferViews", entry["bufferView"])
        data = self.buffer(view.get("buffer"))
        begin, length = view.get("byteOffset", 0), view.get("byteLength")
        for value in (begin, length):
            if not isinstance(value, int) or isinstance(value, bool) or value < 0:
                raise InputError("bufferViews: a length is no whole number; export it again")
        if begin + length > len(data):
            raise InputError("a buffer is shorter than its picture; export it again")
        return data[begin : begin + length]

    def _read(self, entry: dict[str, Any], number: int) -> bytes:
        if entry.get("uri") is None:
            if self._binary is None or number != 0:
                raise InputError(f"buffers[{number}]: there are no bytes for it; export it again")
            return self._binary
        return self._named(entry["uri"], f"buffers[{number}]")

    def _named(self, uri: Any, place: str) -> bytes:
        """What a uri names: its own data, or a file beside it."""
        if not isinstance(uri, str):
            raise InputError(f"{place}: its uri is no text; export it again")
        if uri[:5].lower() == "data:":
            _, comma, coded = uri.partition(",")
            try:
                return base64.b64decode(coded if comma else "?", validate=True)
            except (binascii.Error, ValueError):
                raise InputError(f"{place}: broken base64; export it again") from None
        return self._beside(unquote(uri))

    def _beside(self, name: str) -> bytes:
        """A file of the same folder; no other one is opened."""
        shown = printable(name, 60)
        if self._folder is None:
            raise InputError(f"names the file {shown}; a .glb holds its buffers itself")
        path = path_beside(name, self._folder)
        self.files.append(str(path))
        used = sum(len(data) for data in self._buffers.values())
        return read_bytes(path, max(MOST_BUFFER - used, 0), "the buffer of a .gltf file")
