"""Time the engines of a catalogue on tables with a known truth, in turns inside one run.

    python scripts/catalogue_speed.py [--tables N] [--rounds N] [--empty N]

Prints: what a table costs by stage; one process of the engine against the plain loop (at most 5 %
more); two processes against one (at least 1.8 x); the engine alone, with empty items, and the
memory of the program that drives it (at most 500 MB at 10,000 items). The time to the first
item, in which the processes start, is given by itself. Then whole commands, from start to end, with
the digests of the files, the store, the table and the materials: `relgloss catalogue build` with
one and two processes, again with nothing changed, and a plain loop of `relgloss fit` in one process
(at most 5 % more, although a build meters, matches and draws, too). Let nothing else run.
"""

from __future__ import annotations

import argparse
import os
import pickle
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from relgloss_view import fit_material, read_measurement
from relgloss_view.base.reading import sha256_of
from relgloss_view.base.terminal import Column, table
from relgloss_view.bench.verdicts.judging import SOUND, table_of
from relgloss_view.catalogue.cluster_worker import ONE_THREAD
from relgloss_view.catalogue.columns import TABLE
from relgloss_view.catalogue.engine import EngineOptions, Task, run
from relgloss_view.catalogue.item import Item
from relgloss_view.catalogue.look import draw, match_of, numbers_of
from relgloss_view.catalogue.one_thread import one_thread
from relgloss_view.catalogue.recipe import Recipe
from relgloss_view.catalogue.work import EXPECTED, make_item, renderer
from relgloss_view.picture.output.png import png_bytes

SEED = 20
RESULT_BYTES = 20_000  #: of an empty item
RECIPE = Recipe()


def empty(number: int) -> tuple[int, bytes]:
    """An item that costs nothing."""
    return number, bytes(RESULT_BYTES)


def tree_of(folder: Path, count: int) -> list[Path]:
    """Write tables of different samples, grids and noise."""
    paths = []
    for k in range(count):
        paths.append(folder / f"{k:04d}.csv")
        table_of(SEED, SOUND, k, None).write(paths[-1])
    return paths


def tasks_of(paths: list[Path]) -> list[Task]:
    """The tasks that a build has for them."""
    return [
        Task(
            path.name,
            path.name,
            make_item,
            (str(path), path.name, TABLE, sha256_of(path, EXPECTED)[0], RECIPE),
        )
        for path in paths
    ]


