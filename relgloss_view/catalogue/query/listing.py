"""Hits as a table on a terminal: rank, file, name, what the query uses, what it computed."""

from __future__ import annotations

import math
from typing import Any

from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Column, table
from relgloss_view.catalogue.columns import BY_NAME, DONE, FLAG, NUMBER, TEXT, WHOLE
from relgloss_view.catalogue.query.found import Found, Hit, Measure
from relgloss_view.catalogue.query.notes import left_out_words
from relgloss_view.catalogue.query.vocabulary import label_of
from relgloss_view.material.material import Quality

NOTHING = "-"
BAD = tuple(f"{quality}:" for quality in Quality if quality != Quality.GOOD)
#: Columns of a query that names none.
USUAL = ("gloss_60", "quality")
LONGEST, LONGEST_FAULT = 48, 600  #: characters of a cell
TAIL = 28  #: of them, those of the end: names of lots differ there
DECIMALS = {"GU": 1, "degrees": 2}
COLOURS = ("L_star", "a_star", "b_star")


def listing(found: Found, most: int | None = None) -> str:
    """The whole answer as text: a summary, the table of at most `most` hits, notes."""
    lines = [summary(found)]
    if found.hits:
        shown = tuple(c for c in found.columns if not c.endswith("_se") or _alone(c, found))
        names = shown or USUAL
        for verdict, reason in (("status", "fault"), ("quality", "warnings")):
            if verdict in shown and reason not in names and _reasons(found, verdict, reason):
                names = (*names, reason)  # whoever looks for what went wrong wants to know why
        columns = [
            Column("rank", 4), Column("file", left=True), Column("name", left=True),
            *(Column(_heading(name), left=BY_NAME[name].kind == TEXT) for name in names),
            *(Column(measure.label) for measure in _measures(found)),
        ]  # fmt: skip
        lines.append(table(columns, [_cells(hit, names, found) for hit in found.hits[:most]]))
        if most is not None and len(found.hits) > most:
            lines.append(f"... and {len(found.hits) - most:,} more on the page")
    left_out = left_out_words(found)
    lines += [note for note in (*found.notes, left_out and left_out + ".") if note]
    return "\n".join(lines)


def _reasons(found: Found, verdict: str, reason: str) -> bool:
    """Whether a hit has a bad verdict and its reason."""
    well = (None, "", DONE, str(Quality.GOOD))
    return any(hit.row.get(verdict) not in well and hit.row.get(reason) for hit in found.hits)


def summary(found: Found) -> str:
    """How many hits there are, of how many files, and their order."""
    of = f"of {found.searched} file{'' if found.searched == 1 else 's'}"
    if not found.total:
        return f"No hits: none {of} meets the query."
    hits = f"{found.total} hit{'' if found.total == 1 else 's'} {of}"
    if len(found.hits) < found.total:
        hits += f", the first {len(found.hits)}"
    return f"{hits}, {found.order}:"


def _alone(column: str, found: Found) -> bool:
    """Whether a standard error is asked for without its value, which shows it."""
    return column.removesuffix("_se") not in found.columns


def _measures(found: Found) -> list[Measure]:
    """The numbers of a terminal's table: means of pictures are for JSON and the page."""
    return [measure for measure in found.measures if not measure.key.endswith("_mean")]


def _heading(column: str) -> str:
    unit = BY_NAME[column].unit
    return f"{label_of(column)}\n{unit}" if unit else label_of(column)


def _cells(hit: Hit, names: tuple[str, ...], found: Found) -> list[str]:
    cells = [str(hit.rank), shortened(hit.path), shortened(hit.name)]
    cells += [value_words(hit.row, name) for name in names]
    for measure in _measures(found):
        value = hit.numbers.get(measure.key)
        cells.append(NOTHING if value is None else f"{value:.{measure.decimals}f}")
    return cells


def value_words(row: Any, column: str) -> str:
    """A value as people read it, with its standard error where it has one.

    The error is rounded up, so that it is never 0.

    >>> value_words({"gloss_60": 45.26, "gloss_60_se": 0.03}, "gloss_60")
    '45.3 +- 0.1'
    """
    value = row.get(column)
    if value is None or value == "":
        return NOTHING
    kind = BY_NAME[column].kind
    if kind == FLAG:
        return "yes" if value else "no"
    if kind == WHOLE:
        return str(int(value))
    if kind != NUMBER:
        if column in ("fault", "warnings"):
            lines = str(value).splitlines()
            lines.sort(key=lambda line: not line.startswith(BAD))  # what decided comes first
            return printable("; ".join(lines), LONGEST_FAULT)
        return shortened(str(value))
    error = row.get(f"{column}_se")
    words = _number(float(value), column)
    return words if error is None else f"{words} +- {_error(float(error), column)}"


def shortened(text: str) -> str:
    """A text of one line, cut in its middle: files of one product differ at their end.

    >>> shortened("2024/Algro Design Duo/Algro_Design_Duo_60g_lot402.json")
    '2024/Algro Design...o_Design_Duo_60g_lot402.json'
    """
    whole = printable(text, LONGEST_FAULT)
    if len(whole) <= LONGEST:
        return whole
    return f"{whole[: LONGEST - TAIL - 3]}...{whole[-TAIL:]}"


def _number(value: float, column: str) -> str:
    decimals = _decimals(column)
    return f"{value:.3g}" if decimals is None else f"{value:.{decimals}f}"


def _error(value: float, column: str) -> str:
    decimals = _decimals(column)
    return f"{value:.1g}" if decimals is None else rounded_up(value, decimals)


def rounded_up(error: float, decimals: int) -> str:
    """An error as people read it: rounded up, so that it is never 0.

    >>> rounded_up(0.0003, 3), rounded_up(0.004, 1)
    ('0.001', '0.1')
    """
    step = 10.0**-decimals
    return f"{step * max(math.ceil(error / step - 1e-9), 1):.{decimals}f}"


def _decimals(column: str) -> int | None:
    """How many are shown; None for three digits."""
    if column in COLOURS or column.removesuffix("_se") in ("haze", "doi"):
        return 1
    return DECIMALS.get(BY_NAME[column].unit)
