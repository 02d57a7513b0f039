"""The menu Help: the first steps, the overview of keys and mouse, and where the manual is."""

from __future__ import annotations

import math
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.resources import data_root
from relgloss_view.viewer.panels import floating
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.actions import ACTIONS, FIRST_STEPS, KEYS, MANUAL, MOUSE
from relgloss_view.viewer.shell.navigation import KEYBOARD
from relgloss_view.viewer.shell.theme import em

if TYPE_CHECKING:
    from relgloss_view.viewer.shell.app import App

GAP_EM = 1.0  #: between a key and its action
COLUMN_GAP_EM = 2.0
MOST_COLUMNS = 3
WIDTHS_EM = {FIRST_STEPS: 34.0, MANUAL: 34.0}
PAGE = "window.md"

#: Sections of the overview: by menus, and those whose keys have long names.
MENU_SECTIONS = ("File", "Edit", "View", "Help", "Other keys")
LONG_SECTIONS = ("Keyboard alone", "Mouse")
#: A key or a gesture, its effect, and more words for a tooltip.
Row = tuple[str, str, str]

STEPS = (
    (
        "Choose the sample",
        'Take a paper in the panel "Sample", or drop a file with your measurement on the window. '
        "The file is fitted while you continue. It becomes the test picture on the right.",
    ),
    (
        "Set the gloss",
        'The panel "Look" makes the highlight stronger or weaker (contrast gloss) and the surface '
        'rougher (graininess). The panel "Gloss" shows what a gloss meter would read.',
    ),
    (
        "Set the light",
        "Drag in a picture to turn the object, and hold Ctrl while you drag to move the lamp. The "
        'panel "Scene" has both as numbers.',
    ),
    (
        "Compare",
        "The reference on the left stays as it is. Judge the test beside it. The keys 1 to 4 put "
        "the pictures side by side, one over the other, or show their difference.",
    ),
    ("Keep the result", "Ctrl+S saves the pair, and Ctrl+E saves the pictures."),
)


def show(app: App) -> None:
    """Draw the window that is asked for, if any."""
    title = app.help_window
    if not title:
        return
    draw, width_em = _CONTENTS[title], WIDTHS_EM.get(title, 0.0)
    rows = _sections()
    if title == KEYS:
        width_em = _columns(rows) * _column_width(rows) / em(1.0) + 2.0
    opened, stays = floating.begin(title, width_em)
    if opened:
        draw(app)
        stays = stays and not floating.escaped()
    imgui.end()
    if not stays and app.help_window == title:
        app.help_window = ""


# --- keys and mouse -------------------------------------------------------------------------------


def _sections() -> list[tuple[str, list[Row]]]:
    """The rows by the menus they are in; then what the focus and the mouse do."""
    by_menu: dict[str, list[Row]] = {}
    for action in ACTIONS:
        if action.key:
            row = (action.key, action.text, action.help)
            by_menu.setdefault(action.menu or MENU_SECTIONS[-1], []).append(row)
    sections = [(name, by_menu[name]) for name in MENU_SECTIONS]
    keyboard = [(keys, effect, "") for keys, effect in KEYBOARD]
    mouse = [(gesture, effect, "") for gesture, effect in MOUSE]
    return [*sections, *zip(LONG_SECTIONS, (keyboard, mouse), strict=True)]


def _key_widths(sections: list[tuple[str, list[Row]]]) -> dict[str, float]:
    """Width of the keys by section, pixels: one for the menus, one for the longer ones after."""
    widths: dict[str, float] = {}
    for names in (MENU_SECTIONS, LONG_SECTIONS):
        group = [rows for name, rows in sections if name in names]
        widest = max(imgui.calc_text_size(keys).x for rows in group for keys, _, _ in rows)
        widths |= dict.fromkeys(names, float(widest))
    return widths


def _column_width(sections: list[tuple[str, list[Row]]]) -> float:
    """Of the widest row with the gap behind it, pixels."""
    widths = _key_widths(sections)
    widest = max(
        widths[name] + imgui.calc_text_size(effect).x
        for name, rows in sections
        for _, effect, _ in rows
    )
    return float(widest + em(GAP_EM + COLUMN_GAP_EM))