def cpu_s() -> float:
    """Seconds of all processors that this process and its ended children have taken."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system


@dataclass(frozen=True)
class Timed:
    """One run: seconds to the first item, after it, and of all processors; items by task."""

    first_s: float
    rest_s: float
    cpu_s: float
    items: list[Item]


def timed(tasks: list[Task], workers: int, *, loop: bool = False) -> Timed:
    """Run an engine."""
    cpu_before_s, begun_s = cpu_s(), time.perf_counter()
    first_s = 0.0
    made: dict[str, Item] = {}

    def done(task: Task, item: Any) -> None:
        nonlocal first_s
        first_s = first_s or time.perf_counter()
        made[task.key] = item

    # One worker alone is the plain loop; on processes is what the engine does with more.
    if loop:
        run(tasks, done, EngineOptions(workers=1))
    else:
        from relgloss_view.catalogue.cluster import on_processes

        on_processes(tasks, done, EngineOptions(workers=workers))
    end_s = time.perf_counter()
    items = [made[task.key] for task in tasks]
    return Timed(first_s - begun_s, end_s - first_s, cpu_s() - cpu_before_s, items)


def stages(paths: list[Path]) -> list[tuple[str, str]]:
    """Milliseconds of a processor that a table costs by stage (mean), one thread each."""
    spent: dict[str, float] = {}

    def step(name: str, work: Callable[[], Any]) -> Any:
        begun_s = time.process_time()
        result = work()
        spent[name] = spent.get(name, 0.0) + time.process_time() - begun_s
        return result

    made = renderer()
    for path in paths:
        measurement = step("read", partial(read_measurement, path))
        material = step("fit", partial(fit_material, measurement))
        step("meter", partial(numbers_of, material, RECIPE))
        matched = step("match", partial(match_of, material, RECIPE, 0.0))
        look = partial(draw, material, RECIPE, made, sigma_n_deg=0.0, matched=matched)
        step("picture file", partial(png_bytes, step("draw", look)))
    rows = [(name, f"{1e3 * s / len(paths):.1f} ms") for name, s in spent.items()]
    rows.append(("all stages", f"{1e3 * sum(spent.values()) / len(paths):.1f} ms"))
    return rows


def memory_of(count: int) -> tuple[float, float]:
    """Megabytes (VmHWM) and items a second of a program that drives `count` empty items."""
    program = (
        "import time, catalogue_speed as speed\n"
        "from relgloss_view.catalogue.engine import EngineOptions, Task, run\n"
        f"tasks = (Task(str(n), 'empty', speed.empty, (n,)) for n in range({count}))\n"
        "ends = []\n"
        "run(tasks, lambda *_: ends.append(time.perf_counter()), EngineOptions(workers=2))\n"
        f"assert len(ends) == {count}\n"
        "print(open('/proc/self/status').read().split('VmHWM:')[1].split()[0])\n"
        "print((len(ends) - 1) / (ends[-1] - ends[0]))\n"
    )
    words = [sys.executable, "-c", program]
    printed = subprocess.run(words, capture_output=True, text=True, check=True).stdout.split()
    return float(printed[0]) / 1000.0, float(printed[1])


#: A plain loop of the command `relgloss fit` in one process: argv is a folder and the tables.
FIT_LOOP = """
import contextlib, io, os, sys
from relgloss_view.cli import main
for path in sys.argv[2:]:
    output = os.path.join(sys.argv[1], os.path.basename(path) + ".json")
    with contextlib.redirect_stdout(io.StringIO()):
        assert main(["fit", path, "-o", output]) == 0
