"""The overview of keys and mouse, over the pictures until a key or a click closes it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imgui_bundle import imgui

from relgloss_view.viewer.panels import floating
from relgloss_view.viewer.shell.actions import ACTIONS, MOUSE
from relgloss_view.viewer.shell.theme import em

if TYPE_CHECKING:
    from relgloss_view.viewer.shell.app import App

TITLE = "Keys and mouse"
WIDTH_EM = 68.0
#: Widths of the columns: keys, their actions, and what the mouse does where.
KEY_EM, ACTION_EM, MOUSE_EM = 6.5, 11.0, 11.5


def show(app: App) -> None:
    """Draw the overview, if it is asked for."""
    if not app.helping:
        return
    opened, stays = floating.begin(TITLE, WIDTH_EM)
    if opened:
        beside = imgui.get_content_region_avail().x >= em(0.98 * WIDTH_EM - 2.0)
        if beside and imgui.begin_table("keys", 2, imgui.TableFlags_.sizing_fixed_fit):
            imgui.table_next_column()
            _keys()
            imgui.table_next_column()
            _mouse()
            imgui.end_table()
        elif not beside:
            _mouse()
            imgui.separator()
            _keys()
    imgui.end()
    app.helping = bool(stays)


def _keys() -> None:
    for action in ACTIONS:
        if action.key:
            imgui.text_unformatted(action.key)
            imgui.same_line(em(KEY_EM))
            imgui.text_unformatted(action.text)
            imgui.same_line(em(KEY_EM + ACTION_EM))
            imgui.text_disabled(action.help)


def _mouse() -> None:
    for gesture, effect in MOUSE:
        imgui.text_unformatted(gesture)
        imgui.same_line(em(MOUSE_EM))
        imgui.text_disabled(effect)
