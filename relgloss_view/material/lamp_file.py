"""The spectrum of a lamp from a file of two columns, as spectrometers and spreadsheets save it."""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.decoding import decoded
from relgloss_view.base.errors import InputError
from relgloss_view.base.foreign import HEAD_BYTES, refuse_foreign
from relgloss_view.base.reading import decoding, printable, read_beginning, read_bytes
from relgloss_view.base.text_lines import TextLines

MAX_BYTES = 16 * 1024 * 1024
EXPECTED = "a lamp file of wavelength (nm) and power"
POWER_MAX = 1e100  # relative, and its sums must stay finite
#: Power this far below zero, as a share of the peak, is the noise of a spectrometer ...
NOISE = 1e-3
#: ... or this many standard deviations of the noise that the file shows, up to a share of the peak.
NOISE_DEVIATIONS, MOST_NOISE = 5.0, 1e-2
DARK, FEWEST_DARK = 0.02, 20  #: share of the peak, and how many such powers show the noise
OBSERVER_NM = (360.0, 830.0)  #: outside, nothing is seen (CIE 1931)
MOST_STEP_NM = 10.0
MOST_TITLES = 200  #: lines of words above the numbers
LONGEST_LINE = 4000  #: characters
MOST_ROWS = 100_000  #: wavelengths; from 200 to 1200 nm in steps of 0.01
MOST_LINES = 1_000_000

_NUMBER = re.compile(r"[+-]?(\d+[.,]?\d*|[.,]\d+)([eEdD][+-]?\d+)?", re.ASCII)
_NOTHING = frozenset(
    ("", "-", "--", "nan", "n/a", "na", "#n/a", "#value!", "#div/0!", "null", "none", "missing")
)


@dataclass(frozen=True)
class LampTable:
    """What a lamp file holds: increasing wavelengths (nm), powers of 0 or more, and notes."""

    wavelengths_nm: tuple[float, ...]
    power: tuple[float, ...]
    notes: tuple[str, ...]


@dataclass
class _Row:
    line: int
    nm: float
    power: float  #: NaN where the cell says nothing


def read_lamp(path: Path) -> LampTable:
    """Read wavelength (nm) and relative power, separated by comma, semicolon, tab or spaces.

    Lines of words above and below the numbers are passed over. Empty cells are interpolated from
    their neighbours; noise below zero is read as zero. Raises InputError that names line or
    wavelength, and the remedy.
    """
    refuse_foreign(read_beginning(path, HEAD_BYTES, EXPECTED), path)
    with decoding(path, EXPECTED):
        return _lamp(path)


def lamp_bytes(path: str | os.PathLike[str]) -> bytes:
    """A lamp's file as it is, to be kept beside what was drawn with it. Raises InputError."""
    return read_bytes(path, MAX_BYTES, EXPECTED)


def lamp_text(path: str | os.PathLike[str]) -> str:
    """The text of a lamp's file, its lines ended by \\n, to be kept with a study.

    Raises InputError.
    """
    data = lamp_bytes(path)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = decoded(data, os.fspath(path)).text
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _lamp(path: Path) -> LampTable:
    with TextLines(path, EXPECTED, most_bytes=MAX_BYTES, most_lines=MOST_LINES) as text:
        rows = _rows(path, text.lines())
        notes = [text.note] if text.note else []
    if len(rows) < 3:
        raise _too_little(path)
    nm, power = _in_order(path, rows, notes)
    _check_unit(path, nm)
    power = _filled(path, nm, power, rows, notes)
    power = _without_noise(path, nm, power, notes)
    _check_enough(path, nm, power)
    return LampTable(tuple(map(float, nm)), tuple(map(float, power)), tuple(notes))


def _rows(path: Path, lines: Iterable[str]) -> list[_Row]:
    rows: list[_Row] = []
    titles = 0
    ended: tuple[int, str] | None = None
    for number, line in enumerate(lines, 1):
        fields = _fields(line) if len(line) <= LONGEST_LINE else [line[:40]]
        if not any(fields) or fields[0].startswith("#"):
            continue
        row = _row(path, number, line, fields, not rows)
        if row is None:
            if rows:
                ended = ended or (number, line)
                continue
            titles += 1
            if titles > MOST_TITLES:
                break
            continue
        if ended is not None:
            raise _wrong(path, *ended)
        if len(rows) == MOST_ROWS:
            raise InputError(
                f"{path}: more than {MOST_ROWS} wavelengths; a lamp needs no finer steps than "
                "0.01 nm, so thin it out"
            )
        rows.append(row)
    if ended is not None and _NUMBER.fullmatch(_fields(ended[1])[0]):
        raise _wrong(path, *ended)
    return rows


