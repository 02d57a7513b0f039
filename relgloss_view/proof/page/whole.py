"""The page of a proof with everything that this program puts into it."""

from __future__ import annotations

from relgloss_view.base.version import __version__
from relgloss_view.proof.drawing import shaders_of
from relgloss_view.proof.page.build import page
from relgloss_view.proof.page.static import body
from relgloss_view.proof.proof import Proof

PROGRAM = f"relgloss {__version__}"


def page_of(proof: Proof, language: str = "en") -> str:
    """The HTML of a proof. Its static body is that of the first message: replies keep it."""
    shaders = shaders_of(proof.content["drawing"])
    return page(proof, shaders, body(proof.opening, language), language)
