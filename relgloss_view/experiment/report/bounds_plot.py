"""Settings and category bounds along one scale, with what is known of either."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.figures import INK, MUTED
from relgloss_view.base.reading import printable
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.report import figures
from relgloss_view.experiment.report.chosen_setting import (
    ChosenSetting,
    chosen_setting,
    setting_chosen_by,
)
from relgloss_view.experiment.report.panels import EDGE_IN, heading
from relgloss_view.experiment.report.sentences import BY, label_of
from relgloss_view.experiment.scaling.bootstrap import ScaleValues
from relgloss_view.experiment.verdict.analysis import Analysis, SampleResult

LEAST_ROWS, MOST_ROWS = 4, 48  #: settings, the closest ones; scale.csv has all
ROW_IN, NAMES_IN, PANEL_IN, PANEL_GAP_IN = 0.165, 1.25, 4.6, 0.25
TOP_IN, FOOT_IN = 0.3, 0.95
NUMBER_GAP = 0.035  #: between the numbers of categories, of a panel's width
ZONES = ("#ececec", "#e2e2e2")


def write_bounds(path: Path, result: SampleResult, analysis: Analysis) -> None:
    """Each setting's closeness among the categories, by each question."""
    study = analysis.pool.study
    with figures.drawing():
        rows = min(MOST_ROWS, max(int(np.sum(s.answered)) for s in result.scales))
        wide = NAMES_IN + PANEL_IN
        total = EDGE_IN + len(result.scales) * (wide + PANEL_GAP_IN)
        words = "; ".join(f"{k} {printable(c, 40)}" for k, c in enumerate(study.categories, 1))
        room = total - 2.0 * EDGE_IN
        head = EDGE_IN + 0.3 + figures.height_of(words, room, figures.SMALL_PT, 6)
        title_in = 0.25 if len(result.scales) > 1 else 0.0
        choices = [
            setting_chosen_by(result, study.grid, s.question)
            if result.adaptive is None
            else chosen_setting(result, study.grid)
            for s in result.scales
        ]
        height = (max(rows, LEAST_ROWS) + len(study.categories)) * ROW_IN
        figure = figures.new_figure(total, head + title_in + TOP_IN + height + FOOT_IN)
        heading(figure, label_of(result), words, most=6)
        for k, scale in enumerate(result.scales):
            axes = figures.axes_at(
                figure, EDGE_IN + NAMES_IN + k * (wide + PANEL_GAP_IN), head + title_in + TOP_IN,
                PANEL_IN, height,
            )  # fmt: skip
            if title_in:
                axes.set_title(BY[scale.question], fontsize=figures.TEXT_PT, color=INK, pad=20.0)
            _panel(axes, scale, choices[k], study.grid, rows)
        plain = all(s.interval is None for s in result.scales)
        _foot(figure, plain=plain, chosen_shown=any(c.may_be_named for c in choices))
        figures.save(figure, path)


def _panel(axes: Any, scale: ScaleValues, choice: ChosenSetting, grid: Grid, rows: int) -> None:
    figures.bare(axes)
    order = np.argsort(-np.where(scale.answered, scale.scale, -np.inf), kind="stable")
    order = order[: min(rows, int(np.sum(scale.answered)))]
    bounds = [k for k, bound in enumerate(scale.probit.bounds) if np.isfinite(bound)]
    across = _limits(scale, order)
    top = -len(scale.probit.bounds) - 1.5
    axes.set_xlim(*across)
    axes.set_ylim(max(rows, LEAST_ROWS) - 0.5, top)
    _categories(axes, scale, across)
    axes.axhline(-0.9, color=figures.PAPER, lw=3.0, zorder=2)
    names: list[tuple[float, str, str]] = []
    for k in bounds:
        row = k - len(scale.probit.bounds) - 0.9
        ends = None if scale.bounds_interval is None else -scale.bounds_interval[::-1, k]
        places = (-scale.probit.bounds[k], -scale.torgerson.bounds[k])
        _row(axes, row, places, ends, (figures.GOOD, "D", 4.0))
        names.append((row, f"bound {k + 1} | {k + 2}", figures.GOOD))
    for row, k in enumerate(order.tolist()):
        look = (MUTED, "o", 3.6)
        if choice.may_be_named and choice.as_good[k]:
            look = (INK, "o", 4.4)
        if choice.may_be_named and k == choice.leading:
            look = (figures.MARK, "o", 5.6)
        ends = None if scale.interval is None else scale.interval[:, k]
        _row(axes, row, (scale.scale[k], scale.torgerson.scale[k]), ends, look)
        names.append((row, grid.settings[k].words.removesuffix(" c_max"), look[0]))
    axes.set_yticks([row for row, _, _ in names], [name for _, name, _ in names], fontsize=7.0)
    for tick, (_, _, colour) in zip(axes.get_yticklabels(), names, strict=True):
        tick.set_color(colour)
    axes.set_xlabel("closeness, dispersions", fontsize=figures.SMALL_PT)
    axes.tick_params(axis="x", labelsize=figures.SMALL_PT)


