"""The file of a display, kept whole: its bytes, and those of the profile that it names.

A session has to show years later which display its answers belong to, wherever the file lies then.
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.json_files import parse_json
from relgloss_view.base.reading import printable, read_bytes
from relgloss_view.base.toml import parse_toml, toml_text
from relgloss_view.base.writing import whole_file
from relgloss_view.display.read import EXPECTED, monitor_of

#: Of a profile and of a display file. Two of each, as text, fit into a session's value of 32 MB.
MOST_BYTES, MOST_TOML_BYTES = 6 << 20, 1 << 20
MOST_NAME = 100  #: characters
PROFILE = b"acsp"  #: of an ICC profile, at byte 36
DISPLAY_TABLE, PROFILE_ENTRY = "display", "profile"  #: where a display file names its profile


@dataclass(frozen=True)
class KeptFile:
    """An ICC profile, or a display file with the profile that it names.

    name: as the file was called, without folders. data: its bytes. profile: the bytes of the ICC
    profile beside a display file; None where it names none.

    >>> KeptFile("a.toml", b"x = 1 # one").digest == KeptFile("b.toml", b"x = 1").digest
    True
    """

    name: str
    data: bytes
    profile: bytes | None = None

    @property
    def is_profile(self) -> bool:
        """Whether it is an ICC profile."""
        return self.data[36:40] == PROFILE

    @cached_property
    def digest(self) -> str:
        """SHA-256 of what the file states: the same wherever it and its profile lie."""
        if self.is_profile:
            return hashlib.sha256(self.data).hexdigest()
        named = None if self.profile is None else hashlib.sha256(self.profile).hexdigest()
        tables = self._tables(named)
        return hashlib.sha256(json.dumps(tables, sort_keys=True, default=str).encode()).hexdigest()

    def to_dict(self) -> dict[str, Any]:
        """As JSON holds it."""
        profile = None if self.profile is None else _text(self.profile)
        return {"name": self.name, "data": _text(self.data), "profile": profile}

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> KeptFile:
        """The file of to_dict; ValueError for anything else."""
        if not isinstance(content, Mapping) or set(content) != {"name", "data", "profile"}:
            raise ValueError("display file")
        name, profile = content["name"], content["profile"]
        if not (isinstance(name, str) and len(name) <= MOST_NAME):
            raise ValueError("display file")
        return cls(name, _bytes(content["data"]), None if profile is None else _bytes(profile))

    def to_bytes(self) -> bytes:
        """As one value: the profile itself, or JSON of a display file."""
        return self.data if self.is_profile else json.dumps(self.to_dict()).encode("ascii")

    @classmethod
    def from_bytes(cls, value: bytes) -> KeptFile:
        """The file of to_bytes; ValueError for anything else."""
        if value[36:40] == PROFILE:
            return cls("display.icc", value)
        return cls.from_dict(parse_json(value.decode("utf-8"), 10))

    def put_into(self, folder: Path, stem: str = "") -> str:
        """Write it into a folder, its profile beside it; the path of what was written.

        stem: of the names; from the digest by default. A file that lies there already stays.
        """
        stem = stem or f"display-{self.digest[:16]}"
        if self.is_profile:
            return _put(folder / f"{stem}.icc", self.data)
        if self.profile is None:
            return _put(folder / f"{stem}.toml", self.data)
        beside = f"{stem}.icc"
        _put(folder / beside, self.profile)
        return _put(folder / f"{stem}.toml", toml_text(self._tables(beside)).encode("utf-8"))

    def _tables(self, profile: str | None) -> dict[str, Any]:
        """The tables of a display file, with another name for its profile."""
        tables = _tables_of(self.data)
        if profile is not None:
            tables[DISPLAY_TABLE] = {**tables[DISPLAY_TABLE], PROFILE_ENTRY: profile}
        return tables


def keep_file(path: str | os.PathLike[str]) -> KeptFile:
    """The file of a display as it is now. InputError where it is none, or too large to be kept."""
    monitor_of(os.fspath(path))  # a faulty file is reported as everywhere else
    data = read_bytes(path, MOST_BYTES, f"{EXPECTED} of at most {MOST_BYTES >> 20} MB")
    name = printable(os.path.basename(path), MOST_NAME)[:MOST_NAME]
    if data[36:40] == PROFILE:
        return KeptFile(name, data)
    if len(data) > MOST_TOML_BYTES:
        raise InputError(f"{printable(path)}: a display file of more than 1 MB; give a smaller one")
    named = _profile_name(_tables_of(data))
    if not named:
        return KeptFile(name, data)
    expected = f"an ICC profile of at most {MOST_BYTES >> 20} MB"
    return KeptFile(name, data, read_bytes(Path(path).parent / named, MOST_BYTES, expected))


def _tables_of(data: bytes) -> dict[str, Any]:
    try:
        return parse_toml(data.decode("utf-8"))
    except (InputError, UnicodeDecodeError) as error:
        raise InputError(f"not a display file ({printable(error, 80)})") from error


def _profile_name(tables: Mapping[str, Any]) -> str:
    table = tables.get(DISPLAY_TABLE)
    named = table.get(PROFILE_ENTRY) if isinstance(table, dict) else None
    return named if isinstance(named, str) else ""


def _put(file: Path, data: bytes) -> str:
    if not file.exists():
        with whole_file(file) as temporary:
            temporary.write_bytes(data)
    return str(file)


def _text(data: bytes) -> str:
    return base64.b64encode(data).decode("ascii")


def _bytes(text: object) -> bytes:
    if not isinstance(text, str):
        raise ValueError("display file")
    try:
        return base64.b64decode(text, validate=True)
    except ValueError:
        raise ValueError("display file") from None
