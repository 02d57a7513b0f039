"""The overview of keys and mouse, over the pictures until a key or a click closes it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imgui_bundle import imgui

from relgloss_view.viewer.actions import ACTIONS, MOUSE
from relgloss_view.viewer.panels import floating
from relgloss_view.viewer.theme import em

if TYPE_CHECKING:
    from relgloss_view.viewer.app import App

TITLE = "Keys and mouse"
WIDTH_EM = 62.0


def show(app: App) -> None:
    """Draw the overview, if it is asked for."""
    if not app.helping:
        return
    opened, stays = floating.begin(TITLE, WIDTH_EM)
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
