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
NO_HOME = f"there is no home folder for settings; set {VARIABLE} to a folder"


def config_folder() -> Path:
    """Of the window's layout and the user's presets. InputError where there is no home folder."""
    return _own("config") or _by_the_system("user_config_path")


def state_folder() -> Path:
    """Of the session. InputError where there is no home folder."""
    return _own("state") or _by_the_system("user_state_path")


def data_folder() -> Path:
    """Of the materials that were fitted in the window. InputError where there is no home folder."""
    return _own("data") or _by_the_system("user_data_path")


def _own(folder: str) -> Path | None:
    home = os.environ.get(VARIABLE, "")
    return Path(home).absolute() / folder if home else None


def _by_the_system(kind: str) -> Path:
    """The system's folder of a kind, unless it would lie in whatever folder is the present one."""
    import platformdirs

    try:
        path = Path(getattr(platformdirs, kind)(NAME, appauthor=False))
    except (RuntimeError, KeyError, OSError, ValueError) as error:  # a user without an entry
        raise InputError(NO_HOME) from error
    if not path.is_absolute():
        raise InputError(NO_HOME)
    return path
