"""Speos (OPTIS) tables of reflection as text: .anisotropicbsdf and .brdf.

A header of rows, then a block of readings for each incidence: a row a polar angle, a column an
azimuth, both about the normal; the mirror direction is at (incidence, 0). Readings are relative. In
.anisotropicbsdf a spectrum of reflectance at one incidence gives their level: the block of that
incidence reflects as much over the hemisphere, and the others keep their ratio to it. In .brdf each
block, of an incidence and a wavelength, has its own reflectance.

Sources: Ansys, Speos user's guides, "Structure of Anisotropic BSDF Files" and "Structure of BRDF
files" (2024 R2); Ansys' converter between Speos and Zemax (optical-automation, MIT licence).
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.decoding import decoded
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import named, printable, read_bytes
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.gonio import spherical
from relgloss_view.measure.readers.assemble import assemble, one_channel
from relgloss_view.measure.readers.declared import Declared
from relgloss_view.measure.readers.options import ReadOptions
from relgloss_view.measure.readers.zemax import unread_of
from relgloss_view.measure.table import Measurement

EXPECTED = "a Speos BSDF file"
MOST_BYTES = 64_000_000
MOST_ANGLES = 10_000
MOST_READINGS = 3_000_000
MOST_DIRECTIONS = 150_000  #: more are thinned
MOST_LINES = 100_000  #: of a measurement's description
LARGEST = 1e9
#: Versions of the layout, of which the converter writes and reads the first, and Speos the second.
VERSIONS = {"anisotropic bsdf": (7.0, 8.0), "brdf": (8.0, 8.0)}
#: Wavelengths at which a spectrum between stated ones is taken, nm.
SEEN_NM = np.arange(400.0, 701.0, 10.0)
LEAST_COSINE = 1e-3  #: below which an intensity is no radiance
_HEADER = re.compile(r"OPTIS[ -]+(Anisotropic BSDF|brdf) surface file v(\d+(?:\.\d+)?)", re.I)


class _Block(NamedTuple):
    """Readings of one incidence: BRDF up to a factor, and its share of the light."""

    incidence: float  #: degrees
    theta: Array  #: (T,), degrees
    phi: Array  #: (P,)
    values: Array  #: (T, P), as stored
    brdf: Array  #: (T, P), up to the factor
    whole: float  #: the hemisphere's reflectance, up to the factor


class _Table(NamedTuple):
    bands: Bands | None  #: None for one channel
    label: str  #: of one channel
    blocks: list[_Block]  #: of the first wavelength
    readings: list[Array]  #: (T, P, B) of each block, 1/sr
    notes: list[str]


def read(path: Path, options: ReadOptions) -> Measurement:
    """Read the reflection of a .anisotropicbsdf or .brdf text file. Raises InputError.

    options: a quantity replaces the BRDF; the others have no use and give a warning.
    """
    text = decoded(read_bytes(path, MOST_BYTES, EXPECTED), named(path))
    table = _Rows(path, text.text).table()
    notes = [text.note] if text.note else []
    step = 1 + sum(block.values.size for block in table.blocks) // MOST_DIRECTIONS
    angles, values = [], []
    for block, readings in zip(table.blocks, table.readings, strict=True):
        grid = np.stack(np.meshgrid(block.theta, block.phi, indexing="ij"), axis=-1)
        kept = _once(block)
        kept[:, [k for k in range(len(block.phi)) if k % step]] = False
        place = grid[kept]
        angles.append(np.column_stack([np.full(len(place), block.incidence), place]))
        values.append(readings[kept])
    angle, value = np.concatenate(angles), np.concatenate(values)
    if step > 1:
        notes.append(f"every azimuth of {step} is read; the file holds more than are needed")
    lamp = spherical(angle[:, 0], np.full(len(angle), 180.0))
    receiver = spherical(angle[:, 1], angle[:, 2])
    unread, rim = unread_of(value, receiver)
    value = np.where(unread[:, None], np.nan, value)
    bands = table.bands
    notes += [*rim, *table.notes]
    if bands is None:
        bands, value, gray = one_channel(value, table.label)
        notes.append(gray)
    source = f"{path.name}, Speos BSDF format (Ansys)"
    facts = Declared.of_brdf(path.stem, source, options, notes)
    measurement = assemble(path, facts, angle, bands, value, (lamp, receiver), angle[:, 0])
    unused = options.unused("gamma_s_deg", "angle_unit", "mirror", "part")
    return replace(measurement, warnings=(*measurement.warnings, *unused))


def _once(block: _Block) -> Mask:
    """Which readings (T, P) are no copy of another: at the pole, and at azimuth 360."""
    once = np.ones(block.values.shape, dtype=bool)
    once[block.theta == 0.0, 1:] = False
    if len(block.phi) > 1 and block.phi[-1] - block.phi[0] == 360.0:
        once[:, -1] = False
    return once


def hemisphere(theta: Array, phi: Array, values: Array) -> float:
    """The integral of values (T, P) over solid angle, linear between the nodes; degrees.

    One azimuth holds for all; azimuths over half a turn are mirrored; a gap behind the last one of
    a turn is closed.

    >>> theta, phi = np.linspace(0.0, 90.0, 91), np.array([0.0, 180.0])
    >>> cosine = np.repeat(np.cos(np.radians(theta))[:, None], 2, axis=1)
    >>> round(hemisphere(theta, phi, cosine) / np.pi, 3)
    1.0
    """
    if len(phi) == 1:
        around = 2.0 * np.pi * values[:, 0]
    else:
        span = phi[-1] - phi[0]
        if span > 181.0 and span < 359.999:
            phi = np.append(phi, phi[0] + 360.0)
            values = np.column_stack([values, values[:, 0]])
        turns = 2.0 if span <= 181.0 else 1.0
        around = turns * np.asarray(np.trapezoid(values, np.radians(phi), axis=1))
    polar = np.radians(theta)
    return float(np.trapezoid(around * np.sin(polar), polar))


class _Rows:
    """Reads row by row; its faults name the line."""

    def __init__(self, path: Path, text: str) -> None:
        self._place, self._lines, self._at = named(path), text.splitlines(), 0
        self._is_brdf = False  #: of the readings, instead of intensities
        self._left = MOST_READINGS

    def table(self) -> _Table:
        found = _HEADER.match(self._line().strip())
        kind = found[1].lower() if found else ""
        low, high = VERSIONS.get(kind, (0.0, 0.0))
        if found is None or not low <= float(found[2]) <= high:
            raise self._fail(
                "a layout of another version; open the file in the viewer of Speos and save it"
            )
        if self._line().strip() != "0":
            raise self._fail("a binary file; save it as text in the viewer of Speos")
        self._line()  # a comment
        (characters,) = self._integers(1, least=0, most=10**7)
        for _ in range(MOST_LINES):
            characters -= len(self._line()) + 1
            if characters < 0:
                break
        if kind == "brdf":
            return self._by_wavelength()
        self._line()  # the direction on the part from which rotations are counted
        return self._by_spectrum()

    def _by_wavelength(self) -> _Table:
        notes = self._parts()
        incidences, wavelengths = self._integers(2)
        incidence = self._angles(incidences, 0.0, 90.0)
        nm = self._numbers(self._line().split(), wavelengths)
        blocks, readings = [], []
        for angle in incidence:
            of_bands, first = [], None
            for _ in range(wavelengths):
                (percent,) = self._numbers(self._line().split(), 1)
                block = self._block(float(angle))
                if first is not None and not (
                    np.array_equal(first.theta, block.theta)
                    and np.array_equal(first.phi, block.phi)
                ):
                    raise self._fail("the angles of an incidence differ between wavelengths")
                first = first or block
                of_bands.append(self._level(block, percent) * block.brdf)
            assert first is not None
            blocks.append(first)
            readings.append(np.stack(of_bands, axis=-1))
        if wavelengths == 1:
            return _Table(None, f"{nm[0]:g} nm", blocks, readings, notes)
        return _Table(self._bands(nm), "", blocks, readings, notes)

    def _by_spectrum(self) -> _Table:
        notes = self._parts()
        incidences = self._rotations()
        if notes:
            self._rotations()
        measured, nm, percent = self._spectrum()
        if notes:
            self._spectrum()
        blocks = [self._block(angle) for angle in incidences]
        if len(set(incidences)) < len(incidences):
            notes.append("several rotations of the sample are read as one isotropic sample")
        # Between two incidences the documents weight their hemispheres by the distance to each.
        stated, which = np.unique(incidences, return_inverse=True)
        whole = np.array([block.whole for block in blocks])
        means = np.bincount(which, weights=whole) / np.bincount(which)
        level = float(np.interp(measured, stated, means))
        if not level > 0.0:
            raise self._fail("the readings of the incidence of the spectrum are all zero")
        if np.ptp(percent) == 0.0:
            share = np.array([percent[0]])
            bands, label = None, "the same at all wavelengths"
        else:
            seen = SEEN_NM[(nm[0] <= SEEN_NM) & (nm[-1] >= SEEN_NM)]
            if len(seen) < 2:
                raise self._fail(f"the spectrum reaches from {nm[0]:g} to {nm[-1]:g} nm alone")
            share, bands, label = np.interp(seen, nm, percent), self._bands(seen), ""
        readings = [block.brdf[..., None] * (0.01 * share / level) for block in blocks]
        return _Table(bands, label, blocks, readings, notes)

    def _parts(self) -> list[str]:
        """A note where the file holds transmission too, whose blocks come last."""
        reflection, transmission = self._integers(2, least=0, most=1)
        if not reflection:
            raise self._fail("the file holds transmission alone, and relgloss draws reflection")
        self._is_brdf = bool(self._integers(1, least=0, most=1)[0])
        return ["the transmission of the file is passed over"] if transmission else []

    def _rotations(self) -> list[float]:
        """Incidences of all rotations of the sample, one after the other."""
        (count,) = self._integers(1)
        self._angles(count, -360.0, 360.0)
        incidences: list[float] = []
        for _ in range(count):
            (several,) = self._integers(1)
            incidences += self._angles(several, 0.0, 90.0).tolist()
            if len(incidences) > MOST_ANGLES:
                raise self._fail(f"more than {MOST_ANGLES} incidences")
        return incidences

    def _spectrum(self) -> tuple[float, Array, Array]:
        """The incidence of a spectrum, its wavelengths in nm and reflectances in percent."""
        measured = float(self._numbers(self._line().split(), 2)[0])
        self._line()  # a description
        (count,) = self._integers(1)
        rows = np.array([self._numbers(self._line().split(), 2) for _ in range(count)])
        nm, percent = rows.T
        if (np.diff(nm) <= 0.0).any() or nm[0] <= 0.0 or percent.min() < 0.0:
            raise self._fail("the spectrum above does not increase, or is negative")
        return measured, nm, percent

    def _block(self, incidence: float) -> _Block:
        thetas, phis = self._integers(2)
        self._left -= thetas * phis
        if self._left < 0:
            raise self._fail(f"more than {MOST_READINGS} readings")
        phi = self._angles(phis, -360.0, 360.0, increasing=True)
        rows = np.array([self._numbers(self._line().split(), phis + 1) for _ in range(thetas)])
        theta, values = rows[:, 0], rows[:, 1:]
        if (np.diff(theta) <= 0.0).any() or theta[0] < 0.0 or theta[-1] > 90.0:
            raise self._fail(
                "polar angles of a block of reflection that do not rise within 0 to 90"
            )
        cosine = np.cos(np.radians(theta))[:, None]
        if self._is_brdf:
            return _Block(
                incidence, theta, phi, values, values, hemisphere(theta, phi, values * cosine)
            )
        grazing = cosine < LEAST_COSINE
        brdf = np.where(grazing, 0.0, values / np.where(grazing, 1.0, cosine))
        return _Block(incidence, theta, phi, values, brdf, hemisphere(theta, phi, values))

    def _level(self, block: _Block, percent: float) -> float:
        if not (block.whole > 0.0 and percent >= 0.0):
            raise self._fail(
                "the readings of this incidence are all zero, or its share is negative"
            )
        return 0.01 * percent / block.whole

    def _bands(self, nm: Array) -> Bands:
        try:
            return Bands(tuple(nm.tolist()))
        except InputError as error:
            raise self._fail(str(error)) from None

    def _fail(self, what: str) -> InputError:
        return InputError(f"{self._place}: line {self._at}: {what}")

    def _line(self) -> str:
        if self._at >= len(self._lines):
            raise self._fail("the file ends here; it is cut off")
        self._at += 1
        return self._lines[self._at - 1]

    def _integers(self, count: int, *, least: int = 1, most: int = MOST_ANGLES) -> list[int]:
        words = self._line().split()
        if len(words) != count or not all(w.isdecimal() and len(w) < 9 for w in words):
            shown = printable(" ".join(words[:4]), 40)
            raise self._fail(f"found {shown!r}, expected {count} whole number(s)")
        values = [int(word) for word in words]
        if max(values) > most or min(values) < least:
            raise self._fail(f"found {printable(' '.join(words), 40)}, expected {least} to {most}")
        return values

    def _angles(self, count: int, low: float, high: float, *, increasing: bool = False) -> Array:
        angles = self._numbers(self._line().split(), count)
        rising = not increasing or bool((np.diff(angles) > 0.0).all())
        if not rising or not ((angles >= low) & (angles <= high)).all():
            raise self._fail(f"expected {count} angles from {low:g} to {high:g} degrees")
        return angles

    def _numbers(self, words: list[str], count: int) -> Array:
        if len(words) != count:
            raise self._fail(f"{len(words)} numbers, expected {count}")
        try:
            numbers = np.array(words, dtype=np.float64)
        except ValueError:
            shown = printable(" ".join(words[:4]), 40)
            raise self._fail(f"found {shown!r}, expected numbers") from None
        if not (np.abs(numbers) <= LARGEST).all():
            raise self._fail(f"a number above {LARGEST:g}, or none; correct it")
        return numbers
