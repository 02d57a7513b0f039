"""A folder that a command fills: one that holds nothing but the command's own files."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Mapping
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.json_files import read_mark
from relgloss_view.base.temporaries import is_temporary, sweep


def own_folder(name: str, ours: Mapping[str, str], what: str, *, alone: bool = False) -> Path:
    """The folder, new or filled before by the same command; InputError otherwise.

    `ours` has the names of the JSON files that mark such a folder, each with its format; one of
    them is enough. With `alone` a folder without any of them has to be empty.
    """
    folder = Path(name)
    with contextlib.suppress(OSError, ValueError):  # what a killed run has left is finished first
        real = Path(os.path.realpath(folder))
        for place in (real.parent, real):
            sweep(place)
    if not name or (os.path.lexists(folder) and not folder.is_dir()):
        lost = folder.is_symlink() and not folder.exists()
        problem = "an empty name" if not name else "a link to nothing" if lost else "is a file"
        raise InputError(f"{name or '-o'}: {problem}; give the name of a folder with -o")
    for file, form in ours.items():
        if os.path.lexists(folder / file):
            if read_mark(folder / file).get("format") != form:
                raise InputError(
                    f"{folder / file}: was not written by `relgloss {what}`, or is damaged; "
                    "choose a new folder, or move this one away"
                )
            alone = False
    if alone and folder.is_dir() and not _empty(folder):
        raise InputError(
            f"{folder}: holds files, but no {' or '.join(ours)} of `relgloss {what}`; choose a "
            "new folder, or move this one away"
        )
    return folder


def stimuli_files(folder: Path, manifest: str) -> list[str]:
    """Names of the pictures that a manifest in a folder lists, as a former run wrote them."""
    try:
        return [str(entry["file"]) for entry in read_mark(folder / manifest)["stimuli"]]
    except (LookupError, TypeError):
        return []


def _empty(folder: Path) -> bool:
    """Whether a folder holds nothing, or only what a run that was killed or is at work has left."""
    return all(is_temporary(entry.name) for entry in folder.iterdir())
