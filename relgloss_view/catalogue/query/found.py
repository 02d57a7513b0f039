"""Found: the rows that a query has found, ranked, with the numbers that ranked them.

The search, the window and the page share it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from relgloss_view.catalogue.query.terms import Query

if TYPE_CHECKING:
    from relgloss_view.catalogue.query.references import Resolved
    from relgloss_view.catalogue.recipe import Recipe
    from relgloss_view.material.material import Material


class Searched(Protocol):
    """What a search needs of a catalogue; catalogue/catalogue.py has it."""

    @property
    def folder(self) -> Path:
        """The folder of the catalogue."""
        ...

    @property
    def recipe(self) -> Recipe:
        """How its items were metered, matched and drawn."""
        ...

    @property
    def rows(self) -> Sequence[Mapping[str, Any]]:
        """A row a file: every column but the thumbnail, sorted by path."""
        ...

    def thumbnails(self, paths: Iterable[str]) -> Mapping[str, bytes]:
        """Pictures (PNG) by path; an item without one is not in it."""
        ...

    def material(self, path: str) -> Material:
        """The material of an item."""
        ...


@dataclass(frozen=True)
class Measure:
    """A number that a query computes of each hit: its key in Hit.numbers, its heading, digits."""

    key: str
    label: str
    decimals: int
    unit: str = ""


@dataclass(frozen=True)
class Hit:
    """A row that a query has found: its rank from 1; numbers by Measure.key, those with a value."""

    row: Mapping[str, Any]
    rank: int
    numbers: Mapping[str, float] = field(default_factory=dict)

    @property
    def path(self) -> str:
        """The file, from the top of the tree."""
        return str(self.row["path"])

    @property
    def name(self) -> str:
        """The sample's name, or its file's where it has none."""
        return str(self.row.get("name") or self.path.rpartition("/")[2])


@dataclass(frozen=True)
class Found:
    """Hits in their order, and what a reader has to know about them.

    total: rows that meet the query; hits may be fewer. searched: rows of the catalogue. left_out:
    rows that are neither hits nor refused, because a value is missing; missing: how many of them
    lack each column. columns: names that the query uses, beside path and name. references: what
    each name in the query stands for. notes: sentences for people. is_exact: pictures were redrawn
    exactly, where the query compares pictures.
    """

    query: Query
    hits: tuple[Hit, ...]
    total: int
    searched: int
    left_out: int = 0
    missing: Mapping[str, int] = field(default_factory=dict)
    columns: tuple[str, ...] = ()
    measures: tuple[Measure, ...] = ()
    order: str = "by file"
    references: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    is_exact: bool = True
    #: The sample that the query's first ratio, colour or picture compares with.
    reference: Resolved | None = None

    def as_json(self) -> dict[str, Any]:
        """The result as `--json` prints it."""
        return {
            "query": self.query.text,
            "total": self.total,
            "searched": self.searched,
            "left_out": self.left_out,
            "missing": dict(self.missing),
            "order": self.order,
            "references": dict(self.references),
            "notes": list(self.notes),
            "is_exact": self.is_exact,
            "hits": [
                {"rank": hit.rank, **_plain(hit.row), "numbers": dict(hit.numbers)}
                for hit in self.hits
            ],
        }


def _plain(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row without its picture; a number that JSON can't hold is null."""
    return {
        key: None if isinstance(value, float) and not math.isfinite(value) else value
        for key, value in row.items()
        if not isinstance(value, bytes)
    }
