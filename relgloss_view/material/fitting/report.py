"""The page that shows a fit."""

from __future__ import annotations

from pathlib import Path

from relgloss_view.material.material import Material
from relgloss_view.measure.table import Measurement


def write_fit_report(material: Material, measurement: Measurement, path: Path) -> None:
    """Stub."""
    raise NotImplementedError
