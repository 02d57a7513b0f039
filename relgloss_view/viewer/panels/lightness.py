"""L* along a row of pixels across the highlight, and its distribution over the object."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from imgui_bundle import imgui, implot

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import RelglossError
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model.view import Size
from relgloss_view.viewer.panels import plot_widgets
from relgloss_view.viewer.plots.caches import PerFrame, light_of
from relgloss_view.viewer.plots.lightness import BINS, Histogram, Lightness, Line
from relgloss_view.viewer.shell import sliders, widgets
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.state.model import GhostPicture, Model
from relgloss_view.viewer.state.state import SIDES

TOP_LSTAR = 120.0
#: As many pixels represent all while a hand drags; 50 000 take a third of a millisecond.
PIXELS_IN_A_DRAG = 50_000
LEAST_SHARE = 0.01  #: %, the histogram's foot
LEFT_OF_PLOT_EM = 3.0  #: the values of the vertical axis and its label
BAND = "dullest to glossiest"
BAND_ALPHA = 0.4
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


_memory = plot_widgets.Kept(_Memory)


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
    side = plot_widgets.side_switch(model)
    if side not in model.frames:
        widgets.quiet("No picture yet.")
        return
    light, current = memory.sides[side].light.get(model.frames[side], dragging=model.dragging)
    if light is None:
        widgets.quiet("The curves follow when you let go.")
        return
    _row_slider(memory, light)
    row = light.default_row if memory.row is None else memory.row
    curves = {side: _curves(memory.sides[side], light, model.frames[side], row, model.dragging)}
    beside = plot_widgets.other(side)
    if beside in model.frames:
        faint, _ = memory.sides[beside].light.get(model.frames[beside], dragging=model.dragging)
        if faint is not None:
            frame = model.frames[beside]
            curves[beside] = _curves(memory.sides[beside], faint, frame, row, model.dragging)
    _legend(side, curves, with_band=model.ghost_side == side and len(model.ghosts) > 1)
    plot_widgets.note_if_waiting(current)
    plot_widgets.note_split(model)
    room = imgui.get_content_region_avail()
    if room.x < em(NARROW_EM):
        _in_tabs(model, memory, side, curves, room.x)
        return
    left = 0.62 * room.x
    _line_plot(model, memory, side, curves, left, room.y)
    imgui.same_line(0.0, 0.0)
    _histogram_plot(side, curves, room.x - left, room.y)


def _in_tabs(
    model: Model, memory: _Memory, side: str, by_side: dict[str, _Curves], width: float
) -> None:
    if not imgui.begin_tab_bar("plots"):
        return
    if imgui.begin_tab_item("Across the highlight")[0]:
        _line_plot(model, memory, side, by_side, width, imgui.get_content_region_avail().y)
        imgui.end_tab_item()
    if imgui.begin_tab_item("Distribution")[0]:
        _histogram_plot(side, by_side, width, imgui.get_content_region_avail().y)
        imgui.end_tab_item()
    imgui.end_tab_bar()


def _row_slider(memory: _Memory, light: Lightness) -> None:
    height = light.y_diffuse.shape[0]
    following = memory.row is None
    row = min(light.default_row if memory.row is None else memory.row, height - 1)
    plot_widgets.beside(em(10))
    imgui.set_next_item_width(em(10))
    where = ", highlight" if following and light.highlight_row is not None else ""
    changed, moved = sliders.int_slider("##row", row, 0, max(height - 1, 0), f"row %d{where}")
    if changed:
        memory.row = min(max(moved, 0), height - 1)
    if sliders.resetting():
        memory.row = None
    widgets.tooltip(
        "The row of pixels, from the top, along which the lightness is plotted. Ctrl+click or "
        "Enter to type a row, double-click or Delete to follow the highlight again."
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


def _legend(side: str, by_side: dict[str, _Curves], *, with_band: bool) -> None:
    curves = by_side[side]
    on_object = curves.line.on_object
    top = float(np.max(curves.line.plain[on_object])) if np.any(on_object) else 0.0
    beyond = f" to {top:.0f}" if top > TOP_LSTAR else ""
    entries = [
        ("picture (L*)", plot_widgets.TOTAL),
        ("diffuse (L_d*)", plot_widgets.DIFFUSE),
        ("specular (L_s*)", plot_widgets.SPECULAR),
        (f"unscaled (c = 1){beyond}", plot_widgets.PLAIN),
    ]
    if with_band:
        entries.append((BAND, plot_widgets.BAND))
    if plot_widgets.other(side) in by_side:
        entries.append((plot_widgets.other(side), plot_widgets.OTHER))
    plot_widgets.legend(entries)


def _line_plot(
    model: Model,
    memory: _Memory,
    side: str,
    by_side: dict[str, _Curves],
    width: float,
    height: float,
) -> None:
    count = len(by_side[side].line.l_d)
    if plot_widgets.begin("line", width, height):
        follow = count != memory.width
        memory.width = count
        across = "pixel column", 0.0, float(max(count, 2))
        low = plot_widgets.axes(across, ("lightness (L*)", 0.0, TOP_LSTAR), follow=follow)
        plot_widgets.lightness_ticks(implot.ImAxis_.y1)
        plot_widgets.level("limit", 100.0)
        if model.ghost_side == side:
            _draw_band(model.ghosts, by_side[side], model.picture_size)
        for name in (plot_widgets.other(side), side):
            if name in by_side:
                _draw_line(by_side[name], faint=name != side)
        if low:
            plot_widgets.label_inside("L* by column")
        plot_widgets.end()


def _draw_band(ghosts: dict[str, GhostPicture], curves: _Curves, full: Size) -> None:
    """The band between the dullest and the glossiest material that the readings allow."""
    if len(ghosts) < 2:
        return
    low, high = band(ghosts, curves, full[1])
    x = (np.arange(len(low), dtype=np.float64) + 0.5) * len(curves.line.l_d) / len(low)
    spec = implot.Spec(fill_color=plot_widgets.TOTAL, fill_alpha=BAND_ALPHA, line_weight=0.0)
    implot.plot_shaded(f"##{BAND}", x, low, high, spec)


def band(ghosts: dict[str, GhostPicture], curves: _Curves, height: int) -> tuple[Array, Array]:
    """Least and largest L* by column of the small pictures (W,), along the same row of the object.

    height: of the full picture, pixels.
    """
    lines = []
    for ghost in ghosts.values():
        row = int((curves.line.row + 0.5) * ghost.size[1] / height)
        line = ghost.lightness.line(row)
        lines.append(np.where(line.on_object, np.minimum(line.scaled(curves.c), 2 * TOP_LSTAR), 0))
    return np.min(lines, axis=0), np.max(lines, axis=0)


def _draw_line(curves: _Curves, *, faint: bool) -> None:
    line = curves.line
    x = np.arange(len(line.l_d), dtype=np.float64) + 0.5

    def on_object(values: Array) -> Array:
        return np.where(line.on_object, values, np.nan)

    if faint:
        plot_widgets.line(
            "scaled", x, on_object(line.scaled(curves.c)), plot_widgets.TOTAL, faint=True
        )
        return
    plot_widgets.line("increase L_s*", x, on_object(line.l_s), plot_widgets.SPECULAR, weight=1.2)
    plot_widgets.line("plain", x, on_object(line.plain), plot_widgets.PLAIN, weight=1.2)
    plot_widgets.line("diffuse L_d*", x, on_object(line.l_d), plot_widgets.DIFFUSE, weight=1.2)
    plot_widgets.line("scaled", x, on_object(line.scaled(curves.c)), plot_widgets.TOTAL)


def _histogram_plot(side: str, by_side: dict[str, _Curves], width: float, height: float) -> None:
    if plot_widgets.begin("histogram", width, height):
        clipped = by_side[side].histogram.clipped
        label = "lightness (L*)"
        if clipped:
            above = f"{100.0 * clipped:.2g} % above 100"
            whole = f"{label}; {above}"
            room = width - em(LEFT_OF_PLOT_EM)
            label = whole if imgui.calc_text_size(whole).x < room else f"L*; {above}"
        low = plot_widgets.axes((label, 0.0, TOP_LSTAR), ("% of pixels", LEAST_SHARE, 100.0))
        implot.setup_axis_scale(implot.ImAxis_.y1, implot.Scale_.log10)
        ticks = [0.01, 0.1, 1.0, 10.0, 100.0]
        words = [f"{v:g}" for v in ticks]
        implot.setup_axis_ticks(implot.ImAxis_.y1, ticks, words)
        plot_widgets.lightness_ticks(implot.ImAxis_.x1)
        plot_widgets.level("limit", 100.0, across=False)
        for name in (plot_widgets.other(side), side):
            if name in by_side:
                _draw_histogram(by_side[name].histogram, faint=name != side)
        if low:
            plot_widgets.label_inside("% of pixels by L*")
        plot_widgets.end()


def _draw_histogram(histogram: Histogram, *, faint: bool) -> None:
    # A stair needs its last edge too; the clipped share is just above 100.
    edges = np.arange(BINS + 3, dtype=np.float64)
    share = 100.0 * np.concatenate([histogram.share, [histogram.clipped, 0.0, 0.0]])
    share = np.maximum(share, 0.1 * LEAST_SHARE)
    colour = plot_widgets.OTHER if faint else plot_widgets.TOTAL
    weight = (1.0 if faint else 1.4) * em(1.0) / 15.0
    spec = implot.Spec(line_color=colour, line_weight=weight)
    implot.plot_stairs(f"scaled##{'faint' if faint else 'bold'}", edges, share, spec)
