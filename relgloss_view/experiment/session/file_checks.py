"""What is checked of a session file before SQLite opens it, and before anything in it is believed.

Devices, pipes and what claims to be larger than any session are refused unopened; the tables have
to be exactly ours, without views, triggers or columns that compute; and reading has an end.
"""

from __future__ import annotations

import contextlib
import os
import sqlite3
import stat
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable, read_beginning, unreadable

EXPECTED = "a session file that `relgloss experiment` wrote"
DAMAGED = "the file is damaged; take a copy of it that is whole"
APPLICATION_ID = 0x52476C45  #: "RGlE"
FORMER, VERSION = 1, 2  #: a file of version 1 has no tally, and has kept a log beside it
MAGIC, HEADER_BYTES = b"SQLite format 3\0", 100
MOST_BYTES = 2**30  #: of a file, and of its journal: a million answers take a fifth of that
MOST_TEXT_BYTES = 32 * 2**20  #: of one value: twice the largest ICC profile
MOST_ROWS = 1_000_000  #: of a table
#: Steps of SQLite's machine while a file is read: some 20 million a second. A row takes about 100
#: for all that is checked and read, and no row is smaller than 10 bytes.
STEPS, STEPS_A_BYTE, STEPS_A_CALL = 10_000_000, 50, 100_000
JOURNAL, LOG, LOG_INDEX = "-journal", "-wal", "-shm"  #: what SQLite puts beside a file

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
#: What version 2 has added; see tally.py and losses.py.
COUNTED_TABLES = """
CREATE TABLE tally (
    session TEXT NOT NULL, writes INTEGER NOT NULL, answers INTEGER NOT NULL,
    undone INTEGER NOT NULL, chain TEXT NOT NULL, study TEXT NOT NULL
);
CREATE TABLE loss (
    id INTEGER PRIMARY KEY, at_utc TEXT NOT NULL, cause TEXT NOT NULL, answers INTEGER
);
"""
CHECKS = (" CHECK (category >= 0)", " CHECK (response_ms >= 0)")  #: the first files had none


@dataclass(frozen=True)
class Found:
    """A session file as it lies on the disk."""

    file: Path  #: with links followed, as SQLite does
    bytes: int
    has_log: bool  #: its header states a log, as files of version 1 do that were not closed
    hot: bool  #: a journal lies beside it that a killed program may have left

    @property
    def journal(self) -> Path:
        """Where its journal is, or would be."""
        return beside(self.file, JOURNAL)

    @property
    def log(self) -> Path:
        """Where its log is, or would be."""
        return beside(self.file, LOG)


def beside(file: Path, suffix: str) -> Path:
    """The name of a file that SQLite puts beside another."""
    return file.with_name(file.name + suffix)


def look_at(path: str | os.PathLike[str]) -> Found:
    """Look at a session file and what lies beside it, without SQLite; InputError for any other."""
    header = read_beginning(path, HEADER_BYTES, EXPECTED)
    file = Path(os.path.realpath(path))
    try:
        size = os.path.getsize(file)
        for suffix in (JOURNAL, LOG, LOG_INDEX):
            _check_beside(beside(file, suffix))
        journal, log = _first_byte(beside(file, JOURNAL)), _first_byte(beside(file, LOG))
    except OSError as error:
        raise unreadable(path, error, EXPECTED) from None
    if size > MOST_BYTES:
        raise InputError(f"{printable(path)}: larger than any session; give {EXPECTED}")
    if len(header) < HEADER_BYTES or not header.startswith(MAGIC):
        raise InputError(f"{printable(path)}: not a session file; give {EXPECTED}")
    if int.from_bytes(header[68:72], "big") != APPLICATION_ID:
        raise InputError(f"{printable(path)}: not a session file; give {EXPECTED}")
    # The file format versions, and the encoding UTF-8: "The Database Header" of SQLite's documents.
    versions = header[18:20]
    if versions not in (b"\1\1", b"\2\2") or header[56:60] != b"\0\0\0\1":
        raise InputError(f"{printable(path)}: {DAMAGED}")
    has_log = versions == b"\2\2"
    if log is not None and not has_log:
        name = printable(beside(file, LOG).name)
        raise InputError(
            f"{printable(path)}: {name} lies beside it and does not belong to it; move {name} away"
        )
    return Found(file, size, has_log, journal not in (None, 0))


