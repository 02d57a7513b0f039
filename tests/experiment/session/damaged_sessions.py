"""Session files that are damaged at random, and what the program makes of each.

Run: python tests/experiment/session/damaged_sessions.py --count 100000 --workers 16

Each file is read as `analyse` and `export` do, and opened as `run` does. Anything but a result or
one line (InputError) is a fault; status 1 if there is any. Prints the slowest, and the memory.
"""

from __future__ import annotations

import argparse
import collections
import concurrent.futures
import contextlib
import json
import os
import random
import resource
import shutil
import sqlite3
import sys
import tempfile
import time
import traceback
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent))
sys.path.insert(0, str(Path(__file__).parent))

import answering
import kills
from cases import percepts, study

from relgloss_view.base.errors import InputError
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.observers.population import Population
from relgloss_view.experiment.observers.simulation import run_observers
from relgloss_view.experiment.report import sentences
from relgloss_view.experiment.report.results import as_numbers
from relgloss_view.experiment.report.tables import answer_rows
from relgloss_view.experiment.session import tally
from relgloss_view.experiment.session.flow import Flow
from relgloss_view.experiment.session.pool import read_pool
from relgloss_view.experiment.session.records import PERSON
from relgloss_view.experiment.session.store import Store
from relgloss_view.experiment.verdict.analysis import Options, analyse
from relgloss_view.picture.scene.setting import Setting

SMALL = Grid((0.0, 2.0), (0.5, 1.0))
ANALYSED = 0.1  #: share of the files that are analysed too, which takes longest
TEXTS = (
    "", "?", "{}", "[]", "[[[[", "[" * 100_000, "{" * 3000, '{"a":' * 2000 + "1" + "}" * 2000,
    "[" * 900 + "]" * 900, '{"truths": 3}', '{"truths": {"matte-coated": [1e999, 2]}}',
    '{"truths": {"matte-coated": [1, NaN]}}', '{"truths": {"matte-coated": [[1], 2]}}',
    '{"kind": ["x"], "truths": []}', '{"a": ' + "9" * 4000 + "}", '{"a": ' + "9" * 400 + "}",
    '{"a": "\\ud800"}', '{"file": 3, "observer": {}}', "null", "true", "1e999", '"x"', "\0", "a\0b",
    "\x1b[31mred", "\u202eabc", "x" * 70_000, "x" * 2_000_000, "é" * 100, "\U0010ffff", "person",
    "simulated", "ratio", "grain", "log missing", "-1", "nan", "2026-99-99T99:99:99", "=1+1",
)  # fmt: skip
VALUES = (
    *TEXTS, None, 0, 1, 2, -1, 2**31, 2**53, 2**53 + 1, 2**63 - 1, -(2**63), 0.5, 1.0, -0.0, 1e300,
    float("inf"), float("-inf"), float("nan"), b"", b"\xff\xfe", b"x" * 100, b"\0" * 5000,
)  # fmt: skip
#: SQL values that Python can't hand over: texts that are no UTF-8.
RAW = ("cast(x'ff' AS TEXT)", "cast(x'c3' AS TEXT)", "cast(x'eda080' AS TEXT)", "zeroblob(100000)",
       "cast(x'00' AS TEXT)", "9223372036854775807", "1e308 * 10")  # fmt: skip
SCHEMAS = (
    "CREATE VIEW v AS SELECT 1",
    "CREATE TRIGGER g AFTER INSERT ON answer BEGIN DELETE FROM answer; END",
    "CREATE TABLE more (x)",
    "CREATE INDEX i ON answer (category)",
    "DROP INDEX standing",
    "DROP INDEX shown",
    "DROP TABLE event",
    "DROP TABLE picture",
    "DROP TABLE tally",
    "DROP TABLE loss",
    "ALTER TABLE answer ADD COLUMN x INTEGER",
    "ALTER TABLE answer ADD COLUMN x AS (category + 1)",
    "ALTER TABLE study RENAME TO studies",
    "ALTER TABLE run DROP COLUMN profile",
    "PRAGMA user_version = 0",
    "PRAGMA user_version = 1",
    "PRAGMA user_version = -5",
    "PRAGMA application_id = 1",
    "DROP TABLE study; CREATE VIEW study AS WITH RECURSIVE r(x) AS (SELECT 1 UNION ALL SELECT x "
    "+ 1 FROM r) SELECT max(x) AS content, '' AS digest, '' AS version FROM r",
    "DROP TABLE event; CREATE VIEW event AS SELECT a.id, a.run, '' AS at_utc, '' AS kind, '' AS "
    "detail FROM answer a, answer b, answer c, answer d, answer e, answer f, answer g, answer h",
    "DROP TABLE picture; CREATE TABLE picture (sample AS (abs(-9223372036854775808)), setting, "
    "sha256, device, parameters, first_run)",
    "DROP TABLE loss; CREATE VIRTUAL TABLE loss USING fts5(at_utc, cause, answers)",
)


