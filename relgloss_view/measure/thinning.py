"""A part of a large table that stands for the whole of it, chosen evenly over the angles.

The rows are put into strata by the half-vector's angle from the normal and by the angle at which a
facet is met (Rusinkiewicz 1998). Every stratum gives as many rows, and one that has fewer gives all
of them: so a highlight and grazing incidence, which few rows of a table show, are kept. Within a
stratum the rows are cut into runs of neighbours in plane and angle, and each run gives one row at
random. A row stands for as many as its run has. Sums over the chosen rows with these counts are
unbiased estimates of the sums over all rows (Horvitz and Thompson 1952).
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array, Ints

#: Edges of the strata, degrees: of the half-vector's angle, dense where narrow highlights change.
DELTA_DEG = (0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0)
INCIDENCE_DEG = tuple(range(10, 90, 10))  #: ... and of the angle at which a facet is met


def thinned(
    to_lamp: Array, to_receiver: Array, group: Ints, most: int, seed: int = 0
) -> tuple[Ints, Array]:
    """At most `most` of N rows, and how many each stands for: increasing (M,), (M,), sum N.

    to_lamp, to_receiver: (N, 3), unit vectors above the horizon. group: (N,), planes or settings of
    the lamp. most: at least the number of strata, 144. seed: of the choice within runs.

    >>> up = np.tile([0.0, 0.0, 1.0], (1000, 1))
    >>> rows, counts = thinned(up, up, np.zeros(1000, dtype=np.int64), 200)
    >>> len(rows), float(counts.sum())
    (200, 1000.0)
    """
    total = to_lamp + to_receiver
    delta = np.degrees(np.arctan2(np.hypot(total[:, 0], total[:, 1]), total[:, 2]))
    half = np.clip(0.5 * np.sqrt(np.einsum("nk,nk->n", total, total)), 0.0, 1.0)
    incidence = np.searchsorted(INCIDENCE_DEG, np.degrees(np.arccos(half)))
    stratum = np.searchsorted(DELTA_DEG, delta) * (len(INCIDENCE_DEG) + 1) + incidence
    order = np.lexsort((delta, group, stratum))
    sizes = np.bincount(stratum)
    sizes = sizes[sizes > 0]
    given = np.minimum(sizes, _quota(sizes, most))
    # Runs of about equal length: the k-th of m in n rows ends before row (k + 1) n / m.
    first = np.repeat(np.cumsum(given) - given, given)
    place = np.arange(int(given.sum())) - first
    length, parts = np.repeat(sizes, given), np.repeat(given, given)
    start, end = place * length // parts, (place + 1) * length // parts
    random = np.random.default_rng(seed).random(len(place))
    offset = np.repeat(np.cumsum(sizes) - sizes, given)
    rows = order[offset + start + (random * (end - start)).astype(np.int64)]
    increasing = np.argsort(rows)
    return rows[increasing], (end - start)[increasing].astype(np.float64)


def _quota(sizes: Ints, most: int) -> int:
    """The largest number that every stratum may give so that all give at most `most`."""
    low, high = 1, int(np.max(sizes))
    while low < high:
        middle = (low + high + 1) // 2
        if np.sum(np.minimum(sizes, middle)) <= most:
            low = middle
        else:
            high = middle - 1
    return low


def percentile(values: Array, percent: float, counts: Array | None = None) -> float:
    """A percentile of values (N,), each counted as often as it stands for others.

    counts: (N,), above zero; None where each stands for itself, as numpy.percentile has it.

    >>> percentile(np.array([1.0, 2.0, 9.0]), 50.0, np.array([1.0, 1.0, 8.0]))
    9.0
    """
    if counts is None:
        return float(np.median(values) if percent == 50.0 else np.percentile(values, percent))
    order = np.argsort(values, kind="stable")
    reached = np.cumsum(counts[order])
    place = np.searchsorted(reached, 0.01 * percent * reached[-1])
    return float(values[order[min(int(place), len(values) - 1)]])


def mean(values: Array, counts: Array | None = None) -> float:
    """The mean of values (N,), each counted as often as it stands for others."""
    return float(np.mean(values) if counts is None else np.average(values, weights=counts))
