"""The language of queries: text to Query. docs/catalogue.md has the grammar and its phrases.

query     = [ condition ] { order | number of hits }
condition = all { "or" all }
all       = part { ("and" | "but" | ",") part }
part      = "not" part | "(" condition ")" | phrase
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

from relgloss_view.catalogue.query import columns_phrases, wish_phrases
from relgloss_view.catalogue.query.fault import QueryError
from relgloss_view.catalogue.query.scanner import WIDE, Scanner
from relgloss_view.catalogue.query.terms import (
    CLOSENESS,
    All,
    Any,
    Condition,
    Not,
    Order,
    Query,
    is_wish,
    only_ranks,
)
from relgloss_view.catalogue.query.vocabulary import CHOICES, columns_known, suggestion

MOST_CHARACTERS = 20_000
DEEPEST = 50  #: parentheses within each other
MOST_HITS = 1_000_000
AND, OR = ("and", "but", "&&", "&", ",", ";"), ("or", "||", "|")
SORT, FIRST = ("sort by", "sorted by", "order by", "ordered by"), ("first", "top", "limit")
DOWN = ("descending", "desc", "highest first", "largest first", "downwards")
UP = ("ascending", "asc", "lowest first", "smallest first", "upwards")
CLOSE = ("closeness", "distance", "difference", "nearness")
OPEN, CLOSE_MARK = re.compile(r"\("), re.compile(r"\)")
EVERYTHING = ("all", "everything", "show all", "*")  #: a query without a condition
NUMBER_REMEDY = "write gloss 60 between 40 and 50, or 0.7 x as glossy as NAME"
WHOLE = re.compile(r"[0-9]+(?![0-9.])")


def parse(text: str) -> Query:
    """A query. Raises QueryError, with the place in the text and the words that are known.

    >>> parse("gloss 60 between 40 and 50, sort by gloss 60 descending").order
    (Order(column='gloss_60', descending=True),)
    >>> parse("gloss 60 > 40,5")
    Traceback (most recent call last):
    ...
    relgloss_view.catalogue.query.fault.QueryError: query, character 12 ('40,5'): a comma between \
