"""The engine that works in processes: Dask's, here or on a running cluster."""

from __future__ import annotations

from collections.abc import Iterable

from relgloss_view.catalogue.engine import Done, EngineOptions, Task, in_this_process


def on_processes(tasks: Iterable[Task], done: Done, options: EngineOptions) -> None:
    """Work off the tasks in processes of their own."""
    in_this_process(tasks, done, options)
