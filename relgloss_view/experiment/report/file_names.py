"""File names made of labels: safe on every system, and none twice."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence

LONGEST = 40  #: characters; of four bytes each, with an ending, they still fit a file system
#: Names that Windows keeps for its devices.
TAKEN = {"con", "prn", "aux", "nul", *(f"{d}{k}" for d in ("com", "lpt") for k in range(10))}


def file_names(labels: Sequence[str]) -> tuple[str, ...]:
    """One name a label, without an ending; labels that would have the same get a number."""
    used: set[str] = set()
    names = []
    for label in labels:
        stem = _stem(label)
        name, number = stem, 1
        while _folded(name) in used:
            number += 1
            name = f"{stem}-{number}"
        used.add(_folded(name))
        names.append(name)
    return tuple(names)


def _stem(label: str) -> str:
    """Letters and digits of any script, the rest dashes."""
    plain = unicodedata.normalize("NFKC", label)
    kept = "".join(c if c.isalnum() or c in "_." else "-" for c in plain)
    words = [word for word in kept.split("-") if word.strip("._")]
    stem = "-".join(words).strip("._-")[:LONGEST].rstrip("._-")
    if not stem or stem.split(".")[0].casefold() in TAKEN:
        stem = f"sample-{stem}".rstrip("-")
    return stem


def _folded(name: str) -> str:
    """What file systems that fold case or compose accents take for the name."""
    return unicodedata.normalize("NFKC", name).casefold()
