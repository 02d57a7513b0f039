"""The files of `relgloss display`: which kind each is, and what it holds."""

from __future__ import annotations

import os

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable, read_beginning
from relgloss_view.commands import outputs

PROFILE, DISPLAY_FILE, READINGS = "profile", "display file", "readings"
EXPECTED = (
    "an ICC profile, a display file, or readings of a display (.ti3, or CSV with R,G,B,X,Y,Z)"
)
HEAD = 4096  #: bytes that show which kind a file is
SUFFIXES = (".icc", ".icm")


def kind_of(path: str) -> str:
    """PROFILE, DISPLAY_FILE or READINGS, by content; a damaged profile by its name. InputError."""
    from relgloss_view.display.display_file import is_display_file

    head = read_beginning(path, HEAD, EXPECTED)
    if head[36:40] == b"acsp" or path.lower().endswith(SUFFIXES):
        return PROFILE
    if is_display_file(head):
        return DISPLAY_FILE
    if path.lower().endswith(".toml"):
        raise InputError(
            f"{printable(path)}: not a display file; expected {EXPECTED} (of a scene, give the "
            "file that its [display] names)"
        )
    return READINGS


def check_output(output: str | None, sources: list[str]) -> None:
    """InputError where a display file can't be written, or would replace what it comes from."""
    if output is None:
        return
    outputs.check_output(output, sources, ".toml")


def beside(output: str, profile: str) -> str:
    """The profile's name beside a display file; InputError where it lies elsewhere."""
    folder = os.path.dirname(os.path.abspath(output))
    if os.path.realpath(os.path.dirname(os.path.abspath(profile))) != os.path.realpath(folder):
        raise InputError(
            f"-o {printable(output)}: a display file names the profile beside it; write it into "
            f"the folder of {printable(profile)}, or copy the profile first"
        )
    return os.path.basename(profile)
