"""Steps that readers share: angles and readings to a Measurement, BRDFs above the horizon."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.base.errors import InputError
from relgloss_view.measure import screening as screen
from relgloss_view.measure import single_values
from relgloss_view.measure.bands import RGB, Bands
from relgloss_view.measure.gonio import GRAZING_COSINE, spherical, tabulated_grid
from relgloss_view.measure.quantity import to_radiance_factor
from relgloss_view.measure.readers.declared import Declared
from relgloss_view.measure.table import KEPT, Measurement, source_is_synthetic

#: Two readings of one geometry that differ by more than this contradict each other: noise of gonio
#: instruments is a few percent.
CONTRADICTION = 0.10
#: Readers refuse numbers above 1e12; a BRDF times pi, over the cosine at grazing angles.
MOST_FACTOR = 1e14


def tabulated_directions() -> tuple[Array, Array, Ints]:
    """To lamp and to receiver, (N, 3) each, of gonio.tabulated_grid(), and the group of each.

    The lamp has azimuth 180, so that the mirror direction is at azimuth 0. The group is the polar
    angle of incidence in whole degrees.
    """
    theta_i, theta_r, phi = tabulated_grid().T
    to_lamp = spherical(theta_i, np.full_like(theta_i, 180.0))
    return to_lamp, spherical(theta_r, 180.0 - phi), np.rint(theta_i).astype(np.int64)


def evaluate_above(
    i: ArrayLike, o: ArrayLike, brdf: Callable[[Array, Array], Array], channels: int = 3
) -> Array:
    """`brdf`, of directions (M, 3) each, where both are above z = 0; zero elsewhere, (..., C)."""
    i, o = np.broadcast_arrays(np.asarray(i, np.float64), np.asarray(o, np.float64))
    flat_i, flat_o = i.reshape(-1, 3), o.reshape(-1, 3)
    result = np.zeros((len(flat_i), channels))
    above = (flat_i[:, 2] > 0.0) & (flat_o[:, 2] > 0.0)
    if above.any():
        result[above] = brdf(flat_i[above], flat_o[above])
    return result.reshape(*i.shape[:-1], channels)


def assemble(
    path: Path,
    facts: Declared,
    angles: Array,
    bands: Bands,
    readings: Array,
    directions: tuple[Array, Array],
    group: Array,
    *,
    arms_occlude: bool = False,
) -> Measurement:
    """The measurement of what a reader found, screened and in radiance factors.

    path: for messages. facts: what the file and the caller declare.
    angles: (N, A), the instrument's, degrees. readings: (N, B), in the declared quantity.
    directions: to lamp and to receiver, (N, 3) each. group: (N,), rounded to whole numbers.
    Raises InputError where no sample is left, or where the values can't be the declared quantity
    and the caller does not insist on it.
    """
    to_lamp, to_receiver = directions
    factor = to_radiance_factor(readings, facts.quantity, to_receiver[:, 2])
    above = np.minimum(to_lamp[:, 2], to_receiver[:, 2]) > GRAZING_COSINE
    limit = screen.noise_limit(factor, above)
    out, dark = screen.unusable_bands(factor, above, bands, limit)
    left_out = screen.bands_note(factor[above], out, bands)
    if left_out is not None and bands.wavelengths_nm is not None:
        centres = zip(bands.wavelengths_nm, out, strict=True)
        bands = Bands(tuple(nm for nm, left in centres if not left))
        factor, readings, dark = factor[:, ~out], readings[:, ~out], dark[~out]
    mended: list[str] = []
    # A negative channel of linear sRGB is a saturated colour.
    if not bands.is_rgb and len(factor):
        noise = np.where(dark, np.inf, limit)
        factor, fine, mended = single_values.mended(
            factor, noise, bands.centres_nm(), angles, above
        )
        readings = np.where(fine, 0.0, readings)
    reasons = screen.reasons(
        to_lamp, to_receiver, readings, saturation=facts.saturation, arms_occlude=arms_occlude
    )
    percent = screen.percent_warning(to_lamp, to_receiver, factor, reasons == KEPT)
    if percent is not None and not facts.quantity_insisted:
        raise InputError(f"{path}: {percent}")
    doubts = (left_out, *mended, percent, contradictions(angles, factor, reasons == KEPT))
    measurement = Measurement(
        name=facts.name,
        source=facts.source,
        to_lamp=to_lamp,
        to_receiver=to_receiver,
        bands=bands,
        radiance_factor=factor,
        reasons=reasons,
        group=np.rint(group).astype(np.int64),
        aperture_sd_deg=facts.aperture_sd_deg,
        warnings=(*facts.warnings, *(doubt for doubt in doubts if doubt)),
        synthetic=source_is_synthetic(facts.source),
        quantity=facts.quantity,
    )
    return require_samples(measurement, path)


def one_channel(readings: Array, label: str) -> tuple[Bands, Array, str]:
    """Bands, readings (N, 3) and a warning for readings (N, 1) of a single channel.

    label: what the channel is, such as '633 nm'. A laser or a luminous reading has no colour: all
    channels of linear RGB get it, and the material is gray.

    >>> one_channel(np.array([[0.2]]), "633 nm")[1].tolist()
    [[0.2, 0.2, 0.2]]
    """
    warning = (
        f"the file holds one channel ({label}): the material is gray; give it a colour with --lab"
    )
    return RGB, np.repeat(readings, 3, axis=1), warning


def require_samples(measurement: Measurement, path: object) -> Measurement:
    """Return the measurement; raises InputError where no sample is left, or one is absurd."""
    kept = measurement.kept
    if kept.any():
        # Column by column: a copy of the kept rows would take as much as the table.
        for column in measurement.radiance_factor.T:
            for most in (column.max(where=kept, initial=0.0), column.min(where=kept, initial=0.0)):
                if not abs(most) <= MOST_FACTOR:
                    raise InputError(
                        f"{path}: a reading is {most:.3g} times the perfect diffuser's, beyond any "
                        "surface; the file is damaged, or its unit is another"
                    )
        return measurement
    why = ", ".join(f"{count} {reason}" for reason, count in measurement.left_out().items())
    raise InputError(
        f"{path}: none of the {len(measurement.reasons)} samples can be used ({why}); "
        "check the angles, the quantity and the empty fields"
    )


def contradictions(angles: Array, radiance_factor: Array, kept: Mask) -> str | None:
    """A warning where rows of the same angles (N, A) differ by more than noise, else None."""
    angles, level = angles[kept], radiance_factor[kept].mean(axis=1)
    if len(angles) < 2:
        return None
    order = np.lexsort(angles.T)
    same = (angles[order[1:]] == angles[order[:-1]]).all(axis=1)
    a, b = level[order[1:]][same], level[order[:-1]][same]
    count = int(np.sum(np.abs(a - b) > CONTRADICTION * np.maximum(a, b) + screen.NOISE))
    if not count:
        return None
    pair = np.flatnonzero(same)[np.argmax(np.abs(a - b))]
    place = ", ".join(f"{x:g}" for x in angles[order[pair]])
    return (
        f"{count} repeated geometr{'y' if count == 1 else 'ies'} differ by more than "
        f"{100 * CONTRADICTION:.0f} % (the largest at {place} deg); all are kept"
    )
