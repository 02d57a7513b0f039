"""What readings of a display show beside the fit: its faults, the file's, and the reading's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from relgloss_view.base.arrays import Array
from relgloss_view.display.candidates import Fitted
from relgloss_view.display.readings import Readings

if TYPE_CHECKING:
    from relgloss_view.display.fit import DisplayFit


@dataclass(frozen=True)
class Finding:
    """A warning: a whole sentence with the step that mends it; grave: whether the fit is poor."""

    text: str
    grave: bool = True


def refuse_unusable(readings: Readings) -> None:
    """Raise InputError where the readings can't carry a model."""


def diagnose(
    readings: Readings, fit: DisplayFit, kept: Array, fine: Fitted, whitening: Array
) -> list[Finding]:
    """All findings, the gravest kind first."""
    return []
