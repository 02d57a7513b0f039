"""The words of the page, which stand in words/en.json, and texts as HTML in ASCII."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

from relgloss_view.base.page_scripts import html_text

FILE = Path(__file__).parent / "words" / "en.json"


@lru_cache(maxsize=1)
def sentences() -> Mapping[str, str]:
    """All sentences by key, with their {placeholders}."""
    found: dict[str, str] = json.loads(FILE.read_text(encoding="utf-8"))
    return found


def say(key: str, **values: object) -> str:
    """A sentence with its placeholders filled; KeyError for a key that there is none of.

    >>> say("failed", count=3)
    '3 files could not be read'
    """
    return sentences()[key].format_map(values)


def text(words: object) -> str:
    """Plain text as HTML in ASCII.

    >>> text("R&D \u2013 <1>")
    'R&amp;D &#8211; &lt;1&gt;'
    """
    return html_text(str(words)).encode("ascii", "xmlcharrefreplace").decode("ascii")
