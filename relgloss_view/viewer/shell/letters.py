"""A warning of names of samples that no font here can show."""

from __future__ import annotations

from relgloss_view.base import fonts
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import SIDES


class Letters:
    """Reads the names of both sides against the fonts, once each time that they change."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._names: tuple[str, ...] = ()

    def report(self) -> None:
        """Warn once of a name that no font here can show."""
        samples = [self._model.state.side(side).sample for side in SIDES]
        names = tuple((s.material if s.pack is None else s.pack).name for s in samples)
        if names == self._names:
            return
        self._names = names
        texts = {f"the name of the {s}": n for s, n in zip(SIDES, names, strict=True)}
        for line in fonts.warnings(texts):
            self._model.report_once(line, fault=True)