def _fields(line: str) -> list[str]:
    """The cells of a line, without the empty ones that a spreadsheet appends."""
    text = line.strip().replace("\u2212", "-")
    delimiter = next((d for d in ";\t" if d in text), None)
    if '"' in text:
        text = re.sub(r'"?=""?([^"=]*)""?"?', r"\1", text)  # ="0.25"
    if delimiter is None and '"' in text:  # "450,5","0,25" or "450" 0.25
        mark = "," if re.search(r'"\s*,|,\s*"', text) else " "
        text = ";".join(next(csv.reader([text], delimiter=mark, skipinitialspace=True)))
        delimiter = ";" if ";" in text else None
    if delimiter is None and "," in text:
        delimiter = ","
        if re.fullmatch(r"\d+,\d+\s+[+-]?\d*,\d+([eE][+-]?\d+)?", text):
            delimiter = None  # spaces, and decimal commas
    fields = [_as_number(f.strip(' "\t')) for f in text.split(delimiter)]
    if delimiter == "," and len(fields) == 1:
        fields = text.split()
    while len(fields) > 2 and not fields[-1]:
        fields.pop()
    if len(fields) == 1 and delimiter is not None:
        fields.append("")
    return fields


def _as_number(cell: str) -> str:
    """A cell without what spreadsheets mark a text with, '0.5 or ="0.5", and without nm."""
    return re.sub(r"""^['=]["']?(?=[\d.,+-])|(?<=[\d.,])\s*nm$""", "", cell)


def _row(path: Path, number: int, line: str, fields: list[str], above: bool) -> _Row | None:
    """The row of a line, or None where it does not begin with a number."""
    first = fields[0]
    if len(line) > LONGEST_LINE:
        raise _wrong(path, number, line)
    if not _NUMBER.fullmatch(first):
        return None
    if len(fields) == 1 and first.isdecimal() and above:
        return None  # how many rows follow
    if len(fields) != 2:
        # "450,0.5 W" and three columns alike: which is meant is not for a program to guess.
        raise InputError(
            f"{path}: line {number}: expected wavelength (nm) and power, found {len(fields)} "
            f"field{'s' if len(fields) > 1 else ''}, {printable(line, 40)!r}; keep two columns"
        )
    second = fields[1].removesuffix("%").strip()
    if second.lower() in _NOTHING:
        return _Row(number, _float(first), float("nan"))
    if not _NUMBER.fullmatch(second):
        raise _wrong(path, number, line)
    nm, power = _float(first), _float(second)
    if not (0.0 < nm < np.inf and abs(power) <= POWER_MAX):
        raise InputError(
            f"{path}: line {number}: expected a wavelength above 0 and a power from 0 to "
            f"{POWER_MAX:g}, found {nm:g} and {power:g}"
        )
    return _Row(number, nm, power)


def _float(text: str) -> float:
    return float(text.replace(",", ".").lower().replace("d", "e"))


def _in_order(path: Path, rows: list[_Row], notes: list[str]) -> tuple[Array, Array]:
    """Wavelengths and powers in increasing order, each wavelength once."""
    nm = np.array([row.nm for row in rows])
    power = np.array([row.power for row in rows])
    steps = np.diff(nm)
    if np.any(steps <= 0.0):
        order = np.argsort(nm, kind="stable")
        if np.any(steps < 0.0) and not np.all(steps <= 0.0):
            line = rows[int(np.argmax(steps < 0.0)) + 1].line
            notes.append(f"the wavelengths do not increase at line {line}; they are sorted")
        rows[:] = [rows[k] for k in order]
        nm, power = nm[order], power[order]
    same = np.flatnonzero(np.diff(nm) == 0.0)
    for k in same:
        if power[k] != power[k + 1] and not np.isnan(power[k : k + 2]).all():
            first, second = sorted((rows[k].line, rows[k + 1].line))
            raise InputError(
                f"{path}: lines {first} and {second} give two powers of {nm[k]:g} nm; wavelengths "
                "must increase, each once"
            )
    once = np.r_[True, np.diff(nm) != 0.0]
    rows[:] = [row for row, kept in zip(rows, once, strict=True) if kept]
    return nm[once], power[once]


