"""What readers share: the directions of tabulated files, duplicates, nothing left to use."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from relgloss_view.errors import InputError
from relgloss_view.measure.gonio import spherical, tabulated_grid
from relgloss_view.measure.table import Measurement

Array = NDArray[np.float64]

#: Two readings of one geometry that differ by more than this contradict each other: noise of gonio
#: instruments is a few percent.
CONTRADICTION = 0.10


def tabulated_directions() -> tuple[Array, Array, NDArray[np.int64]]:
    """To lamp and to receiver, (N, 3) each, of gonio.tabulated_grid(), and the group of each.

    The lamp stands at azimuth 180, so that the mirror direction is at azimuth 0; the group is the
    incidence polar angle in degrees.
    """
    theta_i, theta_r, phi = tabulated_grid().T
    to_lamp = spherical(theta_i, np.full_like(theta_i, 180.0))
    return to_lamp, spherical(theta_r, 180.0 - phi), np.rint(theta_i).astype(np.int64)


def require_samples(measurement: Measurement, path: object) -> Measurement:
    """Return the measurement; raises InputError where no sample is left."""
    if measurement.kept.any():
        return measurement
    why = ", ".join(f"{count} {reason}" for reason, count in measurement.left_out().items())
    raise InputError(
        f"{path}: none of the {len(measurement.reasons)} samples can be used ({why}); "
        "check the angles, the quantity and the empty fields"
    )


def contradictions(angles: Array, radiance_factor: Array, kept: NDArray[np.bool_]) -> str | None:
    """A warning where rows of the same angles (N, A) differ by more than noise, else None."""
    angles, level = angles[kept], radiance_factor[kept].mean(axis=1)
    if len(angles) < 2:
        return None
    order = np.lexsort(angles.T)
    same = (angles[order[1:]] == angles[order[:-1]]).all(axis=1)
    a, b = level[order[1:]][same], level[order[:-1]][same]
    count = int(np.sum(np.abs(a - b) > CONTRADICTION * np.maximum(a, b)))
    if not count:
        return None
    pair = np.flatnonzero(same)[np.argmax(np.abs(a - b))]
    place = ", ".join(f"{x:g}" for x in angles[order[pair]])
    return (
        f"{count} repeated geometr{'y' if count == 1 else 'ies'} differ by more than "
        f"{100 * CONTRADICTION:.0f} % (the largest at {place} deg); all are kept"
    )
