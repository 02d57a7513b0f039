"""The keyboard in place of the mouse: the focus within panels, between them, and in the menu.

Tab and arrows carry the focus within a panel: that is ImGui's own navigation. F6 carries it from
one panel to the next, Alt or F10 opens the menu.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from imgui_bundle import imgui

from relgloss_view.viewer.shell.layout import STAGE

if TYPE_CHECKING:
    from relgloss_view.viewer.shell.app import App

internal = imgui.internal
#: How the keyboard is used in panels, for the overview.
KEYBOARD = (
    ("Tab, Shift+Tab", "next or previous control"),
    ("Left, Right", "move the slider; Shift fast, Ctrl fine"),
    ("Enter", "press, open, type a value"),
    ("Delete", "reset the slider"),
    ("Esc", "close, cancel"),
    ("Alt or F10", "open the menu"),
    ("Arrows in the pictures", "turn the object"),
    ("Shift+arrows there", "move the picture"),
    ("Ctrl+arrows there", "move the lamp"),
    ("+ and - there", "zoom"),
)
_ALT = (imgui.Key.left_alt, imgui.Key.right_alt)


def enable() -> None:
    """Let the keyboard carry the focus, and show it while it does."""
    io = imgui.get_io()
    io.config_flags |= int(imgui.ConfigFlags_.nav_enable_keyboard)


class AltKey:
    """Notices that Alt is pressed and let go with nothing else between, as to open a menu."""

    def __init__(self) -> None:
        self._alone = False

    def tapped(self) -> bool:
        """Whether Alt was tapped; call it in every frame."""
        io = imgui.get_io()
        # ImGui's own use of Alt is another one: it goes to the tabs of a panel.
        internal.set_key_owner(imgui.Key.mod_alt, imgui.get_id("menu by Alt"))
        if any(imgui.is_key_pressed(key, False) for key in _ALT):
            self._alone = True
        other = io.key_ctrl or io.key_shift or io.key_super or io.mouse_wheel != 0.0
        other = other or any(imgui.is_mouse_down(button) for button in range(3))
        if self._alone and (other or _another_key()):
            self._alone = False
        if self._alone and not io.key_alt:
            self._alone = False
            return any(imgui.is_key_released(key) for key in _ALT)
        return False


def _another_key() -> bool:
    """Whether a key other than Alt was pressed in this frame."""
    io = imgui.get_io()
    if io.app_focus_lost:  # as by Alt+Tab, of which this window sees no Tab
        return True
    first, last = int(imgui.Key.tab), int(imgui.Key.oem102)
    modifiers = range(int(imgui.Key.left_ctrl), int(imgui.Key.right_super) + 1)
    return any(
        imgui.is_key_pressed(imgui.Key(key), False)
        for key in range(first, last + 1)
        if key not in modifiers
    )


def focused_window() -> str:
    """The panel or floating window that has the focus; empty for none."""
    window = imgui.get_current_context().nav_window
    if window is None:
        return ""
    root = window.root_window
    return str((window if root is None else root).name)


def next_panel(app: App, step: int) -> None:
    """Carry the focus to the next panel that shows, or by -1 to the previous one."""
    titles = [STAGE]
    if not app.layout.hidden:
        titles += [panel.title for panel in app.layout.panels if panel.visible]
    here = focused_window()
    k = titles.index(here) + step if here in titles else min(step, 0)
    app.layout.enter(titles[k % len(titles)])


def typing() -> bool:
    """Whether keys belong to what is edited: a text, a slider, a list or menu that is open."""
    popups = imgui.PopupFlags_.any_popup_id | imgui.PopupFlags_.any_popup_level
    return bool(
        imgui.get_io().want_text_input
        or imgui.is_any_item_active()
        or imgui.is_popup_open("", popups)
    )
