"""L* along a row of pixels across the highlight, and its distribution over the object."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from imgui_bundle import imgui, implot

from relgloss_view.base.errors import RelglossError
from relgloss_view.picture.frame import Frame
from relgloss_view.viewer.panels import plots
from relgloss_view.viewer.plots.lightness import BINS, Histogram, Lightness, Line
from relgloss_view.viewer.plots.memory import PerFrame, light_of
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import SIDES

TOP_LSTAR = 120.0
#: As many pixels stand for all while a hand drags; 50 000 take a third of a millisecond.
PIXELS_IN_A_DRAG = 50_000
LEAST_SHARE = 0.01  #: %, the histogram's foot
NARROW_EM = 28.0  #: below this width the plots lie in tabs


@dataclass
class _Side:
    """What one side's curves are made from, and the last of them."""

    light: PerFrame[Lightness] = field(default_factory=lambda: PerFrame(Lightness.of, light_of))
    made_from: Lightness | None = None
    line: Line | None = None
    line_row: int = 0
    histogram: Histogram | None = None
    histogram_key: tuple[object, ...] = ()


@dataclass
class _Memory:
    sides: dict[str, _Side] = field(default_factory=lambda: {name: _Side() for name in SIDES})
    row: int | None = None  #: None follows the highlight
    width: int = 0


@dataclass(frozen=True)
class _Curves:
    line: Line
    histogram: Histogram
    c: float


_memory = plots.Kept(_Memory)


def show(model: Model) -> None:
    """Draw the panel into the present window."""
    imgui.push_id("lightness")
    try:
        _show(model)
    except RelglossError as error:  # a lamp's file may have gone since the picture was drawn
        widgets.wrapped(str(error), dim=True)
    finally:
        imgui.pop_id()


def _show(model: Model) -> None:
    memory = _memory.of(model)
    side = plots.side_switch(model)
    if side not in model.frames:
        widgets.quiet("No picture yet.")
        return
    light, current = memory.sides[side].light.get(model.frames[side], dragging=model.dragging)
    if light is None:
        widgets.quiet("The curves follow when you let go.")
        return
    _row_slider(memory, light)
    row = light.default_row if memory.row is None else memory.row
    shown = {side: _curves(memory.sides[side], light, model.frames[side], row, model.dragging)}
    beside = plots.other(side)
    if beside in model.frames:
        faint, _ = memory.sides[beside].light.get(model.frames[beside], dragging=model.dragging)
        if faint is not None:
            frame = model.frames[beside]
            shown[beside] = _curves(memory.sides[beside], faint, frame, row, model.dragging)
    _legend(side, shown)
    plots.state_of_drag(current)
    plots.of_the_split(model)
    room = imgui.get_content_region_avail()
    if room.x < em(NARROW_EM):
        _in_tabs(memory, side, shown, room.x)
        return
    left = 0.62 * room.x
    _line_plot(memory, side, shown, left, room.y)
    imgui.same_line(0.0, 0.0)
    _histogram_plot(side, shown, room.x - left, room.y)


def _in_tabs(memory: _Memory, side: str, shown: dict[str, _Curves], width: float) -> None:
    if not imgui.begin_tab_bar("plots"):
        return
    if imgui.begin_tab_item("across the highlight")[0]:
        _line_plot(memory, side, shown, width, imgui.get_content_region_avail().y)
        imgui.end_tab_item()
    if imgui.begin_tab_item("distribution")[0]:
        _histogram_plot(side, shown, width, imgui.get_content_region_avail().y)
        imgui.end_tab_item()
    imgui.end_tab_bar()


def _row_slider(memory: _Memory, light: Lightness) -> None:
    height = light.y_diffuse.shape[0]
    following = memory.row is None
    row = min(light.default_row if memory.row is None else memory.row, height - 1)
    plots.beside(em(10))
    imgui.set_next_item_width(em(10))
    where = ", highlight" if following and light.highlight_row is not None else ""
    changed, moved = imgui.slider_int("##row", row, 0, max(height - 1, 0), f"row %d{where}")
    if changed:
        memory.row = min(max(moved, 0), height - 1)
    if widgets.reset_by_double_click():
        memory.row = None
    widgets.tooltip(
        "The row of pixels, from the top, along which L* is shown. Ctrl-click types a row; a "
        "double click follows the row of the brightest specular pixel again."
    )


