"""The page of a proof as one file: HTML, style, JavaScript, shaders and words joined.

base/page_scripts.py joins the ES modules of page/js/ to one script.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from relgloss_view.base import page_scripts
from relgloss_view.base.page_scripts import html_text, one_script, policy_source
from relgloss_view.base.version import __version__
from relgloss_view.proof.page.parts import MARK, PROGRAM, SEAL, UNSEALED, joined, script_json
from relgloss_view.proof.proof import Proof

FOLDER = Path(__file__).parent
ENTRY = "main.js"  #: which needs all others


@lru_cache(maxsize=1)
def script() -> str:
    """All of page/js as one script."""
    return one_script(FOLDER / "js", ENTRY)


def bundle(*entries: str) -> str:
    """The modules of page/js that some of them need, with them, each after those that it needs."""
    return page_scripts.bundle(FOLDER / "js", *entries)


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
        f"default-src 'none'; script-src '{policy_source(code)}'; "
        f"style-src '{policy_source(style)}'; "
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
