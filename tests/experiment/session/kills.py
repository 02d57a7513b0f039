"""Kills a program that answers as fast as it can, and counts what becomes of its answers.

Run: python tests/experiment/session/kills.py --kills 1000 --workers 16 [--former]

After each kill the files are judged as they were left, and with their journal gone, cut, flipped,
renamed, or another session's in its place; with an older content of the file put back; and as a
copy of the file alone, made while the program was answering. An answer that the program had printed
is lost where it is not read back; in silence, where no line reports that. Status 1 if any is.

--former: answers are written as earlier versions did, into a log: the control, which loses some.
"""

from __future__ import annotations

import argparse
import collections
import concurrent.futures
import contextlib
import os
import random
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import answering

from relgloss_view.base.errors import InputError
from relgloss_view.experiment.session.records import read_record
from relgloss_view.experiment.session.store import Store

LONGEST_S = 0.25  #: until a kill, after the first answer
ALONE = "copied alone while open"
FAULTS = ("none", "gone", "cut", "flipped", "renamed", "another's", "older content", ALONE)
SIDES = ("-journal", "-wal")


def answers_in(file, acknowledged, folder):
    """(lost, silent, wrong, refused): acknowledged answers that are not read back, and how so.

    Read as `analyse` does, and then opened as `run` does; the worse of both counts.
    """
    worst = (0, 0, 0, 0)
    for read in (_as_analyse, _as_run):
        try:
            found, reported = read(file, folder)
        except InputError as error:
            assert len(str(error).splitlines()) == 1
            worst = max(worst, (0, 0, 0, 1))
            continue
        lost = sum(number not in found for number in range(acknowledged))
        wrong = sum(category != answering.category(number) for number, category in found.items())
        worst = max(worst, (lost, 0 if reported else lost + wrong, wrong, 0))
    return worst


def _as_analyse(file, folder):
    record = read_record(file, folder)
    return {a.trial.position: a.category for a in record.answers}, record.losses


def _as_run(file, folder):
    with Store(file) as store:
        return {a.trial.position: a.category for a in store.answers()}, store.losses


def one_kill(seed, former):
    """Kill once; (fault, lost, silent, wrong, refused, whether the journal was in use) of each."""
    hand = random.Random(seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        file = folder / "s.sqlite"
        words = [sys.executable, answering.__file__, str(file), *(["former"] if former else [])]
        process = subprocess.Popen(words, stdout=subprocess.PIPE)
        line = process.stdout.readline()
        assert line == b"0\n", line
        older, alive_s = file.read_bytes(), hand.random() * LONGEST_S
        copy_s = hand.random() * alive_s
        time.sleep(copy_s)
        os.set_blocking(process.stdout.fileno(), False)
        count = 1 + (process.stdout.read() or b"").count(b"\n")
        alone = (count, file.read_bytes())  # a moment, as for `cp`
        time.sleep(alive_s - copy_s)
        process.send_signal(signal.SIGKILL)
        process.wait()
        count += (process.stdout.read() or b"").count(b"\n")
        process.stdout.close()
        side = next((s for k in SIDES if (s := folder / f"s.sqlite{k}").exists()), None)
        hot = side is not None and side.read_bytes()[:1] not in (b"", b"\0")
        results = []
        for fault in FAULTS:
            place = folder / fault.replace(" ", "-")
            place.mkdir()
            copy = _with_fault(place, file, side, fault, hand, older, alone)
            acknowledged = alone[0] if fault == ALONE else count
            results.append((fault, *answers_in(copy, acknowledged, place), hot))
        return count, results


def _with_fault(place, file, side, fault, hand, older, alone):
    copy = place / file.name
    shutil.copyfile(file, copy)
    with contextlib.suppress(OSError, AttributeError):
        for attribute in os.listxattr(file):
            os.setxattr(copy, attribute, os.getxattr(file, attribute))
    if fault == ALONE:
        copy.unlink()
        copy.write_bytes(alone[1])
        return copy
    if side is None:
        return copy
    beside = place / side.name
    data = bytearray(side.read_bytes())
    if fault == "cut":
        data = data[: hand.randrange(len(data))] if data else data
    elif fault == "flipped" and data:
        data[hand.randrange(len(data))] ^= 1 << hand.randrange(8)
    elif fault == "another's":
        data = bytearray(_others_journal())
    elif fault == "older content":
        with open(copy, "r+b") as opened:  # as `cp` does: the same file, its content as before
            opened.write(older)
            opened.truncate()
    if fault == "renamed":
        (place / "log.old").write_bytes(data)
    elif fault != "gone":
        beside.write_bytes(data)
    return copy


def _others_journal():
    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "other.sqlite"
        with Store(file, answering.made()) as store:
            store.observer()
        return hot_journal(file)


def hot_journal(file):
    """The journal of a session that is closed, as a kill within a write leaves it."""
    with contextlib.closing(sqlite3.connect(file, isolation_level=None)) as connection:
        connection.execute("PRAGMA cache_size = 1")
        connection.execute("PRAGMA cache_spill = 1")  # so that the file is written before the end
        connection.execute("BEGIN")
        connection.execute("UPDATE answer SET category = 4")
        with contextlib.suppress(sqlite3.Error):  # the former version has none
            connection.execute("UPDATE tally SET answers = answers + 1")
        connection.execute("UPDATE observer SET begun_utc = 'other'")
        connection.execute("UPDATE study SET version = 'other'")
        connection.execute("UPDATE run SET version = 'other'")
        journal = Path(f"{file}-journal").read_bytes()
        connection.execute("ROLLBACK")
    return journal


def main(words=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--former", action="store_true")
    args = parser.parse_args(words)
    sums, hot, answers = collections.defaultdict(lambda: [0] * 5), 0, 0
    with concurrent.futures.ProcessPoolExecutor(args.workers) as pool:
        seeds = range(args.seed, args.seed + args.kills)
        for count, results in pool.map(one_kill, seeds, [args.former] * args.kills):
            answers += count
            hot += results[0][-1]
            for fault, *numbers, _ in results:
                lost, silent, wrong, refused = numbers
                for k, value in enumerate((lost > 0, lost, silent, wrong, refused)):
                    sums[fault][k] += value
    print(f"{args.kills} kills, {hot} within a write; {answers} answers acknowledged")
    heads = ("kills with a loss", "lost", "silent", "wrong", "refused")
    print(f"{'journal':<26}{heads[0]:>18}" + "".join(f"{head:>9}" for head in heads[1:]))
    for fault, (kills, lost, silent, wrong, refused) in sums.items():
        print(f"{fault:<26}{kills:>18}{lost:>9}{silent:>9}{wrong:>9}{refused:>9}")
    return sums


if __name__ == "__main__":
    totals = main()
    sys.exit(any(row[2] for row in totals.values()) or totals["none"][0] > 0)
