"""Writing files and folders so that they appear whole or not at all."""

from __future__ import annotations

import contextlib
import os
import shutil
import stat
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from relgloss_view.base.errors import InputError


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
    temporary = _reserve(target)
    try:
        yield temporary
        put(temporary, target)
    except OSError as error:
        raise _unwritable(path, error) from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


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
        temporary = Path(tempfile.mkdtemp(prefix=".relgloss-", dir=base))
    except (OSError, ValueError) as error:
        raise _unwritable(path, error) from error
    try:
        yield temporary
        if exists:
            _move_in(temporary, folder, last)
        else:
            folder.parent.mkdir(parents=True, exist_ok=True)
            os.chmod(temporary, 0o777 & ~_umask())  # mkdtemp makes private folders
            os.rename(temporary, folder)
    except OSError as error:
        raise _unwritable(path, error) from error
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _move_in(temporary: Path, folder: Path, last: str) -> None:
    names = sorted(p.name for p in temporary.iterdir())
    for name in names:
        check_target(folder / name)
    (folder / last).unlink(missing_ok=True)
    for name in sorted(names, key=lambda name: (name == last, name)):
        os.replace(temporary / name, folder / name)


def check_writable(path: str | os.PathLike[str]) -> None:
    """Raise InputError where `path` can't be written; call it before long work."""
    _reserve(check_target(path)).unlink(missing_ok=True)


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


def _reserve(target: Path) -> Path:
    try:
        handle, name = tempfile.mkstemp(
            prefix=f".{target.stem[:40]}.", suffix=target.suffix, dir=target.parent
        )
        os.close(handle)
        os.chmod(name, 0o666 & ~_umask())  # mkstemp makes private files; results are ordinary ones
    except (OSError, ValueError) as error:
        raise _unwritable(target, error) from error
    return Path(name)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _unwritable(path: str | os.PathLike[str], error: OSError | ValueError) -> InputError:
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return InputError(f"{path}: can't be written ({reason}); choose another place")
