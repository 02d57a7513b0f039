"""The page of a proof as one file: HTML, style, JavaScript, shaders and words joined.

page/js/ holds ES modules. Here their import lines and the word `export` are taken away, so that all
of them are one script in one scope, in the order in which they need each other; no two of them give
the same name to different things (a test holds it).
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Mapping
from functools import lru_cache
from html import escape
from pathlib import Path
from typing import Any

from relgloss_view.proof.proof import Proof, canonical

FOLDER = Path(__file__).parent
ENTRY = "main.js"  #: which needs all others
#: Marks a file as a proof, within its first bytes; the content is the proof's name.
MARK = '<meta name="relgloss-proof" content="'
SEAL = '<meta name="relgloss-seal" content="'
UNSEALED = "0" * 64
_IMPORT = re.compile(r'^import\b[^;]*?from\s+"\./([\w-]+\.js)";\n', re.M)
_EXPORT = re.compile(r"^export (?=(?:async |const |let |function |class ))", re.M)


@lru_cache(maxsize=1)
def script() -> str:
    """All of page/js as one script."""
    return f'"use strict";\n(() => {{\n{bundle(ENTRY)}\n}})();\n'


def bundle(*entries: str) -> str:
    """The modules of page/js that some of them need, with them, each after those that it needs."""
    ordered: dict[str, str] = {}

    def add(name: str, trail: tuple[str, ...]) -> None:
        assert name not in trail, f"{name} imports itself by way of {' > '.join(trail)}"
        if name in ordered:
            return
        text = (FOLDER / "js" / name).read_text(encoding="utf-8")
        for other in _IMPORT.findall(text):
            add(other, (*trail, name))
        ordered[name] = f"// {name}\n" + _EXPORT.sub("", _IMPORT.sub("", text))

    for entry in entries:
        add(entry, ())
    return "\n".join(ordered.values())


def words(language: str = "en") -> dict[str, str]:
    """The words of the page."""
    path = FOLDER / "words" / f"{language}.json"
    table: dict[str, str] = json.loads(path.read_text(encoding="utf-8"))
    return table


def page(proof: Proof, shaders: Mapping[str, str], body: str, language: str = "en") -> str:
    """The page of a proof.

    shaders: the texts of the shader files that it needs, by name. body: its static part as HTML,
    which is seen where nothing can be drawn (static.py).
    """
    style = (FOLDER / "style.css").read_text(encoding="utf-8")
    code = script()
    policy = (
        f"default-src 'none'; script-src '{_source(code)}'; style-src '{_source(style)}'; "
        "img-src data: blob:; base-uri 'none'; form-action 'none'"
    )
    blocks: dict[str, Any] = {
        "proof": proof.as_json(),
        "signatures": [vars(signature) for signature in proof.signatures],
        "shaders": dict(shaders),
        "words": words(language),
    }
    data = "\n".join(
        f'<script type="application/json" id="{name}">{script_json(value)}</script>'
        for name, value in blocks.items()
    )
    html = (
        "<!DOCTYPE html>\n"
        f'<html lang="{language}"><head><meta charset="utf-8">\n'
        f'{MARK}{proof.digest}">\n{SEAL}{UNSEALED}">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(proof.title)}</title>\n<style>{style}</style></head><body>\n"
        f"{body}\n{data}\n<script>{code}</script></body></html>\n"
    )
    return html.replace(SEAL + UNSEALED, SEAL + seal_of(html), 1)


def seal_of(html: str) -> str:
    """SHA-256 of a page with zeros in place of its seal."""
    return hashlib.sha256(html.encode("utf-8")).hexdigest()


def script_json(value: Any) -> str:
    """JSON that no HTML ends early: the same values, `<` written as an escape."""
    return canonical(value).decode("utf-8").replace("<", "\\u003c")


def _source(text: str) -> str:
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"sha256-{base64.b64encode(digest).decode('ascii')}"
