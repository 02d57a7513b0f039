"""The window "New material": readings of a gloss meter and a colour, and what they leave open."""

from __future__ import annotations

import dataclasses
import os

from imgui_bundle import ImVec2, imgui

from relgloss_view.base.reading import printable
from relgloss_view.measure.spectrum import AT_45_0, GEOMETRIES, SPHERE_EXCLUDED, SPHERE_INCLUDED
from relgloss_view.viewer.files.new_material import NewMaterial
from relgloss_view.viewer.panels import (
    colour_fields,
    estimate_table,
    floating,
    ghost_outlines,
)
from relgloss_view.viewer.panels.file_dialogs import FileDialogs
from relgloss_view.viewer.panels.list_rows import fitting
from relgloss_view.viewer.panels.own_dialog import Question
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import em, gray
from relgloss_view.viewer.state.model import GhostPicture
from relgloss_view.viewer.state.places import data_folder
from relgloss_view.viewer.state.readings_typed import ANGLES_DEG

TITLE = "New material"
WIDTH_EM, TOP_EM = 25.0, 1.7
LABEL_EM = 8.4
ANGLE_EM = 2.2  #: of the label of a reading
GHOST_EM = (11.6, 9.5)  #: the most that a small picture is wide and high
MOST_WARNINGS = 3
LONGEST_WARNING = 240  #: characters
SPECTRA = (".csv", ".txt", ".cxf", ".cgats", ".ti3", ".sp", ".xml", ".tsv")
MEASURED = {
    AT_45_0: "45/0",
    SPHERE_INCLUDED: "d/8, specular included (SCI)",
    SPHERE_EXCLUDED: "d/8, specular excluded (SCE)",
}
SIDE_MEANINGS = {
    "reference": "makes the material the reference, on the left",
    "test": "makes the material the test, on the right",
}


