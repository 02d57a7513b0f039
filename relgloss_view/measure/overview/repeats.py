"""Repeatability: how much readings of one geometry differ."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Ints

#: Components of unit vectors that differ by less are the same direction: 0.00006 degrees.
SAME = 1e-6
#: Relative differences below this are rounding: such rows are copies of one reading.
COPY = 1e-9


@dataclass(frozen=True)
class Repeats:
    """Geometries that a table holds more than once."""

    geometries: int  #: how many there are
    readings: int  #: how many rows they have together
    #: Repeatability standard deviation relative to the mean, pooled over all of them; None where
    #: no geometry is repeated.
    relative_sd: float | None
    largest: float | None  #: largest range of one geometry, relative to its mean
    rows: tuple[int, ...]  #: of that geometry, from 0
    copies: bool  #: whether all repeated rows are equal: they are copies, and no new readings


def repeats(to_lamp: Array, to_receiver: Array, level: Array, index: Ints) -> Repeats:
    """The repeated geometries among N readings.

    to_lamp, to_receiver: (N, 3), unit vectors. level: (N,), readings, above zero. index: (N,),
    their rows in the table.

    The standard deviation is that of ISO 5725-2:1994, 7.4: squared deviations from each geometry's
    mean, over the sum of n - 1; here relative to that mean, as an instrument's noise is.

    >>> up = np.tile([0.0, 0.0, 1.0], (2, 1))
    >>> round(repeats(up, up, np.array([0.99, 1.01]), np.arange(2)).relative_sd, 5)
    0.01414
    """
    used = level > 0.0
    index, level = index[used], level[used]
    keys = np.rint(np.hstack([to_lamp[used], to_receiver[used]]) / SAME).astype(np.int64)
    order = np.lexsort(keys.T)
    new = np.ones(len(order), dtype=bool)
    new[1:] = np.any(keys[order[1:]] != keys[order[:-1]], axis=1)
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.cumsum(new) - 1
    count = np.bincount(number)
    repeated = count > 1
    if not np.any(repeated):
        return Repeats(0, 0, None, None, (), False)
    mean = np.bincount(number, level) / count
    relative = level / mean[number] - 1.0
    squares = np.bincount(number, np.square(relative))
    low, high = np.full(len(count), np.inf), np.full(len(count), -np.inf)
    np.minimum.at(low, number, relative)
    np.maximum.at(high, number, relative)
    spread = np.where(repeated, high - low, 0.0)
    widest = int(np.argmax(spread))
    return Repeats(
        geometries=int(np.sum(repeated)),
        readings=int(np.sum(count[repeated])),
        relative_sd=float(np.sqrt(np.sum(squares[repeated]) / np.sum(count[repeated] - 1))),
        largest=float(spread[widest]),
        rows=tuple(int(row) for row in index[number == widest]),
        copies=bool(spread[widest] < COPY),
    )
