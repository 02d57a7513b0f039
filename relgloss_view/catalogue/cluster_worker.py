"""What a worker of a cluster runs: tasks, one after the other, of the same program as the driver's.

As a program, this module is a worker on this machine: `python -m relgloss_view.base.followed
relgloss_view.catalogue.cluster_worker FOLDER NAME`, where FOLDER holds the file of LOGIN.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib
import json
import os
import platform
import socket
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import GLUnavailableError, InputError, RelglossError
from relgloss_view.base.resources import data_root
from relgloss_view.base.version import __version__
from relgloss_view.catalogue.engine import Task
from relgloss_view.catalogue.one_thread import one_thread

LOGIN = "login.json"  #: the scheduler's address and the keys, readable by this user alone
LOOPBACK = "127.0.0.1"
#: One thread for each library: the workers themselves are what fills the processors.
ONE_THREAD = dict.fromkeys(
    (
        "LP_NUM_THREADS",
        "OMP_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
        "MKL_NUM_THREADS",
        "NUMEXPR_NUM_THREADS",
        "VECLIB_MAXIMUM_THREADS",
    ),
    "1",
)
#: The kernel ends a worker before the program where the machine has no memory left (of 1000).
FIRST_TO_GO = "600"

#: The one thread of a worker that makes contexts and works: OpenGL's belong to a thread.
_thread = ThreadPoolExecutor(1)


@dataclass(frozen=True)
class Program:
    """What has to be the same wherever tasks of one catalogue run."""

    version: str
    digest: str  #: SHA-256 of the package's modules, shaders and assets
    python: str
    numpy: str
    scipy: str

    def difference(self, other: Program) -> str:
        """Where another program differs, in words; empty where it does not."""
        pairs = (
            ("relgloss", self.version, other.version),
            ("Python", self.python, other.python),
            ("numpy", self.numpy, other.numpy),
            ("scipy", self.scipy, other.scipy),
            ("digest of relgloss, its shaders and assets", self.digest[:12], other.digest[:12]),
        )
        return "; ".join(f"{what} {theirs} in place of {ours}" for what, ours, theirs in pairs
                         if ours != theirs)  # fmt: skip


@dataclass(frozen=True)
class Refused:
    """In place of a result: this worker can't do the task; the fault names it, in one line."""

    fault: str
    can_draw: bool = True

    def error(self) -> RelglossError:
        """What ends the run."""
        return InputError(self.fault) if self.can_draw else GLUnavailableError(self.fault)


@lru_cache(maxsize=1)
def this_program() -> Program:
    """The program of this process. Takes some tenths of a second, once."""
    from importlib.metadata import version

    package = Path(__file__).resolve().parent.parent
    root = data_root()
    folders = [(package, ("**/*.py",)), (root / "shaders", ("**/*",)), (root / "assets", ("**/*",))]
    digest = hashlib.sha256()
    for folder, patterns in folders:
        for path in sorted(path for pattern in patterns for path in folder.glob(pattern)):
            if path.is_file() and "__pycache__" not in path.parts:
                words = f"{folder.name}/{path.relative_to(folder).as_posix()}"
                digest.update(f"{words}\0{path.stat().st_size}\0".encode())
                digest.update(path.read_bytes())
    python = ".".join(platform.python_version_tuple()[:2])
    return Program(__version__, digest.hexdigest(), python, version("numpy"), version("scipy"))


@dataclass(frozen=True)
class Performed:
    """What has come of a batch of tasks, from its first one on; those behind were not begun.

    results: the last one may be Refused, in place of a result. seconds: of each.
    """

    results: tuple[Any, ...]
    seconds: tuple[float, ...]


def perform(tasks: tuple[Task, ...], expected: Program, longest_s: float) -> Performed:
    """Do tasks one after the other, in a worker; none is begun after so many seconds."""
    difference = expected.difference(this_program())
    if difference:
        words = f"{worker_name()}: another program: {difference}; install the same there"
        return Performed((Refused(words),), (0.0,))
    for name, value in ONE_THREAD.items():  # a cluster's worker that was started without
        os.environ.setdefault(name, value)
    # Dask knows the worker in its own threads alone.
    return _thread.submit(_performed, tasks, longest_s, worker_name()).result()


def _performed(tasks: tuple[Task, ...], longest_s: float, worker: str) -> Performed:
    results: list[Any] = []
    seconds: list[float] = []
    begun_s = before_s = time.monotonic()
    with one_thread():
        for task in tasks:
            if results and before_s > begun_s + longest_s:
                break
            try:
                results.append(_result(task, worker))
            except Exception:
                if results:  # they are kept; the task comes again, as the first one
                    break
                raise
            after_s = time.monotonic()
            seconds.append(after_s - before_s)
            before_s = after_s
            if isinstance(results[-1], Refused):
                break
    return Performed(tuple(results), tuple(seconds))


def _result(task: Task, worker: str) -> Any:
    try:
        return task.result()
    except (RelglossError, OSError) as error:
        can_draw = not isinstance(error, GLUnavailableError)
        return Refused(f"{worker}: {task.name}: {error}", can_draw)


def worker_name() -> str:
    """This worker, for people: its name or address, user and machine."""
    from distributed import get_worker

    try:
        name = str(get_worker().name)
    except ValueError:
        name = str(os.getpid())
    return f"worker {name} (user {_user()} on {socket.gethostname()})"


def _user() -> str:
    try:
        import pwd

        return pwd.getpwuid(os.getuid()).pw_name
    except (ImportError, AttributeError, KeyError):
        return str(os.getuid()) if hasattr(os, "getuid") else "unknown"


def main(folder: str, name: str) -> int:
    """Be a worker of this machine until the scheduler closes it."""
    import asyncio

    import dask
    import distributed

    with contextlib.suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text(FIRST_TO_GO, encoding="ascii")
    login = json.loads(Path(folder, LOGIN).read_text(encoding="utf-8"))
    # Before the first task, whose time would be longer.
    this_program()
    importlib.import_module("relgloss_view.catalogue.work")

    async def serve() -> None:
        worker = distributed.Worker(
            login["address"],
            nthreads=1,
            name=name,
            host=LOOPBACK,
            security=distributed.Security(**login["security"]),
            dashboard_address=f"{LOOPBACK}:0",
            local_directory=folder,
            memory_limit=0,
        )
        async with worker:
            if not login["beats"]:  # the program sees by itself which of its children are alive
                worker.periodic_callbacks["heartbeat"].stop()
            await worker.finished()

    with dask.config.set(WORKER_CONFIG):
        asyncio.run(serve())
    return 0


#: No profile is taken, no data are kept: of Dask's services a catalogue needs the queue alone.
WORKER_CONFIG = {
    "distributed.worker.profile.enabled": False,
    "distributed.worker.preload": [],
    "distributed.admin.system-monitor.gil.enabled": False,
    "distributed.admin.system-monitor.interval": "10s",
    "distributed.admin.tick.interval": "500ms",
    "distributed.scheduler.active-memory-manager.start": False,
    "distributed.diagnostics.nvml": False,
}

if __name__ == "__main__":
    # Tasks import this module by its name; what is computed here would be computed again there.
    from relgloss_view.catalogue import cluster_worker

    sys.exit(cluster_worker.main(*sys.argv[1:]))