class NewMaterialPanel:
    """The window over a material that is being made."""

    def __init__(self, making: NewMaterial, dialogs: FileDialogs) -> None:
        self.making = making
        self.model = making.model
        self.dialogs = dialogs
        self._raised = False
        self._listing = False  #: whether a list or the colour picker was open in the last frame
        self._focus = False  #: whether the first field gets the keyboard

    def open(self) -> None:
        """Show the window, for the active side."""
        self._focus = self._raised = True
        self.making.begin(self.model.active_side)

    def show(self) -> None:
        """Draw the window, if a material is being made."""
        making = self.making
        if not making.active:
            return
        # Escape first ends the typing, or closes a list.
        busy = imgui.is_any_item_active() or self._listing or self.dialogs.open
        opened, stays = floating.begin(
            TITLE, WIDTH_EM, top_em=TOP_EM, right=True, raised=self._raised
        )
        self._raised = False
        cancelled = not stays
        if opened:
            with widgets.label_column(LABEL_EM):
                self._fields()
            self._outcome()
            cancelled = self._buttons() or cancelled
            cancelled = cancelled or (floating.escaped() and not busy)
        imgui.end()
        self._listing = imgui.is_popup_open("", imgui.PopupFlags_.any_popup)
        if cancelled:
            making.cancel()
        making.each_frame()  # what was typed now is computed from now on

    def _fields(self) -> None:
        making = self.making
        meanings = {side.capitalize(): text for side, text in SIDE_MEANINGS.items()}
        changed, chosen = widgets.buttons("Replaces", meanings, making.side.capitalize())
        if changed:
            making.put_on(chosen.lower())
            self.model.active_side = making.side
        if making.finish:
            widgets.quiet(f"Finish: {printable(making.finish, 60)}")
        widgets.label("Name")
        changed, name = imgui.input_text("##Name", making.name)
        widgets.tooltip("The name of the material and of its file.")
        if changed:
            making.rename(name)
        imgui.separator_text("Gloss units")
        self._gloss()
        imgui.separator_text("Colour")
        self._colour()

    def _gloss(self) -> None:
        """Two fields a line; what is empty was not read."""
        typed = self.making.typed
        texts = list(typed.gloss)
        gap = em(0.9)
        room = 0.5 * (imgui.get_content_region_avail().x - gap)
        for k, angle in enumerate(ANGLES_DEG):
            if k % 2:
                imgui.same_line()
                imgui.set_cursor_pos_x(imgui.get_style().window_padding.x + room + gap)
            texts[k] = self._reading(angle, texts[k], room)
        if tuple(texts) != typed.gloss:
            self.making.typed = dataclasses.replace(typed, gloss=tuple(texts))

    def _reading(self, angle: int, text: str, room: float) -> str:
        """A field for a reading, with a button that empties it."""
        imgui.begin_group()
        imgui.align_text_to_frame_padding()
        left = imgui.get_cursor_pos_x()
        imgui.text_unformatted(f"{angle}°")
        imgui.same_line()
        imgui.set_cursor_pos_x(left + em(ANGLE_EM))
        clear, space = imgui.get_frame_height(), em(0.2)
        imgui.set_next_item_width(room - em(ANGLE_EM) - clear - space)
        if self._focus and angle == ANGLES_DEG[0]:
            imgui.set_keyboard_focus_here()
            self._focus = False
        _, text = imgui.input_text_with_hint(
            f"##gloss {angle}", "-", text, imgui.InputTextFlags_.auto_select_all
        )
        standard = "TAPPI T 480" if angle == 75 else "ISO 2813, ASTM D523"
        widgets.tooltip(
            f"Reading of a gloss meter at {angle}° ({standard}), with the digits that it shows. "
            "Empty: not read."
        )
        imgui.same_line(0.0, space)
        imgui.begin_disabled(not text)
        imgui.push_item_flag(imgui.ItemFlags_.no_tab_stop, True)
        if imgui.button(f"x##clear {angle}", (clear, 0.0)):
            text = ""
        imgui.pop_item_flag()
        imgui.end_disabled()
        widgets.tooltip("Empties the field.")
        imgui.end_group()
        return text

    def _colour(self) -> None:
        making = self.making
        if making.spectrum_file:
            self._spectrum()
        else:
            lab = colour_fields.fields(making.typed.lab)
            if lab is not None:
                making.typed = dataclasses.replace(making.typed, lab=lab)
            widgets.label("")
            if widgets.button(
                "Spectrum file...",
                "takes the colour from a file of a spectrophotometer; or drop the file here",
            ):
                question = Question("Spectrum file", self.making.read_spectrum, SPECTRA)
                self.dialogs.ask(question)
        changed, geometry = widgets.combo(
            "Measured at",
            GEOMETRIES,
            making.typed.geometry,
            "Geometry of the spectrophotometer: 45/0, or a sphere with the specular part included "
            "or excluded.",
            words=MEASURED,
        )
        if changed:
            making.typed = dataclasses.replace(making.typed, geometry=geometry)

    def _spectrum(self) -> None:
        making = self.making
        widgets.label("Spectrum")
        text = "Use Lab"
        beside = imgui.calc_text_size(text).x + 2.0 * imgui.get_style().frame_padding.x
        room = imgui.get_content_region_avail().x - beside - imgui.get_style().item_spacing.x
        name = printable(os.path.basename(making.spectrum_file), 80)
        left = imgui.get_cursor_pos_x()
        imgui.text_unformatted(fitting(name, room))
        widgets.tooltip(printable(making.spectrum_file, 400))
        imgui.same_line(left + room + imgui.get_style().item_spacing.x)
        if widgets.button(text, "takes the colour from L, a, b again"):
            making.without_spectrum()
            return
        widgets.label("Sample in it")
        flags = imgui.InputTextFlags_.enter_returns_true
        entered, part = imgui.input_text_with_hint("##part", "-", making.spectrum_part, flags)
        widgets.tooltip("Name or number of the sample, where the file holds several. Enter reads.")
        left_field = imgui.is_item_deactivated_after_edit()
        if (entered or left_field) and part != making.spectrum_part:
            making.read_spectrum(making.spectrum_file, part)

    def _outcome(self) -> None:
        """What is wrong with the readings, or the materials that they allow."""
        making = self.making
        estimate = making.estimate
        imgui.separator_text("Estimate")
        if making.fault:
            widgets.wrapped(f"! {widgets.sentence(making.fault)}")
        if estimate is None:
            if not making.fault:
                text = "Type at least one gloss reading; the picture follows as you type."
                widgets.wrapped(text, dim=True)
            return
        record = estimate.material.estimate
        assert record is not None
        if not making.fault:
            for warning in record.warnings[:MOST_WARNINGS]:
                widgets.wrapped(f"! {widgets.sentence(printable(warning, LONGEST_WARNING))}")
        self._ghosts(self.model.ghosts)
        estimate_table.show(record)

    def _ghosts(self, ghosts: dict[str, GhostPicture]) -> None:
        """The dullest and the glossiest material side by side."""
        if not ghosts:
            return
        lines = self.model.ghost_outlines
        gap = em(0.6)
        most = (
            min(0.5 * (imgui.get_content_region_avail().x - gap), em(GHOST_EM[0])),
            em(GHOST_EM[1]),
        )
        for k, (name, ghost) in enumerate(ghosts.items()):
            if k:
                imgui.same_line(0.0, gap)
            imgui.begin_group()
            _picture(ghost, most)
            line = "broken line" if name == ghost_outlines.BROKEN else "line"
            imgui.text_unformatted(f"{name.capitalize()} ({line})" if lines else name.capitalize())
            imgui.end_group()
            widgets.tooltip(
                f"The {name} material that the readings allow, at the same setting: 2.5 % of "
                f"those that agree are {'duller' if name == 'dullest' else 'glossier'}."
            )
        if widgets.checkbox(
            "Outline their highlights on the picture",
            lines,
            "marks where each one's highlight has half of its strength",
        ):
            self.model.ghost_outlines = not lines

    def _buttons(self) -> bool:
        """Keep and cancel; returns whether to cancel."""
        making = self.making
        width = em(7.0)
        if widgets.button(
            "Keep",
            "writes the material to a file, which scenes and commands can name",
            width=width,
            enabled=making.complete,
        ):
            self.model.attempt(self._keep)
        imgui.same_line()
        return widgets.button("Cancel", "brings the former sample back", width=width)

    def _keep(self) -> None:
        file = self.making.keep(data_folder() / "materials")
        finish, side = self.making.finish, self.making.side
        place = f"material of the finish {finish}" if finish else f"{side} sample"
        self.model.report(f"written: {file}; it is the {place} now")


def _picture(ghost: GhostPicture, most: tuple[float, float]) -> None:
    """The part of a small picture that can show the object, as large as there is room."""
    left, bottom, right, top = ghost.object_box
    wide, tall = (right - left) * ghost.size[0], (top - bottom) * ghost.size[1]
    if wide < 1.0 or tall < 1.0:
        imgui.dummy(ImVec2(most[0], most[1]))
        return
    scale = min(most[0] / wide, most[1] / tall)
    at = imgui.get_cursor_screen_pos()
    size = ImVec2(round(wide * scale), round(tall * scale))
    texture = imgui.ImTextureRef(ghost.texture)
    imgui.image(texture, size, ImVec2(left, top), ImVec2(right, bottom))
    frame = imgui.get_color_u32(gray(0.36))
    imgui.get_window_draw_list().add_rect(at, ImVec2(at.x + size.x, at.y + size.y), frame)
