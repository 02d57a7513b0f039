"""The window that writes a proof or a reply: note, author, key, file; progress while it works."""

from __future__ import annotations

import dataclasses
import os
import time

from imgui_bundle import ImVec2, imgui

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.viewer.files.folders import NameField, check_place, meant, with_suffix
from relgloss_view.viewer.files.own_materials import safe_name
from relgloss_view.viewer.files.proof_files import PROOF_SUFFIXES
from relgloss_view.viewer.files.proof_writing import (
    LONGEST_TEXT,
    OtherPair,
    ProofRequest,
    ProofWriting,
)
from relgloss_view.viewer.panels import floating
from relgloss_view.viewer.panels.file_dialogs import FileDialogs
from relgloss_view.viewer.panels.own_dialog import Question
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.proofs import OpenProof, author_of, changed_parts

SAVE, REPLY = "Save as proof", "Reply"
LABEL_EM, WIDTH_EM, NOTE_EM = 6.0, 32.0, 5.5
NO_KEY = "not signed"
STEP_S = 0.1  #: between frames while a proof is being written


class SaveProof:
    """The fields of the window; what was typed stays until a proof was written."""

    def __init__(self, model: Model, writing: ProofWriting, dialogs: FileDialogs) -> None:
        self.model, self.writing, self.dialogs = model, writing, dialogs
        self.title = self.note = self.author = self.key = ""
        self.name = NameField()
        self.answers: OpenProof | None = None
        self.pair: OtherPair | None = None  #: written in the place of the window's pair
        self._open = self._raised = False
        self._replacing: ProofRequest | None = None
        self._confirmed = ""  #: a file that the dialog has asked about
        self._fault = ""
        self._began_s = 0.0

    def open(self, answers: OpenProof | None = None, pair: OtherPair | None = None) -> None:
        """Show the window, for a new proof (of another pair) or for an answer to one."""
        other = None if self.answers is None else self.answers.proof
        same = other is (None if answers is None else answers.proof) and self.pair == pair
        if self.writing.busy:
            same = True  # what is being written has its fields
        if not self._open or not same:
            self._replacing, self._confirmed, self._fault = None, "", ""
            if pair is not None:
                self.note = pair.note
            elif self.pair is not None:
                self.note = ""
            self.answers, self.pair = answers, pair
            self.title = self._suggested_title()
            self.name.put(self._suggested_name())
        self._open = self._raised = True

    def done(self) -> None:
        """Close: the proof was written."""
        self._open, self.note, self._fault = False, "", ""

    def failed(self, fault: str) -> None:
        """Show why nothing was written; all that was typed stays."""
        self._fault = fault

    def due_s(self) -> float | None:
        """Seconds until a frame is needed: soon while a proof is being written."""
        return STEP_S if self.writing.busy else None

    def show(self) -> None:
        """Draw the window, if it is open."""
        if not self._open:
            return
        heading = SAVE if self.answers is None else REPLY
        opened, stays = floating.begin(heading, WIDTH_EM, raised=self._raised)
        self._raised = False
        busy = imgui.is_any_item_active() or self.dialogs.open or self.writing.busy
        if opened:
            imgui.begin_disabled(self.writing.busy)
            with widgets.label_column(LABEL_EM):
                self._fields()
            imgui.end_disabled()
            stays = self._end() and stays and not (floating.escaped() and not busy)
        imgui.end()
        if not stays:
            self.writing.cancel()
        self._open = self._open and bool(stays)

    def _fields(self) -> None:
        answers, state = self.answers, self.model.state
        if answers is not None:
            beyond = changed_parts(state, answers.base)
            widgets.wrapped(_reply_words(answers, beyond), dim=not beyond)
        if self.pair is not None:
            widgets.wrapped(self.pair.words, dim=True)
        if answers is None or changed_parts(state, answers.base):
            self.title = self._text("Title", "title", self.title, "What the proof is about.")
        widgets.label("Note")
        changed, note = imgui.input_text_multiline(
            "##Note", self.note, ImVec2(-1.0, em(NOTE_EM)), imgui.InputTextFlags_.word_wrap
        )
        self.note = note[: LONGEST_TEXT["note"]] if changed else self.note
        widgets.tooltip("What you want to say about the pictures, in any language.")
        self.author = self._text(
            "Your name", "author", self.author, "The name that the other side sees; may be empty."
        )
        self._key()
        self._file()

    def _text(self, text: str, kind: str, value: str, meaning: str) -> str:
        widgets.label(text)
        changed, typed = imgui.input_text(f"##{text}", value)
        widgets.tooltip(meaning)
        return typed[: LONGEST_TEXT[kind]] if changed else value

    def _key(self) -> None:
        widgets.label("Signed by")
        name = printable(os.path.basename(self.key), 40) if self.key else NO_KEY
        meaning = (
            "The file of your key, made by `relgloss proof key`. Who knows your key then knows "
            "that the message is yours."
        )
        gap = imgui.get_style().item_inner_spacing.x
        width = imgui.get_content_region_avail().x - (em(1.8) + gap if self.key else 0.0)
        if widgets.button(f"{name}##Signed by", meaning, width=width):
            self.dialogs.ask(Question("Key that signs", self._take_key))
        if self.key:
            imgui.same_line(0.0, gap)
            if widgets.button("x##Signed by", "leaves the proof without a signature"):
                self.key = ""

    def _file(self) -> None:
        widgets.label("File")
        style = imgui.get_style()
        choose = imgui.calc_text_size("Choose...").x + 2.0 * style.frame_padding.x
        imgui.set_next_item_width(-choose - style.item_spacing.x)
        _, name = imgui.input_text("##File", self.name.text, imgui.InputTextFlags_.elide_left)
        if name != self.name.text:
            self.name.text, self._confirmed, self._replacing = name, "", None
        widgets.tooltip(f"A full path, or a name in {printable(self.dialogs.folder, 300)}.")
        imgui.same_line()
        if widgets.button("Choose...", "asks for a folder and a name"):
            name = os.path.basename(self.name.value)
            question = Question("Proof", self._chosen, PROOF_SUFFIXES, saving=True, name=name)
            self.dialogs.ask(question)

    def _end(self) -> bool:
        """Progress, fault, question and buttons; returns whether the window stays."""
        if self.writing.busy:
            seconds = time.monotonic() - self._began_s
            imgui.progress_bar(-0.5 * seconds, ImVec2(-1.0, 0.0), "writing the proof")
            if widgets.button("Cancel", "stops; no file is left", width=em(7.0)):
                self.writing.cancel()
            return True
        if self._replacing is not None:
            name = printable(os.path.basename(self._replacing.path), 80)
            widgets.wrapped(f"{name} is there already. Replace it?")
            if widgets.button("Replace", "writes over what is there", width=em(7.0)):
                self._start(self._replacing)
            imgui.same_line()
            if widgets.button("Keep", "leaves what is there as it is", width=em(7.0)):
                self._replacing = None
            return True
        if self._fault:
            widgets.wrapped(f"! {self._fault}")
        if widgets.button("Save##proof", "writes the file, to be sent", width=em(7.0)):
            self._submit()
        imgui.same_line()
        return not widgets.button("Close", "closes this window; your words stay", width=em(7.0))

    def _submit(self) -> None:
        self._fault = ""
        try:
            if not self.name.value:
                raise InputError("type the name of the file to write")
            path = with_suffix(meant(self.dialogs.folder, self.name.value), PROOF_SUFFIXES)
            there = check_place(path)
        except InputError as error:
            self._fault = printable(str(error), 300)
            return
        request = ProofRequest(
            path, self.model.state, self.note.strip(), self.author.strip(), self.title.strip(),
            self.key, self.answers, make=None if self.pair is None else self.pair.make,
        )  # fmt: skip
        if there and path != self._confirmed:
            self._replacing = request
        else:
            self._start(request)

    def _start(self, request: ProofRequest) -> None:
        self._replacing, self._began_s = None, time.monotonic()
        # What was changed while a question was open is part of the proof.
        self.writing.start(
            dataclasses.replace(request, state=self.model.state, monitor=self.model.screen)
        )

    def _take_key(self, path: str) -> None:
        self.key = path

    def _chosen(self, path: str) -> None:
        self.name.put(path)
        self._confirmed, self._replacing = path, None

    def _suggested_title(self) -> str:
        if self.answers is not None:
            return self.answers.proof.title
        if self.pair is not None:
            return printable(self.pair.name, 100)
        pack, sample = self.model.pack("test"), self.model.sample("test")
        return printable(sample.material.name if pack is None else pack.name, 100)

    def _suggested_name(self) -> str:
        if self.answers is None:
            return f"{safe_name(self.title) or 'proof'}.html"
        stem = os.path.splitext(os.path.basename(self.answers.path))[0]
        number = len(self.answers.proof.messages) + 1
        base, dash, last = stem.rpartition("-")
        stem = base if dash and last.isdigit() else stem
        return f"{stem}-{number}.html"


def _reply_words(answers: OpenProof, beyond: tuple[str, ...]) -> str:
    """What will be written, before it is."""
    whom = author_of(answers.proof.messages[-1])
    if beyond:
        return (
            f"You have changed {', '.join(beyond)}, which a reply can't carry. This becomes a new "
            f"proof that names the one by {whom} as the one it answers."
        )
    return (
        f"Answers {whom}. The file keeps the whole thread, and adds your settings: graininess, "
        "contrast gloss, object and lamp as they show now."
    )
