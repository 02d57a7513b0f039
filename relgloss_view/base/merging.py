"""A folder that takes another one's place brings along what the user has put into the old one.

The user's files are linked into the new folder before the two are exchanged, so that at no moment
one is missing. After the exchange the old folder is taken apart, name by name: a file that somebody
has written there meanwhile moves over, and nothing is removed that is not in the new folder.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import stat
from collections.abc import Callable, Collection
from pathlib import Path

from relgloss_view.base.file_system import keep_attributes, move_new

MOST_LINKED = 20_000  #: files of the user's; above that a folder is filled in place
MOST_ROUNDS = 5  #: in which files are looked for that come in meanwhile


class NotMergeable(Exception):
    """A folder holds what can't be in two folders at once; it has to be filled in place."""


def merge(
    old: Path, new: Path, left_out: Collection[str], is_foreign: Callable[[str], bool]
) -> int:
    """Link what is in a folder into another one, except for names `left_out`; the count of files.

    Sub-folders are made anew, with their modes, owners and times. is_foreign: names of what must
    stay where it is, at any depth. Raises NotMergeable.
    """
    if os.lstat(old).st_mode & stat.S_ISVTX:  # files of others there can't be removed
        raise NotMergeable(old)
    try:
        return _merge(old, new, left_out, is_foreign, os.lstat(old).st_dev)
    except (OSError, NotImplementedError) as error:  # the latter: links to links
        raise NotMergeable(old) from error


def _merge(
    old: Path, new: Path, left_out: Collection[str], is_foreign: Callable[[str], bool], device: int
) -> int:
    count = 0
    with os.scandir(old) as entries:
        for entry in entries:
            if entry.name in left_out:
                continue
            if is_foreign(entry.name):
                raise NotMergeable(entry.path)
            made = new / entry.name
            if entry.is_dir(follow_symlinks=False):
                # What can't be emptied afterwards stays where it is: another file system, a
                # folder without the right to write.
                if os.lstat(entry.path).st_dev != device or not os.access(
                    entry.path, os.W_OK | os.X_OK
                ):
                    raise NotMergeable(entry.path)
                made.mkdir(0o700)
                count += _merge(Path(entry.path), made, (), is_foreign, device)
                shutil.copystat(entry.path, made)
                keep_attributes(entry.path, made)
            else:
                os.link(entry.path, made, follow_symlinks=False)
                count += 1
            if count > MOST_LINKED:
                raise NotMergeable(old)
    return count


def take_apart(old: Path, new: Path, dropped: Collection[str]) -> bool:
    """Remove a folder that `new` has replaced; whether nothing of it is left.

    dropped: names in it that were the program's own. All else is in `new` already, or moves there.
    """
    for _ in range(MOST_ROUNDS):
        try:
            _empty(old, new, dropped)
            os.rmdir(old)
        except FileNotFoundError:
            return True
        except OSError:  # somebody has written into it once more, or it can't be emptied
            continue
        return True
    return False


def _empty(old: Path, new: Path, dropped: Collection[str]) -> None:
    with os.scandir(old) as entries:
        listed = list(entries)
    for entry in listed:
        stays = new / entry.name
        if entry.name in dropped:
            if entry.is_dir(follow_symlinks=False):
                shutil.rmtree(entry.path)
            else:
                os.unlink(entry.path)
        elif entry.is_dir(follow_symlinks=False) and stays.is_dir() and not stays.is_symlink():
            _empty(Path(entry.path), stays, ())
            os.rmdir(entry.path)
        else:
            _bring_over(Path(entry.path), stays)


def _bring_over(old: Path, new: Path) -> None:
    """Drop a file that the new folder has, too; move one that it has not, or has in an older state.

    The last happens where an editor has replaced it between linking and exchange.
    """
    with contextlib.suppress(FileExistsError):
        if not os.path.lexists(new):
            move_new(old, new)
            return
    before, now = os.lstat(old), os.lstat(new)
    if before.st_ino != now.st_ino and before.st_mtime_ns > now.st_mtime_ns:
        os.replace(old, new)
    else:
        os.unlink(old)
