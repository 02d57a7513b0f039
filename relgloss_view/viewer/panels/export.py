"""The window that writes pictures to files: which, in which format, how large, where to."""

from __future__ import annotations

import os

from imgui_bundle import imgui

from relgloss_view.base.decoration import fault_line
from relgloss_view.base.errors import InputError, RelglossError
from relgloss_view.base.reading import printable
from relgloss_view.picture.model.view import MAX_SIDE_PX, Size, check_size
from relgloss_view.viewer.files.folders import NameField, check_place, meant, with_suffix
from relgloss_view.viewer.files.own_materials import safe_name
from relgloss_view.viewer.files.picture_export import (
    BOTH,
    EXR,
    FORMATS,
    PICTURES,
    PNG8,
    ExportRequest,
    obstacle,
    suffix_of,
    write,
)
from relgloss_view.viewer.panels import floating
from relgloss_view.viewer.panels.file_dialogs import FileDialogs
from relgloss_view.viewer.panels.own_dialog import Question
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.screens import name_of
from relgloss_view.viewer.state.state import DIFFERENCE

TITLE = "Export"
LABEL_EM = 6.0
ON_SCREEN, TYPED = "as on the screen", "other"
SETTLING = 2  #: frames that are drawn before the window freezes, so that it shows why
STEP_S = 0.03
MOST_FRAMES = 300  #: that pictures are waited for


