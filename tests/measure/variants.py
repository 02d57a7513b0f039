"""Variants of one table and of one lamp, as spreadsheets, languages and instruments write them.

Run as a program, it counts what is read rightly, refused with the right remedy, and read wrongly:
`PYTHONPATH=. python tests/measure/variants.py [COUNT]`.
"""

# ruff: noqa: E501 - a line of the table of changes is read as one
from __future__ import annotations

import random
import re
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from relgloss_view.base.errors import InputError
from relgloss_view.measure.readers import read_measurement
from relgloss_view.measure.table import Measurement

READ, REFUSED, WRONG = "read", "refused", "wrong"
WAVELENGTHS = (400, 460, 520, 580, 640, 700)


def _reading(row: int, band: int) -> float:
    """A reading of five digits, which every way to write it keeps."""
    return float(f"{0.05 + 0.0712 * band + 0.00317 * row + 0.9 * (row % 7 == 3):.5g}")


@dataclass(frozen=True)
class Sheet:
    """A table as cells, and how a program writes them."""

    above: tuple[tuple[str, ...], ...]
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    angles: int  #: columns of angles, from the first
    units: tuple[tuple[str, ...], ...] = ()
    below: tuple[tuple[str, ...], ...] = ()
    delimiter: str = ","
    comma: bool = False
    quote: str = "needed"
    end: str = "\n"
    encoding: str = "utf-8"
    pad: str = ""
    remedy: str | None = None  #: a pattern of the message where the variant can't be read
    either: bool = False  #: reading rightly is fine too where there is a remedy
    applied: tuple[str, ...] = field(default=())

    def lines(self) -> list[list[str]]:
        """All lines as cells."""
        numbers, below = list(map(list, self.rows)), list(map(list, self.below))
        if self.comma:
            numbers = [[_comma(c) for c in row] for row in numbers]
            below = [[_comma(c) for c in row] for row in below]
        every = [*map(list, self.above), list(self.header), *map(list, self.units), *numbers, *below]  # fmt: skip
        if self.pad == "all":
            most = max(map(len, every)) + 2
            every = [line + [""] * (most - len(line)) for line in every]
        if self.pad == "same":
            most = max(map(len, every))
            every = [line + [""] * (most - len(line)) for line in every]
        if self.pad == "rows":
            every = [
                [*line, ""] if re.match(r"['\"=]*[-+–−]?\d", line[0]) else line for line in every
            ]
        if self.pad == "header":
            every = [[*line, "", ""] if line == list(self.header) else line for line in every]
        return every

    def content(self) -> bytes:
        """The bytes of the file."""
        text = self.end.join(self.delimiter.join(map(self._cell, line)) for line in self.lines())
        return (text + self.end).encode(self.encoding, errors="replace")

    def _cell(self, cell: str) -> str:
        if cell.startswith("#") and self.quote != "all":
            return cell
        number = re.fullmatch(r"[-+]?[\d.,]+([eE][-+]?\d+)?", cell) is not None
        if (
            self.quote == "all"
            or (self.quote == "text" and cell and not number)
            or self.delimiter in cell or "\n" in cell
            or '"' in cell
        ):  # fmt: skip
            return '"' + cell.replace('"', '""') + '"'
        return cell


def _comma(cell: str) -> str:
    return (
        cell.replace(".", ",")
        if re.fullmatch(r"[-+–−'=\"]*\d*\.?\d+([eEdD][-+]?\d+)?\"? ?%?", cell)
        else cell
    )


def gcms() -> Sheet:
    """30 geometries of lamp, receiver and tilt."""
    angles = [(a, b, g) for a in (-60, -45, -20) for b in (-15, 0, 20, 45, 60) for g in (0, 15)]
    return _sheet(("alpha_deg", "beta_deg", "gamma_deg"), angles)


def generic() -> Sheet:
    """30 geometries by polar angle and azimuth."""
    angles = [(i, 0, r, p) for i in (5, 30, 60) for r in (0.5, 15, 30, 45, 70) for p in (0, 180)]
    return _sheet(("theta_i_deg", "phi_i_deg", "theta_r_deg", "phi_r_deg"), angles)


def _sheet(names: Sequence[str], angles: Sequence[Sequence[float]]) -> Sheet:
    rows = tuple(
        (*(f"{x:g}" for x in angle), *(f"{_reading(k, b):.5g}" for b in range(len(WAVELENGTHS))))
        for k, angle in enumerate(angles)
    )
    above = [("# quantity: radiance-factor",)]
    if len(names) == 3:
        above.append(("# gamma_s_deg: 15",))
    return Sheet(tuple(above), (*names, *map(str, WAVELENGTHS)), rows, len(names))


