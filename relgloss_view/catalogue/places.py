"""Where the material of each file lies in a catalogue: its path, as any file system takes it."""

from __future__ import annotations

import hashlib
import os
import re
import unicodedata
from collections import defaultdict
from collections.abc import Iterable
from pathlib import PurePosixPath

FOLDER = "materials"
SUFFIX = ".json"
LONGEST_NAME, LONGEST_PATH = 120, 600  #: bytes
#: What some system does not take in a name; % begins an escaped byte, and ~ a digest.
_FORBIDDEN = frozenset('<>:"/\\|?*%~')
#: Kinds of characters that nobody sees: controls, bidirectional marks, halves of pairs, separators.
_UNSEEN = frozenset(("Cc", "Cf", "Cs", "Co", "Zl", "Zp"))
#: Names that Windows keeps for devices, whatever suffix they have.
_DEVICES = re.compile(r"(?:con|prn|aux|nul|conin\$|conout\$|com[0-9¹²³]|lpt[0-9¹²³])(?=\.|$)", re.I)


def material_places(paths: Iterable[str]) -> dict[str, str]:
    """The material's file of each path of a tree, from the catalogue's folder; all differ.

    They differ also where upper and lower case are one. A place depends on its own path, and on
    paths that differ from it in case alone.

    >>> material_places(["lot 1/paper.csv", "Lot 1/Paper.csv", "nul"])["nul"]
    'materials/%6Eul.json'
    >>> sorted(material_places(["a.csv", "A.csv"]).values())
    ['materials/A.csv~b1f4ee99.json', 'materials/a.csv~32f29f33.json']
    """
    places = {path: _place(path.removesuffix(SUFFIX) or path) for path in paths}
    same: dict[str, list[str]] = defaultdict(list)
    for path, place in places.items():
        same[_folded(place)].append(path)
    for group in same.values():
        if len(group) > 1:
            for path in group:
                places[path] = f"{places[path]}~{_digest(path)[:8]}"
    return {path: f"{FOLDER}/{place}{SUFFIX}" for path, place in places.items()}


def parts_within(place: str) -> tuple[str, ...]:
    """The names of a path below the catalogue's folder; () for one that leads out of
    it, or that no system takes.

    >>> parts_within("materials/lot 1/paper.json"), parts_within("../paper.json")
    (('materials', 'lot 1', 'paper.json'), ())
    """
    path = PurePosixPath(place)
    leads_out = path.is_absolute() or ".." in path.parts or "\\" in place or "\0" in place
    return () if leads_out else path.parts


def in_system(place: str) -> str:
    """A place as this system's calls take it: its bytes are UTF-8, whatever this user's are."""
    return os.fsdecode(place.encode("utf-8"))


def from_system(name: str) -> str:
    """The place of a name that a system's call has returned."""
    return os.fsencode(name).decode("utf-8", "replace")


def _place(path: str) -> str:
    *folders, name = path.split("/")
    # A folder never has the suffix of a material, so that none takes a material's name.
    parts = [_name(folder, ends=True) for folder in folders] + [_name(name)]
    place = "/".join(parts)
    if len(place.encode("utf-8")) > LONGEST_PATH:
        return f"{parts[-1]}~{_digest(path)[:32]}"
    return place


def _name(name: str, *, ends: bool = False) -> str:
    """One name of a path."""
    whole = name
    name = "".join(_escaped(c) if _is_forbidden(c) else c for c in name)
    if _DEVICES.match(name) or name.startswith("."):
        name = _escaped(name[0]) + name[1:]
    if name.endswith((" ", ".")) or (ends and name.lower().endswith(SUFFIX)):
        at = -1 if name.endswith((" ", ".")) else -len(SUFFIX)
        name = name[:at] + _escaped(name[at]) + name[len(name) + at + 1 :]
    data = name.encode("utf-8")
    if len(data) > LONGEST_NAME:
        name = f"{data[:80].decode('utf-8', 'ignore')}~{_digest(whole)[:32]}"
    return name or "~"


def _is_forbidden(character: str) -> bool:
    kind = unicodedata.category(character)
    return character in _FORBIDDEN or kind in _UNSEEN or (kind == "Zs" and character != " ")


def _escaped(character: str) -> str:
    return "".join(f"%{byte:02X}" for byte in character.encode("utf-8", "surrogatepass"))


def _folded(place: str) -> str:
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", place).casefold())


def _digest(path: str) -> str:
    return hashlib.sha256(path.encode("utf-8", "surrogatepass")).hexdigest()
