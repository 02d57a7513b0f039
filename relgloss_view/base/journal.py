"""The journal of a commit: what moves where, written before the first move.

It lies in the temporary folder that holds the new files. Once the folder is marked as committed,
every move is carried out, if not by the program that wrote it then by the next one that comes
there; if one is impossible, all are taken back. Each move is recognised as done by the identity of
the file at its place, so that a program may be killed at any moment, while repairing too.

The outputs of one command may lie in several places. Each place has its own folder and journal, and
names only files beside that folder; one of them, the primary, bears the mark for all.
"""

from __future__ import annotations

import contextlib
import errno
import json
import os
import shutil
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.file_system import (
    REFUSED,
    Identity,
    exchange,
    identity,
    move_new,
    sync,
)
from relgloss_view.base.json_files import read_json
from relgloss_view.base.merging import take_apart

JOURNAL, COMMITTED, UNDOING = "journal.json", "committed", "undoing"
FORMAT, VERSION = "relgloss-commit", 1
MOST_BYTES = 16 * 1024 * 1024
MOST_TRIES = 5


@dataclass(frozen=True)
class Move:
    """A new file or folder comes to its place, or an old file is removed.

    new: its name in the temporary folder; None where a file is only removed.
    to: its place, relative to the folder that the temporary one lies in.
    was, made: identities of what is at the place before and after.
    fresh: nothing may be replaced.
    dropped: of a folder, the names in the old one that were the program's own.
    """

    new: str | None
    to: str
    was: Identity | None
    made: Identity | None
    fresh: bool = False
    dropped: tuple[str, ...] = ()


@dataclass
class Journal:
    """The moves of one temporary folder, and where the others of the same commit are.

    primary, others: relative to the folder; the primary alone lists the others.
    """

    holder: Path
    key: str
    moves: list[Move] = field(default_factory=list)
    primary: str = "."
    others: list[str] = field(default_factory=list)

    def write(self) -> None:
        """Bring it to the disk; OSError where it has more moves than `read` takes."""
        content = {
            "format": FORMAT, "version": VERSION, "key": self.key, "primary": self.primary,
            "others": self.others, "moves": [asdict(move) for move in self.moves],
        }  # fmt: skip
        file = self.holder / JOURNAL
        file.write_text(json.dumps(content), encoding="utf-8")
        if read(self.holder) is None:
            raise OSError(errno.EFBIG, "too many files at once")
        sync(file)
        sync(self.holder)

    def places(self) -> set[Path]:
        """The folders in which something moves."""
        return {self.holder.parent, *((self.holder.parent / m.to).parent for m in self.moves)}

    def carry_out(self, *, strict: bool) -> None:
        """Make every move that is not made yet; OSError where one can't be.

        strict: leave alone what is no longer what it was when the journal was written.
        """
        for number, move in enumerate(self.moves):
            self._move(number, move, strict)

    def take_back(self) -> None:
        """Undo every move that is made, the last one first."""
        for number, move in reversed(list(enumerate(self.moves))):
            self._take_back(number, move)

    def take_apart(self) -> bool:
        """Remove the folders that were replaced, or taken back; whether nothing of them is left."""
        done = True
        for move in self.moves:
            left, place = self.holder / (move.new or os.curdir), self.holder.parent / move.to
            if move.new and move.was and left.is_dir() and place.is_dir():
                done &= take_apart(left, place, move.dropped)
        return done

    def _kept(self, number: int) -> Path:
        """Where an old file goes that is not exchanged; another name in each attempt."""
        return self.holder / f"old-{self.key}-{number}"

    def _move(self, number: int, move: Move, strict: bool) -> None:
        place, kept = self.holder.parent / move.to, self._kept(number)
        if move.new is None:
            if move.was is not None and identity(place) == move.was:
                os.rename(place, kept)
            return
        new = self.holder / move.new
        for attempt in range(MOST_TRIES):
            present = identity(place)
            if present == move.made or identity(new) != move.made:
                return
            if strict and (present != move.was or not place.parent.is_dir()):
                return
            try:
                if present is None or move.fresh:
                    move_new(new, place)
                else:
                    _replace(new, place, kept)
                return
            except (FileExistsError, FileNotFoundError):
                # Another program has made or removed it just now.
                if move.fresh or attempt == MOST_TRIES - 1:
                    raise

    def _take_back(self, number: int, move: Move) -> None:
        place, kept = self.holder.parent / move.to, self._kept(number)
        if move.new is None:
            if identity(kept) is not None and identity(place) is None:
                os.rename(kept, place)
            return
        new = self.holder / move.new
        if identity(place) != move.made:
            return
        if os.path.lexists(kept):  # so there was no exchange
            if not os.path.lexists(new):
                _second_name(place, new)  # it may be wanted in another try
            os.replace(kept, place)
        elif identity(new) is not None:
            exchange(new, place)
        elif move.was is None:
            os.rename(place, new)


