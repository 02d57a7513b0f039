"""Losses: what a session file is known to lack, or to hold otherwise than it was answered.

A loss is found when a file is opened. Whoever opens the file for writing puts it into the file,
which reports it from then on.
"""

from __future__ import annotations

import itertools
import os
import sqlite3
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from relgloss_view.base.reading import printable

#: Causes, as the file keeps them. The first two concern files of earlier versions, which kept
#: the last answers in a log beside the file.
LOG_MISSING = "log missing"
LOG_DAMAGED = "log damaged"
MISSING = "answers missing"
CHANGED = "answers changed"
UNCOUNTED = "answers uncounted"
CAUSES = (LOG_MISSING, LOG_DAMAGED, MISSING, CHANGED, UNCOUNTED)


@dataclass(frozen=True)
class Loss:
    """Something that was found to be lost or changed."""

    cause: str  #: one of CAUSES
    answers: int | None = None  #: how many answers; None where that can't be known


def read_losses(connection: sqlite3.Connection, *, has_table: bool) -> tuple[Loss, ...]:
    """Those that a file has kept. Raises ValueError for what no program has written.

    has_table: whether the file is of a version that has a table for them; before, it was an event.
    """
    query = "SELECT kind, NULL FROM event WHERE kind = ?"
    if has_table:
        query += " UNION ALL SELECT cause, answers FROM loss"
    losses = []
    for cause, answers in connection.execute(query, (LOG_MISSING,)):
        if cause not in CAUSES or not (
            answers is None or (isinstance(answers, int) and answers > 0)
        ):
            raise ValueError("loss")
        losses.append(Loss(cause, answers))
    return summed(losses)


def summed(losses: Iterable[Loss]) -> tuple[Loss, ...]:
    """The losses, each cause once: with the sum of its answers, None where one is not known."""
    sums: dict[str, int | None] = {}
    for loss in losses:
        before = sums.get(loss.cause, 0)
        both = None if before is None or loss.answers is None else before + loss.answers
        sums[loss.cause] = both
    return tuple(Loss(cause, answers) for cause, answers in sums.items())


def former_copies(file: str | os.PathLike[str]) -> list[Path]:
    """Copies of a file, as it was before it became one of the present version without its log."""
    file = Path(os.path.realpath(file))
    names = (former_name(file, number) for number in itertools.count(1))
    return list(itertools.takewhile(os.path.lexists, names))


def former_name(file: Path, number: int) -> Path:
    """The name of such a copy, the first, second, ..."""
    return file.with_name(f"{file.name}.former{'' if number == 1 else f'-{number}'}")


def sentences(losses: Sequence[Loss], path: str | os.PathLike[str]) -> list[str]:
    """Each loss in words, with what to do; without the file's name in front."""
    copies = former_copies(path)
    former = printable(copies[-1].name) if copies else ""
    return [_sentence(loss, Path(path).name, former) for loss in losses]


def warnings(losses: Sequence[Loss], path: str | os.PathLike[str]) -> list[str]:
    """Each loss as a warning that names the file."""
    return [f"{printable(path)}: {line}" for line in sentences(losses, path)]


def _sentence(loss: Loss, name: str, former: str) -> str:
    log = f"{printable(name)}-wal"
    if loss.cause == LOG_MISSING:
        return f"{log} is or was not beside it, and the last answers may be in that: " + (
            f"{former} is the file as it was; put its log beside that, as {former}-wal"
            if former
            else "copy both files, or run the study on once where both lie"
        )
    if loss.cause == LOG_DAMAGED:
        return (
            f"{log} is or was damaged, and the last answers may be missing; look for a copy of "
            "both files that is whole"
        )
    if loss.cause == MISSING:
        return (
            f"lacks {_answers(loss.answers)} that the program had stored; look for a newer or "
            "whole copy of it"
        )
    if loss.cause == UNCOUNTED:
        return (
            f"holds {_answers(loss.answers)} that the program did not count: a write was cut "
            "short, or another program has changed the file"
        )
    return (
        "its answers or trials were changed after they were given: the file was damaged or edited; "
        "look for a copy of it that is whole"
    )


def _answers(count: int | None) -> str:
    return "answers" if count is None else "1 answer" if count == 1 else f"{count} answers"
