"""What is there without scripts: a table of the first hits, and the files that have failed.

The table is in <noscript>: a browser with scripts takes it for one text, and neither lays it out
nor decodes its pictures.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from relgloss_view.base.page_scripts import html_value
from relgloss_view.base.reading import printable
from relgloss_view.catalogue.page import rows
from relgloss_view.catalogue.page.sentences import say, text
from relgloss_view.catalogue.query.found import Hit

ROWS = 200  #: of the table
COLUMNS = ("name", "gloss_20", "gloss_60", "gloss_85", "haze", "L_star", "a_star", "b_star",
           "gloss_ratio", "quality")  # fmt: skip


def plain_table(pictures: Sequence[str], table: Mapping[str, Any], facts: Mapping[str, Any]) -> str:
    """The table. pictures: base64 of WebP by row; table, facts: what the script reads."""
    columns = {column["name"]: column for column in table["columns"]}
    heads = "".join(f'<th scope="col">{text(columns[name]["label"])}</th>' for name in COLUMNS)
    lines = []
    for k in range(min(table["count"], ROWS)):
        picture = (
            f'<img src="data:image/webp;base64,{pictures[k]}" alt="" width="64" height="64">'
            if pictures[k]
            else ""
        )
        cells = "".join(
            f"<td><bdi>{text(_cell(_value(table, name, k), columns[name]))}</bdi></td>"
            for name in COLUMNS[1:]
        )
        name = f"<bdi>{text(_value(table, 'name', k))}</bdi>"
        link = facts["proof"][k] or facts["link"][k]
        if link:
            name = f'<a href="{html_value(link)}">{name}</a>'
        if table["marked"]["ratio_cut"][k]:
            name += f' <span class="marks">{text(say("ratio-cut.short"))}</span>'
        lines.append(f'<tr><td>{picture}</td><th scope="row">{name}</th>{cells}</tr>\n')
    words = say("plain")
    if table["count"] > ROWS:
        words += " " + say("plain.first", shown=ROWS, all=table["count"])
    return (
        f'<div id="static"><p class="late">{text(say("plain.late"))}</p>'
        f'<noscript><p class="notice">{text(words)}</p>\n'
        f'<table class="rows"><thead><tr><th scope="col">{text(say("picture"))}</th>{heads}</tr>'
        f"</thead>\n<tbody>{''.join(lines)}</tbody></table></noscript></div>\n"
    )


def _value(table: Mapping[str, Any], name: str, row: int) -> Any:
    values = table["values"][name]
    return None if values is None else values[row]


def _cell(value: Any, column: Mapping[str, Any]) -> str:
    if column["kind"] == "number":
        return rows.plain_number(value, column["decimals"])
    return "\u2013" if value in (None, "") else str(value)


def failed_list(failed: Sequence[Hit], *, is_open: bool = False) -> str:
    """The files that could not be read, each with its fault; '' for none.

    is_open: where there is nothing else on the page.
    """
    if not failed:
        return ""
    items = "".join(
        f"<li><bdi>{text(printable(hit.path, rows.LONGEST))}</bdi>: "
        f"{text(printable(hit.row.get('fault') or say('failed.fault'), 400))}</li>\n"
        for hit in failed
    )
    count = say("failed.one") if len(failed) == 1 else say("failed", count=len(failed))
    return (
        f'<details class="failed" id="failed"{" open" if is_open else ""}>'
        f"<summary>{text(count)}</summary>\n"
        f"<ul>{items}</ul></details>\n"
    )
