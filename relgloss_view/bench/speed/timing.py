"""Times of frames, each ended by a finish; tasks take turns, so that drift hits all alike."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from relgloss_view.base.errors import RelglossError
from relgloss_view.base.interruptions import checkpoint

PER_VISIT = 2  #: frames that are timed in a row, after one that is not


class Task(Protocol):
    """What is timed. `warm` brings up to date all that `frame` is not meant to pay for."""

    name: str

    def warm(self) -> None:
        """Draw, untimed."""
        ...

    def frame(self, turn: int) -> float | None:
        """Draw and finish; a task that measures itself returns its milliseconds."""
        ...


@dataclass
class Times:
    """Milliseconds of each frame, or why there are none."""

    ms: list[float] = field(default_factory=list)
    fault: str = ""
    visits: list[float] = field(default_factory=list)  #: the median of each visit

    @property
    def median(self) -> float | None:
        """Of the frames."""
        return statistics.median(self.ms) if self.ms else None

    @property
    def quartiles(self) -> tuple[float, float] | None:
        """First and third."""
        if len(self.ms) < 2:
            return None
        low, _, high = statistics.quantiles(self.ms, n=4)
        return low, high

    def over(self, other: Times) -> float | None:
        """Median of the ratios to another task of the same rounds: slow spells hit both."""
        if not self.visits or not other.visits:
            return None
        pairs = zip(self.visits, other.visits, strict=True)
        return statistics.median(mine / theirs for mine, theirs in pairs)

    def as_dict(self) -> dict[str, Any]:
        """For files."""
        return {
            "ms": self.median,
            "quartiles_ms": self.quartiles,
            "frames": len(self.ms),
            **({"fault": self.fault} if self.fault else {}),
        }


def take_turns(
    tasks: Sequence[Task],
    frames: int,
    *,
    per_visit: int = PER_VISIT,
    progress: Callable[[float], object] = lambda share: None,
) -> dict[str, Times]:
    """Time at least so many frames of each task, in rounds over all of them.

    Every other round goes backwards. A task that fails is left out of further rounds, and says why.
    """
    times = {task.name: Times() for task in tasks}
    rounds = -(-frames // per_visit)
    for turn in range(rounds):
        progress(turn / rounds)
        order: Iterable[Task] = tasks if turn % 2 == 0 else reversed(tasks)
        for task in order:
            found = times[task.name]
            if not found.fault:
                _visit(task, found, per_visit)
    return times


def _visit(task: Task, found: Times, per_visit: int) -> None:
    try:
        task.warm()
        for turn in range(per_visit):
            checkpoint()
            start = time.perf_counter()
            own = task.frame(turn)
            wall = 1e3 * (time.perf_counter() - start)
            found.ms.append(wall if own is None else own)
        found.visits.append(statistics.median(found.ms[-per_visit:]))
    except RelglossError as error:
        found.fault = str(error)
        found.ms.clear()
        found.visits.clear()