Change = Callable[[Sheet], Sheet]


def _set(**values: object) -> Change:
    return lambda sheet: replace(sheet, **values)  # type: ignore[arg-type]


def _bands(write: Callable[[int], str]) -> Change:
    return lambda s: replace(s, header=(*s.header[: s.angles], *map(write, WAVELENGTHS)))


def _angles(three: Sequence[str], four: Sequence[str]) -> Change:
    return lambda s: replace(s, header=(*(three if s.angles == 3 else four), *s.header[s.angles :]))


def _angle_words(write: Callable[[str], str]) -> Change:
    return lambda s: replace(
        s,
        header=(*(write(h.removesuffix("_deg")) for h in s.header[: s.angles]),
                *s.header[s.angles :]),
    )  # fmt: skip


def _cells(write: Callable[[str], str], which: str = "values", **more: object) -> Change:
    def change(s: Sheet) -> Sheet:
        first, last = (s.angles, None) if which == "values" else (0, s.angles)
        if which == "all":
            first, last = 0, None

        def written(row: tuple[str, ...]) -> tuple[str, ...]:
            return (
                *row[:first],
                *(write(c) for c in row[first:last]),
                *(row[last:] if last else ()),
            )

        return replace(s, rows=tuple(map(written, s.rows)), **more)  # type: ignore[arg-type]

    return change


def _column(place: int, name: str, write: Callable[[int], str], **more: object) -> Change:
    """A further column."""

    def change(s: Sheet) -> Sheet:
        def put(line: tuple[str, ...], cell: str) -> tuple[str, ...]:
            k = len(line) if place < 0 else place
            return (*line[:k], cell, *line[k:])

        return replace(
            s,
            header=put(s.header, name),
            units=tuple(put(u, "") for u in s.units),
            rows=tuple(put(row, write(k)) for k, row in enumerate(s.rows)),
            angles=s.angles + (place >= 0),
            **more,  # type: ignore[arg-type]
        )

    return change


def _units(angle: str, band: str, first: str | None = None) -> Change:
    return lambda s: replace(
        s, units=(*s.units, (first or angle, *[angle] * (s.angles - 1), *[band] * len(WAVELENGTHS)))
    )


def _insert(at: int, line: Callable[[Sheet], tuple[str, ...]]) -> Change:
    return lambda s: replace(s, rows=(*s.rows[:at], line(s), *s.rows[at:]))


def _long(names: tuple[str, str] = ("wavelength_nm", "value")) -> Change:
    def change(s: Sheet) -> Sheet:
        rows = tuple(
            (*row[: s.angles], str(nm), row[s.angles + b])
            for row in s.rows for b, nm in enumerate(WAVELENGTHS)
        )  # fmt: skip
        return replace(s, header=(*s.header[: s.angles], *names), rows=rows)

    return change


def _transposed(s: Sheet) -> Sheet:
    columns = [[s.header[k], *(row[k] for row in s.rows)] for k in range(len(s.header))]
    return replace(
        s, header=tuple(columns[0]), rows=tuple(map(tuple, columns[1:])), either=True,
        remedy="transpose",
    )  # fmt: skip


def _reversed(s: Sheet) -> Sheet:
    turn = lambda line: (*line[: s.angles], *line[s.angles :][::-1])  # noqa: E731
    return replace(s, header=turn(s.header), rows=tuple(map(turn, s.rows)))


def _other_order(s: Sheet) -> Sheet:
    n = s.angles
    turn = lambda line: (*line[:n][::-1], *line[n:])  # noqa: E731
    return replace(s, header=turn(s.header), rows=tuple(map(turn, s.rows)))


def _angles_last(s: Sheet) -> Sheet:
    n = s.angles
    turn = lambda line: (*line[n:], *line[:n])  # noqa: E731
    return replace(s, header=turn(s.header), rows=tuple(map(turn, s.rows)))


def _percent(s: Sheet) -> Sheet:
    return _cells(lambda c: f"{100 * float(c):.6g}")(s)


def _declared(text: str) -> Change:
    return lambda s: replace(
        s, above=tuple((text,) if "quantity" in a[0] else a for a in s.above if text or "quantity" not in a[0])
    )  # fmt: skip