def _curves(side: _Side, light: Lightness, frame: Frame, row: int, dragging: bool) -> _Curves:
    """The line and histogram of a side, made again only where something has changed."""
    if side.made_from is not light:
        side.made_from, side.line, side.histogram = light, None, None
    if side.line is None or side.line_row != row:
        side.line, side.line_row = light.line(row), row
    most = PIXELS_IN_A_DRAG if dragging else None
    if side.histogram is None or side.histogram_key != (frame.c, most):
        side.histogram, side.histogram_key = light.histogram(frame.c, most), (frame.c, most)
    return _Curves(side.line, side.histogram, frame.c)


def _legend(side: str, shown: dict[str, _Curves]) -> None:
    curves = shown[side]
    seen = curves.line.on_object
    top = float(np.max(curves.line.plain[seen])) if np.any(seen) else 0.0
    beyond = f" to {top:.0f}" if top > TOP_LSTAR else ""
    entries = [
        ("scaled", plots.TOTAL),
        ("L_d*", plots.DIFFUSE),
        ("L_s*", plots.SPECULAR),
        (f"c = 1{beyond}", plots.PLAIN),
    ]
    if plots.other(side) in shown:
        entries.append((plots.other(side), plots.OTHER))
    plots.legend(entries)


def _line_plot(
    memory: _Memory, side: str, shown: dict[str, _Curves], width: float, height: float
) -> None:
    count = len(shown[side].line.l_d)
    if plots.begin("line", width, height):
        follow = count != memory.width
        memory.width = count
        across = "pixel column", 0.0, float(max(count, 2))
        low = plots.axes(across, ("L*", 0.0, TOP_LSTAR), follow=follow)
        plots.lightness_ticks(implot.ImAxis_.y1)
        plots.level("limit", 100.0)
        for name in (plots.other(side), side):
            if name in shown:
                _draw_line(shown[name], faint=name != side)
        if low:
            plots.label_inside("L*, columns")
        plots.end()


def _draw_line(curves: _Curves, *, faint: bool) -> None:
    line = curves.line
    x = np.arange(len(line.l_d), dtype=np.float64) + 0.5

    def seen(values: plots.Array) -> plots.Array:
        return np.where(line.on_object, values, np.nan)

    if faint:
        plots.line("scaled", x, seen(line.scaled(curves.c)), plots.TOTAL, faint=True)
        return
    plots.line("increase L_s*", x, seen(line.l_s), plots.SPECULAR, weight=1.2)
    plots.line("plain", x, seen(line.plain), plots.PLAIN, weight=1.2)
    plots.line("diffuse L_d*", x, seen(line.l_d), plots.DIFFUSE, weight=1.2)
    plots.line("scaled", x, seen(line.scaled(curves.c)), plots.TOTAL)


def _histogram_plot(side: str, shown: dict[str, _Curves], width: float, height: float) -> None:
    if plots.begin("histogram", width, height):
        clipped = shown[side].histogram.clipped
        label = f"scaled L*; {100.0 * clipped:.2g} % above 100" if clipped else "scaled L*"
        low = plots.axes((label, 0.0, TOP_LSTAR), ("% of object", LEAST_SHARE, 100.0))
        implot.setup_axis_scale(implot.ImAxis_.y1, implot.Scale_.log10)
        ticks = [0.01, 0.1, 1.0, 10.0, 100.0]
        words = [f"{v:g}" for v in ticks]
        implot.setup_axis_ticks(implot.ImAxis_.y1, ticks, words)
        plots.lightness_ticks(implot.ImAxis_.x1)
        plots.level("limit", 100.0, across=False)
        for name in (plots.other(side), side):
            if name in shown:
                _draw_histogram(shown[name].histogram, faint=name != side)
        if low:
            plots.label_inside("% of object, L*")
        plots.end()


def _draw_histogram(histogram: Histogram, *, faint: bool) -> None:
    # A stair needs its last edge too; what is clipped stands just above 100.
    edges = np.arange(BINS + 3, dtype=np.float64)
    share = 100.0 * np.concatenate([histogram.share, [histogram.clipped, 0.0, 0.0]])
    share = np.maximum(share, 0.1 * LEAST_SHARE)
    colour = plots.OTHER if faint else plots.TOTAL
    weight = (1.0 if faint else 1.4) * em(1.0) / 15.0
    spec = implot.Spec(line_color=colour, line_weight=weight)
    implot.plot_stairs(f"scaled##{'faint' if faint else 'bold'}", edges, share, spec)
