"""A program that answers as fast as it can and prints the number of each answer once it is stored.

Run: python answering.py FILE.sqlite [former [COUNT]]. Answer k has the category that `category`
gives it, so whoever finds it can check it. former: as earlier versions wrote, into a log. COUNT:
answers after which it waits, its file open, until it is killed.
"""

from __future__ import annotations

import contextlib
import os
import sqlite3
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent))

from cases import study

from relgloss_view.experiment.design.trial_order import planned_trials
from relgloss_view.experiment.session.file_checks import CHECKS
from relgloss_view.experiment.session.store import Store
from relgloss_view.experiment.session.tally import ATTRIBUTE

REPEATS = 20


def made():
    return study(repeats=REPEATS, seed=5)


def category(number):
    return number * number % 7 % 5


def main(file):
    with Store(file, made()) as store:
        observer = store.observer()
        trials = planned_trials(store.study, observer.number)
        store.plan(observer, trials)
        run = store.begin_run(observer, "device", {})
        for number, trial in enumerate(trials):
            store.answer(observer, trial, "ratio", category(number), 0.5, run)
            os.write(1, f"{number}\n".encode())


def as_former(file, count):
    """Write a file of version 1, as the program did that wrote those."""
    with Store(file, made()) as store:
        observer = store.observer()
        trials = planned_trials(store.study, observer.number)
        store.plan(observer, trials)
        run = store.begin_run(observer, "device", {})
    to_former(file)
    connection = sqlite3.connect(file, isolation_level=None)
    connection.execute("PRAGMA locking_mode = EXCLUSIVE")
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = FULL")
    for number, trial in enumerate(trials):
        if number == count:
            time.sleep(3600.0)
        connection.execute(
            "INSERT INTO answer VALUES (NULL, ?, ?, 'ratio', ?, 500, ?, 'now', NULL)",
            (observer.number, trial.position, category(number), run),
        )
        os.write(1, f"{number}\n".encode())


def to_former(file, *, first=False):
    """Make a closed session file one of version 1; first: with the tables of its first files."""
    with contextlib.closing(sqlite3.connect(file, isolation_level=None)) as connection:
        if first:
            connection.execute("PRAGMA writable_schema = ON")
            for check in CHECKS:
                connection.execute("UPDATE sqlite_master SET sql = replace(sql, ?, '')", (check,))
            connection.execute("PRAGMA writable_schema = RESET")
        connection.executescript(
            "DROP TABLE tally; DROP TABLE loss; PRAGMA user_version = 1; VACUUM"
        )
    with contextlib.suppress(OSError, AttributeError):
        os.removexattr(file, ATTRIBUTE)


if __name__ == "__main__":
    if "former" in sys.argv:
        as_former(sys.argv[1], int(sys.argv[3]) if len(sys.argv) > 3 else None)
    else:
        main(sys.argv[1])
