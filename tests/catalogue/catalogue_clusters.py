"""Processes that the tests of the engines look at, start and end."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import sysconfig
import time
from pathlib import Path

import psutil

from relgloss_view.catalogue import cluster_worker
from relgloss_view.catalogue.cluster_worker import ONE_THREAD
from relgloss_view.catalogue.engine import run

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
NOBODY = 65534
AS_NOBODY = ("setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups")
STARTED_S = 120.0
ENDED_S = 60.0  #: so long processes may take to end, on a busy machine


def results(tasks, options, step=None, engine=run):
    """What `done` got, by key; each key once."""
    got = {}

    def done(task, result):
        assert task.key not in got
        got[task.key] = result
        if step is not None:
            step()

    engine(tasks, done, options)
    return got


def workers_of(pid):
    """The worker processes below a process."""
    try:
        children = psutil.Process(pid).children(recursive=True)
    except psutil.NoSuchProcess:
        return []
    alive = []
    for child in children:
        try:
            if cluster_worker.__name__ in child.cmdline():
                alive.append(child)
        except psutil.Error:
            continue
    return alive


def wait_until(condition, longest_s=ENDED_S):
    """Whether a condition comes true in time."""
    end_s = time.monotonic() + longest_s
    while time.monotonic() < end_s:
        if condition():
            return True
        time.sleep(0.05)
    return condition()


def elsewhere(home, *packages):
    """Variables of a process that has another home and the same program, or what is named."""
    packages = packages or (str(ROOT), str(HERE), sysconfig.get_path("purelib"))
    kept = {name: value for name, value in os.environ.items() if name not in ONE_THREAD}
    return {**kept, "HOME": str(home), "PYTHONPATH": os.pathsep.join(packages)}


class Cluster:
    """A scheduler and workers, each started by Dask's own command.

    nobody: the Python that another user starts; None for this user's.
    """

    def __init__(self, folder, nobody=None):
        self.folder, self.nobody = folder, nobody
        self.file = folder / "scheduler.json"
        self.processes = []
        self.scheduler = None

    def start(self, *words, packages=()):
        """Start `dask WORDS` elsewhere: another folder and, where we may, another user."""
        home = self.folder / "home"
        home.mkdir(exist_ok=True)
        command = [sys.executable, "-m", "dask", *words]
        if self.nobody:
            for path in (self.folder, home, *self.folder.glob("*.json")):
                os.chown(path, NOBODY, NOBODY)
            command = [*AS_NOBODY, self.nobody, *command[1:]]
        process = subprocess.Popen(
            command,
            cwd=home,
            env=elsewhere(home, *packages),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            process_group=0,
        )
        self.processes.append(process)
        return process

    def start_scheduler(self, port=0, packages=()):
        """Start the scheduler. Returns its address."""
        self.file.unlink(missing_ok=True)
        words = ("--host", "127.0.0.1", "--port", str(port), "--no-dashboard")
        where = ("--scheduler-file", str(self.file), "--dashboard-address", "127.0.0.1:0")
        self.scheduler = self.start("scheduler", *words, *where, packages=packages)
        end_s = time.monotonic() + STARTED_S
        while time.monotonic() < end_s:
            with contextlib.suppress(OSError, ValueError):
                return json.loads(self.file.read_text())["address"]
            time.sleep(0.05)
        raise AssertionError("no scheduler has started")

    def start_worker(self, name, *more, packages=()):
        """Start a worker with one thread."""
        place = ("--local-directory", str(self.folder / "home"))
        words = ("--scheduler-file", str(self.file), "--nthreads", "1", "--no-dashboard")
        return self.start("worker", *words, "--name", name, *place, *more, packages=packages)

    def close(self):
        """End all processes, with those that they have started."""
        for process in self.processes:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def python_of_nobody():
    """A Python that another user can start and that has this program; None where there is none."""
    if os.getuid() != 0 or shutil.which("setpriv") is None:
        return None
    check = "import os, sys, distributed; import relgloss_view.catalogue.engine; "
    ours = tuple(sys.version_info[:2])
    check += f"sys.exit(not os.access(sys.executable, 1) or sys.version_info[:2] != {ours})"
    for python in (sys.executable, "/usr/bin/python3"):
        done = subprocess.run(
            [*AS_NOBODY, python, "-c", check], cwd="/", env=elsewhere("/"), capture_output=True
        )
        if done.returncode == 0:
            return python
    return None
