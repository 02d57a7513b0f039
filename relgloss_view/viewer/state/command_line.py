"""A side's picture as the `relgloss snapshot` line that draws it again."""

from __future__ import annotations

import ast
import dataclasses
import os
import shlex
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.toml import AUTO, plain
from relgloss_view.material.spectra import is_lamp_name
from relgloss_view.operators.registry import DEFAULT_OPERATOR
from relgloss_view.picture.scene.scene_file import TABLES
from relgloss_view.picture.scene.scene_writer import check_sample
from relgloss_view.viewer.state.state import State
from relgloss_view.viewer.state.state_file import scene_sample

#: Entries of the look that have an option of their own.
_OPTIONS = {
    "sigma_n_deg": "--sigma-n",
    "c": "--c",
    "c_fraction": "--c-fraction",
    "seed": "--seed",
    "samples": "--samples",
}


def snapshot_command(
    state: State, side: str, size: tuple[int, int], output: str | os.PathLike[str]
) -> str:
    """The line, quoted for a POSIX shell, that draws a side's picture exactly as it is.

    size: width, height in pixels. output: the PNG or OpenEXR file that the line writes. Files are
    named in full, so that the line works in any folder. Raises InputError where the sample is in
    no file, its file is gone or a name is not UTF-8 and could not be pasted.
    """
    words = ["relgloss", "snapshot", *_sample(state, side)]
    parts = {name: getattr(state, name) for name in TABLES if name != "look"}
    parts["look"] = state.side(side).look
    for name, option in _OPTIONS.items():
        value = getattr(parts["look"], name)
        if value is not None:
            words += [option, repr(plain(value))]
        elif name == "samples":
            words += [option, AUTO]
    operator = state.presentation.operator(side)
    words += ["--operator", operator] if operator != DEFAULT_OPERATOR else []
    words += ["--size", f"{size[0]}x{size[1]}"]
    for table, part in parts.items():
        for f in dataclasses.fields(part):
            value = getattr(part, f.name)
            if value != f.default and not (table == "look" and f.name in _OPTIONS):
                words += ["--set", f"{table}.{f.name}={_setting(f.name, value)}"]
    words += _option("-o", "--output", _text(os.fspath(output)))
    return shlex.join(words)


def _sample(state: State, side: str) -> list[str]:
    sample = state.side(side).sample
    check_sample(scene_sample(sample))
    if sample.name is not None:
        return ["--sample", sample.name]
    return _option("--material", "--material", _text(str(Path(str(sample.file)).absolute())))


def _option(short: str, long: str, value: str) -> list[str]:
    """An option with a value that may begin as an option does."""
    return [f"{long}={value}"] if value.startswith("-") else [short, value]


def _setting(name: str, value: object) -> str:
    """A value as `--set` reads it back."""
    if not isinstance(value, str):
        return AUTO if value is None else repr(plain(value))
    if name == "illuminant" and not is_lamp_name(value):
        value = _text(str(Path(value).absolute()))
    try:
        ast.literal_eval(value)
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        return value  # a bare word stays one
    return repr(value)


def _text(name: str) -> str:
    """A file's name, if a line of text can hold it."""
    try:
        name.encode("utf-8")
    except UnicodeEncodeError:
        raise InputError(
            f"{printable(name)}: not UTF-8, so no command can name it; rename the file"
        ) from None
    return name
