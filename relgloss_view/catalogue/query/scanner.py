"""Scanner: a place in the text of a query, and what can be read from there."""

from __future__ import annotations

import math
import re
from functools import lru_cache

from relgloss_view.catalogue.query.fault import QueryError

NUMBER = re.compile(r"[+\-\u2212]?(?:[0-9]+(?:\.(?!\.)[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
#: Signs and digits as East Asian keyboards write them; parentheses stay, as names have them.
WIDE = {0xFEE0 + code: code for code in map(ord, "0123456789<>=%.+-")}
SPACE = re.compile(r"\s*")
COMMA = re.compile(r",[0-9]")
PIECE = re.compile(r"[^\s()]+")
QUOTES = {'"': '"', "'": "'", "\u201c": "\u201d", "\u201e": "\u201c", "\u00ab": "\u00bb",
          "\u2018": "\u2019"}  # fmt: skip
#: Chunks of a text at which a text without quotes ends, and what must follow there.
ENDS = {
    "and": None, "or": None, "but": None, "sort": r"\s*by\b", "sorted": r"\s*by\b",
    "order": r"\s*by\b", "ordered": r"\s*by\b", "first": r"\s*[0-9]+\b", "top": r"\s*[0-9]+\b",
    "limit": r"\s*[0-9]+\b",
}  # fmt: skip
ENDS_OF_NAMES = {**ENDS, "within": r"\s*(?:\+-|±)?\s*[0-9.]", "at": r"\s*[0-9]", "±": None}


@lru_cache(maxsize=1024)
def _words(phrases: tuple[str, ...]) -> re.Pattern[str]:
    """Any of some phrases, longest first, not within a longer word."""
    pieces = []
    for phrase in sorted(phrases, key=len, reverse=True):
        piece = r"\s+".join(re.escape(word) for word in phrase.split())
        pieces.append(piece + (r"(?!\w)" if phrase[-1].isalnum() else ""))
    return re.compile("|".join(pieces), re.IGNORECASE)


class Scanner:
    """A text and a place in it. Every read passes over white space first."""

    def __init__(self, text: str) -> None:
        self.text, self.at = text, 0

    def skip(self) -> int:
        """Pass over white space; returns the place."""
        match = SPACE.match(self.text, self.at)
        self.at = match.end() if match else self.at
        return self.at

    @property
    def done(self) -> bool:
        """Whether nothing but white space is left."""
        return self.skip() == len(self.text)

    def take(self, pattern: re.Pattern[str]) -> re.Match[str] | None:
        """What a pattern matches here, passed over."""
        match = self.peek(pattern)
        if match is not None:
            self.at = match.end()
        return match

    def peek(self, pattern: re.Pattern[str]) -> re.Match[str] | None:
        """What a pattern matches here."""
        return pattern.match(self.text, self.skip())

    def word(self, *phrases: str) -> str | None:
        """The phrase of some that is here, in lower case with single spaces, passed over."""
        match = self.take(_words(phrases))
        return None if match is None else " ".join(match.group().lower().split())

    def piece(self) -> tuple[int, int]:
        """The place of the next few words, for messages."""
        at = self.skip()
        match = PIECE.match(self.text, at)
        if match is None:
            return at, min(at + 1, len(self.text))
        return at, match.end()

    def number(self, expected: str) -> float:
        """The number here; QueryError without one, with a decimal comma, or beyond all sizes."""
        match = self.take(NUMBER)
        if match is None:
            raise self.fault(f"expected {expected}", "write a number such as 40 or 0.7")
        if COMMA.match(self.text, match.end()):
            end = match.end() + 1
            while end < len(self.text) and self.text[end].isdigit():
                end += 1
            raise QueryError(
                self.text, match.start(), end,
                "a comma between digits may mean a decimal or two numbers",
                "write 40.5 with a point, and a space between two numbers",
            )  # fmt: skip
        value = float(match.group().replace("\u2212", "-"))
        if not math.isfinite(value):
            raise QueryError(
                self.text, match.start(), match.end(), "too large", "write a smaller number"
            )
        return value

    def has_number(self) -> bool:
        """Whether a number is here."""
        return self.peek(NUMBER) is not None

    def at_end_of_text(self) -> bool:
        """Whether a text without quotation marks would end here, before its first word."""
        match = PIECE.match(self.text, self.skip())
        return match is None or match.group().lower() in ENDS

    def value(self, expected: str, *, is_name: bool = False) -> tuple[str, tuple[int, int]]:
        """The text here and its place: in quotes, or up to `and`, `or`, a comma, a parenthesis.

        is_name: of a reference, which also ends at "within 5 %" and "at 60 degrees".
        """
        at = self.skip()
        closing = QUOTES.get(self.text[at : at + 1])
        if closing is not None:
            end = self.text.find(closing, at + 1)
            if end < 0:
                raise QueryError(
                    self.text, at, len(self.text), "the quotation mark has no partner",
                    f"add {closing} after the text",
                )  # fmt: skip
            self.at = end + 1
            return self._filled(self.text[at + 1 : end], at, end + 1, expected)
        end = at
        ends = ENDS_OF_NAMES if is_name else ENDS
        while match := PIECE.match(self.text, self.skip()):
            if self._is_end(match, ends, is_first=end == at):
                break
            chunk = match.group()
            stripped = chunk.rstrip(",;")
            end = match.start() + len(stripped)
            self.at = end
            if stripped != chunk:
                break
        self.at = end
        text, span = self._filled(self.text[at:end], at, end, expected)
        if self.text[self.skip() : self.at + 1] == "(":
            raise QueryError(
                self.text, at, self.at + 1, "a text without quotation marks ends at a parenthesis",
                'put the whole text in quotation marks, as in name is "Lot (3)"',
            )  # fmt: skip
        return text, span

    def _is_end(self, match: re.Match[str], ends: dict[str, str | None], *, is_first: bool) -> bool:
        chunk = match.group().lower()
        if chunk not in ends:
            return False
        follows = ends[chunk]
        if follows is None:
            return True
        return not is_first and re.compile(follows, re.I).match(self.text, match.end()) is not None

    def _filled(self, text: str, at: int, end: int, expected: str) -> tuple[str, tuple[int, int]]:
        if not text.strip():
            self.at = at if end == at else self.at
            raise QueryError(
                self.text, at, max(end, self.piece()[1]), f"expected {expected}",
                "write it, in quotation marks where it contains and, or, or a parenthesis",
            )  # fmt: skip
        return text.strip(), (at, end)

    def fault(self, fault: str, remedy: str, at: int | None = None) -> QueryError:
        """A fault of the next words, or of those from `at` to here."""
        first, end = self.piece() if at is None else (at, self.at)
        return QueryError(self.text, first, end, fault, remedy)
