"""The program's own file dialog: a window with a folder's files, a name, one line for a fault."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.viewer.files.folders import (
    Entry,
    Listing,
    NameField,
    check_file,
    check_place,
    listing,
    meant,
    shortened,
    with_suffix,
)
from relgloss_view.viewer.panels import floating
from relgloss_view.viewer.panels.list_rows import fitting, row
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import em

LONGEST_SHOWN = 120  #: characters of a name in the list

Key = imgui.Key


@dataclass(frozen=True)
class Question:
    """The dialog's title, the kinds of file, and the use of the answer."""

    title: str
    chosen: Callable[[str], object]
    suffixes: tuple[str, ...] = ()  #: those listed at first; the first is added to a name without
    saving: bool = False
    name: str = ""  #: suggested


class OwnDialog:
    """A window with a folder's files, a field for a name, and one line for a fault."""

    def __init__(self, question: Question, folder: str, name: str = "") -> None:
        self.question = question
        self.folder = folder
        self.name = NameField(name or question.name)
        self.answer: str | None = None
        self.raised = False  #: whether it comes to the front in the next frame
        self._kept = self.name.value  #: for the field, once a folder is open
        self._on_folder = False  #: whether it holds the name of a folder that was clicked
        self._fault = ""
        self._replacing: str | None = None  #: a file that is there and may be replaced
        self._all = False  #: files of every kind
        self._hidden = False
        self._listed: tuple[object, Listing] | None = None
        self._selected = -1
        self._scroll = False
        self._focus = 2  # frames in which the field takes the keyboard
        self._ended = False

    def show(self) -> bool:
        """Draw it; returns whether it stays open."""
        title = self.question.title
        opened, stays = floating.begin(title, 38.0, 28.0, raised=self.raised)
        self.raised = False
        if opened:
            self._where()
            self._files()
            self._field()
            self._buttons()
            self._keys()
        imgui.end()
        return stays and not self._ended

    def submit(self) -> None:
        """Take the field's text as the answer, if it can be one."""
        self._fault, self._replacing = "", None
        path = meant(self.folder, self.name.value)
        try:
            answer = self._checked(path)
        except InputError as error:
            self._fault = shortened(str(error), path)
            return
        if answer is not None:
            self._end(answer)

    def _checked(self, path: str) -> str | None:
        if not self.name.value:
            raise InputError("type a name, or choose a file from the list")
        if os.path.isdir(path):
            self._enter(path)
            return None
        if not self.question.saving:
            check_file(path)
            self.folder = os.path.dirname(path)
            return path
        path = with_suffix(path, self.question.suffixes)
        if check_place(path):
            self._replacing = path
            return None
        self.folder = os.path.dirname(path)
        return path

    def _end(self, path: str | None) -> None:
        self.answer = path
        self._ended = True

    def _enter(self, folder: str) -> None:
        """Go into a folder, unless it can't be read."""
        try:
            listing(folder, self._suffixes(), hidden=self._hidden)
        except InputError as error:
            self._fault = shortened(str(error), folder)
            return
        self.folder, self._fault, self._replacing = folder, "", None
        self._selected, self._on_folder = -1, False
        self._put(self._kept if self.question.saving else "")

    def _go(self, folder: str) -> None:
        """Go into a folder by a button; a name for the new file stays."""
        if not self._on_folder:
            self._kept = self.name.value
        self._enter(folder)

    def _put(self, name: str) -> None:
        """Put a name into the field, even while it is being typed in."""
        self.name.put(name)
        imgui.internal.clear_active_id()
        self._focus = 2

    def _suffixes(self) -> tuple[str, ...]:
        return () if self._all else self.question.suffixes

    def _list(self) -> Listing:
        """The folder's entries, read again when anything about them is new."""
        try:
            changed = os.stat(self.folder).st_mtime_ns
        except OSError:
            changed = 0
        key = (self.folder, self._all, self._hidden, changed)
        if self._listed is None or self._listed[0] != key:
            try:
                entries = listing(self.folder, self._suffixes(), hidden=self._hidden)
            except InputError as error:
                entries = Listing(())
                self._fault = shortened(str(error), self.folder)
            self._listed = (key, entries)
            self._selected = -1
        return self._listed[1]

    def _where(self) -> None:
        if widgets.button("Up", "opens the folder above"):
            self._go(os.path.dirname(self.folder))
        imgui.same_line()
        if widgets.button("Home", "opens your home folder"):
            self._go(os.path.expanduser("~"))
        imgui.same_line()
        imgui.align_text_to_frame_padding()
        room = imgui.get_content_region_avail().x
        widgets.quiet(fitting(printable(self.folder, 1000), room, end=True))
        widgets.tooltip(printable(self.folder, 1000))

    def _files(self) -> None:
        listed = self._list()
        below = 3.0 * imgui.get_frame_height_with_spacing() + floating.text_height(self._message())
        height = imgui.get_content_region_avail().y - below
        flags = imgui.ChildFlags_.borders | imgui.ChildFlags_.nav_flattened
        imgui.begin_child("files", ImVec2(0.0, max(height, em(3.0))), flags)
        clipper = imgui.ListClipper()
        clipper.begin(len(listed.entries))
        if self._scroll and self._selected >= 0:
            clipper.include_item_by_index(self._selected)
        while clipper.step():
            for k in range(clipper.display_start, clipper.display_end):
                self._entry(k, listed.entries[k])
        if not listed.entries:
            imgui.text_disabled("Nothing to show here.")
        if listed.cut:
            imgui.text_disabled(f"Only the first {len(listed.entries)} are listed.")
        self._scroll = False
        imgui.end_child()

    def _entry(self, k: int, entry: Entry) -> None:
        text = printable(entry.name, LONGEST_SHOWN) + ("/" if entry.is_folder else "")
        flags = imgui.SelectableFlags_.allow_double_click
        imgui.push_id(k)
        clicked = row(text, text, k == self._selected, flags=flags)
        imgui.pop_id()
        if self._scroll and k == self._selected:
            imgui.set_scroll_here_y()
        if clicked:
            self._select(k, entry)
            if imgui.is_mouse_double_clicked(imgui.MouseButton_.left):
                self.submit()

    def _select(self, k: int, entry: Entry) -> None:
        if not entry.is_folder:
            self._kept = entry.name
        elif not self._on_folder:
            self._kept = self.name.value
        self._on_folder = entry.is_folder
        self._selected, self._fault, self._replacing = k, "", None
        self._put(entry.name)

    def _field(self) -> None:
        if self._focus:
            imgui.set_keyboard_focus_here()
            self._focus -= 1
        imgui.set_next_item_width(-1.0)
        flags = imgui.InputTextFlags_
        entered, text = imgui.input_text_with_hint(
            "##name",
            "name of the file, or a full path",
            self.name.text,
            flags.enter_returns_true | flags.auto_select_all | flags.elide_left,
        )
        if text != self.name.text:  # the message was about another name
            self.name.text, self._fault, self._replacing = text, "", None
            self._on_folder = False
        if entered:
            self.submit()

    def _message(self) -> str:
        if self._replacing is not None:
            name = printable(os.path.basename(self._replacing), 80)
            return f"{name} is already there. Replace it?"
        return f"! {self._fault}" if self._fault else ""

    def _buttons(self) -> None:
        if self.question.suffixes:
            words = ", ".join(suffix.lstrip(".") for suffix in self.question.suffixes)
            if widgets.checkbox("All files", self._all, f"lists every file, not only {words}"):
                self._all = not self._all
            imgui.same_line()
        if widgets.checkbox("Hidden", self._hidden, "lists names that begin with a dot, too"):
            self._hidden = not self._hidden
        if self.question.suffixes and not self._all:
            imgui.same_line()
            kinds = f"Listed: {', '.join(self.question.suffixes)}"
            widgets.quiet(fitting(kinds, imgui.get_content_region_avail().x))
        message = self._message()
        if message:
            widgets.wrapped(message)
        width = em(7.0)
        if self._replacing is not None:
            if widgets.button("Replace", "writes over the file that is there", width=width):
                self.folder = os.path.dirname(self._replacing)
                self._end(self._replacing)
            imgui.same_line()
            if widgets.button("Keep it", "leaves the file that is there as it is", width=width):
                self._replacing = None
                self._focus = 2
            return
        if widgets.button(
            "Save" if self.question.saving else "Open",
            "takes the file that is named above",
            width=width,
        ):
            self.submit()
        imgui.same_line()
        if widgets.button("Cancel", "closes without choosing", width=width):
            self._end(None)

    def _keys(self) -> None:
        if not imgui.is_window_focused(imgui.FocusedFlags_.root_and_child_windows):
            return
        if floating.escaped():
            self._end(None)
        step = int(imgui.is_key_pressed(Key.down_arrow)) - int(imgui.is_key_pressed(Key.up_arrow))
        entries = self._list().entries
        if step and entries:
            k = min(max(self._selected + step, 0), len(entries) - 1)
            self._select(k, entries[k])
            self._scroll = True
