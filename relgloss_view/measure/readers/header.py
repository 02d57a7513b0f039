"""The header of a text table: where it is, what separates its fields, what its columns are."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence
from pathlib import Path

from relgloss_view.base.cells import is_number
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.measure.readers.headings import (
    DEGREES,
    RADIANS,
    AngleHeading,
    angle_heading,
    is_band,
    is_beside,
    is_sample,
    is_wavelength,
    value_quantity,
)
from relgloss_view.measure.readers.quick_rows import Header
from relgloss_view.measure.readers.rows import split

MAX_COLUMNS = 6_000  #: 100 to 3000 nm in the finest steps, and some beside them
MOST_TITLES = 200  #: lines above the header
MOST_LOOKED_AT = 500  #: columns of a line that may be the header
MOST_HEADINGS = 50_000  #: of all such lines together
PADDING = " \t,;|"  #: what a spreadsheet appends to a line of one cell
SEPARATOR_LINE = re.compile(r'"?sep=.?"?', re.IGNORECASE)
DELIMITERS = (",", ";", "\t", "|", None)
#: A unit in brackets, and the space before one.
_INSIDE = re.compile(r"[\[(][^\[\]()]{1,20}[\])]")
_BEFORE_UNIT = re.compile(r"(?<=\S)[ \t]{1,3}(?=[\[(]\S{1,20}[\])](?:\s|$)|(?:nm|µm|um)\b)")
#: A header in a comment, as numpy.savetxt writes it.
_COMMENT = re.compile(r'^(\s*"?)[#%]+\s*')


def split_headings(line: str, delimiter: str | None, most: int = -1) -> list[str]:
    """The headings of a line. Between spaces, a unit belongs to the name before it."""
    if delimiter is None and '"' not in line:
        line = _INSIDE.sub(lambda unit: "".join(unit[0].split()), line)
        line = _BEFORE_UNIT.sub("", line)
    return split(line, delimiter, most)


def find_header(
    path: Path, lines: Iterable[str], layouts: Sequence[Collection[str]]
) -> tuple[int, str | None]:
    """The index of the header line and its delimiter."""
    first: int | None = None
    first_delimiter = ","
    best: tuple[int, int, str | None] = (0, -1, None)
    looked_at = headings = 0
    for index, line in enumerate(lines):
        stripped = line.strip()
        if not stripped.strip(PADDING):
            continue
        if stripped.startswith(("#", '"#')):
            looked_at += 1
            if looked_at <= MOST_TITLES and _holds_layout(line, layouts):
                return index, _delimiter_of(line, layouts)
            continue
        if index < 2 and SEPARATOR_LINE.fullmatch(stripped):
            continue
        if first is None:
            first, first_delimiter = index, max(",;\t", key=line.count)
        looked_at += 1
        if looked_at > MOST_TITLES or headings > MOST_HEADINGS:
            break
        for delimiter in DELIMITERS:
            if delimiter is not None and delimiter not in line:
                continue
            fields = split_headings(line, delimiter, MOST_LOOKED_AT)
            headings += len(fields)
            names = {a.name for a in map(angle_heading, fields) if a is not None}
            for layout in layouts:
                if len(names & set(layout)) == len(layout):
                    return index, delimiter
                count = len(names & set(layout))
                if count == 1 and len(fields) > 2 and all(map(is_number, fields[1:])):
                    count = 2  # the angles run along the rows
                if count > best[0]:
                    best = (count, index, delimiter)
    if first is None:
        raise InputError(f"{path}: only comments; a table needs a header line and rows")
    if best[0] > 1 or best[1] == first:
        return best[1], best[2]
    return first, first_delimiter


def without_comment_sign(line: str) -> str:
    """A line without the sign of a comment before it.

    >>> without_comment_sign("# alpha_deg,beta_deg")
    'alpha_deg,beta_deg'
    """
    return _COMMENT.sub(r"\1", line, count=1)


def _delimiter_of(line: str, layouts: Sequence[Collection[str]]) -> str | None:
    """The delimiter by which a commented line is the header of one of the layouts; else a blank."""
    text = without_comment_sign(line)
    for delimiter in DELIMITERS:
        fields = split_headings(text, delimiter, MOST_LOOKED_AT)
        names = {a.name for a in map(angle_heading, fields) if a is not None}
        if len(fields) > 4 and any(set(layout) <= names for layout in layouts):
            return delimiter
    return ""


def _holds_layout(line: str, layouts: Sequence[Collection[str]]) -> bool:
    return _COMMENT.match(line) is not None and _delimiter_of(line, layouts) != ""


def uncommented(line: str, layouts: Sequence[Collection[str]]) -> str:
    """A line, without the sign of a comment where it is the header of one of the layouts."""
    return without_comment_sign(line) if _holds_layout(line, layouts) else line


def read_header(
    path: Path, line: int, text: str, delimiter: str | None, following: Sequence[str]
) -> tuple[Header, set[str], list[str]]:
    """The header, the angles that it declares in radians, and a note on other words for angles."""
    names = [
        name.strip().strip('"').strip() for name in split_headings(text.strip("\r\n"), delimiter)
    ]
    below = [split(row.strip("\r\n"), delimiter) for row in following]
    if _has_row_names(names, below):
        names.insert(0, "")
    if len(names) > MAX_COLUMNS:
        raise InputError(
            f"{path}: line {line}: {len(names)} columns, at most {MAX_COLUMNS} are read; "
            "is this the header of a table?"
        )
    if not any(names):
        raise InputError(f"{path}: line {line}: no column has a name; name the columns")
    if all(is_number(name) for name in names if name):
        raise InputError(
            f"{path}: line {line}: numbers where the header should be; "
            "name the columns in the first line that is not a # comment"
        )
    angles = [angle_heading(name) for name in names]
    if below and below[0] and _runs_along(names, below[0]):
        raise InputError(
            f"{path}: line {line}: the angles run along the rows; transpose the table: one row a "
            "geometry, one column an angle or a wavelength"
        )
    for k, angle in enumerate(angles, start=1):
        if angle and angle.unit not in (None, RADIANS, DEGREES):
            raise InputError(
                f"{path}: line {line}, column {k}: {printable(names[k - 1], 40)!r}: unknown unit "
                f"of angle {printable(angle.unit, 20)!r}; give {DEGREES} or {RADIANS}"
            )
    columns = tuple(
        angle.name if angle else printable(name, 40)
        for angle, name in zip(angles, names, strict=True)
    )
    first: dict[str, int] = {}
    for k, name in enumerate(columns, start=1):
        if name and first.setdefault(name.lower(), k) != k:
            raise InputError(
                f"{path}: line {line}, column {k}: {name!r} is already column "
                f"{first[name.lower()]}; rename or remove one"
            )
    keys = tuple(k for k, angle in enumerate(angles) if angle)
    radians = {angle.name for angle in angles if angle and angle.unit == RADIANS}
    words = tuple(name.lower() for name in names)
    beside = [k for k, name in enumerate(columns) if name and k not in keys and is_beside(name)]
    if not keys:
        beside = []
    sample = next((k for k in beside if is_sample(columns[k])), None)
    header = Header(line, columns, words, keys, delimiter, frozenset(beside), sample)
    return header, radians, _renamed(names, angles)


def _has_row_names(names: list[str], below: list[list[str]]) -> bool:
    """Whether rows have the number of the row before the first column, as R writes them."""
    firsts = [fields[0].strip().strip('"') for fields in below if fields]
    return firsts == ["1", "2"] and all(
        len(fields) == len(names) + 1 and is_number(fields[-1]) for fields in below
    )


def _runs_along(names: list[str], fields: list[str]) -> bool:
    """Whether header and next line hold an angle each, and its numbers."""
    return all(
        len(line) > 2 and angle_heading(line[0].strip().strip('"')) is not None
        and all(is_number(cell.strip().strip('"')) for cell in line[1:] if cell.strip())
        for line in (names, fields)
    )  # fmt: skip


def check_columns(path: Path, header: Header, layouts: Sequence[Collection[str]]) -> None:
    """InputError where the header is that of no table, before any row is parsed."""
    where = f"{path}: line {header.line}"
    if not header.keys:
        first = next(name for name in header.columns if name)
        expected = " or ".join(",".join(layout) for layout in layouts)
        if is_wavelength(first) and sum(map(bool, header.columns)) == 2:
            raise InputError(
                f"{where}: this is a spectrum without a geometry; it can serve as a lamp or for "
                "the colour of a material, and a fit needs a table with columns of angles"
            )
        if is_wavelength(first):
            raise InputError(
                f"{where}: the wavelengths run down the table; transpose it: one row a geometry, "
                f"columns {expected}, then the wavelengths"
            )
        raise InputError(f"{where}: found column {first!r}; the header should begin {expected}")
    if not any(set(layout) <= set(header.columns) for layout in layouts):
        return  # the column that is missing is named later
    rest = {
        k + 1: name for k, name in enumerate(header.columns)
        if name and k not in header.keys and k not in header.beside
    }  # fmt: skip
    values = [k for k, name in rest.items() if value_quantity(name) is not None]
    waves = [k for k, name in rest.items() if is_wavelength(name)]
    if len(values) == 1 and len(rest) == 1 + len(waves) and len(waves) <= 1:
        return  # one reading a row
    for k, name in rest.items():
        if not is_band(header.words[k - 1]):
            raise InputError(
                f"{where}, column {k}: {name!r} is neither an angle, a wavelength in nm, nor R, G, "
                "B; rename or remove it"
            )


def _renamed(names: list[str], angles: list[AngleHeading | None]) -> list[str]:
    """A note where columns of angles have other words than relgloss's, for the reader to check."""
    pairs = [
        f"{printable(name, 30)!r} as {angle.name}"
        for name, angle in zip(names, angles, strict=True)
        if angle and angle.name.removesuffix("_deg") not in re.sub(r"[\s_.-]+", "_", name.lower())
    ]
    return [f"read {', '.join(pairs)}"] if pairs else []
