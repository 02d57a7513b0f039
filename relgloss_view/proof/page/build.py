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
from pathlib import Path
from typing import Any

from relgloss_view.base.version import __version__
from relgloss_view.base.visible import visible
from relgloss_view.proof.page.parts import MARK, PROGRAM, SEAL, UNSEALED, joined, script_json
from relgloss_view.proof.proof import Proof

FOLDER = Path(__file__).parent
ENTRY = "main.js"  #: which needs all others
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
        ordered[name] = f"// {name}\n" + condensed(_EXPORT.sub("", _IMPORT.sub("", text)))

    for entry in entries:
        add(entry, ())
    return "\n".join(ordered.values())


def condensed(text: str) -> str:
    """A module without indentation, empty lines and lines of comment alone: a third less to send.

    No text in backquotes goes over several lines, so a line's beginning is never part of one.

    >>> condensed("/** Twice x. */\\nfunction f(x) {\\n  // Really.\\n  return 2 * x;\\n}\\n")
    'function f(x) {\\nreturn 2 * x;\\n}'
    """
    kept, in_comment = [], False
    for line in map(str.strip, text.split("\n")):
        in_comment = in_comment or line.startswith("/*")
        if line and not in_comment and not line.startswith("//"):
            assert line.count("`") % 2 == 0, f"a text in backquotes over several lines: {line}"
            kept.append(line)
        in_comment = in_comment and not line.endswith("*/")
    return "\n".join(kept)


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
    assert not re.search("</script|<!--|\r|\0", code, re.I), "browsers would end it early"
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
    head = (
        "<!DOCTYPE html>\n"
        f'<html lang="{language}"><head><meta charset="utf-8">\n'
        f'{MARK}{UNSEALED}">\n{SEAL}{UNSEALED}">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        f'{PROGRAM}relgloss {__version__}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{html_text(proof.title)}</title>\n"
    )
    texts = {"head": head, "style": style, "static": body, "script": code}
    texts |= {name: script_json(value) for name, value in blocks.items()}
    return joined(texts, proof.digest)


def html_text(text: str) -> str:
    """Plain text as HTML, as browsers write it, on one line.

    >>> html_text("R&D\\u00a0<1>")
    'R&amp;D&nbsp;&lt;1&gt;'
    """
    line = visible("".join(" " if c in "\n\r\t\f" else c for c in text), "\u00a0")
    for character, entity in (("&", "amp"), ("<", "lt"), (">", "gt"), ("\u00a0", "nbsp")):
        line = line.replace(character, f"&{entity};")
    return line


def _source(text: str) -> str:
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"sha256-{base64.b64encode(digest).decode('ascii')}"
