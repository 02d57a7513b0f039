"""BRDF tables in the format of ASTM E1392: lines 'KEY value' down to VARS, then rows of numbers.

The columns are those of Cornell's database (http://www.graphics.cornell.edu/online/measurements/
reflectance/) and of libbsdf's AstmReader (Kimura 2017): theta_i, phi_i, theta_s, phi_s and the
BRDF, as R,G,B, as X,Y,Z, by wavelength ('400nm') or as one number.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.gonio import spherical
from relgloss_view.measure.quantity import BRDF, BRDF_COS
from relgloss_view.measure.readers import number_rows
from relgloss_view.measure.readers.assemble import assemble, one_channel
from relgloss_view.measure.readers.declared import Declared, canonical_unit, is_same_side
from relgloss_view.measure.readers.headings import DEGREES, RADIANS, unit_of
from relgloss_view.measure.readers.options import ReadOptions
from relgloss_view.measure.readers.tristimulus import readable_rgb, srgb_from_xyz
from relgloss_view.measure.table import Measurement

EXPECTED = "a BRDF in the format of ASTM E1392"
MAX_HEADER_LINES = 2000
ANGLES = ("theta_i", "phi_i", "theta_s", "phi_s")
_SAME = {"theta_r": "theta_s", "phi_r": "phi_s", "theta_o": "theta_s", "phi_o": "phi_s"}
_WAVELENGTH = re.compile(r"[^\d.]{0,12}?(\d+(?:\.\d+)?) ?(nm)?", re.ASCII)
_RGB = (("r", "g", "b"), ("red", "green", "blue"))
#: Angles that all lie below these are in radians: a quarter and a whole turn, with rounding.
QUARTER, TURN = 0.5 * np.pi + 1e-3, 2.0 * np.pi + 1e-3


@dataclass
class _Header:
    """What stands above the numbers."""

    names: list[str] = field(default_factory=list)  #: of the columns, as written
    entries: dict[str, str] = field(default_factory=dict)  #: by KEY in capitals


def read(path: Path, options: ReadOptions) -> Measurement:
    """Read a file of ASTM E1392. Raises InputError.

    The angles are in the unit that the caller or the header gives; else in radians, as in
    Cornell's files, if none exceeds what radians allow, and in degrees otherwise. Azimuths are
    counted from one axis: the mirror direction is at phi_s = phi_i + 180 degrees, unless the
    caller's `mirror` is 'same-side'.
    """
    with number_rows.opened(path, EXPECTED) as text:
        lines = enumerate(text.lines(), start=1)
        header = _header(path, lines)
        table = number_rows.NumberRows(path, len(header.names)).read(lines)
        notes = [] if text.note is None else [text.note]
    columns = _columns(path, header)
    kind, value_columns, labels = _values(path, header, columns)
    quantity = options.quantity_or(_quantity(labels))
    angles = np.stack(
        [table[:, columns[name]] if name in columns else np.zeros(len(table)) for name in ANGLES],
        axis=1,
    )
    angles, note = _degrees(path, header, angles, options)
    notes += [note, *_counted(header, len(table))]
    if "phi_i" not in columns:
        notes.append("the file has no phi_i: it is taken as 0")
    others = sorted(set(range(len(header.names))) - set(columns.values()) - set(value_columns))
    if others:
        names = ", ".join(printable(header.names[k], 30) for k in others[:6])
        notes.append(f"passed over columns without a BRDF: {names}")
    readings = table[:, value_columns]
    bands, readings, remarks = _bands(path, kind, readings, labels)
    complete = np.isfinite(angles).all(axis=1)
    if not complete.all():
        notes.append(f"passed over {np.sum(~complete)} rows without an angle")
        angles, readings = angles[complete], readings[complete]
    theta_i, phi_i, theta_s, phi_s = angles.T
    turned = 0.0
    if options.mirror is not None and is_same_side(options.mirror, "--mirror"):
        turned = 180.0
    measurement = assemble(
        path,
        Declared(
            name=header.entries.get("SAMPLE") or header.entries.get("TITLE") or path.stem,
            source=f"{path.name}, ASTM E1392",
            quantity=quantity,
            quantity_insisted=options.quantity is not None,
            warnings=(*notes, *remarks),
        ),
        angles,
        bands,
        readings,
        (spherical(theta_i, phi_i), spherical(theta_s, phi_s + turned)),
        np.rint(np.abs(theta_i)),
    )
    unused = options.unused("gamma_s_deg", "part")
    return replace(measurement, warnings=(*measurement.warnings, *unused))


def _header(path: Path, lines: Iterator[tuple[int, str]]) -> _Header:
    header = _Header()
    for line, text in lines:
        key, rest = ([*re.split(r"\s*[=:\s]\s*", text.strip(), maxsplit=1), ""])[:2]
        key = key.upper()[:40]
        if key == "VARS":
            header.names = [
                name.strip().strip('"') for name in re.split("[,;\t]", rest.strip(" ,;\t"))
            ]
            if len(header.names) == 1:
                header.names = rest.split()
            return header
        if line > MAX_HEADER_LINES:
            break
        if key and not key.startswith("#"):
            header.entries.setdefault(key, printable(rest.strip(), 200))
    raise InputError(
        f"{path}: no line 'VARS theta_i,phi_i,theta_s,phi_s,...' above the numbers; give {EXPECTED}"
    )


def _columns(path: Path, header: _Header) -> dict[str, int]:
    """The place of each angle's column."""
    columns: dict[str, int] = {}
    for place, name in enumerate(header.names):
        word = re.split(r"[\[(]", name)[0].strip().lower().replace(" ", "_")
        word = re.sub(r"^(theta|phi)(?=[isro]$)", r"\1_", word)
        word = _SAME.get(word, word)
        if word in ANGLES:
            if word in columns:
                raise InputError(f"{path}: VARS has two columns {word}; remove one")
            columns[word] = place
    missing = [name for name in ANGLES if name not in columns and name != "phi_i"]
    if missing:
        raise InputError(
            f"{path}: VARS has no column {' or '.join(missing)}, so the directions are unknown; "
            "export theta_i,phi_i,theta_s,phi_s and the BRDF"
        )
    return columns


