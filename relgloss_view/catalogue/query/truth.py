"""Which rows meet a condition, with missing values as a third answer (Kleene's strong logic).

1 is met, 0 is not met, 0.5 is unknown because a value is missing. And is the smallest of its parts,
or the largest, not 1 - x; a row is a hit at 1 alone. So a missing value meets neither a condition
nor its opposite, and whoever asks can be warned of the rows in between.
Source: Kleene 1952, Introduction to Metamathematics, section 64.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.catalogue.query import terms
from relgloss_view.catalogue.query.terms import Condition, Leaf, Wish, is_wish, only_ranks
from relgloss_view.catalogue.query.values import Values, plain

UNKNOWN = 0.5
#: Distance (N,) of each row from a wish; NaN where a value is missing.
Distance = Callable[[Wish], Array]
#: Ratio of gloss (N,) of each row to a reference.
Ratio = Callable[[terms.GlossRatio], Array]


def truth(condition: Condition | None, values: Values, distance: Distance, ratio: Ratio) -> Array:
    """1, 0 or 0.5 (N,) by row."""
    if condition is None:
        return np.ones(len(values))
    if isinstance(condition, terms.Not):
        return 1.0 - truth(condition.part, values, distance, ratio)
    if isinstance(condition, terms.All):
        parts = [truth(part, values, distance, ratio) for part in condition.parts]
        return np.asarray(np.minimum.reduce(parts))
    if isinstance(condition, terms.Any):
        parts = [truth(part, values, distance, ratio) for part in condition.parts]
        return np.asarray(np.maximum.reduce(parts))
    return _of_leaf(condition, values, distance, ratio)


def _of_leaf(leaf: Leaf, values: Values, distance: Distance, ratio: Ratio) -> Array:
    if is_wish(leaf):
        distances = distance(leaf)  # type: ignore[arg-type]
        if only_ranks(leaf):
            return np.where(np.isnan(distances), UNKNOWN, 1.0)
        return _at_most(distances, tolerance_of(leaf))
    if isinstance(leaf, terms.Range):
        return _within(values.numbers(leaf.column), leaf)
    if isinstance(leaf, terms.GlossRatio):
        return _within(ratio(leaf), leaf)
    if isinstance(leaf, terms.Flag):
        numbers = values.numbers(leaf.column)
        met = (numbers > 0.0) == leaf.wanted
        return np.asarray(np.where(np.isnan(numbers), UNKNOWN, met), dtype=np.float64)
    if isinstance(leaf, terms.Present):
        return np.asarray(present(leaf.column, values) == leaf.wanted, dtype=np.float64)
    assert isinstance(leaf, terms.TextTest)
    wanted = plain(leaf.text)
    test = _TESTS[leaf.how]
    texts = values.texts(leaf.column)
    return np.array([UNKNOWN if t is None else float(test(t, wanted)) for t in texts])


def present(column: str, values: Values) -> Mask:
    """Whether each row has a value (N,)."""
    return np.array([row.get(column) not in (None, "") for row in values.rows], dtype=bool)


def tolerance_of(leaf: Condition) -> float:
    """The tolerance of a wish, in the unit of its distance."""
    tolerance = getattr(leaf, "tolerance", None)
    return np.inf if tolerance is None else float(tolerance)


def _within(numbers: Array, limits: terms.Range | terms.GlossRatio) -> Array:
    with np.errstate(invalid="ignore"):
        above = numbers >= limits.low if limits.with_low else numbers > limits.low
        below = numbers <= limits.high if limits.with_high else numbers < limits.high
    return np.where(np.isnan(numbers), UNKNOWN, above & below)


def _at_most(distances: Array, tolerance: float) -> Array:
    # Decimal numbers such as 45 +- 0.1 miss their binary neighbours by some 1e-14.
    with np.errstate(invalid="ignore"):
        met = distances <= tolerance * (1.0 + 1e-12) + 1e-12
    return np.where(np.isnan(distances), UNKNOWN, met)


def _in_folder(path: str, folder: str) -> bool:
    folder = folder.removeprefix("./").strip("/")
    return not folder or path.startswith(folder + "/")


_TESTS: dict[str, Callable[[str, str], bool]] = {
    terms.IS: lambda text, wanted: text == wanted,
    terms.CONTAINS: lambda text, wanted: wanted in text,
    terms.STARTS: lambda text, wanted: text.startswith(wanted),
    terms.ENDS: lambda text, wanted: text.endswith(wanted),
    terms.WITHIN: _in_folder,
}
