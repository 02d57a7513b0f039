"""Text of files that other programs saved: UTF-8, UTF-16 with or without a mark, Windows-1252."""

from __future__ import annotations

import codecs
from dataclasses import dataclass

from relgloss_view.base.errors import InputError

#: A UTF-16 text of Latin letters and digits has a zero in nearly every second byte, and there only.
_MOST_ZEROS, _FEWEST_ZEROS = 0.7, 0.02
#: A text in a code page of Europe has fewer letters beyond ASCII than this share of its bytes.
MOST_BEYOND_ASCII = 0.3
_LOOKED_AT = 4096  #: bytes; even, so that pairs stay pairs
_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"),  # before UTF-16's, which is how it begins
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)


@dataclass(frozen=True)
class Decoded:
    """The text of a file, without its mark, and a note where its encoding is only likely."""

    text: str
    note: str | None = None


def wide_encoding(head: bytes) -> str | None:
    """The encoding of a text of two or four bytes a character, from its beginning; else None.

    A file without a mark counts where every second byte is zero and the others are not.

    >>> wide_encoding("0,1\\n".encode("utf-16-le")), wide_encoding("0,1\\n".encode("utf-16"))
    ('utf-16-le', 'utf-16')
    >>> wide_encoding(b"0,1"), wide_encoding(bytes(8))
    (None, None)
    """
    for mark, encoding in _MARKS:
        if head.startswith(mark) and encoding != "utf-8-sig":
            return encoding
    head = head[:_LOOKED_AT]
    pairs = len(head) // 2
    if pairs < 2:
        return None
    first, second = (head[k : 2 * pairs : 2].count(0) / pairs for k in (0, 1))
    if second >= _MOST_ZEROS and first <= _FEWEST_ZEROS:
        return "utf-16-le"
    if first >= _MOST_ZEROS and second <= _FEWEST_ZEROS:
        return "utf-16-be"
    return None


def decoded(data: bytes, place: str) -> Decoded:
    """The text of a file's bytes. Raises InputError, which begins with `place`, where it is none.

    What is no UTF-8 is read as Windows-1252, as spreadsheets in Western Europe save text, with a
    note: another code page may have been meant, which changes letters but no digit.

    >>> decoded("45°".encode(), "a.csv")
    Decoded(text='45°', note=None)
    >>> decoded("45°".encode("latin-1"), "a.csv").text
    '45°'
    """
    wide = wide_encoding(data)
    if wide is not None:
        return Decoded(_wide(data, wide, place))
    try:
        return Decoded(data.decode("utf-8-sig").rstrip("\x1a"))  # the end of a file in DOS
    except UnicodeDecodeError as error:
        at = error.start
    if not _mostly_ascii(data):
        raise InputError(
            f"{place}: byte {at}: neither UTF-8 text nor a known binary format; save it as UTF-8"
        )
    line = data.count(b"\n", 0, at) + 1
    try:
        text = data.decode("cp1252")
    except UnicodeDecodeError:  # one of the five bytes that Windows-1252 leaves open
        text = data.decode("latin-1")
    note = (
        f"line {line} is not UTF-8; the text is read as Windows-1252, so names may show wrong "
        "letters: save it as UTF-8"
    )
    return Decoded(text.rstrip("\x1a"), note)


def decoded_beginning(head: bytes) -> str:
    """The beginning of a file as text; a character cut at its end does no harm, '' for no text."""
    try:
        if wide_encoding(head) is not None:
            head = head[: len(head) // 4 * 4]
        return decoded(head, "").text
    except InputError:
        return ""


def first_byte_of_no_text(beginning: bytes) -> int | None:
    r"""Where the beginning of a file stops to be text in any encoding read here; None if it is.

    >>> first_byte_of_no_text(b"45\xb0"), first_byte_of_no_text(b"a" + b"\xfe" * 9)
    (None, 1)
    """
    try:
        codecs.getincrementaldecoder("utf-8")().decode(beginning)
    except UnicodeDecodeError as error:
        if not _mostly_ascii(beginning) and wide_encoding(beginning) is None:
            return error.start
    return None


def _mostly_ascii(data: bytes) -> bool:
    return len(data.translate(None, bytes(range(128)))) <= MOST_BEYOND_ASCII * len(data) + 2


def _wide(data: bytes, encoding: str, place: str) -> str:
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        raise InputError(
            f"{place}: byte {error.start}: the text is {encoding[:6].upper()}, but damaged or cut "
            "off; save it as UTF-8"
        ) from None
    return text.removeprefix("\ufeff").rstrip("\x1a")
