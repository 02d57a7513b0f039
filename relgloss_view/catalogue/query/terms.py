"""What a query holds after it was read: conditions, wishes, order and number of hits.

A condition decides which rows are hits. A wish has a distance: the smaller, the better the hit.
`span` is the place in the text, for faults that only the catalogue shows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

Span = tuple[int, int]
#: How a text may be compared.
IS, CONTAINS, STARTS, ENDS, WITHIN = "is", "contains", "starts with", "ends with", "in"


def _span() -> Span:
    return (0, 0)


@dataclass(frozen=True)
class Range:
    """A number between two limits, each of which may belong to it."""

    column: str
    low: float = -math.inf
    high: float = math.inf
    with_low: bool = True
    with_high: bool = True


@dataclass(frozen=True)
class Near:
    """A number near a target; without a tolerance it only ranks."""

    column: str
    target: float
    tolerance: float | None = None


@dataclass(frozen=True)
class TextTest:
    """A text compared by IS, CONTAINS, STARTS, ENDS or WITHIN; upper and lower case are equal."""

    column: str
    how: str
    text: str


@dataclass(frozen=True)
class Present:
    """Whether there is a value."""

    column: str
    wanted: bool


@dataclass(frozen=True)
class Flag:
    """A yes or no."""

    column: str
    wanted: bool


@dataclass(frozen=True)
class ReferenceName:
    """Another sample by its name: an item, a built-in paper or a material file."""

    text: str
    span: Span = field(default_factory=_span, compare=False)


@dataclass(frozen=True)
class ColourNear:
    """A colour near another, by CIEDE2000 or CIE 1976; without a tolerance it only ranks."""

    target: tuple[float, float, float] | ReferenceName
    tolerance: float | None = None
    formula: str = "2000"  #: or "76"


@dataclass(frozen=True)
class GlossRatio:
    """The gloss over that of a reference: near `wanted`, or between two limits.

    tolerance: a share of `wanted`; None only ranks. column: of the reading; None is the measure
    whose ratio the catalogue keeps.
    """

    reference: ReferenceName
    wanted: float | None = None
    tolerance: float | None = None
    low: float = 0.0
    high: float = math.inf
    with_low: bool = True
    with_high: bool = True
    column: str | None = None


@dataclass(frozen=True)
class Nearest:
    """The picture near that of a reference; it only ranks."""

    reference: ReferenceName


@dataclass(frozen=True)
class Not:
    """The opposite; a missing value meets neither."""

    part: Condition


@dataclass(frozen=True)
class All:
    """Every part."""

    parts: tuple[Condition, ...]


@dataclass(frozen=True)
class Any:
    """At least one part."""

    parts: tuple[Condition, ...]


Wish = Near | ColourNear | GlossRatio | Nearest
Leaf = Range | Near | TextTest | Present | Flag | ColourNear | GlossRatio | Nearest
Condition = Leaf | Not | All | Any

CLOSENESS = "closeness"  #: an order by the query's first wish


@dataclass(frozen=True)
class Order:
    """One column of `sort by`, or CLOSENESS."""

    column: str
    descending: bool = False


@dataclass(frozen=True)
class Query:
    """A query: condition None is met by every row; first: at most so many hits, None all."""

    text: str
    condition: Condition | None = None
    order: tuple[Order, ...] = ()
    first: int | None = None

    @property
    def wishes(self) -> tuple[Wish, ...]:
        """The wishes that can rank hits, in their order in the text."""
        return tuple(one for one in ranking(self.condition) if is_wish(one))

    @property
    def leaves(self) -> tuple[Leaf, ...]:
        """All its conditions without and, or, not."""
        return tuple(_leaves(self.condition))


def is_wish(leaf: Condition) -> bool:
    """Whether a condition has a distance by which hits are ranked."""
    if isinstance(leaf, GlossRatio):
        return leaf.wanted is not None
    return isinstance(leaf, Near | ColourNear | Nearest)


def only_ranks(leaf: Condition) -> bool:
    """Whether a wish has no tolerance, so that it leaves nothing out."""
    if isinstance(leaf, Nearest):
        return True
    return is_wish(leaf) and getattr(leaf, "tolerance", None) is None


def ranking(condition: Condition | None) -> list[Wish]:
    """Wishes that every hit meets: those that neither `or` nor `not` weakens."""
    if isinstance(condition, All):
        return [wish for part in condition.parts for wish in ranking(part)]
    if condition is not None and is_wish(condition):
        return [condition]  # type: ignore[list-item]
    return []


def _leaves(condition: Condition | None) -> list[Leaf]:
    if condition is None:
        return []
    if isinstance(condition, Not):
        return _leaves(condition.part)
    if isinstance(condition, All | Any):
        return [leaf for part in condition.parts for leaf in _leaves(part)]
    return [condition]
