"""From a measurement to a material.

In order: `observations` (what is fitted), `shapes` and `model` (what a rung predicts), `unknowns`,
`linear`, `problem` and `descent` (how one rung is fitted), `search` and `ladder` (which rungs are
tried and chosen), `verdict`, `evidence` and `results` (what the fit may claim), `departure`,
`use_gloss`, `use_picture`, `use_planes` and `use` (the fit judged by gloss and picture), `fit` (all
of it), `curves`, `slices`, `describe` and `report` (how people read it).
"""

from relgloss_view.fitting.describe import describe_fit
from relgloss_view.fitting.fit import MODELS, fit_material
from relgloss_view.fitting.report import write_fit_report

__all__ = ["MODELS", "describe_fit", "fit_material", "write_fit_report"]