def originals(folder):
    """Whole files: one of simulated observers, one of people; each of both versions."""
    made = study(grid=SMALL, ask_grain=True)
    files = [folder / "simulated.sqlite", folder / "person.sqlite"]
    for file in folder.iterdir():
        file.unlink()
    with Store(files[0], made) as store:
        run_observers(store, percepts(made, [Setting(1.0, 0.7)]), Population(), 5, 0)
    with Store(files[1], made) as store:
        observer = store.observer(kind=PERSON)
        flow = Flow(store, observer, store.begin_run(observer, "d", {}), lambda: 0.0)
        for k, trial in enumerate(store.trials(observer)):
            store.answer(observer, trial, "ratio", k % 5, 0.5, flow.run)
        store.keep_picture(flow.run, 0, 1, "ab", "d", {"x": 1})
        store.undo(observer, flow.run)
    for file in list(files):
        former = folder / f"former-{file.name}"
        shutil.copyfile(file, former)
        answering.to_former(former)
        files.append(former)
    return files


def mutate(file, hand):
    """Damage a file; what was done to it, in words."""
    kind = hand.choice(("bits", "bytes", "cut", "header", "swap", "cell", "row", "cell", "schema",
                        "schema text", "journal", "sparse", "wal"))  # fmt: skip
    data = bytearray(file.read_bytes())
    if kind == "bits":
        for _ in range(hand.choice((1, 1, 3, 30))):
            data[hand.randrange(len(data))] ^= 1 << hand.randrange(8)
    elif kind == "bytes":
        place, length = hand.randrange(len(data)), hand.choice((1, 4, 100, 4096))
        data[place : place + length] = hand.randbytes(length)
    elif kind == "cut":
        data = data[: hand.randrange(len(data))]
    elif kind == "header":
        data[hand.choice((16, 18, 20, 24, 28, 32, 36, 40, 44, 52, 56, 60, 64, 68, 92, 96, 100, 103))
             + hand.randrange(4)] = hand.choice((0, 1, 2, 127, 128, 255))  # fmt: skip
    elif kind == "swap":
        pages = [hand.randrange(len(data) // 4096) * 4096 for _ in range(2)]
        a, b = (bytes(data[p : p + 4096]) for p in pages)
        data[pages[0] : pages[0] + 4096], data[pages[1] : pages[1] + 4096] = b, a
    elif kind == "journal":
        Path(f"{file}-journal").write_bytes(_damaged(bytearray(kills.hot_journal(file)), hand))
    elif kind == "wal":
        data[18:20] = b"\2\2"
        if hand.random() < 0.5:
            Path(f"{file}-wal").write_bytes(hand.randbytes(hand.choice((10, 32, 5000))))
    if kind in ("cell", "row", "schema", "schema text"):
        return _edited(file, kind, hand)
    file.write_bytes(data)
    if kind == "sparse":
        os.truncate(file, hand.choice((2**20, 2**29, 2**31, 2**40)))
    return kind


def _damaged(data, hand):
    if hand.random() < 0.5:
        del data[hand.randrange(len(data)) :]
    else:
        data[hand.randrange(len(data))] ^= 1 << hand.randrange(8)
    return data


def _edited(file, kind, hand):
    with contextlib.closing(sqlite3.connect(file, isolation_level=None)) as connection:
        connection.execute("PRAGMA ignore_check_constraints = ON")
        tables = [
            n for (n,) in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
        ]
        table = hand.choice(tables)
        columns = [row[1] for row in connection.execute(f"PRAGMA table_info({table})")]
        column = hand.choice(columns)
        words = f"{kind} {table}.{column}"
        with contextlib.suppress(sqlite3.Error):
            if kind == "cell":
                value, raw = hand.choice(VALUES), "?"
                if hand.random() < 0.2:
                    raw = hand.choice(RAW)
                if hand.random() < 0.3:  # in the place of the column's own content
                    old = connection.execute(f"SELECT {column} FROM {table}").fetchone()
                    value = _altered(None if old is None else old[0], hand)
                values = (value,) if raw == "?" else ()
                some = hand.choice(("", " WHERE rowid % 2", " LIMIT 1"))
                try:
                    connection.execute(f"UPDATE {table} SET {column} = {raw}{some}", values)
                except sqlite3.OperationalError:
                    connection.execute(f"UPDATE {table} SET {column} = {raw}", values)
                if table == "study" and hand.random() < 0.7 and "tally" in tables:
                    text = connection.execute("SELECT content FROM study").fetchone()[0]
                    digest = tally.study_hash(text)
                    connection.execute("UPDATE tally SET study = ?", (digest,))
            elif kind == "row":
                changes = ("DELETE FROM {0}", "DELETE FROM {0} WHERE rowid % 2",
                           "INSERT INTO {0} SELECT * FROM {0}")  # fmt: skip
                change = hand.choice(changes).format(table)
                connection.execute(change)
                words += change[:6]
            elif kind == "schema":
                words = hand.choice(SCHEMAS)
                connection.executescript(words)
            else:
                connection.execute("PRAGMA writable_schema = ON")
                what = hand.choice(("rootpage = rootpage + 1", "rootpage = 0", "rootpage = 99999",
                                    "sql = replace(sql, 'TEXT', 'BLOB')", "sql = NULL",
                                    "sql = 'CREATE TABLE x(' || sql", "name = 'x'", "type = 'view'",
                                    "sql = sql || ' STRICT'", "rootpage = 1"))  # fmt: skip
                words = what
                connection.execute(
                    f"UPDATE sqlite_master SET {what} WHERE name = ?",
                    (hand.choice((table, "standing", "shown")),),
                )
    return words


def _altered(value, hand):
    """A value with a part replaced, as JSON where it is that."""
    if not isinstance(value, str) or not value:
        return hand.choice(VALUES)
    try:
        content = json.loads(value)
    except ValueError:
        place = hand.randrange(len(value))
        return value[:place] + hand.choice(("", "\0", "é", "x" * 10)) + value[place + 1 :]
    if not isinstance(content, dict | list):
        return hand.choice(VALUES)
    node = content
    for _ in range(hand.randrange(1, 8)):
        keys = list(node) if isinstance(node, dict) else list(range(len(node)))
        if not keys:
            break
        key = hand.choice(keys)
        if not isinstance(node[key], dict | list) or hand.random() < 0.2:
            node[key] = hand.choice(
                (None, True, -1, 1e308, float("nan"), float("inf"), "x", [], {}, [[]], 10**400,
                 "x" * 10_000, [0.5] * 5000, {"a": {}}, "", 2**60)
            )  # fmt: skip
            break
        node = node[key]
    return json.dumps(content)


def judged(file, folder, whole):
    """Use a file in every way: (None or the traceback of what is no single line, uses refused)."""
    refused = 0
    try:
        for use in (_analyse, _run):
            try:
                use(file, folder, whole)
            except InputError:
                refused += 1
    except Exception:
        return traceback.format_exc(), refused
    return None, refused


def _analyse(file, folder, whole):
    pool = read_pool([file], folder)
    list(answer_rows(pool))
    lines = [*sentences.files(pool), *sentences.losses_words(pool)]
    assert all(line.isprintable() for line in lines), lines
    if whole:
        analysis = analyse(pool, Options(3))
        json.dumps(as_numbers(analysis), allow_nan=False).encode("utf-8")
        sentences.summary(analysis).encode("utf-8")


def _run(file, folder, whole):
    with Store(file) as store:
        for observer in store.observers():
            store.details(observer)
            Flow(store, observer, 1, lambda: 0.0).progress()


def one(number, folder):
    """Damage and judge one file; (what, fault or None, uses refused, seconds)."""
    hand = random.Random(number)
    files = sorted(Path(folder).glob("*.sqlite"))
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        file = place / "s.sqlite"
        shutil.copyfile(hand.choice(files), file)
        what = mutate(file, hand)
        begun_s = time.perf_counter()
        fault, refused = judged(file, place, hand.random() < ANALYSED)
        return what, fault, refused, time.perf_counter() - begun_s


def main(words=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args(words)
    faults, slowest, kinds, uses = [], (0.0, ""), collections.Counter(), collections.Counter()
    with tempfile.TemporaryDirectory() as name:
        for file in originals(Path(name)):
            assert judged(file, Path(name), True) == (None, 0)  # the control
        originals(Path(name))
        with concurrent.futures.ProcessPoolExecutor(args.workers) as pool:
            numbers = range(args.seed, args.seed + args.count)
            chunk = max(1, args.count // args.workers // 20)
            results = pool.map(one, numbers, [name] * args.count, chunksize=chunk)
            for number, (what, fault, refused, seconds) in zip(numbers, results, strict=True):
                kind = what.split()[0]
                kinds[kind] += 2
                uses[kind] += 2 - refused
                slowest = max(slowest, (seconds, f"{number}: {what}"))
                if fault is not None:
                    faults.append(fault)
                    if len(faults) <= 5:
                        print(f"{number}: {what}\n{fault}")
    memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024.0
    print("used all the same:", ", ".join(f"{k} {uses[k]} of {n}" for k, n in kinds.items()))
    print(f"{args.count} damaged files: {len(faults)} faults; slowest {slowest[0]:.2f} s "
          f"({slowest[1]}); {memory:.0f} MB")  # fmt: skip
    return faults


if __name__ == "__main__":
    sys.exit(bool(main()))
