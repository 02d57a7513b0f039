"""Temporary folders that no killed program leaves for ever.

Each is locked (flock) by its program. The kernel drops the lock when the program ends, however it
ends, so a folder without one has nobody: the next program that comes there removes it, or finishes
what its journal lists (journal.py). A folder lies beside the file that is written, or in the
system's folder for temporary files (TMPDIR). Nothing temporary is made in another way.

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
import time
from collections.abc import Collection, Iterable, Iterator
from pathlib import Path
from typing import BinaryIO

from relgloss_view.base import journal
from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import pause

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

PREFIX, SUFFIX = ".relgloss-", ".part"
MOST_TRIES = 100
PRIVATE = 0o700
TAKEN = -1  #: in place of a handle: another program has the folder
SWEPT_S = 10.0  #: so long a place is not looked at again
LOCK_WAIT_S, LOCK_RETRY_S = 20.0, 0.02
#: Where Python looks for a place too, after the variables.
TEMPORARY_PLACES = ("/tmp", "/var/tmp", "/usr/tmp")
TEMPORARY_VARIABLES = ("TMPDIR", "TEMP", "TMP")

Place = tuple[int, int]  #: device and number of a folder

_held: set[str] = set()  #: the folders of this program
_chosen: str | None = None  #: the place that tempfile was given
_swept: dict[str, float] = {}  #: when this program has looked for what others left, by place


@contextlib.contextmanager
def scratch_folder() -> Iterator[Path]:
    """A folder in the system's for temporary files, removed with its content at the end.

    Raises InputError where none can be made.
    """
    fault: OSError | None = None
    with contextlib.ExitStack() as stack:
        for place in temporary_places():
            try:
                folder = stack.enter_context(held_folder(place))
            except OSError as error:
                fault = fault or error
            else:
                break
        else:
            raise no_temporary_folder(fault)
        yield folder


@contextlib.contextmanager
def scratch_file() -> Iterator[BinaryIO]:
    """A file without a name, to be written and read; it is gone when it is closed."""
    with contextlib.ExitStack() as stack:
        with scratch_folder() as folder:
            file = stack.enter_context((folder / "file").open("w+b"))
        yield file


def temporary_places() -> list[str]:
    """Folders for temporary files, best first; none is tried by writing, as tempfile does."""
    if tempfile.tempdir not in (None, _chosen):  # a program that uses the package has chosen
        return [os.path.realpath(str(tempfile.tempdir))]
    named = [os.environ.get(name) for name in TEMPORARY_VARIABLES]
    places = [os.path.realpath(name) for name in (*named, *TEMPORARY_PLACES, os.curdir) if name]
    usable = [p for p in places if os.path.isdir(p) and os.access(p, os.W_OK | os.X_OK)]
    return list(dict.fromkeys(usable))


def prepare(words: Iterable[str]) -> None:
    """What every command begins with: what killed programs have left around is removed.

    words: the command line. The folders that it names are swept, those of its files, and TMPDIR.
    """
    global _chosen
    places = temporary_places()
    if tempfile.tempdir is None and places:
        # Python would try the folder by a file, which stays there if it is killed just then.
        tempfile.tempdir = _chosen = places[0]
    named = {os.path.realpath(os.curdir), *places[:1]}
    for word in words:
        for name in {word, word.partition("=")[2]}:
            with contextlib.suppress(OSError, ValueError):
                real = os.path.realpath(name)
                named.update((real, os.path.dirname(real)))
    for place in sorted(named):
        sweep(place)


def is_no_folder(error: OSError) -> bool:
    """Whether a library has found no folder for temporary files: tempfile's error, by its words."""
    return error.errno == errno.ENOENT and "temporary directory" in str(error.strerror)


def no_temporary_folder(error: OSError | None = None) -> InputError:
    """What to do where no temporary file can be made."""
    reason = "there is no folder for it" if error is None else error.strerror or error
    return InputError(
        f"no temporary folder can be made ({reason}); set TMPDIR to a folder that can be written"
    )


@contextlib.contextmanager
def held_folder(base: str | os.PathLike[str]) -> Iterator[Path]:
    """A folder in the folder `base`, private and empty, removed with its content at the end.

    It may be renamed away, and then stays. Leftovers of killed programs in `base` are removed
    first. Raises OSError where the place can't be written.
    """
    place = os.path.abspath(base)
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
            _remove(path)
        if lock is not None and lock != TAKEN:
            os.close(lock)
        _held.discard(path)  # last: until then `remove_all` removes it, should a signal come here


def is_held(path: str | os.PathLike[str]) -> bool:
    """Whether a path lies in a temporary folder of this program."""
    return any(str(parent) in _held for parent in Path(path).parents)