"""


def command(words: list[str]) -> tuple[float, float]:
    """Seconds, and seconds of all processors, of a program from its start to its end."""
    cpu_before_s, begun_s = cpu_s(), time.perf_counter()
    subprocess.run([sys.executable, *words], stdout=subprocess.DEVNULL, check=True)
    return time.perf_counter() - begun_s, cpu_s() - cpu_before_s


def whole_commands(tree: Path, rounds: int) -> dict[str, list[tuple[float, float]]]:
    """`command` of each way to work off a tree, in turns."""
    paths = [str(path) for path in sorted(tree.glob("*.csv"))]
    spent: dict[str, list[tuple[float, float]]] = {}
    for _ in range(rounds):
        with tempfile.TemporaryDirectory() as scratch:
            one = ["-m", "relgloss_view.cli", "catalogue", "build", str(tree), "--workers", "1"]
            two = [*one[:-1], "2"]
            ways = {
                "loop of relgloss fit": ["-c", FIT_LOOP, scratch, *paths],
                "build, one process": [*one, "-o", f"{scratch}/one"],
                "build, two processes": [*two, "-o", f"{scratch}/two"],
                "build, nothing changed": [*one, "-o", f"{scratch}/one"],
            }
            for name, words in ways.items():
                spent.setdefault(name, []).append(command(words))
    return spent


def main() -> int:
    """Measure and print; 1 where a figure is missed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    add = parser.add_argument
    add("--tables", type=int, default=40, metavar="N", help="Number of tables (default 40)")
    add("--rounds", type=int, default=3, metavar="N", help="Number of turns (default 3)")
    add("--empty", type=int, default=10_000, metavar="N", help="Number of empty items")
    args = parser.parse_args()
    here = str(Path(__file__).resolve().parent)
    os.environ |= ONE_THREAD
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (here, os.environ.get("PYTHONPATH"))))
    with tempfile.TemporaryDirectory() as folder:
        paths = tree_of(Path(folder), args.tables)
        tasks = tasks_of(paths)
        timed(tasks[:2], 1, loop=True)  # imports, the first compilation of shaders
        with one_thread():
            print(table([Column("stage", left=True), Column("a table")], stages(paths)))
        empty_run = timed(tasks[:1], 1)
        runs: dict[str, list[Timed]] = {"loop": [], "one": [], "two": []}
        for _ in range(args.rounds):
            for name, workers in (("loop", 0), ("one", 1), ("two", 2)):
                runs[name].append(timed(tasks, workers, loop=not workers))
        wholes = whole_commands(Path(folder), args.rounds)
    items = runs["loop"][0].items
    assert all(run.items == items for name in runs for run in runs[name])
    size = statistics.mean(len(pickle.dumps(item)) for item in items)
    print(f"an item is {size / 1000:.1f} kB on its way; all engines made the same items")
    more = len(tasks) - 1
    rows = [
        (
            name,
            f"{statistics.median(run.first_s for run in each):.2f} s",
            f"{1e3 * statistics.median(run.rest_s for run in each) / more:.1f} ms",
            f"{1e3 * statistics.median(run.cpu_s for run in each) / len(tasks):.1f} ms",
        )
        for name, each in runs.items()
    ]
    columns = [Column("first item"), Column("each more"), Column("of a processor")]
    print(table([Column("engine", left=True), *columns], rows))
    pairs = list(zip(runs["loop"], runs["one"], runs["two"], strict=True))
    overhead = statistics.median(one.rest_s / loop.rest_s - 1.0 for loop, one, _ in pairs)
    # Both shares of one item are taken off: that of the loop, and that of a run with one item.
    work = statistics.median(loop.cpu_s for loop, *_ in pairs) * more / len(tasks)
    spent = statistics.median(one.cpu_s for _, one, _ in pairs) - empty_run.cpu_s
    gain = statistics.median(one.rest_s / two.rest_s for _, one, two in pairs)
    megabytes, rate = memory_of(args.empty)
    medians = {
        name: [statistics.median(values) for values in zip(*each, strict=True)]
        for name, each in wholes.items()
    }
    columns = [Column("all tables"), Column("of a processor"), Column("a table")]
    print(
        table(
            [Column("command, from start to end", left=True), *columns],
            [
                (name, f"{wall:.2f} s", f"{cpu:.2f} s", f"{1e3 * cpu / len(tasks):.1f} ms")
                for name, (wall, cpu) in medians.items()
            ],
        )
    )
    turns = list(zip(*wholes.values(), strict=True))
    whole = statistics.median(one[1] / fits[1] - 1.0 for fits, one, *_ in turns)
    halved = statistics.median(one[0] / two[0] for _, one, two, _ in turns)
    figures = (
        (
            "build against a loop of relgloss fit, time of processors",
            f"{100 * whole:+.1f} %",
            "at most +5 %",
            whole <= 0.05,
        ),
        ("build, two processes against one", f"{halved:.2f} x", "at least 1.8 x", halved >= 1.8),
        (
            "one process against the plain loop",
            f"{100 * overhead:+.1f} %",
            "at most +5 %",
            overhead <= 0.05,
        ),
        ("the same in time of processors", f"{100 * (spent / work - 1.0):+.1f} %", "", True),
        ("two processes against one", f"{gain:.2f} x", "at least 1.8 x", gain >= 1.8),
        (
            f"memory of the driver, {args.empty} items",
            f"{megabytes:.0f} MB",
            "at most 500 MB",
            megabytes <= 500,
        ),
        ("empty items in a second, two processes", f"{rate:.0f}", "", True),
    )
    columns = [Column("here"), Column("wanted"), Column("")]
    print(
        table(
            [Column("figure", left=True), *columns],
            [(*row, "" if good else "MISSED") for *row, good in figures],
        )
    )
    return 0 if all(good for *_, good in figures) else 1


if __name__ == "__main__":
    sys.exit(main())
