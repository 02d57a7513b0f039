"""A folder that a command fills: its own, and nothing of somebody else's."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import read_text

MAX_BYTES = 64 * 1024 * 1024  #: of a file that says whose a folder is


def own_folder(name: str, ours: Mapping[str, str], what: str, *, alone: bool = False) -> Path:
    """The folder, new or one that the same command has filled; InputError otherwise.

    `ours` names the JSON files that say whose a folder is, each with its format; any of them will
    do. With `alone` a folder that holds none of them has to be empty.
    """
    folder = Path(name)
    if not name or (os.path.lexists(folder) and not folder.is_dir()):
        found = "is a file" if name else "an empty name"
        raise InputError(f"{name or '-o'}: {found}; give the name of a folder with -o")
    for file, form in ours.items():
        if os.path.lexists(folder / file):
            if _format(folder / file) != form:
                raise InputError(
                    f"{folder / file}: is not of a relgloss {what}; choose another folder"
                )
            alone = False
    if alone and folder.is_dir() and any(folder.iterdir()):
        raise InputError(f"{folder}: holds what is not of a relgloss {what}; choose another folder")
    return folder


def _format(file: Path) -> object:
    try:
        return json.loads(read_text(file, MAX_BYTES, "a manifest"))["format"]
    except (InputError, ValueError, LookupError, TypeError, RecursionError):
        return None