def held_in(folder: str | os.PathLike[str]) -> list[str]:
    """Names of this program's temporary folders in a folder."""
    return [
        os.path.basename(path)
        for path in tuple(_held)
        if os.path.dirname(path) == os.fspath(folder)
    ]


def sweep(
    base: str | os.PathLike[str], *, again: bool = False, locked: Collection[Place] = ()
) -> None:
    """Remove the temporary folders in `base` whose programs are gone, their moves finished first.

    again: also where that was done a moment ago. locked: places that the caller has locked.
    """
    place = os.path.abspath(base)
    now_s = time.monotonic()
    if fcntl is None or (not again and now_s < _swept.get(place, -SWEPT_S) + SWEPT_S):
        return
    _swept[place] = now_s
    for name in leftovers(place):
        if os.path.join(place, name) not in _held:
            _remove_leftover(os.path.join(place, name), locked)


def leftovers(place: str | os.PathLike[str]) -> list[str]:
    """Names of all temporary folders in a place, whose programs may live."""
    with contextlib.suppress(OSError, ValueError), os.scandir(place) as entries:
        return [entry.name for entry in entries if is_temporary(entry.name)]
    return []


def is_temporary(name: str) -> bool:
    """Whether a name is one of these folders'."""
    return name.startswith(PREFIX) and name.endswith(SUFFIX)


def remove_all() -> None:
    """Remove the folders of this program, before an end that leaves no with-block."""
    for path in tuple(_held):
        _remove(path)


@contextlib.contextmanager
def locked_places(
    places: Iterable[Path], *, have: Collection[Place] = (), wait_s: float = LOCK_WAIT_S
) -> Iterator[set[Place]]:
    """Keep other programs from committing in these folders; the folders, with those of `have`.

    Waits, with checkpoints; raises BlockingIOError where another one does that for longer than
    `wait_s`. Where there are no locks it goes on without.
    """
    held = set(have)
    with contextlib.ExitStack() as stack:
        numbered = {_number(place): place for place in places}
        for number, place in sorted((n, p) for n, p in numbered.items() if n is not None):
            # What can't be opened has no lock; a temporary folder of this program has its own.
            if number in held or not os.access(place, os.R_OK) or os.fspath(place) in _held:
                continue
            deadline_s = time.monotonic() + wait_s
            while (lock := _lock(os.fspath(place))) == TAKEN and os.path.isdir(place):
                if time.monotonic() >= deadline_s:
                    text = "another program is writing there"
                    raise BlockingIOError(errno.EWOULDBLOCK, text)
                pause(LOCK_RETRY_S)
            if lock is not None and lock != TAKEN:
                stack.callback(os.close, lock)
            held.add(number)
        yield held


def _remove(path: str) -> None:
    """Remove a folder, unless its journal is to be finished by another program."""
    if not journal.is_marked(path):
        shutil.rmtree(path, ignore_errors=True)


def _remove_leftover(path: str, locked: Collection[Place]) -> None:
    found = journal.read(Path(path))
    if found is not None and found.primary != os.curdir:
        primary = os.path.normpath(os.path.join(path, found.primary))
        there = journal.read(Path(primary))
        if is_temporary(os.path.basename(primary)) and there and there.key == found.key:
            _settle(primary, locked)
            return
    _settle(path, locked)


def _settle(path: str, locked: Collection[Place]) -> None:
    """Finish what the journal of a leftover lists, with its others, and remove them all."""
    with contextlib.ExitStack() as stack:
        if not _take(path, stack):
            return
        first = journal.read(Path(path))
        journals = [] if first is None else [first]
        for other in [] if first is None else first.others:
            name = os.path.normpath(os.path.join(path, other))
            if not is_temporary(os.path.basename(name)) or not os.path.lexists(name):
                continue
            if not _take(name, stack):
                return
            found = journal.read(Path(name))
            if first is not None and found is not None and found.key == first.key:
                journals.append(found)
        if journals and journal.is_marked(path):
            try:
                places = {place for found in journals for place in found.places()}
                stack.enter_context(locked_places(places, have=locked, wait_s=0.0))
            except BlockingIOError:
                return
            if not journal.settle(journals):
                return
        for found in reversed(journals):
            _remove(os.fspath(found.holder))
        _remove(path)


def _take(path: str, stack: contextlib.ExitStack) -> bool:
    """Lock a leftover of this user; whether that worked."""
    lock = _lock(path)
    if lock is None or lock == TAKEN:
        return False
    stack.callback(os.close, lock)
    return _is_at(lock, path) and os.fstat(lock).st_uid == os.geteuid()


def _number(place: Path) -> Place | None:
    with contextlib.suppress(OSError):
        there = os.stat(place)
        return there.st_dev, there.st_ino
    return None


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