def _check_beside(file: Path) -> None:
    try:
        status = os.lstat(file)
    except FileNotFoundError:
        return
    if not stat.S_ISREG(status.st_mode):
        raise InputError(f"{printable(file)}: this is not a regular file; move it away")
    if status.st_size > MOST_BYTES:
        raise InputError(f"{printable(file)}: larger than any session's; move it away")


def _first_byte(file: Path) -> int | None:
    """The first byte of a file; None where there is none."""
    try:
        byte = read_beginning(file, 1, EXPECTED)
    except InputError:
        if os.path.lexists(file):
            raise
        return None
    return byte[0] if byte else None


def bound(connection: sqlite3.Connection) -> None:
    """Have SQLite believe nothing in the file that it need not, and keep values within bounds."""
    for limit, value in (
        (sqlite3.SQLITE_LIMIT_LENGTH, MOST_TEXT_BYTES),
        (sqlite3.SQLITE_LIMIT_SQL_LENGTH, 20_000),
        (sqlite3.SQLITE_LIMIT_COLUMN, 100),
        (sqlite3.SQLITE_LIMIT_EXPR_DEPTH, 50),
        (sqlite3.SQLITE_LIMIT_ATTACHED, 0),
        (sqlite3.SQLITE_LIMIT_TRIGGER_DEPTH, 1),
    ):
        connection.setlimit(limit, value)
    connection.execute("PRAGMA trusted_schema = OFF")
    connection.execute("PRAGMA cell_size_check = ON")


@contextlib.contextmanager
def bounded_work(connection: sqlite3.Connection, size: int) -> Iterator[None]:
    """End a reading that takes more steps than a file of so many bytes needs."""
    left = (STEPS + STEPS_A_BYTE * size) // STEPS_A_CALL

    def count() -> int:
        nonlocal left
        left -= 1
        return left < 0

    connection.set_progress_handler(count, STEPS_A_CALL)
    try:
        yield
    finally:
        connection.set_progress_handler(None, 0)


def check_tables(connection: sqlite3.Connection, path: str | os.PathLike[str]) -> int:
    """The version of a file whose tables are exactly ours, and not too long; else InputError."""
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    if version not in (FORMER, VERSION):
        raise InputError(
            f"{printable(path)}: of version {version}, expected {FORMER} or {VERSION}; a newer "
            "file needs a newer relgloss"
        )
    rows = connection.execute("SELECT type, name, tbl_name, sql FROM sqlite_master")
    found = frozenset(_plain(*row) for row in rows.fetchmany(100))
    if found not in _schemas(version):
        raise InputError(f"{printable(path)}: its tables are not a session's: {DAMAGED}")
    # A damaged index would leave answers out without a word.
    if connection.execute("PRAGMA integrity_check(1)").fetchone() != ("ok",):
        raise InputError(f"{printable(path)}: {DAMAGED}")
    for kind, name, *_ in found:
        if kind == "table":
            (count,) = connection.execute(f"SELECT count(*) FROM {name}").fetchone()
            if count > MOST_ROWS:
                raise InputError(f"{printable(path)}: more than {MOST_ROWS} rows in {name}")
    return int(version)


@lru_cache
def _schemas(version: int) -> tuple[frozenset[tuple[str, ...]], ...]:
    """What sqlite_master holds in files of a version."""
    first = TABLES
    for check in CHECKS:
        first = first.replace(check, "")
    schemas = []
    for tables in (TABLES, first):
        with contextlib.closing(sqlite3.connect(":memory:")) as connection:
            connection.executescript(tables if version == FORMER else tables + COUNTED_TABLES)
            rows = connection.execute("SELECT type, name, tbl_name, sql FROM sqlite_master")
            schemas.append(frozenset(_plain(*row) for row in rows))
    return tuple(schemas)


def _plain(*columns: object) -> tuple[str, ...]:
    """A row with white space as it may be."""
    return tuple(" ".join(str(column).split()) for column in columns)
