"""File dialogs: the system's own where there is one, a window of the program elsewhere.

The system's dialog is another process on Linux (zenity, kdialog or a relative). The window polls it
and never waits for it. The environment variable RELGLOSS_DIALOG=own chooses the program's own.
"""

from __future__ import annotations

import os
import shutil
import sys
from typing import Any

from relgloss_view.viewer.files.folders import with_suffix
from relgloss_view.viewer.panels.own_dialog import OwnDialog, Question

VARIABLE = "RELGLOSS_DIALOG"
HELPERS = ("zenity", "qarma", "matedialog", "kdialog")
POLL_S = 0.1


class FileDialogs:
    """The dialog that is open, if any, and the folder where the next one begins."""

    def __init__(self) -> None:
        self.folder = _first_folder()
        self._own: OwnDialog | None = None
        self._native: tuple[Question, Any] | None = None

    @property
    def open(self) -> bool:
        """Whether an answer is awaited."""
        return self._own is not None or self._native is not None

    def ask(self, question: Question) -> None:
        """Open a dialog in place of another; one with the same question comes to the front.

        The system's dialog stays until it is answered, and this question is dropped.
        """
        if self._native is not None:
            return
        if self._own is not None and self._own.question.title == question.title:
            self._own.raised = True
            return
        if not os.path.isdir(self.folder):
            self.folder = _first_folder()
        if native_available() and _is_utf8(self.folder + question.name):
            self._native = (question, _native(question, self.folder))
        else:
            self._own = OwnDialog(question, self.folder)

    def show(self) -> None:
        """Draw the program's own dialog and take the answer of either kind."""
        if self._native is not None:
            self._poll()
        elif self._own is not None and not self._own.show():
            dialog, self._own = self._own, None
            self.folder = dialog.folder
            if dialog.answer is not None:
                dialog.question.chosen(dialog.answer)

    def due_s(self) -> float | None:
        """Seconds until the system's dialog has to be asked again."""
        return POLL_S if self._native is not None else None

    def close(self) -> None:
        """Close what is open, without an answer."""
        if self._native is not None:
            self._native[1].kill()
        self._native = self._own = None

    def _poll(self) -> None:
        assert self._native is not None
        question, dialog = self._native
        if not dialog.ready(0):
            return
        self._native = None
        result = dialog.result()
        path = (result[0] if result else "") if isinstance(result, list) else result
        if not path:
            return
        self.folder = os.path.dirname(path)
        final = with_suffix(path, question.suffixes) if question.saving else path
        if final != path and os.path.lexists(final):
            # The system has asked about another name: ask about this one.
            self._own = OwnDialog(question, self.folder, os.path.basename(final))
            self._own.submit()
            return
        question.chosen(final)


def native_available() -> bool:
    """Whether the system's own dialog can be used."""
    if os.environ.get(VARIABLE, "") == "own":
        return False
    if sys.platform.startswith("linux"):
        if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
            return False
        return any(shutil.which(helper) for helper in HELPERS)
    return sys.platform in ("win32", "darwin")


def _is_utf8(path: str) -> bool:
    """Whether the system's dialog takes a path: it has to be UTF-8."""
    try:
        path.encode("utf-8")
    except UnicodeEncodeError:
        return False
    return True


def _first_folder() -> str:
    """The working directory, the home folder if that is gone, or the root without either."""
    try:
        return os.getcwd()
    except OSError:
        home = os.path.expanduser("~")
        return home if os.path.isabs(home) else os.path.abspath(os.sep)


def _native(question: Question, folder: str) -> Any:
    from imgui_bundle import portable_file_dialogs as pfd

    patterns = " ".join(f"*{suffix}" for suffix in question.suffixes)
    filters = ["Files", patterns] if patterns else []
    filters += ["All files", "*"]
    if question.saving:
        return pfd.save_file(question.title, os.path.join(folder, question.name), filters)
    return pfd.open_file(question.title, os.path.join(folder, ""), filters)
