"""Tables under each other in one file: parts of one scan, or readings of another sample."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.base.errors import InputError

#: Readings of one sample repeat within this share; where more than half of those that a second
#: table repeats are farther off, it is of another sample.
SAME_WITHIN = 0.1
FEWEST_REPEATED = 5
MOST_ROWS = 200_000  #: that are compared


def refuse_contradiction(
    path: Path, repeated: Sequence[int], lines: Ints, angles: Array, readings: Array
) -> None:
    """InputError where rows below a repeated header contradict those of their geometries above.

    repeated: lines of the header's repetitions. lines: (N,), of each row. angles: (N, A).
    readings: (N, B), NaN where empty.
    """
    if not len(repeated) or len(lines) > MOST_ROWS:
        return
    block = np.searchsorted(np.asarray(repeated), lines)
    _, geometry = np.unique(angles, axis=0, return_inverse=True)
    geometry = geometry.reshape(-1)
    # The first row of a geometry and the first one of it in a later block.
    _, first = np.unique(geometry, return_index=True)
    pairs = np.unique(np.column_stack([geometry, block]), axis=0, return_index=True)[1]
    later = pairs[block[pairs] > block[first[geometry[pairs]]]]
    if len(later) < FEWEST_REPEATED:
        return
    above = readings[first[geometry[later]]]
    below = readings[later]
    with np.errstate(invalid="ignore"):
        size = np.nanmax(np.maximum(np.abs(above), np.abs(below)), axis=1, initial=0.0)
        off = np.nanmax(np.abs(above - below), axis=1, initial=0.0)
    far = off > SAME_WITHIN * size
    if np.mean(far) > 0.5:
        begins = repeated[int(block[later[int(np.argmax(far))]]) - 1]
        raise InputError(
            f"{path}: line {begins}: another table begins, and its readings contradict those above "
            "in the same geometries; save each table as a file of its own"
        )
