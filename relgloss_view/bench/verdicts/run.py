"""Many tables in parallel, and the table by kind."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from multiprocessing import get_context
from typing import Any, TypeVar

from relgloss_view.base.terminal import Column, table
from relgloss_view.bench.verdicts import judging
from relgloss_view.bench.verdicts.faults import FAULTS
from relgloss_view.bench.verdicts.judging import CLASSES, FALSE_GOOD, SOUND, Outcome, judge_one

Result = TypeVar("Result")
FORMAT, VERSION = "relgloss-fit-verdicts", 1


def tasks(count: int, sound: int, kinds: Sequence[str] | None = None) -> list[tuple[str, int]]:
    """Kind and index of each table: `count` with faults, in turns over the kinds, and sound ones.

    >>> tasks(2, 1)
    [('undeclared saturation', 0), ('stray light', 0), ('sound', 0)]
    """
    names = [fault.name for fault in FAULTS if kinds is None or fault.name in kinds]
    troubled = [(names[k % len(names)], k // len(names)) for k in range(count)] if names else []
    return troubled + [(SOUND, k) for k in range(sound)]


def in_parallel(
    work: Callable[..., Result],
    arguments: Sequence[tuple[Any, ...]],
    workers: int,
    done: Callable[[int, int], None] | None = None,
) -> list[Result]:
    """The results in the order of the arguments, by processes with one thread each."""
    results: list[Result] = []

    def collect(source: Iterable[Result]) -> list[Result]:
        for result in source:
            results.append(result)
            if done is not None:
                done(len(results), len(arguments))
        return results

    if workers <= 1:
        return collect(work(*a) for a in arguments)
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")  # inherited by the processes, which start afresh
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        futures = [pool.submit(work, *a) for a in arguments]
        return collect(future.result() for future in futures)


def run(
    seed: int,
    chosen: Sequence[tuple[str, int]],
    workers: int = 1,
    keep: str | None = None,
    done: Callable[[int, int], None] | None = None,
) -> list[Outcome]:
    """Judge the tables of a seed; the same for any number of workers, but for the seconds."""
    return in_parallel(judge_one, [(seed, k, n, keep) for k, n in chosen], workers, done)


COLUMNS = (
    Column("kind", 30, left=True),
    Column("tables", 6),
    *(Column(name, max(len(name), 4)) for name in CLASSES),
    Column("named", 5),
    Column("worst", 5),
)


def summary(outcomes: Sequence[Outcome]) -> str:
    """A row a kind, and one for all with faults.

    "worst" is the largest difference of a false "good", in units of what the rule allows.
    """
    kinds = list(dict.fromkeys(o.kind for o in outcomes))
    rows = [_row(kind, [o for o in outcomes if o.kind == kind]) for kind in kinds]
    troubled = [o for o in outcomes if o.kind != SOUND]
    if troubled:
        rows.append(_row("all with a fault", troubled))
    return table(COLUMNS, rows)


def _row(name: str, outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    counts = Counter(o.outcome for o in outcomes)
    cells = (str(counts[c]) if counts[c] else "" for c in CLASSES)
    worst = max((o.severity for o in outcomes if o.outcome == FALSE_GOOD), default=0.0)
    named = str(sum(o.named for o in outcomes))
    return (name, str(len(outcomes)), *cells, named, f"{worst:.1f}" if worst else "")


def details(outcomes: Sequence[Outcome], classes: Sequence[str]) -> list[str]:
    """Lines about each table of the given classes."""
    lines = []
    for o in outcomes:
        if o.outcome not in classes:
            continue
        lines.append(
            f"{o.kind} {o.index}: {o.outcome} ({o.severity:.1f}); {o.size or 'no fault'}; {o.grid}"
        )
        lines.append(f"    {o.sample}")
        lines.append(f"    fitted {o.fitted or 'no lobe'} ({o.quality or 'none'})")
        if o.wrong or o.beyond:
            lines.append(f"    {'; '.join((*o.wrong, *o.beyond))}")
        lines += [f"    warned: {text}" for text in o.warnings]
    return lines


def as_json(seed: int, outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """All of it, for a file."""
    rule = {
        name: getattr(judging, name)
        for name in ("SMALLEST_GLOSS", "GLOSS_SHARE", "GLOSS_UNITS", "PEAK_SHARE", "STATED_ERRORS",
                     "GLOSS_EXCUSED", "PEAK_EXCUSED", "BEYOND_DEG")
    }  # fmt: skip
    return {
        "format": FORMAT,
        "version": VERSION,
        "seed": seed,
        "rule": rule,
        "tables": [asdict(o) for o in outcomes],
    }
