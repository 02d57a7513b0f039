"""The engine that works in processes: Dask's, on this machine or on a running cluster.

A few tasks for each worker are in flight, so no worker waits for the driver and the driver holds no
more than those. A task whose worker died is set aside until all others are done. Then each of them
has a worker of its own, where what it does to that worker shows (cluster_evidence.py).
"""

from __future__ import annotations

import contextlib
import itertools
import time
import uuid
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import STEP_S, checkpoint
from relgloss_view.catalogue.cluster_check import check_scheduler, checked
from relgloss_view.catalogue.cluster_evidence import Evidence
from relgloss_view.catalogue.cluster_processes import Processes, local_cluster, silent
from relgloss_view.catalogue.cluster_worker import Program, Refused, perform, this_program
from relgloss_view.catalogue.engine import MOST_WORKERS, Done, EngineOptions, Lost, Task

IN_FLIGHT = 2  #: tasks of a worker: one at work, one that waits there
COUNTED_S = 0.5  #: between two counts of the workers
ANSWER_S = 10.0  #: so long a scheduler may take to answer
GONE_S = 2.0  #: so long after a worker has gone, what it did may still be on its way
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
            options.report(f"Dask's dashboard: {client.dashboard_link}")
        _Run(client, processes, evidence, options).work_off(tasks, done)


@dataclass
class _Flight:
    """A task that a worker has, or will have."""

    task: Task
    begun_s: float
    worker: str | None = None  #: address of the one that has this task alone
    gone_s: float | None = None  #: when that worker was found gone


class _Run:
    """One run of an engine."""

    def __init__(
        self, client: Any, processes: Processes | None, evidence: Evidence, options: EngineOptions
    ) -> None:
        from distributed import as_completed

        self._client, self._processes = client, processes
        self._evidence, self._options = evidence, options
        self._program: Program = this_program()
        self._flights: dict[Any, _Flight] = {}
        self._completed = as_completed(loop=client.loop, with_results=True, raise_errors=False)
        self._keys = (f"relgloss-{uuid.uuid4().hex[:12]}-{n}" for n in itertools.count())
        self._known: dict[str, str] = {}  #: names of the scheduler's workers, by address
        self._checked: set[str] = set()  #: addresses of workers that have this program
        self._counted_s = 0.0
        self._seen_s = time.monotonic()  #: when a worker was there last

    def work_off(self, tasks: Iterable[Task], done: Done) -> None:
        """Call `done` for every task."""
        source: Iterator[Task] = iter(tasks)
        again: deque[Task] = deque()  #: the scheduler has lost them
        aside: deque[Task] = deque()  #: a worker died under them
        exhausted = False
        while True:
            checkpoint()
            self._look()
            while not exhausted and len(self._flights) < IN_FLIGHT * len(self._known):
                task = again.popleft() if again else next(source, None)
                if task is None:
                    exhausted = True
                else:
                    self._submit(task)
            exhausted = exhausted and not again
            if exhausted and all(flight.worker for flight in self._flights.values()):
                self._submit_alone(aside)
                if not aside and not self._flights:
                    return
            self._wait()
            for future, result in self._completed.next_batch(block=False):
                flight = self._flights.pop(future, None)
                if flight is not None:
                    self._finish(flight, future, result, done, again, aside)
            for flight in self._left_behind():
                self._judge(flight, 1, done, aside)

    def _wait(self) -> None:
        """Wait for a result, a short while."""
        ready = self._completed.thread_condition
        with ready:
            if not self._completed.has_ready():
                ready.wait(STEP_S)

    def _finish(
        self,
        flight: _Flight,
        future: Any,
        result: Any,
        done: Done,
        again: deque[Task],
        aside: deque[Task],
    ) -> None:
        from distributed import KilledWorker

        task = flight.task
        if future.status == "cancelled":
            again.append(task)
        elif future.status == "finished":
            if isinstance(result, Refused):
                raise result.error()
            self._evidence.forget(task.key)
            done(task, result)
        else:
            _, error, trace = result
            if not isinstance(error, KilledWorker):
                raise error.with_traceback(trace)
            self._judge(flight, error.allowed_failures + 1, done, aside)

    def _judge(self, flight: _Flight, deaths: int, done: Done, aside: deque[Task]) -> None:
        """So many workers have died under a task: it is lost, or tried again alone."""
        if self._processes is None:
            self._evidence.deaths += deaths
        key = flight.task.key
        if flight.worker is not None:
            ended_s = flight.gone_s or time.monotonic()
            took_s = (ended_s - flight.begun_s) / deaths
            if self._evidence.died(key, took_s, len(self._known), deaths=deaths):
                done(flight.task, Lost(self._evidence.tries(key)))
                return
        aside.append(flight.task)

    def _submit(self, task: Task, worker: str | None = None) -> None:
        """Hand a task to Dask; to one worker alone, if it is named."""
        if worker is not None:
            self._evidence.begin(task.key)
        future = self._client.submit(
            perform,
            task,
            self._program,
            key=next(self._keys),
            pure=False,
            workers=None if worker is None else [worker],
        )
        self._flights[future] = _Flight(task, time.monotonic(), worker)
        self._completed.add(future)

    def _submit_alone(self, aside: deque[Task]) -> None:
        """Bind tasks that were set aside to workers that have nothing else, as far as they go."""
        if not aside:
            return
        self._count()  # a worker that has just died would take the blame to the next task
        taken = {flight.worker for flight in self._flights.values()}
        for worker in [address for address in self._known if address not in taken]:
            if aside:
                self._submit(aside.popleft(), worker)

    def _left_behind(self) -> list[_Flight]:
        """Take back tasks whose only worker has gone: Dask waits for that worker for ever."""
        if not self._known:  # nothing is heard: that is the scheduler's silence, or all have gone
            return []
        now_s = time.monotonic()
        left = []
        for future, flight in list(self._flights.items()):
            if flight.worker is None or flight.worker in self._known:
                flight.gone_s = None
            elif flight.gone_s is None:
                flight.gone_s = now_s
            elif now_s > flight.gone_s + GONE_S:
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
                self._checked &= present
                self._checked |= checked(self._client, present - self._checked, self._program)
        self._known = {address: address for address in self._checked & present}

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
