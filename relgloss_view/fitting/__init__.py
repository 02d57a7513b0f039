"""From a measurement to a material: samples, shapes, solvers, the ladder of models, the verdict."""

from relgloss_view.fitting.describe import describe_fit
from relgloss_view.fitting.fit import MODELS, fit_material
from relgloss_view.fitting.report import write_fit_report

__all__ = ["MODELS", "describe_fit", "fit_material", "write_fit_report"]
