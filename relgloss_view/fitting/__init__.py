"""From a measurement to a material.

In order: `observations` (what is fitted), `shapes` and `model` (what a rung predicts), `unknowns`,
`linear`, `problem` and `descent` (how one rung is fitted), `search` and `ladder` (which rungs are
tried and chosen), `verdict`, `evidence` and `results` (what the fit may claim), `departure`,
`use_gloss`, `use_picture`, `use_planes` and `use` (the fit judged by gloss and picture), `fit` (all
of it), `curves`, `slices`, `describe` and `report` (how people read it). Where there is no table:
`estimate`.

The names below are imported when first used: an estimate needs none of the fit's libraries.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from relgloss_view.fitting.describe import describe_fit as describe_fit
    from relgloss_view.fitting.fit import MODELS as MODELS
    from relgloss_view.fitting.fit import fit_material as fit_material
    from relgloss_view.fitting.report import write_fit_report as write_fit_report

_HOMES = {
    "MODELS": "fit",
    "describe_fit": "describe",
    "fit_material": "fit",
    "write_fit_report": "report",
}
__all__ = ["MODELS", "describe_fit", "fit_material", "write_fit_report"]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)
