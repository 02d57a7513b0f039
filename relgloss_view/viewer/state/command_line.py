"""A side's picture as the `relgloss snapshot` line that draws it again."""

from __future__ import annotations

import os

from relgloss_view.base.shell import command_line, option
from relgloss_view.operators.registry import DEFAULT_OPERATOR
from relgloss_view.picture.scene.options import pasted_name, sample_words, scene_words
from relgloss_view.viewer.state.state import State


def snapshot_command(
    state: State, side: str, size: tuple[int, int], output: str | os.PathLike[str]
) -> str:
    """The line, quoted for a POSIX shell, that draws a side's picture exactly as it is.

    size: width, height in pixels. output: the PNG or OpenEXR file that the line writes. Files are
    named in full, so that the line works in any folder. Raises InputError where the sample is in
    no file, its file is gone or a name is not UTF-8 and could not be pasted.
    """
    shown = state.side(side)
    words = ["relgloss", "snapshot", *sample_words(shown.sample)]
    words += scene_words(state.scene(side).setup, shown.look)  # with a pack's own form
    operator = state.presentation.operator(side)
    words += ["--operator", operator] if operator != DEFAULT_OPERATOR else []
    words += ["--size", f"{size[0]}x{size[1]}"]
    name = pasted_name(os.fspath(output))
    words += option("--output", name) if name.startswith("-") else ["-o", name]
    return command_line(words)
