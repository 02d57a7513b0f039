"""How much of a large table is fitted: a part of it that stands for the whole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.fitting.observations import usable_rows
from relgloss_view.measure.table import Measurement
from relgloss_view.measure.thinning import thinned

#: Geometries on which the model is chosen, cross-validated and judged: many starts and one fit for
#: each plane, whose time and memory go with it (docs/files.md).
MOST_GEOMETRIES = 6000
#: Values, geometries times bands, on which the chosen model is refined last: one descent alone.
MOST_VALUES = 1_000_000


def selected(measurement: Measurement, seed: int, most: int = MOST_GEOMETRIES) -> Measurement:
    """The measurement, or of a larger one the rows that stand for it (measure.thinning).

    Rows that a fit can't use are not among them. seed: of the choice.
    """
    usable = np.flatnonzero(usable_rows(measurement))
    if len(usable) <= most:
        return measurement
    lamp, receiver = measurement.to_lamp[usable], measurement.to_receiver[usable]
    chosen, counts = thinned(lamp, receiver, measurement.group[usable], most, seed)
    rows = usable[chosen]
    return replace(
        measurement,
        to_lamp=measurement.to_lamp[rows],
        to_receiver=measurement.to_receiver[rows],
        radiance_factor=measurement.radiance_factor[rows],
        reasons=measurement.reasons[rows],
        group=measurement.group[rows],
        stands_for=counts,
    )


def words(measurement: Measurement) -> str:
    """'8000 of 300000 geometries' where a measurement is a part of a larger one, else ''."""
    return counted(measurement.stands_for)


def counted(counts: Array | None) -> str:
    """The same of how many geometries each of a part stands for; None: it is no part."""
    return "" if counts is None else f"{len(counts)} of {int(np.sum(counts))} geometries"
