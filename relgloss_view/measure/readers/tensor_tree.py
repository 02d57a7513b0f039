"""Tensor trees: a function on a cube of 3 or 4 dimensions, in cells that are halved where needed.

The text of a tree nests braces: `{` 2^rank trees `}`, or `{` a grid of 2^(rank k) numbers `}`. Bit
d of a child's place chooses the upper half of dimension d; in a grid the last dimension varies
fastest. Children follow one another as their places count, so the leaves of a text lie in the order
of their Morton codes, and levels and values are all that a tree holds.

Source: Ward, Radiance's bsdf_t.c (`load_tree_data`, `SDlookupTre`).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable

#: Halvings of a side: a smallest cell of 1/65536 is finer than any instrument. Of four dimensions
#: fewer, so that a Morton code fits 63 bits.
DEEPEST = {3: 16, 4: 15}
MOST_LEAVES = 4_000_000
LARGEST = 1e9  #: 1/sr
_TOKENS = re.compile(r"[{}]|[^{}]+")


@dataclass(frozen=True)
class Tree:
    """levels: (L,), how often each leaf's cell is halved; values: (L,); both in Morton order."""

    rank: int
    levels: Ints
    values: Array

    @cached_property
    def starts(self) -> Ints:
        """(L,), the Morton code at the finest level where each leaf begins."""
        spans = np.left_shift(1, self.rank * (DEEPEST[self.rank] - self.levels))
        return np.asarray(np.concatenate([[0], np.cumsum(spans)[:-1]]))

    @property
    def smallest(self) -> float:
        """Side of the smallest cell; the cube's is 1."""
        return float(0.5 ** int(self.levels.max(initial=0)))

    def at(self, places: Array) -> Array:
        """Values (M,) at places (M, rank), 0 to below 1, without interpolation."""
        return np.asarray(self.values[self.leaf_at(places)])

    def leaf_at(self, places: Array) -> Ints:
        """The leaf (M,) that holds each place."""
        deepest = DEEPEST[self.rank]
        steps = np.clip((places * 2**deepest).astype(np.int64), 0, 2**deepest - 1)
        codes = np.zeros(len(places), dtype=np.int64)
        for d in range(self.rank):
            for bit in range(deepest):
                codes |= ((steps[:, d] >> bit) & 1) << (self.rank * bit + d)
        return np.asarray(np.searchsorted(self.starts, codes, side="right") - 1)

    def middles(self, leaves: Ints) -> Array:
        """(M, rank), the middles of leaves (M,)."""
        deepest = DEEPEST[self.rank]
        codes, corners = self.starts[leaves], np.zeros((len(leaves), self.rank))
        for d in range(self.rank):
            for bit in range(deepest):
                corners[:, d] += ((codes >> (self.rank * bit + d)) & 1) * 2.0 ** (bit - deepest)
        return corners + 0.5 * 0.5 ** self.levels[leaves][:, None]

    def text(self, digits: int = 4) -> str:
        """The tree as files hold it. Eight leaves of one parent share their braces."""
        children = 1 << self.rank
        parts: list[str] = []
        words = [f"{value:.{digits}g}" for value in self.values.tolist()]
        order = _grid_order(self.rank, 1)

        def put(level: int, leaf: int) -> int:
            own = int(self.levels[leaf])
            if own == level:
                parts.append("{" + words[leaf] + "}")
                return leaf + 1
            below = self.levels[leaf : leaf + children]
            if own == level + 1 and len(below) == children and np.all(below == level + 1):
                grid = (words[leaf + k] for k in order)
                parts.append("{" + " ".join(grid) + "}\n")
                return leaf + children
            parts.append("{")
            for _ in range(children):
                leaf = put(level + 1, leaf)
            parts.append("}\n")
            return leaf

        put(0, 0)
        return "".join(parts)


@lru_cache(maxsize=32)
def _grid_order(rank: int, halvings: int) -> list[int]:
    """The Morton place of each value of a grid, whose last dimension varies fastest."""
    side = 2**halvings
    steps = np.indices((side,) * rank).reshape(rank, -1)
    codes = np.zeros(side**rank, dtype=np.int64)
    for d in range(rank):
        for bit in range(halvings):
            codes |= ((steps[d] >> bit) & 1) << (rank * bit + d)
    return [int(code) for code in codes]


