"""The chart: time across, error up on a logarithmic axis; what nothing else beats is joined."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.figures import (
    ACCENT,
    FAINT,
    INK,
    MUTED,
    drawing,
    new_figure,
    save_figure,
)
from relgloss_view.base.reading import printable
from relgloss_view.bench.speed.labels import spread
from relgloss_view.bench.speed.run import NO_ERROR

Found = dict[str, Any]

CHARTS = ("chart.svg", "chart.png")
FIGURE_INCHES, DPI = (9.6, 6.6), 170
JND = 1.0  #: dE2000
FRONT, AUTO, POINT = "#1f6f8b", "#2e7d4f", "#8b96a0"
CROWD = 1.7  #: points within this factor of the fastest's time stand in the wide panel
CROWD_SHARE = 0.38  #: of that panel; labels have the rest
LEFT, BOTTOM, TOP, WIDE, NARROW, GAP = 0.085, 0.135, 0.855, 0.70, 0.155, 0.015
SEEN_FLOOR, NEAR_FLOOR = 0.96, 2.0  #: where the fastest is within this of the floor, it is shown
LABEL_INCHES, LABEL_GAP = 0.168, 0.035  #: height of a label; share of the panel beside the crowd


def write_chart(found: Found, folder: Path) -> None:
    """chart.svg and chart.png of a run, drawn without a window system."""
    figure = figure_of(found)
    with drawing():
        for name in CHARTS:
            save_figure(figure, folder / name, name.rpartition(".")[2])


def figure_of(found: Found) -> Any:
    """The chart as matplotlib's figure."""
    with drawing({"font.size": 9.0}):
        figure = new_figure(*FIGURE_INCHES, dpi=DPI)
        _draw(figure, found)
    return figure


def _draw(figure: Any, found: Found) -> None:
    entries = [entry for entry in found["methods"] if entry["charted"]]
    limit = CROWD * min(entry["floors"] for entry in entries)
    crowd = [entry for entry in entries if entry["floors"] <= limit]
    others = [entry for entry in entries if entry["floors"] > limit]
    lone = bool(others)
    wide = figure.add_axes((LEFT, BOTTOM, WIDE if lone else WIDE + GAP + NARROW, TOP - BOTTOM))
    top = 2.2 * max(max(entry["worst_p95"] for entry in entries), JND)
    _panel(wide, top)
    low, high = _times(crowd)[[0, -1]]
    room = max(high - low, 0.2 * low) * (1.0 / CROWD_SHARE - 1.0) * 0.5
    left = low - room
    wide.set_xlim(min(left, SEEN_FLOOR) if low < NEAR_FLOOR else left, high + room)
    _ticks_of_times(wide, 1.0)
    _front(wide, [entry for entry in crowd if entry["front"]])
    _points(wide, crowd)
    _label_crowd(figure, wide, crowd)
    _floor(wide)
    wide.set_ylabel("error: dE2000, 95th percentile")
    wide.set_xlabel("time of a frame, as a multiple of the fill floor")
    if lone:
        side = figure.add_axes((LEFT + WIDE + GAP, BOTTOM, NARROW, TOP - BOTTOM), sharey=wide)
        _panel(side, top)
        side.set_xscale("log")
        times = _times(others)
        side.set_xlim(0.62 * times[0], 1.6 * times[-1])
        _ticks_of_times(side, times[0])
        side.spines["left"].set_visible(False)
        side.tick_params(labelleft=False)
        _points(side, others)
        for entry in others:
            _label_alone(side, entry)
    last = figure.axes[-1]
    last.text(
        1.02,
        JND,
        "1 JND",
        transform=last.get_yaxis_transform(),
        color=ACCENT,
        fontsize=8,
        va="center",
    )
    _words(figure, found)


def _times(entries: Sequence[Found]) -> Array:
    return np.sort([entry["floors"] for entry in entries])


def _up(entry: Found) -> float:
    return max(float(entry["worst_p95"]), NO_ERROR)


