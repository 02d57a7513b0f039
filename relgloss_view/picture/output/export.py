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
    shown: Displayed | None = None,
) -> None:
    """Write a frame as PNG or OpenEXR, by the ending of its name.

    path: ends in .png or .exr. The file appears whole or not at all.
    command: the command line that reproduces the picture; it goes into the file.
    bits: of a channel of a PNG, 8 or 16.
    displayed: the picture of another operator than the split. shown: its former name.

    Raises InputError where the ending is another one or the file can't be written. Layers and
    headers are listed in docs/files.md.

    >>> from relgloss_view import Look, Scene, load_sample, open_renderer
    >>> with open_renderer("reference") as renderer:
    ...     frame = renderer.render(Scene(load_sample("art-coated")), Look(samples=1), (24, 24))
    ...     save_frame(frame, "art.png")
    >>> Path("art.png").read_bytes()[1:4]
    b'PNG'
    >>> save_frame(frame, "art.jpg")
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: art.jpg: expected a name that ends in .png or .exr
    """
    file = check_suffix(path)
    displayed = displayed or shown
    if file.suffix.lower() == ".png":
        save_png(frame, file, command, bits, displayed)
    else:
        save_exr(frame, file, command, displayed)
