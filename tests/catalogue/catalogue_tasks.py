"""Tasks that the tests of the engines hand to other processes."""

from __future__ import annotations

import os
import signal
import threading
import time
from pathlib import Path

import numpy as np

from relgloss_view.base.errors import GLUnavailableError
from relgloss_view.catalogue.engine import Task
from relgloss_view.catalogue.one_thread import thread_counts


def square(number):
    """A result that is cheap."""
    return {"number": number, "square": number * number}


def slow_square(number, seconds):
    """The same after a while."""
    time.sleep(seconds)
    return square(number)


def heavy(number, size):
    """A result of `size` bytes."""
    return number, bytes(size)


def busy(number, seconds):
    """Work of so many seconds of a processor."""
    end_s = time.thread_time() + seconds
    while time.thread_time() < end_s:
        pass
    return number


def deadly(number):
    """End the process that works on it."""
    os.kill(os.getpid(), signal.SIGKILL)


def greedy(number):
    """Take memory without end."""
    taken = []
    while True:
        taken.append(b"x" * 50_000_000)
        time.sleep(0.01)


def place(number):
    """Where it runs: process, thread, folder, variables."""
    return os.getpid(), threading.get_ident(), str(Path.cwd()), dict(os.environ)


def user(number):
    """Who runs it, and at home where."""
    return os.getuid(), os.environ["HOME"]


def blas_threads(number):
    """Threads of the linear algebra, and the bits of a product that depends on them."""
    rng = np.random.default_rng(number)
    a, b = rng.normal(size=(300, 300)), rng.normal(size=(300, 300))
    return thread_counts(), (a @ b).tobytes()


def no_context(number):
    """No OpenGL here."""
    raise GLUnavailableError("no OpenGL 3.3 context")


def text_of(path):
    """What a file holds."""
    return Path(path).read_text()


def wrong(number):
    """A bug of the program."""
    raise ZeroDivisionError(f"task {number}")


def tasks_of(function, numbers, *more):
    """A task for each number."""
    return [Task(f"{function.__name__} {n}", f"{n}.csv", function, (n, *more)) for n in numbers]
