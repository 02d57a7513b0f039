"""The materials that were fitted in the window, each in a file that is never replaced."""

from __future__ import annotations

import contextlib
import itertools
import os
import re
import tempfile
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.writing import make_folder
from relgloss_view.material.files import save_material
from relgloss_view.material.material import Material

LONGEST_NAME = 40  #: characters; each may be four bytes of the 255 that a file's name may have


def keep_material(material: Material, folder: Path) -> Path:
    """Save a material under a new name, made from its own; returns the file. Raises InputError."""
    make_folder(folder)
    try:
        handle, reserved = tempfile.mkstemp(prefix=".fitted.", suffix=".json", dir=folder)
        os.close(handle)
    except OSError as error:
        raise _unwritable(folder, error) from error
    temporary = Path(reserved)
    try:
        save_material(material, temporary)
        return _move(temporary, folder, safe_name(material.name))
    except OSError as error:
        raise _unwritable(folder, error) from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def safe_name(name: str) -> str:
    """A name of letters, digits, dots and hyphens that any file system takes."""
    safe = re.sub(r"[^\w.-]+", "-", name).strip("._-")[:LONGEST_NAME].strip("._-")
    return safe or "material"


def _move(temporary: Path, folder: Path, name: str) -> Path:
    """Give a finished file the first free name. Taking it and filling it are two steps: not every
    file system can link, and a rename alone replaces what another window has just written.
    """
    for number in itertools.count(1):
        file = folder / f"{name}-{number}.json"
        try:
            file.open("xb").close()
        except FileExistsError:
            continue
        try:
            os.replace(temporary, file)
        except BaseException:
            file.unlink(missing_ok=True)
            raise
        return file
    raise AssertionError("there is always a next number")


def _unwritable(folder: Path, error: OSError) -> InputError:
    return InputError(f"{folder}: can't be written ({error.strerror or error})")
