"""Files that another file names: only those in its own folder and below are ever opened."""

from __future__ import annotations

from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable


def path_beside(name: str, folder: Path) -> Path:
    """The path of a file that a file of `folder` names, relative to it.

    Raises InputError where the name, or a link that it leads through, leaves the folder.
    """
    shown = printable(name, 60)
    refusal = f"names the file {shown}, which is not in its folder; put its files beside it"
    parts = name.replace("\\", "/").split("/")
    if ":" in name or "\0" in name or ".." in parts or name.startswith(("/", "\\")):
        raise InputError(refusal)
    path = folder / name
    try:
        inside = path.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError, ValueError):
        inside = False
    if not inside:
        raise InputError(refusal)
    return path
