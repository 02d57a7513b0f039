"""The window that writes pictures to files: which, in which format, how large, where to."""

from __future__ import annotations

import os

from imgui_bundle import imgui

from relgloss_view.base.errors import InputError, RelglossError
from relgloss_view.base.reading import printable
from relgloss_view.picture.model.view import MAX_SIDE_PX, Size, check_size
from relgloss_view.viewer.files.exporting import (
    BOTH,
    EXR,
    FORMATS,
    PICTURES,
    PNG8,
    Order,
    obstacle,
    suffix_of,
    write,
)
from relgloss_view.viewer.files.folders import NameField, check_place, meant, with_suffix
from relgloss_view.viewer.files.own_materials import safe_name
from relgloss_view.viewer.panels import floating
from relgloss_view.viewer.panels.dialog import FileDialogs
from relgloss_view.viewer.panels.own_dialog import Question
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import DIFFERENCE

TITLE = "Export"
ON_SCREEN, TYPED = "as on the screen", "other"
SETTLING = 2  #: frames that are drawn before the window stands still, so that it says why
STEP_S = 0.03
MOST_FRAMES = 300  #: that pictures are waited for


class Export:
    """What is chosen in the window, and the order that is being carried out."""

    def __init__(self, model: Model, dialogs: FileDialogs) -> None:
        self.model = model
        self.dialogs = dialogs
        self.picture = model.active_side
        self.format = PNG8
        self.sizing = ON_SCREEN
        self.size: Size = (1024, 1024)
        self.name = NameField()
        self._open = self._raised = False
        self._confirmed = ""  #: a file that the dialog has asked about
        self._replacing: Order | None = None
        self._order: Order | None = None
        self._frames = 0  #: since the order was given
        self._told = ""
        self._fault = False

    def open(self) -> None:
        """Show the window, for the active side."""
        if not self._open:
            self.picture, self._told, self._replacing = self.model.active_side, "", None
            self.name.put(self._suggested())
        self._open = self._raised = True

    def due_s(self) -> float | None:
        """Seconds until a frame is needed: soon while an order is carried out."""
        return STEP_S if self._order is not None else None

    def show(self) -> None:
        """Draw the window, if it is open, and carry out what it asked for."""
        if self._order is not None:
            self._carry_out(self._order)
        if not self._open:
            return
        opened, stays = floating.begin(TITLE, 30.0, raised=self._raised)
        self._raised = False
        if opened:
            imgui.begin_disabled(self._order is not None)
            self._what()
            self._where()
            self._contents()
            imgui.end_disabled()
            self._end()
            stays = stays and not floating.escaped()
        imgui.end()
        self._open = self._open and bool(stays)

    def _what(self) -> None:
        told = "One picture, or both side by side as the window shows them: with the gap, mirrored "
        told += "if that is on."
        changed, picture = widgets.combo("picture", PICTURES, self.picture, told)
        if changed:
            untouched = self.name.value == self._suggested()
            self.picture = picture
            if untouched:
                self.name.put(self._suggested())
            self._forget()
        told = "PNG for eyes, with the sRGB profile; OpenEXR for numbers: every stage in floats."
        changed, chosen = widgets.combo("format", FORMATS, self.format, told)
        if changed:
            self.format = chosen
            self.name.put(os.path.splitext(self.name.value)[0] + suffix_of(chosen))
            self._forget()
        if self.model.render_at is None:
            self.sizing = ON_SCREEN
            return
        told = "Of one picture, in pixels."
        changed, self.sizing = widgets.combo("size", (ON_SCREEN, TYPED), self.sizing, told)
        if self.sizing == TYPED:
            widgets.label("")
            _, typed = imgui.input_int2("##pixels", list(self.size))
            self.size = (_bounded(typed[0]), _bounded(typed[1]))
            widgets.tooltip(f"Width and height in pixels, 1 to {MAX_SIDE_PX} each.")

    def _where(self) -> None:
        widgets.label("file")
        choose = imgui.calc_text_size("Choose...").x + 2.0 * imgui.get_style().frame_padding.x
        imgui.set_next_item_width(-choose - imgui.get_style().item_spacing.x)
        flags = imgui.InputTextFlags_
        entered, name = imgui.input_text(
            "##file", self.name.text, flags.enter_returns_true | flags.elide_left
        )
        if name != self.name.text:
            self.name.text = name
            self._forget()
        widgets.tooltip(f"A whole path, or a name in {printable(self.dialogs.folder, 300)}.")
        imgui.same_line()
        if widgets.button("Choose...", "ask for a place"):
            suffixes = (suffix_of(self.format),)
            name = os.path.basename(self.name.value)
            self.dialogs.ask(Question("Export to", self._chosen, suffixes, True, name))
        if entered:
            self._submit()

    def _contents(self) -> None:
        """What the file will hold, in a line."""
        width, height = self._pixels()
        if self.picture == BOTH and self.format != EXR:
            presentation = self.model.state.presentation
            width = 2 * width + self.model.gap_px
            told = f"{width} x {height} px, both parameters and commands inside"
            told += ", mirrored" if presentation.mirror else ""
        elif self.picture == BOTH:
            told = f"two files of {width} x {height} px: ...-reference.exr and ...-test.exr"
        else:
            told = f"{width} x {height} px, with its parameters and command inside"
        shown = self.model.state.presentation
        if shown.overlay != "none" or shown.compare == DIFFERENCE:
            told += "; the pictures themselves: File > Export view writes what is shown over them"
        widgets.label("")
        widgets.wrapped(told, dim=True)

    def _end(self) -> None:
        """The last lines: what is going on or went wrong, and the buttons."""
        if self._replacing is not None:
            there = [f for f in self._replacing.files if os.path.lexists(f)]
            names = " and ".join(printable(os.path.basename(f), 80) for f in there)
            widgets.wrapped(f"{names}: there already. Replace?")
            if widgets.button("Replace", "write over what is there", width=em(7.0)):
                self._order, self._replacing, self._frames = self._replacing, None, 0
            imgui.same_line()
            if widgets.button("Keep", "leave what is there as it is", width=em(7.0)):
                self._replacing = None
            return
        if self._told:
            widgets.wrapped(f"! {self._told}" if self._fault else self._told)
        imgui.begin_disabled(self._order is not None)
        if widgets.button("Export##go", "write the files", width=em(7.0)):
            self._submit()
        imgui.end_disabled()
        imgui.same_line()
        if widgets.button("Close", "close this window; nothing is lost", width=em(7.0)):
            self._open, self._order = False, None

    def _submit(self) -> None:
        """Give the order, unless something about it has to be asked or mended first."""
        self._forget_told()
        try:
            order = self._ordered()
            there = [f for f in order.files if check_place(f)]
        except InputError as error:
            self._say(str(error), fault=True)
            return
        if there and there != [self._confirmed]:
            self._replacing = order
            return
        self._order, self._frames = order, 0

    def _ordered(self) -> Order:
        if not self.name.value:
            raise InputError("give the name of the file to write")
        path = meant(self.dialogs.folder, self.name.value)
        path = with_suffix(path, (suffix_of(self.format),))
        size = None if self.sizing == ON_SCREEN else check_size(self.size)
        return Order(self.picture, self.format, path, size)

    def _carry_out(self, order: Order) -> None:
        """Write as soon as the pictures are there and the window has said so."""
        self._frames += 1
        reason = obstacle(self.model, order)
        self._say(reason or "writing; the window stands still for a moment")
        if self._frames <= SETTLING or (reason and self._frames < MOST_FRAMES):
            return
        self._order, self._confirmed = None, ""
        try:
            if reason:
                raise InputError(f"nothing was written: still {reason}; try again")
            told = write(self.model, order)
        except (RelglossError, MemoryError) as error:
            fault = str(error) or "not enough memory; choose a smaller size"
            self._say(fault, fault=True)
            self.model.say(fault, fault=True)
            return
        self._say(told)
        self.model.say(told)

    def _chosen(self, path: str) -> None:
        self.name.put(path)
        self._forget()
        self._confirmed = path

    def _pixels(self) -> Size:
        return self.model.picture_size if self.sizing == ON_SCREEN else self.size

    def _suggested(self) -> str:
        if self.picture == BOTH:
            name = "pair"
        else:
            material = self.model.state.side(self.picture).sample.material
            name = f"{safe_name(material.name)}-{self.picture}"
        return name + suffix_of(self.format)

    def _forget(self) -> None:
        """What was said and agreed about another choice."""
        self._confirmed, self._replacing = "", None
        self._forget_told()

    def _forget_told(self) -> None:
        self._told, self._fault = "", False

    def _say(self, text: str, *, fault: bool = False) -> None:
        self._told, self._fault = printable(text, 300), fault


def _bounded(side: int) -> int:
    return min(max(int(side), 1), MAX_SIDE_PX)
