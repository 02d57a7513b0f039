"""The kinds of files that packs are made of, by their content: pack files and artwork."""

from __future__ import annotations

import os
import re
from pathlib import Path

from relgloss_view.base.reading import read_beginning
from relgloss_view.base.resources import asset

PACK, ARTWORK = "pack", "artwork"
EXPECTED = "a pack file (TOML), or an artwork (PDF, PNG, JPEG, TIFF, PSD)"
#: The packs that come with the program; their names serve in place of a file.
SHIPPED = ("can", "carton")
HEAD_BYTES = 1 << 16
_PICTURES = (
    b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff", b"II*\0", b"MM\0*", b"II+\0", b"MM\0+", b"8BPS",
)  # fmt: skip
_PDF_WITHIN = 1024  #: bytes in which a PDF's mark may lie
#: A line that only a pack has; a scene that holds one has a further table of its own.
_PACK_LINE = re.compile(rb"^[ \t]*\[pack(\.form|\.placement)?\][ \t\r]*(#.*)?$", re.MULTILINE)
_TABLE_LINE = re.compile(rb"^[ \t]*\[{1,2}[ \t]*([\w-]+)", re.MULTILINE)
_OF_PACKS = {b"pack", b"finish"}


def pack_path(path: str | os.PathLike[str]) -> str | os.PathLike[str]:
    """The file of a shipped pack where a path is its name and there is no such file; else itself.

    >>> pack_path("mine.toml"), Path(pack_path("can")).name
    ('mine.toml', 'can.toml')
    """
    if str(path) in SHIPPED and not Path(path).exists():
        return Path(str(asset("packs", f"{path}.toml")))
    return path


def kind_of_pack(path: str | os.PathLike[str], expected: str = EXPECTED) -> str | None:
    """PACK, ARTWORK, or None for a file of another kind. InputError where it can't be read.

    path: a file, or the name of a shipped pack. expected: what is wanted, for the message.
    """
    head = read_beginning(pack_path(path), HEAD_BYTES, expected)
    if head.startswith(_PICTURES) or b"%PDF-" in head[:_PDF_WITHIN]:
        return ARTWORK
    if _PACK_LINE.search(head) and set(_TABLE_LINE.findall(head)) <= _OF_PACKS:
        return PACK
    return None
