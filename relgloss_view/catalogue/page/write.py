"""The page of what a search has found, or of a whole catalogue: one file for any browser.

Nothing of it is fetched: style, script, data and pictures are in the file, and its policy lets in
nothing else. Without scripts it is a table of the first hits with their pictures. The thumbnails
come after the script, in parts, so that a large page shows its first hits while it is still read.
"""

from __future__ import annotations

import base64
import json
import os
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from relgloss_view.base.page_scripts import (
    data_json,
    html_text,
    html_value,
    one_script,
    policy_source,
)
from relgloss_view.base.reading import printable
from relgloss_view.base.version import __version__
from relgloss_view.base.writing import whole_file
from relgloss_view.catalogue.columns import FAILED
from relgloss_view.catalogue.page import rows
from relgloss_view.catalogue.query.found import Found, Hit, Searched
from relgloss_view.catalogue.query.notes import left_out_words

FOLDER = Path(__file__).parent
ENTRY = "main.js"
PLAIN_ROWS = 200  #: rows of the table without scripts
PART = 250  #: thumbnails of a block
PLAIN = ("name", "gloss_20", "gloss_60", "gloss_85", "haze", "L_star", "a_star", "b_star",
         "gloss_ratio", "quality")  # fmt: skip


def write_page(
    found: Found,
    catalogue: Searched,
    path: str | os.PathLike[str],
    proofs: Mapping[str, Path] | None = None,
) -> None:
    """Write the page of hits, whole or not at all.

    proofs: files of proofs by the item's path; like `path`, from the working folder. Hits that
    failed are listed apart. Raises InputError where the page can't be written.
    """
    html = page_of(found, catalogue, Path(path), proofs or {})
    with whole_file(path) as temporary:
        temporary.write_bytes(html.encode("ascii"))


def page_of(found: Found, catalogue: Searched, path: Path, proofs: Mapping[str, Path]) -> str:
    """The HTML of the page, in ASCII: all other characters are written as references."""
    hits = [hit for hit in found.hits if hit.row.get("status") != FAILED]
    failed = [hit for hit in found.hits if hit.row.get("status") == FAILED]
    pictures = _pictures(hits, catalogue)
    style = (FOLDER / "style.css").read_text(encoding="utf-8")
    code = _script()
    policy = (
        f"default-src 'none'; script-src '{policy_source(code)}'; "
        f"style-src '{policy_source(style)}'; img-src data:; base-uri 'none'; form-action 'none'"
    )
    title = printable(found.query.text, 300) or "Catalogue"
    table = _table(hits, found, catalogue, path, proofs)
    parts = [
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        f'<meta name="generator" content="relgloss {html_value(__version__)}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{_text(title)}</title>\n<style>{style}</style></head>\n<body>\n",
        _head(title, found, catalogue),
        '<div class="work"><details id="fold" class="filters"><summary>Filters</summary>'
        '<div id="panel"></div></details>\n<main id="main"><div id="tools"></div>'
        '<div id="list"></div>\n',
        _plain(hits, pictures, table),
        '</main></div>\n<div id="tray" role="region" aria-label="Comparison" hidden></div>\n',
        _failed(failed),
        '<p id="live" class="unseen" role="status" aria-live="polite"></p>\n',
        _block("words", json.loads((FOLDER / "words" / "en.json").read_text(encoding="utf-8"))),
        _block("rows", table),
        *(_block(f"pictures-{k}", part) for k, part in enumerate(_parts(pictures)[:1])),
        f"<script>{code}</script>\n",
        *(_block(f"pictures-{k + 1}", part) for k, part in enumerate(_parts(pictures)[1:])),
        "</body></html>\n",
    ]
    return "".join(parts)


@lru_cache(maxsize=1)
def _script() -> str:
    return one_script(FOLDER / "js", ENTRY)


def _text(text: object) -> str:
    """Plain text as HTML in ASCII."""
    return html_text(str(text)).encode("ascii", "xmlcharrefreplace").decode("ascii")


def _block(name: str, value: Any) -> str:
    return f'<script type="application/json" id="{name}">{data_json(value)}</script>\n'


def _parts(pictures: Sequence[str]) -> list[Sequence[str]]:
    return [pictures[k : k + PART] for k in range(0, len(pictures), PART)]


def _pictures(hits: Sequence[Hit], catalogue: Searched) -> list[str]:
    """Thumbnails as base64 of WebP; '' where there is none."""
    coded = []
    for start in range(0, len(hits), PART):
        part = hits[start : start + PART]
        pngs = catalogue.thumbnails([hit.path for hit in part])
        for hit in part:
            png = pngs.get(hit.path)
            coded.append(base64.b64encode(rows.small_picture(png)).decode("ascii") if png else "")
    return coded


