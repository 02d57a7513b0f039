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
WIDTH_EM = 62.0
KEY_EM, MOUSE_EM = 7.5, 12.5  #: widths of the columns that name keys


def show(app: App) -> None:
    """Draw the overview, if it is asked for."""
    if not app.helping:
        return
    opened, stays = floating.begin(TITLE, WIDTH_EM)
    if opened:
        keys = [(a.key, f"{a.text}: {a.help}") for a in ACTIONS if a.key]
        beside = imgui.get_content_region_avail().x >= em(0.98 * WIDTH_EM - 2.0)
        if beside and imgui.begin_table("keys", 2, imgui.TableFlags_.sizing_fixed_fit):
            imgui.table_next_column()
            _list(keys, KEY_EM)
            imgui.table_next_column()
            _list(list(MOUSE), MOUSE_EM)
            imgui.end_table()
        elif not beside:
            _list(list(MOUSE), MOUSE_EM)
            imgui.separator()
            _list(keys, KEY_EM)
    imgui.end()
    app.helping = bool(stays)


def _list(entries: list[tuple[str, str]], width_em: float) -> None:
    for key, text in entries:
        imgui.text_unformatted(key)
        imgui.same_line(em(width_em))
        imgui.text_disabled(text)