def _then(*changes: Change) -> Change:
    def change(s: Sheet) -> Sheet:
        for one in changes:
            s = one(s)
        return s

    return change


def _above(*lines: tuple[str, ...]) -> Change:
    return lambda s: replace(s, above=(*lines, *s.above))


def _below(*lines: tuple[str, ...]) -> Change:
    return lambda s: replace(s, below=(*s.below, *lines))


def _no_hash(separator: str) -> Change:
    """Declarations as cells of their own, without #."""

    def change(s: Sheet) -> Sheet:
        pairs = [line[0].lstrip("# ").split(": ") for line in s.above]
        cells = [(k, v) if separator == "cell" else (f"{k}{separator}{v}",) for k, v in pairs]
        return replace(s, above=tuple(cells))

    return change


def _r_table(s: Sheet) -> Sheet:
    return replace(
        s, rows=tuple((str(k + 1), *row) for k, row in enumerate(s.rows)), delimiter=" ",
        quote="text",
    )  # fmt: skip


def _each(lines: str) -> Change:
    return lambda s: replace(s, above=tuple((re.sub(r"^#", lines, a[0]), *a[1:]) for a in s.above))


def _savetxt(s: Sheet) -> Sheet:
    return replace(s, header=("# " + s.header[0], *s.header[1:]))


