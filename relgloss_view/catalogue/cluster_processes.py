"""Processes: the workers of this machine, and the Dask scheduler they ask for work.

Whoever reaches a Dask scheduler runs code as its workers. So this one listens on the loopback
address alone, and only to who holds a key that is made for the run (TLS) and that a folder of this
user holds. The workers are children of this program (base/child.py): Ctrl-C reaches the program
alone, and they end with it however it ends.
"""

from __future__ import annotations

import contextlib
import importlib.util
import itertools
import json
import logging
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

from relgloss_view.base import followed
from relgloss_view.base.child import PACKAGE_FOLDER, Child
from relgloss_view.base.errors import InputError
from relgloss_view.base.shell import command_line
from relgloss_view.base.temporaries import no_temporary_folder, scratch_folder
from relgloss_view.catalogue import cluster_worker
from relgloss_view.catalogue.cluster_evidence import Evidence
from relgloss_view.catalogue.cluster_worker import LOGIN, LOOPBACK, ONE_THREAD, WORKER_CONFIG

#: So many processes in a row that end before they have reached the scheduler are no accident.
MOST_STILLBORN = 12
MEMORY_SHARE = 0.85  #: of the machine's memory, all workers together
LOOKED_S = 0.2  #: between two looks at the workers
CLOSED_S = 2.0
EXTRA = "relgloss-view[dashboard]"  #: what brings bokeh
SYNCED_S = 3600.0  #: between two answers to a question that nobody asks here
LOGGERS = ("distributed", "tornado", "asyncio", "bokeh")


class Processes:
    """The workers of this machine. Dead ones are replaced whenever `look` finds one."""

    def __init__(self, number: int, folder: Path, evidence: Evidence, longest_bytes: float) -> None:
        self.number = number
        self._folder, self._evidence, self._longest_bytes = folder, evidence, longest_bytes
        self._children: dict[int, Child] = {}
        self._outputs: dict[int, BinaryIO] = {}
        self._names = itertools.count(1)
        self._stillborn = 0
        self._looked_s = 0.0
        for _ in range(number):
            self._start()

    def look(self, known: set[str]) -> None:
        """Replace dead workers. known: the names of those that the scheduler knows."""
        now_s = time.monotonic()
        if now_s < self._looked_s + LOOKED_S:
            return
        self._looked_s = now_s
        for name, child in list(self._children.items()):
            if str(name) in known:
                self._stillborn = 0
            if child.process.poll() is not None:
                self._evidence.deaths += 1
                self._stillborn += 1
                words = self._closed(name)
                if self._stillborn > MOST_STILLBORN:
                    raise InputError(
                        f"no worker process starts here, after {self._stillborn} tries: {words}"
                    )
                self._start()
            elif _resident_bytes(child.process.pid) > self._longest_bytes:
                child.kill()  # before the kernel ends something else

    def close(self) -> None:
        """End all workers."""
        for child in self._children.values():
            child.kill()
        for name in list(self._children):
            self._closed(name)

    def _start(self) -> None:
        name = next(self._names)
        path = os.pathsep.join(filter(None, (str(PACKAGE_FOLDER), os.environ.get("PYTHONPATH"))))
        words = (followed.__name__, cluster_worker.__name__, str(self._folder), str(name))
        output = (self._folder / f"{name}.txt").open("w+b")
        self._outputs[name] = output
        self._children[name] = Child(
            [sys.executable, "-m", *words],
            followed=True,
            cwd=self._folder,
            env={**os.environ, **ONE_THREAD, "PYTHONPATH": path},
            stdout=subprocess.DEVNULL,
            stderr=output,
        )

    def _closed(self, name: int) -> str:
        """Close a worker. Returns the last line that it has printed."""
        self._children.pop(name).close()
        with self._outputs.pop(name) as output:
            output.seek(0)
            lines = output.read().decode("utf-8", "replace").split("\n")
        with contextlib.suppress(OSError):
            (self._folder / f"{name}.txt").unlink()
        return next((line for line in reversed(lines) if line.strip()), "it printed nothing")


