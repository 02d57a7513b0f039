"""Whether a file looks like a measured table, from its beginning: for folders of mixed files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from relgloss_view.base import cells
from relgloss_view.base.decoding import decoded_beginning, wide_encoding
from relgloss_view.base.errors import InputError
from relgloss_view.base.foreign import HEAD_BYTES, foreign_format
from relgloss_view.base.reading import read_beginning
from relgloss_view.measure.readers import (
    EXPECTED,
    FORMATS,
    gcms,
    generic,
    merl,
    spectrum_text,
    tensor_file,
)
from relgloss_view.measure.readers.csv_table import whole_lines
from relgloss_view.measure.readers.header import (
    DELIMITERS,
    MOST_LOOKED_AT,
    MOST_TITLES,
    split_headings,
    without_comment_sign,
)
from relgloss_view.measure.readers.headings import (
    angle_heading,
    is_band,
    is_beside,
    is_wavelength,
    value_quantity,
)
from relgloss_view.measure.readers.rows import split

_LINES_BELOW = 30  #: a header, in which the first row of numbers is looked for


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
    return is_table_of_angles(head) or spectrum_text.is_multi_angle_table(head)


def is_table_of_angles(head: bytes) -> bool:
    """Whether text begins as a table with a column for each angle of lamp and receiver.

    A line names two and more angles of one layout, and numbers follow it, or nothing. A text about
    tables, or a program that writes one, names angles too.
    """
    if b"\x00" in head and wide_encoding(head) is None:
        return False
    lines = list(whole_lines(decoded_beginning(head).splitlines()[: MOST_TITLES + _LINES_BELOW]))
    layouts = [set(layout.COLUMNS) for layout in (gcms, generic)]
    for k, line in enumerate(lines):
        text = without_comment_sign(line)
        for delimiter in DELIMITERS:
            if delimiter is not None and delimiter not in text:
                continue
            fields = list(filter(str.strip, split_headings(text, delimiter, MOST_LOOKED_AT)))
            names = {angle.name for angle in map(angle_heading, fields) if angle is not None}
            known = len(names) + sum(map(_is_known, fields))
            if 2 * known > len(fields) and any(len(names & layout) > 1 for layout in layouts):
                below = [t for t in lines[k + 1 : k + 1 + _LINES_BELOW] if t.strip(" \t,;|")]
                if not below or any(_is_row(row, delimiter, fields) for row in below):
                    return True
    return False


def _is_known(heading: str) -> bool:
    """Whether a heading that is no angle is one that tables have."""
    if is_band(heading) or is_beside(heading) or is_wavelength(heading):
        return True
    return value_quantity(heading) is not None


def _is_row(line: str, delimiter: str | None, headings: Sequence[str]) -> bool:
    """Whether a line has a field for each heading, or a name more, and most are numbers."""
    fields = [field for field in split(line, delimiter, MOST_LOOKED_AT) if field.strip()]
    numbers = sum(map(_is_number, fields))
    return len(fields) <= len(headings) + 1 and 2 * numbers > max(len(headings), len(fields))


def _is_number(field: str) -> bool:
    text = field.strip().strip('"').removesuffix("%").strip()
    if cells.is_number(text):
        return True
    try:
        return cells.number(text, decimal_comma="," in text) is not None
    except InputError:
        return False
