"""The commit of a command's outputs: all come to their places, or none does.

Every output is made whole in a temporary folder beside its place first. Then:

- One file, or one new folder, is renamed to its place: the rename is the commit.
- A folder that exists is replaced by a new one, which holds the user's other files of the old one
  too (merging.py), by exchanging the two names; then the old one is taken apart.
- Where a folder can't be exchanged (it is somebody's working folder, the root of a file system, or
  the file system does not know the call) its files are moved one by one.
- More than one move is listed in a journal first (journal.py), so that after a kill the next
  program finishes them.

Everything is on the disk before the first name changes.
"""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from relgloss_view.base import journal, temporaries
from relgloss_view.base.errors import InputError
from relgloss_view.base.file_system import (
    REFUSED,
    identity,
    keep_attributes,
    may_be_exchanged,
    move_new,
    sync,
    sync_tree,
)
from relgloss_view.base.interruptions import checkpoint, uninterrupted
from relgloss_view.base.journal import Journal, Move
from relgloss_view.base.json_files import read_mark
from relgloss_view.base.merging import NotMergeable, merge


@dataclass(eq=False)
class Output:
    """A file or folder that lies whole in a temporary folder, and its place.

    name: as the user wrote it, for messages. holder: the temporary folder; staged: what is in it.
    target: the place, links followed. fresh: an existing file is never replaced.
    """

    name: str
    holder: Path
    staged: Path
    target: Path
    fresh: bool = False


@dataclass(eq=False)
class FolderOutput(Output):
    """A folder; `last` is the file that lists the others and marks it as the program's own.

    stale: names what a former run has written into the folder, as far as it goes now.
    """

    last: str = ""
    stale: Callable[[Path], Iterable[str]] = field(default=lambda _: ())
    files: tuple[str, ...] = ()  #: the program's own, once all are there
    is_new: bool = False  #: there was none when the work began
    in_place: bool = False  #: it can't be exchanged

    def new_top(self) -> tuple[Path, Path]:
        """The uppermost folder that does not exist yet: as it is staged, and its place."""
        staged, target = self.staged, self.target
        while not os.path.lexists(target.parent):
            staged, target = staged.parent, target.parent
        return staged, target


def put_in_place(outputs: Sequence[Output]) -> None:
    """Commit outputs; InputError, and nothing has changed, where one can't be put in place.

    A signal is obeyed before the first move, also while another program writes there, or after the
    last one.
    """
    checkpoint()
    wanted = _absorbed(list({output.target: output for output in outputs}.values()))
    if not wanted:
        return
    if len(wanted) == 1 and not _is_there(wanted[0]):
        output = wanted[0]
        try:
            with uninterrupted():
                _put_one(output)
            return
        except FileExistsError as error:
            if not isinstance(output, FolderOutput):
                raise taken(output.name) from error
        except OSError as error:
            raise unwritable(output.name, error) from error
        # The folder has been made meanwhile.
    _commit(wanted)


def _is_there(output: Output) -> bool:
    return isinstance(output, FolderOutput) and os.path.lexists(output.target)


def _put_one(output: Output) -> None:
    """One file, or one new folder: a single rename."""
    nested = temporaries.is_held(output.target)  # its folder is brought to the disk later
    if isinstance(output, FolderOutput):
        staged, target = output.new_top()
        if not nested:
            sync_tree(staged)
        move_new(staged, target)
    else:
        target = output.target
        if not output.fresh and os.path.lexists(target):
            keep_attributes(target, output.staged)
        if not nested:
            sync(output.staged)
        if output.fresh:
            move_new(output.staged, target)
        else:
            os.replace(output.staged, target)
    if not nested:
        sync(target.parent)


def _absorbed(outputs: list[Output]) -> list[Output]:
    """Put files whose place is in a folder that is written too into that folder's staged form."""
    folders = [output for output in outputs if isinstance(output, FolderOutput)]
    left: list[Output] = []
    for output in outputs:
        for folder in folders:
            if output is not folder and output.target.is_relative_to(folder.target):
                place = folder.staged / output.target.relative_to(folder.target)
                if place.parent != folder.staged:  # in a sub-folder, which is the user's
                    folder.in_place = True
                    continue
                os.replace(output.staged, place)
                break
        else:
            left.append(output)
    return left


def _commit(outputs: list[Output]) -> None:
    # Folders first: one that turns out not to be exchangeable needs a second plan.
    outputs = sorted(outputs, key=lambda output: not isinstance(output, FolderOutput))
    places = {output.target.parent for output in outputs}
    places |= {output.holder.parent for output in outputs}
    places |= {output.target for output in outputs if isinstance(output, FolderOutput)}
    try:
        with temporaries.locked_places(places) as locked, uninterrupted():
            for place in sorted(places):
                temporaries.sweep(place, again=True, locked=locked)
            _commit_locked(outputs)
    except BlockingIOError as error:
        raise unwritable(outputs[0].name, error) from error


def _commit_locked(outputs: list[Output]) -> None:
    while True:
        journals = _journals(outputs)
        fault, at = _carried_out(outputs, journals)
        if fault is None:
            journal.clear(journals)
            return
        journal.undo(journals)
        if isinstance(at, FolderOutput) and not at.in_place and fault.errno in REFUSED:
            at.in_place = True
            continue
        journal.clear(journals)
        if at.fresh and isinstance(fault, FileExistsError):
            raise taken(at.name) from fault
        raise unwritable(at.name, fault) from fault


def _journals(outputs: list[Output]) -> list[Journal]:
    """Plan all moves, and commit to them; until then nothing has changed."""
    key = secrets.token_hex(8)
    journals = [Journal(output.holder, key, _planned(output)) for output in outputs]
    primary = outputs[0].holder
    for other in journals[1:]:
        other.primary = os.path.relpath(primary, other.holder)
        journals[0].others.append(os.path.relpath(other.holder, primary))
    for output, written in zip(outputs, journals, strict=True):
        with errors_of(output.name):
            written.write()
            sync(written.holder.parent)
    with errors_of(outputs[0].name):
        journal.mark(primary)
    return journals


