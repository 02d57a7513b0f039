"""Panels that show a value for every setting of a grid, and the marks on them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.figures import INK, MUTED
from relgloss_view.experiment.design.coordinates import coordinates, from_steps, grid_steps
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.report import figures
from relgloss_view.experiment.report.chosen_setting import ChosenSetting
from relgloss_view.experiment.report.sentences import label_of, sentence
from relgloss_view.experiment.verdict.analysis import Analysis, SampleResult
from relgloss_view.picture.scene.setting import Setting, share_words

CELL_IN, LEAST_IN, MOST_IN = 0.62, 1.1, (4.6, 3.9)  #: of a cell; of a panel
BESIDE = 0.72  #: the size of panels that stand beside others
LEFT_IN, RIGHT_IN, BOTTOM_IN = 0.85, 1.0, 0.55  #: around a panel
TITLE_IN, GAP_IN = 0.3, 0.12  #: above a panel
BAR_IN, BAR_GAP_IN = 0.13, 0.13
EDGE_IN, NARROWEST_IN, LEGEND_IN = 0.25, 5.6, 0.65  #: of a figure
FLAT = 1e-3  #: a fine table with less in it has no contours


def panel_in(grid: Grid, beside: bool = False) -> tuple[float, float]:
    """Width and height of a panel, inches."""
    size = BESIDE if beside else 1.0
    across, up = (
        min(max(size * CELL_IN * n, LEAST_IN), size * most)
        for n, most in zip(grid.shape, MOST_IN, strict=True)
    )
    return across, up


def panels(
    result: SampleResult, analysis: Analysis, titles: Sequence[str]
) -> tuple[Any, list[Any]]:
    """A figure that says which sample and what was found; a panel for each title, in a row."""
    grid = analysis.pool.study.grid
    width, height = panel_in(grid, len(titles) > 1)
    step = LEFT_IN + width + RIGHT_IN
    total = max(len(titles) * step, NARROWEST_IN)
    words = sentence(result, analysis)
    head = EDGE_IN + 0.3 + GAP_IN + (TITLE_IN if any(titles) else 0.0)
    head += figures.height_of(words, total - 2.0 * EDGE_IN, figures.SMALL_PT, 3)
    figure = figures.new_figure(total, head + height + BOTTOM_IN + LEGEND_IN)
    heading(figure, label_of(result), words)
    made = []
    for k, title in enumerate(titles):
        axes = figures.axes_at(figure, LEFT_IN + k * step, head, width, height)
        axes.set_title(title, fontsize=figures.TEXT_PT, color=INK)
        _scales(axes, grid, (width, height))
        made.append(axes)
    return figure, made


def heading(figure: Any, title: str, words: str, most: int = 3) -> None:
    """What a figure is about, at its top."""
    room = figure.get_size_inches()[0] - 2.0 * EDGE_IN
    below = figures.write(
        figure, (EDGE_IN, EDGE_IN - 0.05), title, room, size=figures.HEAD_PT, weight="bold"
    )
    figures.write(
        figure, (EDGE_IN, below), words, room, size=figures.SMALL_PT, most=most, color=MUTED
    )


def _scales(axes: Any, grid: Grid, size_in: tuple[float, float]) -> None:
    """One cell a setting, evenly, whatever the steps between them are."""
    figures.bare(axes)
    rows, columns = grid.shape
    axes.set_xlim(-0.5, rows - 0.5)
    axes.set_ylim(-0.5, columns - 0.5)
    across = [f"{s:.3g}" for s in grid.sigma_n_deg]
    up = [share_words(c) for c in grid.c_fraction]
    if not all(word.endswith("/6") for word in up):
        up = [f"{c:.3g}" for c in grid.c_fraction]
    of_x = figures.thinned(len(across), size_in[0], 0.4)
    of_y = figures.thinned(len(up), size_in[1], 0.16)
    axes.set_xticks(of_x, [across[k] for k in of_x])
    axes.set_yticks(of_y, [up[k] for k in of_y])
    axes.set_xlabel("grain sigma_N, degrees")
    axes.set_ylabel("c / c_max")


def cells(
    axes: Any, grid: Grid, values: Array, low: float | None = None, *, least_range: float
) -> Any:
    """The settings as cells, from `low` or the least value; those without a value are hatched."""
    rows, columns = grid.shape
    there = values[np.isfinite(values)]
    low = float(there.min()) if low is None else low
    high = max(float(there.max()), low + least_range)
    axes.add_patch(
        _box(0, 0, rows, columns, fc=figures.UNJUDGED, ec=figures.HATCH, hatch="////", zorder=0)
    )
    return axes.pcolormesh(
        np.arange(rows + 1) - 0.5, np.arange(columns + 1) - 0.5,
        np.ma.masked_invalid(values.reshape(rows, columns).T),
        cmap=figures.shades(), vmin=low, vmax=high, edgecolors=figures.PAPER, linewidth=0.8,
        zorder=1,
    )  # fmt: skip


def fine(axes: Any, grid: Grid, values: Array) -> Any:
    """A fine table over the range of the grid, with a dot where a setting is."""
    x, y = _places(grid, values.shape)
    mesh = axes.pcolormesh(
        _edges(x), _edges(y), values.T, cmap=figures.shades(), vmin=0.0, zorder=1
    )
    dots = np.array([divmod(k, grid.shape[1]) for k in range(len(grid))])
    axes.plot(dots[:, 0], dots[:, 1], ".", color=MUTED, ms=2.5, zorder=2, clip_on=False)
    return mesh


def bar(figure: Any, axes: Any, mesh: Any, name: str, form: Any = None) -> None:
    """What the shades of a panel mean, beside it; `form` formats its numbers."""
    place, across = axes.get_position(), figure.get_size_inches()[0]
    beside = figure.add_axes(
        (place.x1 + BAR_GAP_IN / across, place.y0, BAR_IN / across, place.height)
    )
    drawn = figure.colorbar(mesh, cax=beside, format=form)
    drawn.outline.set_visible(False)
    drawn.solids.set_edgecolor("face")  # else a viewer's smoothing shows lines between the shades
    beside.tick_params(length=0, labelsize=figures.SMALL_PT, labelcolor=MUTED)
    beside.set_ylabel(name, fontsize=figures.SMALL_PT, color=MUTED)


def contours(axes: Any, grid: Grid, smooth: Array | None, levels: Any = 7) -> None:
    """Lines of equal value of a fine table, where it has both axes."""
    if smooth is None or min(smooth.shape) < 2 or np.ptp(smooth) < FLAT:
        return
    x, y = _places(grid, smooth.shape)
    axes.contour(
        x, y, smooth.T, levels=levels, colors=INK, linewidths=0.7, alpha=0.5, linestyles="solid",
        zorder=2,
    )  # fmt: skip


def marks(
    axes: Any, grid: Grid, choice: ChosenSetting, truth: Setting | None, *, optimum: bool = True
) -> list[tuple[Any, str]]:
    """What is chosen and what is as good, where it may be shown; handles for a legend."""
    from matplotlib.lines import Line2D

    handles: list[tuple[Any, str]] = []
    columns = grid.shape[1]
    if choice.may_be_named:
        if np.sum(choice.as_good) > 1:
            _outline(axes, choice.as_good.reshape(grid.shape))
            line = Line2D([], [], color=figures.MARK, lw=1.5, ls=figures.DASHES)
            handles.append((line, "not significantly worse"))
        row, column = divmod(choice.leading, columns)
        leading = _box(row, column, 1, 1, ec=figures.MARK, lw=2.4, zorder=4)
        leading.set_clip_on(False)
        axes.add_patch(leading)
        handles.insert(0, (_box(0, 0, 1, 1, ec=figures.MARK, lw=2.4), "leading setting"))
        if optimum:
            handles.append((_cross(axes, grid, choice), _best_words(choice)))
    if truth is not None:
        (point,) = axes.plot(
            *_cell(grid, truth), "D", mfc=figures.TRUTH, mec="white", mew=0.8, ms=5.0, zorder=6,
            ls="none", clip_on=False,
        )  # fmt: skip
        handles.append((point, "right for the simulated observers"))
    return handles


def legend(figure: Any, handles: list[tuple[Any, str]]) -> None:
    """Once for all panels, at the foot of the figure."""
    if handles:
        across = figure.get_size_inches()[0]
        figure.legend(
            *zip(*handles, strict=True), loc="upper left", ncols=2, frameon=False,
            bbox_to_anchor=(EDGE_IN / across, (LEGEND_IN - 0.05) / figure.get_size_inches()[1]),
            fontsize=figures.SMALL_PT, borderaxespad=0.0, borderpad=0.0, labelcolor=INK,
        )  # fmt: skip


def _best_words(choice: ChosenSetting) -> str:
    if choice.adaptive:
        return "mean of the posterior, with 95 % intervals"
    known = choice.sigma_n_interval_deg or choice.c_interval
    return "best between grid points" + (", with 95 % intervals" if known else "")


def _cross(axes: Any, grid: Grid, choice: ChosenSetting) -> Any:
    """The best between grid points; its intervals along both axes."""
    from matplotlib.patheffects import withStroke

    best = choice.at
    halo = [withStroke(linewidth=3.4, foreground="white")]
    arms = [
        [Setting(end, best.c_fraction) for end in choice.sigma_n_interval_deg or ()],
        [Setting(best.sigma_n_deg, end) for end in choice.c_interval or ()],
    ]
    for arm in arms:
        if arm:
            across, up = zip(*(_cell(grid, setting) for setting in arm), strict=True)
            axes.plot(across, up, color=INK, lw=1.6, zorder=5, path_effects=halo, clip_on=False)
    (point,) = axes.plot(
        *_cell(grid, best), "o", mfc="white", mec=INK, mew=1.4, ms=8.5, zorder=5.5, ls="none",
        clip_on=False,
    )  # fmt: skip
    return point


def _outline(axes: Any, region: Any) -> None:
    """The border of a set of cells."""
    padded = np.pad(region, 1)
    for row, column in zip(*np.nonzero(region), strict=True):
        left, right, low, high = row - 0.5, row + 0.5, column - 0.5, column + 0.5
        for step, side in (
            ((-1, 0), ([left, left], [low, high])),
            ((1, 0), ([right, right], [low, high])),
            ((0, -1), ([left, right], [low, low])),
            ((0, 1), ([left, right], [high, high])),
        ):
            if not padded[row + 1 + step[0], column + 1 + step[1]]:
                axes.plot(
                    *side, color=figures.MARK, lw=1.5, ls=figures.DASHES, zorder=3, clip_on=False
                )


def _box(row: float, column: float, rows: float, columns: float, **style: Any) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle((row - 0.5, column - 0.5), rows, columns, **{"fc": "none", "lw": 0.0, **style})


def _cell(grid: Grid, setting: Setting) -> tuple[float, float]:
    """The place of a setting in a panel, whose cells are as wide as each other."""
    return grid_steps(grid, setting.sigma_n_deg, setting.c_fraction)


def _places(grid: Grid, shape: tuple[int, ...]) -> tuple[Array, Array]:
    """Where the rows and columns of a fine table over the grid's range stand in a panel."""
    ends = coordinates(grid)[-1]
    along_axes = []
    for axis in (0, 1):
        points = np.zeros((shape[axis], 2))
        points[:, axis] = np.linspace(0.0, ends[axis], shape[axis])
        settings = from_steps(grid, points)
        along_axes.append(
            np.array([_cell(grid, Setting(s, c))[axis] for s, c in settings.tolist()])
        )
    return along_axes[0], along_axes[1]


def _edges(places: Array) -> Array:
    """Between which places the cells of a fine axis lie; a whole cell where there is one."""
    if len(places) == 1:
        return np.array([places[0] - 0.5, places[0] + 0.5])
    middle = 0.5 * (places[1:] + places[:-1])
    return np.concatenate([places[:1], middle, places[-1:]])
