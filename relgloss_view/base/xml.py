"""XML files of other programs, within bounds: no DTD, no entities, a limit of parts and of depth.

A short XML text can ask for much: entities within entities grow without bound, and one that names
a file opens it. So a text with a document type is refused at that line; no format that is read
here needs one. What is counted before the parse bounds the memory that the elements take.

Source of the grammar: XML 1.0, fifth edition (W3C 2008).
"""

from __future__ import annotations

import os
import re
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from relgloss_view.base.decoding import decoded, wide_encoding
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import named, printable, read_bytes

MOST_DEPTH = 64  #: of elements in elements; the formats read here have about ten
MOST_MARKUP = 600_000  #: of tags and comments; a file of 10,000 colours has half as many
MOST_ATTRIBUTES = 300_000
_FED = 1 << 20  #: bytes; the parser begins a tag or comment anew for each such part of it
_PIECE = 1 << 16  #: characters of a text that the parser hands over at once
_DECLARED = re.compile(rb"<\?xml\s[^>]{0,200}?encoding\s*=\s*[\"']([A-Za-z][A-Za-z0-9._-]{0,40})")
#: Encodings of one text or another that XML files declare. Python knows more, some of which take
#: time with the square of the length.
_ENCODINGS = re.compile(
    r"us-ascii|ascii|iso[-_]?8859[-_]\d{1,2}|latin-?1|windows-125\d|cp125\d|macintosh|koi8-[ru]|"
    r"shift[-_]jis|cp932|windows-31j|euc-(jp|kr)|gb2312|gbk|gb18030|big5"
)


class Node(Element):
    """An element that remembers the line of the file in which it begins."""

    line = 0


def read_xml(path: str | os.PathLike[str], expected: str, *, most_bytes: int) -> Element:
    """The root element of an XML file of at most `most_bytes`.

    expected: the wanted kind of file for messages, as in "a CxF file". Tags and names of attributes
    are local names, without prefix or namespace; declarations of namespaces are left out. The
    encoding is the declared one, that of the byte order mark, or UTF-8; where the bytes are no
    UTF-8 they are read as Windows-1252, which may change letters of a name, but no digit.
    `line_of` has each element's line.

    Raises InputError, which names the line, for a text that is not well-formed, has a document
    type, is nested more than MOST_DEPTH deep, or has more parts than the limits above.
    """
    data = _as_utf8(read_bytes(path, most_bytes, expected), named(path))
    for mark, most, what in (
        (b"<", MOST_MARKUP, "tags"),
        (b"=", MOST_ATTRIBUTES, "attributes"),
    ):
        if data.count(mark) > most:
            raise InputError(f"{named(path)}: more than {most} {what}; give {expected}")
    builder = _Builder(named(path), expected)
    return builder.parse(data)


def line_of(element: Element) -> int:
    """The line of the file in which an element of read_xml begins, from 1."""
    return element.line if isinstance(element, Node) else 0


class _Builder:
    """Makes the elements of what the parser meets."""

    def __init__(self, place: str, expected: str) -> None:
        self._place, self._expected = place, expected
        self._parser = expat.ParserCreate("utf-8")  # whatever the text declares: it is UTF-8 now
        self._parser.buffer_text = True
        self._parser.buffer_size = _PIECE
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.StartDoctypeDeclHandler = self._refuse_doctype
        self._tree = TreeBuilder(element_factory=Node)
        self._parser.CharacterDataHandler = self._tree.data
        self._depth = 0
        self._names: dict[str, str] = {}

    def parse(self, data: bytes) -> Element:
        try:
            for start in range(0, len(data), _FED):
                self._parser.Parse(data[start : start + _FED], False)
                if start + _FED - self._parser.CurrentByteIndex > 2 * _FED:
                    raise InputError(
                        f"{self._place}: line {self._parser.CurrentLineNumber}: a tag or comment "
                        f"of more than {_FED} bytes; give {self._expected}"
                    )
            self._parser.Parse(b"", True)
        except expat.ExpatError as error:
            raise InputError(
                f"{self._place}: line {error.lineno}: not well-formed XML "
                f"({expat.ErrorString(error.code)}); give {self._expected}"
            ) from None
        return self._tree.close()

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        self._depth += 1
        line = self._parser.CurrentLineNumber
        if self._depth > MOST_DEPTH:
            raise InputError(
                f"{self._place}: line {line}: elements are nested more than {MOST_DEPTH} deep; "
                f"give {self._expected}"
            )
        node = self._tree.start(self._local(name), self._local_attributes(attributes))
        if isinstance(node, Node):
            node.line = line

    def _end(self, name: str) -> None:
        self._depth -= 1
        self._tree.end(self._local(name))

    def _local(self, name: str) -> str:
        """A name without its prefix, the same object for the same name."""
        return self._names.setdefault(name, name.rpartition(":")[2])

    def _local_attributes(self, attributes: dict[str, str]) -> dict[str, str]:
        if not attributes:
            return attributes
        return {
            self._local(name): value
            for name, value in attributes.items()
            if name != "xmlns" and not name.startswith("xmlns:")
        }

    def _refuse_doctype(self, name: str, *_: object) -> None:
        raise InputError(
            f"{self._place}: line {self._parser.CurrentLineNumber}: the document type "
            f"{printable(name, 40)!r} is not read, because its entities may ask for anything; "
            "remove the DOCTYPE, and write out what its entities stand for"
        )


def _as_utf8(data: bytes, place: str) -> bytes:
    """The bytes of an XML text as UTF-8 without a mark, and without an end of file of DOS."""
    if data.endswith(b"\x1a"):
        data = data.rstrip(b"\x1a")
    declared = _DECLARED.match(data.lstrip(b"\xef\xbb\xbf"))
    if wide_encoding(data[:4096]) is None and declared is not None:
        name = declared[1].decode("ascii").lower()
        # A program that saves text as UTF-8 may leave the declaration of UTF-16 as it was.
        if not name.startswith("utf"):
            return _recoded(data, name, place)
    if not data.startswith(b"\xef\xbb\xbf") and wide_encoding(data[:4096]) is None:
        try:
            data.decode("utf-8")
            return data
        except UnicodeDecodeError:
            pass
    return decoded(data, place).text.encode("utf-8", "replace")


def _recoded(data: bytes, name: str, place: str) -> bytes:
    if _ENCODINGS.fullmatch(name) is None:
        raise InputError(
            f"{place}: line 1: unknown encoding {printable(name, 40)!r}; save it as UTF-8"
        )
    python = {"macintosh": "mac-roman", "windows-31j": "cp932"}.get(name, name)
    try:
        return data.decode(python).encode("utf-8")
    except LookupError:  # there is no part 12 of ISO 8859
        raise InputError(f"{place}: line 1: unknown encoding {name!r}; save it as UTF-8") from None
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise InputError(
            f"{place}: line {line}: not {name} text, as line 1 declares; save it as UTF-8"
        ) from None
