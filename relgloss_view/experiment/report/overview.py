"""All samples of a study in one picture: what was chosen for each, and how surely."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from relgloss_view.base.figures import FAINT, INK, MUTED
from relgloss_view.base.reading import printable
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.report import figures
from relgloss_view.experiment.report.answerers import people, truths
from relgloss_view.experiment.report.chosen_setting import ChosenSetting, Interval, chosen_setting
from relgloss_view.experiment.report.panels import EDGE_IN, heading, legend
from relgloss_view.experiment.report.sentences import SHORT, label_of
from relgloss_view.experiment.verdict.analysis import Analysis
from relgloss_view.picture.scene.setting import Setting, share_words

NAMES_IN, PANEL_IN, GAP_IN, WORDS_IN, ROW_IN = 2.3, 2.5, 0.3, 1.75, 0.34
AXIS_IN, FOOT_IN = 0.45, 0.75
MOST_TICKS = 7


def write_overview(path: Path, analysis: Analysis) -> None:
    """A row for each sample: sigma_N and c, between grid points and on them."""
    study = analysis.pool.study
    rows = len(analysis.samples)
    with figures.drawing():
        total = 2.0 * EDGE_IN + NAMES_IN + 2.0 * (PANEL_IN + GAP_IN) + WORDS_IN
        head = EDGE_IN + 0.3 + 0.35
        height = rows * ROW_IN
        figure = figures.new_figure(total, head + height + AXIS_IN + FOOT_IN)
        heading(figure, printable(study.title, 60), people(analysis.pool), most=1)
        sides = []
        for k, name in enumerate(("grain sigma_N, degrees", "c / c_max")):
            left = EDGE_IN + NAMES_IN + k * (PANEL_IN + GAP_IN)
            axes = figures.axes_at(figure, left, head, PANEL_IN, height)
            _scale(axes, study.grid, k, rows)
            axes.set_xlabel(name)
            sides.append(axes)
        told: dict[str, Any] = {}
        right = truths(analysis.pool)
        for row, result in enumerate(analysis.samples):
            choice = chosen_setting(result, study.grid)
            middle = head + (row + 0.5) * ROW_IN
            figures.write(
                figure, (EDGE_IN, middle), label_of(result), NAMES_IN - 0.2, va="center_baseline"
            )
            figures.write(
                figure, (total - EDGE_IN - WORDS_IN, middle), SHORT[choice.status], WORDS_IN,
                color=INK if choice.may_be_named else MUTED, va="center_baseline",
            )  # fmt: skip
            told |= _row(sides, row, choice, right.get(result.label))
        legend(figure, [(handle, words) for words, handle in told.items()])
        figures.save(figure, path)


def _scale(axes: Any, grid: Grid, axis: int, rows: int) -> None:
    values = grid.c_fraction if axis else grid.sigma_n_deg
    sixths = axis == 1 and all(share_words(c).endswith("/6") for c in values)
    span = values[-1] - values[0] or 1.0
    figures.bare(axes)
    axes.set_xlim(values[0] - 0.06 * span, values[-1] + 0.06 * span)
    axes.set_ylim(rows - 0.5, -0.5)
    axes.set_yticks([])
    for value in values:
        axes.axvline(value, color=FAINT, lw=0.7, zorder=0)
    for row in range(rows):
        axes.axhline(row, color=FAINT, lw=0.7, zorder=0)
    kept = values[:: -(-len(values) // MOST_TICKS)]
    axes.set_xticks(kept, [share_words(v) if sixths else f"{v:.3g}" for v in kept])


def _row(
    sides: list[Any], row: int, choice: ChosenSetting, truth: Setting | None
) -> dict[str, Any]:
    """The marks of a sample, where there is anything to point at; those for a legend."""
    handles: dict[str, Any] = {}
    for k, axes in enumerate(sides):
        if choice.may_be_named:
            (handles["leading setting of the grid"],) = axes.plot(
                _of(choice.setting, k), row, "s", mfc="none", mec=figures.MARK, mew=1.8, ms=10.0,
                zorder=3, ls="none", clip_on=False,
            )  # fmt: skip
        if choice.may_be_named:
            ends: Interval | None = choice.c_interval if k else choice.sigma_n_interval_deg
            name = "between grid points"
            if ends is not None:
                axes.plot(ends, [row, row], color=INK, lw=2.2, zorder=4, clip_on=False)
                name += ", with 95 % interval"
            (handles[name],) = axes.plot(
                _of(choice.at, k), row, "o", mfc="white", mec=INK, mew=1.3, ms=5.5, zorder=5,
                ls="none", clip_on=False,
            )  # fmt: skip
        if truth is not None:
            (handles["right for the simulated observers"],) = axes.plot(
                _of(truth, k), row + 0.33, "^", mfc=figures.TRUTH, mec="white", ms=6.0, zorder=6,
                ls="none", clip_on=False,
            )  # fmt: skip
    return handles


def _of(setting: Setting, axis: int) -> float:
    return setting.c_fraction if axis else setting.sigma_n_deg
