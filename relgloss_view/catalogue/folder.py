"""The folder of a catalogue: its mark, and the lock that keeps a second build out."""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Iterator
from pathlib import Path

from relgloss_view.base.commit import errors_of
from relgloss_view.base.errors import InputError
from relgloss_view.base.json_files import read_mark
from relgloss_view.base.reading import named, printable
from relgloss_view.base.temporaries import PREFIX, sweep
from relgloss_view.catalogue.store import PART, put_whole
from relgloss_view.catalogue.tree import FORMAT, MARK, is_catalogue

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

VERSION = 1  #: of the folder's layout
LOCK = ".lock"


@contextlib.contextmanager
def claimed(output: str | os.PathLike[str], top: str) -> Iterator[Path]:
    """The folder of a catalogue, made where there is none, and locked for the length of a block.

    top: the tree's real path. Raises InputError where the folder may not be written to: it is the
    tree or lies above it, it is no catalogue and holds something, or another build is at work.
    """
    shown = os.fspath(output)
    if not shown:
        raise InputError("-o '': an empty name; give the name of the catalogue's folder")
    place = Path(os.path.realpath(output))
    if top == str(place) or top.startswith(str(place).rstrip(os.sep) + os.sep):
        raise InputError(
            f"-o {named(shown)}: holds the samples themselves; choose a folder for the catalogue "
            "alone"
        )
    with errors_of(shown):  # such as a name that is too long
        made = not place.exists()
    _check_content(place, shown)
    with errors_of(shown):
        place.mkdir(parents=True, exist_ok=True)
    with contextlib.ExitStack() as stack:
        if made:
            stack.callback(_remove_if_empty, place)
        stack.enter_context(_locked(place, shown))
        sweep(place, again=True)
        yield place


def write_mark(catalogue: Path) -> None:
    """Mark a folder as a catalogue, unless it is one."""
    if not is_catalogue(catalogue):
        for left in catalogue.glob(f".{MARK}.*{PART}"):
            left.unlink(missing_ok=True)
        content = {"format": FORMAT, "version": VERSION}
        put_whole(catalogue / MARK, json.dumps(content).encode() + b"\n", catalogue)


def _check_content(place: Path, shown: str) -> None:
    """InputError where a folder is there that is no catalogue of this version."""
    if not os.path.lexists(place):
        return
    if place.is_symlink():  # what links lead to was looked up: this one leads to itself
        raise InputError(f"-o {named(shown)}: is a link that leads nowhere; remove it")
    if not place.is_dir():
        raise InputError(f"-o {named(shown)}: is a file; give the name of a folder")
    if is_catalogue(place):
        version = read_mark(place / MARK).get("version")
        if version != VERSION:
            raise InputError(
                f"-o {named(shown)}: a catalogue of version {printable(version, 20)}, this program "
                f"writes {VERSION}; choose another folder, or update relgloss"
            )
        return
    try:
        names = os.listdir(place)
    except OSError as error:
        reason = error.strerror or error
        raise InputError(
            f"-o {named(shown)}: can't be read ({reason}); mend its permissions, or choose another "
            "folder"
        ) from error
    if any(not _is_ours(name) for name in names):
        raise InputError(
            f"-o {named(shown)}: holds files and is no catalogue; choose a new or an empty folder"
        )


def _is_ours(name: str) -> bool:
    """Whether a build that was killed before it marked its folder has left a name."""
    is_mark = name.startswith(f".{MARK}.") and name.endswith(PART)
    return name == LOCK or is_mark or name.startswith(PREFIX)


@contextlib.contextmanager
def _locked(place: Path, shown: str) -> Iterator[None]:
    if fcntl is None:
        yield
        return
    with errors_of(shown):
        handle = os.open(place / LOCK, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise InputError(
                f"-o {named(shown)}: another build works on it; wait for its end"
            ) from None
        except OSError:  # a file system without locks
            pass
        yield
    finally:
        os.close(handle)


def _remove_if_empty(place: Path) -> None:
    """Remove a folder that was made for nothing."""
    with contextlib.suppress(OSError):
        if set(os.listdir(place)) <= {LOCK}:
            with contextlib.suppress(FileNotFoundError):
                os.unlink(place / LOCK)
            os.rmdir(place)