class Export:
    """The choices of the window, and the export that is under way."""

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
        self._replacing: ExportRequest | None = None
        self._request: ExportRequest | None = None
        self._frames = 0  #: since it was requested
        self._message = ""
        self._fault = False

    def open(self) -> None:
        """Show the window, for the active side."""
        if not self._open:
            self.picture, self._message, self._replacing = self.model.active_side, "", None
            self.name.put(self._suggested())
        self._open = self._raised = True

    def due_s(self) -> float | None:
        """Seconds until a frame is needed: soon while an export is under way."""
        return STEP_S if self._request is not None else None

    def show(self) -> None:
        """Draw the window, if it is open, and carry out the export that was requested."""
        if self._request is not None:
            self._carry_out(self._request)
        if not self._open:
            return
        opened, stays = floating.begin(TITLE, 30.0, raised=self._raised)
        self._raised = False
        if opened:
            imgui.begin_disabled(self._request is not None)
            with widgets.label_column(LABEL_EM):
                self._what()
                self._where()
                self._contents()
            imgui.end_disabled()
            self._end()
            stays = stays and not floating.escaped()
        imgui.end()
        self._open = self._open and bool(stays)

    def _what(self) -> None:
        changed, picture = widgets.combo(
            "Picture",
            PICTURES,
            self.picture,
            "One picture, or both side by side as in the window: with the gap, and mirrored if the "
            "window is.",
        )
        if changed:
            untouched = self.name.value == self._suggested()
            self.picture = picture
            if untouched:
                self.name.put(self._suggested())
            self._forget()
        changed, chosen = widgets.combo(
            "Format",
            FORMATS,
            self.format,
            "PNG, with the profile of the scene's display, for looking; OpenEXR, with every stage "
            "in floats, for computing.",
        )
        if changed:
            self.format = chosen
            self.name.put(os.path.splitext(self.name.value)[0] + suffix_of(chosen))
            self._forget()
        if self.model.render_at is None:
            self.sizing = ON_SCREEN
            return
        meaning = "Size of one picture, in pixels."
        changed, self.sizing = widgets.combo("Size", (ON_SCREEN, TYPED), self.sizing, meaning)
        if self.sizing == TYPED:
            widgets.label("")
            _, typed = imgui.input_int2("##pixels", list(self.size))
            self.size = (_bounded(typed[0]), _bounded(typed[1]))
            widgets.tooltip(f"Width and height in pixels, 1 to {MAX_SIDE_PX} each.")

    def _where(self) -> None:
        widgets.label("File")
        choose = imgui.calc_text_size("Choose...").x + 2.0 * imgui.get_style().frame_padding.x
        imgui.set_next_item_width(-choose - imgui.get_style().item_spacing.x)
        flags = imgui.InputTextFlags_
        entered, name = imgui.input_text(
            "##File", self.name.text, flags.enter_returns_true | flags.elide_left
        )
        if name != self.name.text:
            self.name.text = name
            self._forget()
        widgets.tooltip(f"A full path, or a name in {printable(self.dialogs.folder, 300)}.")
        imgui.same_line()
        if widgets.button("Choose...", "asks for a folder and a name"):
            suffixes = (suffix_of(self.format),)
            name = os.path.basename(self.name.value)
            self.dialogs.ask(Question("Export to", self._chosen, suffixes, saving=True, name=name))
        if entered:
            self._submit()

    def _contents(self) -> None:
        """The contents of the file, in a line."""
        width, height = self._pixels()
        presentation = self.model.state.presentation
        if self.picture == BOTH and self.format != EXR:
            width = 2 * width + self.model.gap_px
            text = f"{width} x {height} px, with both pictures' parameters and commands"
            text += ", mirrored" if presentation.mirror else ""
        elif self.picture == BOTH:
            text = f"Two files of {width} x {height} px: ...-reference.exr and ...-test.exr"
        else:
            text = f"{width} x {height} px, with its parameters and command"
        if presentation.overlay != "none" or presentation.compare == DIFFERENCE:
            text += ". Without overlay or map; File > Export view writes these too"
        text += f". Drawn for {name_of(self.model.state.setup.display)}, as the scene declares"
        text += ", not for this monitor" if self.model.on_screen is not self.model.state else ""
        widgets.label("")
        widgets.wrapped(f"{text}.", dim=True)

    def _end(self) -> None:
        """The last lines: progress or fault, and the buttons."""
        if self._replacing is not None:
            there = [f for f in self._replacing.files if os.path.lexists(f)]
            names = " and ".join(printable(os.path.basename(f), 80) for f in there)
            widgets.wrapped(f"{names} already there. Replace?")
            if widgets.button("Replace", "writes over what is there", width=em(7.0)):
                self._request, self._replacing, self._frames = self._replacing, None, 0
            imgui.same_line()
            if widgets.button("Keep", "leaves what is there as it is", width=em(7.0)):
                self._replacing = None
            return
        if self._message:
            widgets.wrapped(f"! {self._message}" if self._fault else self._message)
        imgui.begin_disabled(self._request is not None)
        if widgets.button("Export##go", "writes the files", width=em(7.0)):
            self._submit()
        imgui.end_disabled()
        imgui.same_line()
        if widgets.button("Close", "closes this window", width=em(7.0)):
            self._open, self._request = False, None

    def _submit(self) -> None:
        """Request the export, unless something has to be asked or mended first."""
        self._forget_message()
        try:
            request = self._wanted()
            there = [f for f in request.files if check_place(f)]
        except InputError as error:
            self._note(str(error), fault=True)
            return
        if there and there != [self._confirmed]:
            self._replacing = request
            return
        self._request, self._frames = request, 0

    def _wanted(self) -> ExportRequest:
        if not self.name.value:
            raise InputError("type the name of the file to write")
        path = meant(self.dialogs.folder, self.name.value)
        path = with_suffix(path, (suffix_of(self.format),))
        size = None if self.sizing == ON_SCREEN else check_size(self.size)
        return ExportRequest(self.picture, self.format, path, size)

    def _carry_out(self, request: ExportRequest) -> None:
        """Write as soon as the pictures are there and the window displays why it waits."""
        self._frames += 1
        reason = obstacle(self.model, request)
        self._note(reason or "writing; the window does not react for a moment")
        if self._frames <= SETTLING or (reason and self._frames < MOST_FRAMES):
            return
        self._request, self._confirmed = None, ""
        try:
            if reason:
                raise InputError(f"nothing was written: still {reason}; try again")
            text = write(self.model, request)
        except Exception as error:
            if isinstance(error, RelglossError | MemoryError):
                fault = str(error) or "not enough memory; choose a smaller size"
            else:
                fault = f"the export failed: {fault_line(error)}"
            self._note(fault, fault=True)
            self.model.report(fault, fault=True)
            return
        self._note(text)
        self.model.report(text)

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
            pack, sample = self.model.pack(self.picture), self.model.sample(self.picture)
            title = sample.material.name if pack is None else pack.name
            name = f"{safe_name(title)}-{self.picture}"
        return name + suffix_of(self.format)

    def _forget(self) -> None:
        """Drop the message and the agreement about another choice."""
        self._confirmed, self._replacing = "", None
        self._forget_message()

    def _forget_message(self) -> None:
        self._message, self._fault = "", False

    def _note(self, text: str, *, fault: bool = False) -> None:
        self._message, self._fault = printable(text, 300), fault


def _bounded(side: int) -> int:
    return min(max(int(side), 1), MAX_SIDE_PX)
