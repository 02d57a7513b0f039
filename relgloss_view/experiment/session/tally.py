"""Tally: how many answers a session file has ever taken, and a chain of digests over them.

The tally is written in the same transaction as an answer, so a file whose answers do not agree
with it has lost some or was changed. A second copy lies outside the file's content, as an extended
attribute: an older content of the same file does not agree with that. A copy of the file without
the attribute is judged by its content alone.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import secrets
import sqlite3
from dataclasses import dataclass, replace
from typing import Any

from relgloss_view.experiment.session.losses import CHANGED, MISSING, UNCOUNTED, Loss

START = "0" * 64  #: the chain of no answer
ATTRIBUTE = "user.relgloss.tally"
MOST_ATTRIBUTE_BYTES = 400
#: What of an answer is in the chain, and whether it was taken back.
ROWS = (
    "SELECT a.id, a.observer, a.position, t.sample, t.setting, t.repeat, a.question, a.category, "
    "a.response_ms, a.run, a.answered_utc, a.undone_utc IS NOT NULL "
    "FROM answer a LEFT JOIN trial t ON t.observer = a.observer AND t.position = a.position "
    "ORDER BY a.id"
)


@dataclass(frozen=True)
class Tally:
    """What was counted."""

    session: str  #: 32 hexadecimal digits, made with the file
    writes: int  #: transactions
    answers: int  #: ever stored, with those that were taken back
    undone: int  #: of them
    chain: str  #: SHA-256 over all answers, 64 hexadecimal digits
    study: str  #: SHA-256 of the study's text

    def written(self) -> Tally:
        """After one more transaction."""
        return replace(self, writes=self.writes + 1)

    def answered(self, row: tuple[Any, ...]) -> Tally:
        """After one more answer; row: its columns as in ROWS, without the last."""
        return replace(self, answers=self.answers + 1, chain=link(self.chain, row))

    def taken_back(self) -> Tally:
        """After one answer was taken back."""
        return replace(self, undone=self.undone + 1)


@dataclass(frozen=True)
class Recount:
    """What the rows of a file hold."""

    answers: int  #: with a trial
    orphans: int  #: whose trial is not there
    undone: int
    chain: str
    chain_at: dict[int, str]  #: after so many answers, for the numbers that were asked for


def link(chain: str, row: tuple[Any, ...]) -> str:
    """The chain after one more answer."""
    return hashlib.sha256(f"{chain}\n{row!a}".encode("ascii")).hexdigest()


def recount(connection: sqlite3.Connection, *wanted: int) -> Recount:
    """Count the answers anew, and chain them; `wanted`: where the chain is asked for too."""
    count = orphans = undone = 0
    chain = START
    chain_at = {0: START}
    for *row, taken_back in connection.execute(ROWS):
        count += 1
        orphans += row[3] is None
        undone += taken_back
        chain = link(chain, tuple(row))
        if count in wanted:
            chain_at[count] = chain
    return Recount(count - orphans, orphans, undone, chain, chain_at)


def new_tally(connection: sqlite3.Connection, content: str) -> Tally:
    """The tally of a file that has none yet, from its rows."""
    rows = recount(connection)
    return Tally(secrets.token_hex(16), 0, rows.answers + rows.orphans, rows.undone, rows.chain,
                 study_hash(content))  # fmt: skip


def recounted(connection: sqlite3.Connection, tally: Tally) -> Tally:
    """The tally of the rows as they are, where it did not agree with them."""
    rows = recount(connection)
    return replace(tally, answers=rows.answers + rows.orphans, undone=rows.undone, chain=rows.chain)


def study_hash(content: object) -> str:
    """The digest of the study's text as it lies in the file; of nothing else than a text."""
    text = content if isinstance(content, str) else repr(type(content))
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def read_tally(connection: sqlite3.Connection) -> Tally:
    """The tally of a file; ValueError for what no program has written."""
    rows = connection.execute(
        "SELECT session, writes, answers, undone, chain, study FROM tally"
    ).fetchmany(2)
    if len(rows) != 1:
        raise ValueError("tally")
    tally = Tally(*rows[0])
    texts, counts = (tally.session, tally.chain, tally.study), (tally.writes, tally.answers)
    if not all(isinstance(x, str) and x.isalnum() and len(x) <= 64 for x in texts):
        raise ValueError("tally")
    if not all(isinstance(n, int) and 0 <= n < 2**53 for n in (*counts, tally.undone)):
        raise ValueError("tally")
    return tally


def write_tally(connection: sqlite3.Connection, tally: Tally) -> None:
    """Put the tally in place of the last one; call it within a transaction."""
    connection.execute(
        "UPDATE tally SET session = ?, writes = ?, answers = ?, undone = ?, chain = ?, study = ?",
        (tally.session, tally.writes, tally.answers, tally.undone, tally.chain, tally.study),
    )


def find_losses(
    connection: sqlite3.Connection, tally: Tally | None, witness: Tally | None
) -> tuple[Loss, ...]:
    """What the rows lack of what was counted. At most one loss.

    tally: the file's own; None for a file of a version that had none.
    witness: the attribute's, which counts if it is of the same session.
    """
    if tally is None:
        rows = recount(connection)
        return (Loss(MISSING, rows.orphans),) if rows.orphans else ()
    counted = [tally]
    if witness is not None and witness.session == tally.session:
        counted.append(witness)
    rows = recount(connection, *(t.answers for t in counted))
    total = rows.answers + rows.orphans
    same = [rows.chain_at.get(t.answers) == t.chain and t.undone <= rows.undone for t in counted]
    if all(same) and (total, rows.undone) == (tally.answers, tally.undone):
        return ()
    most = max(t.answers for t in counted)
    if rows.answers < most:
        return (Loss(MISSING, most - rows.answers),)
    if all(same) and total > tally.answers:
        return (Loss(UNCOUNTED, total - tally.answers),)
    return (Loss(CHANGED),)


def remember(path: str | os.PathLike[str], tally: Tally) -> None:
    """Keep the tally beside the file's content, where the file system can."""
    words = f"{tally.session} {tally.answers} {tally.undone} {tally.chain}"
    with contextlib.suppress(OSError, AttributeError):  # no such attributes; not Linux
        os.setxattr(path, ATTRIBUTE, words.encode("ascii"))


def recall(path: str | os.PathLike[str]) -> Tally | None:
    """The tally that was kept beside the file's content; None where there is none."""
    try:
        words = os.getxattr(path, ATTRIBUTE)[:MOST_ATTRIBUTE_BYTES].decode("ascii").split()
        session, answers, undone, chain = words
        return Tally(session, 0, int(answers), int(undone), chain, "")
    except (OSError, AttributeError, ValueError):
        return None
