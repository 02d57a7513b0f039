"""What output asks of the file system: on the disk before it counts, in place in one step.

Exchanging two names needs Linux (renameat2) and a file system that knows it; everything else here
works on any system, and does the next best thing where a call is not to be had.
"""

from __future__ import annotations

import contextlib
import errno
import os
import stat
from collections.abc import Callable
from functools import cache
from pathlib import Path

AT_FDCWD = -100
NO_REPLACE, EXCHANGE = 1, 2  #: flags of renameat2
#: What a file system answers that does not know a call, or can't do it there.
UNKNOWN = {errno.EINVAL, errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP}
#: What it answers where a call is known, and another way may still be open.
REFUSED = UNKNOWN | {errno.EPERM, errno.EACCES, errno.EBUSY, errno.EXDEV, errno.EMLINK}

Identity = tuple[int, int, int]  #: which file it is, whatever its name


def sync(path: str | os.PathLike[str]) -> None:
    """Bring a file or folder to the disk; OSError where the disk is full or broken."""
    flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_CLOEXEC", 0)
    try:
        handle = os.open(path, flags)
    except PermissionError:  # written by us, but its mode lets nobody read it
        return
    try:
        os.fsync(handle)
    except OSError as error:
        if error.errno not in UNKNOWN:  # some network drives have no such call
            raise
    finally:
        os.close(handle)


def sync_tree(folder: Path) -> None:
    """Bring a folder with all its files to the disk, the folder last."""
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.is_dir(follow_symlinks=False):
                sync_tree(Path(entry.path))
            elif entry.is_file(follow_symlinks=False):
                sync(entry.path)
    sync(folder)


def identity(path: str | os.PathLike[str]) -> Identity | None:
    """The same for a file as long as nobody writes it, wherever it is moved; None for no file."""
    try:
        there = os.lstat(path)
    except (FileNotFoundError, NotADirectoryError):
        return None
    if stat.S_ISDIR(there.st_mode):  # its times change with what is in it
        return there.st_ino, 0, 0
    return there.st_ino, there.st_mtime_ns, there.st_size


def exchange(one: str | os.PathLike[str], other: str | os.PathLike[str]) -> None:
    """Exchange two names in one step; OSError with an errno in REFUSED where that can't be."""
    _renameat2(one, other, EXCHANGE)


def move_new(source: str | os.PathLike[str], target: str | os.PathLike[str]) -> None:
    """Rename to a name that nothing has; FileExistsError where something has it."""
    try:
        _renameat2(source, target, NO_REPLACE)
        return
    except OSError as error:
        if error.errno not in UNKNOWN:
            raise
    if os.path.isdir(source):
        if os.path.lexists(target):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), os.fspath(target))
        os.rename(source, target)
        return
    try:
        os.link(source, target, follow_symlinks=False)
    except FileExistsError:
        raise
    except (OSError, NotImplementedError):  # no links either: take the name, then fill it
        os.close(os.open(target, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600))
        os.replace(source, target)
    else:
        os.unlink(source)


def keep_attributes(old: str | os.PathLike[str], new: str | os.PathLike[str]) -> None:
    """Give a new file or folder the mode, owner and access list of the one that it replaces.

    As far as that is permitted: where the group can't be kept, it gets no more than all others.
    """
    before, now = os.stat(old), os.stat(new)
    mode = before.st_mode & (0o3777 if stat.S_ISDIR(before.st_mode) else 0o777)
    if hasattr(os, "chown"):
        if before.st_uid != now.st_uid:
            with contextlib.suppress(OSError):
                os.chown(new, before.st_uid, -1)
        if before.st_gid != now.st_gid:
            try:
                os.chown(new, -1, before.st_gid)
            except OSError:
                mode = mode & ~0o070 | (mode & 0o007) << 3
    if mode != stat.S_IMODE(now.st_mode):
        os.chmod(new, mode)
    if hasattr(os, "listxattr"):
        with contextlib.suppress(OSError):
            for name in os.listxattr(old):
                if name.startswith(("user.", "system.posix_acl_")):
                    with contextlib.suppress(OSError):
                        os.setxattr(new, name, os.getxattr(old, name))


def may_be_exchanged(folder: Path) -> bool:
    """Whether a folder may be replaced by another one.

    Not where somebody works in it, whose terminal would be left in a folder that is gone; not where
    it is the root of a file system.
    """
    try:
        parent = os.lstat(folder.parent)
        if os.lstat(folder).st_dev != parent.st_dev or os.path.ismount(folder):
            return False
        return os.access(folder.parent, os.W_OK | os.X_OK) and not _is_worked_in(folder)
    except OSError:
        return False


def _is_worked_in(folder: Path) -> bool:
    """Whether it is the working folder, or above that, of a process that one may look at."""
    inside = os.fspath(folder) + os.sep
    places = []
    with contextlib.suppress(OSError):
        places.append(os.getcwd())
    with contextlib.suppress(OSError):
        for number in os.listdir("/proc"):
            if number.isdigit():
                with contextlib.suppress(OSError):
                    places.append(os.readlink(f"/proc/{number}/cwd"))
    return any((place + os.sep).startswith(inside) for place in places)


def _renameat2(one: str | os.PathLike[str], other: str | os.PathLike[str], flags: int) -> None:
    call = _call_of_renameat2()
    if call is None:
        raise OSError(errno.ENOSYS, os.strerror(errno.ENOSYS))
    number = call(os.fsencode(one), os.fsencode(other), flags)
    if number:
        raise OSError(number, os.strerror(number), os.fspath(one), None, os.fspath(other))


@cache
def _call_of_renameat2() -> Callable[[bytes, bytes, int], int] | None:
    """The C library's function; it returns an errno. None where there is none."""
    import ctypes

    try:
        function = ctypes.CDLL(None, use_errno=True).renameat2
    except (AttributeError, OSError, TypeError):
        return None
    name, number = ctypes.c_char_p, ctypes.c_int
    function.argtypes = (number, name, number, name, ctypes.c_uint)
    function.restype = number

    def call(one: bytes, other: bytes, flags: int) -> int:
        failed = function(AT_FDCWD, one, AT_FDCWD, other, flags)
        return ctypes.get_errno() if failed else 0

    return call
