"""How far observers agree, who answers at random, and whether any stimulus differs at all.

Answers come as a table (observers, stimuli), or as equally long arrays of observer, stimulus and
category, one answer each, in any design. Permutation tests are exact: their p is at most a with
probability at most a where the hypothesis holds, whatever the number of permutations.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from relgloss_view.base.arrays import Array, Ints

Level = Literal["nominal", "ordinal", "interval"]

PERMUTATIONS = 999
FEWEST_ANSWERS = 3  #: of which a rank correlation tells anything
TIE = 1e-9  #: sums of squares that differ by this share are equal but for rounding


@dataclass(frozen=True)
class Relation:
    """How an observer's answers follow those of all the others.

    None where nothing can be told: one observer, fewer than 3 answers to stimuli that others
    judged, or always the same answer.
    """

    observer: int
    correlation: float | None  #: Spearman's, -1..1
    p: float | None  #: of a correlation at least as large from answers at random, 0..1


def krippendorff_alpha(ratings: ArrayLike, level: Level = "ordinal") -> float | None:
    """Krippendorff's alpha of ratings (observers, units), NaN where there is none.

    1 is perfect agreement, 0 what chance gives; it may be negative. None where no unit has two
    ratings or all of those are alike. Krippendorff, Computing Krippendorff's Alpha-Reliability
    (2011).
    """
    table = _table(ratings)
    there = np.isfinite(table)
    paired = np.sum(there, axis=0) >= 2
    there &= paired
    values, number = np.unique(table[there], return_inverse=True)
    if values.size < 2:
        return None
    held = np.zeros((table.shape[1], values.size))  # how often each unit got each value
    np.add.at(held, (np.nonzero(there)[1], number), 1.0)
    held = held[paired]
    weight = 1.0 / (held.sum(axis=1) - 1.0)
    coincidences = held.T @ (weight[:, None] * held) - np.diag(weight @ held)
    total = coincidences.sum(axis=0)
    if level == "nominal":
        difference = 1.0 - np.eye(values.size)
    elif level in ("ordinal", "interval"):
        # The ordinal difference, the values between two and half of either, is that of mid-ranks.
        place = np.cumsum(total) - 0.5 * total if level == "ordinal" else values
        difference = np.square(place[:, None] - place)
    else:
        raise ValueError(f"the level is 'nominal', 'ordinal' or 'interval', not {level!r}")
    observed = np.sum(coincidences * difference)
    expected = total @ difference @ total / (np.sum(total) - 1.0)
    return float(1.0 - observed / expected)


def kendall_w(ratings: ArrayLike) -> float | None:
    """Kendall's coefficient of concordance W of ratings (observers, stimuli), corrected for ties.

    0 is no agreement in rank, 1 the same order by all. Stimuli that not every observer rated (NaN)
    are left out, as ranks need a complete table. None for fewer than two observers or stimuli, or
    where each observer always gave the same answer. Kendall and Babington Smith, The problem of m
    rankings (1939).
    """
    table = _table(ratings)
    table = table[:, np.all(np.isfinite(table), axis=0)]
    observers, stimuli = table.shape
    if observers < 2 or stimuli < 2:
        return None
    # Over all ranks: the observers' own sums of squares are what full agreement would reach; ties
    # lower them, which is the usual correction.
    ranks = _mid_ranks(table) - 0.5 * (stimuli + 1)
    most = observers * np.sum(np.square(ranks))
    return float(np.sum(np.square(ranks.sum(axis=0))) / most) if most else None


def relation_to_others(
    observer: ArrayLike,
    stimulus: ArrayLike,
    category: ArrayLike,
    seed: int,
    permutations: int = PERMUTATIONS,
) -> list[Relation]:
    """Spearman's correlation of each observer's answers with the means of all others' answers.

    Ascending by observer. Each answer is paired with the mean answer of the others to the same
    stimulus. p is one-sided, from permutations of the observer's answers: large where an observer
    answers at random, or against the others. It depends on nothing but the answers, whatever
    their order, and the seed. Observers and the seed are not negative.
    """
    who, what, answer = _answers(observer, stimulus, category)
    relations = []
    for number, mine in _by_observer(who):
        size = int(what.max()) + 1
        all_sum, all_count = _sums(what, answer, size)
        my_sum, my_count = _sums(what[mine], answer[mine], size)
        count = all_count - my_count
        mean = (all_sum - my_sum) / np.maximum(count, 1.0)
        mine = mine[count[what[mine]] > 0.0]
        # Twice a mid-rank is a whole number, so that sums of products are exact and ties are ties.
        # Means that are equal fractions may differ in the last bit.
        own = 2.0 * _mid_ranks(answer[mine])
        others = 2.0 * _mid_ranks(np.round(mean[what[mine]], 9))
        spread = np.var(own) * np.var(others) if mine.size >= FEWEST_ANSWERS else 0.0
        if not spread:
            relations.append(Relation(number, None, None))
            continue
        covariance = np.mean(own * others) - np.mean(own) * np.mean(others)
        generator = np.random.default_rng([seed, number])
        shuffled = generator.permuted(np.tile(own, (permutations, 1)), axis=1)
        as_large = np.sum(shuffled @ others >= own @ others)
        p = (1.0 + float(as_large)) / (1.0 + permutations)
        relations.append(Relation(number, float(covariance / np.sqrt(spread)), p))
    return relations


def no_difference_p(
    observer: ArrayLike,
    stimulus: ArrayLike,
    category: ArrayLike,
    seed: int,
    permutations: int = PERMUTATIONS,
) -> float:
    """The probability of answers that differ as much between stimuli where no stimulus differs.

    The statistic is the sum of squares between stimuli of mid-ranks within each observer, as
    shares of the observer's answers and centred; each observer's answers are permuted over what
    the observer saw. With one answer to each stimulus by each observer this is Friedman's test
    (1937) with its exact law. At least 1/(permutations + 1); 1 where nothing can differ.
    """
    who, what, answer = _answers(observer, stimulus, category)
    if not who.size:
        return 1.0
    size = int(what.max()) + 1
    generator = np.random.default_rng(seed)
    sums = np.zeros((1 + permutations, size))  # the first row is what was answered
    for _, mine in _by_observer(who):
        ranks = (_mid_ranks(answer[mine]) - 0.5 * (mine.size + 1)) / mine.size
        rows = np.tile(ranks, (1 + permutations, 1))
        rows[1:] = generator.permuted(rows[1:], axis=1)
        sums += rows @ np.eye(size)[what[mine]]
    between = np.square(sums) @ (1.0 / np.bincount(what))
    as_large = np.sum(between[1:] >= between[0] - TIE * np.max(between))
    return float((1.0 + as_large) / (1.0 + permutations))


def _mid_ranks(values: Array) -> Array:
    """Ranks from 1 along the last axis; equal values share the mean of their ranks."""
    if values.ndim > 1:
        return np.array([_mid_ranks(row) for row in values])
    _, place, often = np.unique(values, return_inverse=True, return_counts=True)
    return np.asarray((np.cumsum(often) - 0.5 * (often - 1.0))[place])


def _table(ratings: ArrayLike) -> Array:
    table = np.asarray(ratings, dtype=np.float64)
    if table.ndim != 2:
        raise ValueError(f"ratings of shape {table.shape}: observers by stimuli")
    return table


def _answers(
    observer: ArrayLike, stimulus: ArrayLike, category: ArrayLike
) -> tuple[Ints, Ints, Array]:
    """The three arrays, of one length; stimuli numbered anew, without gaps.

    Sorted, so that permutations do not depend on the order in which answers were given.
    """
    who = np.asarray(observer, dtype=np.int64)
    what = np.asarray(stimulus, dtype=np.int64)
    answer = np.asarray(category, dtype=np.float64)
    if who.ndim != 1 or who.shape != what.shape or who.shape != answer.shape:
        raise ValueError(f"answers of shapes {who.shape}, {what.shape} and {answer.shape}")
    order = np.lexsort((answer, what, who))
    return who[order], np.unique(what, return_inverse=True)[1][order], answer[order]


def _by_observer(who: Ints) -> Iterator[tuple[int, NDArray[np.intp]]]:
    """Each observer and where that observer's answers stand."""
    for number in np.unique(who):
        yield int(number), np.nonzero(who == number)[0]


def _sums(what: Ints, answer: Array, size: int) -> tuple[Array, Array]:
    """Sum and number of answers to each stimulus."""
    total = np.asarray(np.bincount(what, weights=answer, minlength=size), dtype=np.float64)
    return total, np.asarray(np.bincount(what, minlength=size), dtype=np.float64)