def _row(
    axes: Any,
    row: float,
    places: tuple[float, float],
    ends: Array | None,
    look: tuple[str, str, float],
) -> None:
    """One value: by the probit with its interval, and Torgerson's."""
    colour, sign, size = look
    if ends is not None and np.all(np.isfinite(ends)):
        axes.plot(ends, [row, row], color=colour, lw=1.3, zorder=4, solid_capstyle="butt")
    axes.plot(places[0], row, sign, color=colour, ms=size, mew=0.0, zorder=5)
    axes.plot(places[1], row, "|", color=INK, ms=5.5, mew=0.9, zorder=6)


def _limits(scale: ScaleValues, order: Any) -> tuple[float, float]:
    """From the least to the largest of what is shown, and room for the end categories."""
    bounds = -scale.probit.bounds[np.isfinite(scale.probit.bounds)]
    values = scale.scale[order]
    placed = [values, bounds]
    if scale.interval is not None:
        placed += [*scale.interval[:, order]]
    if scale.bounds_interval is not None:
        placed += [*-scale.bounds_interval]
    every = np.concatenate(placed)
    every = every[np.isfinite(every)]
    low, high = float(np.min(every)), float(np.max(every))
    room = 0.06 * max(high - low, 0.5)
    return low - room, high + room


def _categories(axes: Any, scale: ScaleValues, across: tuple[float, float]) -> None:
    """Which category a setting of some closeness is put in most likely, 1 being close."""
    bounds = -scale.probit.bounds  # along closeness they fall
    places = [across[1], *bounds, across[0]]
    numbers: list[tuple[float, str]] = []
    above = across[1]
    for k, below in enumerate(places[1:]):
        if not np.isfinite(below):
            continue  # an end category that nobody used
        if above - below > 1e-9:
            axes.axvspan(below, above, color=ZONES[k % 2], lw=0, zorder=0)
            numbers.append((0.5 * (above + below), str(k + 1)))
        above = min(above, below)
    for bound in bounds[np.isfinite(bounds)]:
        axes.axvline(bound, color=figures.GOOD, lw=0.9, zorder=1)
    for place, number in _apart(numbers, NUMBER_GAP * (across[1] - across[0])):
        axes.annotate(
            number, (place, 1.0), xycoords=("data", "axes fraction"), xytext=(0, 3),
            textcoords="offset points", ha="center", va="bottom", fontsize=figures.SMALL_PT,
            color=figures.GOOD, weight="bold",
        )  # fmt: skip


def _apart(numbers: Sequence[tuple[float, str]], gap: float) -> list[tuple[float, str]]:
    """Moved to the left, from the right end on, where they would touch."""
    moved: list[tuple[float, str]] = []
    for place, number in numbers:
        moved.append((min(place, moved[-1][0] - gap) if moved else place, number))
    return moved


def _foot(figure: Any, *, plain: bool, chosen_shown: bool) -> None:
    """What the signs mean; `plain`: without intervals."""
    from matplotlib.lines import Line2D

    def _sign(colour: str, sign: str, size: float) -> Any:
        return Line2D([], [], color=colour, marker=sign, ms=size, mew=0.0, lw=0 if plain else 1.3)

    handles: list[tuple[Any, str]] = [
        (_sign(figures.GOOD, "D", 4.0), "bound between two categories"),
        (_sign(MUTED, "o", 4.0), "setting" + ("" if plain else ", with 95 % interval")),
        (_sign(figures.MARK, "o", 5.6), "leading setting"),
        (_sign(INK, "o", 4.4), "not significantly worse"),
        (Line2D([], [], color=INK, marker="|", ms=6.0, lw=0), "either by Torgerson's method"),
    ]
    if not chosen_shown:
        del handles[2:4]
    across, down = figure.get_size_inches()
    figure.legend(
        *zip(*handles, strict=True), loc="lower left", ncols=3, frameon=False,
        bbox_to_anchor=(EDGE_IN / across, 0.12 / down), fontsize=figures.SMALL_PT,
        borderaxespad=0.0, borderpad=0.0, columnspacing=1.4,
    )  # fmt: skip
