"""All plots of a report, as PNG files."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from relgloss_view.base.decoration import Drawn, decoration
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.experiment.report.bounds_plot import write_bounds
from relgloss_view.experiment.report.maps import write_closeness, write_winners
from relgloss_view.experiment.report.overview import write_overview
from relgloss_view.experiment.report.sentences import label_of
from relgloss_view.experiment.verdict.analysis import Analysis

OVERVIEW = "overview.png"


@dataclass(frozen=True)
class Plot:
    """A plot of a sample: its file's name, and what it shows for those who can't see it."""

    file: str
    shows: str


def write_plots(
    folder: Path,
    analysis: Analysis,
    names: Mapping[str, str],
    progress: ProgressReport = no_progress,
) -> dict[str, tuple[Plot, ...]]:
    """Write each sample's plots, by label, and overview.png where there is a scaled sample.

    `names` are those of the files. A plot that can't be drawn is left out, with a warning.
    """
    if analysis.samples:
        with _plot(folder / OVERVIEW):
            write_overview(folder / OVERVIEW, analysis)
    plots_by_label = {}
    for number, result in enumerate(analysis.samples):
        label = label_of(result)
        progress(number / len(analysis.samples), f"plots of {label}")
        name = names[result.label]
        closeness, winners, bounds = (
            f"{name}-{kind}.png" for kind in ("closeness", "winners", "bounds")
        )
        plots = []
        with _plot(folder / closeness):
            write_closeness(folder / closeness, result, analysis)
            map_of = "posterior" if result.adaptive is not None else "closeness of every setting"
            plots.append(Plot(closeness, f"{label}: map of the {map_of}, sigma_N across, c up"))
        with _plot(folder / winners):
            if write_winners(folder / winners, result, analysis):
                plots.append(Plot(winners, f"{label}: map of how often each setting leads"))
        with _plot(folder / bounds):
            write_bounds(folder / bounds, result, analysis)
            shows = f"{label}: settings among the category bounds, closest first"
            plots.append(Plot(bounds, shows))
        plots_by_label[result.label] = tuple(plots)
    return plots_by_label


def _plot(path: Path) -> contextlib.AbstractContextManager[Drawn]:
    return decoration(path.name, "all numbers and tables are written", files=[path])
