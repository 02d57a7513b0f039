"""Batches: cheap tasks travel together, so that they share what Dask spends on a task.

A batch is worked on for a quarter of a second at most, and one task more: the worker looks at the
clock after each, and what it has not begun by then comes back and travels again. So a worker that
dies takes little with it, and a costly task travels alone.
"""

from __future__ import annotations

import statistics
from collections import deque
from collections.abc import Iterable, Iterator, Sequence

from relgloss_view.catalogue.engine import Task

LONGEST_S = 0.25  #: of a batch
MOST = 16  #: tasks of a batch: the worker holds their results until the last one is done
REMEMBERED = 5  #: times of a sort of tasks


class Batches:
    """Tasks as batches, by the time that others of their sort have taken lately.

    A task of a sort that nobody has timed yet travels alone. The median of the times is taken, as
    the first task of a process loads what all others find there.
    """

    def __init__(self, tasks: Iterable[Task]) -> None:
        self._source: Iterator[Task] = iter(tasks)
        self._waiting: deque[Task] = deque()
        self._times: dict[str, deque[float]] = {}

    def next(self) -> tuple[Task, ...]:
        """The next batch; empty where no task is left."""
        batch: list[Task] = []
        left_s = LONGEST_S
        while len(batch) < MOST and (task := self._peek()) is not None:
            left_s -= self._expected_s(task)
            if batch and left_s < 0.0:
                break
            batch.append(self._waiting.popleft())
        return tuple(batch)

    def put_back(self, tasks: Sequence[Task]) -> None:
        """These travel again, first of all."""
        self._waiting.extendleft(reversed(tasks))

    def note(self, task: Task, took_s: float) -> None:
        """A task has taken so long."""
        self._times.setdefault(task.sort, deque(maxlen=REMEMBERED)).append(took_s)

    def _peek(self) -> Task | None:
        if not self._waiting:
            task = next(self._source, None)
            if task is None:
                return None
            self._waiting.append(task)
        return self._waiting[0]

    def _expected_s(self, task: Task) -> float:
        times = self._times.get(task.sort)
        return statistics.median(times) if times else LONGEST_S
