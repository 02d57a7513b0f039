"""Scale values by the method of successive categories, least squares.

Torgerson, Theory and Methods of Scaling (1958), chapter 10: the law of categorical judgment in
condition D, where stimuli and category bounds share one dispersion. The oldest estimate and the
simplest; ordinal.py has the one by maximum likelihood.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.base.errors import InputError

Zero = Literal["clip", "drop"]

#: Bounds out of order by less than this, in dispersions, are rounding.
ORDER_TOLERANCE = 1e-9


@dataclass(frozen=True)
class SuccessiveScale:
    """Where stimuli and category bounds lie, in units of the discriminal dispersion.

    The distance of stimulus j is -scale[j], and P(category <= k) = Phi(bounds[k] + scale[j]).
    """

    scale: Array  #: (J,), closeness: larger is closer, mean 0; NaN where a stimulus has no place
    bounds: Array  #: (K-1,), along distance, never decreasing; NaN beyond the end categories in use


def successive_categories(counts: ArrayLike, zero: Zero = "clip") -> SuccessiveScale:
    """The least-squares scale of counts (J stimuli, K categories), category 0 the closest.

    Minimises the sum of (bounds[k] + scale[j] - z[j,k])^2, z the normal deviate of the share of
    answers up to category k. Shares of 0 and 1 have none: 'clip' takes them for 1/(2N) and
    1 - 1/(2N), N the answers of the stimulus, which draws the ends in; 'drop' leaves them out
    and gives NaN to stimuli and bounds that nothing then joins to the most. One answer a
    stimulus, clipped, tells nothing: all is 0.

    A category that nobody used is merged with its neighbour: its two bounds are one, and the one
    that would set apart an end category is NaN. A stimulus without answers is NaN. InputError
    where the counts are not counts or nothing can be scaled.
    """
    table = checked_counts(counts, 2)
    one = _successive(table[None], zero)
    if not np.any(np.isfinite(one.bounds)):
        raise InputError(
            "no share of answers lies between 0 and 1; nothing can be scaled unless zero is 'clip'"
        )
    return SuccessiveScale(one.scale[0], one.bounds[0])


def checked_counts(counts: ArrayLike, dimensions: int) -> Array:
    """Counts as floats, with `dimensions` axes, the last one categories.

    InputError where they are not finite, negative, absent, or all in one category, which places
    nothing.
    """
    table = np.asarray(counts, dtype=np.float64)
    if table.ndim != dimensions or table.shape[-1] < 2:
        raise ValueError(f"counts of shape {table.shape}: {dimensions} axes, at least 2 categories")
    if not np.all(np.isfinite(table)) or np.any(table < 0.0):
        raise InputError("counts of answers must be finite and not negative")
    in_use = int(np.sum(used_categories(table.reshape(-1, table.shape[-1]))))
    if not in_use:
        raise InputError("there are no answers to scale")
    if in_use == 1:
        raise InputError("all answers lie in one category; nothing can be scaled")
    return table


def used_categories(counts: Array) -> Mask:
    """Which categories of counts (..., cells, K) hold an answer, (..., K)."""
    return np.asarray(np.any(counts > 0.0, axis=-2))


def counted_bounds(used: Mask) -> Mask:
    """Which bounds stand when unused categories are merged with their neighbours, (..., K-1).

    One between each used category and the next used one: that at the upper end of the former.
    """
    return np.asarray(used[..., :-1] & _any_above(used))


def spread_bounds(bounds: Array, used: Mask) -> Array:
    """All bounds (..., K-1) from those that `counted_bounds` tells.

    The others repeat the one below; where no used category lies below or above, they are NaN.
    """
    number = np.arange(bounds.shape[-1])
    source = np.maximum.accumulate(np.where(used[..., :-1], number, -1), axis=-1)
    repeated = np.take_along_axis(bounds, np.maximum(source, 0), axis=-1)
    return np.where((source >= 0) & _any_above(used), repeated, np.nan)


def _any_above(used: Mask) -> Mask:
    """Whether a category above each bound is in use, (..., K-1)."""
    return np.asarray(np.logical_or.accumulate(used[..., ::-1], axis=-1)[..., ::-1][..., 1:])


def _successive(counts: Array, zero: Zero) -> SuccessiveScale:
    """Scales of a batch (B, J, K)."""
    from scipy.special import ndtri

    used = used_categories(counts)
    counted = counted_bounds(used)
    cumulative = np.cumsum(counts, axis=-1)
    total = cumulative[..., -1]
    answered = total > 0.0
    number = np.where(answered, total, 1.0)
    # Of weights, fewer than one answer may be left; one half is then as far as clipping goes.
    least = np.minimum(0.5 / number, 0.5)[..., None]
    shares = cumulative[..., :-1] / number[..., None]
    if zero == "clip":
        deviates = ndtri(np.clip(shares, least, 1.0 - least))
        scale, bounds = _complete(deviates, answered, counted)
    elif zero == "drop":
        there = (shares > 0.0) & (shares < 1.0) & counted[:, None, :]
        deviates = ndtri(np.where(there, shares, 0.5))
        each = [_incomplete(z, cells) for z, cells in zip(deviates, there, strict=True)]
        scale = np.stack([one[0] for one in each])
        bounds = np.stack([one[1] for one in each])
    else:
        raise ValueError(f"zero is 'clip' or 'drop', not {zero!r}")
    return SuccessiveScale(scale, spread_bounds(bounds, used))


def _complete(deviates: Array, answered: Mask, counted: Mask) -> tuple[Array, Array]:
    """Scale and bounds of a batch of which each answered stimulus has each counted deviate.

    Least squares has a closed form then: means over rows and columns.
    """
    stimuli = np.maximum(np.sum(answered, axis=-1), 1)[:, None]
    bounds = np.sum(np.where(answered[..., None], deviates, 0.0), axis=-2) / stimuli
    columns = np.sum(counted, axis=-1)[:, None]
    above = np.where(counted[:, None, :], deviates - bounds[:, None, :], 0.0)
    scale = np.sum(above, axis=-1) / np.maximum(columns, 1)
    placed = answered & (columns > 0)
    return np.where(placed, scale, np.nan), np.where(counted, bounds, np.nan)


def _incomplete(deviates: Array, there: Mask) -> tuple[Array, Array]:
    """Scale (J,) and bounds (K-1,) from those deviates (J, K-1) that are there; the rest NaN."""
    scale = np.full(there.shape[0], np.nan)
    bounds = np.full(there.shape[1], np.nan)
    rows, columns = _largest_joined(there)
    if not rows.any():
        return scale, bounds
    cells = there & rows[:, None]
    j, k = np.nonzero(cells)
    j_of = np.cumsum(rows) - 1
    k_of = np.cumsum(columns) - 1
    values, limits = _least_squares(j_of[j], k_of[k], deviates[cells])
    scale[rows], bounds[columns] = values, limits
    return scale, bounds


def _largest_joined(there: Mask) -> tuple[Mask, Mask]:
    """The stimuli and bounds of the largest set that cells join; of equals, the first.

    Two sets without a common stimulus or bound have no place relative to each other.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    stimuli, bounds = there.shape
    links = np.zeros((stimuli + bounds, stimuli + bounds))
    links[:stimuli, stimuli:] = there
    _, label = connected_components(csr_array(links), directed=False)
    cells = np.bincount(label[:stimuli], weights=np.sum(there, axis=1), minlength=int(label.max()))
    largest = label == np.argmax(cells)
    if not np.max(cells):
        largest[:] = False
    return largest[:stimuli], largest[stimuli:]


