"""What a session file holds, as values: observers, answers, runs, and the study itself."""

from __future__ import annotations

import contextlib
import os
import sqlite3
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.json_files import parse_json
from relgloss_view.base.reading import printable
from relgloss_view.display.kept_file import KeptFile
from relgloss_view.display.record import DisplayRecord
from relgloss_view.experiment.design.study import QUESTIONS, Study
from relgloss_view.experiment.design.study_file import study_from_dict
from relgloss_view.experiment.design.trial_order import Trial
from relgloss_view.experiment.session import session_file
from relgloss_view.experiment.session.losses import Loss

PERSON, SIMULATED = "person", "simulated"
MOST_TEXT = 65_536  #: characters of a text, but for the study's
MOST_DEPTH, MOST_VALUES = 4, 2_000  #: of a value in JSON
MOST_STUDY_VALUES = 5_000_000  #: of a study in JSON, with its materials
DISPLAY = "display"  #: of a run's screen: the record of what pictures were drawn for
LARGEST = 2**53  #: of numbers without another limit; a float holds each below exactly


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
    run: int = 0


@dataclass(frozen=True)
class Picture:
    """A picture as it was shown."""

    sample: int | None  #: of the study; None for the reference picture
    setting: int | None  #: of the grid
    sha256: str  #: of its digital values
    device: str
    run: int  #: in which it was shown first


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
    display: DisplayRecord | None = None  #: that pictures were drawn for; None in older files


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
    losses: tuple[Loss, ...]  #: what it is known to lack of what was answered
    display_files: tuple[KeptFile, ...] = ()  #: those that runs have kept, each once


def read_record(path: Path, lamp_folder: Path) -> Record:
    """All of a session file; a lamp's table is put into `lamp_folder`. Raises InputError."""
    with damaged_rows(path), session_file.open_to_read(path) as opened:
        connection = opened.connection
        study, digest, version = read_study(connection, lamp_folder, path)
        observers = read_observers(connection)
        (undone,) = connection.execute(
            "SELECT count(*) FROM answer WHERE undone_utc IS NOT NULL"
        ).fetchone()
        runs = tuple(_read_runs(connection))
        return Record(
            path=path,
            study=study,
            digest=digest,
            version=version,
            observers=tuple(observers),
            details=tuple(read_details(connection, o.number) for o in observers),
            answers=tuple(read_answers(connection, study)),
            undone=int(undone),
            runs=runs,
            pictures=tuple(_read_pictures(connection)),
            losses=opened.losses,
            display_files=read_display_files(
                connection, {run.display.digest for run in runs if run.display}
            ),
        )


@contextlib.contextmanager
def damaged_rows(path: str | os.PathLike[str]) -> Iterator[None]:
    """Turn whatever a damaged row leads to into one line; for code that only reads rows.

    Any exception: what a decoder may raise on what nobody has thought of is not known.
    """
    try:
        with session_file.input_errors(path):
            yield
    except InputError:
        raise
    except Exception as error:
        raise InputError(
            f"{printable(path)}: a row in it is damaged ({printable(error, 80)}); take a copy of "
            "the file that is whole"
        ) from error


def read_study(
    connection: sqlite3.Connection, lamp_folder: Path, path: Path
) -> tuple[Study, str, str]:
    """The study of a session file, its digest, and the version of relgloss that made the file.

    InputError where it is damaged.
    """
    damaged = InputError(f"{printable(path)}: the study in it is damaged")
    with session_file.input_errors(path):
        row = connection.execute("SELECT content, digest, version FROM study").fetchone()
    if row is None or not all(isinstance(column, str) for column in row[:2]):
        raise damaged
    content, digest, version = row
    with damaged_rows(path):
        version = _text(version, "study.version")
    try:
        return study_from_dict(parse_json(content, MOST_STUDY_VALUES), lamp_folder), digest, version
    except InputError as error:
        raise InputError(f"{printable(path)}: the study in it: {error}") from error
    except Exception as error:
        raise damaged from error


# What follows raises whatever a damaged row leads to: call it within `damaged_rows`.


def read_observers(connection: sqlite3.Connection) -> list[Observer]:
    """The observers of a session file, by number."""
    rows = connection.execute(
        "SELECT number, name, kind, consented_utc, ended_utc, begun_utc FROM observer "
        "ORDER BY number"
    )
    return [
        Observer(
            _whole(number, "observer.number"),
            _text(name, "observer.name"),
            _one_of((PERSON, SIMULATED), kind, "observer.kind"),
            consented is not None,
            ended is not None,
            _text(begun, "observer.begun_utc"),
        )
        for number, name, kind, consented, ended, begun in rows
    ]


def read_details(connection: sqlite3.Connection, observer: int) -> dict[str, Any]:
    """How an observer was made; empty for people."""
    ((text,),) = connection.execute("SELECT details FROM observer WHERE number = ?", (observer,))
    return _object(text, "observer.details")


def read_trials(connection: sqlite3.Connection, study: Study, observer: int) -> list[Trial]:
    """What an observer sees and has seen, in order."""
    rows = connection.execute(
        "SELECT position, sample, setting, repeat FROM trial WHERE observer = ? ORDER BY position",
        (observer,),
    )
    return [_trial(study, *row) for row in rows]


