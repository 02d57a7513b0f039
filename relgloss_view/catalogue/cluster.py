"""The engine that works in processes: Dask's, on this machine or on a running cluster.

A few tasks for each worker are in flight, so no worker waits for the driver and the driver holds no
more than those; cheap ones travel together (cluster_batches.py). A task whose worker died is set
aside until all others are done. Then each of them has a worker of its own, where what it does to
that worker shows (cluster_evidence.py).
"""

from __future__ import annotations

import concurrent.futures
import contextlib
import itertools
import time
import uuid
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import STEP_S, checkpoint
from relgloss_view.catalogue.cluster_batches import LONGEST_S, Batches
from relgloss_view.catalogue.cluster_check import Inspection, check_scheduler
from relgloss_view.catalogue.cluster_evidence import Evidence
from relgloss_view.catalogue.cluster_processes import (
    Processes,
    dashboard_link,
    local_cluster,
    silent,
)
from relgloss_view.catalogue.cluster_worker import (
    Performed,
    Program,
    Refused,
    perform,
    this_program,
)
from relgloss_view.catalogue.engine import MOST_WORKERS, Done, EngineOptions, Lost, Task

IN_FLIGHT = 2  #: batches of a worker: one at work, one that waits there
WAITED_S = 0.2  #: between two checkpoints; a result ends the wait
COUNTED_S = 0.5  #: between two counts of the workers
ANSWER_S = 10.0  #: so long a scheduler may take to answer
GONE_S = 2.0  #: so long after a worker has gone, what it did may still be on its way
UNHEARD_S = 30.0  #: so long Dask may take to hand over what is done
SCHEMES = ("tcp://", "tls://")


def on_processes(tasks: Iterable[Task], done: Done, options: EngineOptions) -> None:
    """Work off the tasks in processes: as engine.Engine.

    Raises InputError where no scheduler or worker answers for `patience_s`, and where a worker has
    another program or can't read a task's file, GLUnavailableError where one can't draw.
    """
    evidence = Evidence()
    with contextlib.ExitStack() as stack:
        stack.enter_context(silent())
        import distributed
        from dask.system import CPU_COUNT

        stack.enter_context(silent())  # its loggers exist only now
        address: Any = options.scheduler
        processes = None
        if address is None:
            number = options.workers or min(CPU_COUNT, MOST_WORKERS)
            address, processes = stack.enter_context(
                local_cluster(number, evidence, dashboard=options.dashboard)
            )
        elif not address.startswith(SCHEMES):
            raise InputError(
                f"--scheduler {address!r}: expected tcp://HOST:PORT or tls://HOST:PORT"
            )
        try:
            client = distributed.Client(
                address, timeout=options.patience_s, set_as_default=False, name="relgloss"
            )
        except (OSError, ValueError, TimeoutError) as error:
            raise InputError(
                f"scheduler {options.scheduler}: no answer within {options.patience_s:g} s "
                f"({_first_line(error)}); start one with: dask scheduler"
            ) from None
        stack.callback(client.close, timeout=ANSWER_S if processes is None else 1.0)
        if processes is None:
            check_scheduler(client, address)
        if options.dashboard:
            link = client.dashboard_link if processes is None else dashboard_link(client.cluster)
            options.report(f"Dask's dashboard: {link}")
        _Run(client, processes, evidence, options, tasks, done).work_off()


@dataclass
class _Flight:
    """Tasks that a worker has, or will have."""

    tasks: tuple[Task, ...]
    begun_s: float
    worker: str | None = None  #: address of the one that has a task alone
    gone_s: float | None = None  #: when that worker was found gone
    over_s: float | None = None  #: when Dask was found to be done with them


