"""The session file: SQLite, and how it is opened so that nothing acknowledged is lost.

One file holds a study and the sessions of its observers. While a program writes into it the file is
its own (locking_mode EXCLUSIVE). A transaction is on the disk before the next stimulus shows: what
it replaces goes to a journal beside the file, then the file is written, then the journal is made
void (journal_mode PERSIST, each step synced). So the file itself is whole between answers, and a
copy of it alone has them all. At rest it is one plain file.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import sqlite3
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.temporaries import scratch_folder
from relgloss_view.base.writing import fresh_file
from relgloss_view.experiment.session import former_log
from relgloss_view.experiment.session import tally as tallies
from relgloss_view.experiment.session.file_checks import (
    APPLICATION_ID,
    COUNTED_TABLES,
    DAMAGED,
    EXPECTED,
    FORMER,
    JOURNAL,
    LOG,
    TABLES,
    VERSION,
    Found,
    beside,
    bound,
    bounded_work,
    check_tables,
    look_at,
)
from relgloss_view.experiment.session.losses import Loss, read_losses, summed
from relgloss_view.experiment.session.tally import Tally

JOURNAL_MODE, SYNCHRONOUS = "PERSIST", "EXTRA"  #: measured in docs/experiment.md


@dataclass(frozen=True)
class Opened:
    """A session file that is open."""

    connection: sqlite3.Connection
    tally: Tally | None  #: None in a file of the former version that is read
    losses: tuple[Loss, ...]  #: kept in the file, or found now
    found: tuple[Loss, ...] = ()  #: those that were found now


def create_file(path: str | os.PathLike[str], content: str, digest: str, version: str) -> None:
    """Make a session file that holds a study and no observer yet, whole or not at all.

    Raises InputError where the name is taken or the place can't be written.
    """
    with fresh_file(path, private=True) as temporary, input_errors(path):
        connection = sqlite3.connect(temporary, isolation_level=None)
        with contextlib.closing(connection):
            connection.executescript(
                f"PRAGMA application_id = {APPLICATION_ID}; PRAGMA user_version = {VERSION};"
                f"BEGIN; {TABLES} {COUNTED_TABLES} COMMIT;"
            )
            connection.execute("INSERT INTO study VALUES (?, ?, ?)", (content, digest, version))
            _insert_tally(connection, tallies.new_tally(connection, content))


def open_to_write(path: str | os.PathLike[str]) -> Opened:
    """A connection that has the file to itself until it is closed; InputError otherwise.

    What is found to be lost is put into the file. A file of the former version becomes a present
    one; if its log is missing or damaged, a copy of it as it was stays beside it.
    """
    found = look_at(path)
    with input_errors(path), contextlib.ExitStack() as stack:
        before = _former_loss(found)
        if found.hot:
            with scratch_folder() as folder:
                _refuse_if_open(found)
                if not _journal_helps(found, folder, path):
                    name = printable(found.journal.name)
                    raise InputError(
                        f"{printable(path)}: {name} beside it is damaged or does not belong to "
                        f"it; the file is whole without it: move {name} away"
                    )
        if before is not None:
            stack.enter_context(former_log.kept(found.file, found.log))
        connection = _connect(found.file, "rw")
        try:
            connection.execute("PRAGMA locking_mode = EXCLUSIVE")
            if not found.has_log:
                choose_journal(connection)
            with bounded_work(connection, found.bytes):
                connection.execute("BEGIN EXCLUSIVE")
                opened = _check(connection, path, found, before)
                tally = _put_right(opened, path)
                connection.execute("COMMIT")
            choose_journal(connection)
            connection.execute("PRAGMA foreign_keys = ON")
        except BaseException:
            connection.close()
            raise
    tallies.remember(found.file, tally)
    return Opened(connection, tally, opened.losses)


def choose_journal(
    connection: sqlite3.Connection, mode: str = JOURNAL_MODE, synchronous: str = SYNCHRONOUS
) -> None:
    """How transactions get to the disk. A connection to a file with a log puts that into the file.

    Raises sqlite3.OperationalError where that is not possible.
    """
    (chosen,) = connection.execute(f"PRAGMA journal_mode = {mode}").fetchone()
    if chosen.upper() != mode:
        raise sqlite3.OperationalError(f"journal_mode {chosen}")
    connection.execute(f"PRAGMA synchronous = {synchronous}")
    connection.execute("PRAGMA fullfsync = ON")  # macOS: fsync alone leaves it to the disk


def whereabouts(file: str) -> tuple[tuple[int, int] | None, ...]:
    """Which files lie at the names of an open session and of its journal; None where none does.

    A program that goes on writing into a file that was replaced stores answers nowhere, and one
    whose journal was removed leaves half a write if it is killed.
    """
    there: list[tuple[int, int] | None] = []
    for name in (file, f"{file}{JOURNAL}"):
        try:
            status = os.lstat(name)
        except OSError:
            there.append(None)
        else:
            there.append((status.st_dev, status.st_ino))
    return tuple(there)


def close(connection: sqlite3.Connection, path: str | os.PathLike[str]) -> None:
    """Close it so that one plain file is left: the journal, which is void, is removed."""
    # A disk that failed may refuse that; a void journal beside the file does no harm.
    with input_errors(path), contextlib.closing(connection), contextlib.suppress(sqlite3.Error):
        connection.execute("PRAGMA locking_mode = NORMAL")
        connection.execute("PRAGMA journal_mode = DELETE")


@contextlib.contextmanager
def open_to_read(path: str | os.PathLike[str]) -> Iterator[Opened]:
    """A connection for reading that changes nothing, wherever the file lies; InputError.

    A file that a program is writing into is refused: what is in it changes. One that a killed
    program left is read as a copy, with what lies beside it.
    """
    found = look_at(path)
    with contextlib.ExitStack() as stack, input_errors(path):
        _refuse_if_open(found)
        before = _former_loss(found)
        source, mode = found.file, "ro"
        if found.hot or found.has_log:
            folder = stack.enter_context(scratch_folder())
            helps = not found.hot or _journal_helps(found, folder, path)
            suffixes = (JOURNAL, LOG) if helps else (LOG,)
            source, mode = _copied(found, folder / "read", *suffixes), "rw"
            _refuse_if_open(found)
        connection = stack.enter_context(contextlib.closing(_connect(source, mode)))
        stack.enter_context(bounded_work(connection, found.bytes))
        if mode == "rw":
            _complete_copy(connection)
        connection.execute("PRAGMA query_only = ON")
        yield _check(connection, path, found, before)


def _connect(file: Path, mode: str) -> sqlite3.Connection:
    uri = f"{file.absolute().as_uri()}?mode={mode}&readonly_shm=1"
    if mode == "rw":
        uri = uri.partition("&")[0]
    connection = sqlite3.connect(uri, uri=True, isolation_level=None, timeout=0.0)
    try:
        bound(connection)
    except BaseException:
        connection.close()
        raise
    return connection


def _refuse_if_open(found: Found) -> None:
    """Raise sqlite3.OperationalError, a lock, where another program has the file open."""
    if found.has_log and not found.log.exists():
        return  # nobody has it open, and SQLite would make a log, and leave it
    with contextlib.closing(_connect(found.file, "ro")) as connection:
        try:
            connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
        except sqlite3.Error as error:
            if _is_lock(error):
                raise


def _former_loss(found: Found) -> Loss | None:
    return former_log.lost_with(found.log) if found.has_log else None


def _complete_copy(connection: sqlite3.Connection) -> None:
    """Have SQLite put back what a journal or a log holds, before anything is read of a copy."""
    connection.execute("PRAGMA synchronous = OFF")
    connection.execute("BEGIN IMMEDIATE")
    connection.execute("COMMIT")


def _copied(found: Found, folder: Path, *suffixes: str) -> Path:
    """A copy of the file, with those of the files beside it that are there."""
    folder.mkdir()
    for suffix in ("", *suffixes):
        source = beside(found.file, suffix)
        if source.exists():
            shutil.copyfile(source, folder / source.name)
    return folder / found.file.name


def _journal_helps(found: Found, folder: Path, path: str | os.PathLike[str]) -> bool:
    """Whether a journal mends the file, or at least does no harm; tried on copies in `folder`.

    A journal that was cut, altered, or comes from another file or an earlier time would put old or
    wrong pages into a file that is whole without it. InputError where the file is damaged with it
    and without it.
    """
    alone = _tried(found, folder / "alone", path, LOG)
    mended = _tried(found, folder / "mended", path, JOURNAL, LOG)
    if mended is None and alone is None:
        raise InputError(
            f"{printable(path)}: the file and {printable(found.journal.name)} beside it are "
            "damaged; take a copy of both that is whole"
        )
    return mended is not None and (alone is None or _follows(alone, mended))


def _follows(alone: Opened, mended: Opened) -> bool:
    """Whether a file is what another one was at most one transaction before."""
    if mended.found and not alone.found:
        return False
    if alone.tally is None or mended.tally is None:
        return mended.tally is alone.tally or (alone.tally is not None and alone.tally.writes <= 1)
    gone = alone.tally.writes - mended.tally.writes
    return alone.tally.session == mended.tally.session and gone in (0, 1)


def _tried(
    found: Found, folder: Path, path: str | os.PathLike[str], *suffixes: str
) -> Opened | None:
    """What a copy of the file holds, with its connection closed; None where it is damaged."""
    copy = _copied(found, folder, *suffixes)
    try:
        with input_errors(path), contextlib.closing(_connect(copy, "rw")) as connection:
            _complete_copy(connection)
            with bounded_work(connection, found.bytes):
                return _check(connection, path, found, None)
    except InputError:
        return None


def _check(
    connection: sqlite3.Connection, path: str | os.PathLike[str], found: Found, before: Loss | None
) -> Opened:
    """Check all that can be checked of a file; before: what is known to be lost already."""
    version = check_tables(connection, path)
    try:
        kept = read_losses(connection, has_table=version == VERSION)
        tally = None if version == FORMER else tallies.read_tally(connection)
    except (ValueError, TypeError) as error:
        raise InputError(f"{printable(path)}: the tally in it is damaged; {DAMAGED}") from error
    if tally is not None:
        texts = connection.execute("SELECT content FROM study").fetchmany(2)
        if [tallies.study_hash(text) for (text,) in texts] != [tally.study]:
            raise InputError(f"{printable(path)}: the study in it is damaged; take a whole copy")
    now: tuple[Loss, ...] = () if before is None else (before,)
    now += tallies.find_losses(connection, tally, tallies.recall(found.file))
    return Opened(connection, tally, summed([*kept, *now]), now)


def _put_right(opened: Opened, path: str | os.PathLike[str]) -> Tally:
    """Bring an open file up to the present: its tables, its losses, its tally."""
    connection = opened.connection
    if opened.tally is None:
        for statement in COUNTED_TABLES.split(";")[:-1]:
            connection.execute(statement)
        connection.execute(f"PRAGMA user_version = {VERSION}")
        row = connection.execute("SELECT content FROM study").fetchone()
        if row is None or not isinstance(row[0], str):
            raise InputError(f"{printable(path)}: the study in it is damaged")
        tally = tallies.new_tally(connection, row[0])
        _insert_tally(connection, tally)
    else:
        tally = opened.tally
    if opened.found:
        now = datetime.now(UTC).isoformat(timespec="milliseconds")
        connection.executemany(
            "INSERT INTO loss VALUES (NULL, ?, ?, ?)",
            [(now, x.cause, x.answers) for x in opened.found],
        )
        tally = tallies.recounted(connection, tally)
    # Also where nothing is to be put right: the first write takes the lock.
    tally = tally.written()
    tallies.write_tally(connection, tally)
    return tally


def _insert_tally(connection: sqlite3.Connection, tally: Tally) -> None:
    connection.execute(
        "INSERT INTO tally VALUES (?, ?, ?, ?, ?, ?)",
        (tally.session, tally.writes, tally.answers, tally.undone, tally.chain, tally.study),
    )


@contextlib.contextmanager
def input_errors(path: str | os.PathLike[str]) -> Iterator[None]:
    """Turn SQLite's errors into one line that says what is wrong with which file."""
    try:
        yield
    except sqlite3.Error as error:
        raise InputError(f"{printable(path)}: {_reason(error)}") from error
    except UnicodeDecodeError as error:  # of a damaged table's name, in SQLite's own message
        raise InputError(f"{printable(path)}: {DAMAGED}") from error
    except OSError as error:
        reason = error.strerror or error
        raise InputError(
            f"{printable(path)}: can't be read or copied ({reason}); check the disk, or choose "
            "another place"
        ) from error


def _reason(error: sqlite3.Error) -> str:
    code = getattr(error, "sqlite_errorcode", None) or 0
    if _is_lock(error):
        return "another program has this session open; close it first"
    if code & 0xFF == sqlite3.SQLITE_FULL:
        return "the disk is full; make room and start again; all answers so far are kept"
    if code & 0xFF in (sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_PERM):
        return "the file or its folder can't be written; choose another place with -o"
    if code & 0xFF == sqlite3.SQLITE_NOTADB:
        return f"not a session file; give {EXPECTED}"
    if code & 0xFF in (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_TOOBIG, sqlite3.SQLITE_INTERRUPT):
        return DAMAGED
    if code == sqlite3.SQLITE_ERROR or "decode" in str(error):  # tables or texts are not ours
        return DAMAGED
    return f"can't be read or written ({printable(error)}); check the disk, or choose another place"


def _is_lock(error: sqlite3.Error) -> bool:
    code = getattr(error, "sqlite_errorcode", None) or 0
    return code & 0xFF in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED)
