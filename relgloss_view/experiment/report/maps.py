"""Maps over the grid: how close each setting is, and how often it leads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.figures import INK
from relgloss_view.experiment.report import figures, panels
from relgloss_view.experiment.report.answerers import truths
from relgloss_view.experiment.report.chosen_setting import (
    chosen_setting,
    scale_table,
    setting_chosen_by,
)
from relgloss_view.experiment.report.results import counts_of
from relgloss_view.experiment.report.sentences import BY
from relgloss_view.experiment.verdict.analysis import Analysis, SampleResult

REGION = 0.95  #: of a posterior, within its outline
LEAST_RANGE = 2.0  #: dispersions, from white to dark: less must not look like more
CELL_IN = 0.33  #: a cell as large has room for a number
CLOSENESS, POSTERIOR = "closeness, dispersions", "posterior, of its peak"
LEADS, NEAREST = "share of resamplings in which it leads", "share of the posterior nearest to it"


def write_closeness(path: Path, result: SampleResult, analysis: Analysis) -> None:
    """The closeness of all settings, by each question and by both; adaptive: the posterior."""
    grid = analysis.pool.study.grid
    truth = truths(analysis.pool).get(result.label)
    with figures.drawing():
        if result.adaptive is not None:
            figure, (axes,) = panels.panels(result, analysis, [""])
            posterior = result.adaptive.posterior
            mesh = panels.fine(axes, grid, posterior / posterior.max())
            panels.contours(axes, grid, posterior, [level_of(posterior, REGION)])
            panels.bar(figure, axes, mesh, POSTERIOR)
            handles = panels.marks(axes, grid, chosen_setting(result, grid), truth)
        else:
            counts = counts_of(analysis.pool, result.label)
            titles = [BY[q] if len(result.verdicts) > 1 else "" for q in result.verdicts]
            figure, made = panels.panels(result, analysis, titles)
            by_words: dict[str, Any] = {}
            for axes, (question, verdict) in zip(made, result.verdicts.items(), strict=True):
                values = scale_table(result, counts, question).probit
                mesh = panels.cells(axes, grid, values, least_range=LEAST_RANGE)
                panels.bar(figure, axes, mesh, CLOSENESS)
                choice = setting_chosen_by(result, grid, question)
                panels.contours(axes, grid, verdict.smooth if choice.may_be_named else None)
                marked = panels.marks(axes, grid, choice, truth)
                by_words |= {words: handle for handle, words in marked}
            handles = [(handle, words) for words, handle in by_words.items()]
        panels.legend(figure, handles)
        figures.save(figure, path)


def level_of(posterior: Array, share: float) -> float:
    """The probability above which so large a share of a posterior lies."""
    ordered = np.sort(posterior, axis=None)[::-1]
    reached = int(np.searchsorted(np.cumsum(ordered), share))
    return float(ordered[min(reached, len(ordered) - 1)])


def write_winners(path: Path, result: SampleResult, analysis: Analysis) -> bool:
    """In how many resamplings each setting leads; False, and no file, where there are none."""
    grid = analysis.pool.study.grid
    choice = chosen_setting(result, grid)
    if choice.shares is None:
        return False
    with figures.drawing():
        figure, (axes,) = panels.panels(result, analysis, [""])
        mesh = panels.cells(axes, grid, choice.shares, low=0.0, least_range=0.1)
        name = NEAREST if choice.adaptive else LEADS
        panels.bar(figure, axes, mesh, name, lambda share, _: f"{100.0 * share:.0f} %")
        sizes = np.divide(panels.panel_in(grid), grid.shape)
        if np.min(sizes) >= CELL_IN:
            top = float(np.max(choice.shares))
            least = 0.005 if choice.adaptive else 0.0  # a posterior is nowhere nothing
            for k, share in enumerate(choice.shares):
                if share > least:
                    axes.text(
                        *divmod(k, grid.shape[1]), _short(share), ha="center", va="center",
                        fontsize=7.5, color="white" if share > 0.6 * top else INK, zorder=3,
                    )  # fmt: skip
        panels.legend(figure, panels.marks(axes, grid, choice, None, optimum=False))
        figures.save(figure, path)
    return True


def _short(share: float) -> str:
    return "< 1 %" if share < 0.01 else f"{100.0 * share:.0f} %"
