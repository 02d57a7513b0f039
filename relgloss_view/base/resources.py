"""Where shaders/, assets/ and docs/ lie: in an installed wheel, or at the top of a source tree."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from relgloss_view.base.errors import InputError


@lru_cache(maxsize=1)
def data_root() -> Path:
    """The folder that holds shaders/ and assets/."""
    package = Path(__file__).resolve().parent.parent
    for root in (package / "_data", package.parent):
        if (root / "shaders").is_dir() and (root / "assets").is_dir():
            return root
    raise InputError(f"{package}: shaders and assets are missing; install relgloss-view again")


def asset(*parts: str) -> Path:
    """Path of a file under assets/."""
    return data_root().joinpath("assets", *parts)
