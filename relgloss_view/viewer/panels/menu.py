"""The menu bar: every action of the table, the overlays and the panels."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imgui_bundle import imgui

from relgloss_view.viewer.shell.actions import ACTIONS, Action
from relgloss_view.viewer.shell.widgets import sentence, tooltip
from relgloss_view.viewer.state.layout_file import FONT_SCALES
from relgloss_view.viewer.state.state import OVERLAYS

if TYPE_CHECKING:
    from relgloss_view.viewer.shell.app import App

MENUS = ("File", "Edit", "View", "Help")


def show(app: App) -> float:
    """Draw the bar; returns its height in pixels."""
    if not imgui.begin_main_menu_bar():
        return 0.0
    height = float(imgui.get_window_size().y)
    if app.menu_wanted:
        _enter(MENUS[0])
    for name in MENUS:
        if imgui.begin_menu(name):
            for action in ACTIONS:
                if action.menu == name:
                    _item(app, action)
            if name == "View":
                imgui.separator()
                _overlays(app)
                _panels(app)
                _text_sizes(app)
            imgui.end_menu()
    imgui.end_main_menu_bar()
    return height


def _enter(name: str) -> None:
    """Give the bar the keyboard, with a menu of it; Down opens that."""
    internal = imgui.internal
    window = internal.get_current_window()
    internal.focus_window(window)
    internal.set_nav_id(imgui.get_id(name), internal.NavLayer.menu, 0, internal.ImRect())
    imgui.set_nav_cursor_visible(True)


def _item(app: App, action: Action) -> None:
    on = action.on(app) if action.on is not None else False
    clicked, _ = imgui.menu_item(action.text, action.key, on, action.possible(app))
    tooltip(sentence(action.help), beside=True)
    if clicked:
        action.run(app)


def _overlays(app: App) -> None:
    if imgui.begin_menu("Overlay"):
        present = app.model.state.presentation.overlay
        for name in OVERLAYS:
            if imgui.menu_item(name, "", name == present, True)[0]:
                app.model.set_part("presentation", overlay=name)
        imgui.end_menu()


def _text_sizes(app: App) -> None:
    if imgui.begin_menu("Text size"):
        for scale in FONT_SCALES:
            if imgui.menu_item(f"{100 * scale:.0f} %", "", scale == app.font_scale, True)[0]:
                app.set_font_scale(scale)
        imgui.end_menu()


def _panels(app: App) -> None:
    if imgui.begin_menu("Panels"):
        for panel in app.layout.panels:
            if imgui.menu_item(panel.title, "", panel.visible, True)[0]:
                if panel.visible:
                    panel.visible = False
                else:
                    app.layout.focus(panel.title)
        imgui.end_menu()
