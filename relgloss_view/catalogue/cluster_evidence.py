"""Evidence: whether a task has ended the processes that worked on it, or was only there.

A process that ends without an answer does not show why: a task may have taken all memory, or
someone has ended the process. A task is at fault if chance does not explain its deaths. Chance is
the rate at which processes died of anything else (deaths as a Poisson process): a process without
fault lives t seconds or less with F(t) = 1 - exp(-rate t). The F of n tries are uniform if chance
alone ends them, and the product of n uniform numbers is y or less with a probability of
y * sum of (-ln y)^k / k!, k from 0 to n - 1 (Fisher 1932, combination of independent tests).

Deaths under other tasks that have a process alone count as chance, too, until chance is no
explanation for all of these tasks together. Then processes die while they work on such tasks more
often than at any other time. That is a comparison of two Poisson rates: of all deaths, those under
such tasks are binomial with the share of time that was theirs (Przyborowski and Wilenski 1940,
Biometrika 31). From then on the other deaths alone measure chance, and one more, because there may
be none of them.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass, field

LEAST_TRIES, MOST_TRIES = 3, 30
LEAST_CHANCE = 1e-6  #: below it, chance is no explanation
SHORTEST_S = 1e-3


@dataclass(frozen=True)
class Try:
    """Deaths under a task that was alone in its process."""

    ended_s: float
    took_s: float  #: each
    deaths: int


@dataclass
class Record:
    """The tries of one task. since_s: when it was alone first, after so many deaths of the run."""

    since_s: float
    deaths_before: int
    tries: list[Try] = field(default_factory=list)

    @property
    def own(self) -> int:
        """Processes that died under the task."""
        return sum(each.deaths for each in self.tries)


@dataclass
class Evidence:
    """The deaths of a run. clock: seconds, for tests."""

    clock: Callable[[], float] = time.monotonic
    deaths: int = 0  #: of all processes, whatever they died of
    _records: dict[Hashable, Record] = field(default_factory=dict)
    _guilty: list[Try] = field(default_factory=list)  #: of tasks that were found at fault
    _begun_s: float | None = None

    def begin(self, key: Hashable) -> None:
        """A task begins, alone in its process."""
        now_s = self.clock()
        self._begun_s = now_s if self._begun_s is None else self._begun_s
        record = self._records.setdefault(key, Record(now_s, self.deaths))
        if not record.tries:
            record.since_s, record.deaths_before = now_s, self.deaths

    def died(self, key: Hashable, took_s: float, workers: int, *, deaths: int = 1) -> bool:
        """Note that `deaths` processes have died under a task. Returns whether it is at fault.

        took_s: seconds of each; workers: processes at work on the run. The deaths are part of
        `self.deaths` already.
        """
        now_s = self.clock()
        record = self._records.setdefault(key, Record(now_s - took_s, self.deaths - deaths))
        record.tries.append(Try(now_s, max(took_s, SHORTEST_S), deaths))
        if record.own < LEAST_TRIES:
            return False
        rate = self._rate(record, max(workers, 1))
        if record.own < MOST_TRIES and _chance(record.tries, rate) >= LEAST_CHANCE:
            return False
        self._guilty += record.tries
        return True

    def tries(self, key: Hashable) -> int:
        """Processes that died under a task while it was alone."""
        return self._records[key].own

    def forget(self, key: Hashable) -> None:
        """A task is done, or lost."""
        self._records.pop(key, None)

    def _rate(self, record: Record, workers: int) -> float:
        """Deaths of other causes in a second of a worker: the higher of the run's and of lately."""
        suspects = [each for each in self._records.values() if each.tries]
        theirs = [each for suspect in suspects for each in suspect.tries]
        ruled_out = len(suspects) > 1 and self._more_than_chance(suspects, theirs, workers)
        left_out = theirs if ruled_out else record.tries
        spans = [
            self._others(left_out, workers, 0, self._begun_s),
            self._others(left_out, workers, record.deaths_before, record.since_s),
        ]
        return max((deaths + ruled_out) / seconds for deaths, seconds in spans)

    def _more_than_chance(self, suspects: list[Record], tries: list[Try], workers: int) -> bool:
        """Whether processes die under the suspects together more often than at other times."""
        first = min(suspects, key=lambda record: record.since_s)
        own = sum(each.deaths for each in tries)
        own_s = sum(each.deaths * each.took_s for each in tries)
        for before, since_s in ((0, self._begun_s), (first.deaths_before, first.since_s)):
            deaths, seconds = self._others(tries, workers, before, since_s)
            if _at_least(own, own + deaths, own_s / (own_s + seconds)) >= LEAST_CHANCE:
                return False
        return True

    def _others(
        self, left_out: Iterable[Try], workers: int, deaths_before: int, since_s: float | None
    ) -> tuple[int, float]:
        """Deaths since a time that are none of these and of no guilty task, in how many seconds.

        The seconds are those of all workers, without the tries that are left out.
        """
        now_s = self.clock()
        since_s = now_s if since_s is None else since_s
        tries = [each for each in (*left_out, *self._guilty) if each.ended_s > since_s]
        deaths = self.deaths - deaths_before - sum(each.deaths for each in tries)
        seconds = workers * (now_s - since_s) - sum(each.deaths * each.took_s for each in tries)
        return max(deaths, 0), max(seconds, SHORTEST_S)


def _chance(tries: list[Try], rate: float) -> float:
    """Probability of deaths as early as these, by chance alone."""
    x = 0.0
    for each in tries:
        lived = -math.expm1(-rate * each.took_s)
        if lived <= 0.0:
            return 0.0
        x -= math.log(lived)
    if x <= 0.0:
        return 1.0
    n = len(tries)
    return sum(math.exp(k * math.log(x) - x - math.lgamma(k + 1)) for k in range(n))


def _at_least(count: int, of: int, share: float) -> float:
    """Probability that at least `count` of `of` events fall into a share of the time."""
    inside, outside = math.log(share), math.log1p(-share)
    return math.fsum(
        math.exp(
            math.lgamma(of + 1) - math.lgamma(k + 1) - math.lgamma(of - k + 1)
            + k * inside + (of - k) * outside
        )
        for k in range(count, of + 1)
    )  # fmt: skip
