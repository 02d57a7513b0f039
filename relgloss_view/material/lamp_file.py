"""The spectrum of a lamp from a file of two columns, as spectrometers and spreadsheets save it."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.decoding import decoded
from relgloss_view.base.errors import InputError
from relgloss_view.base.foreign import HEAD_BYTES, refuse_foreign
from relgloss_view.base.reading import decoding, read_beginning, read_bytes
from relgloss_view.base.text_lines import TextLines
from relgloss_view.base.two_columns import (
    MOST_LINES,
    Row,
    Words,
    check_unit,
    in_order,
    read_rows,
)

MAX_BYTES = 16 * 1024 * 1024
EXPECTED = "a lamp file of wavelength (nm) and power"
#: Power this far below zero, as a share of the peak, is the noise of a spectrometer ...
NOISE = 1e-3
#: ... or this many standard deviations of the noise that the file shows, up to a share of the peak.
NOISE_DEVIATIONS, MOST_NOISE = 5.0, 1e-2
DARK, FEWEST_DARK = 0.02, 20  #: share of the peak, and how many such powers show the noise
OBSERVER_NM = (360.0, 830.0)  #: outside, nothing is seen (CIE 1931)
MOST_STEP_NM = 10.0
WORDS = Words("a lamp", "power")


@dataclass(frozen=True)
class LampTable:
    """What a lamp file holds: increasing wavelengths (nm), powers of 0 or more, and notes."""

    wavelengths_nm: tuple[float, ...]
    power: tuple[float, ...]
    notes: tuple[str, ...]


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
        rows = read_rows(path, text.lines(), WORDS)
        notes = [text.note] if text.note else []
    if len(rows) < 3:
        raise _too_little(path)
    nm, power = in_order(path, rows, WORDS, notes)
    check_unit(path, nm)
    power = _filled(path, nm, power, rows, notes)
    power = _without_noise(path, nm, power, notes)
    _check_enough(path, nm, power)
    return LampTable(tuple(map(float, nm)), tuple(map(float, power)), tuple(notes))


def _filled(path: Path, nm: Array, power: Array, rows: list[Row], notes: list[str]) -> Array:
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
