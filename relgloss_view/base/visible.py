"""Text from outside made harmless: what a terminal would obey is shown instead."""

from __future__ import annotations

import unicodedata


def visible(text: str, keep: str = "") -> str:
    """The text with every character escaped that is not seen: controls, bidi marks, surrogates.

    keep: such characters that stay, as "\\n" for text of several lines. Spaces of any width stay.

    >>> visible("a\\tname\\nwith \\x1b[31mcolour")
    'a\\\\tname\\\\nwith \\\\x1b[31mcolour'
    """
    if text.isprintable():
        return text
    return "".join(c if c in keep or is_seen(c) else escape(c) for c in text)


def is_seen(character: str) -> bool:
    """Whether a terminal shows a character, or leaves a gap for it, and does nothing else."""
    return character.isprintable() or unicodedata.category(character) == "Zs"


def escape(character: str) -> str:
    """A character as Python writes it in a string: \\n, \\x1b, \\u202e."""
    return character.encode("unicode_escape").decode("ascii")
