"""A report as a folder: page, plots, numbers, tables and scenes."""

from __future__ import annotations

import json
from pathlib import Path

from relgloss_view.base.decoration import decoration
from relgloss_view.base.json_files import read_mark
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.experiment.report.file_names import file_names
from relgloss_view.experiment.report.page import report_page
from relgloss_view.experiment.report.plots import write_plots
from relgloss_view.experiment.report.results import as_numbers
from relgloss_view.experiment.report.scenes import write_scenes
from relgloss_view.experiment.report.tables import write_tables
from relgloss_view.experiment.verdict.analysis import Analysis

PAGE, RESULTS = "report.html", "results.json"  #: results.json says whose a folder is
PLOTS_SHARE = 0.95  #: of the time


def write_report(
    folder: Path,
    analysis: Analysis,
    *,
    command: str | None = None,
    progress: ProgressReport = no_progress,
) -> tuple[str, ...]:
    """Fill an existing, empty folder; the names of what was written, all of them plain files.

    The same analysis and command give the same bytes. `command` is shown as the line that makes the
    report again.
    """
    labels = [result.label for result in analysis.samples]
    *of_samples, of_reference = file_names([*labels, "reference"])
    names = dict(zip(labels, of_samples, strict=True))
    write_tables(folder, analysis)
    scenes = write_scenes(folder, analysis, names, of_reference)
    plots = write_plots(
        folder, analysis, names, lambda share, text: progress(PLOTS_SHARE * share, text)
    )
    progress(PLOTS_SHARE, PAGE)
    with decoration(PAGE, "all numbers and tables are written", files=[folder / PAGE]):
        page = report_page(folder, analysis, plots, scenes, command)
        (folder / PAGE).write_text(page, encoding="utf-8", newline="\n")
    written = sorted({path.name for path in folder.iterdir()} | {RESULTS})
    content = as_numbers(analysis)
    for sample in content["samples"]:
        sample["scene"] = scenes.get(sample["label"])
        sample["plots"] = [plot.file for plot in plots[sample["label"]]]
    content["written"] = written
    text = json.dumps(content, indent=1, allow_nan=False) + "\n"
    (folder / RESULTS).write_text(text, encoding="utf-8")
    return tuple(written)


def earlier_files(folder: Path) -> tuple[str, ...]:
    """What a former report has written into a folder, as its results.json lists.

    It goes with that report: a setting that was declared best once is not to stand beside a report
    that declares none.
    """
    names = read_mark(folder / RESULTS).get("written")
    return tuple(name for name in names if isinstance(name, str)) if isinstance(names, list) else ()
