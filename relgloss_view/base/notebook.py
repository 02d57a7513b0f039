"""Tables that a notebook shows for a value: escaped HTML, plain enough for every front end."""

from __future__ import annotations

import html
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.reading import printable

LONGEST = 300  #: characters of one cell; names and sources come from outside


def html_table(title: str, rows: Sequence[tuple[str, str]], warnings: Sequence[str] = ()) -> str:
    """An HTML table of entries and their values, followed by the warnings as a list.

    Every text is escaped and cut to LONGEST characters on one line, so that a name from a file can
    neither add markup nor fill the page.
    """
    cells = "".join(
        f"<tr><th style='text-align:left'>{_escaped(entry)}</th>"
        f"<td style='text-align:left'>{_escaped(value)}</td></tr>"
        for entry, value in rows
    )
    notes = "".join(f"<li>{_escaped(text)}</li>" for text in warnings)
    table = f"<table><caption>{_escaped(title)}</caption>{cells}</table>"
    return table + (f"<p>Warnings</p><ul>{notes}</ul>" if notes else "")


def span(values: ArrayLike, unit: str = "") -> str:
    """Smallest and largest finite value as text, such as '0.02 to 14 cd/m2'.

    One number where both are the same, 'none' where no value is finite.
    """
    numbers = np.asarray(values, dtype=np.float64)
    numbers = numbers[np.isfinite(numbers)]
    if not numbers.size:
        return "none"
    low, high = f"{numbers.min():.4g}", f"{numbers.max():.4g}"
    text = low if low == high else f"{low} to {high}"
    return f"{text} {unit}".rstrip()


def _escaped(text: str) -> str:
    return html.escape(printable(text, LONGEST))