def read_answers(
    connection: sqlite3.Connection, study: Study, observer: int | None = None
) -> list[Answer]:
    """Standing answers of a session file, by observer and position; of one observer or of all."""
    chosen, values = ("", ()) if observer is None else ("AND a.observer = ? ", (observer,))
    rows = connection.execute(
        "SELECT a.observer, t.position, t.sample, t.setting, t.repeat, a.question, a.category, "
        "a.response_ms, a.run FROM answer a JOIN trial t USING (observer, position) "
        f"WHERE a.undone_utc IS NULL {chosen}ORDER BY a.observer, t.position, a.id",
        values,
    )
    return [
        Answer(
            _whole(observer, "answer.observer"),
            _trial(study, *trial),
            _one_of(QUESTIONS, question, "answer.question"),
            _whole(category, "answer.category", len(study.categories)),
            _whole(response_ms, "answer.response_ms") / 1000.0,
            _whole(run, "answer.run"),
        )
        for observer, *trial, question, category, response_ms, run in rows
    ]


def read_runs(connection: sqlite3.Connection) -> list[Run]:
    """The runs of a session file, in their order."""
    return list(_read_runs(connection))


def _read_runs(connection: sqlite3.Connection) -> Iterator[Run]:
    rows = connection.execute(
        "SELECT id, observer, begun_utc, ended_utc, version, device, screen FROM run ORDER BY id"
    )
    for number, observer, begun, ended, version, device, screen in rows:
        kept = _object(screen, "run.screen")
        display = kept.pop(DISPLAY, None)
        yield Run(
            _whole(number, "run.id"),
            _whole(observer, "run.observer"),
            _text(begun, "run.begun_utc"),
            None if ended is None else _text(ended, "run.ended_utc"),
            _text(version, "run.version"),
            _text(device, "run.device"),
            kept,
            None if display is None else DisplayRecord.from_dict(display),
        )


def read_display_files(connection: sqlite3.Connection, digests: set[str]) -> tuple[KeptFile, ...]:
    """The files of displays that runs have kept, those of some digests, each once."""
    files: dict[str, KeptFile] = {}
    if digests:
        rows = connection.execute("SELECT profile FROM run WHERE profile IS NOT NULL ORDER BY id")
        for (value,) in rows:
            # A damaged file is none: its digest, which the record states, finds nothing.
            with contextlib.suppress(ValueError, KeyError, TypeError, AttributeError, InputError):
                file = KeptFile.from_bytes(value)
                if file.digest in digests:
                    files.setdefault(file.digest, file)
    return tuple(files.values())


def _read_pictures(connection: sqlite3.Connection) -> Iterator[Picture]:
    rows = connection.execute(
        "SELECT sample, setting, sha256, device, first_run FROM picture "
        "ORDER BY sample, setting, rowid"
    )
    for sample, setting, sha256, device, run in rows:
        yield Picture(
            None if sample is None else _whole(sample, "picture.sample"),
            None if setting is None else _whole(setting, "picture.setting"),
            _text(sha256, "picture.sha256"),
            _text(device, "picture.device"),
            _whole(run, "picture.first_run"),
        )


def _trial(study: Study, position: Any, sample: Any, setting: Any, repeat: Any) -> Trial:
    return Trial(
        _whole(position, "trial.position"),
        _whole(sample, "trial.sample", len(study.samples)),
        _whole(setting, "trial.setting", len(study.grid)),
        _whole(repeat, "trial.repeat"),
    )


def _whole(value: object, what: str, count: int | None = None) -> int:
    """A whole number from 0, below `count`; ValueError for what no program has written."""
    if not (isinstance(value, int) and 0 <= value < (LARGEST if count is None else count)):
        raise ValueError(what)
    return value


def _text(value: object, what: str) -> str:
    if not (isinstance(value, str) and len(value) <= MOST_TEXT):
        raise ValueError(what)
    return value


def _one_of(choices: Iterable[str], value: object, what: str) -> str:
    if value not in tuple(choices):
        raise ValueError(what)
    return str(value)


def _object(written: object, what: str) -> dict[str, Any]:
    """An object in JSON as programs write it: flat, short, with finite numbers."""
    try:
        content = parse_json(_text(written, what), MOST_VALUES)
        left = _checked(content, MOST_DEPTH, MOST_VALUES)
    except (InputError, ValueError):
        raise ValueError(what) from None
    if not isinstance(content, dict) or left < 0:
        raise ValueError(what)
    return content


def _checked(value: Any, depth: int, left: int) -> int:
    """How many values are left of `left` after this one; ValueError for what may not be there."""
    if isinstance(value, dict | list):
        if depth == 0:
            raise ValueError("too deep")
        if isinstance(value, dict):
            value = [*value, *value.values()]
        for each in value:
            left = _checked(each, depth - 1, left)
    elif isinstance(value, str):
        value.encode("utf-8")  # UnicodeEncodeError, a ValueError: a lone surrogate
    elif isinstance(value, int | float) and not abs(value) <= LARGEST:  # also NaN
        raise ValueError("too large")
    return left - 1
