"""Damaged files, fed to every reader: each is read, or refused with one clear line, soon.

    python scripts/mutated_inputs.py --count 100000 --workers 2
    python scripts/mutated_inputs.py --bombs
    python scripts/mutated_inputs.py --large --workers 1
    python scripts/mutated_inputs.py --layouts

Inputs of at most 1 MB are made from valid files (input_readers.py, input_mutations.py) and read in
processes of their own. Reported are outcomes other than a result or one InputError line: another
exception, a crash, a hang, a warning, text that a terminal would obey, a message without the file's
name, more than 2 s of processor time, more than 300 MB of memory. With --large files have up to
64 MB, and may take 5 s and 1 GB. --layouts writes valid files in other ways that mean the same, and
reports where a reader finds other values. Input K of a seed is always the
same: --only READER:K makes it again, and --keep FOLDER keeps those that failed. The exit status is
1 where any failed.
"""

from __future__ import annotations

import argparse
import collections
import contextlib
import ctypes
import io
import multiprocessing
import os
import random
import resource
import signal
import sys
import tempfile
import time
import warnings
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

import input_large
from input_formats import VOCABULARY
from input_large import LARGE
from input_layouts import differences
from input_mutations import MOST_BYTES, bombs, mutated
from input_readers import Reader, readers, sound, structured_bombs

from relgloss_view.base.errors import InputError
from relgloss_view.base.visible import visible

MOST_S, MOST_MB = 2.0, 300.0
LONGEST_MESSAGE = 600  #: characters, without the file's name
HANG_S = 60.0  #: of wall time, after which a process is ended
ADDRESS_SPACE = 6 << 30  #: bytes a worker may take, so that a bomb does no harm to the machine
SEEDS_S = 300.0  #: that a process may take to make valid files


@dataclass
class Outcome:
    """What became of one input."""

    reader: str
    number: int | str  #: of the input, or the name of a bomb
    fault: str = ""  #: empty where it was read, or refused as it should be
    read: bool = False
    caught: bool = False  #: refused by the net below a decoder, which knows no reason
    seconds: float = 0.0
    megabytes: float = 0.0


@dataclass
class Tally:
    """Outcomes of a reader, counted."""

    inputs: int = 0
    read: int = 0
    caught: int = 0
    faults: int = 0
    seconds: float = 0.0
    megabytes: float = 0.0
    kinds: collections.Counter[str] = field(default_factory=collections.Counter)

    def add(self, outcome: Outcome) -> None:
        """Count an outcome."""
        self.inputs += 1
        self.read += outcome.read
        self.caught += outcome.caught
        self.faults += bool(outcome.fault)
        self.seconds = max(self.seconds, outcome.seconds)
        self.megabytes = max(self.megabytes, outcome.megabytes)
        if outcome.fault:
            self.kinds[outcome.fault] += 1


def attempt(
    reader: Reader,
    number: int | str,
    data: bytes,
    path: Path,
    *,
    timed: bool = True,
    most: tuple[float, float] | None = None,
) -> Outcome:
    """Read an input, and judge how that went; without `timed` not how long it took.

    most: seconds and MB; None: MOST_S and MOST_MB.
    """
    most_s, most_mb = most or (MOST_S, MOST_MB)
    path.write_bytes(data)
    outcome = Outcome(reader.name, number)
    before = _memory_mb(reset=True)
    start = time.process_time()
    printed = io.StringIO()
    with (
        warnings.catch_warnings(record=True) as warned,
        contextlib.redirect_stdout(printed),
        contextlib.redirect_stderr(printed),
    ):
        warnings.simplefilter("always")
        try:
            result = reader.read(path)
            outcome.read = True
            outcome.fault = sound(result) or ""
        except InputError as error:
            outcome.fault = _fault_of(str(error), path)
            outcome.caught = "can't be decoded" in str(error)
        except BaseException as error:
            outcome.fault = f"{type(error).__name__}: {error}"[:80]
    outcome.seconds = time.process_time() - start
    outcome.megabytes = _memory_mb() - before
    if not outcome.fault:
        if warned:
            outcome.fault = f"warning: {warned[0].message}"[:80]
        elif printed.getvalue():
            outcome.fault = f"printed: {printed.getvalue()}"[:80]
        elif timed and outcome.seconds > most_s:
            outcome.fault = f"slow: more than {most_s:g} s"
        elif timed and outcome.megabytes > most_mb:
            outcome.fault = f"large: more than {most_mb:g} MB"
    with contextlib.suppress(OSError):
        path.unlink()
    return outcome


def _fault_of(message: str, path: Path) -> str:
    if visible(message) != message or "\n" in message:
        return "a message with control characters"
    if path.name not in message and path.parent.name not in message:
        return f"a message without the file's name: {message}"[:80]
    if len(message.replace(str(path), "")) > LONGEST_MESSAGE:
        return "a long message"
    if "memory" in message:
        return "out of memory"
    return ""


