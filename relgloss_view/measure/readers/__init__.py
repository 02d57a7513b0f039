"""Readers: one for each format, chosen by the content of the file and never by its name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from relgloss_view.base.decoding import wide_encoding
from relgloss_view.base.errors import InputError
from relgloss_view.base.foreign import HEAD_BYTES, foreign_format, refuse_foreign_json
from relgloss_view.base.reading import decoding, read_beginning
from relgloss_view.measure.quantity import BRDF
from relgloss_view.measure.readers import (
    alta,
    arrange,
    astm_e1392,
    bsdf_xml,
    cgats,
    csv_table,
    cxf,
    gcms,
    generic,
    merl,
    multi_angle,
    pbsdf,
    rgl,
    spectrum_text,
    speos,
    ssdd,
    tensor_file,
    zemax,
)
from relgloss_view.measure.readers.built_in import table_file
from relgloss_view.measure.readers.options import ReadOptions
from relgloss_view.measure.table import Measurement

__all__ = ["read_measurement"]

EXPECTED = "a measurement file"
#: The reader of each format of another program, by its key in base.foreign.
FORMATS: Mapping[str, Callable[[Path, ReadOptions], Measurement]] = {
    "bsdf-xml": bsdf_xml.read,
    "zemax": zemax.read,
    "alta": alta.read,
    "e1392": astm_e1392.read,
    "ssdd": ssdd.read,
    "speos": speos.read,
    "cgats": cgats.read,
    "cxf": cxf.read,
}
MATERIAL = b"relgloss-material"  #: the format that `fit` writes into a material file
#: Bytes that no text holds, but for a few that a program lets slip.
_CONTROLS = [bytes([c]) for c in range(32) if c not in b"\t\n\x0b\x0c\r\x1a\x1b"]
MOST_CONTROLS = 0.005


def read_measurement(
    path: str | Path,
    *,
    quantity: str | None = None,
    gamma_s_deg: float | None = None,
    angle_unit: str | None = None,
    mirror: str | None = None,
    part: str | None = None,
) -> Measurement:
    """Read a measured table in any of the formats below.

    GCMS-style and generic tables as text (CSV), ASTM E1392, SSDD, ALTA, Zemax BSDF, Speos,
    BSDF XML of WINDOW and Radiance, RGL .bsdf, polarised .pbsdf, MERL .binary, and multi-angle
    readings in CGATS, CxF3 or CSV.

    path: the file; its content decides the format (docs/files.md). The name of a built-in paper,
    such as 'art-coated', reads its synthetic table, unless there is a file of that name.
    quantity: 'radiance-factor' (pi f_r), 'brdf' (f_r, 1/sr), 'brdf-cos' (f_r cos theta_r, 1/sr) or
    'radiance-factor-percent' (100 pi f_r). It replaces what the file declares, and is required
    where a text table declares none. A table whose values can't be the declared quantity is
    refused, unless this argument insists on it. RGL, pBSDF and MERL hold BRDFs whatever it is.
    gamma_s_deg: tilt at which a GCMS table sees the mirror direction, degrees, -90 to 90; replaces
    the declared one.
    angle_unit: 'degrees' or 'radians' of the angles of a text table or of ASTM E1392; replaces the
    declared one.
    mirror: 'opposite' where the receiver is counted so that the mirror direction is at
    beta = -alpha or at opposite azimuths; 'same-side' where it is at beta = +alpha or at equal
    azimuths. Replaces what a text table declares, and serves for ASTM E1392; opposite is the
    default.
    part: name or number, from 1, of the sample or surface that is wanted of a file that holds
    several: samples of a text table, CGATS or CxF3; 'front' or 'back' of BSDF XML.

    Returns the Measurement in radiance factors, with its warnings. Raises InputError, one line
    that names file, place and remedy, for everything that is wrong with the file.

    An argument that a format has no use for gives a warning.

    Sources of the formats: Dupuy and Jakob 2018 (RGL), Baek et al. 2020 (pBSDF), Matusik et al.
    2003 (MERL), libbsdf's specification of SSDD (Kimura 2023), ASTM E1392 as Cornell and libbsdf
    write it, Belcour et al. 2014 (ALTA), Rykowski 2008 (Zemax), LBNL's BSDF-v1.7.7.xsd and Ward's
    bsdf_m.c (BSDF XML), Ansys (Speos), ANSI CGATS.17, ISO 17972-1 (CxF3), ASTM E2194 (multi-angle).

    >>> read_measurement("uncoated").bands.count
    35
    >>> read_measurement("no-such.csv")
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: no-such.csv: can't be read (No such file or directory)...
    """
    file = table_file(path)
    options = ReadOptions(quantity, gamma_s_deg, angle_unit, mirror, part)
    with decoding(path, EXPECTED):
        measurement = _read(file, options)
    return replace(measurement, file=str(file))


def _read(path: Path, options: ReadOptions) -> Measurement:
    head = read_beginning(path, HEAD_BYTES, EXPECTED)

    # A file cut off inside the magic number is a damaged .bsdf too.
    if head and tensor_file.MAGIC.startswith(head[: len(tensor_file.MAGIC)]):
        measurement = _tensor_file(path)
    elif head.startswith(merl.HEADER):
        measurement = replace(merl.read(path), format="a MERL .binary", quantity=BRDF)
    else:
        foreign = foreign_format(head)
        if foreign is None:
            return _read_text(path, head, options)
        if foreign.key in FORMATS:
            measurement = FORMATS[foreign.key](path, options)
            return replace(measurement, format=foreign.name, in_time_order=False)
        raise InputError(f"{path}: this looks like {foreign.name}; {foreign.remedy}")
    unused = options.unused("quantity", "gamma_s_deg", "angle_unit", "mirror", "part")
    return replace(measurement, warnings=(*measurement.warnings, *unused))


def _tensor_file(path: Path) -> Measurement:
    if pbsdf.is_polarised(path):
        return replace(pbsdf.read(path), format="a polarised .pbsdf", quantity=BRDF)
    return replace(rgl.read(path), format="an RGL .bsdf", quantity=BRDF)


def _refuse_no_table(path: Path, head: bytes) -> None:
    """InputError for binary data and JSON."""
    controls = sum(head.count(c) for c in _CONTROLS)
    wide = wide_encoding(head) is not None
    if not wide and (b"\x00" in head or controls > MOST_CONTROLS * len(head)):
        raise InputError(
            f"{path}: neither text nor a known binary format; "
            "give a CSV table, an RGL .bsdf or a MERL .binary"
        )
    text = head.replace(b"\x00", b"") if wide else head
    text = text.lstrip(b"\xff\xfe\xef\xbb\xbf \t\r\n")
    if text.startswith(b"{") and MATERIAL in text:
        raise InputError(
            f"{path}: this is a material, not a measurement; "
            f"draw it with `relgloss snapshot --material`"
        )
    if text.startswith((b"{", b"[{")):
        refuse_foreign_json(text, path)
        raise InputError(f"{path}: this looks like JSON; give a measured table as CSV")


def _read_text(path: Path, head: bytes, options: ReadOptions) -> Measurement:
    _refuse_no_table(path, head[:4096])
    if spectrum_text.is_samples_table(head):
        return multi_angle.measurement(path, spectrum_text.read_samples(path, "1"), options)
    table = csv_table.parse(path, (gcms.COLUMNS.keys(), generic.COLUMNS.keys()))
    table, options = arrange.arranged(table, options)
    names = {name.lower() for name in table.columns}
    if names & gcms.COLUMNS.keys():
        return replace(gcms.read(table, options), format="a GCMS-style table")
    return replace(generic.read(table, options), format="a table of polar angles and azimuths")
