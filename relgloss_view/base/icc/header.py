"""What an ICC profile is of, and what it calls itself, read within bounds.

A colour engine takes half a second and 400 MB for a damaged profile of 576 bytes whose text claims
a gigabyte; and what it raises for text that is none depends on the text. Here the header, the table
of tags and one text are all that is needed.

Source: ICC.1:2022, 7.2 (header), 7.3 (tags), 9.2 and 10.15 (multiLocalizedUnicodeType); ICC.1:2001,
6.5.17 (textDescriptionType).
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

HEADER_BYTES = 128
MOST_TAGS = 100  #: as many as widespread colour engines take
MOST_TEXTS = 1000  #: of one tag, each in another language
LONGEST_TEXT = 1000  #: bytes of a text that are read
_SIGNATURE = b"acsp"
#: Tags with a name for a profile: its description, its device's model, its device's maker.
_NAMES = (b"desc", b"dmdd", b"dmnd")


@dataclass(frozen=True)
class IccProfile:
    """The header's words, and a name, which is empty where the profile has none."""

    colour_space: str  #: such as "RGB"
    description: str


def parse_profile(data: bytes) -> IccProfile:
    """The colour space and the name of a profile. Raises ValueError where this is no profile.

    Texts that can't be read count as absent, for the profile still serves.

    >>> parse_profile(b"no profile")
    Traceback (most recent call last):
    ...
    ValueError: not an ICC profile
    """
    if len(data) < HEADER_BYTES + 4 or data[36:40] != _SIGNATURE:
        raise ValueError("not an ICC profile")
    size, (count,) = struct.unpack_from(">I", data)[0], struct.unpack_from(">I", data, HEADER_BYTES)
    if size > len(data) or count > MOST_TAGS or HEADER_BYTES + 4 + 12 * count > len(data):
        raise ValueError("an ICC profile that is cut off")
    table = data[HEADER_BYTES + 4 : HEADER_BYTES + 4 + 12 * count]
    places = {tag: (offset, length) for tag, offset, length in struct.iter_unpack(">4sII", table)}
    names = (_text(data, *places[tag]) for tag in _NAMES if tag in places)
    return IccProfile(
        data[16:20].decode("latin-1").strip(), next((name for name in names if name), "")
    )


def _text(data: bytes, offset: int, length: int) -> str:
    """The text of a tag; empty where it has none that can be read."""
    part = data[offset : offset + length]
    try:
        if part[:4] == b"mluc":
            return _localized(part)
        if part[:4] == b"desc":
            (count,) = struct.unpack_from(">I", part, 8)
            return _plain(part[12 : 12 + min(count, LONGEST_TEXT)])
        return _plain(part[8 : 8 + LONGEST_TEXT]) if part[:4] == b"text" else ""
    except struct.error:
        return ""


def _localized(part: bytes) -> str:
    """The English text of several, or the first."""
    count, size = struct.unpack_from(">II", part, 8)
    if size < 12:
        return ""
    first = ""
    for k in range(min(count, MOST_TEXTS)):
        language, _, length, offset = struct.unpack_from(">2s2sII", part, 16 + size * k)
        text = part[offset : offset + min(length, LONGEST_TEXT)]
        decoded = _clean(text[: len(text) // 2 * 2].decode("utf-16-be", "replace"))
        if language == b"en" and decoded:
            return decoded
        first = first or decoded
    return first


def _plain(text: bytes) -> str:
    return _clean(text.decode("latin-1"))


def _clean(text: str) -> str:
    return text.partition("\0")[0].strip()
