"""The window that writes pictures to files."""

from __future__ import annotations

from imgui_bundle import imgui

from relgloss_view.viewer.model import Model
from relgloss_view.viewer.panels.dialog import FileDialogs

TITLE = "Export"


class Export:
    """Which picture, which format, where to."""

    def __init__(self, model: Model, dialogs: FileDialogs) -> None:
        self.model = model
        self.dialogs = dialogs
        self._open = False

    def open(self) -> None:
        """Show the window."""
        self._open = True

    def due_s(self) -> float | None:
        """Seconds until a frame is needed."""
        return None

    def show(self) -> None:
        """Draw the window, if it is open."""
        if not self._open:
            return
        opened, stays = imgui.begin(TITLE, True, imgui.WindowFlags_.no_saved_settings)
        if opened:
            imgui.text_unformatted("to come")
        imgui.end()
        self._open = bool(stays)