#: Ways to write that exclude each other, by kind; each must read, unless it sets a remedy.
CHANGES: dict[str, dict[str, Change]] = {
    "separator": {
        "comma": _set(),
        "semicolon": _set(delimiter=";"),
        "tab": _set(delimiter="\t"),
        "german": _set(delimiter=";", comma=True),
        "tab, decimal comma": _set(delimiter="\t", comma=True),
        "comma, quoted decimal comma": _set(comma=True, quote="text"),
        "comma and blank": _set(delimiter=", "),
        "bar": _set(delimiter="|"),
    },
    "encoding": {
        "utf-8": _set(),
        "bom": _set(encoding="utf-8-sig"),
        "utf-16": _set(encoding="utf-16"),
        "utf-16-le": _set(encoding="utf-16-le"),
        "utf-16-be": _set(encoding="utf-16-be"),
        "utf-32": _set(encoding="utf-32"),
        "cp1252": _then(_above(("# Gerät für 45°",)), _set(encoding="cp1252")),
        "cp932": _then(_above(("# 変角分光測色システム",)), _set(encoding="cp932")),
        "mac": _then(_above(("# mesuré à 45°",)), _set(encoding="mac-roman")),
        "cp437": _then(_above(("# für 45°",)), _set(encoding="cp437")),
        "gbk": _then(_above(("# 测量报告",)), _set(encoding="gbk")),
    },
    "ends": {
        "lf": _set(),
        "crlf": _set(end="\r\n"),
        "cr": _set(end="\r"),
        "blank lines": _set(end="\n\n"),
        "crcrlf": _set(end="\r\r\n"),
    },
    "quotes": {
        "needed": _set(),
        "all": _set(quote="all"),
        "text": _set(quote="text"),
    },
    "padding": {
        "none": _set(),
        "all": _set(pad="all"),
        "same": _set(pad="same"),
        "rows": _set(pad="rows"),
        "header": _set(pad="header"),
    },
    "angles": {
        "own": _set(),
        "brackets": _angle_words(lambda n: f"{n} [°]"),
        "round": _angle_words(lambda n: f"{n.capitalize()} (deg)"),
        "slash": _angle_words(lambda n: f"{n}/°"),
        "in": _angle_words(lambda n: f"{n} in deg"),
        "blank": _angle_words(lambda n: n.replace("_", " ")),
        "upper": _angle_words(str.upper),
        "degrees": _angle_words(lambda n: f"{n} (degrees)"),
        "nbsp": _angle_words(lambda n: f"{n}\u00a0[°]"),
        "new line": _angle_words(lambda n: f"{n}\n[°]"),
        "º": _angle_words(lambda n: f"{n} (º)"),
        "greek": _angles(("α", "β", "γ"), ("θi", "φi", "θr", "φr")),
        "greek degrees": _angles(("α (°)", "β (°)", "γ (°)"), ("θ_i [°]", "φ_i [°]", "θ_r [°]", "φ_r [°]")),
        "camel": _angles(("Alpha", "Beta", "Gamma"), ("ThetaI", "PhiI", "ThetaR", "PhiR")),
        "camel in out": _angles(("Alpha", "Beta", "Gamma"), ("thetaIn", "phiIn", "thetaOut", "phiOut")),
        "words": _angles(("alpha angle", "beta angle", "gamma angle"),
                         ("incidence angle", "incidence azimuth", "viewing angle", "viewing azimuth")),
        "angle of": _angles(("angle alpha", "angle beta", "angle gamma"),
                            ("angle of incidence [deg]", "azimuth of incidence [deg]", "angle of view [deg]", "azimuth of view [deg]")),
        "pandas": _angles(("alpha.deg", "beta.deg", "gamma.deg"), ("theta.i.deg", "phi.i.deg", "theta.r.deg", "phi.r.deg")),
        "R": _angles(("alpha..deg.", "beta..deg.", "gamma..deg."), ("theta_i..deg.", "phi_i..deg.", "theta_r..deg.", "phi_r..deg.")),
        "tex": _angles(("$\\alpha$", "$\\beta$", "$\\gamma$"), ("$\\theta_i$", "$\\phi_i$", "$\\theta_r$", "$\\phi_r$")),
    },
    "bands": {
        "own": _set(),
        "400nm": _bands(lambda n: f"{n}nm"),
        "400 nm": _bands(lambda n: f"{n} nm"),
        "400 [nm]": _bands(lambda n: f"{n} [nm]"),
        "400 (nm)": _bands(lambda n: f"{n} (nm)"),
        "R400": _bands(lambda n: f"R{n}"),
        "R_400": _bands(lambda n: f"R_{n}"),
        "R(400)": _bands(lambda n: f"R({n})"),
        "R[400]": _bands(lambda n: f"R[{n}]"),
        "R(400 nm)": _bands(lambda n: f"R({n} nm)"),
        "400.0": _bands(lambda n: f"{n}.0"),
        "400.00nm": _bands(lambda n: f"{n}.00nm"),
        "W400": _bands(lambda n: f"W{n}"),
        "nm400": _bands(lambda n: f"nm{n}"),
        "λ=400": _bands(lambda n: f"λ={n}"),
        "lambda 400": _bands(lambda n: f"lambda {n}"),
        "λ400nm": _bands(lambda n: f"λ{n}nm"),
        "X400": _bands(lambda n: f"X{n}"),
        "x400": _bands(lambda n: f"x{n}"),
        "X400.nm": _bands(lambda n: f"X{n}.nm"),
        "X400..nm.": _bands(lambda n: f"X{n}..nm."),
        "SPECTRAL_NM400": _bands(lambda n: f"SPECTRAL_NM{n}"),
        "SPEC_400": _bands(lambda n: f"SPEC_{n}"),
        "refl 400": _bands(lambda n: f"Reflectance {n} nm"),
        "BRDF_400": _bands(lambda n: f"BRDF_{n}"),
        "brdf(400)": _bands(lambda n: f"brdf({n}nm)"),
        "wavelength 400": _bands(lambda n: f"Wavelength {n} nm"),
        "4.00E+02": _bands(lambda n: f"{n:.6E}"),
        "um": _then(_bands(lambda n: f"{n / 1000:g}"), _set(remedy="nanomet")),
        "um named": _bands(lambda n: f"{n / 1000:g} µm"),
        "angstrom": _bands(lambda n: f"{n * 10} Å"),
        "upper": _bands(lambda n: f"{n} NM"),
        "nbsp": _bands(lambda n: f"{n}\u00a0nm"),
        "value [1]": _bands(lambda n: f"{n} nm [-]"),
    },
    "numbers": {
        "own": _set(),
        "exponents": _cells(lambda c: f"{float(c):.5E}"),
        "small exponents": _cells(lambda c: f"{float(c):.6e}", "all"),
        "fixed": _cells(lambda c: f"{float(c):.8f}"),
        "repr": _cells(lambda c: repr(float(c)), "all"),
        "fortran": _cells(lambda c: f"{float(c):.5E}".replace("E", "D")),
        "plus": _cells(lambda c: c if c.startswith("-") else f"+{c}", "all"),
        "apostrophe": _cells(lambda c: f"'{c}", "all"),
        "formula text": _cells(lambda c: f'="{c}"', "all"),
        "minus": _cells(lambda c: c.replace("-", "\u2212"), "angles"),
        "en dash": _cells(lambda c: c.replace("-", "\u2013"), "angles"),
        "hyphen": _cells(lambda c: c.replace("-", "\u2011"), "angles"),
        "full width": _cells(lambda c: c.replace("-", "\uff0d"), "angles"),
        "padded": _cells(lambda c: f"  {c} ", "all"),
        "thin": _cells(lambda c: f"\u2009{c}\u2009", "all"),
        "nbsp": _cells(lambda c: f"\u00a0{c}", "all"),
        "no zero": _cells(lambda c: c.removeprefix("0")),
        "rounded degrees": _cells(lambda c: f"{float(c):.1f}", "angles"),
        "percent cells": _cells(lambda c: f"{100 * float(c):.6g}%"),
        "percent cells, blank": _cells(lambda c: f"{100 * float(c):.6g} %"),
        "degree cells": _cells(lambda c: f"{c}°", "angles", remedy="unit", either=True),
        "unit cells": _cells(lambda c: f"{c} 1/sr", "values", remedy="unit"),
        "thousands": _cells(lambda c: f"{1234 * float(c):,.2f}" if float(c) > 0.9 else c, "values", remedy="thousands|semicolon|radiance-factor-percent|comma"),
        "date": _cells(lambda c: "3. Apr" if c.startswith("0.3") else c, remedy="date"),
    },
    "units": {
        "none": _set(),
        "degrees": _units("°", ""),
        "deg, 1": _units("deg", "1"),
        "[deg]": _units("[deg]", "[-]"),
        "degree, nm": _units("degree", "nm"),
        "Units:": _units("deg", "a.u.", "Units:"),
        "origin": _then(_units("°", "nm"), _units("lamp", "R", "Comments")),
        "empty after": _then(_units("°", ""), _units("", "")),
        "matlab": _units("double", "double"),
    },
    "titles": {
        "none": _set(),
        "title": _above(("Goniospectrophotometer report",), ("Sample", "board 7")),
        "date": _above(("24.12.2024 10:30:11",), ("Operator", "me")),
        "sep": _set(),
        "keys": _above(("Instrument: G-1",), ("Serial No.", "12345"), ("Temperature", "23.5", "°C"), ("",)),
        "long": _above(*[(f"Parameter {k}", str(k)) for k in range(40)]),
        "letter": _above(("Report, of today; with marks",), ("",), ("",)),
        "section": _above(("[Header]",), ("Version=1.2",), ("[Data]",)),
        "quoted": _above(('Board "7"',), ('3" tube',)),
        "count": _above(("30",), ("6",)),
    },
    "declared": {
        "own": _set(),
        "cells": _no_hash("cell"),
        "colon": _no_hash(": "),
        "equals": _no_hash(" = "),
        "percent sign": _each("%"),
        "slashes": _each("//"),
        "exclamation": _each("!"),
        "star": _each("*"),
        "none": _then(_declared(""), _set(remedy="quantity of the numbers")),
        "upper": _declared("# Quantity: Radiance Factor"),
        "hash before header": _savetxt,
    },
    "below": {
        "none": _set(),
        "end": _below(("End of data",)),
        "mean": lambda s: _below(("Mean", *[""] * (s.angles - 1), *["0.3"] * 6))(s),
        "mean without a word": lambda s: _below(("",) * s.angles + ("0.3",) * 6)(s),
        "statistics": lambda s: _below(*[(w, *[""] * (s.angles - 1), *["0.1"] * 6) for w in ("Average", "StdDev", "Min", "Max")])(s),
        "blank rows": _below(("",), ("", "", ""), ("",)),
        "signed": _below(("",), ("Signed: M. Muster",), ("24.12.2024",)),
        "counted": _below(("Rows: 30",)),
        "equals": _below(("=====",)),
        "star": _below(("*** end ***",)),
        "checksum": _below(("Checksum", "A7F3")),
        "notes": _below(("Note:", "beta counts from the lamp; see manual"),),
        "ctrl-z": _below(("\x1a",)),
    },
    "columns": {
        "none": _set(),
        "unnamed index": _column(0, "", str),
        "index from 1": _column(0, "", lambda k: str(k + 1)),
        "Unnamed: 0": _column(0, "Unnamed: 0", str),
        "index": _column(0, "index", str),
        "No.": _column(0, "No.", lambda k: str(k + 1)),
        "#": _column(0, "#", lambda k: str(k + 1), remedy="rename|remove|header", either=True),
        "sample": _column(0, "Sample", lambda k: "board 7"),
        "sample id": _column(0, "Sample ID", lambda k: "7"),
        "two samples": _column(0, "Sample", lambda k: "ab"[k % 2], remedy="split|--part|one sample"),
        "timestamp": _column(0, "Timestamp", lambda k: f"2024-12-24 10:{k:02d}:00"),
        "date and time last": _column(-1, "Date/Time", lambda k: f"24.12.2024 10:{k:02d}"),
        "comment": _column(-1, "Comment", lambda k: "ok" if k % 5 else "dust?"),
        "empty comment": _column(-1, "Remarks", lambda k: ""),
        "repeat": _column(0, "Repeat", lambda k: "1"),
        "integration": _column(0, "Integration time (ms)", lambda k: str(20 + k % 3)),
        "temperature": _column(-1, "Temp", lambda k: "23.5"),
        "unknown words": _column(-1, "foo", lambda k: "x", remedy="rename|remove"),
        "unknown numbers": _column(-1, "foo", lambda k: f"{k * 0.37:.3f}", remedy="rename|remove"),
        "deviation": _column(-1, "SD 400", lambda k: "0.001", remedy="rename|remove"),
        "doubled band": _column(-1, "400", lambda k: "0.001", remedy="already column|each once"),
        "R row names": _r_table,
    },
    "layout": {
        "own": _set(),
        "reversed bands": _reversed,
        "other order": _other_order,
        "angles last": _angles_last,
        "long": _long(),
        "long, other words": _long(("Wavelength [nm]", "Reflectance factor")),
        "long, lambda": _long(("λ", "R")),
        "long, plain": _long(("wavelength", "radiance_factor")),
        "transposed": _transposed,
        "header again": _insert(12, lambda s: s.header),
        "blank row": _insert(12, lambda s: ("",) * len(s.header)),
        "mean inside": _insert(12, lambda s: ("Mean", *[""] * (s.angles - 1), *["0.3"] * 6)),
        "percent declared": _then(_percent, _declared("# quantity: radiance-factor-percent")),
        "percent [%]": _then(_percent, _bands(lambda n: f"{n} nm [%]")),
        "percent R [%]": _then(_percent, _bands(lambda n: f"R{n} (%)"), _declared("")),
        "percent units": _then(_percent, _units("deg", "%")),
        "percent word": _then(_percent, _declared("# quantity: reflectance factor [%]")),
        "percent unsaid": _then(_percent, _set(remedy="radiance-factor-percent")),
        "brdf": _then(_cells(lambda c: repr(float(c) / np.pi)), _declared("# quantity: BRDF [1/sr]")),
        "nan signs": _set(),
    },
}  # fmt: skip