def _replace(new: Path, place: Path, kept: Path) -> None:
    """Replace a file so that it can be put back: by an exchange, or with a second name for it."""
    try:
        exchange(new, place)
    except OSError as error:
        if error.errno not in REFUSED or place.is_dir():
            raise
        if not os.path.lexists(kept):
            _second_name(place, kept)
        os.replace(new, place)


def _second_name(file: Path, name: Path) -> None:
    """A link to a file, or a copy of it where the file system has no links."""
    try:
        os.link(file, name, follow_symlinks=False)
    except (OSError, NotImplementedError):
        shutil.copy2(file, name, follow_symlinks=False)


def read(holder: Path) -> Journal | None:
    """The journal of a temporary folder; None where there is none, or it is not whole."""
    try:
        content = read_json(holder / JOURNAL, MOST_BYTES, "a journal of relgloss")
        if (content["format"], content["version"]) != (FORMAT, VERSION):
            return None
        moves = [_move_of(entry) for entry in content["moves"]]
        others = [str(other) for other in content["others"]]
        key = str(content["key"])
        if not key.isalnum():
            return None
        return Journal(holder, key, moves, str(content["primary"]), others)
    except (InputError, ValueError, LookupError, TypeError):
        return None


def _move_of(entry: dict[str, Any]) -> Move:
    """ValueError where a name leads out of the folder: nobody but this program writes such names,
    but a folder may come out of an archive.
    """
    new, to = entry["new"], str(entry["to"])
    for name in (to, "." if new is None else str(new)):
        if os.path.isabs(name) or ".." in Path(name).parts:
            raise ValueError(name)
    was, made = (None if entry[k] is None else _identity_of(entry[k]) for k in ("was", "made"))
    dropped = tuple(str(name) for name in entry["dropped"])
    return Move(None if new is None else str(new), to, was, made, bool(entry["fresh"]), dropped)


def _identity_of(numbers: Sequence[Any]) -> Identity:
    inode, time_ns, size = (int(number) for number in numbers)
    return inode, time_ns, size


def mark(holder: Path) -> None:
    """The moment of the commit: from now on the moves are made, whoever makes them.

    OSError where it can't be brought to the disk; there is no mark then, and nothing moves.
    """
    committed = holder / COMMITTED
    os.close(os.open(committed, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600))
    try:
        sync(holder)
    except OSError:
        os.unlink(committed)
        raise


def is_marked(holder: str | os.PathLike[str]) -> bool:
    """Whether moves of a folder are to be finished or taken back, so that it must not go."""
    return any(os.path.lexists(os.path.join(holder, name)) for name in (COMMITTED, UNDOING))


def undo(journals: Sequence[Journal]) -> None:
    """Take back all that was moved; the first journal is the primary's."""
    primary = journals[0].holder
    with contextlib.suppress(FileNotFoundError):
        os.rename(primary / COMMITTED, primary / UNDOING)
        sync(primary)
    for journal in reversed(journals):
        journal.take_back()
    sync_places(journals)


def clear(journals: Sequence[Journal]) -> bool:
    """After all moves, or all taken back: whether the temporary folders may go.

    They stay, marked, where one holds something that could not be brought over.
    """
    gone = [journal.take_apart() for journal in journals]
    if not all(gone):
        return False
    for name in (COMMITTED, UNDOING):
        with contextlib.suppress(FileNotFoundError):
            os.unlink(journals[0].holder / name)
    sync(journals[0].holder)
    return True


def sync_places(journals: Sequence[Journal]) -> None:
    """Bring the names to the disk."""
    for place in sorted({place for journal in journals for place in journal.places()}):
        with contextlib.suppress(FileNotFoundError):
            sync(place)


def settle(journals: Sequence[Journal]) -> bool:
    """Finish or take back what a killed program has left; whether its folders may go."""
    primary = journals[0].holder
    try:
        if os.path.lexists(primary / COMMITTED):
            for journal in journals:
                journal.carry_out(strict=True)
            sync_places(journals)
        elif os.path.lexists(primary / UNDOING):
            undo(journals)
        else:
            return True
        return clear(journals)
    except OSError:  # the disk is full, say; another program may be luckier
        return False
