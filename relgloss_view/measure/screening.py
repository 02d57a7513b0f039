"""Reasons to leave samples out of a measurement."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.measure import table
from relgloss_view.measure.gonio import GRAZING_COSINE, OCCLUSION_DEG

#: Values whose half-vector is further from the normal than this show the body of most samples.
BODY_DEG = 20.0
#: No surface sends back more light than it receives; fluorescent papers come near this.
MOST_BODY = 2.0


def reasons(
    to_lamp: Array,
    to_receiver: Array,
    readings: Array,
    *,
    saturation: float | None = None,
    arms_occlude: bool = False,
) -> NDArray[np.str_]:
    """For each sample, table.KEPT or the reason to leave it out; shape (N,).

    to_lamp, to_receiver: (N, 3), unit vectors. readings: (N, B), as the instrument wrote them, NaN
    where a field is empty. saturation: largest reading of the instrument, in the same unit.
    arms_occlude: lamp and receiver are arms that shadow each other within 8 degrees.

    Where several reasons apply, the reading's own fault comes before the geometry's.

    >>> above = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    >>> reasons(above, above, np.array([[0.5], [-0.1]])).tolist()
    ['', 'negative']
    """
    missing = np.isnan(readings).any(axis=1)
    filled = np.where(np.isnan(readings), 0.0, readings)
    lowest = np.minimum(to_lamp[:, 2], to_receiver[:, 2])

    faults = [
        (table.MISSING, missing),
        (table.NEGATIVE, (filled < 0.0).any(axis=1)),
    ]
    if saturation is not None:
        faults.append((table.SATURATED, (filled >= saturation).any(axis=1)))
    # cos(90 deg) is 6e-17 in float64: the horizon itself counts as below.
    faults += [(table.BELOW, lowest <= 1e-12), (table.GRAZING, lowest < GRAZING_COSINE)]
    if arms_occlude:
        # From the chord, which stays exact for near-equal directions where acos does not.
        chord = np.linalg.norm(to_lamp - to_receiver, axis=1)
        angle_deg = np.degrees(2.0 * np.arcsin(np.minimum(0.5 * chord, 1.0)))
        # "Within 8 degrees" includes 8 itself, whatever the last bit of the chord is.
        faults.append((table.OCCLUDED, angle_deg <= OCCLUSION_DEG + 1e-9))

    names = [name for name, _ in faults]
    chosen = np.select([mask for _, mask in faults], names, default=table.KEPT)
    return np.asarray(chosen, dtype=np.str_)


def percent_warning(
    to_lamp: Array, to_receiver: Array, radiance_factor: Array, kept: Mask
) -> str | None:
    """A warning where the values can be no radiance factors, as where they are percent; else None.

    Arrays as in Measurement. Away from the mirror direction the median of the brightest band is the
    diffuse reflectance, at most about 1.

    >>> straight = np.array([[0.0, 0.0, 1.0]])
    >>> aslant = np.array([[0.0, 0.9428, 0.3333]])
    >>> percent_warning(straight, aslant, np.array([[0.8]]), np.array([True])) is None
    True
    >>> percent_warning(straight, aslant, np.array([[80.0]]), np.array([True]))
    'away from the mirror direction the values reach 80, ... they look like percent; ...'
    """
    half = to_lamp + to_receiver
    length = np.linalg.norm(half, axis=1)
    away = kept & (half[:, 2] < np.cos(np.radians(BODY_DEG)) * length)
    if not np.any(away):
        return None
    level = float(np.max(np.median(radiance_factor[away], axis=0)))
    if not level > MOST_BODY:
        return None
    looks = "they look like percent; divide them by 100, or " if level <= 100 * MOST_BODY else ""
    return (
        f"away from the mirror direction the values reach {level:.3g}, and the perfect diffuser "
        f"has 1: {looks}give the right --quantity"
    )
