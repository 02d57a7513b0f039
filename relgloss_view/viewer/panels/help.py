"""The overview of keys and mouse, over the pictures until a key or a click closes it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imgui_bundle import ImVec2, imgui

from relgloss_view.viewer.actions import ACTIONS, MOUSE
from relgloss_view.viewer.theme import em

if TYPE_CHECKING:
    from relgloss_view.viewer.app import App

TITLE = "Keys and mouse"


def show(app: App) -> None:
    """Draw the overview, if it is asked for."""
    if not app.helping:
        return
    viewport = imgui.get_main_viewport()
    centre = ImVec2(viewport.pos.x + 0.5 * viewport.size.x, viewport.pos.y + 0.5 * viewport.size.y)
    imgui.set_next_window_pos(centre, imgui.Cond_.always, ImVec2(0.5, 0.5))
    imgui.set_next_window_size_constraints(
        ImVec2(em(10), em(5)), ImVec2(0.96 * viewport.size.x, 0.9 * viewport.size.y)
    )
    flags = imgui.WindowFlags_
    opened, stays = imgui.begin(
        TITLE,
        True,
        flags.no_docking | flags.no_collapse | flags.no_saved_settings | flags.always_auto_resize,
    )
    if opened and imgui.begin_table("keys", 2, imgui.TableFlags_.sizing_fixed_fit):
        half = [(a.key, f"{a.text}: {a.help}") for a in ACTIONS if a.key]
        for column in (half, list(MOUSE)):
            imgui.table_next_column()
            for key, text in column:
                imgui.text_unformatted(key)
                imgui.same_line(em(7.5 if column is half else 12.5))
                imgui.text_disabled(text)
        imgui.end_table()
    imgui.end()
    app.helping = bool(stays)