#: Kinds of change in the order in which a program applies them.
ORDER = ("layout", "numbers", "bands", "angles", "units", "columns", "declared", "titles", "below",
         "separator", "quotes", "padding", "ends", "encoding")  # fmt: skip


def _possible(names: dict[str, str]) -> bool:
    """Whether the changes can go together and say what they say alone."""
    layout, numbers = names.get("layout", "own"), names.get("numbers", "own")
    if layout.startswith(("long", "transposed")) and (
        set(names) & {"bands", "units", "columns", "below"}
    ):
        return False
    if layout.startswith("transposed") and (set(names) & {"angles", "declared", "numbers"}):
        return False
    if layout == "percent unsaid" and numbers == "thousands":
        return False
    if layout.startswith("percent") and numbers.startswith(("percent", "thousands", "date")):
        return False
    if layout == "brdf" and numbers not in ("own", "repr", "padded", "plus"):
        return False
    if layout == "other order" and "angles" in names:
        return False
    if layout == "reversed bands" and "bands" in names:
        return False
    if names.get("declared") == "none" and (
        layout.startswith(("long", "percent")) or numbers.startswith("percent")
    ):
        return False
    if layout.startswith("long") and numbers.startswith(("percent", "unit", "thousands", "date")):
        return False
    if layout in ("percent [%]", "percent R [%]") and "bands" in names:
        return False
    if layout in ("header again", "mean inside", "blank row", "angles last") and (
        set(names) & {"numbers", "bands", "angles", "columns", "units", "below"}
    ):
        return False
    if layout in ("percent R [%]", "percent declared", "percent word", "brdf") and (
        "declared" in names
    ):
        return False
    if layout == "percent units" and "units" in names:
        return False
    if names.get("columns") == "R row names" and (
        set(names) - {"columns", "layout", "encoding", "ends", "numbers"}
    ):
        return False
    if names.get("declared") == "hash before header" and "columns" in names:
        return False
    encoding = names.get("encoding", "utf-8")
    narrow = not encoding.startswith(("utf", "bom"))
    beyond = (names.get("angles") in ("greek", "greek degrees", "º", "nbsp")
              or numbers in ("minus", "en dash", "hyphen", "full width", "thin", "nbsp")
              or names.get("bands") in ("λ=400", "λ400nm", "um named", "angstrom", "nbsp")
              or layout == "long, lambda")  # fmt: skip
    return not (narrow and beyond)


