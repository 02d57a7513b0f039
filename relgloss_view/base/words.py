"""Words of the interface, made from the words of declarations."""

from __future__ import annotations

from collections.abc import Iterable


def sentence_case(text: str) -> str:
    """The text with a capital at its beginning."""
    return text[:1].upper() + text[1:]


def listed(names: Iterable[str], last: str = "and") -> str:
    """Names as a sentence lists them.

    >>> listed(["red", "green", "blue"]), listed(["red"])
    ('red, green and blue', 'red')
    """
    *before, end = names
    return f"{', '.join(before)} {last} {end}" if before else end
