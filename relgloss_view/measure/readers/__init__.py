"""Readers: one for each format, chosen by the content of the file and never by its name."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import check_regular, unreadable
from relgloss_view.measure.quantity import BRDF, canonical_quantity
from relgloss_view.measure.readers import csv_table, gcms, generic, merl, rgl, tensor_file
from relgloss_view.measure.readers.built_in import table_file
from relgloss_view.measure.table import Measurement

__all__ = ["read_measurement"]

EXPECTED = "a measurement file"
MATERIAL = b"relgloss-material"  #: the format that `fit` writes into a material file


def read_measurement(
    path: str | Path,
    *,
    quantity: str | None = None,
    gamma_s_deg: float | None = None,
    mirror: str | None = None,
) -> Measurement:
    """Read an instrument's file: RGL .bsdf, MERL .binary, GCMS-style or generic CSV.

    path: the file; its content decides the format (docs/files.md). The name of a built-in paper,
    such as 'art-coated', reads its synthetic table, unless there is a file of that name.
    quantity: 'radiance-factor' (pi f_r), 'brdf' (f_r, 1/sr) or 'brdf-cos' (f_r cos theta_r, 1/sr).
    It replaces what a text table declares, and is required where the table declares none.
    gamma_s_deg: tilt at which a GCMS table sees the mirror direction, degrees, -90 to 90; replaces
    the declared one.
    mirror: 'opposite' where the receiver is counted to the other side than the lamp, so that the
    mirror direction is at beta = -alpha or opposite azimuths; 'same-side' where it is at
    beta = +alpha or equal azimuths. Replaces what a text table declares; opposite is the default.

    Returns the Measurement in radiance factors, with its warnings. Raises InputError, one line
    that names file, place and remedy, for everything that is wrong with the file.

    Sources of the formats: Dupuy and Jakob 2018 (RGL), Matusik et al. 2003 (MERL).

    >>> read_measurement("uncoated").bands.count
    35
    >>> read_measurement("no-such.csv")
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: no-such.csv: can't be read (No such file or directory)...
    """
    file = table_file(path)
    try:
        measurement = _read(file, quantity, gamma_s_deg, mirror)
    except OSError as error:
        raise unreadable(path, error, EXPECTED) from None
    return replace(measurement, file=str(file))


def _read(
    path: Path, quantity: str | None, gamma_s_deg: float | None, mirror: str | None
) -> Measurement:
    with check_regular(path, EXPECTED).open("rb") as file:
        head = file.read(4096)

    # A file cut off inside the magic number is a damaged .bsdf too.
    if head and tensor_file.MAGIC.startswith(head[: len(tensor_file.MAGIC)]):
        measurement = rgl.read(path)
    elif head.startswith(merl.HEADER):
        measurement = merl.read(path)
    elif head.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise InputError(f"{path}: the text is UTF-16; save it as UTF-8")
    elif b"\x00" in head:
        raise InputError(
            f"{path}: neither text nor a known binary format; "
            "give a CSV table, an RGL .bsdf or a MERL .binary"
        )
    elif head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{") and MATERIAL in head:
        raise InputError(
            f"{path}: this is a material, not a measurement; "
            f"draw it with `relgloss snapshot --material`"
        )
    else:
        return _read_text(path, quantity, gamma_s_deg, mirror)
    return _with_unused_arguments(measurement, quantity, gamma_s_deg, mirror)


def _with_unused_arguments(
    measurement: Measurement,
    quantity: str | None,
    gamma_s_deg: float | None,
    mirror: str | None,
) -> Measurement:
    """The measurement, with a warning for each argument that its format does not use."""
    warnings = list(measurement.warnings)
    if quantity is not None and canonical_quantity(quantity, "--quantity") != BRDF:
        warnings.append(f"the format holds BRDFs in 1/sr; --quantity {quantity} is not used")
    if gamma_s_deg is not None:
        warnings.append("the format has no tilt of the sample; --gamma-s-deg is not used")
    if mirror is not None:
        warnings.append("the format fixes its mirror direction; --mirror is not used")
    return replace(measurement, warnings=tuple(warnings))


def _read_text(
    path: Path, quantity: str | None, gamma_s_deg: float | None, mirror: str | None
) -> Measurement:
    table = csv_table.parse(path)
    names = {name.lower() for name in table.columns}
    if names & gcms.COLUMNS.keys():
        return gcms.read(table, quantity, gamma_s_deg, mirror)
    if names & generic.COLUMNS.keys():
        return generic.read(table, quantity, gamma_s_deg, mirror)
    raise InputError(
        f"{path}: line {table.header_line}: found column {table.columns[0]!a}; the header "
        f"should begin {','.join(gcms.COLUMNS)} or {','.join(generic.COLUMNS)}"
    )
