"""The page of a proof with everything that this program puts into it."""

from __future__ import annotations

import dataclasses

from relgloss_view.base.version import __version__
from relgloss_view.proof.drawing import shaders_of
from relgloss_view.proof.page.build import page
from relgloss_view.proof.page.parts import load
from relgloss_view.proof.page.static import body
from relgloss_view.proof.proof import Proof, canonical

PROGRAM = f"relgloss {__version__}"


def page_of(proof: Proof, language: str = "en") -> str:
    """The HTML of a proof, the same whether the proof was just made or was read from a file.

    A reply that the page itself makes is the same, byte for byte (js/static.js, js/canonical.js).
    """
    # In the order of names, as every reader of the file has it.
    content = load(canonical(proof.content).decode("utf-8"))
    proof = dataclasses.replace(proof, content=content)
    shaders = shaders_of(proof.content["drawing"])
    return page(proof, shaders, body(proof, language), language)