digits may mean a decimal or two numbers; write 40.5 with a point, and a space between two numbers
    """
    return _Parser(text).query()


class _Parser:
    def __init__(self, text: str) -> None:
        if len(text) > MOST_CHARACTERS:
            raise QueryError(
                text, MOST_CHARACTERS, len(text),
                f"longer than {MOST_CHARACTERS} characters", "write a shorter query",
            )  # fmt: skip
        self.scanner = Scanner(text.translate(WIDE))
        self.depth = 0
        self.last: Condition | None = None  #: what the last phrase has asked for

    def query(self) -> Query:
        """The whole text."""
        scanner = self.scanner
        condition, order, first = None, [], None
        scanner.word(*EVERYTHING)
        if not scanner.done and not self._is_tail():
            condition = self.any_of()
        while not scanner.done:
            while scanner.word(*AND):
                pass
            if scanner.done:
                break
            if scanner.word(*SORT):
                order += self.orders()
            elif scanner.word(*FIRST):
                first = self.count()
            else:
                raise self._after_end()
        made = Query(scanner.text, condition, tuple(order), first)
        if any(one.column == CLOSENESS for one in order) and not made.wishes:
            raise QueryError(
                scanner.text, 0, len(scanner.text), "there is nothing to be close to",
                "add nearest to NAME, colour near 50 20 10 or as glossy as NAME",
            )  # fmt: skip
        return made

    def any_of(self) -> Condition:
        """condition = all { "or" all }."""
        start = self.scanner.skip()
        parts = [self.all_of()]
        while self.scanner.word(*OR):
            parts.append(self.all_of())
        if len(parts) == 1:
            return parts[0]
        for part in parts:
            self._check_filters(part, "or", start)
        return Any(tuple(parts))

    def all_of(self) -> Condition:
        """All = part { "and" part }."""
        parts = [self.part()]
        while True:
            at = self.scanner.at
            if not self.scanner.word(*AND):
                break
            if self.scanner.done or self._is_tail():
                comma = self.scanner.text[at : self.scanner.at].strip() in (",", ";")
                if self.scanner.done and not comma:
                    raise self.scanner.fault(
                        "something has to follow here", "write a condition, or leave out 'and'"
                    )
                self.scanner.at = at
                break
            parts.append(self.part())
        return parts[0] if len(parts) == 1 else All(tuple(parts))

    def part(self) -> Condition:
        """Part = "not" part | "(" condition ")" | phrase."""
        scanner = self.scanner
        start, negated, count = scanner.skip(), False, 0
        while scanner.word("not"):
            negated, count = not negated, count + 1
        if scanner.take(OPEN):
            with self._deeper(scanner.at - 1):
                opened = scanner.at - 1
                inner = self.any_of()
                if not scanner.take(CLOSE_MARK):
                    if scanner.done:
                        raise QueryError(
                            scanner.text, opened, opened + 1, "this parenthesis is not closed",
                            "add ) where its condition ends",
                        )  # fmt: skip
                    raise self._after_end()
        else:
            inner = self.phrase()
        if count:
            self.last = None  # "not quality good or poor" would mean something else than it says
            self._check_filters(inner, "not", start)
        return Not(inner) if negated else inner

    def phrase(self) -> Condition:
        """One condition on colour, gloss ratio, picture or a column."""
        scanner = self.scanner
        if scanner.done:
            raise scanner.fault("a condition is missing here", suggestion(""))
        made: Condition | None = wish_phrases.wish(scanner)
        made = made or columns_phrases.again(scanner, self.last)
        for read in (columns_phrases.alone, columns_phrases.on_column):
            made = made or read(scanner)
        if made is not None:
            self.last = made
            return made
        if scanner.has_number():
            raise scanner.fault("a condition begins with what it is about", NUMBER_REMEDY)
        at, end = scanner.piece()
        if scanner.text[at:end].lower() in (*AND, *OR):
            remedy = "write a condition before it, or leave it out"
            raise QueryError(scanner.text, at, end, "it joins two conditions", remedy)
        longer = scanner.text[at : min(len(scanner.text), end + 12)]
        piece = scanner.text[at : min(end, at + 30)]
        if piece.lower() in CHOICES["quality"]:
            remedy = f"write quality {piece.lower()}"
            raise QueryError(scanner.text, at, end, "not a condition by itself", remedy)
        near = suggestion(longer)
        then = " To" if near.endswith("?") else "; to"
        remedy = f"{near}{then} look for a name, write name contains {piece}"
        raise QueryError(scanner.text, at, end, "not a known word here", remedy)

    def orders(self) -> list[Order]:
        """The columns of `sort by`, each with its direction."""
        orders = []
        while True:
            if self.scanner.word(*CLOSE):
                column = CLOSENESS
            else:
                column = columns_phrases.column(self.scanner) or ""
                if not column:
                    at, end = self.scanner.piece()
                    piece = self.scanner.text[at:end]
                    raise self.scanner.fault(
                        "no column to sort by", suggestion(piece, columns_known(), 0.6)
                    )
            descending = bool(self.scanner.word(*DOWN))
            if not descending:
                self.scanner.word(*UP)
            orders.append(Order(column, descending))
            at = self.scanner.at
            if not self.scanner.word(",", "and", "then"):
                return orders
            if self.scanner.done or self._is_tail():
                self.scanner.at = at
                return orders

    def count(self) -> int:
        """The number after `first`."""
        match = self.scanner.take(WHOLE)
        if match is None or not 1 <= (count := int(match.group()[:9])) <= MOST_HITS:
            if match is not None:
                self.scanner.at = match.start()
            raise self.scanner.fault(
                "expected a number of hits", f"write a whole number from 1 to {MOST_HITS}"
            )
        self.scanner.word("hits", "items", "rows", "results")
        return count

    @contextmanager
    def _deeper(self, at: int) -> Iterator[None]:
        self.depth += 1
        if self.depth > DEEPEST:
            raise QueryError(
                self.scanner.text, at, at + 1, f"more than {DEEPEST} parentheses within each other",
                "write a simpler query",
            )  # fmt: skip
        yield
        self.depth -= 1

    def _is_tail(self) -> bool:
        at = self.scanner.at
        is_tail = bool(self.scanner.word(*SORT))
        if not is_tail and self.scanner.word(*FIRST):
            # "first lobe width above 2" is a condition
            is_tail = columns_phrases.column(Scanner(self.scanner.text[at:])) is None
        self.scanner.at = at
        return is_tail

    def _check_filters(self, part: Condition, word: str, at: int) -> None:
        """QueryError where a wish that leaves nothing out is within `or` or `not`."""
        parts = part.parts if isinstance(part, All | Any) else (part,)
        for one in parts:
            if is_wish(one) and only_ranks(one):
                raise self.scanner.fault(
                    f"{word!r} needs a condition, and this only ranks the hits",
                    "add a tolerance (within 5 %, within dE 3), or join it with 'and'", at,
                )  # fmt: skip

    def _after_end(self) -> QueryError:
        """The fault of what follows a whole condition."""
        if self.scanner.peek(CLOSE_MARK):
            return self.scanner.fault("this parenthesis was not opened", "remove it")
        at, end = self.scanner.piece()
        known = ("and", "or", "sort by", "first")
        return self.scanner.fault(
            "not expected after a whole condition",
            suggestion(self.scanner.text[at:end], known)
            if end - at > 2
            else "join conditions with 'and' or 'or'; then may follow sort by COLUMN, first 20",
        )
