"""The stability maps as figures: colour is the error, a line where it passes the bound."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from relgloss_view.base.decoration import decoration
from relgloss_view.base.figures import INK, MUTED, drawing, new_figure, save_figure
from relgloss_view.bench.stability.maps import Axis, Map
from relgloss_view.picture.gpu.targets import LARGEST_HALF

FAILED = "#d0006f"
#: A map fills its axes: it has a frame on all sides and no grid. Its logarithmic axes write powers.
FRAMED = {
    "axes.grid": False,
    "axes.spines.top": True,
    "axes.spines.right": True,
    "text.parse_math": True,
}
PAGES = {
    "lobe": "Lobe: largest error over all normals, as a share of the lobe's peak",
    "diffuse": "Diffuse part: largest error for the full model of Oren and Nayar",
    "grain": "Grain and lamp: largest error, as a share of the peak",
    "tone": "Tone stage: L*, a*, b* against float64; c_max; how bright a highlight is",
}
KEPT = "stability.json has all numbers"
LOWEST, HIGHEST = -7, 0  #: decades of error
PANEL_INCHES = (3.7, 3.0)


def write_figures(maps: list[Map], folder: Path) -> list[str]:
    """One figure a page as PNG and SVG; returns the names of the files that could be drawn."""
    names: list[str] = []
    for page, title in PAGES.items():
        panels = [m for m in maps if m.subject.page == page]
        files = {ending: f"stability-{page}.{ending}" for ending in ("png", "svg")}
        places = [folder / name for name in files.values()]
        with decoration(files["png"], KEPT, files=places) as drawn, drawing(FRAMED):
            figure = _page(title, panels)
            for ending, name in files.items():
                save_figure(figure, folder / name, ending)
        names += files.values() if drawn.done else []
    return names


def _page(title: str, panels: list[Map]) -> Any:
    columns = 2 if len(panels) == 4 else 3
    rows = -(-len(panels) // columns)
    size = (PANEL_INCHES[0] * columns + 1.0, PANEL_INCHES[1] * rows + 0.9)
    figure = new_figure(*size, dpi=110, layout="constrained")
    figure.suptitle(title, x=0.01, ha="left", fontsize=11, weight="bold", color=INK)
    axes = figure.subplots(rows, columns, squeeze=False)
    for panel, ax in zip(panels, axes.flat, strict=False):
        _draw(ax, panel)
    _explain(figure, axes)
    return figure


def _draw(ax: Any, m: Map) -> None:
    subject = m.subject
    x, y = _edges(m.x, subject.x), _edges(m.y, subject.y)
    if subject.is_error:
        _cells(ax, m, x, y)
    else:
        _levels(ax, m)
    for axis, set_scale in ((subject.x, ax.set_xscale), (subject.y, ax.set_yscale)):
        if axis.log:
            set_scale("log")
    ax.set_xlim(x[0], x[-1])
    ax.set_ylim(y[0], y[-1])
    ax.set_xlabel(subject.x.label)
    ax.set_ylabel(subject.y.label)
    told = subject.unit
    if subject.domain is not None:
        told += f"; line at {subject.domain.bound:g}"
        told += "" if subject.domain.boxes else "; holds nowhere"
    ax.set_title(subject.title, color=INK, pad=14.0)
    place = {"xy": (0.0, 1.02), "xycoords": "axes fraction"}
    ax.annotate(told, **place, fontsize=7.0, color=MUTED)


def _cells(ax: Any, m: Map, x: Any, y: Any) -> None:
    subject, (colours, norm) = m.subject, _colours()
    shown = np.where(np.isfinite(m.error), np.log10(np.maximum(m.error, 1e-30)), np.nan)
    ax.set_facecolor(FAILED)
    ax.pcolormesh(x, y, shown, cmap=colours, norm=norm, rasterized=True)
    if subject.domain is not None:
        worst = np.where(np.isfinite(m.error), m.error, 1e30)
        level = [subject.domain.bound]
        if np.min(worst) < level[0] < np.max(worst):
            ax.contour(m.x, m.y, worst, level, colors="white", linewidths=2.6)
            ax.contour(m.x, m.y, worst, level, colors=INK, linewidths=1.2)
        _outline(ax, x, y, m.inside)


def _levels(ax: Any, m: Map) -> None:
    """Lines of equal value, labelled: for a map that shows no error."""
    ax.set_facecolor("white")
    colours = {"cmap": "Greys", "vmin": -3.0, "vmax": 10.0, "rasterized": True}
    x, y = _edges(m.x, m.subject.x), _edges(m.y, m.subject.y)
    ax.pcolormesh(x, y, np.log10(np.maximum(m.error, 1e-30)), **colours)
    levels = [*(10.0**k for k in range(-2, 7)), LARGEST_HALF]
    widths = [0.7] * (len(levels) - 1) + [1.6]
    drawn = ax.contour(
        m.x,
        m.y,
        m.error,
        sorted(levels),
        colors=INK,
        linewidths=[widths[levels.index(v)] for v in sorted(levels)],
    )
    ax.clabel(drawn, fmt=lambda v: f"{v:g}", fontsize=6.5)


def _outline(ax: Any, x: Any, y: Any, inside: Any) -> None:
    """A dotted line around the cells of the declared domain."""
    from matplotlib.collections import LineCollection

    cells = np.pad(inside, 1)
    flat = [
        ((x[j], y[k]), (x[j + 1], y[k]))
        for k, j in np.argwhere(cells[:-1, 1:-1] != cells[1:, 1:-1])
    ]
    upright = [
        ((x[k], y[j]), (x[k], y[j + 1]))
        for j, k in np.argwhere(cells[1:-1, :-1] != cells[1:-1, 1:])
    ]
    for colour, width, style in (("white", 1.8, "solid"), (INK, 1.0, (0, (1.2, 1.2)))):
        lines = LineCollection(flat + upright, colors=colour, linewidths=width, linestyles=style)
        ax.add_collection(lines, autolim=False)


def _edges(values: Any, axis: Axis) -> Any:
    """Borders between cells around the values."""
    v = np.log(values) if axis.log else np.asarray(values)
    middle = 0.5 * (v[1:] + v[:-1])
    edges = np.concatenate([[v[0] - (middle[0] - v[0])], middle, [v[-1] + (v[-1] - middle[-1])]])
    if axis.log:
        return np.exp(edges)
    return np.maximum(edges, min(float(values[0]), 0.0)) if values[0] >= 0.0 else edges


def _colours() -> tuple[Any, Any]:
    from matplotlib import colormaps
    from matplotlib.colors import BoundaryNorm

    return colormaps["viridis"].resampled(256), BoundaryNorm(
        np.arange(LOWEST, HIGHEST + 0.5, 0.5), 256, extend="both"
    )


def _explain(figure: Any, axes: Any) -> None:
    from matplotlib.cm import ScalarMappable

    colours, norm = _colours()
    bar = figure.colorbar(ScalarMappable(norm, colours), ax=axes, shrink=0.8, pad=0.01, aspect=40)
    bar.set_ticks(list(range(LOWEST, HIGHEST + 1)))
    bar.set_ticklabels([f"1e{k}" for k in range(LOWEST, HIGHEST + 1)])
    bar.outline.set_linewidth(0.4)
    said = "line: where the error passes the bound; dotted: the declared domain"
    figure.supxlabel(f"{said}; magenta: not finite", x=0.99, ha="right", fontsize=7.5, color=MUTED)