def read_tree(text: str, rank: int, where: str) -> Tree:
    """The tree of a text. Raises InputError, which begins with `where`.

    Values below zero are zero, as Radiance takes them.
    """
    children = 2**rank
    open_children: list[int] = []  #: trees that each open brace holds so far
    levels: list[Ints] = []
    values: list[Array] = []
    count = 0
    ended = False
    for token in _tokens(text):
        if ended:
            raise InputError(f"{where}: {printable(token, 20)!r} after the end of the tensor tree")
        if token == "{":
            if open_children and open_children[-1] == children:
                raise InputError(f"{where}: a branch of the tensor tree has more than {children}")
            open_children.append(0)
            if len(open_children) > DEEPEST[rank] + 1:
                raise InputError(
                    f"{where}: the tensor tree is nested more than {DEEPEST[rank]} deep"
                )
            continue
        if not open_children:
            raise InputError(
                f"{where}: the tensor tree begins with {printable(token, 20)!r}; expected {{"
            )
        if token == "}":
            if open_children.pop() not in (children, -1):
                raise InputError(
                    f"{where}: a branch of the tensor tree has fewer than {children} parts"
                )
            if not open_children:
                ended = True
            elif open_children[-1] >= 0:
                open_children[-1] += 1
            continue
        if open_children[-1] != 0:
            raise InputError(f"{where}: numbers between branches of the tensor tree")
        grid = _numbers(token, where)
        halvings = (len(grid).bit_length() - 1) // rank
        level = len(open_children) - 1 + halvings
        if len(grid) != children**halvings:
            raise InputError(
                f"{where}: a grid of {len(grid)} numbers in the tensor tree; expected 1, "
                f"{children}, {children**2} or another power of {children}"
            )
        if level > DEEPEST[rank]:
            raise InputError(f"{where}: the tensor tree is nested more than {DEEPEST[rank]} deep")
        count += len(grid)
        if count > MOST_LEAVES:
            raise InputError(
                f"{where}: the tensor tree has more than {MOST_LEAVES} values; reduce it with "
                "rttree_reduce of Radiance"
            )
        sorted_grid = np.empty_like(grid)
        sorted_grid[_grid_order(rank, halvings)] = grid
        values.append(sorted_grid)
        levels.append(np.full(len(grid), level))
        open_children[-1] = -1
    if not ended:
        raise InputError(f"{where}: the tensor tree ends within a branch")
    return Tree(rank, np.concatenate(levels), np.maximum(np.concatenate(values), 0.0))


def _tokens(text: str) -> Iterator[str]:
    for match in _TOKENS.finditer(text):
        token = match[0]
        if token in "{}" or token.strip(" \t\r\n,"):
            yield token


def _numbers(token: str, where: str) -> Array:
    words = token.replace(",", " ").split()
    if len(words) > MOST_LEAVES:
        raise InputError(f"{where}: the tensor tree has more than {MOST_LEAVES} values")
    try:
        grid = np.array(words, dtype=np.float64)
    except ValueError:
        raise InputError(
            f"{where}: {printable(token.strip(), 30)!r} in the tensor tree; expected numbers"
        ) from None
    if not np.all(np.abs(grid) <= LARGEST):  # NaN too
        raise InputError(
            f"{where}: a value above {LARGEST:g} or no number in the tensor tree; correct it"
        )
    return grid


#: XYZ of the perfect diffuser in Radiance, whose RGB is white at equal energy (Ward, color.h).
RADIANCE_WHITE = np.ones(3)


def uv_of(xyz: Array) -> tuple[Array, Array]:
    """CIE 1976 u' and v', (M,) each, of XYZ (M, 3) (CIE 15:2004)."""
    below = xyz @ np.array([1.0, 15.0, 3.0])
    return np.asarray(4.0 * xyz[:, 0] / below), np.asarray(9.0 * xyz[:, 1] / below)


def xyz_of(y: Array, u: Array, v: Array) -> Array:
    """XYZ (M, 3) of luminance and CIE 1976 u', v', (M,) each; 0 where v' is 0.

    >>> xyz_of(np.array([0.5]), *uv_of(np.array([[0.3, 0.5, 0.2]]))).round(6).tolist()
    [[0.3, 0.5, 0.2]]
    """
    below = np.where(v > 0.0, 4.0 * v, np.inf)
    x, z = y * 9.0 * u / below, y * (12.0 - 3.0 * u - 20.0 * v) / below
    return np.stack([x, np.where(v > 0.0, y, 0.0), z], axis=-1)
