"""The order of hits in words."""

from __future__ import annotations

from collections.abc import Mapping

from relgloss_view.catalogue.query.terms import (
    CLOSENESS,
    ColourNear,
    GlossRatio,
    Near,
    Order,
    Query,
    ReferenceName,
    Wish,
)
from relgloss_view.catalogue.query.vocabulary import label_of


def order_words(query: Query, references: Mapping[str, str]) -> str:
    """How the hits of a query are ordered, as in "by closeness to gloss 60 45"."""
    orders = query.order or ((Order(CLOSENESS),) if query.wishes else ())
    if not orders:
        return "by file"
    return "by " + ", then ".join(_words(order, query, references) for order in orders)


def _words(order: Order, query: Query, references: Mapping[str, str]) -> str:
    if order.column == CLOSENESS:
        words = f"closeness to {wish_words(query.wishes[0], references)}"
        return words + ", farthest first" * order.descending
    return f"{label_of(order.column)}, {'highest' if order.descending else 'lowest'} first"


def wish_words(wish: Wish, references: Mapping[str, str]) -> str:
    """What a wish asks for."""
    if isinstance(wish, Near):
        return f"{label_of(wish.column)} {wish.target:g}"
    if isinstance(wish, GlossRatio):
        return f"{wish.wanted:g} x the gloss of {_name(wish.reference, references)}"
    if isinstance(wish, ColourNear):
        if isinstance(wish.target, ReferenceName):
            return f"the colour of {_name(wish.target, references)}"
        return "L* a* b* " + " ".join(f"{value:g}" for value in wish.target)
    return f"the picture of {_name(wish.reference, references)}"


def _name(name: ReferenceName, references: Mapping[str, str]) -> str:
    return references.get(name.text, name.text)