def _table(
    hits: Sequence[Hit],
    found: Found,
    catalogue: Searched,
    path: Path,
    proofs: Mapping[str, Path],
) -> dict[str, Any]:
    """All that the script reads of the hits."""
    columns = rows.columns_of(found)
    places = [rows.material_place(hit, catalogue.folder, path) for hit in hits]
    proof_places = [
        rows.beside(proofs[hit.path], path) if hit.path in proofs else "" for hit in hits
    ]
    return {
        "columns": columns,
        "count": len(hits),
        "part": PART,
        "values": rows.values_of(hits, columns),
        "errors": rows.errors_of(hits, columns),
        "facts": {
            "link": [rows.address(place) for place in places],
            "proof": [rows.address(place) for place in proof_places],
            "command": [rows.command(place) for place in places],
            "warnings": [rows.warnings_of(hit) for hit in hits],
            "ratio_cut": [hit.row.get("is_ratio_kept") is False for hit in hits],
        },
    }


def _head(title: str, found: Found, catalogue: Searched) -> str:
    recipe = catalogue.recipe
    reference = recipe.reference
    if not isinstance(reference, str):
        reference = str(reference.get("name") or "a material")
    notes = [*found.notes]
    if left_out := left_out_words(found):
        notes.append(f"{left_out}.")
    facts = (
        f"Reference: {printable(reference, 80)}. "
        f"Gloss is compared by {printable(recipe.gloss, 40)}. "
        f"Pictures are for an sRGB screen. Made by relgloss {__version__}."
    )
    lines = "".join(f'<p class="quiet">{_text(printable(note, 400))}</p>\n' for note in notes)
    return (
        f'<header class="head"><h1><bdi>{_text(title)}</bdi></h1>\n'
        f'<p class="quiet">{_text(facts)}</p>\n{lines}</header>\n'
    )


def _plain(hits: Sequence[Hit], pictures: Sequence[str], table: Mapping[str, Any]) -> str:
    """The table without scripts."""
    columns = {column["name"]: column for column in table["columns"]}
    heads = "".join(f'<th scope="col">{_text(columns[name]["label"])}</th>' for name in PLAIN)
    lines = []
    for k in range(min(len(hits), PLAIN_ROWS)):
        picture = (
            f'<img src="data:image/webp;base64,{pictures[k]}" alt="" width="64" height="64">'
            if pictures[k]
            else ""
        )
        cells = "".join(
            f"<td><bdi>{_text(_cell(table['values'][name][k], columns[name]))}</bdi></td>"
            for name in PLAIN[1:]
        )
        name = f"<bdi>{_text(table['values']['name'][k])}</bdi>"
        link = table["facts"]["proof"][k] or table["facts"]["link"][k]
        if link:
            name = f'<a href="{html_value(link)}">{name}</a>'
        cut = ' <span class="marks">ratio not kept</span>' * table["facts"]["ratio_cut"][k]
        lines.append(f'<tr><td>{picture}</td><th scope="row">{name}{cut}</th>{cells}</tr>\n')
    more = ""
    if len(hits) > PLAIN_ROWS:
        more = f" These are the first {PLAIN_ROWS} of {len(hits)}."
    return (
        '<div id="static"><noscript><p class="notice">Filters and sorting need JavaScript, which '
        f"is off in this browser.{more}</p></noscript>\n"
        f'<table class="rows"><thead><tr><th scope="col">picture</th>{heads}</tr></thead>\n'
        f"<tbody>{''.join(lines)}</tbody></table></div>\n"
    )


def _cell(value: Any, column: Mapping[str, Any]) -> str:
    if column["kind"] == "number":
        return rows.plain_number(value, column["decimals"])
    return "\u2013" if value in (None, "") else str(value)


def _failed(failed: Sequence[Hit]) -> str:
    if not failed:
        return ""
    items = "".join(
        f"<li><bdi>{_text(printable(hit.path, rows.LONGEST))}</bdi>: "
        f"{_text(printable(hit.row.get('fault') or 'unknown fault', 400))}</li>\n"
        for hit in failed
    )
    count = "1 file" if len(failed) == 1 else f"{len(failed)} files"
    return (
        f'<details class="failed" id="failed"><summary>{count} could not be read</summary>\n'
        f"<ul>{items}</ul></details>\n"
    )