def _panel(axis: Any, top: float) -> None:
    """Errors up: what is above a just noticeable difference is tinted."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    axis.set_yscale("log")
    axis.set_ylim(0.55 * NO_ERROR, top)
    axis.yaxis.set_major_locator(FixedLocator([0.01, 0.1, 1.0, 10.0, 100.0]))
    axis.yaxis.set_minor_locator(NullLocator())
    axis.yaxis.set_major_formatter(
        FuncFormatter(lambda v, _: f"≤ {v:g}" if v == NO_ERROR else f"{v:g}")
    )
    axis.tick_params(which="both", length=0)
    axis.set_facecolor("none")
    axis.axhspan(JND, top, color=ACCENT, alpha=0.035, lw=0)
    axis.axhline(JND, color=ACCENT, lw=0.9)


def _ticks_of_times(axis: Any, least: float) -> None:
    """Round numbers; none below the floor, where nothing can be."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    low, high = axis.get_xlim()
    steps = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
    step = next((s for s in steps if (high - low) / s <= 9.0), 20.0)
    ticks = np.arange(np.ceil(low / step), np.floor(high / step) + 1.0) * step
    if axis.get_xscale() == "log":
        ticks = np.array([t for t in (2, 3, 5, 10, 20, 30, 50, 100, 200) if low <= t <= high])
    axis.xaxis.set_major_locator(FixedLocator([t for t in ticks if t >= least - 1e-9]))
    axis.xaxis.set_minor_locator(NullLocator())
    axis.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def _floor(axis: Any) -> None:
    low, high = axis.get_xlim()
    if not low < 1.0 < high:
        return
    axis.axvline(1.0, color=MUTED, lw=0.9, ls=(0, (1, 2)), zorder=1)
    axis.annotate(
        "fill floor",
        (1.0, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(0, 3),
        textcoords="offset points",
        ha="center",
        fontsize=8,
        color=MUTED,
    )


def _front(axis: Any, entries: Sequence[Found]) -> None:
    """Steps: right of and above them, something else is both faster and nearer."""
    steps = sorted((entry["floors"], _up(entry)) for entry in entries)
    if steps:
        across, up = zip(*steps, strict=True)
        axis.step(across, up, where="post", color=FRONT, lw=1.3, alpha=0.8, zorder=2)


def _points(axis: Any, entries: Sequence[Found]) -> None:
    for entry in entries:
        x, y = entry["floors"], _up(entry)
        if entry["default"]:
            axis.plot(x, y, "o", ms=10.5, mfc="white", mec=ACCENT, mew=1.4, zorder=5)
            axis.plot(x, y, "o", ms=5.0, color=ACCENT, mew=0, zorder=6)
        elif entry["group"] == "auto":
            axis.plot(x, y, "D", ms=8.0, color=AUTO, mec="white", mew=0.8, zorder=6)
        else:
            axis.plot(
                x, y, "o", ms=5.5, color=_colour(entry, POINT), mec="white", mew=0.6, zorder=4
            )


def _label_crowd(figure: Any, axis: Any, entries: Sequence[Found]) -> None:
    """In a column on either side, joined by lines: the faster half left, the slower right."""
    to_axes = axis.transAxes.inverted()
    places = {
        entry["method"]: to_axes.transform(axis.transData.transform((entry["floors"], _up(entry))))
        for entry in entries
    }
    by_time = sorted(entries, key=lambda entry: entry["floors"])
    half = len(by_time) // 2
    reach = [places[entry["method"]][0] for entry in (by_time[0], by_time[-1])]
    step = LABEL_INCHES / (figure.get_size_inches()[1] * axis.get_position().height)
    for some, column, sign in (
        (by_time[:half], reach[0] - LABEL_GAP, -1.0),
        (by_time[half:], reach[1] + LABEL_GAP, 1.0),
    ):
        order = sorted(some, key=lambda e: (places[e["method"]][1], -sign * places[e["method"]][0]))
        wanted = [float(places[entry["method"]][1]) for entry in order]
        for entry, up in zip(
            order, spread(wanted, step, 0.5 * step, 1.0 - 0.5 * step), strict=True
        ):
            x, y = places[entry["method"]]
            axis.plot(
                [x, column - 0.012 * sign, column - 0.004 * sign],
                [y, up, up],
                transform=axis.transAxes,
                color=FAINT,
                lw=0.8,
                zorder=1.5,
            )
            side = "left" if sign > 0.0 else "right"
            _label(axis, entry, (column, up), ha=side, transform=axis.transAxes)


def _label_alone(axis: Any, entry: Found) -> None:
    """Above its point, or below where the line of a just noticeable difference would cross it."""
    up = _up(entry)
    below = 0.5 * JND < up < JND
    axis.annotate(
        entry["label"].replace(", ", ",\n"),
        (entry["floors"], up),
        xytext=(0, -6 if below else 6),
        textcoords="offset points",
        ha="center",
        va="top" if below else "bottom",
        fontsize=8.2,
        color=_colour(entry, INK),
        parse_math=False,
        path_effects=_halo(),
    )


def _halo() -> list[Any]:
    """What lifts words off the lines behind them."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=2.2, foreground="white", alpha=0.85)]


def _label(axis: Any, entry: Found, place: tuple[float, float], **how: Any) -> None:
    marked = entry["default"] or entry["group"] == "auto"
    axis.text(
        *place,
        entry["label"],
        va="center_baseline",
        fontsize=8.5,
        color=_colour(entry, INK),
        weight="bold" if marked else "normal",
        parse_math=False,
        zorder=7,
        path_effects=_halo(),
        **how,
    )


def _colour(entry: Found, otherwise: str) -> str:
    if entry["default"]:
        return ACCENT
    if entry["group"] == "auto":
        return AUTO
    return FRONT if entry["front"] else otherwise


def _words(figure: Any, found: Found) -> None:
    width, height = found["settings"]["size"]
    floors = [scene["floor_ms"] for scene in found["scenes"]]
    figure.text(LEFT, 0.955, "Speed against accuracy", fontsize=14, weight="bold", color=INK)
    said = (
        f"Each way to draw {len(found['scenes'])} scenes at {width} x {height}: median time; error "
        "against the float64 spectral reference, in the worst scene,\nthe worse of object and "
        "highlight. Joined: nothing else is both faster and nearer."
    )
    figure.text(LEFT, 0.942, said, fontsize=8.5, color=MUTED, va="top", linespacing=1.35)
    made = found["machine"]
    machine = (
        f"{printable(made['cpu'], 70)}, {made['cores']} cores, "
        f"{printable(made['opengl']['renderer'], 60)}; fill floor {np.median(floors):.1f} ms"
    )
    figure.text(0.965, 0.022, machine, fontsize=7.5, color=MUTED, ha="right", parse_math=False)
    if found["quick"]:
        figure.text(LEFT, 0.022, "a quick run: few scenes and frames", fontsize=7.5, color=ACCENT)
