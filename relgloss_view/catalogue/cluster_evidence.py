"""Evidence: whether a task has ended the processes that worked on it, or was only there.

A process that ends without an answer does not show why: a task may have taken all memory, or
someone has ended the process. A task is at fault if chance does not explain its deaths. Chance is
the rate at which processes died of anything else (deaths as a Poisson process): a process without
fault lives t seconds or less with F(t) = 1 - exp(-rate t). The F of n tries are uniform if chance
alone ends them, and the product of n uniform numbers is y or less with a probability of
y * sum of (-ln y)^k / k!, k from 0 to n - 1 (Fisher 1932, combination of independent tests).
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field

LEAST_TRIES, MOST_TRIES = 3, 30
LEAST_CHANCE = 1e-6  #: below it, chance is no explanation
SHORTEST_S = 1e-3


@dataclass
class Record:
    """Deaths under one task, while it was alone in its process."""

    tries: int = 0
    log_product: float = 0.0  #: natural logarithm of the product of F over the tries
    own: int = 0  #: processes that died
    since_s: float = 0.0
    deaths_before: int = 0


def _chance(record: Record) -> float:
    """Probability of deaths as early as these, by chance alone."""
    x = -record.log_product
    if math.isinf(x):
        return 0.0
    return sum(math.exp(k * math.log(x) - x - math.lgamma(k + 1)) for k in range(record.tries))


@dataclass
class Evidence:
    """The deaths of a run. clock: seconds, for tests."""

    clock: Callable[[], float] = time.monotonic
    deaths: int = 0  #: of all processes, whatever they died of
    explained: int = 0  #: of them, under tasks that were found at fault
    _records: dict[Hashable, Record] = field(default_factory=dict)
    _begun_s: float | None = None

    def begin(self, key: Hashable) -> None:
        """A task begins, alone in its process."""
        self._begun_s = self.clock() if self._begun_s is None else self._begun_s
        record = self._records.setdefault(key, Record())
        if not record.tries:
            record.since_s, record.deaths_before = self.clock(), self.deaths

    def died(self, key: Hashable, took_s: float, workers: int, *, deaths: int = 1) -> bool:
        """Note that `deaths` processes have died under a task. Returns whether it is at fault.

        took_s: seconds of the try; workers: processes at work on the run. The deaths are part of
        `self.deaths` already.
        """
        record = self._records.setdefault(key, Record(since_s=self.clock() - took_s))
        record.tries += 1
        record.own += deaths
        rate = self._rate(record, max(workers, 1))
        lived = -math.expm1(-rate * max(took_s, SHORTEST_S))
        record.log_product += math.log(lived) if lived > 0.0 else -math.inf
        enough = record.own >= LEAST_TRIES
        if enough and (_chance(record) < LEAST_CHANCE or record.own >= MOST_TRIES):
            self.explained += record.own
            return True
        return False

    def tries(self, key: Hashable) -> int:
        """Processes that died under a task while it was alone."""
        return self._records[key].own

    def forget(self, key: Hashable) -> None:
        """A task is done."""
        self._records.pop(key, None)

    def _rate(self, record: Record, workers: int) -> float:
        """Deaths of other causes in a second of a worker: the higher of the run's and of lately."""
        now_s = self.clock()
        begun_s = now_s if self._begun_s is None else self._begun_s
        spans = (
            (self.deaths - self.explained, now_s - begun_s),
            (self.deaths - record.deaths_before, now_s - record.since_s),
        )
        return max(max(n - record.own, 0) / (workers * max(s, SHORTEST_S)) for n, s in spans)
