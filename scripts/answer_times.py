"""How long an answer takes to reach the disk, by each way of writing a session file.

    .venv/bin/python scripts/answer_times.py [--folder DIR] [--answers 100] [--turns 6]

The ways take turns, so that a disk that others use slows all of them. Prints the 10th percentile,
median, 95th percentile and largest, in milliseconds: the table of docs/experiment.md.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from unittest import mock

import numpy as np

from relgloss_view.experiment.design.study_file import load_study
from relgloss_view.experiment.design.trial_order import planned_trials
from relgloss_view.experiment.session import session_file
from relgloss_view.experiment.session.store import Store

#: Name, journal mode, synchronous, and whether a log's content is moved into the file at once.
WAYS = (
    ("kept journal (now)", session_file.JOURNAL_MODE, session_file.SYNCHRONOUS, False),
    ("cut journal", "TRUNCATE", "FULL", False),
    ("log, moved into the file", "WAL", "FULL", True),
    ("log alone", "WAL", "FULL", False),
    ("nothing synced", "PERSIST", "OFF", False),
)


@contextmanager
def _way(mode: str, synchronous: str) -> Iterator[None]:
    real = session_file.choose_journal
    with mock.patch.object(
        session_file, "choose_journal", lambda connection: real(connection, mode, synchronous)
    ):
        yield


def times_ms(folder: Path, answers: int, mode: str, synchronous: str, moved: bool) -> list[float]:
    """How long each answer of a session takes, the whole transaction."""
    study = load_study("paper")
    times = []
    with (
        tempfile.TemporaryDirectory(dir=folder) as name,
        _way(mode, synchronous),
        Store(Path(name) / "s.sqlite", study) as store,
    ):
        observer = store.observer()
        trials = planned_trials(study, observer.number)
        store.plan(observer, trials)
        run = store.begin_run(observer, "device", {})
        for trial in trials[:answers]:
            begun_s = time.perf_counter()
            store.answer(observer, trial, "ratio", 1, 0.5, run)
            if moved and store._connection is not None:
                store._connection.execute("PRAGMA wal_checkpoint(PASSIVE)").fetchone()
            times.append(1000.0 * (time.perf_counter() - begun_s))
    return times


def main() -> None:
    """Measure in turns, and print."""
    parser = argparse.ArgumentParser(description="Time the ways of storing an answer.")
    parser.add_argument("--folder", type=Path, default=Path(tempfile.gettempdir()))
    parser.add_argument("--answers", type=int, default=100)
    parser.add_argument("--turns", type=int, default=6)
    args = parser.parse_args()
    times: dict[str, list[float]] = {name: [] for name, *_ in WAYS}
    for _ in range(args.turns):
        for name, mode, synchronous, moved in WAYS:
            times[name] += times_ms(args.folder, args.answers, mode, synchronous, moved)
    heads = "".join(f"{head:>9}" for head in ("10 %", "median", "95 %", "largest"))
    print(f"{'way':<28}{heads}   ms, {args.turns * args.answers} answers each")
    for name, values in times.items():
        row = "".join(f"{v:>9.2f}" for v in np.percentile(values, (10, 50, 95, 100)))
        print(f"{name:<28}{row}")


if __name__ == "__main__":
    main()
