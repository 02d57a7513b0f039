"""Single bad values of a spectrum: noise below zero, which stays, and faults, which are filled.

A spectrum of 31 values with one that is empty, negative or absurd has 30 good ones. The value that
its neighbours in wavelength suggest stands in for it.
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask

#: A sample with more bad values than this share of its bands is left out.
MOST_FILLED = 0.25
#: Spectra of surfaces are smooth: a value that is this many times its neighbours, or this small a
#: share of them, and off by an amount that counts, is none. Where bands are close, and many.
ABSURD, ABSURD_BY = 5.0, 0.05
NEAR_NM, FEWEST_BANDS = 26.0, 7
#: In more samples than this share, and this number, such values are what the table holds.
MOST_ABSURD, FEW_ABSURD = 0.05, 3
ROWS_AT_ONCE = 1 << 15
EMPTY, NEGATIVE, ABSURD_WORD = "empty", "negative", "far off its neighbours"


def mended(
    radiance_factor: Array, noise: Array, centres_nm: Array, angles: Array, whole: Mask
) -> tuple[Array, Mask, list[str]]:
    """The values with single bad ones filled, where there is noise below zero, and notes.

    radiance_factor: (N, B), NaN where empty. noise: (B,), how far below zero a value is noise.
    centres_nm: (B,). angles: (N, A), degrees, for the notes. whole: (N,), samples whose geometry
    is of use; the others stay as they are.

    A value is filled by the white highlight and the share of the body's colour that explain the
    good ones of its sample best, and by what the neighbours leave over, interpolated in wavelength.
    """
    low = radiance_factor < 0.0
    is_noise = low & (radiance_factor >= -noise)
    kinds = {EMPTY: np.isnan(radiance_factor), NEGATIVE: low & ~is_noise}
    kinds[ABSURD_WORD] = _absurd(radiance_factor, centres_nm)
    bad = kinds[EMPTY] | kinds[NEGATIVE] | kinds[ABSURD_WORD]
    share = bad.mean(axis=1)
    rows = np.flatnonzero(whole & (share > 0.0) & (share <= MOST_FILLED))
    notes = []
    if len(rows):
        filled = radiance_factor.copy()
        typical = _typical(radiance_factor)
        for row in rows:
            done = _completed(filled[row], ~bad[row], typical, centres_nm)
            # The body of a dark sample extrapolates to below zero, where no reflectance is.
            filled[row] = np.where(bad[row], np.maximum(done, 0.0), done)
        radiance_factor = filled
        notes.append(_filled_note(kinds, bad, rows, centres_nm, angles))
    if np.any(is_noise):
        count, lowest = int(np.sum(is_noise)), float(np.min(radiance_factor[is_noise]))
        notes.append(
            f"{count} reading{'s' if count > 1 else ''} down to {lowest:.2g} "
            f"{'are' if count > 1 else 'is'} kept as noise about zero"
        )
    mask = is_noise.copy()
    mask[rows] |= bad[rows]
    return radiance_factor, mask, notes


def _completed(values: Array, good: Mask, typical: Array, centres_nm: Array) -> Array:
    """(B,), the values with those that are not good filled."""
    basis = np.column_stack([np.ones(len(typical)), typical])
    # From the body's colour alone: where it is flat, nothing parts it from a white highlight.
    share = float(np.median((values / typical)[good]))
    more = np.linalg.lstsq(basis[good], (values - share * typical)[good], rcond=1e-9)[0]
    parts = more + np.array([0.0, share])
    rest = np.interp(centres_nm, centres_nm[good], (values - basis @ parts)[good])
    return np.where(good, values, basis @ parts + rest)


def _typical(values: Array) -> Array:
    """(B,), what each band reads in most samples, above zero."""
    some = values[:: max(len(values) // ROWS_AT_ONCE, 1)]
    middle = np.nanmedian(np.where(np.isfinite(some).any(axis=0), some, 1.0), axis=0)
    least = 1e-3 * float(np.max(middle, initial=0.0))
    return np.asarray(np.maximum(middle, least if least > 0.0 else 1.0))


def _absurd(values: Array, centres_nm: Array) -> Mask:
    """(N, B), values that no neighbour in wavelength comes near, as they are and per typical value.

    The median of two neighbours to either side is compared, so that a spike does not accuse them.
    """
    found = np.zeros(values.shape, dtype=bool)
    bands = len(centres_nm)
    if bands < FEWEST_BANDS or np.max(np.diff(centres_nm)) > NEAR_NM or not len(values):
        return found
    typical: Array | None = None
    at = np.arange(bands)[:, None] + np.array([-2, -1, 1, 2])
    beyond = (at < 0) | (at >= bands)
    at = np.clip(at, 0, bands - 1)
    for top in range(0, len(values), ROWS_AT_ONCE):
        some = values[top : top + ROWS_AT_ONCE]
        # Few samples hold a jump from one band to the next.
        pairs = some[:, :-1], some[:, 1:]
        low, high = np.minimum(*pairs), np.maximum(*pairs)
        rows = np.flatnonzero(((high > ABSURD * low) & (high - low > ABSURD_BY)).any(axis=1))
        if not len(rows):
            continue
        typical = _typical(values) if typical is None else typical
        part = some[rows]
        around = np.where(beyond, np.nan, part[:, at])  # (rows, bands, 4)
        around[np.isnan(around).all(axis=2)] = 1.0
        nearby = np.nanmedian(around, axis=2)
        relative = np.nanmedian(around / typical[at], axis=2) * typical
        off = (_off(part, nearby) > 1.0) & (_off(part, relative) > 1.0)
        found[top + rows] = off & (np.abs(part - nearby) > ABSURD_BY)
    count = int(np.sum(found.any(axis=1)))
    return found & (count <= max(MOST_ABSURD * len(values), FEW_ABSURD))


def _off(values: Array, expected: Array) -> Array:
    """Above 1 where values are absurd beside what is expected."""
    size = np.maximum(np.abs(expected), 1e-12)
    ratio = np.abs(values) / size
    return np.maximum(ratio, 1.0 / np.maximum(ratio, 1e-12)) / ABSURD


def _filled_note(
    kinds: dict[str, Mask], bad: Mask, rows: Ints, centres_nm: Array, angles: Array
) -> str:
    row = int(rows[0])
    band = int(np.argmax(bad[row]))
    place = ", ".join(f"{x:g}" for x in angles[row])
    counts = {word: int(np.sum(mask[rows])) for word, mask in kinds.items()}
    total = int(np.sum(bad[rows]))
    listed = ", ".join(f"{count} {word}" for word, count in counts.items() if count)
    return (
        f"{total} single value{'s are' if total > 1 else ' is'} filled from neighbouring bands "
        f"({listed}): the first at {centres_nm[band]:g} nm, {place} deg"
    )
