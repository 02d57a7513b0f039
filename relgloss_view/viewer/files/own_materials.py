"""Materials that the window writes, each into a file of its own that is never replaced."""

from __future__ import annotations

import contextlib
import itertools
import os
import re
from collections.abc import Iterator
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.file_system import move_new, sync
from relgloss_view.base.temporaries import held_folder
from relgloss_view.base.writing import make_folder
from relgloss_view.material.files import load_material, save_material
from relgloss_view.material.material import Material

MOST_BESIDE = 10_000  #: files of one name beside a scene
LONGEST_NAME = 40  #: characters; each may be four bytes of the 255 that a file's name may have


def keep_material(material: Material, folder: Path) -> Path:
    """Save a material under a new name, made from its own; returns the file. Raises InputError."""
    make_folder(folder)
    name = safe_name(material.name)
    return _saved(material, folder, (f"{name}-{number}.json" for number in itertools.count(1)))


def keep_beside(material: Material, scene: Path) -> tuple[Path, bool]:
    """The file of a material beside a scene, and whether it was written now. Raises InputError.

    It is called `<scene>-<material>.json`, with a number where another file has that name. A file
    that already holds the material is taken as it is, so that a scene can be saved again and again.
    """
    stem = f"{scene.stem[:LONGEST_NAME]}-{safe_name(material.name)}"
    names = [f"{stem}.json", *(f"{stem}-{number}.json" for number in range(2, MOST_BESIDE))]
    for name in names:
        file = scene.parent / name
        if not os.path.lexists(file):
            break
        with contextlib.suppress(InputError):
            if load_material(file) == material:
                return file, False
    return _saved(material, scene.parent, iter(names)), True


def _saved(material: Material, folder: Path, names: Iterator[str]) -> Path:
    """Save a material under the first of the names that is free."""
    try:
        with held_folder(folder) as held:
            temporary = held / "fitted.json"
            save_material(material, temporary)
            return _move(temporary, folder, names)
    except OSError as error:
        raise _unwritable(folder, error) from error


def safe_name(name: str) -> str:
    """A name of letters, digits, dots and hyphens that any file system takes."""
    safe = re.sub(r"[^\w.-]+", "-", name).strip("._-")[:LONGEST_NAME].strip("._-")
    return safe or "material"


def _move(temporary: Path, folder: Path, names: Iterator[str]) -> Path:
    """Give a finished file the first free name, which no other window has taken."""
    for name in names:
        file = folder / name
        try:
            sync(temporary)
            move_new(temporary, file)
            sync(folder)
        except FileExistsError:
            continue
        return file
    raise InputError(f"{folder}: every name for the material is taken; choose another folder")


def _unwritable(folder: Path, error: OSError) -> InputError:
    return InputError(f"{folder}: can't be written ({error.strerror or error})")
