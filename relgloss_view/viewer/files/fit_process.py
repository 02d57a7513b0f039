"""A fit in a process of its own, so that drawing and fitting do not wait for each other.

In a thread the window would hardly notice the fit: a main thread that wakes every 5 ms never waited
for longer than 42 ms. But the fit would starve. It releases the interpreter at every step and waits
up to 5 ms to get it back from drawing: a fit that takes 1.3 s alone took 20 s while pictures were
drawn one after the other (measured on two cores).
"""

from __future__ import annotations

from relgloss_view.base.terminal import ProgressReport
from relgloss_view.material.material import Material
from relgloss_view.measure.table import Measurement
from relgloss_view.viewer.files.answering import Answering, answered


class FitProcess(Answering):
    """Reads and fits one measurement. Begins at once; InputError where no process can be made."""

    def __init__(self, path: str) -> None:
        self._path = path
        super().__init__(__name__, path, fault=f"{path}: no process can be made to fit it")

    def run(self, progress: ProgressReport) -> tuple[Material, Measurement]:
        """Wait for the outcome; InputError for what is wrong with the file or ends the process."""
        ended = (
            f"{self._path}: the fit ended before it was done; there may not be enough memory: "
            "thin out the table or close other programs"
        )
        material, measurement = self.outcome(progress, ended)
        return material, measurement


def answer(path: str) -> None:
    """What the process does: read and fit."""

    def work(progress: ProgressReport) -> tuple[Material, Measurement]:
        from relgloss_view.fitting import fit_material
        from relgloss_view.measure.readers import read_measurement

        measurement = read_measurement(path)
        progress(0.0, "fitting")
        return fit_material(measurement, progress=progress), measurement

    short = f"{path}: not enough memory; thin out the table or close other programs"
    answered(work, path, short)
