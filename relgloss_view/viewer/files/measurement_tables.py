"""Tables that samples of the state were fitted to, read again in the background for plots."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable

from relgloss_view.base.errors import RelglossError
from relgloss_view.measure.table import Measurement
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import SIDES


class MeasurementTables:
    """Gives the model the measurement of each sample whose table can still be read."""

    def __init__(self, model: Model, wake: Callable[[], None]) -> None:
        self._model = model
        self._wake = wake
        self._tried: set[str] = set()
        self._read: list[tuple[str, Measurement]] = []  #: by the threads, for the window's own

    def each_frame(self) -> None:
        """Take the tables that were read; begin to read those that are missing, each once."""
        while self._read:
            self._model.measurements.setdefault(*self._read.pop())
        for side in SIDES:
            table = self._model.state.side(side).sample.table
            if table is None or table in self._model.measurements or table in self._tried:
                continue
            self._tried.add(table)
            threading.Thread(target=self._run, args=(table,), daemon=True).start()

    def _run(self, table: str) -> None:
        from relgloss_view.measure.readers import read_measurement

        # A table that is gone leaves the plot without points; the picture needs none.
        with contextlib.suppress(RelglossError):
            self._read.append((table, read_measurement(table)))
            self._wake()
