"""Windows over the pictures, for a moment: dialogs, progress, export. One look for all of them."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from relgloss_view.viewer.shell.theme import em

WIDEST, HIGHEST = 0.94, 0.88  #: shares of the program's window


def begin(
    title: str,
    width_em: float,
    height_em: float = 0.0,
    *,
    flags: int = 0,
    top_em: float = 0.0,
    right: bool = False,
    raised: bool = False,
) -> tuple[bool, bool]:
    """Begin a window in the middle, or `top_em` below the upper edge; imgui.end() goes with it.

    `right`: along the right edge of the program's window, so that the pictures can be seen.

    Without a height it is as high as what is in it. `raised` brings it to the front. Returns
    whether to draw into it and whether it was left open.
    """
    viewport = imgui.get_main_viewport()
    limit = ImVec2(WIDEST * viewport.size.x, HIGHEST * viewport.size.y)
    padding = imgui.get_style().scrollbar_size  # a bar must not cover the words where it is needed
    size = ImVec2(min(em(width_em) + padding, limit.x), min(em(height_em), limit.y))
    place, pivot = viewport.get_center(), ImVec2(0.5, 0.5)
    if top_em:
        place, pivot = ImVec2(place.x, viewport.pos.y + em(top_em)), ImVec2(0.5, 0.0)
    if right:
        place, pivot = ImVec2(viewport.pos.x + viewport.size.x, place.y), ImVec2(1.0, pivot.y)
    imgui.set_next_window_pos(place, imgui.Cond_.appearing, pivot)
    if height_em:
        imgui.set_next_window_size(size, imgui.Cond_.appearing)
        imgui.set_next_window_size_constraints(ImVec2(1.0, 1.0), limit)
    else:
        imgui.set_next_window_size_constraints(ImVec2(size.x, 1.0), ImVec2(size.x, limit.y))
        flags |= imgui.WindowFlags_.always_auto_resize
    flags |= (
        imgui.WindowFlags_.no_docking
        | imgui.WindowFlags_.no_collapse
        | imgui.WindowFlags_.no_saved_settings
    )
    if raised:
        imgui.set_next_window_focus()
    imgui.push_style_var(imgui.StyleVar_.window_border_size, 1.0)
    opened, stays = imgui.begin(title, True, flags)
    imgui.pop_style_var()
    _hold_inside(viewport)
    return bool(opened), bool(stays)


def _hold_inside(viewport: imgui.Viewport) -> None:
    """Lift the present window where it has grown beyond the lower edge of the program's."""
    place, size = imgui.get_window_pos(), imgui.get_window_size()
    over = place.y + size.y - (viewport.pos.y + viewport.size.y)
    if over > 0.0 and not imgui.is_mouse_down(imgui.MouseButton_.left):
        imgui.set_window_pos(ImVec2(place.x, max(place.y - over, viewport.pos.y)))


def escaped() -> bool:
    """Whether Escape was pressed while this window has the keyboard."""
    focused = imgui.is_window_focused(imgui.FocusedFlags_.root_and_child_windows)
    return bool(focused and imgui.is_key_pressed(imgui.Key.escape, False))


def text_height(text: str) -> float:
    """Of a text that is wrapped at the window's edge, with the space below it, in pixels."""
    if not text:
        return 0.0
    room = imgui.get_content_region_avail().x
    size = imgui.calc_text_size(text, wrap_width=room)
    return float(size.y + imgui.get_style().item_spacing.y)
