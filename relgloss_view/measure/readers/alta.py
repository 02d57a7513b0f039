"""Data files of ALTA (Belcour, Barla, Pacanowski 2014): '#' lines, then rows of numbers.

'#DIM n m' has the numbers of a direction and of a value, '#PARAM_IN' the name of the coordinates,
'#PARAM_OUT' that of the values, '#VS' whether intervals follow. Source: ALTA's core/params.h and
core/data_storage.cpp. Angles are in radians; x is the tangent, z the normal.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.measure import quantity as quantities
from relgloss_view.measure.gonio import from_normal
from relgloss_view.measure.readers import number_rows
from relgloss_view.measure.readers.alta_coordinates import COORDINATES, Directions
from relgloss_view.measure.readers.assemble import assemble, one_channel
from relgloss_view.measure.readers.declared import Declared
from relgloss_view.measure.readers.options import ReadOptions
from relgloss_view.measure.readers.tristimulus import readable_rgb, srgb_from_xyz
from relgloss_view.measure.table import Measurement

EXPECTED = "a data file of ALTA"
MAX_HEADER_LINES = 2000
ONE, RGB_COLOR, XYZ_COLOR = "INV_STERADIAN", "RGB_COLOR", "XYZ_COLOR"
#: The quantity of each kind of values.
QUANTITIES: Mapping[str, str] = {
    ONE: quantities.BRDF,
    "INV_STERADIAN_COSINE_FACTOR": quantities.BRDF_COS,
    RGB_COLOR: quantities.BRDF,
    XYZ_COLOR: quantities.BRDF,
}


def read(path: Path, options: ReadOptions) -> Measurement:
    """Read a text file of ALTA whose coordinates give both directions. Raises InputError."""
    with number_rows.opened(path, EXPECTED) as text:
        header = _header(text.lines())
        inputs, outputs = _dimensions(path, header)
        directions = _coordinates(path, header, inputs)
        kind = _kind(path, header, options)
        if outputs not in ((3,) if kind in (RGB_COLOR, XYZ_COLOR) else (1, 3)):
            raise InputError(
                f"{path}: #DIM has {outputs} values of {kind} a row; read are 1, or 3 of a colour"
            )
        rows = number_rows.NumberRows(path, inputs + outputs, extra=True)
        table = rows.read(enumerate(text.lines(), start=1))
        notes = [] if text.note is None else [text.note]
    complete = np.isfinite(table[:, :inputs]).all(axis=1)
    if not complete.all():
        notes.append(f"passed over {np.sum(~complete)} rows without a direction")
        table = table[complete]
    if not len(table):
        raise InputError(f"{path}: no row of numbers; give {EXPECTED}")
    if rows.passed_over:
        notes.append(f"passed over the intervals (#VS) of {rows.passed_over} rows")
    angles, values = table[:, :inputs], table[:, inputs:]
    lamp, receiver = _unit(path, *directions(angles))
    # A kind that is not among them is read where the caller has a quantity alone.
    quantity = options.quantity_or(QUANTITIES.get(kind, ""))
    if outputs == 1:
        bands, values, gray = one_channel(values, kind)
        remarks: tuple[str, ...] = (gray,)
    else:
        bands, values, remarks = readable_rgb(
            srgb_from_xyz(values) if kind == XYZ_COLOR else values
        )
    source = [path.name, "ALTA data", header["PARAM_IN"]]
    source += {XYZ_COLOR: ["XYZ taken as under D65"]}.get(kind, [])
    source += ["channels taken as linear sRGB"] if outputs == 3 and kind != XYZ_COLOR else []
    measurement = assemble(
        path,
        Declared(
            name=path.stem,
            source=", ".join(source),
            quantity=quantity,
            quantity_insisted=options.quantity is not None,
            warnings=(*notes, *remarks),
        ),
        angles,
        bands,
        values,
        (lamp, receiver),
        np.rint(from_normal(lamp)),
    )
    unused = options.unused("gamma_s_deg", "angle_unit", "mirror", "part")
    return replace(measurement, warnings=(*measurement.warnings, *unused))


def _header(lines: Iterator[str]) -> dict[str, str]:
    """The entries above the first row of numbers."""
    header: dict[str, str] = {}
    for count, text in enumerate(lines):
        entry = re.match(r"\s*#\s*([A-Za-z_]{2,40})\s+(\S.{0,199})", text)
        if entry is not None:
            header.setdefault(entry[1].upper(), printable(entry[2].strip(), 80))
        elif text.strip() and not text.lstrip().startswith("#"):
            break
        if count > MAX_HEADER_LINES:
            break
    return header


def _dimensions(path: Path, header: dict[str, str]) -> tuple[int, int]:
    """How many numbers of a row are its directions, and how many its values."""
    words = header.get("DIM", "").split()
    if len(words) != 2 or not all(re.fullmatch(r"[1-9]\d?", word) for word in words):
        raise InputError(
            f"{path}: '#DIM {header.get('DIM', '')}'; expected two counts, such as '#DIM 3 3'"
        )
    return int(words[0]), int(words[1])


def _coordinates(path: Path, header: dict[str, str], inputs: int) -> Directions:
    name = header.setdefault("PARAM_IN", "UNKNOWN_INPUT").split()[0].upper()
    if name not in COORDINATES:
        raise InputError(
            f"{path}: the coordinates '#PARAM_IN {name}' do not give both directions, or not as "
            f"ALTA documents them; convert the data to {', '.join(sorted(COORDINATES))}"
        )
    count, directions = COORDINATES[name]
    if count != inputs:
        raise InputError(f"{path}: {name} has {count} numbers a row, #DIM declares {inputs}")
    return directions


def _kind(path: Path, header: dict[str, str], options: ReadOptions) -> str:
    kind = header.get("PARAM_OUT", "UNKNOWN_OUTPUT").split()[0].upper()
    if kind not in QUANTITIES and (options.quantity is None or kind != "UNKNOWN_OUTPUT"):
        raise InputError(
            f"{path}: the quantity of the values is '#PARAM_OUT {kind}'; read are "
            f"{', '.join(QUANTITIES)}, and files without it with --quantity"
        )
    return kind


def _unit(path: Path, lamp: Array, receiver: Array) -> tuple[Array, Array]:
    """Both as unit vectors; a direction that the coordinates don't have lies below the horizon."""
    made = []
    for vectors in (lamp, receiver):
        length = np.linalg.norm(vectors, axis=1)
        odd = np.isfinite(length) & (np.abs(length - 1.0) > 1e-2)
        if odd.any():
            raise InputError(
                f"{path}: row {int(np.argmax(odd)) + 1} of the numbers has a direction of length "
                f"{length[odd][0]:.3g}, expected 1; is '#PARAM_IN' right?"
            )
        sound = np.isfinite(length)[:, None]
        down = np.array([0.0, 0.0, -1.0])
        made.append(np.where(sound, vectors / np.where(sound, length[:, None], 1.0), down))
    return made[0], made[1]
