"""Gloss meters' readings of the window's materials, computed in the background."""

from __future__ import annotations

from collections.abc import Callable

from relgloss_view.gloss.meter.meter import Reading, gloss_readings
from relgloss_view.material.material import Material
from relgloss_view.viewer.files.background import Outcome, Worker
from relgloss_view.viewer.plots.caches import Recent

Readings = tuple[Reading, ...]


class GlossReadings:
    """The readings of the materials that were last asked for."""

    def __init__(self, wake: Callable[[], None]) -> None:
        self._worker: Worker[Material, Readings] = Worker(wake)
        self._recent: Recent[Outcome[Material, Readings]] = Recent()

    def of(self, material: Material) -> Outcome[Material, Readings] | None:
        """A material's readings or why it has none; None until they are computed."""
        ended = self._worker.take()
        if ended is not None:
            self._recent.get(ended.key, None, lambda: ended)
        outcome = self._recent.peek(material, None)
        if outcome is None and not self._worker.busy:
            self._worker.start(material, lambda: gloss_readings(material))
        return outcome