def _columns(sections: list[tuple[str, list[Row]]]) -> int:
    """How many columns the program's window has room for."""
    room = floating.WIDEST * imgui.get_main_viewport().size.x - em(2.0)
    return int(min(max(room // _column_width(sections), 1), MOST_COLUMNS))


def _keys(_: App) -> None:
    sections = _sections()
    count = _columns(sections)
    # A section is as high as its rows and its heading.
    each = math.ceil(sum(len(rows) + 1.5 for _, rows in sections) / count)
    if not imgui.begin_table("keys", count, imgui.TableFlags_.sizing_stretch_same):
        return
    imgui.table_next_column()
    filled, column, widths = 0.0, 1, _key_widths(sections)
    for name, rows in sections:
        if filled and filled + 0.5 * len(rows) > each and column < count:
            imgui.table_next_column()
            filled, column = 0.0, column + 1
        filled += len(rows) + 1.5
        imgui.separator_text(name)
        _rows(rows, widths[name] + em(GAP_EM))
    imgui.end_table()


def _rows(rows: list[Row], indent: float) -> None:
    effects = imgui.get_cursor_pos_x() + indent
    for keys, effect, more in rows:
        imgui.text_unformatted(keys)
        imgui.same_line()
        imgui.set_cursor_pos_x(effects)
        widgets.wrapped(effect, dim=True)
        if more:
            widgets.tooltip(widgets.sentence(more))


# --- first steps ----------------------------------------------------------------------------------


def _steps(app: App) -> None:
    widgets.wrapped(
        "relgloss shows two pictures of printed paper side by side. You tune the gloss of the test "
        "until it is right beside the reference."
    )
    for number, (title, text) in enumerate(STEPS, 1):
        imgui.separator_text(f"{number}. {title}")
        widgets.wrapped(text, dim=True)
    imgui.spacing()
    if widgets.button(KEYS, "shows what every key does"):
        app.help_window = KEYS
    imgui.same_line()
    if widgets.button(MANUAL, "shows where the whole manual is"):
        app.help_window = MANUAL


# --- the manual -----------------------------------------------------------------------------------


def manual() -> Path | None:
    """The page of the manual on this window, beside which the others are; None without one."""
    try:
        page = data_root() / "docs" / PAGE
    except InputError:
        return None
    return page if page.is_file() else None


def _manual(app: App) -> None:
    page = manual()
    if page is None:
        widgets.wrapped("The manual is missing. Install relgloss-view again.")
        return
    widgets.wrapped(
        "The manual is a folder of text files (Markdown). README.md lists them; window.md is about "
        "this window, first-pair.md leads to a first matched pair."
    )
    widgets.wrapped(printable(str(page.parent), 400), dim=True)
    imgui.spacing()
    opener = _opener()
    if widgets.button(
        "Open", f"opens {PAGE} with the system's own program", enabled=opener is not None
    ):
        assert opener is not None
        try:
            opener(page)
        except OSError as error:
            app.model.report(f"{page}: can't be opened ({error.strerror or error})", fault=True)
    imgui.same_line()
    if widgets.button("Copy the folder's name", "puts the full path on the clipboard"):
        imgui.set_clipboard_text(str(page.parent))
        app.model.report(f"copied: {page.parent}")


def _opener() -> Callable[[Path], object] | None:
    """What opens a file with the system's own program, without waiting for it; None for nothing."""
    if sys.platform == "win32":
        return os.startfile
    name = shutil.which("open" if sys.platform == "darwin" else "xdg-open")
    if name is None:
        return None
    quiet = subprocess.DEVNULL
    return lambda page: subprocess.Popen([name, str(page)], stdout=quiet, stderr=quiet)


_CONTENTS: dict[str, Callable[[App], None]] = {FIRST_STEPS: _steps, KEYS: _keys, MANUAL: _manual}
