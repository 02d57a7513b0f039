"""Temporary folders that no killed program leaves for ever.

Each is locked (flock) by its program. The kernel drops the lock when the program ends, however it
ends, so a folder without one has nobody: the next program that writes there removes it. A folder
lies beside the file that is written, or in the system's folder for temporary files (TMPDIR).

Where the file system has no such locks (some network drives) nothing is removed but by the program
that made it.
"""

from __future__ import annotations

import contextlib
import errno
import os
import secrets
import shutil
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path

from relgloss_view.base.errors import InputError

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

PREFIX, SUFFIX = ".relgloss-", ".part"
MOST_TRIES = 100
PRIVATE = 0o700
TAKEN = -1  #: in place of a handle: another program has the folder

_held: set[str] = set()  #: the folders of this program
_swept: set[str] = set()  #: where this program has looked for what others left


@contextlib.contextmanager
def scratch_folder() -> Iterator[Path]:
    """A folder in the system's for temporary files, removed with its content at the end.

    Raises InputError where none can be made.
    """
    with contextlib.ExitStack() as stack:
        try:
            folder = stack.enter_context(held_folder(tempfile.gettempdir()))
        except OSError as error:
            raise InputError(
                f"no temporary folder can be made ({error.strerror or error}); set TMPDIR to a "
                "folder that can be written"
            ) from error
        yield folder


@contextlib.contextmanager
def held_folder(base: str | os.PathLike[str]) -> Iterator[Path]:
    """A folder in the folder `base`, private and empty, removed with its content at the end.

    It may be renamed away, and then stays. Leftovers of killed programs in `base` are removed
    first. Raises OSError where the place can't be written.
    """
    place = os.fspath(base)
    sweep(place)
    for _ in range(MOST_TRIES):
        path = os.path.join(place, f"{PREFIX}{secrets.token_hex(6)}{SUFFIX}")
        with _removed_at_the_end(path) as lock:
            if lock != TAKEN:
                yield Path(path)
                return
    raise FileExistsError(errno.EEXIST, "no free name for a temporary folder")


@contextlib.contextmanager
def _removed_at_the_end(path: str) -> Iterator[int | None]:
    """Make a folder and lock it; the lock, None without such locks, or TAKEN."""
    lock: int | None = TAKEN
    ours = True  # before it is made, for a signal may come in between
    try:
        _held.add(path)
        try:
            os.mkdir(path, PRIVATE)
            lock = _lock(path)
        except FileExistsError:
            ours = False
        # Another program may have taken it for a leftover before it was locked.
        if lock is not None and lock != TAKEN and not _is_at(lock, path):
            os.close(lock)
            lock = TAKEN
        yield lock
    finally:
        if ours:
            shutil.rmtree(path, ignore_errors=True)
        if lock is not None and lock != TAKEN:
            os.close(lock)
        _held.discard(path)  # last: until then `remove_all` removes it, should a signal come here


def sweep(base: str | os.PathLike[str]) -> None:
    """Remove the temporary folders in `base` whose programs are gone; once for each place."""
    place = os.fspath(base)
    if fcntl is None or place in _swept:
        return
    _swept.add(place)
    with contextlib.suppress(OSError, ValueError), os.scandir(place) as entries:
        for entry in entries:
            if is_temporary(entry.name):
                _remove_leftover(entry.path)


def is_temporary(name: str) -> bool:
    """Whether a name is one of these folders'."""
    return name.startswith(PREFIX) and name.endswith(SUFFIX)


def remove_all() -> None:
    """Remove the folders of this program, before an end that leaves no with-block."""
    for path in tuple(_held):
        shutil.rmtree(path, ignore_errors=True)


def _remove_leftover(path: str) -> None:
    lock = _lock(path)
    if lock is None or lock == TAKEN:
        return
    try:
        if _is_at(lock, path) and os.fstat(lock).st_uid == os.geteuid():
            shutil.rmtree(path, ignore_errors=True)
    finally:
        os.close(lock)


def _lock(path: str) -> int | None:
    """A handle that holds the lock of a folder; TAKEN by another, None where there are no locks."""
    if fcntl is None:
        return None
    try:
        handle = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    except OSError:
        return TAKEN
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(handle)
        return TAKEN
    except OSError:
        os.close(handle)
        return None
    return handle


def _is_at(handle: int, path: str) -> bool:
    """Whether an open folder is still the one of that name."""
    try:
        there = os.stat(path, follow_symlinks=False)
    except OSError:
        return False
    return stat.S_ISDIR(there.st_mode) and os.path.samestat(there, os.fstat(handle))
