"""Colours and metrics of the window: neutral grays only, so that nothing tints the judgement.

In the spirit of ISO 3664:2009 and ISO 12646:2015: the surround of the pictures is a neutral gray,
the interface is darker and neutral too. Sizes are in em: a larger font scales everything.
"""

from __future__ import annotations

from imgui_bundle import ImVec2, ImVec4, hello_imgui, imgui, implot

from relgloss_view.base.arrays import Rgb
from relgloss_view.base.fonts import font_files

FONT_PX = 15.0
FONT = "fonts/Roboto/Roboto-Regular.ttf"  #: among the assets of imgui_bundle
FONT_HEIGHT_EM = 1.1719  #: of it, ascender to descender

# Grays, sRGB values 0..1. Text on a panel has a contrast of 11:1, quiet text 5.5:1; WCAG 2 asks
# for 4.5.
PANEL = 0.155
POPUP = 0.125
FRAME = 0.245
FRAME_HOVERED = 0.30
FRAME_ACTIVE = 0.36
GRAB = 0.43
TEXT = 0.87
QUIET = 0.62
LINE = 0.30

#: Curves of a plot, which differ in lightness first and in a trace of hue second.
CURVES = (
    ImVec4(0.93, 0.93, 0.93, 1.0),
    ImVec4(0.66, 0.74, 0.82, 1.0),
    ImVec4(0.82, 0.72, 0.62, 1.0),
    ImVec4(0.52, 0.62, 0.54, 1.0),
    ImVec4(0.66, 0.58, 0.68, 1.0),
)


def gray(value: float, alpha: float = 1.0) -> ImVec4:
    """A neutral colour."""
    return ImVec4(value, value, value, alpha)


def coloured(digital: Rgb, alpha: float = 1.0) -> ImVec4:
    """A colour of three digital values."""
    return ImVec4(*digital, alpha)


def em(count: float) -> float:
    """A length in pixels: so many times the size of the font."""
    return count * imgui.get_font_size()


def load_fonts() -> None:
    """Give ImGui its font, and behind it those for letters that it lacks.

    Glyphs are drawn when they are first needed. ImGui scales a font so that its lines have one
    height; fonts with higher lines than the first are enlarged, so that their letters are as large.
    Raises InputError where RELGLOSS_FONTS names a file that is no font.
    """
    hello_imgui.load_font(FONT, FONT_PX)
    for file in font_files():
        config = imgui.ImFontConfig()
        config.merge_mode = True
        config.font_no = file.index
        config.extra_size_scale = file.height_em / FONT_HEIGHT_EM
        imgui.get_io().fonts.add_font_from_file_ttf(file.path, FONT_PX, config)


def apply(scale: float = 1.0) -> None:
    """Set colours and spacing of ImGui and ImPlot, for text of so many times FONT_PX."""
    style = imgui.get_style()
    c = imgui.Col_
    for name, value in _COLOURS.items():
        style.set_color_(getattr(c, name), value)
    unit = scale * FONT_PX / 15.0
    style.window_padding = ImVec2(10 * unit, 8 * unit)
    style.frame_padding = ImVec2(6 * unit, 3 * unit)
    style.item_spacing = ImVec2(8 * unit, 5 * unit)
    style.item_inner_spacing = ImVec2(6 * unit, 4 * unit)
    style.cell_padding = ImVec2(5 * unit, 2 * unit)
    style.scrollbar_size = 11 * unit
    style.grab_min_size = 9 * unit
    for name in ("window", "frame", "grab", "popup", "tab", "scrollbar"):
        setattr(style, f"{name}_rounding", 3.0)
    style.window_rounding = 0.0
    style.window_border_size = 0.0
    style.popup_border_size = 1.0
    style.docking_separator_size = 2.0 * unit
    style.tab_bar_overline_size = 0.0
    style.separator_text_padding = ImVec2(0.0, 4.0 * unit)
    style.separator_text_border_size = 1.0
    plot = implot.get_style()
    p = implot.Col_
    for key, value in (
        (p.plot_bg, gray(0.0, 0.0)),
        (p.frame_bg, gray(0.0, 0.0)),
        (p.plot_border, gray(LINE)),
        (p.axis_grid, gray(1.0, 0.10)),
        (p.axis_text, gray(QUIET)),
        (p.legend_bg, gray(POPUP, 0.85)),
        (p.legend_border, gray(LINE)),
        (p.legend_text, gray(TEXT)),
        (p.title_text, gray(TEXT)),
        (p.inlay_text, gray(TEXT)),
        (p.crosshairs, gray(TEXT)),
        (p.selection, gray(TEXT)),
    ):
        plot.set_color_(key, value)
    plot.plot_padding = ImVec2(6 * unit, 6 * unit)


_COLOURS = {
    "text": gray(TEXT),
    "text_disabled": gray(QUIET),
    "window_bg": gray(PANEL),
    "child_bg": gray(PANEL, 0.0),
    "popup_bg": gray(POPUP),
    "border": gray(LINE),
    "frame_bg": gray(FRAME),
    "frame_bg_hovered": gray(FRAME_HOVERED),
    "frame_bg_active": gray(FRAME_ACTIVE),
    "title_bg": gray(POPUP),
    "title_bg_active": gray(POPUP),
    "title_bg_collapsed": gray(POPUP),
    "menu_bar_bg": gray(POPUP),
    "scrollbar_bg": gray(PANEL, 0.0),
    "scrollbar_grab": gray(FRAME),
    "scrollbar_grab_hovered": gray(FRAME_HOVERED),
    "scrollbar_grab_active": gray(FRAME_ACTIVE),
    "check_mark": gray(TEXT),
    "checkbox_selected_bg": gray(FRAME),
    "slider_grab": gray(GRAB),
    "slider_grab_active": gray(0.52),
    "button": gray(FRAME),
    "button_hovered": gray(FRAME_HOVERED),
    "button_active": gray(FRAME_ACTIVE),
    "header": gray(FRAME),
    "header_hovered": gray(FRAME_HOVERED),
    "header_active": gray(FRAME_ACTIVE),
    "separator": gray(LINE),
    "separator_hovered": gray(FRAME_ACTIVE),
    "separator_active": gray(GRAB),
    "resize_grip": gray(FRAME, 0.0),
    "resize_grip_hovered": gray(FRAME_ACTIVE),
    "resize_grip_active": gray(GRAB),
    "tab": gray(POPUP),
    "tab_hovered": gray(FRAME_HOVERED),
    "tab_selected": gray(PANEL),
    "tab_selected_overline": gray(PANEL),
    "tab_dimmed": gray(POPUP),
    "tab_dimmed_selected": gray(PANEL),
    "tab_dimmed_selected_overline": gray(PANEL),
    "docking_preview": gray(GRAB, 0.5),
    "docking_empty_bg": gray(PANEL, 0.0),
    "plot_lines": gray(TEXT),
    "plot_histogram": gray(GRAB),
    "plot_histogram_hovered": gray(TEXT),
    "table_header_bg": gray(FRAME, 0.5),
    "table_border_strong": gray(LINE),
    "table_border_light": gray(LINE, 0.5),
    "table_row_bg_alt": gray(1.0, 0.03),
    "text_selected_bg": gray(GRAB, 0.5),
    "text_link": gray(TEXT),
    "drag_drop_target": gray(TEXT),
    "nav_cursor": gray(1.0),
    "modal_window_dim_bg": gray(0.0, 0.45),
}
