"""The session file: SQLite, its tables, and how it is opened so that nothing acknowledged is lost.

One file holds a study and the sessions of its observers. While a program writes into it the file is
its own (locking_mode EXCLUSIVE); each answer is on the disk before the next stimulus shows (WAL,
synchronous FULL). At rest it is one plain file.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import sqlite3
from collections.abc import Iterator
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import check_regular, printable
from relgloss_view.base.temporaries import scratch_folder
from relgloss_view.base.writing import fresh_file

APPLICATION_ID = 0x52476C45  #: "RGlE"
VERSION = 1
EXPECTED = "a session file that `relgloss experiment` wrote"
DAMAGED = "the file is damaged; take a copy of it that is whole"
TABLES = """
CREATE TABLE study (content TEXT NOT NULL, digest TEXT NOT NULL, version TEXT NOT NULL);
CREATE TABLE observer (
    number INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE, kind TEXT NOT NULL,
    begun_utc TEXT NOT NULL, consented_utc TEXT, ended_utc TEXT, details TEXT NOT NULL
);
CREATE TABLE run (
    id INTEGER PRIMARY KEY, observer INTEGER NOT NULL REFERENCES observer,
    begun_utc TEXT NOT NULL, ended_utc TEXT, version TEXT NOT NULL, device TEXT NOT NULL,
    screen TEXT NOT NULL, profile BLOB
);
CREATE TABLE trial (
    observer INTEGER NOT NULL REFERENCES observer, position INTEGER NOT NULL,
    sample INTEGER NOT NULL, setting INTEGER NOT NULL, repeat INTEGER NOT NULL,
    PRIMARY KEY (observer, position)
) WITHOUT ROWID;
CREATE TABLE answer (
    id INTEGER PRIMARY KEY, observer INTEGER NOT NULL, position INTEGER NOT NULL,
    question TEXT NOT NULL, category INTEGER NOT NULL CHECK (category >= 0),
    response_ms INTEGER NOT NULL CHECK (response_ms >= 0),
    run INTEGER NOT NULL REFERENCES run, answered_utc TEXT NOT NULL, undone_utc TEXT,
    FOREIGN KEY (observer, position) REFERENCES trial
);
CREATE UNIQUE INDEX standing ON answer (observer, position, question) WHERE undone_utc IS NULL;
CREATE TABLE picture (
    sample INTEGER, setting INTEGER, sha256 TEXT NOT NULL, device TEXT NOT NULL,
    parameters TEXT NOT NULL, first_run INTEGER NOT NULL REFERENCES run
);
CREATE UNIQUE INDEX shown ON picture (ifnull(sample, -1), ifnull(setting, -1), sha256, device);
CREATE TABLE event (
    id INTEGER PRIMARY KEY, run INTEGER NOT NULL REFERENCES run, at_utc TEXT NOT NULL,
    kind TEXT NOT NULL, detail TEXT NOT NULL
);
"""


def create_file(path: str | os.PathLike[str], content: str, digest: str, version: str) -> None:
    """Make a session file that holds a study and no observer yet, whole or not at all.

    Raises InputError where the name is taken or the place can't be written.
    """
    with fresh_file(path, private=True) as temporary, input_errors(path):
        connection = sqlite3.connect(temporary, isolation_level=None)
        with contextlib.closing(connection):
            connection.executescript(
                f"PRAGMA application_id = {APPLICATION_ID}; PRAGMA user_version = {VERSION};"
                f"BEGIN; {TABLES} COMMIT;"
            )
            connection.execute("INSERT INTO study VALUES (?, ?, ?)", (content, digest, version))


def open_to_write(path: str | os.PathLike[str]) -> sqlite3.Connection:
    """A connection that has the file to itself until it is closed; InputError otherwise."""
    check_regular(path, EXPECTED)
    with input_errors(path):
        connection = sqlite3.connect(_uri(path, "rw"), uri=True, isolation_level=None, timeout=0.0)
        try:
            _check_format(connection, path)
            connection.execute("PRAGMA foreign_keys = ON")
            connection.execute("PRAGMA locking_mode = EXCLUSIVE")
            connection.execute("PRAGMA journal_mode = WAL")
            connection.execute("PRAGMA synchronous = FULL")
            # The lock is taken by the first write, so one is made that changes nothing.
            connection.execute("BEGIN IMMEDIATE")
            connection.execute(f"PRAGMA user_version = {VERSION}")
            connection.execute("COMMIT")
        except BaseException:
            connection.close()
            raise
    return connection


def close(connection: sqlite3.Connection, path: str | os.PathLike[str]) -> None:
    """Close it so that one plain file is left, which can be copied as it is."""
    # A full disk may refuse that; what was committed stays in the log beside the file.
    with input_errors(path), contextlib.closing(connection), contextlib.suppress(sqlite3.Error):
        connection.execute("PRAGMA journal_mode = DELETE")


@contextlib.contextmanager
def open_to_read(path: str | os.PathLike[str]) -> Iterator[sqlite3.Connection]:
    """A connection for reading, also where file or folder can't be written; InputError.

    A file that a program is writing into is refused: what is in it changes.
    """
    file = check_regular(path, EXPECTED)
    with contextlib.ExitStack() as stack, input_errors(path):
        try:
            connection = _reading(file)
        except sqlite3.OperationalError as error:
            if _is_lock(error):
                raise
            # After a kill the log must be read too, and SQLite does that only where it may write.
            folder = stack.enter_context(scratch_folder())
            for name in (file.name, f"{file.name}-wal"):
                if file.with_name(name).exists():
                    shutil.copyfile(file.with_name(name), folder / name)
            connection = _reading(folder / file.name)
        stack.enter_context(contextlib.closing(connection))
        _check_format(connection, path)
        yield connection


def _reading(file: Path) -> sqlite3.Connection:
    connection = sqlite3.connect(_uri(file, "rw"), uri=True, isolation_level=None, timeout=0.0)
    try:
        connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
        connection.execute("PRAGMA query_only = ON")
    except BaseException:
        connection.close()
        raise
    return connection


def log_missing(path: str | os.PathLike[str]) -> bool:
    """Whether a file was left by a kill without its log, as when it was copied alone."""
    try:
        with open(path, "rb") as file:
            header = file.read(20)
    except OSError:
        return False  # reported when it is opened
    writing_ahead = header[18:20] == b"\x02\x02"  # SQLite's file format, "File format versions"
    return writing_ahead and not os.path.exists(f"{os.fspath(path)}-wal")


def lost_log(path: str | os.PathLike[str]) -> str:
    """What to do about a file without its log."""
    return (
        f"{printable(Path(path).name)}-wal is not beside it, and the last answers may be in that: "
        "copy both files, or run the study on once where both lie"
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
    if code & 0xFF == sqlite3.SQLITE_CORRUPT:
        return DAMAGED
    if code == sqlite3.SQLITE_ERROR or "decode" in str(error):  # tables or texts are not ours
        return DAMAGED
    return f"can't be read or written ({printable(error)}); check the disk, or choose another place"


def _is_lock(error: sqlite3.Error) -> bool:
    code = getattr(error, "sqlite_errorcode", None) or 0
    return code & 0xFF in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED)


def _check_format(connection: sqlite3.Connection, path: str | os.PathLike[str]) -> None:
    (application,) = connection.execute("PRAGMA application_id").fetchone()
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    if application != APPLICATION_ID:
        raise InputError(f"{printable(path)}: not a session file; give {EXPECTED}")
    if version != VERSION:
        raise InputError(
            f"{printable(path)}: of version {version}, expected {VERSION}; a newer file needs a "
            "newer relgloss"
        )
    # A damaged index would leave answers out without a word.
    if connection.execute("PRAGMA integrity_check(1)").fetchone() != ("ok",):
        raise InputError(f"{printable(path)}: {DAMAGED}")


def _uri(path: str | os.PathLike[str], mode: str) -> str:
    """The file as SQLite's URI; its name may hold anything."""
    return f"{Path(path).absolute().as_uri()}?mode={mode}"