def _carried_out(outputs: list[Output], journals: list[Journal]) -> tuple[OSError | None, Output]:
    """Make all moves; the fault that prevents one, and its output."""
    made = outputs[0]
    try:
        for output, written in zip(outputs, journals, strict=True):
            made = output
            written.carry_out(strict=False)
        journal.sync_places(journals)
    except OSError as error:
        return error, made
    except BaseException:
        journal.undo(journals)
        journal.clear(journals)
        raise
    return None, made


def _planned(output: Output) -> list[Move]:
    """The moves of an output; what they place is on the disk."""
    with errors_of(output.name):
        if not isinstance(output, FolderOutput):
            return [_file_move(output)]
        return _folder_moves(output)


def _file_move(output: Output) -> Move:
    was = identity(output.target)
    if was is not None and stat.S_ISDIR(os.lstat(output.target).st_mode):
        raise InputError(f"{output.name}: is a folder; give the name of a file in it")
    if was is not None and output.fresh:
        raise taken(output.name)
    if was is not None:
        keep_attributes(output.target, output.staged)
    sync_tree(output.staged.parent)
    return _move(output, output.staged, output.target, was, fresh=output.fresh)


def _move(
    output: Output,
    staged: Path,
    target: Path,
    was: tuple[int, int, int] | None,
    *,
    fresh: bool = False,
    dropped: tuple[str, ...] = (),
) -> Move:
    new = os.path.relpath(staged, output.holder)
    to = os.path.relpath(target, output.holder.parent)
    return Move(new, to, was, identity(staged), fresh, dropped)


def _folder_moves(output: FolderOutput) -> list[Move]:
    output.files = output.files or tuple(sorted(p.name for p in output.staged.iterdir()))
    old = output.target
    if not os.path.lexists(old):
        staged, target = output.new_top()
        sync_tree(staged)
        return [_move(output, staged, target, None)]
    if output.is_new:
        _check_neighbour(output)
    output.in_place = output.in_place or not may_be_exchanged(old)
    stale = [name for name in output.stale(old) if name not in output.files]
    stale = [name for name in stale if _is_file_in(old, name)]
    for name in output.files:
        there = old / name
        if there.is_dir() and not (output.staged / name).is_dir():
            raise InputError(f"{there}: is a folder; give the name of a file in it")
        if there.exists() and not there.is_file():
            raise InputError(f"{there}: is not a regular file; choose another place")
        if there.is_file() and not there.is_symlink():
            keep_attributes(there, output.staged / name)
    if not output.in_place:
        ours = temporaries.held_in(old)
        dropped = (*output.files, *stale, *ours)
        try:
            # A temporary folder in it is that of a program at work, which would lose it.
            merge(old, output.staged, dropped, temporaries.is_temporary)
            keep_attributes(old, output.staged)
        except NotMergeable:
            output.in_place = True
        else:
            sync_tree(output.holder)
            return [_move(output, output.staged, old, identity(old), dropped=dropped)]
    sync_tree(output.holder)
    marked = os.path.lexists(old / output.last)
    # The mark is never missing: a new one comes first, one that is replaced last.
    order = sorted(output.files, key=lambda name: ((name == output.last) == marked, name))
    moves = [
        _move(output, output.staged / name, old / name, identity(old / name)) for name in order
    ]
    below = os.path.relpath(old, output.holder.parent)
    moves += [Move(None, os.path.join(below, name), identity(old / name), None) for name in stale]
    return moves


def _check_neighbour(output: FolderOutput) -> None:
    """InputError where a folder that did not exist has been made by somebody else meanwhile."""
    old = output.target
    theirs, ours = (
        read_mark(folder / output.last).get("format") for folder in (old, output.staged)
    )
    if any(old.iterdir()) and (theirs is None or theirs != ours):
        raise InputError(f"{output.name}: was made by another program meanwhile; choose another")


def _is_file_in(folder: Path, name: str) -> bool:
    """Whether a name is that of a file in the folder itself, and no place elsewhere."""
    try:
        return Path(name).name == name and stat.S_ISREG(os.lstat(folder / name).st_mode)
    except (OSError, ValueError):
        return False


def taken(name: str | os.PathLike[str]) -> InputError:
    """The refusal to replace a file."""
    return InputError(f"{os.fspath(name)}: is there already; choose another name")


def unwritable(path: str | os.PathLike[str], error: OSError | ValueError) -> InputError:
    """A place that can't be written, in one line; an InputError stays what it is."""
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return InputError(f"{_lasting(path)}: can't be written ({reason}); choose another place")


#: What the user calls the folders that are being filled, by their temporary paths.
_names: dict[str, str] = {}


@contextlib.contextmanager
def shown_as(staged: Path, name: str | os.PathLike[str]) -> Iterator[None]:
    """Within the block, messages name a file of a temporary folder by its place."""
    _names[os.fspath(staged)] = os.fspath(name)
    try:
        yield
    finally:
        del _names[os.fspath(staged)]


def _lasting(path: str | os.PathLike[str]) -> str:
    for staged, name in tuple(_names.items()):
        if Path(path).is_relative_to(staged):
            return os.path.join(name, os.path.relpath(path, staged))
    return os.fspath(path)


@contextlib.contextmanager
def errors_of(path: str | os.PathLike[str]) -> Iterator[None]:
    """Errors of the file system within the block, as that of one place."""
    try:
        yield
    except (OSError, UnicodeError) as error:
        raise unwritable(path, error) from error