def _check_unit(path: Path, nm: Array) -> None:
    """InputError where the wavelengths are in another unit than nanometres."""
    low, high = float(nm[0]), float(nm[-1])
    for name, size in (("micrometres", 1e-3), ("ångströms", 10.0), ("metres", 1e-9)):
        if len(nm) > 1 and 180 * size <= low <= 400 * size and 700 * size <= high <= 3000 * size:
            if name == "ångströms" and low <= 800.0:
                continue
            raise InputError(
                f"{path}: the wavelengths, {low:g} to {high:g}, look like {name}; give nanometres"
            )


def _filled(path: Path, nm: Array, power: Array, rows: list[_Row], notes: list[str]) -> Array:
    """The powers with empty cells interpolated between their neighbours."""
    empty = np.isnan(power)
    if not np.any(empty):
        return power
    if np.all(empty):
        raise _too_little(path)
    inside = empty & (nm > nm[~empty][0]) & (nm < nm[~empty][-1])
    widest = float(np.max(np.diff(nm[~empty]), initial=0.0))
    if widest > MOST_STEP_NM:
        at = int(np.argmax(np.diff(nm[~empty])))
        raise InputError(
            f"{path}: no power from {nm[~empty][at]:g} to {nm[~empty][at + 1]:g} nm; a lamp needs "
            f"power from 400 to 700 nm or wider, in steps of at most {MOST_STEP_NM:g} nm"
        )
    if np.any(inside):
        first = int(np.argmax(inside))
        count = int(np.sum(inside))
        more = f" and {count - 1} more" if count > 1 else ""
        notes.append(
            f"no power at {nm[first]:g} nm (line {rows[first].line}){more}: interpolated between "
            "the neighbours"
        )
    return np.where(inside, np.interp(nm, nm[~empty], power[~empty]), np.where(empty, 0.0, power))


def _without_noise(path: Path, nm: Array, power: Array, notes: list[str]) -> Array:
    """The powers with noise below zero read as zero.

    Noise is below a thousandth of the peak, or what the file shows all over: a weak lamp's is more.
    Where no eye sees, any amount is.
    """
    low, high = OBSERVER_NM
    seen = (nm >= low) & (nm <= high)
    peak = float(np.max(power[seen], initial=0.0))
    limit = max(NOISE * peak, min(NOISE_DEVIATIONS * _noise(power, peak), MOST_NOISE * peak))
    below = power < 0.0
    too_low = below & seen & (power < -limit)
    if np.any(too_low):
        k = int(np.argmin(np.where(too_low, power, np.inf)))
        raise InputError(
            f"{path}: the power at {nm[k]:g} nm is {power[k]:.3g}, below zero by more than noise "
            f"(peak {peak:.3g}); subtract the dark signal and give a power from 0"
        )
    if np.any(below):
        count, lowest = int(np.sum(below)), float(np.min(power))
        notes.append(
            f"{count} power{'s' if count > 1 else ''} down to {lowest:.2g} "
            f"{'are' if count > 1 else 'is'} read as 0: noise about zero (peak {peak:.3g})"
        )
    return np.where(below, 0.0, power)


def _noise(power: Array, peak: float) -> float:
    """Standard deviation of the noise where the lamp gives next to nothing; 0 where unseen.

    It is estimated from second differences, whose variance is six times that of one power
    (von Neumann 1941); their median (over 0.6745, Hampel 1974) sees no lines.
    """
    dark = np.abs(power) < DARK * peak
    differences = np.diff(power, 2)[dark[:-2] & dark[1:-1] & dark[2:]]
    if len(differences) < FEWEST_DARK:
        return 0.0
    return float(np.median(np.abs(differences)) / (0.6745 * np.sqrt(6.0)))


def _check_enough(path: Path, nm: Array, power: Array) -> None:
    inside = (nm >= 380.0) & (nm <= 780.0)
    if (
        not np.any(inside)
        or nm[inside][0] > 400.0
        or nm[inside][-1] < 700.0
        or float(np.max(np.diff(nm), initial=0.0)) > MOST_STEP_NM
        or not np.any(power[inside] > 0.0)
    ):
        raise _too_little(path)


def _too_little(path: Path) -> InputError:
    return InputError(
        f"{path}: a lamp needs power from 400 to 700 nm or wider, in steps of at most "
        f"{MOST_STEP_NM:g} nm"
    )


def _wrong(path: Path, number: int, line: str) -> InputError:
    return InputError(
        f"{path}: line {number}: expected wavelength (nm) and power, found {printable(line, 40)!r}"
    )
