"""From the spectra of a multi-angle spectrophotometer to the Measurement of one sample."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.quantity import (
    RADIANCE_FACTOR,
    RADIANCE_FACTOR_PERCENT,
    canonical_quantity,
)
from relgloss_view.measure.readers.aspecular import directions
from relgloss_view.measure.readers.assemble import assemble
from relgloss_view.measure.readers.colour_reading import MOST_FRACTION
from relgloss_view.measure.readers.declared import Declared
from relgloss_view.measure.readers.options import ReadOptions
from relgloss_view.measure.readers.parts import chosen_part
from relgloss_view.measure.readers.samples import Sample, SampleFile, series
from relgloss_view.measure.screening import MOST_BODY
from relgloss_view.measure.table import Measurement


def measurement(path: Path, file: SampleFile, options: ReadOptions) -> Measurement:
    """The wanted sample of a file, its geometries as directions.

    options: part chooses the sample, quantity replaces the declared one. Raises InputError, one
    line that names the remedy; for spectra of a single geometry, what they can serve for.
    """
    groups = series(file.samples)
    measured = {name: s for name, s in groups.items() if any(x.angle is not None for x in s)}
    if not measured:
        raise InputError(_single_geometry(path, file))
    names = list(measured)
    name = names[chosen_part(path, names, options.part) if len(names) > 1 else 0]
    samples = [sample for sample in measured[name] if sample.angle is not None]
    notes = list(file.notes)
    if len(names) == 1 and options.part is not None:
        notes += options.unused("part")
    nm, readings = _common(path, samples, notes)
    geometries = [sample.angle for sample in samples if sample.angle is not None]
    angles = np.array(geometries, np.float64).reshape(-1, 3)
    facts = Declared(
        name=printable(name, 60),
        source=printable(file.source or path.name, 200),
        quantity=_quantity(path, samples, readings, angles, file, options, notes),
        quantity_insisted=options.quantity is not None,
        warnings=(*notes, *options.unused("gamma_s_deg", "angle_unit", "mirror")),
    )
    try:
        bands = Bands(tuple(map(float, nm)))
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    result = assemble(path, facts, angles, bands, readings, directions(geometries), angles[:, 0])
    return replace(result, file=str(path))


def _single_geometry(path: Path, file: SampleFile) -> str:
    count = len(file.samples)
    if not count:
        return f"{path}: the file holds no reflectance spectrum; export the spectra with it"
    what = "one spectrum" if count == 1 else f"{count} spectra"
    part = "" if count == 1 else ", with --part NAME"
    return (
        f"{path}: {what} in a single geometry, no multi-angle readings; a fit needs 12 geometries. "
        "For the colour of a material: `relgloss estimate --spectrum FILE`" + part
    )


def _common(path: Path, samples: list[Sample], notes: list[str]) -> tuple[Array, Array]:
    """The wavelengths that all spectra have, and the readings, (N, B)."""
    shared = samples[0].wavelengths_nm
    for sample in samples[1:]:
        shared = np.intersect1d(shared, sample.wavelengths_nm)
    if len(shared) < 2:
        raise InputError(
            f"{path}: the geometries of a sample have no wavelengths in common; export all with "
            "the same ones"
        )
    if any(len(sample.wavelengths_nm) != len(shared) for sample in samples):
        notes.append(f"read the {len(shared)} wavelengths that all geometries have")
    rows = []
    for sample in samples:
        order = np.argsort(sample.wavelengths_nm, kind="stable")
        ordered = sample.wavelengths_nm[order]
        same = np.flatnonzero(np.diff(ordered) <= 0.0)
        if len(same):
            raise InputError(f"{path}: {ordered[same[0]]:g} nm occurs twice; give it once")
        rows.append(sample.values[order][np.searchsorted(ordered, shared)])
    return np.sort(shared), np.array(rows)


def _quantity(
    path: Path,
    samples: list[Sample],
    readings: Array,
    angles: Array,
    file: SampleFile,
    options: ReadOptions,
    notes: list[str],
) -> str:
    """What the numbers are: declared, or what the geometry furthest from the mirror shows."""
    if options.quantity is not None:
        return canonical_quantity(options.quantity, "--quantity")
    if file.quantity is not None:
        return file.quantity
    declared = {sample.percent for sample in samples}
    if declared == {True}:
        return RADIANCE_FACTOR_PERCENT
    if declared == {False}:
        return RADIANCE_FACTOR
    filled = np.isfinite(readings).any(axis=1)
    if not np.any(filled):
        return RADIANCE_FACTOR
    away = np.abs(angles[:, 1]) >= min(40.0, float(np.max(np.abs(angles[filled, 1])))) - 1e-9
    level = float(np.nanmax(readings[away & filled], initial=0.0))
    if level <= MOST_FRACTION:
        notes.append(
            f"the values are read as fractions of the perfect diffuser ({level:.3g} away from the "
            f"mirror direction; --quantity {RADIANCE_FACTOR_PERCENT} reads percent)"
        )
        return RADIANCE_FACTOR
    if level > MOST_BODY:
        notes.append(
            f"the values are read as percent: they reach {level:.3g} away from the mirror direction"
        )
        return RADIANCE_FACTOR_PERCENT
    raise InputError(
        f"{path}: the values reach {level:.3g} away from the mirror direction: percent of a black, "
        f"or fractions? Pass --quantity {RADIANCE_FACTOR_PERCENT} or {RADIANCE_FACTOR}"
    )