class _Run:
    """One run of an engine."""

    def __init__(
        self,
        client: Any,
        processes: Processes | None,
        evidence: Evidence,
        options: EngineOptions,
        tasks: Iterable[Task],
        done: Done,
    ) -> None:
        from distributed import as_completed

        self._client, self._processes = client, processes
        self._evidence, self._options, self._done = evidence, options, done
        self._program: Program = this_program()
        self._batches = Batches(tasks)
        self._aside: deque[Task] = deque()  #: a worker died under them
        self._flights: dict[Any, _Flight] = {}
        self._completed = as_completed(loop=client.loop, with_results=True, raise_errors=False)
        self._keys = (f"relgloss-{uuid.uuid4().hex[:12]}-{n}" for n in itertools.count())
        self._known: dict[str, str] = {}  #: names of the scheduler's workers, by address
        self._inspection = Inspection(client, self._program)
        self._counted_s = 0.0
        self._seen_s = time.monotonic()  #: when a worker was there last

    def work_off(self) -> None:
        """Call `done` for every task."""
        while True:
            checkpoint()
            self._look()
            exhausted = self._submit_batches()
            if exhausted and all(flight.worker for flight in self._flights.values()):
                self._submit_alone()
                if not self._aside and not self._flights:
                    return
            self._wait()
            for future, result in self._completed.next_batch(block=False):
                flight = self._flights.pop(future, None)
                if flight is not None:
                    self._finish(flight, result)
            for flight in self._left_behind():
                self._judge(flight, 1)

    def _submit_batches(self) -> bool:
        """Give each worker something to do. Returns whether no task is left that can be given."""
        while len(self._flights) < IN_FLIGHT * len(self._known):
            batch = self._batches.next()
            if not batch:
                return True
            self._submit(batch)
        return False

    def _wait(self) -> None:
        """Wait for a result, a short while."""
        ready = self._completed.thread_condition
        with ready:
            if not self._completed.has_ready():
                ready.wait(WAITED_S)

    def _finish(self, flight: _Flight, result: Any) -> None:
        """Take what came. A future's status may have gone on since, as a worker died."""
        from distributed import KilledWorker

        if isinstance(result, concurrent.futures.CancelledError):  # the scheduler has lost them
            self._batches.put_back(flight.tasks)
        elif isinstance(result, Performed):
            begun = flight.tasks[: len(result.results)]
            for task, each, took_s in zip(begun, result.results, result.seconds, strict=True):
                if isinstance(each, Refused):
                    raise each.error()
                self._evidence.forget(task.key)
                self._batches.note(task, took_s)
                self._done(task, each)
            self._batches.put_back(flight.tasks[len(begun) :])
        else:
            _, error, trace = result
            if not isinstance(error, KilledWorker):
                raise error.with_traceback(trace)
            self._judge(flight, error.allowed_failures + 1)

    def _judge(self, flight: _Flight, deaths: int) -> None:
        """So many workers have died under tasks: they are tried again alone, or one is lost."""
        if flight.worker is None:
            self._aside += flight.tasks
            return
        if self._processes is None:
            self._evidence.deaths += deaths
        (task,) = flight.tasks
        took_s = ((flight.gone_s or time.monotonic()) - flight.begun_s) / deaths
        if self._evidence.died(task.key, took_s, len(self._known), deaths=deaths):
            tries = self._evidence.tries(task.key)
            self._evidence.forget(task.key)
            self._done(task, Lost(tries))
        else:
            self._aside.append(task)

    def _submit(self, tasks: tuple[Task, ...], worker: str | None = None) -> None:
        """Hand tasks to Dask; one to one worker alone, if it is named."""
        if worker is not None:
            self._evidence.begin(tasks[0].key)
        future = self._client.submit(
            perform,
            tasks,
            self._program,
            LONGEST_S,
            key=next(self._keys),
            pure=False,
            workers=None if worker is None else [worker],
        )
        self._flights[future] = _Flight(tasks, time.monotonic(), worker)
        self._completed.add(future)

    def _submit_alone(self) -> None:
        """Bind tasks that were set aside to workers that have nothing else, as far as they go."""
        if not self._aside:
            return
        self._count()  # a worker that has just died would take the blame to the next task
        taken = {flight.worker for flight in self._flights.values()}
        for worker in [address for address in self._known if address not in taken]:
            if self._aside:
                self._submit((self._aside.popleft(),), worker)

    def _left_behind(self) -> list[_Flight]:
        """Take back what would never come.

        Dask waits for ever for the only worker that a task may have, and it hands nothing over
        where a second worker dies while it fetches a result.
        """
        if not self._known:  # nothing is heard: that is the scheduler's silence, or all have gone
            return []
        now_s = time.monotonic()
        left = []
        for future, flight in list(self._flights.items()):
            is_here = flight.worker is None or flight.worker in self._known
            flight.gone_s = None if is_here else flight.gone_s or now_s
            flight.over_s = None if future.status == "pending" else flight.over_s or now_s
            is_gone = flight.gone_s is not None and now_s > flight.gone_s + GONE_S
            is_unheard = flight.over_s is not None and now_s > flight.over_s + UNHEARD_S
            if is_gone or is_unheard:
                del self._flights[future]
                future.cancel()
                left.append(flight)
        return left

    def _look(self) -> None:
        """Count the workers, replace dead ones; raises InputError once none is left for long."""
        now_s = time.monotonic()
        if now_s > self._counted_s + COUNTED_S or not self._known:
            self._count()
            if not self._known:
                time.sleep(STEP_S)
        if self._processes is not None:
            self._processes.look(set(self._known.values()))
        if self._known:
            self._seen_s = now_s
        elif now_s > self._seen_s + self._options.patience_s:
            raise InputError(self._loss())

    def _count(self) -> None:
        """Ask the scheduler for its workers."""
        self._counted_s = time.monotonic()
        if self._processes is not None:
            workers = self._client.cluster.scheduler.workers.copy()
            self._known = {address: str(worker.name) for address, worker in workers.items()}
            return
        present: set[str] = set()
        if self._client.status == "running":
            with contextlib.suppress(OSError, TimeoutError, RuntimeError):
                answer = self._client.sync(self._client.scheduler.ncores, callback_timeout=ANSWER_S)
                present = set(answer)
                alone = {flight.worker for flight in self._flights.values()}
                gone = self._known.keys() - present - alone
                self._evidence.deaths += len(gone)  # those that have a task alone are judged
                self._known = dict.fromkeys(self._inspection.passed(present), "")
                return
        self._known = {}

    def _loss(self) -> str:
        waited = f"for {self._options.patience_s:g} s; what is done is kept"
        if self._processes is not None:
            return f"no worker process has started {waited}"
        if self._client.status != "running":
            return f"scheduler {self._options.scheduler}: no answer {waited}"
        return (
            f"scheduler {self._options.scheduler}: no worker {waited}; "
            f"start some with: dask worker {self._options.scheduler} --nthreads 1"
        )


def _first_line(error: BaseException) -> str:
    return (str(error).strip() or type(error).__name__).split("\n")[0]