def build(base: Callable[[], Sheet], names: dict[str, str]) -> Sheet:
    """The sheet with named changes, one of each kind at most."""
    sheet = base()
    remedies, either = [], False
    for kind in ORDER:
        if kind in names:
            sheet = replace(CHANGES[kind][names[kind]](sheet))
            if sheet.remedy:
                remedies.append(sheet.remedy)
                either = either or sheet.either
            sheet = replace(sheet, remedy=None, either=False)
    if names.get("titles") == "sep":
        mark = sheet.delimiter.strip() if sheet.delimiter != "\t" else "\t"
        sheet = replace(sheet, above=((f"sep={mark}",), *sheet.above))
        # A spreadsheet writes this line as it is.
    return replace(sheet, remedy="|".join(remedies) or None, either=either and len(remedies) == 1)


def singles() -> Iterator[dict[str, str]]:
    """Each change alone."""
    for kind, changes in CHANGES.items():
        for name in changes:
            yield {kind: name}


def combined(count: int, seed: int = 16) -> Iterator[dict[str, str]]:
    """Random combinations of two to five changes."""
    dice = random.Random(seed)
    made = 0
    while made < count:
        kinds = dice.sample(ORDER, dice.randint(2, 5))
        names = {kind: dice.choice(list(CHANGES[kind])) for kind in kinds}
        if _possible(names):
            made += 1
            yield names


