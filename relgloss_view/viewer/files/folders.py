"""What a folder holds, as a file dialog lists it, and what a typed name means in it. No ImGui."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import open_regular, printable, unreadable
from relgloss_view.base.writing import check_target

LONGEST_NAME, LONGEST_MESSAGE = 50, 300  #: characters
LONGEST_TYPED = 4096
MOST_ENTRIES = 20_000  #: that are listed; the listing notes where there are more


@dataclass(frozen=True)
class Entry:
    """A file or a folder in a folder."""

    name: str
    is_folder: bool


@dataclass(frozen=True)
class Listing:
    """The entries of a folder, folders first, and whether there are more."""

    entries: tuple[Entry, ...]
    cut: bool = False


class NameField:
    """A file's name in a text field, which can't show every name that a file can have."""

    def __init__(self, name: str = "") -> None:
        self.text = ""  #: in the field
        self.put(name)

    def put(self, name: str) -> None:
        """Put a name into the field: escaped where it is not printable or not UTF-8."""
        self._exact = name
        self.text = self._written = printable(name, LONGEST_TYPED)

    @property
    def value(self) -> str:
        """The name in the field: the one put there, unless it was changed."""
        return self._exact if self.text == self._written else self.text.strip()


def natural_key(name: str) -> tuple[tuple[int, int, str], ...]:
    """A key by which sheet-2 comes before sheet-10, without regard to case."""
    parts = re.split(r"([0-9]+)", name.casefold())
    return tuple((0, int(p), "") if k % 2 else (1, 0, p) for k, p in enumerate(parts) if p)


def listing(folder: str, suffixes: tuple[str, ...] = (), *, hidden: bool = False) -> Listing:
    """The contents of a folder: folders, and files with one of the suffixes (without any, all).

    Names that begin with a dot are left out unless `hidden`. InputError, one line, for a folder
    that can't be read.
    """
    entries: list[Entry] = []
    cut = False
    try:
        with os.scandir(folder) as inside:
            for item in inside:
                entry = _entry(item, suffixes, hidden)
                if entry is None:
                    continue
                if len(entries) == MOST_ENTRIES:
                    cut = True
                    break
                entries.append(entry)
    except (OSError, ValueError) as error:
        raise unreadable(folder, error, "a folder that can be read") from None
    entries.sort(key=lambda entry: (not entry.is_folder, natural_key(entry.name), entry.name))
    return Listing(tuple(entries), cut)


def meant(folder: str, typed: str) -> str:
    """The path that a typed name means: in the folder, in full, or from the home folder with ~."""
    return os.path.abspath(os.path.join(folder, os.path.expanduser(typed)))


def check_file(path: str) -> None:
    """InputError, one line, where a path is no file that can be opened."""
    try:
        if os.path.isdir(path):
            raise InputError(f"{path}: this is a folder; choose a file in it")
    except (OSError, ValueError) as error:
        raise unreadable(path, error, "a file") from None
    open_regular(path, "a file").close()


def check_place(path: str) -> bool:
    """Whether a file of this name is there already; InputError where none can be written."""
    check_target(path)
    parent = os.path.dirname(path)
    if not os.path.isdir(parent):
        raise InputError(f"{parent}: there is no such folder; choose one that is there")
    if not os.access(parent, os.W_OK):
        raise InputError(f"{parent}: nothing can be written here; choose another folder")
    return os.path.lexists(path)


def shortened(message: str, path: str) -> str:
    """A message in one line that names a path by its last part only, and not all of a long one."""
    name = os.path.basename(path) or path
    part = name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 1]}…"
    return printable(message.replace(path, part), LONGEST_MESSAGE)


def with_suffix(path: str, suffixes: tuple[str, ...]) -> str:
    """The path with the first of the suffixes added, unless it ends in one of them."""
    if not suffixes or Path(path).suffix.lower() in suffixes:
        return path
    return path + suffixes[0]


def _entry(item: os.DirEntry[str], suffixes: tuple[str, ...], hidden: bool) -> Entry | None:
    if item.name.startswith(".") and not hidden:
        return None
    try:
        is_folder = item.is_dir()
    except OSError:  # a loop of links
        is_folder = False
    if not is_folder and suffixes and Path(item.name).suffix.lower() not in suffixes:
        return None
    return Entry(item.name, is_folder)
