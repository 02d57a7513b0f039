"""Whether a file looks like a measured table, from its beginning: for folders of mixed files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from relgloss_view.base.decoding import decoded, wide_encoding
from relgloss_view.base.errors import InputError
from relgloss_view.base.foreign import HEAD_BYTES, foreign_format
from relgloss_view.base.reading import read_beginning
from relgloss_view.measure.readers import EXPECTED, FORMATS, gcms, generic, merl, tensor_file
from relgloss_view.measure.readers.cells import is_number
from relgloss_view.measure.readers.header import MOST_LOOKED_AT, MOST_TITLES
from relgloss_view.measure.readers.headings import angle_heading, is_band
from relgloss_view.measure.readers.rows import split

_LINES_BELOW = 30  #: a header, in which the first row of numbers is looked for
_DELIMITERS = (",", ";", "\t", "|", None)


def is_table(path: Path) -> bool:
    """Whether `read_measurement` would take a file for a table, sound or faulty.

    A faulty table counts, so that its fault is reported and the file is not passed over.
    """
    try:
        head = read_beginning(path, HEAD_BYTES, EXPECTED)
    except InputError:
        return False
    if head.startswith((tensor_file.MAGIC, merl.HEADER)):
        return True
    foreign = foreign_format(head)
    if foreign is not None:
        return foreign.key in FORMATS
    wide = wide_encoding(head) is not None
    if b"\x00" in head and not wide:
        return False
    try:
        text = decoded(head[: len(head) // 4 * 4] if wide else head, "").text
    except InputError:
        return False
    return _has_header(text.splitlines()[: MOST_TITLES + _LINES_BELOW])


def _has_header(lines: Sequence[str]) -> bool:
    """Whether a line names two and more angles of one layout, and numbers follow it, or nothing.

    A text about tables, or a program that writes one, names angles too.
    """
    layouts = [set(layout.COLUMNS) for layout in (gcms, generic)]
    for k, line in enumerate(lines):
        if line.lstrip().startswith("#"):
            continue
        for delimiter in _DELIMITERS:
            if delimiter is not None and delimiter not in line:
                continue
            fields = split(line, delimiter, MOST_LOOKED_AT)
            names = {angle.name for angle in map(angle_heading, fields) if angle is not None}
            filled = [field for field in fields if field.strip()]
            known = len(names) + sum(map(is_band, filled))
            if 2 * known > len(filled) and any(len(names & layout) > 1 for layout in layouts):
                below = [
                    text for text in lines[k + 1 : k + 1 + _LINES_BELOW] if text.strip(" \t,;")
                ]
                if not below or any(_is_row(text, delimiter, len(fields)) for text in below):
                    return True
    return False


def _is_row(line: str, delimiter: str | None, count: int) -> bool:
    """Whether a line has so many fields, most of them numbers."""
    fields = split(line, delimiter, MOST_LOOKED_AT)
    filled = [field for field in fields if field.strip()]
    return len(fields) == count and 2 * sum(map(is_number, filled)) > len(filled)
