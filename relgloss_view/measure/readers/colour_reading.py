"""From the numbers of one spectrum to a ColourReading: unit, noise, range and step."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.quantity import (
    RADIANCE_FACTOR,
    RADIANCE_FACTOR_PERCENT,
    canonical_quantity,
    to_radiance_factor,
)
from relgloss_view.measure.readers.samples import Sample, geometry_of
from relgloss_view.measure.screening import MOST_BODY, NOISE
from relgloss_view.measure.spectrum import ColourReading

#: Up to here undeclared values are reflectances: white papers with brighteners reach 1.2.
MOST_FRACTION = 1.3
MOST_PERCENT = 100.0 * MOST_BODY
SEEN_NM = (360.0, 830.0)  #: CIE 1931
NEEDED_NM = (430.0, 670.0)  #: as in material.band_coverage, where the figures are
WIDEST_NM = 50.0  #: likewise
FINEST_NM = 1.0  #: finer steps are averaged: no instrument's band is narrower
VALUE = "the reflectance"


def colour_reading(
    path: Path, sample: Sample, quantity: str | None, notes: list[str], declared: str | None = None
) -> ColourReading:
    """The reading that a sample's numbers give.

    quantity: the caller's, which replaces what the file declares. notes: of the file; what is
    found here joins them. Raises InputError that names wavelength and remedy.
    """
    said = list(notes)
    nm, values = _sorted(path, sample)
    values = _filled(path, nm, values, said)
    nm, values = _seen(path, nm, values, said)
    factor = _factor(path, values, sample.percent, declared, quantity, said)
    nm, factor = _above_zero(path, nm, factor, said)
    nm, factor = _averaged(nm, factor, said)
    wide = float(np.max(np.diff(nm), initial=0.0)) if len(nm) > 1 else np.inf
    if nm[0] > NEEDED_NM[0] or nm[-1] < NEEDED_NM[1] or wide > WIDEST_NM:
        raise InputError(
            f"{path}: {_span(nm)}: a colour needs a reflectance from {NEEDED_NM[0]:g} to "
            f"{NEEDED_NM[1]:g} nm or wider (400 to 700 is usual), in steps of at most "
            f"{WIDEST_NM:g} nm"
        )
    return ColourReading(
        name=sample.name,
        bands=Bands(tuple(map(float, nm))),
        radiance_factor=factor,
        geometry=geometry_of(sample.geometry),
        notes=tuple(said),
        file=str(path),
    )


def _span(nm: Array) -> str:
    if len(nm) < 2:
        return "one wavelength"
    return f"{len(nm)} wavelengths, {nm[0]:g} to {nm[-1]:g} nm"


def _sorted(path: Path, sample: Sample) -> tuple[Array, Array]:
    nm, values = sample.wavelengths_nm, sample.values
    order = np.argsort(nm, kind="stable")
    nm, values = nm[order], values[order]
    same = np.flatnonzero(np.diff(nm) <= 0.0)
    if len(same):
        raise InputError(f"{path}: {nm[same[0]]:g} nm occurs twice; give each wavelength once")
    return nm, values


def _filled(path: Path, nm: Array, values: Array, notes: list[str]) -> Array:
    """Empty cells between others interpolated; those at the ends stay, and are cut off later."""
    empty = np.isnan(values)
    if np.all(empty):
        raise InputError(f"{path}: the spectrum has no value; give one that was measured")
    inside = empty & (nm > nm[~empty][0]) & (nm < nm[~empty][-1])
    if np.any(inside):
        at = nm[~empty]
        gaps = np.diff(at)
        if np.max(gaps) > WIDEST_NM:
            k = int(np.argmax(gaps))
            raise InputError(
                f"{path}: no reflectance from {at[k]:g} to {at[k + 1]:g} nm; a colour needs "
                f"steps of at most {WIDEST_NM:g} nm"
            )
        count = int(np.sum(inside))
        notes.append(
            f"no reflectance at {nm[np.argmax(inside)]:g} nm"
            f"{f' and {count - 1} more' if count > 1 else ''}: interpolated between the neighbours"
        )
        values = np.where(inside, np.interp(nm, at, values[~empty]), values)
    return values


def _seen(path: Path, nm: Array, values: Array, notes: list[str]) -> tuple[Array, Array]:
    """Without empty ends, and without what lies where no eye sees."""
    filled = np.isfinite(values)
    seen = (nm >= SEEN_NM[0]) & (nm <= SEEN_NM[1]) & filled
    if np.any(filled & ~seen):
        notes.append(f"left out wavelengths outside {SEEN_NM[0]:g} to {SEEN_NM[1]:g} nm")
    if not np.any(seen):
        raise InputError(
            f"{path}: no reflectance between {SEEN_NM[0]:g} and {SEEN_NM[1]:g} nm; give "
            "wavelengths in nanometres, 400 to 700 or wider"
        )
    return nm[seen], values[seen]


def _factor(
    path: Path,
    values: Array,
    percent: bool | None,
    declared: str | None,
    argument: str | None,
    notes: list[str],
) -> Array:
    """The values as radiance factors: what is declared, or what they can only be."""
    most = float(np.max(values))
    if argument is not None:
        quantity = canonical_quantity(argument, "--quantity")
    elif declared is not None:
        quantity = declared
    elif percent is not None:
        quantity = RADIANCE_FACTOR_PERCENT if percent else RADIANCE_FACTOR
    elif most <= MOST_FRACTION:
        quantity = RADIANCE_FACTOR
        notes.append(
            f"the values, up to {most:.3g}, are read as fractions of the perfect diffuser "
            f"(--quantity {RADIANCE_FACTOR_PERCENT} reads percent)"
        )
    elif MOST_BODY < most <= MOST_PERCENT:
        quantity = RADIANCE_FACTOR_PERCENT
        notes.append(
            f"the values, up to {most:.3g}, are read as percent: no surface reflects more than "
            "it receives"
        )
    elif most <= MOST_BODY:
        raise InputError(
            f"{path}: the values reach {most:.3g}: percent of a black, or fractions of a "
            f"fluorescent white? Pass --quantity {RADIANCE_FACTOR_PERCENT} or {RADIANCE_FACTOR}"
        )
    else:
        raise InputError(
            f"{path}: the values reach {most:.3g}, beyond any reflectance in percent; give "
            "reflectance, as fractions or percent, and no raw signal"
        )
    # A reading at 45/0 and one of a sphere see the sample from the normal, or 8 degrees beside it.
    factor: Array = to_radiance_factor(values[None, :], quantity, np.ones(1))[0]
    if argument is None and float(np.max(factor)) > MOST_BODY:
        other = RADIANCE_FACTOR_PERCENT if quantity != RADIANCE_FACTOR_PERCENT else None
        remedy = f"pass --quantity {other}" if other and most <= MOST_PERCENT else "check the unit"
        raise InputError(
            f"{path}: read as {quantity}, the values reach {np.max(factor):.3g}, and the perfect "
            f"diffuser has 1; {remedy}"
        )
    return factor


def _above_zero(path: Path, nm: Array, factor: Array, notes: list[str]) -> tuple[Array, Array]:
    """Noise below zero as zero; bands beside the needed range that are below it left out."""
    low = factor < -NOISE
    needed = (nm >= NEEDED_NM[0]) & (nm <= NEEDED_NM[1])
    if np.any(low & needed):
        k = int(np.argmin(np.where(needed, factor, np.inf)))
        raise InputError(
            f"{path}: {VALUE} at {nm[k]:g} nm is {factor[k]:.3g}, below zero by more than noise; "
            "calibrate the instrument on its black and white standards and measure again"
        )
    if np.any(low):
        listed = ", ".join(f"{v:g}" for v in nm[low][:5])
        notes.append(f"left out what is below zero by more than noise ({listed} nm)")
        nm, factor = nm[~low], factor[~low]
    below = factor < 0.0
    if np.any(below):
        notes.append(f"values down to {np.min(factor):.2g} are read as 0: noise about zero")
    return nm, np.maximum(factor, 0.0)


def _averaged(nm: Array, factor: Array, notes: list[str]) -> tuple[Array, Array]:
    """Steps finer than FINEST_NM averaged to whole nanometres."""
    if len(nm) < 2 or np.min(np.diff(nm)) >= FINEST_NM * (1.0 - 1e-6):
        return nm, factor
    whole = np.rint(nm / FINEST_NM).astype(np.int64)
    centres, which, counts = np.unique(whole, return_inverse=True, return_counts=True)
    mean = np.bincount(which.ravel(), weights=factor) / counts
    notes.append(f"{len(nm)} wavelengths averaged to {len(centres)}, {FINEST_NM:g} nm apart")
    return np.asarray(centres * FINEST_NM, np.float64), np.asarray(mean, np.float64)
