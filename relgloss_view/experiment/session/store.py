"""Store: the answers of a study on the disk, each whole before the next stimulus shows.

Nothing is ever taken out: an answer that was undone stays and says so. A program that is killed
leaves a file that goes on where it stood.
"""

from __future__ import annotations

import contextlib
import json
import os
import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.shell import command_line, operand
from relgloss_view.base.temporaries import scratch_folder
from relgloss_view.base.version import __version__
from relgloss_view.display.kept_file import KeptFile
from relgloss_view.display.record import OPTION, DisplayRecord
from relgloss_view.experiment.design.study import Study
from relgloss_view.experiment.design.study_file import study_digest, study_to_dict
from relgloss_view.experiment.design.trial_order import Trial
from relgloss_view.experiment.session import session_file, tally
from relgloss_view.experiment.session.records import (
    DISPLAY,
    PERSON,
    Answer,
    Observer,
    Run,
    damaged_rows,
    read_answers,
    read_details,
    read_display_files,
    read_observers,
    read_runs,
    read_study,
    read_trials,
)
from relgloss_view.experiment.session.sitting import Sitting

LONGEST_NAME = 40


class Store:
    """A session file, open for one program alone. Close it, or use it as a context.

    Every method that writes has written when it returns; InputError says what hindered it.
    """

    def __init__(self, path: str | os.PathLike[str], study: Study | None = None) -> None:
        """Open a session file, or make it for a study; an existing one must be of that study."""
        self.path = Path(path)
        content = None if study is None else study_to_dict(study)
        if content is not None and not os.path.lexists(path):
            written = json.dumps(content, allow_nan=False)
            session_file.create_file(path, written, study_digest(content), __version__)
        opened = session_file.open_to_write(path)
        self._connection: sqlite3.Connection | None = opened.connection
        assert opened.tally is not None
        self._tally = self._next = opened.tally  #: what is written, and what the next write has
        self._file = os.path.realpath(path)
        self._in_batch = False
        self._whereabouts: tuple[object, ...] | None = None  #: from the first write on
        self.losses = opened.losses  #: what the file is known to lack of what was answered
        self._lamps = contextlib.ExitStack()
        try:
            self._folder = self._lamps.enter_context(scratch_folder())
            held, digest, _ = read_study(self._connection, self._folder, self.path)
            if content is not None and study_digest(content) != digest:
                line = command_line(["relgloss", "experiment", "run", operand(path)])
                raise InputError(
                    f"{printable(path)}: holds answers to another study, or to this one before it "
                    f"was edited; give another file with -o, or continue with `{line}`"
                )
        except BaseException:
            self.close()
            raise
        self.study = held

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Give the file back; harmless when that was done."""
        connection, self._connection = self._connection, None
        if connection is not None:
            try:
                session_file.close(connection, self.path)
            finally:
                self._lamps.close()

    # --- observers and runs -------------------------------------------------------------------

    def observers(self) -> list[Observer]:
        """All so far, by number."""
        assert self._connection is not None
        with damaged_rows(self.path):
            return read_observers(self._connection)

    def observer(
        self, name: str | None = None, kind: str = PERSON, details: Mapping[str, Any] | None = None
    ) -> Observer:
        """The observer of a name, made if new; without a name who is not done yet, or a new one.

        A name is a pseudonym of up to 40 printable characters. InputError where it is none, or
        where this observer is through.
        """
        observers = self.observers()
        if name is None:
            unfinished = [o for o in observers if not o.ended and o.kind == kind]
            if unfinished:
                return unfinished[0]
            name = _free_name({o.name for o in observers})
        name = name.strip()
        if not (1 <= len(name) <= LONGEST_NAME and name.isprintable()):
            raise InputError(
                f"observer {printable(name, 60)!r}: expected a pseudonym of 1 to {LONGEST_NAME} "
                "printable characters"
            )
        for other in observers:
            if other.name == name:
                if other.ended:
                    raise InputError(
                        f"observer {name!r} has finished this study; give another name"
                    )
                return other
        return self._make_observer(name, kind, details)

    def details(self, observer: Observer) -> dict[str, Any]:
        """How an observer was made; empty for people."""
        assert self._connection is not None
        with damaged_rows(self.path):
            return read_details(self._connection, observer.number)

    def new_observer(self) -> Observer:
        """A new person under a free pseudonym, whoever is not finished yet."""
        return self._make_observer(_free_name({o.name for o in self.observers()}), PERSON, None)

    def _make_observer(self, name: str, kind: str, details: Mapping[str, Any] | None) -> Observer:
        number = 1 + max((o.number for o in self.observers()), default=-1)
        made = Observer(number, name, kind, False, False, _now())
        with self._writing() as connection:
            connection.execute(
                "INSERT INTO observer VALUES (?, ?, ?, ?, NULL, NULL, ?)",
                (made.number, name, kind, made.begun_utc, json.dumps(dict(details or {}))),
            )
        return made

    def consent(self, observer: Observer) -> None:
        """Keep that the observer has agreed."""
        self._mark(observer, "consented_utc")

    def end(self, observer: Observer) -> None:
        """Keep that the observer is through."""
        self._mark(observer, "ended_utc")

    def begin_run(
        self,
        observer: Observer,
        device: str,
        screen: Mapping[str, Any],
        profile: bytes | None = None,
        sitting: Sitting | None = None,
    ) -> int:
        """Keep that a program starts to show pictures: on what device and screen; its number.

        profile: the monitor's, which pictures are not drawn for. sitting: the display that they are
        drawn for; its file, where there is no `profile`, is kept by the first run that has it.
        """
        kept = dict(screen)
        if sitting is not None:
            kept[DISPLAY] = sitting.record.to_dict()
            if profile is None and sitting.file is not None:
                profile = sitting.file.to_bytes()
                if self._rows("SELECT 1 FROM run WHERE profile = ? LIMIT 1", profile):
                    profile = None
        with self._writing() as connection:
            row = connection.execute(
                "INSERT INTO run VALUES (NULL, ?, ?, NULL, ?, ?, ?, ?)",
                (observer.number, _now(), __version__, device, json.dumps(kept), profile),
            )
            assert row.lastrowid is not None
        return row.lastrowid

    def answered_displays(self, observer: Observer) -> list[DisplayRecord | None]:
        """The displays of an observer's runs that have standing answers, None: not recorded."""
        answered = {answer.run for answer in self.answers(observer)}
        return [run.display for run in self._runs() if run.id in answered]

    def last_given_display(self) -> str | None:
        """The file that was last given with --display, put where drawing finds it; None: none."""
        assert self._connection is not None
        displays = [run.display for run in self._runs()]
        given = [d.digest for d in displays if d is not None and d.origin == OPTION]
        if not given:
            return None
        with damaged_rows(self.path):
            files = read_display_files(self._connection, {given[-1]})
        return self.put(files[0]) if files else None

    def put(self, file: KeptFile) -> str:
        """Write a display's file where drawing finds it until the store is closed; its path."""
        return file.put_into(self._folder)

    def _runs(self) -> list[Run]:
        assert self._connection is not None
        with damaged_rows(self.path):
            return read_runs(self._connection)

    def end_run(self, run: int) -> None:
        """Keep that the program ended by itself, and was not killed."""
        with self._writing() as connection:
            connection.execute("UPDATE run SET ended_utc = ? WHERE id = ?", (_now(), run))

    def note(self, run: int, kind: str, detail: str = "") -> None:
        """Keep something that happened: a pause, the end of the adaptation, an undone answer."""
        with self._writing() as connection:
            connection.execute(
                "INSERT INTO event VALUES (NULL, ?, ?, ?, ?)", (run, _now(), kind, detail)
            )

    # --- trials and answers -------------------------------------------------------------------

    def trials(self, observer: Observer) -> list[Trial]:
        """What the observer sees and has seen, in order."""
        assert self._connection is not None
        with damaged_rows(self.path):
            return read_trials(self._connection, self.study, observer.number)

    def plan(self, observer: Observer, trials: Sequence[Trial]) -> None:
        """Keep trials that are to come; all of them or none."""
        with self._writing() as connection:
            connection.executemany(
                "INSERT INTO trial VALUES (?, ?, ?, ?, ?)",
                [(observer.number, t.position, t.sample, t.setting, t.repeat) for t in trials],
            )

    def answer(
        self, observer: Observer, trial: Trial, question: str, category: int, response_s: float,
        run: int,
    ) -> None:  # fmt: skip
        """Keep an answer. When this returns it is on the disk, whatever happens next.

        Within a `batch` it is there when that ends.
        """
        place = (observer.number, trial.position)
        values = (question, category, round(1000.0 * response_s), run, _now())
        with self._writing() as connection:
            row = connection.execute(
                "INSERT INTO answer VALUES (NULL, ?, ?, ?, ?, ?, ?, ?, NULL)", (*place, *values)
            )
            stimulus = (trial.sample, trial.setting, trial.repeat)
            self._next = self._next.answered((row.lastrowid, *place, *stimulus, *values))

    def undo(self, observer: Observer, run: int, *, drop_unanswered: bool = False) -> Trial | None:
        """Take the observer's last standing answer back; its trial, None where there is none.

        With `drop_unanswered`, later trials that were never answered are unplanned: they were
        chosen by what is now undone.
        """
        rows = self._rows(
            "SELECT id, position FROM answer WHERE observer = ? AND undone_utc IS NULL "
            "ORDER BY position DESC, id DESC LIMIT 1",
            observer.number,
        )
        if not rows:
            return None
        answer, position = rows[0]
        with self._writing() as connection:
            connection.execute("UPDATE answer SET undone_utc = ? WHERE id = ?", (_now(), answer))
            self._next = self._next.taken_back()
            connection.execute(
                "INSERT INTO event VALUES (NULL, ?, ?, 'undo', ?)", (run, _now(), str(position))
            )
            if drop_unanswered:
                connection.execute(
                    "DELETE FROM trial WHERE observer = ?1 AND position > ?2 AND NOT EXISTS "
                    "(SELECT 1 FROM answer WHERE observer = ?1 AND position = trial.position)",
                    (observer.number, position),
                )
        with damaged_rows(self.path):
            (trial,) = (t for t in self.trials(observer) if t.position == position)
        return trial

    def answers(self, observer: Observer | None = None) -> list[Answer]:
        """Standing answers, by observer and position; of one observer or of all."""
        assert self._connection is not None
        with damaged_rows(self.path):
            number = None if observer is None else observer.number
            return read_answers(self._connection, self.study, number)

    def keep_picture(
        self, run: int, sample: int | None, setting: int | None, sha256: str, device: str,
        parameters: Mapping[str, Any],
    ) -> None:  # fmt: skip
        """Keep what a picture was, so that it can be told whether it is drawn again the same.

        The reference picture has neither sample nor setting. Kept once for each device and result.
        """
        with self._writing() as connection:
            connection.execute(
                "INSERT OR IGNORE INTO picture VALUES (?, ?, ?, ?, ?, ?)",
                (sample, setting, sha256, device, json.dumps(dict(parameters)), run),
            )

    def _mark(self, observer: Observer, column: str) -> None:
        with self._writing() as connection:
            connection.execute(
                f"UPDATE observer SET {column} = ? WHERE number = ? AND {column} IS NULL",
                (_now(), observer.number),
            )

    def _rows(self, query: str, *values: object) -> list[Any]:
        assert self._connection is not None
        with damaged_rows(self.path):
            return self._connection.execute(query, values).fetchall()

    @contextlib.contextmanager
    def batch(self) -> Iterator[None]:
        """One transaction for all that the block writes: on the disk when it ends, or none of it.

        For simulated observers: a transaction waits for the disk, however much is in it.
        """
        with self._writing():
            self._in_batch = True
            try:
                yield
            finally:
                self._in_batch = False

    @contextlib.contextmanager
    def _writing(self) -> Iterator[sqlite3.Connection]:
        """A transaction: on the disk when the block ends, undone where it can't be."""
        assert self._connection is not None
        with session_file.input_errors(self.path):
            if self._in_batch:
                yield self._connection
                return
            self._check_whereabouts()
            self._connection.execute("BEGIN IMMEDIATE")
            try:
                self._next = self._tally.written()
                yield self._connection
                tally.write_tally(self._connection, self._next)
                self._connection.execute("COMMIT")
            except BaseException:
                with contextlib.suppress(sqlite3.Error):
                    self._connection.execute("ROLLBACK")
                raise
            before, self._tally = self._tally, self._next
            if self._whereabouts is None:
                self._whereabouts = session_file.whereabouts(self._file)
        if (before.answers, before.undone) != (self._tally.answers, self._tally.undone):
            tally.remember(self._file, self._tally)

    def _check_whereabouts(self) -> None:
        """Raise InputError where the file or its journal is not what this program has open."""
        known = self._whereabouts
        if known is not None and session_file.whereabouts(self._file) != known:
            raise InputError(
                f"{printable(self.path)}: the file, or {printable(self.path.name)}-journal, was "
                "moved, replaced or removed while it is in use; put it back, or end here"
            )


def _free_name(taken: set[str]) -> str:
    """A pseudonym that nobody has: O01, O02, ..."""
    number = 1
    while f"O{number:02d}" in taken:
        number += 1
    return f"O{number:02d}"


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")
