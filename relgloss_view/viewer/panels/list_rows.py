"""Rows of a list whose names come from outside: ImGui would end a label at the first ##."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from relgloss_view.viewer.shell.theme import em

LEAST_NAME_EM = 8.0  #: of a name, before the text beside it gives way


def row(
    name: str, text: str, on: bool, *, flags: int = 0, width: float = 0.0, beside: str = ""
) -> bool:
    """A row to click: `##name` is its label, `text` its words; returns whether it was clicked.

    width: in pixels, 0 as wide as the window. `beside` is quiet text at its right end.
    """
    room = width or imgui.get_content_region_avail().x
    clicked, _ = imgui.selectable(f"##{name}", on, flags, ImVec2(width, 0.0))
    # The area that can be clicked reaches half a space beyond the text on each side.
    space = imgui.get_style().item_spacing
    low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    left, top = low.x + 0.5 * space.x, low.y + 0.5 * space.y
    painter = imgui.get_window_draw_list()
    taken = imgui.calc_text_size(beside).x if beside else 0.0
    if beside and room >= taken + em(LEAST_NAME_EM):
        place = ImVec2(high.x - 0.5 * space.x - taken, top)
        painter.add_text(place, imgui.get_color_u32(imgui.Col_.text_disabled), beside)
        room -= taken + em(0.5)
    colour = imgui.get_color_u32(imgui.Col_.text)
    painter.add_text(ImVec2(left, top), colour, fitting(text, room))
    return bool(clicked)


def fitting(text: str, width: float, *, end: bool = False) -> str:
    """The beginning of a text, or its end, as much as a width in pixels holds."""
    if imgui.calc_text_size(text).x <= width:
        return text
    low, high = 0, len(text)  # the longest part that fits, by halves
    while low < high:
        middle = (low + high + 1) // 2
        if imgui.calc_text_size(_part(text, middle, end)).x <= width:
            low = middle
        else:
            high = middle - 1
    return _part(text, low, end)


def both_ends(text: str, width: float) -> str:
    """A text with its middle left out, as much as a width in pixels holds.

    Names of one brand begin alike, and differ at their ends.
    """
    if imgui.calc_text_size(text).x <= width:
        return text
    low, high = 0, len(text)  # the most characters that fit, by halves
    while low < high:
        count = (low + high + 1) // 2
        if imgui.calc_text_size(_ends(text, count)).x <= width:
            low = count
        else:
            high = count - 1
    return _ends(text, low)


def preview(text: str) -> str:
    """The beginning of a text, as much as the combo that comes next holds beside its arrow."""
    room = imgui.calc_item_width() - imgui.get_frame_height()
    return fitting(text, room - 2.0 * imgui.get_style().frame_padding.x)


def small_width(text: str) -> float:
    """Of a small button, in pixels."""
    return float(imgui.calc_text_size(text).x + 2.0 * imgui.get_style().frame_padding.x)


def _ends(text: str, count: int) -> str:
    """The first and the last characters of a text, so many together."""
    last = count // 2
    return f"{text[: count - last].rstrip()}…{text[len(text) - last :].lstrip()}"


def _part(text: str, count: int, end: bool) -> str:
    return "…" + text[len(text) - count :] if end else text[:count] + "…"
