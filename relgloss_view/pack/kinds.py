"""The kinds of files that packs are made of, by their content: pack files and artwork."""

from __future__ import annotations

import os
import re

from relgloss_view.base.reading import read_beginning

PACK, ARTWORK = "pack", "artwork"
EXPECTED = "a pack file (TOML), or an artwork (PDF, PNG, JPEG, TIFF, PSD)"
HEAD_BYTES = 1 << 16
_PICTURES = (
    b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff", b"II*\0", b"MM\0*", b"II+\0", b"MM\0+", b"8BPS",
)  # fmt: skip
_PDF_WITHIN = 1024  #: bytes in which a PDF's mark may lie
#: A line that only a pack has; a scene that holds one has a further table of its own.
_PACK_LINE = re.compile(rb"^[ \t]*\[pack(\.form|\.placement)?\][ \t\r]*(#.*)?$", re.MULTILINE)
_TABLE_LINE = re.compile(rb"^[ \t]*\[{1,2}[ \t]*([\w-]+)", re.MULTILINE)
_OF_PACKS = {b"pack", b"finish"}


def kind_of_pack(path: str | os.PathLike[str]) -> str | None:
    """PACK, ARTWORK, or None for a file of another kind. InputError where it can't be read."""
    head = read_beginning(path, HEAD_BYTES, EXPECTED)
    if head.startswith(_PICTURES) or b"%PDF-" in head[:_PDF_WITHIN]:
        return ARTWORK
    if _PACK_LINE.search(head) and set(_TABLE_LINE.findall(head)) <= _OF_PACKS:
        return PACK
    return None
