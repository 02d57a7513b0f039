"""What a session file holds, as values: observers, answers, runs, and the study itself."""

from __future__ import annotations

import dataclasses
import json
import sqlite3
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.experiment.design.study import QUESTIONS, Study
from relgloss_view.experiment.design.study_file import study_from_dict
from relgloss_view.experiment.design.trial_order import Trial
from relgloss_view.experiment.session import session_file

PERSON, SIMULATED = "person", "simulated"


@dataclass(frozen=True)
class Observer:
    """Who judges: a pseudonym, and the number that decides the order."""

    number: int  #: from 0, in the order of arrival
    name: str
    kind: str
    consented: bool
    ended: bool
    begun_utc: str = ""


@dataclass(frozen=True)
class Answer:
    """A standing answer; the category counts from 0, close, upwards."""

    observer: int
    trial: Trial
    question: str
    category: int
    response_s: float


@dataclass(frozen=True)
class Picture:
    """A picture as it was shown."""

    sample: int | None  #: of the study; None for the reference picture
    setting: int | None  #: of the grid
    sha256: str  #: of its digital values
    device: str


@dataclass(frozen=True)
class Run:
    """A program that showed pictures to an observer, from its start to its end."""

    id: int
    observer: int
    begun_utc: str
    ended_utc: str | None  #: None where it was killed
    version: str  #: of relgloss
    device: str
    screen: dict[str, Any]  #: window, monitor and platform


@dataclass(frozen=True)
class Record:
    """A session file as it was when it was read."""

    path: Path
    study: Study
    digest: str  #: of the study
    version: str  #: of the relgloss that made the file
    observers: tuple[Observer, ...]
    details: tuple[dict[str, Any], ...]  #: of each observer: how a simulated one was made
    answers: tuple[Answer, ...]  #: standing ones
    undone: int  #: answers that were taken back
    runs: tuple[Run, ...]
    pictures: tuple[Picture, ...]  #: what was shown
    log_missing: bool  #: after a kill the last answers are in a log, which is not beside the file


def read_record(path: Path, lamp_folder: Path) -> Record:
    """All of a session file; a lamp's table is put into `lamp_folder`. Raises InputError."""
    log_missing = session_file.log_missing(path)
    with session_file.open_to_read(path) as connection:
        study, digest = read_study(connection, lamp_folder, path)
        try:
            record = _record(path, connection, study, digest, log_missing)
            _check(record)
        except (ValueError, TypeError, LookupError, AttributeError, RecursionError) as error:
            raise InputError(
                f"{printable(path)}: a row in it is damaged ({printable(error, 80)}); take a copy "
                "of the file that is whole"
            ) from error
    return record


def _record(
    path: Path, connection: sqlite3.Connection, study: Study, digest: str, log_missing: bool
) -> Record:
    (version,) = connection.execute("SELECT version FROM study").fetchone()
    details = connection.execute("SELECT details FROM observer ORDER BY number").fetchall()
    (undone,) = connection.execute(
        "SELECT count(*) FROM answer WHERE undone_utc IS NOT NULL"
    ).fetchone()
    runs = connection.execute(
        "SELECT id, observer, begun_utc, ended_utc, version, device, screen FROM run ORDER BY id"
    ).fetchall()
    pictures = connection.execute(
        "SELECT sample, setting, sha256, device FROM picture ORDER BY sample, setting, rowid"
    ).fetchall()
    return Record(
        path=path,
        study=study,
        digest=digest,
        version=version,
        observers=tuple(read_observers(connection)),
        details=tuple(json.loads(text) for (text,) in details),
        answers=tuple(read_answers(connection)),
        undone=int(undone),
        runs=tuple(_run(*row) for row in runs),
        pictures=tuple(Picture(*row) for row in pictures),
        log_missing=log_missing,
    )


def _run(*columns: Any) -> Run:
    """A row of the table, in the order of Run's fields; `screen` is JSON."""
    run = Run(*columns)
    return dataclasses.replace(run, screen=json.loads(columns[-1]))


def _check(record: Record) -> None:
    """ValueError where a row says what no program has written."""
    study = record.study
    numbers = {observer.number for observer in record.observers}
    for observer in record.observers:
        _expect(isinstance(observer.name, str) and isinstance(observer.begun_utc, str), "observer")
        _expect(observer.kind in (PERSON, SIMULATED), "observer.kind")
    _expect(all(isinstance(details, dict) for details in record.details), "observer.details")
    for run in record.runs:
        _expect(isinstance(run.screen, dict), "run.screen")
        texts = (run.begun_utc, run.version, run.device)
        _expect(all(isinstance(text, str) for text in texts), "run")
    _expect(isinstance(record.version, str), "study.version")
    for answer in record.answers:
        trial = answer.trial
        _expect(answer.observer in numbers, "answer.observer")
        _expect(trial.sample in range(len(study.samples)), "trial.sample")
        _expect(trial.setting in range(len(study.grid)), "trial.setting")
        _expect(answer.question in QUESTIONS, "answer.question")
        _expect(answer.category in range(len(study.categories)), "answer.category")
        _expect(answer.response_s >= 0.0, "answer.response_ms")


def _expect(holds: bool, what: str) -> None:
    if not holds:
        raise ValueError(what)


def read_study(connection: sqlite3.Connection, lamp_folder: Path, path: Path) -> tuple[Study, str]:
    """The study of a session file and its digest; InputError where it is damaged."""
    with session_file.input_errors(path):
        content, digest, _ = connection.execute("SELECT * FROM study").fetchone() or ("", "", "")
    try:
        return study_from_dict(json.loads(content), lamp_folder), digest
    except InputError as error:
        raise InputError(f"{printable(path)}: the study in it: {error}") from error
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        raise InputError(f"{printable(path)}: the study in it is damaged") from error


def read_answers(connection: sqlite3.Connection, observer: int | None = None) -> list[Answer]:
    """Standing answers of a session file, by observer and position; of one observer or of all."""
    chosen, values = ("", ()) if observer is None else ("AND a.observer = ? ", (observer,))
    rows = connection.execute(
        "SELECT a.observer, t.position, t.sample, t.setting, t.repeat, a.question, a.category, "
        "a.response_ms FROM answer a JOIN trial t USING (observer, position) "
        f"WHERE a.undone_utc IS NULL {chosen}ORDER BY a.observer, t.position, a.id",
        values,
    )
    return [
        Answer(observer, Trial(position, sample, setting, repeat), question, category, ms / 1000.0)
        for observer, position, sample, setting, repeat, question, category, ms in rows
    ]


def read_observers(connection: sqlite3.Connection) -> list[Observer]:
    """The observers of a session file, by number."""
    rows = connection.execute(
        "SELECT number, name, kind, consented_utc, ended_utc, begun_utc FROM observer "
        "ORDER BY number"
    )
    return [
        Observer(number, name, kind, consented is not None, ended is not None, begun)
        for number, name, kind, consented, ended, begun in rows
    ]
