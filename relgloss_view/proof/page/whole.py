"""The page of a proof with everything that this program puts into it."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import refuse
from relgloss_view.base.version import PROGRAM as PROGRAM
from relgloss_view.picture.gpu.shader import shader_folder
from relgloss_view.proof.drawing import shaders_of
from relgloss_view.proof.entries import check_entries
from relgloss_view.proof.page.build import page
from relgloss_view.proof.page.parts import load
from relgloss_view.proof.page.static import body
from relgloss_view.proof.proof import Proof, canonical

STAGE = re.compile(r"[a-z_]{1,40}\.(?:frag|vert|glsl)")  #: a file's name without any folder


def page_of(proof: Proof, language: str = "en") -> str:
    """The HTML of a proof, the same whether the proof was just made or was read from a file.

    A reply that the page itself makes is the same, byte for byte (js/static.js, js/canonical.js).
    Raises InputError where the content, which may be anyone's, is not one that a page shows.
    """
    # In the order of names, as every reader of the file has it.
    content = load(canonical(proof.content).decode("utf-8"))
    proof = dataclasses.replace(proof, content=content)
    try:
        check_entries(content)
        check_stages(content["drawing"])
        return page(proof, shaders_of(content["drawing"]), body(proof, language), language)
    except (AttributeError, IndexError, KeyError, TypeError, ValueError) as error:
        kind = type(error).__name__
        raise InputError(f"content: a part is of another kind than a proof's ({kind})") from error


def check_stages(drawing: Mapping[str, Any]) -> None:
    """InputError where a drawing names a stage that is none of this program's shaders."""
    for stage in drawing["stages"]:
        if not (isinstance(stage, str) and STAGE.fullmatch(stage)):
            refuse("content.drawing.stages", "names of shaders, such as shade.frag", stage)
        if not (shader_folder() / stage).is_file():
            refuse("content.drawing.stages", "names of this program's shaders", stage)
