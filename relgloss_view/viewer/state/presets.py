"""Presets: looks by name. The paper's published optima are built in; the user's own are in a file.

The file is TOML, one table a preset with the entries of [look]. A damaged file is never written
over: saving refuses until it is mended or moved away.
"""

from __future__ import annotations

import os
import unicodedata
from dataclasses import dataclass, replace
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.toml import entries, read_toml, write_toml
from relgloss_view.base.writing import make_folder
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES
from relgloss_view.picture.scene.scene_file import MAX_BYTES, build
from relgloss_view.viewer.state.places import config_folder

LONGEST_NAME = 60  #: characters
MOST = 500
EXPECTED = "a presets file (TOML)"


@dataclass(frozen=True)
class Preset:
    """A look and its name; InputError for a name that can't be displayed."""

    name: str
    look: Look

    def __post_init__(self) -> None:
        name = unicodedata.normalize("NFC", self.name).strip()
        if not (1 <= len(name) <= LONGEST_NAME and name.isprintable()):
            raise InputError(
                f"preset {printable(self.name, 80)!r}: expected a name of 1 to {LONGEST_NAME} "
                "printable characters"
            )
        object.__setattr__(self, "name", name)


Presets = tuple[Preset, ...]


def presets_file() -> Path:
    """Where the user's own presets are kept."""
    return config_folder() / "presets.toml"


def built_in() -> Presets:
    """The settings that the paper's observers chose for each kind of paper."""
    return tuple(
        Preset(published_name(sample), Look().at(setting)) for sample, setting in SAMPLES.items()
    )


def published_name(sample: str) -> str:
    """The name of the built-in preset of a sample, which no sample has."""
    return f"Published: {sample}"


def load(path: str | os.PathLike[str]) -> Presets:
    """The presets of a file, none where there is none; InputError, one line, if it is damaged."""
    if not os.path.lexists(path):
        return ()
    presets: Presets = ()
    tables = read_toml(path, MAX_BYTES, EXPECTED)
    try:
        for name, values in tables.items():
            look = build("look", values, f"{printable(name, 80)}: ")
            # A name that a later version builds in stays the user's.
            presets = _appended(presets, Preset(name, look))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return presets


def save(path: str | os.PathLike[str], presets: Presets) -> None:
    """Write the user's presets, whole or not at all.

    InputError where the place can't be written or the file that is there is damaged. Another window
    may have written since they were loaded: load, change and save in one go.
    """
    try:
        load(path)
    except InputError as error:
        raise InputError(f"{error}; mend it or move it away, it is not written over") from error
    make_folder(Path(path).parent)
    write_toml(path, {preset.name: entries(preset.look) for preset in presets})


def find(presets: Presets, name: str) -> Preset | None:
    """The preset of a name."""
    return next((preset for preset in presets if preset.name == name), None)


def add(presets: Presets, name: str, look: Look) -> Presets:
    """The presets with one more at the end; InputError if the name is taken or can't be."""
    preset = Preset(name, look)
    _check_not_built_in(preset.name)
    return _appended(presets, preset)


def rename(presets: Presets, old: str, new: str) -> Presets:
    """The presets with one renamed, in its place; InputError as add, or if there is no `old`."""
    present = _existing(presets, old)
    renamed = replace(present, name=new)
    if renamed.name != present.name:
        _check_not_built_in(renamed.name)
        _check_free(presets, renamed.name)
    return tuple(renamed if preset is present else preset for preset in presets)


def remove(presets: Presets, name: str) -> Presets:
    """The presets without one; InputError if there is none of that name."""
    present = _existing(presets, name)
    return tuple(preset for preset in presets if preset is not present)


def _existing(presets: Presets, name: str) -> Preset:
    preset = find(presets, name)
    if preset is None:
        raise InputError(f"preset {printable(name, 80)!r}: there is none of that name")
    return preset


def _appended(presets: Presets, preset: Preset) -> Presets:
    _check_free(presets, preset.name)
    if len(presets) >= MOST:
        raise InputError(f"there are {MOST} presets already; remove one first")
    return (*presets, preset)


def _check_free(presets: Presets, name: str) -> None:
    if find(presets, name) is not None:
        raise InputError(f"preset {name!r}: the name is taken; choose another")


def _check_not_built_in(name: str) -> None:
    if name in SAMPLES or name in map(published_name, SAMPLES):
        raise InputError(f"preset {name!r}: the name is that of a built-in one; choose another")
