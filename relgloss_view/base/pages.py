"""HTML pages that stand alone: one skeleton and style, tables, pictures held inside the file.

Every text is escaped here or by the caller with html.escape, so that a name from outside can't
become markup.
"""

from __future__ import annotations

import base64
from collections.abc import Collection, Iterable, Sequence
from html import escape

#: Neutral grays: the surround of a judged picture is L* 50.
STYLE = """
body { margin: 2rem; background: #777; color: #fff; font: 15px/1.45 system-ui, sans-serif; }
h1 { font-size: 1.5rem; font-weight: 600; margin: 0 0 .3rem; }
p { margin: .2rem 0; max-width: 60rem; }
.muted { color: #eee; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { text-align: right; border-bottom: 1px solid #909090; }
th { font-weight: 600; }
th:first-child, td:first-child, .text { text-align: left; }
code { font: 13px/1.4 ui-monospace, monospace; overflow-wrap: anywhere; }
"""


def page(title: str, parts: Iterable[str], style: str = "") -> str:
    """A whole page: its title as plain text, the parts of its body as HTML, empty ones left out.

    `style` is CSS that adds to STYLE and overrides it.
    """
    head = [
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width">',
        f"<title>{escape(title)}</title><style>{STYLE}{style.lstrip()}</style></head><body>",
    ]
    return "\n".join([*head, *(part for part in parts if part), "</body></html>\n"])


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], texts: Collection[int] = ()) -> str:
    """A table of plain texts; `texts` are the indices of further columns that hold words.

    The first column holds words in any case; the others are numbers and align to the right.
    """

    def row(kind: str, cells: Sequence[str]) -> str:
        marked = (
            f"<{kind}{' class=text' if k in texts else ''}>{escape(cell)}</{kind}>"
            for k, cell in enumerate(cells)
        )
        return f"<tr>{''.join(marked)}</tr>"

    body = "".join(row("td", cells) for cells in rows)
    return f"<table><thead>{row('th', heads)}</thead><tbody>{body}</tbody></table>"


def embedded_png(data: bytes) -> str:
    """A PNG file as a data URL."""
    return "data:image/png;base64," + base64.b64encode(data).decode("ascii")
