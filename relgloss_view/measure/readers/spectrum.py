"""The colour of a sample as a spectrophotometer reads it: one spectrum of a file in any format."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from relgloss_view.base.errors import InputError
from relgloss_view.base.foreign import HEAD_BYTES, foreign_format
from relgloss_view.base.reading import decoding, read_beginning
from relgloss_view.measure.gonio import from_normal
from relgloss_view.measure.quantity import RADIANCE_FACTOR, canonical_quantity
from relgloss_view.measure.readers import (
    cgats,
    cxf,
    merl,
    read_measurement,
    spectrum_text,
    tensor_file,
)
from relgloss_view.measure.readers.colour_reading import MOST_PERCENT, colour_reading
from relgloss_view.measure.readers.parts import chosen_part
from relgloss_view.measure.readers.recognised import is_table_of_angles
from relgloss_view.measure.readers.samples import Sample, SampleFile, series
from relgloss_view.measure.readers.spectrum_text import EXPECTED
from relgloss_view.measure.screening import MOST_BODY
from relgloss_view.measure.spectrum import AT_45_0, ColourReading, from_45_0, is_45_0
from relgloss_view.measure.table import Measurement

__all__ = ["read_spectrum"]

TIE_DEG = 0.5  #: geometries of a gonio table that are this much farther from 45/0 are averaged
#: Readers of the spectra in formats of other programs, by the key in base.foreign.
_FORMATS: Mapping[str, Callable[[Path], SampleFile]] = {
    "cgats": cgats.read_samples,
    "cxf": cxf.read_samples,
}


def read_spectrum(
    path: str | Path, *, part: str | None = None, quantity: str | None = None
) -> ColourReading:
    """Read one reflectance spectrum: of text, CGATS, CxF3 or a gonio table.

    path: the file, whose content decides the format (docs/files.md). Of a gonio table
    and of multi-angle readings, the geometry 45/0 is taken.
    part: name, in any case, or number from 1 of the sample that is wanted of several.
    quantity: one of measure.quantity.QUANTITIES; replaces what the file declares or what its
    values look like.

    Returns radiance factors (1 is the perfect diffuser) from 360 to 830 nm at most, with notes on
    what was converted or passed over. Raises InputError, one line that names file and remedy.
    """
    file = Path(path)
    if quantity is not None:
        canonical_quantity(quantity, "--quantity")
    head = read_beginning(file, HEAD_BYTES, EXPECTED)
    with decoding(file, EXPECTED):
        if _is_gonio(head):
            return _of_table(read_measurement(file, quantity=quantity, part=part))
        samples = _samples(file, head, part)
        sample = _chosen(file, samples, part)
        return colour_reading(file, sample, quantity, samples.notes, samples.quantity)


def _samples(path: Path, head: bytes, part: str | None) -> SampleFile:
    foreign = foreign_format(head)
    if foreign is None:
        return spectrum_text.read_samples(path, part)
    if foreign.key in _FORMATS:
        return _FORMATS[foreign.key](path)
    raise InputError(
        f"{path}: this looks like {foreign.name}, of which no spectrum is read; save two columns, "
        "wavelength (nm) and reflectance, as text"
    )


def _chosen(path: Path, file: SampleFile, part: str | None) -> Sample:
    """The wanted sample; of a multi-angle instrument, its reading along the normal."""
    groups = series(file.samples)
    if not any(sample.angle is not None for sample in file.samples):
        groups = {**groups, **{name: [] for name in file.colours if name not in groups}}
    names = list(groups)
    name = names[chosen_part(path, names, part) if len(names) > 1 else 0]
    if not groups[name]:
        lab = ",".join(f"{v:.4g}" for v in file.colours[name])
        raise InputError(
            f"{path}: the sample {name!r} has a colour and no spectrum; pass it as --lab {lab}"
        )
    samples = groups[name]
    flat = [sample for sample in samples if sample.angle is None]
    if flat:  # of which each has a name of its own
        return _scaled(file, flat[0])
    normal = [sample for sample in samples if sample.angle is not None and sample.angle.is_45_0]
    if not normal:
        listed = ", ".join(s.angle.words for s in samples[:8] if s.angle is not None)
        raise InputError(
            f"{path}: the sample {name!r} has no geometry 45as45 (45/0) among {listed}; fit it "
            "with `relgloss fit`, or give the spectrum as two columns"
        )
    file.notes.append(f"read the geometry 45as45, which is 45/0, of {len(samples)}")
    return replace(_scaled(file, normal[0]), geometry=AT_45_0)


def _scaled(file: SampleFile, sample: Sample) -> Sample:
    """The sample, marked as percent where others of its file can be nothing else."""
    if sample.percent is None and file.quantity is None:
        most = max(
            float(np.nanmax(s.values, initial=0.0))
            for s in file.samples
            if s.angle is None or s.angle.is_45_0
        )
        if MOST_BODY < most <= MOST_PERCENT:
            file.notes.append(f"the values of the file, up to {most:.3g}, are read as percent")
            return replace(sample, percent=True)
    return sample


def _is_gonio(head: bytes) -> bool:
    """Whether a file begins as a table of angles or a binary BRDF."""
    if head.startswith((tensor_file.MAGIC, merl.HEADER)):
        return True
    return foreign_format(head) is None and is_table_of_angles(head)


def _of_table(measurement: Measurement) -> ColourReading:
    """The geometry 45/0 of a table, or 0/45, which reads the same (Helmholtz reciprocity)."""
    place = measurement.place
    if measurement.bands.is_rgb:
        raise InputError(f"{place}: the table holds R, G, B and no spectrum; give wavelengths")
    lamp, receiver = (from_normal(d) for d in (measurement.to_lamp, measurement.to_receiver))
    off = from_45_0(lamp, receiver)
    rows = measurement.kept & is_45_0(lamp, receiver)
    rows &= off <= np.min(off, where=rows, initial=np.inf) + TIE_DEG
    if not np.any(rows):
        raise InputError(
            f"{place}: no geometry 45/0 (lamp at 45 degrees, receiver along the normal) among "
            f"{len(off)}; fit the table with `relgloss fit`, or give the spectrum as two columns"
        )
    notes = list(measurement.warnings)
    count = int(np.sum(rows))
    if len(off) > 1:
        notes.append(
            f"read the geometry 45/0 of {len(off)}"
            + (f", the mean of {count} readings" if count > 1 else "")
        )
    values = np.mean(measurement.radiance_factor[rows], axis=0)
    sample = Sample(measurement.name, measurement.bands.centres_nm(), values, AT_45_0)
    # A row of a table may hold noise below zero, and a bad value that a spectrum may not.
    reading = colour_reading(Path(place), sample, None, notes, RADIANCE_FACTOR)
    return replace(reading, geometry=AT_45_0, file=measurement.file)