@contextlib.contextmanager
def local_cluster(
    number: int, evidence: Evidence, *, dashboard: bool
) -> Iterator[tuple[Any, Processes]]:
    """A scheduler in this process and workers beside it. Yields (Dask's cluster, Processes)."""
    if dashboard and importlib.util.find_spec("bokeh") is None:
        install = command_line([sys.executable, "-m", "pip", "install", EXTRA])
        raise InputError(f"--dashboard: Dask's page needs bokeh; install it with: {install}")
    import dask
    import distributed
    from distributed.system import MEMORY_LIMIT

    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(scratch_folder())
        config = {
            **WORKER_CONFIG,
            "temporary-directory": str(folder),
            "distributed.scheduler.allowed-failures": 0,  # this program judges deaths itself
            "distributed.scheduler.preload": [],
            "distributed.scheduler.worker-ttl": None,  # a worker may compute for long
            "distributed.scheduler.work-stealing-interval": "500ms",
            "distributed.comm.timeouts.connect": "10s",
        }
        stack.enter_context(dask.config.set(config))
        security = distributed.Security.temporary()
        with _faults_of_start():
            cluster = distributed.LocalCluster(
                n_workers=0,
                threads_per_worker=1,
                processes=True,
                security=security,
                dashboard_address=f"{LOOPBACK}:0",
                silence_logs=logging.CRITICAL,
                scheduler_sync_interval=SYNCED_S,
                scheduler_kwargs={
                    "dashboard": dashboard,
                    # This program speaks to its own scheduler by queues, the workers by sockets.
                    "protocol": ["inproc", "tls"],
                    "host": [None, LOOPBACK],
                },
            )
        stack.callback(cluster.close, timeout=CLOSED_S)
        *_, listener = cluster.scheduler.listeners
        login = {
            "address": listener.contact_address,
            "security": _keys(security),
            "beats": dashboard,
        }
        with os.fdopen(os.open(folder / LOGIN, os.O_CREAT | os.O_WRONLY | os.O_EXCL, 0o600), "w",
                       encoding="utf-8") as file:  # fmt: skip
            json.dump(login, file)
        processes = Processes(number, folder, evidence, MEMORY_SHARE * MEMORY_LIMIT / number)
        stack.callback(processes.close)
        yield cluster, processes


def dashboard_link(cluster: Any) -> str:
    """Address of a local cluster's page: the cluster itself names the machine's, not loopback's."""
    return f"http://{LOOPBACK}:{cluster.scheduler.services['dashboard'].port}/status"


@contextlib.contextmanager
def _faults_of_start() -> Iterator[None]:
    """Dask's "failed to start" as one line, where the system is at fault: a full disk, no files."""
    try:
        yield
    except RuntimeError as error:
        if not isinstance(error.__cause__, OSError):
            raise
        raise no_temporary_folder(error.__cause__) from error


@contextlib.contextmanager
def silent() -> Iterator[None]:
    """A block in which neither Dask nor what it brings prints: the terminal is the command's."""
    import warnings

    loggers = [logging.getLogger(name) for name in LOGGERS]
    loggers += [
        logging.getLogger(name)
        for name in logging.root.manager.loggerDict
        if name.split(".")[0] in LOGGERS
    ]
    before = [logger.disabled for logger in loggers]
    try:
        for logger in loggers:
            logger.disabled = True
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        for logger, disabled in zip(loggers, before, strict=True):
            logger.disabled = disabled


def _keys(security: Any) -> dict[str, Any]:
    """What makes the same Security in a worker."""
    names = ("tls_ca_file", "tls_worker_cert", "tls_worker_key", "require_encryption")
    return {name: getattr(security, name) for name in names}


def _resident_bytes(pid: int) -> float:
    """Memory of a process, where the system shows it in /proc; 0 elsewhere."""
    try:
        pages = int(Path("/proc", str(pid), "statm").read_text(encoding="ascii").split()[1])
    except (OSError, ValueError, IndexError):
        return 0.0
    return float(pages * os.sysconf("SC_PAGE_SIZE"))