#: Sixty whole files, as the programs in the comments write them.
SIXTY: tuple[dict[str, str], ...] = (
    # Excel: comma, German, Unicode text, marks of separator and encoding, code pages.
    {"padding": "same", "ends": "crlf", "encoding": "bom"},
    {"separator": "german", "ends": "crlf", "encoding": "cp1252", "titles": "sep"},
    {"separator": "german", "ends": "crlf", "encoding": "cp1252", "padding": "all"},
    {"separator": "tab", "ends": "crlf", "encoding": "utf-16"},
    {"separator": "tab, decimal comma", "ends": "crlf", "encoding": "utf-16-le"},
    {"separator": "comma", "titles": "sep", "ends": "crlf"},
    {"separator": "semicolon", "titles": "sep", "quotes": "text"},
    {"encoding": "cp932", "ends": "crlf", "bands": "400nm", "padding": "same"},
    {"encoding": "mac", "ends": "cr", "angles": "brackets"},
    {"encoding": "gbk", "ends": "crlf", "angles": "brackets", "units": "degrees"},
    {"encoding": "utf-32", "titles": "title"},
    {"separator": "german", "layout": "percent [%]", "ends": "crlf", "encoding": "bom"},
    {"numbers": "percent cells", "ends": "crlf", "encoding": "bom"},
    {"separator": "german", "numbers": "percent cells, blank", "ends": "crlf"},
    {"numbers": "apostrophe", "quotes": "needed"},
    {"numbers": "formula text", "ends": "crlf"},
    {"angles": "new line", "bands": "400 [nm]", "ends": "crlf"},
    {"quotes": "all", "padding": "all", "ends": "crlf"},
    {"declared": "cells", "padding": "same", "ends": "crlf", "encoding": "bom"},
    # LibreOffice, Google Sheets, Numbers.
    {"separator": "comma, quoted decimal comma", "quotes": "text"},
    {"separator": "comma", "quotes": "text", "declared": "cells"},
    {"separator": "tab", "quotes": "all", "bands": "R_400"},
    {"separator": "comma and blank", "numbers": "rounded degrees"},
    # R, pandas, numpy, MATLAB.
    {"columns": "R row names"},
    {"columns": "unnamed index", "numbers": "repr"},
    {"columns": "Unnamed: 0", "numbers": "repr", "bands": "400.0"},
    {"angles": "R", "bands": "X400..nm."},
    {"declared": "hash before header", "numbers": "small exponents"},
    {"bands": "x400", "numbers": "exponents", "declared": "percent sign"},
    {"numbers": "fortran", "separator": "comma and blank"},
    {"layout": "long", "numbers": "repr", "angles": "pandas"},
    # Origin, JMP, instruments.
    {"units": "origin", "separator": "tab", "angles": "greek degrees"},
    {"units": "Units:", "titles": "keys", "below": "end"},
    {"units": "deg, 1", "bands": "400 nm", "columns": "comment"},
    {"layout": "percent units", "titles": "section", "separator": "tab"},
    {"layout": "long, other words", "titles": "keys", "separator": "german"},
    {"layout": "long, lambda", "angles": "greek"},
    {"layout": "reversed bands", "below": "statistics"},
    {"layout": "other order", "columns": "index from 1"},
    {"columns": "timestamp", "below": "signed", "titles": "date"},
    {"columns": "date and time last", "separator": "german"},
    {"columns": "sample", "bands": "SPECTRAL_NM400", "below": "checksum"},
    {"columns": "repeat", "angles": "round", "bands": "R(400 nm)"},
    {"columns": "integration", "angles": "slash", "bands": "λ=400"},
    {"angles": "camel", "bands": "W400", "titles": "long"},
    {"angles": "words", "bands": "refl 400", "below": "mean"},
    {"angles": "angle of", "bands": "nm400", "below": "mean without a word"},
    {"angles": "tex", "bands": "um named", "padding": "rows"},
    {"numbers": "minus", "padding": "header", "below": "star"},
    {"numbers": "en dash", "separator": "semicolon", "below": "notes"},
    {"numbers": "thin", "ends": "blank lines", "below": "blank rows"},
    {"layout": "percent declared", "separator": "bar", "below": "ctrl-z"},
    {"layout": "brdf", "declared": "own", "titles": "quoted"},
    {"layout": "angles last", "padding": "all", "titles": "letter"},
    # What can't be read, with its remedy.
    {"bands": "um", "separator": "german"},
    {"numbers": "date", "ends": "crlf"},
    {"numbers": "unit cells", "separator": "tab"},
    {"numbers": "thousands", "layout": "other order"},
    {"columns": "two samples", "separator": "semicolon"},
    {"layout": "transposed", "separator": "tab"},
)  # fmt: skip


