"""Search a catalogue: the rows that meet a query, ranked."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.catalogue.columns import BY_NAME, LAB, NUMBER, READINGS, TEXT
from relgloss_view.catalogue.query import terms
from relgloss_view.catalogue.query.fault import QueryError
from relgloss_view.catalogue.query.found import Found, Hit, Measure, Searched
from relgloss_view.catalogue.query.nearest import (
    EXACT_MOST,
    MEASURES,
    Differences,
    PictureIndex,
    redrawn,
)
from relgloss_view.catalogue.query.notes import (
    ERRORS,
    colour_note,
    exact_note,
    pictures_note,
    reading_note,
)
from relgloss_view.catalogue.query.order_words import order_words
from relgloss_view.catalogue.query.parse import parse
from relgloss_view.catalogue.query.references import Resolved, resolved
from relgloss_view.catalogue.query.terms import (
    CLOSENESS,
    ColourNear,
    GlossRatio,
    Near,
    Nearest,
    Query,
    ReferenceName,
    Wish,
)
from relgloss_view.catalogue.query.truth import UNKNOWN, present, truth
from relgloss_view.catalogue.query.values import Values
from relgloss_view.material.difference import delta_e_2000

if TYPE_CHECKING:
    from relgloss_view.quality.backends import FrameRenderer

RATIO = Measure("ratio", "x as glossy", 3)
COLOUR = Measure("colour_difference", "dE2000", 2)
COLOUR_76 = Measure("colour_difference", "dE76", 2)
TEXTS_KNOWN = ("path", "kind", "status")  #: columns that every row has


def search(
    catalogue: Searched,
    query: str | Query,
    limit: int | None = None,
    *,
    renderer: FrameRenderer | None = None,
    progress: ProgressReport = no_progress,
) -> Found:
    """What a query finds in a catalogue; see Searcher.search."""
    return Searcher(catalogue).search(query, limit, renderer=renderer, progress=progress)


class Searcher:
    """Searches one catalogue again and again; what a query has read is kept for the next one."""

    def __init__(self, catalogue: Searched) -> None:
        self.catalogue = catalogue
        self.values = Values(catalogue.rows)
        self._index: PictureIndex | None = None

    def search(
        self,
        query: str | Query,
        limit: int | None = None,
        *,
        renderer: FrameRenderer | None = None,
        progress: ProgressReport = no_progress,
    ) -> Found:
        """The hits of a query, at most `limit`, in the order that the query asks for.

        renderer: redraws the nearest pictures exactly; without one, thumbnails decide. Hits are
        ordered by `sort by`, else by the first wish, else by file; equal ones by file. Raises
        QueryError, an InputError with the place in the query.
        """
        query = parse(query) if isinstance(query, str) else query
        return _Search(self, query, limit, renderer, progress).found()

    def index(self, progress: ProgressReport) -> PictureIndex:
        """The thumbnails as colours, read once."""
        if self._index is None:
            self._index = PictureIndex.of(self.catalogue, progress)
        return self._index


class _Search:
    """One search."""

    def __init__(
        self,
        searcher: Searcher,
        query: Query,
        limit: int | None,
        renderer: FrameRenderer | None,
        progress: ProgressReport,
    ) -> None:
        self.searcher, self.query, self.renderer = searcher, query, renderer
        self.values, self.catalogue = searcher.values, searcher.catalogue
        self.progress = progress
        limits = [n for n in (limit, query.first) if n is not None]
        self.limit = min(limits) if limits else len(self.values)
        self._references: dict[str, Resolved] = {}
        self._distances: dict[int, Array] = {}
        self._readings: dict[int, tuple[float, str]] = {}
        self.differences: Differences | None = None

    def found(self) -> Found:
        """The result."""
        query, values = self.query, self.values
        met = truth(query.condition, values, self.distance, self.ratio)
        rows = np.flatnonzero(met == 1.0)
        unknown = np.flatnonzero(met == UNKNOWN)
        rows = self._ordered(rows)
        is_exact = True
        nearest = self._nearest_wish()
        if nearest is not None:
            rows, is_exact = self._by_pictures(rows, nearest)
        numbers = self._numbers()
        hits = tuple(
            Hit(values.rows[k], rank, self._of_row(int(k), numbers))
            for rank, k in enumerate(rows[: self.limit], 1)
        )
        measures = tuple(dict.fromkeys(measure for measure, _ in numbers))
        return Found(
            query=query,
            hits=hits,
            total=len(rows),
            searched=len(values),
            left_out=len(unknown),
            missing=self._missing(unknown),
            columns=self._columns(),
            measures=measures + (MEASURES if self.differences is not None else ()),
            order=order_words(query, {k: v.words for k, v in self._references.items()}),
            references={name: one.words for name, one in self._references.items()},
            notes=self._notes(is_exact),
            is_exact=is_exact,
            reference=next(iter(self._references.values()), None),
        )

    def distance(self, wish: Wish) -> Array:
        """Distances (N,) from a wish; NaN where a value is missing."""
        key = id(wish)
        if key not in self._distances:
            self._distances[key] = self._distance(wish)
        return self._distances[key]

    def _distance(self, wish: Wish) -> Array:
        if isinstance(wish, Near):
            return np.asarray(np.abs(self.values.numbers(wish.column) - wish.target))
        if isinstance(wish, GlossRatio):
            assert wish.wanted is not None
            return np.asarray(np.abs(self.ratio(wish) / wish.wanted - 1.0))
        if isinstance(wish, ColourNear):
            return self._colour_distance(wish)
        if self.differences is not None:
            raise QueryError(
                self.query.text, *wish.reference.span, "a query can compare pictures only once",
                "remove one 'nearest to'",
            )  # fmt: skip
        reference = self._resolve(wish.reference)
        index = self.searcher.index(self.progress)
        self.differences = index.differences(reference, self.catalogue, self.renderer)
        return self.differences.all

    def ratio(self, wish: GlossRatio) -> Array:
        """Gloss over the reference's (N,)."""
        gloss = self.catalogue.recipe.gloss
        column = wish.column or READINGS[gloss]
        reference = self._resolve(wish.reference)
        reading = reference.reading(column, self.values)
        if not reading > 0.0:
            raise QueryError(
                self.query.text, *wish.reference.span, f"{reference.words} has no gloss",
                "choose another sample to compare with",
            )  # fmt: skip
        self._readings[id(wish)] = (reading, column)
        return self.values.numbers(column) / reading

    def _colour_distance(self, wish: ColourNear) -> Array:
        target = self.target(wish)
        colours = self.values.colours
        if wish.formula == "76":
            return np.asarray(np.linalg.norm(colours - target, axis=-1))
        return delta_e_2000(colours, np.broadcast_to(target, colours.shape))

    def target(self, wish: ColourNear) -> Array:
        """The wanted L*, a*, b* (3,)."""
        if not isinstance(wish.target, ReferenceName):
            return np.array(wish.target)
        reference = self._resolve(wish.target)
        colour = reference.colour(self.values)
        if np.any(np.isnan(colour)):
            raise QueryError(
                self.query.text, *wish.target.span, f"{reference.words} has no colour",
                "choose another sample, or write its L* a* b*",
            )  # fmt: skip
        return colour

    def _resolve(self, name: ReferenceName) -> Resolved:
        if name.text not in self._references:
            self._references[name.text] = resolved(
                name, self.catalogue, self.values, self.query.text
            )
        return self._references[name.text]

    def _ordered(self, rows: Ints) -> Ints:
        """Rows by the keys of the query; rows without a value come last, equal ones by file."""
        orders = self.query.order
        if not orders and self.query.wishes:
            orders = (terms.Order(CLOSENESS),)
        ordered = [int(k) for k in rows]
        for order in reversed(orders):
            ordered = self._sorted(ordered, order)
        return np.array(ordered, dtype=np.int64)

    def _sorted(self, rows: list[int], order: terms.Order) -> list[int]:
        if order.column == CLOSENESS:
            keys: Any = self.distance(self.query.wishes[0])
        elif _is_text(order.column):
            keys = self.values.texts(order.column)
        else:
            keys = self.values.numbers(order.column)
        known = [k for k in rows if keys[k] is not None and keys[k] == keys[k]]
        if len(known) < len(rows):
            in_known = set(known)
            rest = [k for k in rows if k not in in_known]
        else:
            rest = []
        # `reverse` keeps the order of equal ones
        return sorted(known, key=lambda k: keys[k], reverse=order.descending) + rest

    def _nearest_wish(self) -> Nearest | None:
        wishes = [wish for wish in self.query.wishes if isinstance(wish, Nearest)]
        return wishes[0] if wishes else None

    def _by_pictures(self, rows: Ints, wish: Nearest) -> tuple[Ints, bool]:
        """Rows whose nearest are ranked by pictures that are drawn exactly."""
        assert self.differences is not None
        ranks = not self.query.order and self.query.wishes[0] is wish
        most = max(min(self.limit, EXACT_MOST), 1) if not ranks else EXACT_MOST
        if self.renderer is None:
            return rows, False
        reference = self._resolve(wish.reference)
        paths = [str(self.values.rows[int(k)]["path"]) for k in rows[:most]]
        exact = redrawn(reference, paths, self.catalogue, self.renderer, self.progress)
        self.differences = dataclasses.replace(
            self.differences,
            exact={int(k): exact[path] for k, path in zip(rows, paths, strict=False)},
        )
        if ranks:
            by = {int(k): exact[path].difference for k, path in zip(rows, paths, strict=False)}
            head = sorted((int(k) for k in rows[:most]), key=lambda k: (by[k], k))
            rows = np.array([*head, *(int(k) for k in rows[most:])], dtype=np.int64)
        return rows, True

    def _numbers(self) -> list[tuple[Measure, Array]]:
        """The measures of the query with their values by row."""
        made: list[tuple[Measure, Array]] = []
        seen: set[str] = set()
        for leaf in self.query.leaves:
            if isinstance(leaf, GlossRatio):
                measure, values = RATIO, self.ratio(leaf)
            elif isinstance(leaf, ColourNear):
                measure = COLOUR_76 if leaf.formula == "76" else COLOUR
                values = self.distance(leaf)
            else:
                continue
            if measure.key in seen:  # the first of the query
                continue
            seen.add(measure.key)
            made.append((measure, values))
        return made

    def _of_row(self, k: int, numbers: list[tuple[Measure, Array]]) -> Mapping[str, float]:
        made = {m.key: float(values[k]) for m, values in numbers if np.isfinite(values[k])}
        if self.differences is not None:
            made |= self.differences.of_row(k)
        return made

    def _columns(self) -> tuple[str, ...]:
        """Columns that the query uses, beside path and name."""
        used = [*self._used(), *(order.column for order in self.query.order)]
        return tuple(c for c in dict.fromkeys(used) if c not in ("path", "name", CLOSENESS))

    def _used(self) -> tuple[str, ...]:
        """Columns of the query's conditions, in its order."""
        used: list[str] = []
        for leaf in self.query.leaves:
            column = getattr(leaf, "column", None)
            if isinstance(leaf, GlossRatio):
                used.append(column or READINGS[self.catalogue.recipe.gloss])
            elif isinstance(leaf, ColourNear):
                used += LAB
            elif column is not None:
                used.append(column)
        return tuple(dict.fromkeys(used))

    def _notes(self, is_exact: bool) -> tuple[str, ...]:
        sentences = [self._note(leaf, is_exact) for leaf in self.query.leaves]
        if any(f"{column}_se" in BY_NAME for column in self._columns()):
            sentences.append(ERRORS)
        return tuple(dict.fromkeys(sentence for sentence in sentences if sentence))

    def _note(self, leaf: terms.Leaf, is_exact: bool) -> str:
        """What a reader has to know about a condition; empty for most."""
        if isinstance(leaf, GlossRatio) and id(leaf) in self._readings:
            return reading_note(self._resolve(leaf.reference).words, *self._readings[id(leaf)])
        if isinstance(leaf, ColourNear) and isinstance(leaf.target, ReferenceName):
            return colour_note(self._resolve(leaf.target).words, self.target(leaf))
        if isinstance(leaf, terms.Range) and leaf.low == leaf.high and _is_number(leaf.column):
            return exact_note(leaf.column, leaf.low)
        if isinstance(leaf, Nearest):
            count = len(self.differences.exact) if is_exact and self.differences else None
            return pictures_note(self._resolve(leaf.reference).words, count)
        return ""

    def _missing(self, unknown: Ints) -> dict[str, int]:
        """How many of the rows that were left out lack each column of the query."""
        if len(unknown) == 0:
            return {}
        columns = [c for c in self._used() if c not in TEXTS_KNOWN]
        counts = {c: int(np.sum(~present(c, self.values)[unknown])) for c in columns}
        if self.differences is not None:
            counts["thumbnail"] = int(np.sum(np.isnan(self.differences.all[unknown])))
        return {column: count for column, count in counts.items() if count}


def _is_number(column: str) -> bool:
    return BY_NAME[column].kind == NUMBER


def _is_text(column: str) -> bool:
    return BY_NAME[column].kind == TEXT
