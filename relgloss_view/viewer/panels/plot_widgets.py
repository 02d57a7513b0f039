"""Plots of the panels: curves in the theme's colours, a legend, a choice of the side."""

from __future__ import annotations

import math
import weakref
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from imgui_bundle import ImVec2, ImVec4, imgui, implot

from relgloss_view.base.arrays import Array
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import CURVES, PANEL, QUIET, em, gray
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import SIDES

T = TypeVar("T")

TOTAL, DIFFUSE, SPECULAR, PLAIN = CURVES[0], CURVES[1], CURVES[2], CURVES[4]
OTHER = gray(0.45)  #: the other side's curves
LIMIT = gray(QUIET)
BAND = gray(0.36)  #: as a translucent band looks on a panel
SMALLEST_PLOT_EM = (8.0, 4.5)
LOW_EM = 11.0  #: in a lower plot the labels of the axes are inside
ROOMY_EM = 12.0  #: with this height left, the legend may take a line of its own
MORE = "..."
Entry = tuple[str, ImVec4]
_low = False  #: whether the plot that was begun is low
POINTS = gray(1.0, 0.85)


class Kept(Generic[T]):
    """A panel's own memory for each model, gone with it."""

    def __init__(self, make: Callable[[], T]) -> None:
        self._make = make
        self._of: weakref.WeakKeyDictionary[Model, T] = weakref.WeakKeyDictionary()

    def of(self, model: Model) -> T:
        """The memory for a model."""
        if model not in self._of:
            self._of[model] = self._make()
        return self._of[model]


def other(side: str) -> str:
    """The side that is not this one."""
    return SIDES[1 - SIDES.index(side)]


def side_switch(model: Model) -> str:
    """Two buttons that choose the active side; returns it."""
    for k, side in enumerate(SIDES):
        if k:
            imgui.same_line(0.0, em(0.6))
        if imgui.radio_button(side.capitalize(), model.active_side == side):
            model.active_side = side
        widgets.tooltip(f"Shows the {side} picture's curves; the other's are faint.")
    return model.active_side


def beside(width: float, gap_em: float = 1.1) -> None:
    """Put what comes next, so wide in pixels, on the same line if it fits, else on a new one."""
    right = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
    imgui.same_line(0.0, em(gap_em))
    if imgui.get_cursor_screen_pos().x + width > right:
        imgui.new_line()


def checkbox_width(text: str) -> float:
    """Width of a box to tick with its text, pixels."""
    gap = imgui.get_style().item_inner_spacing.x
    return float(imgui.get_frame_height() + gap + imgui.calc_text_size(text).x)


def button_width(text: str) -> float:
    """Width of a button or a radio button's text with its padding, pixels."""
    return float(imgui.calc_text_size(text).x + 2.0 * imgui.get_style().frame_padding.x)


def legend(entries: list[Entry]) -> None:
    """The meaning of the curves' colours, beside the controls; a tooltip has what finds no room."""
    right = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
    dots = imgui.calc_text_size(MORE).x
    more = em(1.1) + dots
    tall = imgui.get_content_region_avail().y > em(ROOMY_EM)
    if tall and entries:
        beside(sum(_entry_width(text) + em(1.1) for text, _ in entries) - em(1.1))
        imgui.dummy(ImVec2(0.0, 0.0))
    for k, (text, _) in enumerate(entries):
        imgui.same_line(0.0, 0.0 if tall and k == 0 else em(1.1))
        width = _entry_width(text)
        last = k == len(entries) - 1
        if imgui.get_cursor_screen_pos().x + width + (0.0 if last else more) > right:
            if imgui.get_cursor_screen_pos().x + dots > right:
                imgui.new_line()
            imgui.align_text_to_frame_padding()
            widgets.quiet(MORE)
            if imgui.begin_item_tooltip():
                for entry in entries[k:]:
                    _entry(entry)
                imgui.end_tooltip()
            return
        _entry(entries[k])


def _entry_width(text: str) -> float:
    return float(em(1.45) + imgui.calc_text_size(text).x)


def _entry(entry: Entry) -> None:
    text, colour = entry
    font = imgui.get_font_size()
    sample = 1.1 * font
    imgui.align_text_to_frame_padding()
    at = imgui.get_cursor_screen_pos()
    middle = at.y + 0.5 * imgui.get_frame_height()
    draw, ink = imgui.get_window_draw_list(), imgui.get_color_u32(colour)
    if colour is POINTS:
        draw.add_circle(ImVec2(at.x + 0.5 * sample, middle), 0.2 * font, ink)
    else:
        draw.add_line(ImVec2(at.x, middle), ImVec2(at.x + sample, middle), ink, 0.14 * font)
    imgui.dummy(ImVec2(sample, 0.0))
    imgui.same_line(0.0, 0.35 * font)
    imgui.text_unformatted(text)


def table_headings() -> None:
    """The row of headings of a table, which the keyboard passes over: they do nothing."""
    imgui.push_item_flag(imgui.ItemFlags_.no_nav, True)
    imgui.table_headers_row()
    imgui.pop_item_flag()


def note_if_waiting(current: bool) -> None:
    """Note that curves wait for the end of a drag, where they are not current."""
    if not current:
        text = "Follows when you let go"
        beside(imgui.calc_text_size(text).x)
        imgui.align_text_to_frame_padding()
        widgets.quiet(text)


def note_split(model: Model) -> None:
    """Note that numbers are the split's, where a picture shows another operator's."""
    if model.operator_pictures:
        text = "Values of the split"
        beside(imgui.calc_text_size(text).x)
        imgui.align_text_to_frame_padding()
        widgets.quiet(text)
        widgets.tooltip(
            "These numbers are of the split's picture, whatever tone mapping the pictures show."
        )