def _least_squares(j: Ints, k: Ints, deviates: Array) -> tuple[Array, Array]:
    """Scale (mean 0) and bounds, in order, nearest to deviates at cells (j, k) that all join."""
    from scipy.optimize import lsq_linear

    stimuli, bounds = int(j.max()) + 1, int(k.max()) + 1
    cell = np.arange(deviates.size)
    design = np.zeros((deviates.size, stimuli + bounds))
    design[cell, j] = 1.0
    design[cell, stimuli + k] = 1.0
    solution = np.linalg.lstsq(design, deviates, rcond=None)[0]
    limits = solution[stimuli:]
    if np.any(np.diff(limits) < -ORDER_TOLERANCE):
        # With cells missing the optimum may turn bounds round. As sums of steps that are not
        # negative they are the nearest ones in order.
        steps = np.tri(bounds)
        design[:, stimuli:] = design[:, stimuli:] @ steps
        lower = np.full(stimuli + bounds, -np.inf)
        lower[stimuli + 1 :] = 0.0
        solution = lsq_linear(design, deviates, bounds=(lower, np.inf), method="bvls").x
        limits = steps @ solution[stimuli:]
    scale = solution[:stimuli]
    middle = np.mean(scale)
    return scale - middle, np.maximum.accumulate(limits) + middle