def _values(
    path: Path, header: _Header, columns: dict[str, int]
) -> tuple[str, list[int], list[str]]:
    """'rgb', 'xyz', 'spectrum' or 'one'; the columns of the BRDF, and their names."""
    places = [k for k in range(len(header.names)) if k not in columns.values()]
    names = [header.names[k] for k in places]
    words = tuple(name.lower() for name in names)
    if words in _RGB:
        return "rgb", places, names
    if words == ("x", "y", "z"):
        return "xyz", places, names
    matched = [_WAVELENGTH.fullmatch(re.sub(r"[\[\]()]", "", word)) for word in words]
    spectral = [(k, m[1]) for k, m in zip(places, matched, strict=True) if m is not None]
    if len(spectral) >= 2:
        return "spectrum", [k for k, _ in spectral], [nm for _, nm in spectral]
    if len(names) == 1:
        return "one", places, names
    brdf = [k for k, word in zip(places, words, strict=True) if re.match(r"brdf|bsdf|ccbrdf", word)]
    if len(brdf) == 1:
        return "one", brdf, [header.names[brdf[0]]]
    shown = ", ".join(printable(name, 30) for name in names[:6])
    raise InputError(
        f"{path}: VARS has no BRDF that is read but {shown or 'nothing'}; expected R,G,B or X,Y,Z "
        "or wavelengths such as 450nm,550nm or one column"
    )


def _quantity(labels: list[str]) -> str:
    """What the columns of the values hold by their names."""
    cosine = len(labels) == 1 and re.match(r"ccbrdf|brdf ?\*? ?cos", labels[0].lower())
    return BRDF_COS if cosine else BRDF


def _degrees(path: Path, header: _Header, angles: Array, options: ReadOptions) -> tuple[Array, str]:
    """The angles in degrees, and a note that names their unit and where it comes from."""
    polar, azimuth = np.abs(angles[:, [0, 2]]), np.abs(angles[:, [1, 3]])
    unit, origin = None, "--angle-unit"
    if options.angle_unit is not None:
        unit = canonical_unit(options.angle_unit, "--angle-unit")
    else:
        in_header = [unit_of(value) for key, value in header.entries.items() if "ANG" in key]
        unit, origin = next((found for found in in_header if found), None), "the header has it"
    if unit is None:
        small = np.nanmax(polar, initial=0.0) <= QUARTER and np.nanmax(azimuth, initial=0.0) <= TURN
        unit = RADIANS if small else DEGREES
        origin = "none is larger" if small else "some are too large for radians"
        origin += "; --angle-unit replaces it"
    if unit == RADIANS:
        angles, polar, azimuth = np.degrees(angles), np.degrees(polar), np.degrees(azimuth)
    if np.nanmax(polar, initial=0.0) > 180.0 or np.nanmax(azimuth, initial=0.0) > 720.0:
        raise InputError(
            f"{path}: angles of up to {np.nanmax(polar, initial=0.0):g} and "
            f"{np.nanmax(azimuth, initial=0.0):g} degrees, read in {unit} ({origin}); give the "
            "right --angle-unit"
        )
    return angles, f"the angles are read in {unit} ({origin})"


def _counted(header: _Header, rows: int) -> list[str]:
    declared = header.entries.get("NUM_POINTS", "")
    if not re.fullmatch(r"\d{1,9}", declared) or int(declared) == rows:
        return []
    return [f"the file declares {int(declared)} points and holds {rows}: is it cut off?"]


def _bands(
    path: Path, kind: str, readings: Array, labels: list[str]
) -> tuple[Bands, Array, tuple[str, ...]]:
    if kind == "one":
        bands, readings, gray = one_channel(readings, printable(labels[0], 60))
        return bands, readings, (gray,)
    if kind == "spectrum":
        nm = np.array([float(label) for label in labels])
        order = np.argsort(nm, kind="stable")
        try:
            return Bands(tuple(nm[order].tolist())), readings[:, order], ()
        except InputError as error:
            raise InputError(f"{path}: VARS: {error}") from None
    if kind == "xyz":
        readings = srgb_from_xyz(readings)
    return readable_rgb(readings)
