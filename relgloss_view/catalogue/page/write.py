"""The page of what a search has found, or of a whole catalogue: one file for any browser.

Nothing of it is fetched: style, script, data and pictures are in the file, and its policy lets in
nothing else. Without scripts it is a table of the first hits with their pictures (plain.py). The
thumbnails come in parts, the first before the script and the others after it, so that a large page
shows its first hits while it is still read; what is read of an opened hit alone comes last.
"""

from __future__ import annotations

import base64
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

from relgloss_view.base.page_scripts import (
    data_json,
    html_value,
    one_script,
    policy_source,
)
from relgloss_view.base.reading import printable
from relgloss_view.base.version import __version__
from relgloss_view.base.writing import whole_file
from relgloss_view.catalogue.columns import FAILED, READINGS
from relgloss_view.catalogue.page import rows
from relgloss_view.catalogue.page.plain import failed_list, plain_table
from relgloss_view.catalogue.page.sentences import say, sentences, text
from relgloss_view.catalogue.query.found import Found, Hit, Searched
from relgloss_view.catalogue.query.notes import left_out_words
from relgloss_view.catalogue.query.vocabulary import label_of

FOLDER = Path(__file__).parent
ENTRY = "main.js"
PART = 100  #: thumbnails of a block
#: Pictures up to which bytes are worth more than the time: half the bytes for ten times the time.
SMALL_PAGE = 2000
THREADS = 4


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
    title = printable(found.query.text, 300) or say("title")
    table, facts = _table(hits, found, catalogue, path, proofs)
    blocks = [
        _block(f"pictures-{k}", pictures[start : start + PART])
        for k, start in enumerate(range(0, len(pictures), PART))
    ]
    parts = [
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        f'<meta name="generator" content="relgloss {html_value(__version__)}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{text(title)}</title>\n<style>{style}</style></head>\n<body>\n",
        _head(title, found, catalogue),
        f'<div class="work"><details id="fold" class="filters"><summary>{text(say("fold"))}'
        '</summary><div id="panel"></div></details>\n<main id="main"><div id="tools"></div>'
        '<div id="list"></div>\n',
        plain_table(pictures, table, facts),
        f'</main></div>\n<div id="tray" role="region" aria-label="{html_value(say("tray"))}" '
        "hidden></div>\n",
        failed_list(failed, is_open=not hits),
        '<p id="live" class="unseen" role="status" aria-live="polite"></p>\n',
        _block("words", dict(sentences())),
        _block("rows", table),
        *blocks[:1],
        f"<script>{code}</script>\n",
        *blocks[1:],
        _block("facts", facts),
        "</body></html>\n",
    ]
    return "".join(parts)


@lru_cache(maxsize=1)
def _script() -> str:
    return one_script(FOLDER / "js", ENTRY)


def _block(name: str, value: Any) -> str:
    return f'<script type="application/json" id="{name}">{data_json(value)}</script>\n'


def _pictures(hits: Sequence[Hit], catalogue: Searched) -> list[str]:
    """Thumbnails as base64 of WebP; '' where there is none."""
    pngs = catalogue.thumbnails([hit.path for hit in hits])
    small = partial(rows.small_picture, is_small_page=len(hits) <= SMALL_PAGE)
    # The encoder works outside of Python's lock.
    with ThreadPoolExecutor(min(THREADS, os.cpu_count() or 1)) as threads:
        webps = threads.map(small, [pngs.get(hit.path, b"") for hit in hits])
        return [base64.b64encode(webp).decode("ascii") for webp in webps]


def _table(
    hits: Sequence[Hit],
    found: Found,
    catalogue: Searched,
    path: Path,
    proofs: Mapping[str, Path],
) -> tuple[dict[str, Any], dict[str, Any]]:
    """All that the script reads of the hits: at once, and when one is opened."""
    columns = rows.columns_of(found)
    places = [rows.material_place(hit, catalogue.folder, path) for hit in hits]
    proof_places = [
        rows.beside(proofs[hit.path], path) if hit.path in proofs else "" for hit in hits
    ]
    warnings = [rows.warnings_of(hit) for hit in hits]
    table = {
        "columns": columns,
        "count": len(hits),
        "part": PART,
        "values": rows.values_of(hits, columns),
        "marked": {
            "ratio_cut": [int(hit.row.get("is_ratio_kept") is False) for hit in hits],
            "warned": [len(lines) for lines in warnings],
        },
    }
    facts = {
        "errors": rows.errors_of(hits, columns),
        "link": [rows.address(place) for place in places],
        "proof": [rows.address(place) for place in proof_places],
        "command": [rows.command(place) for place in places],
        "warnings": warnings,
    }
    return table, facts


def _head(title: str, found: Found, catalogue: Searched) -> str:
    recipe = catalogue.recipe
    reference = recipe.reference
    if not isinstance(reference, str):
        reference = str(reference.get("name") or say("head.material"))
    notes = [*found.notes]
    if left_out := left_out_words(found):
        notes.append(say("head.note", note=left_out))
    facts = say(
        "head",
        reference=printable(reference, 80),
        gloss=label_of(READINGS[recipe.gloss]),
        version=__version__,
    )
    lines = "".join(f'<p class="quiet">{text(printable(note, 400))}</p>\n' for note in notes)
    return (
        f'<header class="head"><h1><bdi>{text(title)}</bdi></h1>\n'
        f'<p class="quiet">{text(facts)}</p>\n{lines}</header>\n'
    )
