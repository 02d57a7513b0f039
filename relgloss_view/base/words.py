"""Words of the interface, made from the words of declarations."""

from __future__ import annotations


def sentence_case(text: str) -> str:
    """The text with a capital at its beginning."""
    return text[:1].upper() + text[1:]
