"""QueryError: a query that nobody can follow, with its place in the text."""

from __future__ import annotations

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable

SHOWN = 40  #: characters of the text at fault that a message shows


class QueryError(InputError):
    """A fault of a query. at, end: the characters of the text that it concerns, from 0.

    >>> error = QueryError("glos 60 > 40", 0, 4, "no such column", "did you mean gloss 60?")
    >>> error.at, error.end
    (0, 4)
    >>> print(error)
    query, character 1 ('glos'): no such column; did you mean gloss 60?
    """

    def __init__(self, text: str, at: int, end: int, fault: str, remedy: str) -> None:
        self.text, self.at, self.end = text, at, max(at, end)
        self.fault, self.remedy = fault, remedy
        piece = text[at : self.end]
        place = f"character {at + 1} ({printable(piece, SHOWN)!r})" if piece.strip() else "its end"
        if not text.strip():
            place = "empty"
        super().__init__(f"query, {place}: {fault}; {remedy}")
