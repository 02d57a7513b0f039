"""Writing files and folders so that they appear whole or not at all.

What is not whole yet lies in a temporary folder beside its place (temporaries.py), so a program
that was killed leaves nothing that the next one does not remove.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import stat
from collections.abc import Callable, Iterator
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.temporaries import held_folder, scratch_folder


@contextlib.contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary path beside `path`, which replaces `path` when the block ends without error.

    On any exception the temporary file is removed and `path` keeps its content. A symbolic link
    stays one: its target is written. Raises InputError where the place can't be written.

    >>> with whole_file("numbers.txt") as temporary:
    ...     _ = temporary.write_text("1 2 3")
    >>> Path("numbers.txt").read_text()
    '1 2 3'
    """
    with _put_in_place(path, os.replace) as temporary:
        yield temporary


@contextlib.contextmanager
def fresh_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """As whole_file, for a new name: an existing file is never replaced.

    Raises InputError where the name exists when the block begins or ends.
    """
    taken = InputError(f"{path}: is there already; choose another name")

    def put(temporary: Path, target: Path) -> None:
        try:
            os.link(temporary, target)
        except FileExistsError:
            raise taken from None
        except OSError:  # a file system without links: the check below has to do
            os.rename(temporary, target)

    if os.path.lexists(check_target(path)):
        raise taken
    with _put_in_place(path, put) as temporary:
        yield temporary


@contextlib.contextmanager
def _put_in_place(
    path: str | os.PathLike[str], put: Callable[[Path, Path], None]
) -> Iterator[Path]:
    target = check_target(path)
    try:
        with held_folder(target.parent) as folder:
            temporary = folder / target.name
            _make_empty(temporary)
            yield temporary
            put(temporary, target)
    except (OSError, UnicodeError) as error:
        raise _unwritable(path, error) from error


@contextlib.contextmanager
def whole_folder(path: str | os.PathLike[str], last: str) -> Iterator[Path]:
    """A temporary folder, whose files move to `path` when the block ends without error.

    A new `path` appears at once with all its files. In an existing one, files of the same names are
    replaced. last: name of the file that lists the others; its old version is removed first and its
    new one is moved last. On any exception the temporary folder is removed with its files. Raises
    InputError where the place can't be written.
    """
    folder = _resolved(path)
    exists = _mode(path, folder) is not None
    base = folder if exists else next(p for p in folder.parents if os.path.lexists(p))
    try:
        with held_folder(base) as temporary:
            yield temporary
            if exists:
                _move_in(temporary, folder, last)
            else:
                folder.parent.mkdir(parents=True, exist_ok=True)
                os.chmod(temporary, 0o777 & ~_umask())  # a temporary folder is private
                os.rename(temporary, folder)
    except (OSError, UnicodeError) as error:
        raise _unwritable(path, error) from error


def _move_in(temporary: Path, folder: Path, last: str) -> None:
    names = sorted(p.name for p in temporary.iterdir())
    for name in names:
        check_target(folder / name)
    (folder / last).unlink(missing_ok=True)
    for name in sorted(names, key=lambda name: (name == last, name)):
        os.replace(temporary / name, folder / name)


def check_writable(path: str | os.PathLike[str]) -> None:
    """Raise InputError where `path` can't be written; call it before long work."""
    target = check_target(path)
    try:
        with held_folder(target.parent) as folder:
            _make_empty(folder / target.name)
    except (OSError, ValueError) as error:
        raise _unwritable(path, error) from error


def check_target(path: str | os.PathLike[str]) -> Path:
    """The path that a file of this name is written to, with links followed.

    Raises InputError for an empty name, a folder, a device and a pipe: only a regular file may be
    replaced.
    """
    if not os.fspath(path):
        raise InputError("an empty file name; give the name of the file to write")
    target = _resolved(path)
    mode = _mode(path, target)
    if mode is not None and stat.S_ISDIR(mode):
        raise InputError(f"{path}: is a folder; give the name of a file in it")
    if mode is not None and not stat.S_ISREG(mode):
        raise InputError(f"{path}: is not a regular file; choose another place")
    return target


@contextlib.contextmanager
def utf8_path(path: Path) -> Iterator[Path]:
    """A path that libraries take which know UTF-8 alone; what they write there goes to `path`."""
    try:
        os.fspath(path).encode("utf-8")
    except UnicodeEncodeError:
        with scratch_folder() as folder:
            written = folder / f"written{path.suffix if path.suffix.isascii() else ''}"
            yield written
            shutil.copyfile(written, path)
        return
    yield path


def make_folder(path: str | os.PathLike[str]) -> Path:
    """Make a folder and its parents, unless they exist; InputError where that is not possible."""
    folder = Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise _unwritable(folder, error) from error
    return folder


def _resolved(path: str | os.PathLike[str]) -> Path:
    try:
        return Path(os.path.realpath(path))
    except (OSError, ValueError) as error:  # ValueError: a NUL, a lone surrogate
        raise _unwritable(path, error) from error


def _mode(path: str | os.PathLike[str], target: Path) -> int | None:
    """The mode of the file or folder `target`; None where there is none. Errors name `path`."""
    try:
        return target.stat().st_mode
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:  # a loop of links, a name too long, no permission
        raise _unwritable(path, error) from error


def _make_empty(file: Path) -> None:
    """Make the file with the permissions of an ordinary result."""
    os.close(os.open(file, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _unwritable(path: str | os.PathLike[str], error: OSError | ValueError) -> InputError:
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return InputError(f"{path}: can't be written ({reason}); choose another place")
