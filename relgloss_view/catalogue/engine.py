"""Engine: what works off the tasks of a catalogue. Here its values, and the plain loop.

An engine decides where and when a task runs, and nothing of what comes out of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.catalogue.one_thread import one_thread

MOST_WORKERS = 256  #: of one machine


@dataclass(frozen=True)
class Task:
    """One piece of work: `function(*arguments)`, in whichever process.

    key: names the task among those of a run. name: the file, for people. sort: tasks of one sort
    take about as long as each other. The function is one of a module of this package and everything
    else can be pickled, as another process makes the call.
    The function returns a fault of the item as its result; it raises InputError only where the
    process or the machine that works is at fault, such as a folder that it can't read: that ends
    the run.
    """

    key: str
    name: str
    function: Callable[..., Any]
    arguments: tuple[Any, ...] = ()
    sort: str = ""

    def result(self) -> Any:
        """Do the work, in this process."""
        return self.function(*self.arguments)


@dataclass(frozen=True)
class Lost:
    """In place of a result: every process that worked on the task has died of it."""

    tries: int  #: processes that died while they worked on this task alone

    @property
    def fault(self) -> str:
        """One line for the item's row: the same one however often it was tried."""
        return "the process that worked on it ended without an answer, each time"


@dataclass(frozen=True)
class EngineOptions:
    """Where a catalogue's tasks run.

    workers: processes on this machine; 1 without a scheduler is this process itself. None takes one
    for each processor. scheduler: address of a running Dask scheduler (tcp://HOST:PORT or
    tls://HOST:PORT), in place of processes here. dashboard: whether to serve Dask's own page on
    this machine. patience_s: so long a lost scheduler, or the first worker, is waited for.
    report: gets lines for people, such as the address of the page.
    """

    workers: int | None = None
    scheduler: str | None = None
    dashboard: bool = False
    patience_s: float = 60.0
    report: Callable[[str], object] = bool


Done = Callable[[Task, Any], object]  #: gets each task once, with its result or Lost, in any order


#: Works off the tasks, and calls `done` in this thread for each of them. The tasks are taken one by
#: one, shortly before they run. Exceptions of `done`, of a checkpoint and InputError of a task end
#: the run: no process of the engine is left then.
Engine = Callable[[Iterable[Task], Done, EngineOptions], None]


def run(tasks: Iterable[Task], done: Done, options: EngineOptions) -> None:
    """Work off the tasks by the engine that the options ask for."""
    if options.workers is not None and not 1 <= options.workers <= MOST_WORKERS:
        raise InputError(f"--workers {options.workers}: expected 1 to {MOST_WORKERS}")
    if options.scheduler is None and options.workers == 1 and not options.dashboard:
        in_this_process(tasks, done, options)
        return
    # Dask takes half a second to import, which a plain loop does not need.
    from relgloss_view.catalogue.cluster import on_processes

    on_processes(tasks, done, options)


def in_this_process(tasks: Iterable[Task], done: Done, options: EngineOptions) -> None:
    """The plain loop: one task after the other, here."""
    with one_thread():
        for task in tasks:
            checkpoint()
            done(task, task.result())
