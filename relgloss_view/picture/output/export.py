"""Frames to files, by the ending of the file's name: PNG for the eye, OpenEXR for computing."""

from __future__ import annotations

import os
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.picture.displayed import Displayed
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.output.exr import save_exr
from relgloss_view.picture.output.png import save_png

SUFFIXES = (".png", ".exr")


def check_suffix(path: str | os.PathLike[str]) -> Path:
    """The path, if its ending names a format that is written; InputError otherwise."""
    file = Path(path)
    if file.suffix.lower() not in SUFFIXES:
        raise InputError(f"{file}: expected a name that ends in {' or '.join(SUFFIXES)}")
    return file


def save_frame(
    frame: Frame,
    path: str | os.PathLike[str],
    command: str = "",
    *,
    bits: int = 8,
    displayed: Displayed | None = None,
) -> None:
    """Write a frame as PNG or OpenEXR, by the ending of its name."""
    file = check_suffix(path)
    if file.suffix.lower() == ".png":
        save_png(frame, file, command, bits, displayed)
    else:
        save_exr(frame, file, command, displayed)
