"""Tasks that the tests of the engines hand to other processes."""

from __future__ import annotations

import os
import signal
import threading
import time
from pathlib import Path

from relgloss_view.catalogue.engine import Task


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


def text_of(path):
    """What a file holds."""
    return Path(path).read_text()


def wrong(number):
    """A bug of the program."""
    raise ZeroDivisionError(f"task {number}")


def tasks_of(function, numbers, *more):
    """A task for each number."""
    return [Task(f"{function.__name__} {n}", f"{n}.csv", function, (n, *more)) for n in numbers]
