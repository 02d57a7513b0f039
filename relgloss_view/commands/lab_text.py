"""L*, a*, b* as people type them: 46,-50,25, or with spaces, semicolons and decimal commas."""

from __future__ import annotations

import re


def lab_words(text: str) -> list[str]:
    """The numbers of a text, each a word with a decimal point.

    >>> lab_words("46,-50,25"), lab_words("46 -50 25"), lab_words("46,5; -50,2; 25")
    (['46', '-50', '25'], ['46', '-50', '25'], ['46.5', '-50.2', '25'])
    """
    text = text.strip()
    # Between two semicolons a comma can only be a decimal one.
    if text.count(";") == 2:
        text = text.replace(",", ".")
    return re.split(r"\s*[,;]\s*|\s+", text)
