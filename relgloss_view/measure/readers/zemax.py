"""Zemax tabular BSDF (.bsdf), which Radiant's Imaging Sphere and others write: reflection.

The file has a header of keywords, then, for each rotation of the sample and each angle of
incidence, rows of BRDFs in 1/sr: a row an azimuth, a column a radial angle. Both angles are about
the mirror direction: radial 0 is the mirror direction, and azimuth 0 points from there to the
normal. The combinations that lie below the horizon hold anything.

Source: Rykowski 2008, "BSDF Data Interchange File Format Specification" (Radiant Imaging).
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.decoding import decoded
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import named, printable, read_bytes
from relgloss_view.measure.gonio import from_normal, spherical
from relgloss_view.measure.readers.assemble import assemble, one_channel
from relgloss_view.measure.readers.declared import Declared
from relgloss_view.measure.readers.options import ReadOptions
from relgloss_view.measure.readers.tristimulus import rgb_of
from relgloss_view.measure.table import Measurement

EXPECTED = "a Zemax BSDF file"
MOST_BYTES = 64_000_000
LARGEST = 1e9  #: 1/sr; a perfect mirror seen through the finest instrument stays below
MOST_LINES = 1_200_000
SHORT_ROW = 16  #: numbers
MOST_READINGS = 1_000_000  #: of one channel
#: Zeros beyond this polar angle show where the instrument's view ends; readings within RIM_DEG of
#: it are left out, as those are that lie as near to the horizon.
RIM_BEYOND_DEG = 70.0
RIM_DEG = 3.0
#: Axes of the table in the order of its numbers, with the least and largest angle, degrees.
AXES = {
    "samplerotation": (-360.0, 360.0),
    "angleofincidence": (0.0, 90.0),
    "scatterazimuth": (-360.0, 360.0),
    "scatterradial": (0.0, 180.0),
}
_CHANNELS = {"monochrome": "", "tristimulusx": "X", "tristimulusy": "Y", "tristimulusz": "Z"}
_SYMMETRIES = ("planesymmetrical", "asymmetrical", "asymmetrical4d")
_WORDS = {
    "source": (),
    "symmetry": _SYMMETRIES,
    "spectralcontent": ("monochrome", "xyz"),
    "scattertype": ("brdf", "btdf"),
}


def read(path: Path, options: ReadOptions) -> Measurement:
    """Read the reflection of a Zemax BSDF file. Raises InputError.

    options: a quantity replaces the BRDF; the others have no use and give a warning.
    """
    text = decoded(read_bytes(path, MOST_BYTES, EXPECTED), named(path))
    table = _Parser(path).parse(text.text)
    axes = [table.axes[name] for name in AXES]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    stacked = np.stack([np.asarray(table.values[c]) for c in sorted(table.values)], axis=-1)
    readings = stacked.reshape(*grid.shape[:-1], -1)
    once = _once(axes, readings)
    angles, values = grid[once], readings[once]

    notes = [text.note] if text.note else []
    lamp, receiver = directions(*angles.T)
    unread, rim = unread_of(values, receiver)
    notes += rim
    values = np.where(unread[:, None], np.nan, values)
    if len(axes[0]) > 1:
        notes.append(f"{len(axes[0])} rotations of the sample are read as one isotropic sample")
    notes += table.notes
    if values.shape[1] == 3:
        bands, values, more = rgb_of(values)
        notes += more
    else:
        bands, values, gray = one_channel(values, "monochrome")
        notes.append(gray)
    source = f"{path.name}, Zemax BSDF format (Rykowski 2008)"
    facts = Declared.of_brdf(path.stem, source, options, notes)
    measurement = assemble(path, facts, angles, bands, values, (lamp, receiver), angles[:, 1])
    unused = options.unused("gamma_s_deg", "angle_unit", "mirror", "part")
    return replace(measurement, warnings=(*measurement.warnings, *unused))


def unread_of(values: Array, receiver: Array) -> tuple[Mask, list[str]]:
    """Which readings (N, C) the instrument did not take, and a note about them.

    It writes zeros where it sees nothing. Where these begin near the horizon its view ends, and
    what lies just within is mixed with them.
    """
    unread = np.asarray((values == 0.0).all(axis=1))
    polar = from_normal(receiver)
    outer = polar[unread & (polar < 90.0)]
    if not len(outer):
        return unread, []
    notes = [f"{len(outer)} zeros above the horizon count as not measured"]
    rim = float(outer.min())
    if rim >= RIM_BEYOND_DEG:
        within = ~unread & (polar >= rim - RIM_DEG) & (polar < 90.0)
        unread |= within
        notes.append(
            f"{int(within.sum())} readings within {RIM_DEG:g} deg of the rim of the instrument's "
            f"view, {rim:.0f} deg from the normal, are left out"
        )
    return unread, notes


def directions(
    rotation: Array, incidence: Array, azimuth: Array, radial: Array
) -> tuple[Array, Array]:
    """Unit vectors to lamp and receiver, (N, 3) each, of the file's angles in degrees, (N,) each.

    >>> lamp, receiver = directions(*np.array([[0.0], [30.0], [0.0], [30.0]]))
    >>> bool(np.allclose(receiver, [0.0, 0.0, 1.0]))  # from the mirror direction to the normal
    True
    """
    theta, turn = np.radians(incidence), np.radians(rotation)
    zero = np.zeros_like(theta)
    mirror = np.stack([np.sin(theta), zero, np.cos(theta)], axis=-1)
    inwards = np.stack([-np.cos(theta), zero, np.sin(theta)], axis=-1)
    aside = np.array([0.0, -1.0, 0.0])
    a, r = np.radians(azimuth)[:, None], np.radians(radial)[:, None]
    receiver = np.cos(r) * mirror + np.sin(r) * (np.cos(a) * inwards + np.sin(a) * aside)
    x, y = receiver[:, 0].copy(), receiver[:, 1].copy()
    # The sample turns under lamp and receiver: in its frame both turn back.
    receiver[:, 0] = np.cos(turn) * x + np.sin(turn) * y
    receiver[:, 1] = np.cos(turn) * y - np.sin(turn) * x
    return spherical(incidence, 180.0 - rotation), receiver


def _once(axes: list[Array], readings: Array) -> Mask:
    """Which readings (R, I, A, P) are no copy of another: at radial 0, and at azimuth 360."""
    once = np.ones(readings.shape[:-1], dtype=bool)
    for k in np.flatnonzero(np.abs(axes[3]) < 1e-9).tolist():
        at_pole = readings[:, :, :, k]
        if np.array_equal(at_pole, np.broadcast_to(at_pole[:, :, :1], at_pole.shape)):
            once[:, :, 1:, k] = False
    for k in range(1, len(axes[2])):
        same = abs(axes[2][k] - axes[2][0]) == 360.0
        if same and np.array_equal(readings[:, :, k], readings[:, :, 0]):
            once[:, :, k] = False
    return once


@dataclass
class _Table:
    axes: dict[str, Array] = field(default_factory=dict)
    words: dict[str, str] = field(default_factory=dict)
    values: dict[str, array[float]] = field(default_factory=dict)  #: of each channel
    notes: list[str] = field(default_factory=list)


class _Parser:
    """Reads line by line; its faults name the line."""

    def __init__(self, path: Path) -> None:
        self._place, self._table = named(path), _Table()
        self._line = 0
        self._channel: str | None = None
        self._count = 0  #: of the numbers in this channel
        self._in_data = False

    def parse(self, text: str) -> _Table:
        lines = self._lines(text)
        unknown = None
        for words in lines:
            key = words[0].lower().rstrip(":")
            if key in AXES:
                self._axis(key, words, lines)
            elif key in _WORDS:
                self._word(key, words)
            elif key in _CHANNELS:
                self._begin(_CHANNELS[key])
            elif key == "databegin":
                self._in_data = True
                if self._channel is None:
                    self._begin("")
            elif key == "dataend":
                self._in_data = False
            elif key == "tis":
                self._check_block()
            elif self._in_data:
                self._row(words)
            elif unknown is None:
                unknown = (self._line, " ".join(words))
        if unknown is not None:
            line, words_there = unknown
            self._table.notes.append(f"passed over line {line}: {printable(words_there, 40)!r}")
        self._check_end()
        return self._table

    def _lines(self, text: str) -> Iterator[list[str]]:
        if text.count("\n") > MOST_LINES:
            raise InputError(f"{self._place}: more than {MOST_LINES} lines; give {EXPECTED}")
        for number, line in enumerate(text.splitlines(), start=1):
            # Split no further than any row goes: the parts of a line take much more than the line.
            line = line.partition("#")[0].replace(";", " ")
            words = [w for w in line.split(None, MOST_READINGS) if w.strip(",")]
            if words:
                self._line = number
                yield words

    def _fail(self, what: str) -> InputError:
        return InputError(f"{self._place}: line {self._line}: {what}")

    def _word(self, key: str, words: list[str]) -> None:
        value = words[1].lower() if len(words) > 1 else ""
        allowed = _WORDS[key]
        if allowed and value not in allowed:
            raise self._fail(
                f"{words[0]} {printable(' '.join(words[1:]), 30)!r}; expected one of "
                f"{', '.join(allowed)}"
            )
        if value == "btdf":
            raise self._fail(
                "ScatterType BTDF: the file holds transmission, and relgloss draws reflection; "
                "give the file of the BRDF"
            )
        self._table.words[key] = value

    def _axis(self, key: str, words: list[str], lines: Iterator[list[str]]) -> None:
        name = words[0]
        if len(words) < 2 or not words[1].isdecimal() or not 0 < len(words[1]) <= 7:
            raise self._fail(f"{name}: expected the number of angles")
        count, texts = int(words[1]), words[2:]
        if not 0 < count <= MOST_READINGS:
            raise self._fail(f"{name}: {count} angles; expected 1 to {MOST_READINGS}")
        while len(texts) < count:
            more = next(lines, None)
            if more is None or more[0][0].isalpha():
                raise self._fail(f"{name}: {len(texts)} angles where {count} are declared")
            texts += more
        if len(texts) > count:
            raise self._fail(f"{name}: {len(texts)} angles where {count} are declared")
        low, high = AXES[key]
        angles = self._numbers(texts)
        if not ((angles >= low) & (angles <= high)).all():  # False for NaN
            raise self._fail(f"{name}: expected angles from {low:g} to {high:g} degrees")
        self._table.axes[key] = angles

    def _begin(self, channel: str) -> None:
        if channel in self._table.values:
            raise self._fail(f"a second block of {channel or 'Monochrome'} data")
        if self._channel is not None:
            self._check_whole()
        self._channel, self._count, self._in_data = channel, 0, False
        self._table.values[channel] = array("d")
        missing = [name for name in AXES if name not in self._table.axes]
        if "samplerotation" in missing:
            self._table.axes["samplerotation"] = np.zeros(1)
            missing.remove("samplerotation")
        if missing:
            raise self._fail(f"the data begin before {', '.join(missing)}; the header is damaged")
        if self._expected() > MOST_READINGS:
            raise self._fail(f"{self._expected()} readings; at most {MOST_READINGS} are read")

    def _expected(self) -> int:
        count = 1
        for axis in self._table.axes.values():
            count *= len(axis)
        return count

    def _row(self, words: list[str]) -> None:
        if self._channel is None or self._count + len(words) > self._expected():
            raise self._fail(f"more numbers than the {self._expected()} that the header declares")
        self._table.values[self._channel].extend(self._few(words) or self._numbers(words))
        self._count += len(words)

    def _check_block(self) -> None:
        block = len(self._table.axes.get("scatterazimuth", ())) * len(
            self._table.axes.get("scatterradial", ())
        )
        if block and self._count % block:
            raise self._fail(
                f"TIS after {self._count % block} of the {block} numbers of an incidence; "
                "complete the rows above"
            )

    def _check_whole(self) -> None:
        if self._count != self._expected():
            raise self._fail(
                f"the data end after {self._count} of {self._expected()} numbers; "
                "the file is cut off or its header is wrong"
            )

    def _check_end(self) -> None:
        if self._channel is None:
            raise self._fail("no data; expected DataBegin and rows of numbers")
        self._check_whole()
        channels = set(self._table.values)
        if channels not in ({""}, {"X", "Y", "Z"}):
            lacking = ", ".join(sorted({"X", "Y", "Z"} - channels))
            raise self._fail(f"the blocks of Tristimulus {lacking} are missing; export all three")

    def _few(self, words: list[str]) -> list[float]:
        """The numbers of a short row that is sound, [] of any other, for which arrays are slow."""
        if len(words) > SHORT_ROW:
            return []
        try:
            numbers = list(map(float, words))
        except ValueError:
            return []
        return numbers if all(abs(number) <= LARGEST for number in numbers) else []

    def _numbers(self, words: list[str]) -> Array:
        try:
            numbers = np.array([float(w) for w in words])
        except ValueError:
            try:  # decimal commas, or commas behind numbers
                numbers = np.array([float(w.rstrip(",").replace(",", ".")) for w in words])
            except ValueError:
                shown = printable(" ".join(words), 40)
                raise self._fail(f"found {shown!r}, expected numbers separated by spaces") from None
        if np.nanmax(np.abs(numbers), initial=0.0) > LARGEST:
            raise self._fail(f"a number above {LARGEST:g}, which no BRDF reaches; correct it")
        return numbers