def begin(title: str, width: float, height: float, *, decorated: bool = True) -> bool:
    """Begin a plot of a size in pixels; `end` must follow where this is true."""
    global _low
    _low = height < em(LOW_EM)
    small = ImVec2(em(SMALLEST_PLOT_EM[0]), em(SMALLEST_PLOT_EM[1]))
    implot.push_style_var(implot.StyleVar_.plot_min_size, ImVec2(0.5 * small.x, 0.5 * small.y))
    unit = em(1.0) / 15.0
    implot.push_style_var(implot.StyleVar_.label_padding, ImVec2(4.0 * unit, 2.0 * unit))
    implot.push_style_var(implot.StyleVar_.plot_padding, ImVec2(6.0 * unit, 4.0 * unit))
    flags = implot.Flags_.no_title | implot.Flags_.no_legend | implot.Flags_.no_menus
    flags |= implot.Flags_.no_frame
    if not decorated:
        flags |= implot.Flags_.canvas_only | implot.Flags_.no_inputs
    # A plot shows; there is nothing in it that the keyboard could move.
    imgui.push_item_flag(imgui.ItemFlags_.no_nav, True)
    begun: bool = implot.begin_plot(
        f"##{title}", (max(width, small.x), max(height, small.y)), flags
    )
    imgui.pop_item_flag()
    if not begun:
        implot.pop_style_var(3)
    return begun


def end() -> None:
    """End a plot that `begin` began."""
    implot.end_plot()
    implot.pop_style_var(3)


def axes(
    x: tuple[str, float, float],
    y: tuple[str, float, float],
    *,
    follow: bool = False,
    decorated: bool = True,
) -> bool:
    """Labels with units and limits; `follow` sets limits that change with the data.

    Returns whether there is no room for the labels, so that `label_inside` has to put it shorter.
    """
    cond = implot.Cond_.always if follow else implot.Cond_.once
    flags = implot.AxisFlags_.no_highlight | implot.AxisFlags_.no_side_switch
    flags |= implot.AxisFlags_.no_initial_fit
    if not decorated:
        flags |= implot.AxisFlags_.no_decorations
    inside = decorated and _low
    for axis, (text, low, high) in ((implot.ImAxis_.x1, x), (implot.ImAxis_.y1, y)):
        implot.setup_axis(axis, None if inside else text, flags)
        implot.setup_axis_limits(axis, low, high, cond)
    return inside


def label_inside(text: str) -> None:
    """The quantity of a low plot, in its corner."""
    at, gap = implot.get_plot_pos(), em(0.2)
    size = imgui.calc_text_size(text)
    low = ImVec2(at.x + gap, at.y + gap)
    draw = implot.get_plot_draw_list()
    high = ImVec2(low.x + size.x + 2.0 * gap, low.y + size.y)
    draw.add_rect_filled(low, high, imgui.get_color_u32(gray(PANEL, 0.8)))
    draw.add_text(ImVec2(low.x + gap, low.y), imgui.get_color_u32(gray(QUIET)), text)


def lightness_ticks(axis: int) -> None:
    """Ticks of an L* axis: up to 100, as many as have room."""
    values = [0.0, 50.0, 100.0] if _low else [0.0, 20.0, 40.0, 60.0, 80.0, 100.0]
    implot.setup_axis_ticks(axis, values, [f"{v:g}" for v in values])


@dataclass(frozen=True)
class Curve:
    """A curve to draw: see `line`."""

    title: str
    x: Array
    y: Array
    colour: ImVec4
    weight: float = 1.6
    faint: bool = False

    def draw(self) -> None:
        """Draw it into the plot that was begun."""
        line(self.title, self.x, self.y, self.colour, weight=self.weight, faint=self.faint)


def line(
    title: str, x: Array, y: Array, colour: ImVec4, *, weight: float = 1.6, faint: bool = False
) -> None:
    """A curve; NaN leaves a gap. `weight` in pixels at the ordinary size of the font."""
    chosen = OTHER if faint else colour
    width = (1.0 if faint else weight) * em(1.0) / 15.0
    spec = implot.Spec(line_color=chosen, line_weight=width)
    implot.plot_line(f"{title}##{'faint' if faint else 'bold'}", _floats(x), _floats(y), spec)


def points(title: str, x: Array, y: Array) -> None:
    """Measured points: hollow circles that let the curve be seen."""
    spec = implot.Spec(
        marker=implot.Marker_.circle,
        marker_size=(0.12 if _low else 0.2) * em(1.0),
        marker_line_color=POINTS,
        marker_fill_color=gray(0.0, 0.0),
        line_weight=em(1.0) / 15.0,
    )
    implot.plot_scatter(title, _floats(x), _floats(y), spec)


def level(title: str, value: float, *, across: bool = True) -> None:
    """A thin line across the plot at a value of y, or up at a value of x."""
    flags = implot.InfLinesFlags_.horizontal if across else implot.InfLinesFlags_.none
    spec = implot.Spec(line_color=LIMIT, line_weight=em(1.0) / 15.0, flags=flags)
    implot.plot_inf_lines(f"##{title}", np.array([value]), spec)


def nice_ceiling(value: float) -> float:
    """The next of 1, 2, 5 times a power of ten, with a little room above the value."""
    if not value > 0.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(1.05 * value))
    return next(f * power for f in (1.0, 2.0, 5.0, 10.0) if f * power >= 1.05 * value * 0.999999)


def _floats(values: Array) -> Array:
    return np.ascontiguousarray(values, dtype=np.float64)
