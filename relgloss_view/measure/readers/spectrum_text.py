"""Spectra in plain text: two or more columns, or a row for each sample."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from relgloss_view.base import cells
from relgloss_view.base.arrays import Array
from relgloss_view.base.decoding import decoded_beginning
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.text_lines import TextLines
from relgloss_view.base.two_columns import (
    LONGEST_LINE,
    MOST_LINES,
    MOST_TITLES,
    NUMBER,
    Words,
    check_unit,
    fields_of,
    in_order,
    read_rows,
)
from relgloss_view.measure.quantity import canonical_quantity
from relgloss_view.measure.readers.aspecular import split_aspecular
from relgloss_view.measure.readers.csv_table import whole_lines
from relgloss_view.measure.readers.headings import angle_heading, is_wavelength
from relgloss_view.measure.readers.parts import chosen_part
from relgloss_view.measure.readers.rows import split
from relgloss_view.measure.readers.samples import (
    LONGEST_NAME,
    Sample,
    SampleFile,
    add_sample,
    distinguish,
)
from relgloss_view.measure.readers.spectral_columns import (
    FEWEST_BANDS,
    HEADING_NM,
    spectral_columns,
)

EXPECTED = "a spectrum of wavelength (nm) and reflectance"
WORDS = Words("a sample", "reflectance")
MAX_BYTES = 32 * 1024 * 1024
MOST_COLUMNS = 10_000
MOST_LOOKED_AT = 400_000  #: characters of lines that may be the header
_DELIMITERS = (";", "\t", "|", ",", None)
_PERCENT = re.compile(
    r"%\s*(r|rfl|refl\w*)\b|\b(r|rfl|refl\w*|radiance factor)\s*[\[(,;:]*\s*(in\s*)?(%|percent\b)"
    r"|\[\s*%\s*\]|\(\s*%\s*\)",
    re.IGNORECASE,
)
_FRACTION = re.compile(r"\brefl\w*\s*[\[(]?\s*(0\s*(\.\.|-|to)\s*1|fraction)\b", re.IGNORECASE)
#: What columns beside wavelengths may hold instead of a reflectance.
_OTHER = re.compile(
    r"\b(transmi\w+|absor\w+|optical density|k/s|counts?|irradiance|radiance(?![ _-]?factor)|power|"
    r"intensity|W/nm|W/m2|SPD|illuminance|energy)\b",
    re.IGNORECASE,
)
#: Headings of a column that counts the rows, before one of wavelengths.
_INDEX = frozenset(("", "index", "no", "no.", "nr", "nr.", "#", "n", "row", "id", "point", "pixel"))
_NAME = re.compile(r".*(name|sample|label|specimen|patch|colou?r|\bink\b|\bid\b).*", re.IGNORECASE)
_GEOMETRY = re.compile(r".*(geometry|angle|aspecular).*", re.IGNORECASE)
_QUANTITY = re.compile(r"#?\s*\"?quantity\"?\s*[:=,;\t]\s*(.+)", re.IGNORECASE)
_SOURCE = re.compile(
    r"#?\s*\"?(?:source|instrument\w*|device|model)\"?\s*[:=,;\t]\s*(.+)", re.IGNORECASE
)
_TITLE = re.compile(r"#?\s*\"?name\"?\s*[:=,;\t]\s*(.+)", re.IGNORECASE)


@dataclass(frozen=True)
class _Beginning:
    """What stands above the numbers, and the header of wavelengths, if there is one."""

    titles: list[str]
    first: list[str]  #: cells of the first line that begins with a number
    header: int | None  #: index of the line with a column for each wavelength
    delimiter: str | None
    numbers_percent: bool


def read_samples(path: Path, part: str | None = None) -> SampleFile:
    """The samples of a text file; of a table with a column for each sample, the wanted one alone.

    Raises InputError that names line and remedy.
    """
    with TextLines(path, EXPECTED, most_bytes=MAX_BYTES, most_lines=MOST_LINES) as text:
        if text.empty:
            raise InputError(f"{path}: the file is empty; give {EXPECTED}")
        beginning = _beginning(text)
        result = SampleFile(notes=[text.note] if text.note else [])
        for title in beginning.titles:
            declared = _QUANTITY.match(title)
            if declared:
                quantity = declared[1].strip(' ",;\t')
                result.quantity = canonical_quantity(quantity, str(path))
        if beginning.header is not None:
            _in_rows(path, text, beginning, result)
        else:
            _in_columns(path, text, beginning, result, part)
    return result


def _beginning(text: TextLines) -> _Beginning:
    titles: list[str] = []
    looked_at = 0
    for index, line in enumerate(text.lines()):
        if len(titles) > MOST_TITLES or looked_at > MOST_LOOKED_AT:
            break
        looked_at += len(line)
        short = line[:LONGEST_LINE]
        if not short.strip(" \t,;"):
            continue
        if not short.lstrip().startswith("#"):
            for delimiter in _DELIMITERS:
                if (delimiter is None or delimiter in line) and _is_header(line, delimiter):
                    return _Beginning(titles, [], index, delimiter, False)
            fields = fields_of(short)
            if NUMBER.fullmatch(fields[0].removesuffix("nm").strip()):
                percent = fields[-1].endswith("%")
                return _Beginning(titles, fields, None, None, percent)
        titles.append(short.strip())
    return _Beginning(titles, [], None, None, False)


def _is_header(line: str, delimiter: str | None) -> bool:
    """Whether a line has wavelengths that increase in several cells, and words in the others."""
    fields = [f.strip().strip('"') for f in split(line, delimiter, MOST_COLUMNS)]
    if len(fields) < FEWEST_BANDS or any(angle_heading(f) for f in fields[:8]):
        return False
    layout = spectral_columns(fields)
    used = set(layout.used)
    return bool(layout.spectra) and not any(
        cells.is_number(f) for k, f in enumerate(fields) if k not in used
    )


def is_samples_table(head: bytes) -> bool:
    """Whether a file begins as a table of spectra: a row each, or two columns, and no angles."""
    text = decoded_beginning(head)
    pairs: list[float] = []
    lines = [
        line
        for line in whole_lines(text.splitlines()[: MOST_TITLES + 4])
        if line.strip(" \t,;") and not line.lstrip().startswith("#")
    ]
    for line, following in itertools.zip_longest(lines, lines[1:], fillvalue=""):
        words = re.split(r"[,;\t]", line, maxsplit=8)[:8]
        if sum(angle_heading(word.strip(' "')) is not None for word in words) > 1:
            return False  # a table of angles, whose columns are looked for elsewhere
        for delimiter in _DELIMITERS:
            if (delimiter is None or delimiter in line) and _is_header(line, delimiter):
                below = [angle_heading(f.strip(' "')) for f in split(following, delimiter, 8)]
                if sum(angle is not None for angle in below) > 1:
                    return False  # wavelengths above a header of angles
                return not _has_unknown_angles(split(line, delimiter), split(following, delimiter))
        fields = fields_of(line[:LONGEST_LINE])
        if len(fields) == 2 and all(NUMBER.fullmatch(f.removesuffix("nm")) for f in fields):
            pairs.append(float(fields[0].removesuffix("nm").replace(",", ".").replace("d", "e")))
            if len(pairs) == 3:
                low, high = HEADING_NM
                return low <= pairs[0] < pairs[1] < pairs[2] <= high
        elif pairs:
            return False
    return False


def is_multi_angle_table(head: bytes) -> bool:
    """Whether a file begins as a table of spectra that names geometries as instruments do."""
    if not is_samples_table(head):
        return False
    lines = decoded_beginning(head).splitlines()[: MOST_TITLES + 4]
    lines = [t for t in whole_lines(lines) if t.strip(" \t,;") and not t.lstrip().startswith("#")]
    for line, following in itertools.pairwise(lines):
        for delimiter in _DELIMITERS:
            if (delimiter is not None and delimiter not in line) or not _is_header(line, delimiter):
                continue
            headings, row = (
                [f.strip(' "') for f in split(text, delimiter)] for text in (line, following)
            )
            layout = spectral_columns(headings)
            numbers = sum(cells.is_number(row[k]) for k in layout.used if k < len(row))
            others = [k for k in range(len(headings)) if k not in layout.used]
            named = any(angle is not None for angle, _, _ in layout.spectra) or any(
                _GEOMETRY.fullmatch(headings[k]) or (k < len(row) and split_aspecular(row[k])[0])
                for k in others
            )
            return named and 2 * numbers > len(layout.used)
    return False


def _has_unknown_angles(headings: list[str], row: list[str]) -> bool:
    """Whether numbers stand in two columns or more that name neither a wavelength nor a sample."""
    used = spectral_columns([heading.strip(' "') for heading in headings]).used
    others = [k for k in range(min(len(headings), len(row))) if k not in set(used)]
    if any(_NAME.fullmatch(headings[k]) for k in others):
        return False
    return sum(cells.is_number(row[k].strip(' "')) for k in others) >= 2


# Wavelengths downwards


def _in_columns(
    path: Path, text: TextLines, beginning: _Beginning, result: SampleFile, part: str | None
) -> None:
    titles = [title for title in beginning.titles if not _QUANTITY.match(title)]
    first = beginning.first
    headings = fields_of(titles[-1]) if titles else []
    if len(first) < 2 or len(headings) != len(first):
        headings = []
    # An index before the wavelengths, or the wavelengths last.
    waves = [k for k, heading in enumerate(headings) if is_wavelength(heading)]
    wave = waves[0] if len(waves) == 1 else 0
    name = _keyword(_TITLE, titles) or path.stem
    columns = [
        k for k in range(len(first))
        if first[k] and k != wave and not (wave and headings[k].lower() in _INDEX)
    ]  # fmt: skip
    column = columns[0] if columns else 1
    if len(columns) > 1 and headings:
        names = [headings[k] or f"column {k + 1}" for k in columns]
        column = columns[chosen_part(path, names, part)]
        name = headings[column]
    elif part is not None:
        result.notes.append("--part is not used: the file holds one sample")
    heading = headings[column] if headings else ""
    _refuse_other(path, heading or (titles[-1] if titles else ""))

    def chosen(fields: list[str]) -> list[str]:
        if not headings or (len(fields) <= 2 and not wave):
            return fields
        return [
            fields[wave] if wave < len(fields) else "",
            fields[column] if column < len(fields) else "",
        ]

    rows = read_rows(path, text.lines(), WORDS, chosen)
    if len(rows) < 3:
        raise InputError(
            f"{path}: no spectrum: {len(rows)} lines begin with a wavelength; give two columns, "
            "wavelength (nm) and reflectance, from 400 to 700 nm or wider"
        )
    nm, values = in_order(path, rows, WORDS, result.notes)
    check_unit(path, nm)
    percent = True if beginning.numbers_percent else _percent([heading, *titles])
    result.samples.append(
        Sample(printable(name, LONGEST_NAME), nm, values, " ".join(titles), percent)
    )


def _keyword(pattern: re.Pattern[str], titles: list[str]) -> str:
    found = next((m for m in map(pattern.match, titles) if m), None)
    return found[1].strip(' ",;\t') if found else ""


def _percent(texts: list[str]) -> bool | None:
    texts = [" ".join(text[:LONGEST_LINE].split()) for text in texts]
    if any(text.strip() == "%" or _PERCENT.search(text) for text in texts):
        return True
    return False if any(_FRACTION.search(text) for text in texts) else None


def _refuse_other(path: Path, heading: str) -> None:
    found = _OTHER.search(heading)
    if found and "refl" not in heading.lower():
        raise InputError(
            f"{path}: the column is {printable(heading, 40)!r} and no reflectance; give the "
            "reflectance of the sample"
        )


# Wavelengths along a row


def _in_rows(path: Path, text: TextLines, beginning: _Beginning, result: SampleFile) -> None:
    assert beginning.header is not None
    delimiter, start = beginning.delimiter, beginning.header + 1
    header = next(itertools.islice(text.lines(), start - 1, None))
    headings = [f.strip().strip('"').strip() for f in split(header, delimiter, MOST_COLUMNS)]
    layout = spectral_columns(headings)
    others = [k for k in range(len(headings)) if k not in layout.used]
    named = [k for k in others if _NAME.fullmatch(headings[k])] or others[:1]
    geometry = next((k for k in others if _GEOMETRY.fullmatch(headings[k])), None)
    where = " ".join(beginning.titles)
    declared = _percent([*beginning.titles, *headings])
    result.source = _keyword(_SOURCE, beginning.titles)
    comma = False
    if delimiter != "," or text.has_quotes:
        below = _below(itertools.islice(text.lines(), start, None), delimiter, start + 1)
        comma = decimal_commas(f[k] for _, f in below for k in layout.used if k < len(f))
    below = _below(itertools.islice(text.lines(), start, None), delimiter, start + 1)
    for number, fields in below:
        words = [fields[k] for k in named if k < len(fields) and fields[k] and k != geometry]
        at = fields[geometry] if geometry is not None and geometry < len(fields) else ""
        name = " ".join(words)
        angle, _ = split_aspecular(at, whole=True)
        if angle is None:
            angle, name = split_aspecular(name)
        for column_angle, nm, columns in layout.spectra:
            texts = [fields[k] if k < len(fields) else "" for k in columns]
            signs = {t.endswith("%") for t in texts if cells.is_number(t.removesuffix("%"))}
            texts = [t.removesuffix("%").strip() for t in texts]
            if not signs:
                continue
            if max(columns) >= len(fields):
                raise InputError(
                    f"{path}: line {number}: {len(fields)} fields, the header in line {start} has "
                    f"{len(headings)}; complete the row, or remove it"
                )
            if len(signs) > 1:
                raise InputError(
                    f"{path}: line {number}: some values have a % sign and others have none; write "
                    "all of them alike"
                )
            sample = Sample(
                printable(name, LONGEST_NAME) or f"row {len(result.samples) + 1}",
                nm,
                _values(path, number, texts, comma),
                at or where,
                True if True in signs else declared,
                column_angle or angle,
            )
            add_sample(path, result, sample)
    if not result.samples:
        raise InputError(
            f"{path}: line {start}: no row of values follows the wavelengths; add the reflectances "
            "below them"
        )
    _name_unnamed(path, beginning.titles, result)
    distinguish(result)


def _name_unnamed(path: Path, titles: list[str], result: SampleFile) -> None:
    """Give the name of the file to its only sample, or to its geometries without another name."""
    name = printable(_keyword(_TITLE, titles) or path.stem, LONGEST_NAME)
    only = result.samples[0]
    of_quantity = only.name.lower().startswith(("reflect", "r ", "r%"))
    unnamed = all(re.fullmatch(r"row \d+", sample.name) for sample in result.samples)
    angles = all(sample.angle is not None for sample in result.samples)
    if (len(result.samples) == 1 and (unnamed or of_quantity)) or (unnamed and angles):
        result.samples[:] = [replace(sample, name=name) for sample in result.samples]


def decimal_commas(texts: Iterable[str]) -> bool:
    """Whether numbers have decimal commas and none has a point."""
    commas = False
    for text in texts:
        if cells.is_number(text):
            if "." in text:
                return False
            commas = commas or "," in text
    return commas


def _below(
    lines: Iterator[str], delimiter: str | None, first: int
) -> Iterator[tuple[int, list[str]]]:
    for number, line in enumerate(lines, first):
        if line.strip(" \t,;") and not line.lstrip().startswith("#"):
            yield number, [f.strip().strip('"').strip() for f in split(line, delimiter)]


def _values(path: Path, number: int, texts: list[str], comma: bool) -> Array:
    values = []
    for k, text in enumerate(texts):
        try:
            values.append(cells.reading(text, comma))
        except InputError as error:
            raise InputError(
                f"{path}: line {number}, wavelength {k + 1}: found {printable(text, 30)!r}, "
                f"expected a reflectance; {error}"
            ) from None
    return np.array(values)