def sixty() -> Iterator[tuple[Callable[[], Sheet], dict[str, str]]]:
    """Each of them of one table or the other, in turns."""
    for k, names in enumerate(SIXTY):
        yield (gcms, generic)[k % 2], names


def outcome(path: Path, sheet: Sheet, expected: Measurement) -> tuple[str, str]:
    """READ, REFUSED or WRONG, and the notes or the message."""
    path.write_bytes(sheet.content())
    try:
        found = read_measurement(path)
    except InputError as error:
        right = sheet.remedy is not None and re.search(sheet.remedy, str(error))
        return (REFUSED if right else WRONG + " refusal"), str(error)
    if sheet.remedy is not None and not sheet.either:
        return WRONG, "read: " + " / ".join(found.warnings)
    if not same(found, expected):
        return WRONG, "other values: " + " / ".join(found.warnings)
    return READ, " / ".join(found.warnings)


def same(a: Measurement, b: Measurement) -> bool:
    """Whether two measurements hold the same numbers, in the same rows."""
    if a.bands != b.bands or a.radiance_factor.shape != b.radiance_factor.shape:
        return False
    if a.gamma_s_deg != b.gamma_s_deg or a.reasons.tolist() != b.reasons.tolist():
        return False
    pairs = (
        (a.radiance_factor, b.radiance_factor),
        (a.to_lamp, b.to_lamp),
        (a.to_receiver, b.to_receiver),
    )
    return all(np.allclose(x, y, rtol=1e-12, atol=1e-15) for x, y in pairs)


def main(count: int) -> None:
    """Print what is not as it should be, and the counts."""
    counts = {READ: 0, REFUSED: 0, WRONG: 0, WRONG + " refusal": 0}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "t.csv"
        plain = {}
        for base in (gcms, generic):
            path.write_bytes(base().content())
            plain[base] = read_measurement(path)
        for names in [*singles(), *combined(count)]:
            for base in (gcms, generic):
                sheet = build(base, names)
                result, text = outcome(path, sheet, plain[base])
                counts[result] += 1
                if result not in (READ, REFUSED):
                    print(f"{result}: {base.__name__} {names}\n    {text[len(folder) :][:230]}")
    print(counts)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 400)