def _memory_mb(*, reset: bool = False) -> float:
    """The largest resident memory of this process, since it was last reset where that can be."""
    if reset:
        with contextlib.suppress(OSError):
            Path("/proc/self/clear_refs").write_text("5")  # VmHWM begins anew (proc(5))
    try:
        for line in Path("/proc/self/status").read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) / 1024.0
    except OSError:
        pass
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def input_of(reader: Reader, seeds: list[bytes], seed: int, number: int) -> bytes:
    """Input `number` of a reader: the same each time."""
    rng = random.Random(f"{seed} {reader.name} {number}")
    return mutated(seeds, rng, reader.name)


def _work(pipe: Connection, seed: int, folder: str) -> None:
    """A worker: takes (reader, number or name of a bomb, ...) and sends outcomes, one by one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    every, seeds = readers(), {}
    trim = ctypes.CDLL(None).malloc_trim if sys.platform == "linux" else None
    made = all_bombs() if pipe.recv() else {}
    while (task := pipe.recv()) is not None:
        name, number = task
        reader = every[name]
        path = Path(folder) / f"input{reader.suffix}"
        most = None
        if isinstance(number, str):
            large = LARGE.get(number)
            data = made[number] if large is None else large()
            most = None if large is None else (input_large.MOST_S, input_large.MOST_MB)
            if trim:
                trim(0)  # what one input has freed is no credit of the next
        else:
            if name not in seeds:
                seeds[name] = reader.seeds()
                with contextlib.suppress(Exception):
                    attempt(reader, -1, seeds[name][0], path)  # imports are paid here
            data = input_of(reader, seeds[name], seed, number)
        pipe.send(None)  # from now on its time is counted
        pipe.send(attempt(reader, number, data, path, most=most))


def all_bombs(size: int = MOST_BYTES) -> dict[str, bytes]:
    """All inputs made by hand, by name."""
    return {**dict(bombs(size)), **dict(structured_bombs(size))}


class _Worker:
    """A process that reads inputs, replaced where one ends it."""

    def __init__(self, seed: int, folder: Path, with_bombs: bool) -> None:
        self.args = (seed, folder, with_bombs)
        self.todo: collections.deque[tuple[str, int | str]] = collections.deque()
        self.sent: tuple[str, int | str] | None = None
        self.since = 0.0
        self.patience_s = 0.0  #: while seeds are made
        self.start()

    def start(self) -> None:
        """Begin a process, which has nothing to do yet."""
        seed, folder, with_bombs = self.args
        context = multiprocessing.get_context("spawn")
        self.pipe, far = context.Pipe()
        place = tempfile.mkdtemp(dir=folder)
        self.process = context.Process(target=_work, args=(far, seed, place), daemon=True)
        self.process.start()
        far.close()
        self.pipe.send(with_bombs)

    def send(self) -> bool:
        """Send the next input; False where none is left."""
        self.sent = self.todo.popleft() if self.todo else None
        self.since, self.patience_s = time.monotonic(), SEEDS_S
        self.pipe.send(self.sent)
        return self.sent is not None

    def ended(self, reason: str) -> Outcome:
        """The outcome of an input that ended the process, which is started again."""
        self.process.kill()
        self.process.join()
        assert self.sent is not None
        name, number = self.sent
        fault = reason or f"crash: status {self.process.exitcode}"
        self.start()
        return Outcome(name, number, fault)


def outcomes(
    tasks: Iterator[tuple[str, int | str]], seed: int, workers: int, *, with_bombs: bool = False
) -> Iterator[Outcome]:
    """The outcomes of all tasks, as they come."""
    with tempfile.TemporaryDirectory() as folder:
        team = [_Worker(seed, Path(folder), with_bombs) for _ in range(workers)]
        busy: set[_Worker] = set()

        def give(worker: _Worker) -> None:
            while len(worker.todo) == 0:
                task = next(tasks, None)
                if task is None:
                    break
                worker.todo.append(task)
            (busy.add if worker.send() else busy.discard)(worker)

        for worker in team:
            give(worker)
        try:
            while busy:
                ready = wait([worker.pipe for worker in busy], timeout=1.0)
                for worker in list(busy):
                    if worker.pipe in ready:
                        try:
                            outcome: Outcome | None = worker.pipe.recv()
                        except EOFError:
                            outcome = worker.ended("")
                        if outcome is None:
                            worker.since, worker.patience_s = time.monotonic(), 0.0
                            continue
                    elif time.monotonic() - worker.since > HANG_S + worker.patience_s:
                        outcome = worker.ended(f"hang: more than {HANG_S:g} s")
                    else:
                        continue
                    yield outcome
                    give(worker)
        finally:
            for worker in team:
                worker.process.kill()
                worker.process.join()


def tasks_of(names: list[str], count: int) -> Iterator[tuple[str, int | str]]:
    """`count` inputs, shared out among readers by their shares."""
    every = readers()
    total = sum(every[name].share for name in names)
    counts = {name: int(count * every[name].share / total) for name in names}
    counts[names[0]] += count - sum(counts.values())
    for name in names:
        yield from ((name, number) for number in range(counts[name]))


def run(names: list[str], args: argparse.Namespace) -> int:
    """Read all inputs, print a table, and count the faults."""
    tallies = {name: Tally() for name in names}
    if args.bombs:
        listed = list(all_bombs())
        tasks: Iterator[Any] = (
            (name, bomb)
            for name in names
            for bomb in listed
            if bomb.startswith(f"{name}: ") or bomb.partition(": ")[0] not in names
        )
    elif args.large:
        tasks = ((name, large) for name in names for large in LARGE if large.startswith(f"{name}:"))
    else:
        tasks = tasks_of(names, args.count)
    slowest: list[Outcome] = []
    for outcome in outcomes(tasks, args.seed, args.workers, with_bombs=args.bombs):
        tallies[outcome.reader].add(outcome)
        slowest.append(outcome)
        if len(slowest) > 10_000:
            slowest = _worst(slowest)
        if outcome.fault and tallies[outcome.reader].kinds[outcome.fault] <= 3:
            print(f"{outcome.reader}:{outcome.number}: {visible(outcome.fault)}", flush=True)
            if args.keep and isinstance(outcome.number, int):
                _keep(outcome, args)
    print(f"{'reader':12} {'inputs':>8} {'read':>7} {'caught':>7} {'faults':>7} {'s':>6} {'MB':>6}")
    for name, tally in (*tallies.items(), ("all", _sum(list(tallies.values())))):
        print(
            f"{name:12} {tally.inputs:8} {tally.read:7} {tally.caught:7} {tally.faults:7} "
            f"{tally.seconds:6.2f} {tally.megabytes:6.0f}"
        )
    for outcome in _worst(slowest):
        print(
            f"  {outcome.seconds:6.2f} s {outcome.megabytes:6.0f} MB  "
            f"{outcome.reader}:{outcome.number}"
        )
    return sum(tally.faults for tally in tallies.values())


def run_layouts(names: list[str]) -> int:
    """Compare what readers find in valid files and in the same in other layouts; count faults."""
    faults = 0
    for name in names:
        found = list(differences(readers()[name]))
        wrong = [(place, fault) for place, fault in found if fault]
        for place, fault in wrong:
            print(f"{place}: {visible(fault)}", flush=True)
        print(f"{name:12} {len(found):8} {len(wrong):7}", flush=True)
        faults += len(wrong)
    return faults


def _worst(found: list[Outcome]) -> list[Outcome]:
    """The five slowest and the five largest."""
    largest = sorted(found, key=lambda o: -o.megabytes)[:5]
    worst = [*sorted(found, key=lambda o: -o.seconds)[:5], *largest]
    return list({(o.reader, o.number): o for o in worst}.values())


def _sum(tallies: list[Tally]) -> Tally:
    return Tally(
        sum(t.inputs for t in tallies),
        sum(t.read for t in tallies),
        sum(t.caught for t in tallies),
        sum(t.faults for t in tallies),
        max(t.seconds for t in tallies),
        max(t.megabytes for t in tallies),
    )


def _keep(outcome: Outcome, args: argparse.Namespace) -> None:
    reader = readers()[outcome.reader]
    assert isinstance(outcome.number, int)
    data = input_of(reader, reader.seeds(), args.seed, outcome.number)
    Path(args.keep).mkdir(exist_ok=True)
    digest = zlib.crc32(data)
    name = f"{outcome.reader}-{outcome.number}-{digest:08x}{reader.suffix}"
    (Path(args.keep) / name).write_bytes(data)


def main(words: Sequence[str] | None = None) -> int:
    names = list(readers())
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=10_000, help="Inputs in all")
    parser.add_argument("--seed", type=int, default=0, help="Seed of the mutations")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="Processes")
    parser.add_argument("--reader", action="append", choices=names, help="Only this reader")
    parser.add_argument("--bombs", action="store_true", help="Inputs of 1 MB made by hand")
    parser.add_argument("--large", action="store_true", help="Inputs of 64 MB made by hand")
    parser.add_argument("--layouts", action="store_true", help="Valid files in other layouts")
    parser.add_argument("--keep", metavar="FOLDER", help="Keep the inputs that failed here")
    parser.add_argument("--only", metavar="READER:K", help="Read one input, here")
    args = parser.parse_args(words)
    if args.only:
        name, _, number = args.only.partition(":")
        reader = readers()[name]
        data = (
            input_of(reader, reader.seeds(), args.seed, int(number))
            if number.isdigit()
            else LARGE[f"{name}:{number}"]()
            if f"{name}:{number}" in LARGE
            else all_bombs()[number]
        )
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"input{reader.suffix}"
            path.write_bytes(data)
            print(reader.read(path))
        return 0
    if args.layouts:
        return int(run_layouts(args.reader or list(VOCABULARY)) > 0)
    return int(run(args.reader or names, args) > 0)


if __name__ == "__main__":
    sys.exit(main())
