"""Folders of the user's own files: layout and presets, session, materials.

RELGLOSS_HOME, where it is set, holds all of it in folders of its own. Nothing is made here: a
folder appears when a file is first written into it.
"""

from __future__ import annotations

import os
from pathlib import Path

from relgloss_view.base.errors import InputError

VARIABLE = "RELGLOSS_HOME"
NAME = "relgloss"


def config_folder() -> Path:
    """Of the window's layout and the user's presets. InputError where there is no home folder."""
    import platformdirs

    return _own("config") or _whole(platformdirs.user_config_path(NAME, appauthor=False))


def state_folder() -> Path:
    """Of the session. InputError where there is no home folder."""
    import platformdirs

    return _own("state") or _whole(platformdirs.user_state_path(NAME, appauthor=False))


def data_folder() -> Path:
    """Of the materials that were fitted in the window. InputError where there is no home folder."""
    import platformdirs

    return _own("data") or _whole(platformdirs.user_data_path(NAME, appauthor=False))


def _own(folder: str) -> Path | None:
    home = os.environ.get(VARIABLE, "")
    return Path(home).absolute() / folder if home else None


def _whole(path: Path) -> Path:
    """The path, unless it would lie in whatever folder the program was started from."""
    if not path.is_absolute():
        raise InputError(f"there is no home folder for settings; set {VARIABLE} to a folder")
    return path
