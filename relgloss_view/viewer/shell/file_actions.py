"""Actions on files: open, save, export, copy; nothing that takes time holds up the window."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import NamedTuple

from imgui_bundle import imgui

from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import ProgressReport
from relgloss_view.pack.forms.mesh_files import MESH_SUFFIXES
from relgloss_view.pack.pack import Pack
from relgloss_view.viewer.drawing.arrangement import as_shown
from relgloss_view.viewer.files.catalogue_files import TABLE_SUFFIXES, catalogue_folder
from relgloss_view.viewer.files.display_files import DISPLAY_SUFFIXES
from relgloss_view.viewer.files.new_material import NewMaterial
from relgloss_view.viewer.files.open_job import Opened, OpenJob, opened_display
from relgloss_view.viewer.files.opened_words import report_opened
from relgloss_view.viewer.files.own_materials import safe_name
from relgloss_view.viewer.files.pack_edits import MaskReader, PackWatch
from relgloss_view.viewer.files.pack_files import ARTWORK_SUFFIXES, NO_PROFILE
from relgloss_view.viewer.files.picture_export import write_view
from relgloss_view.viewer.files.plate_colours import PlateColours
from relgloss_view.viewer.files.preparation import prepare
from relgloss_view.viewer.files.proof_files import PROOF_SUFFIXES
from relgloss_view.viewer.files.scene_saving import save_scene
from relgloss_view.viewer.files.session_reading import SessionReading
from relgloss_view.viewer.panels import opening
from relgloss_view.viewer.panels.export import Export
from relgloss_view.viewer.panels.file_dialogs import FileDialogs
from relgloss_view.viewer.panels.new_material import NewMaterialPanel
from relgloss_view.viewer.panels.own_dialog import Question
from relgloss_view.viewer.shell.catalogue_actions import CatalogueActions
from relgloss_view.viewer.shell.proof_actions import ProofActions
from relgloss_view.viewer.state.command_line import snapshot_command
from relgloss_view.viewer.state.matching import as_displayed, with_plain_pack
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.packs import within_memory
from relgloss_view.viewer.state.screens import name_of
from relgloss_view.viewer.state.session import Autosave
from relgloss_view.viewer.state.state import State

TICK_S = 0.1  #: between looks at a running job
QUICK_S = 0.3  #: a job that ends sooner shows no window
SCENE_SUFFIXES = (".toml",)
SAMPLE_SUFFIXES = (".json", ".csv", ".txt", ".bsdf", ".binary")
OPEN_SUFFIXES = (
    *SCENE_SUFFIXES,
    *PROOF_SUFFIXES,
    *SAMPLE_SUFFIXES,
    *ARTWORK_SUFFIXES,
    *MESH_SUFFIXES,
)
PROFILE_SUFFIXES = (".icc", ".icm")
OPEN_SUFFIXES += PROFILE_SUFFIXES
MASK_SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff")  #: of what mask_file.read_mask reads


class Wanted(NamedTuple):
    """A file to open, the side that it is for, the finish whose material it is, its profile.

    display: the entry that a display is for.
    """

    path: str
    side: str = "test"
    finish: str = ""
    profile: str = ""
    display: str = ""


class FileActions:
    """Opens, saves, exports, copies, and keeps the session, if there is one."""

    def __init__(self, model: Model, wake: Callable[[], None]) -> None:
        self.model = model
        self.session: Autosave | None = None
        self.scene_path: str | None = None  #: of the scene that was opened or saved last
        self.dialogs = FileDialogs()
        self._export = Export(model, self.dialogs)
        self.new_material = NewMaterial(model, wake)
        self._new_material_panel = NewMaterialPanel(self.new_material, self.dialogs)
        self.proofs = ProofActions(model, self.dialogs, wake)
        self.catalogue = CatalogueActions(model, self.open_path, self.proofs.save_pair, wake)
        self._wake = wake
        self._waiting: list[Wanted] = []
        self._job: OpenJob | None = None
        self._wanted = Wanted("")  #: what the job is for
        #: Before and after what was opened, made in the job's thread.
        self._prepared: tuple[State, State] | None = None
        self._session_reading: SessionReading | None = None
        self._masks = MaskReader(model, wake)
        self._watch = PackWatch(model, wake)
        self._plates = PlateColours(model, wake)
        self._began_s = 0.0

    # --- the actions --------------------------------------------------------------------------

    def open(self) -> None:
        """Ask for a file and open it."""
        self._ask(Question("Open file", self.open_path, OPEN_SUFFIXES))

    def open_catalogue(self) -> None:
        """Ask for the table of a catalogue and open the catalogue."""
        self._ask(Question("Open catalogue", self.open_path, TABLE_SUFFIXES))

    def open_path(self, path: str, side: str = "test", finish: str = "", profile: str = "") -> None:
        """Open a file in the background; a sample becomes the test unless asked otherwise.

        finish: of the side's pack, whose material a sample then becomes. profile: an ICC file of an
        artwork's printing condition.
        """
        self._waiting.append(Wanted(os.fspath(path), side, finish, profile))
        self._wake()

    def read_session(self, path: str | os.PathLike[str], coming: Mapping[str, str]) -> None:
        """Read the packs of the last session in the background; `coming`: their names by side."""
        self._session_reading = reading = SessionReading(self.model, path, coming)
        self._began_s = time.monotonic()
        self._job = OpenJob(reading.path, self._wake, self._prepare, reading.read)

    def note_pack(self, pack: Pack) -> None:
        """Note a pack as its file holds it, so that later changes of the file can be told apart."""
        self._watch.note_read(pack)

    def ask_artwork(self, side: str) -> None:
        """Ask for an artwork and lay it on a side's pack, or on a new can."""
        self._ask(
            Question("Open artwork", lambda path: self.open_path(path, side), ARTWORK_SUFFIXES)
        )

    def _ask_profile(self, wanted: Wanted) -> None:
        """Ask for the profile of an artwork that has none, and open it with that."""
        path, side, finish = wanted[:3]

        def take(profile: str) -> None:
            self.open_path(path, side, finish, profile)

        self._ask(Question("ICC profile of the print", take, PROFILE_SUFFIXES))

    def ask_display(self, title: str, entry: str) -> None:
        """Ask for an ICC profile or a display file for an entry; see files.display_files."""

        def take(path: str) -> None:
            self._waiting.append(Wanted(path, display=entry))
            self._wake()

        self._ask(Question(title, take, DISPLAY_SUFFIXES))

    def ask_mesh(self, side: str) -> None:
        """Ask for a mesh, which becomes the form of a side's pack."""
        self._ask(Question("Open mesh", lambda path: self.open_path(path, side), MESH_SUFFIXES))

    def ask_finish_material(self, side: str, finish: str) -> None:
        """Ask for a measurement or a material, which becomes the material of a finish."""

        def take(path: str) -> None:
            self.open_path(path, side, finish)

        self._ask(Question("Material of the finish", take, SAMPLE_SUFFIXES))

    def ask_mask(self, side: str, finish: str) -> None:
        """Ask for a gray picture that shows where a finish lies."""

        def take(path: str) -> None:
            self._masks.read(path, side, finish)

        self._ask(Question("Mask of the finish", take, MASK_SUFFIXES))

    def make_pack(self, side: str) -> None:
        """Put a can of the side's present sample in its place."""
        model = self.model
        model.attempt(lambda: model.change(with_plain_pack(model.state, side)))

    def replace_reference(self) -> None:
        """Ask for the file of another reference sample and open it."""
        question = Question(
            "Replace reference", lambda path: self.open_path(path, "reference"), SAMPLE_SUFFIXES
        )
        self._ask(question)

    def make_material(self) -> None:
        """Show the window that makes a material from readings, for the active side."""
        self._leave_haploscopic()
        self._new_material_panel.open()

    def dropped(self, path: str) -> None:
        """Open a file that was dropped; while a material is being made, spectra are its colour."""
        is_other = path.lower().endswith((*SCENE_SUFFIXES, ".json"))
        is_other = is_other or catalogue_folder(path) is not None
        if self.new_material.active and not is_other:
            self.new_material.read_spectrum(path)
            self._wake()
        else:
            finish = self.model.active_finish("test")
            self.open_path(path, finish="" if finish is None else finish.name)

    def save(self) -> None:
        """Save the scene where it was opened or saved last, or ask where."""
        if self.scene_path is None:
            self.save_as()
        else:
            self._save_to(self.scene_path)

    def save_as(self) -> None:
        """Ask for a place and save the scene there."""
        name = "pair.toml"
        if self.scene_path is not None:
            folder, name = os.path.split(self.scene_path)
            self.dialogs.folder = folder
        self._ask(Question("Save scene as", self._save_to, SCENE_SUFFIXES, saving=True, name=name))

    def export(self) -> None:
        """Show the window that writes pictures."""
        self._leave_haploscopic()
        self._export.open()

    def save_proof(self) -> None:
        """Show the window that writes the pair as a proof."""
        self._leave_haploscopic()
        self.proofs.save_as_proof()

    def reply(self) -> None:
        """Show the window that answers the open proof."""
        self._leave_haploscopic()
        self.proofs.reply()

    def export_view(self) -> None:
        """Ask for a place and write the pane there: overlay, wipe and all."""
        self._ask(
            Question("Export view", self._write_view, (".png",), saving=True, name="view.png")
        )

    def _write_view(self, path: str) -> None:
        self.model.take_view = partial(write_view, self.model, path)
        self._wake()

    def copy_command(self) -> None:
        """Copy the line that draws the active side's picture without a window."""
        model = self.model
        side = model.active_side

        def copy() -> None:
            state = as_shown(model.state, model.picture_size, model.pixel_pitch_m)
            state = as_displayed(state, model.factor)
            sample = state.side(side).sample
            title = sample.material.name if sample.pack is None else sample.pack.name
            name = f"{safe_name(title)}.png"
            imgui.set_clipboard_text(snapshot_command(state, side, model.picture_size, name))
            width, height = model.picture_size
            text = f"copied: the command that draws the {side} picture, {width}x{height}"
            other = model.on_screen is not model.state
            text += f", for {name_of(state.setup.display)}, not for this monitor" if other else ""
            model.report(text)

        model.attempt(copy)

    # --- in every frame -----------------------------------------------------------------------

    def each_frame(self) -> None:
        """Take the file that was opened, begin the next, keep the session."""
        if self._job is not None and self._job.done:
            job, self._job = self._job, None
            self._take(job)
        if self._job is None and self._waiting:
            self._wanted = wanted = self._waiting.pop(0)
            self._began_s = time.monotonic()
            self._prepared = None
            read = partial(self._read_display, wanted) if wanted.display else None
            self._job = OpenJob(wanted.path, self._wake, self._prepare, read, wanted.profile)
        self.new_material.each_frame()
        self.proofs.each_frame()
        self.catalogue.each_frame()
        self._masks.each_frame()
        self._watch.each_frame()
        self._plates.each_frame()
        if self.session is not None and not self.model.coming:
            self.session.note(self.model.state)
            if self.session.due(time.monotonic()):
                self.model.attempt(self.session.save)

    def show(self) -> None:
        """Draw dialogs, progress and the export window."""
        self.dialogs.show()
        self._export.show()
        self.proofs.show()
        self._new_material_panel.show()
        if self._job is not None and time.monotonic() - self._began_s >= QUICK_S:
            reading = self._session_reading
            title = "" if reading is None else reading.title
            if opening.show(self._job, title, len(self._waiting)):
                self._waiting.clear()

    def due_s(self) -> float | None:
        """Seconds until a frame is needed without an event; None if nothing is under way."""
        waits = [self.dialogs.due_s(), self._export.due_s(), self.proofs.due_s()]
        waits.append(self.catalogue.due_s())
        waiting = self._waiting or self.new_material.waiting or self._masks.busy
        if self._job is not None or waiting:
            waits.append(TICK_S)
        if self.session is not None and not self.model.coming:
            waits.append(self.session.due_in(time.monotonic()))
        return min((due for due in waits if due is not None), default=None)

    def close(self) -> None:
        """End what runs and keep the session; the window is about to close."""
        self._waiting.clear()
        self.new_material.cancel()  # what is in no file would be lost
        self.dialogs.close()
        self.proofs.close()
        self.catalogue.close()
        self._watch.close()
        if self._job is not None:
            self._job.close()
            self._job = None
        if self.session is not None and not self.model.coming:  # or its file would lose its packs
            self.session.note(self.model.state)
            self.model.attempt(self.session.save)

    # --- how ----------------------------------------------------------------------------------

    def _ask(self, question: Question) -> None:
        self._leave_haploscopic()
        self.dialogs.ask(question)

    def _leave_haploscopic(self) -> None:
        """Leave the mode in which a window over the pictures would not show."""
        if self.model.state.presentation.haploscopic:
            self.model.set_part("presentation", haploscopic=False)

    def _save_to(self, path: str) -> None:
        def write() -> None:
            saved = save_scene(path, self.model.state)
            self.scene_path = path
            self.model.report(saved.words)

        self.model.attempt(write)

    def _take(self, job: OpenJob) -> None:
        reading, self._session_reading = self._session_reading, None
        if reading is not None:
            whole = reading.take(job.result, job.fault or "")
            if whole is not None and self.session is not None:
                self.session.note_written(whole)
            return
        name = printable(Path(job.path).name, 80)
        self.catalogue.note_opened(job.path)
        if job.fault is not None and NO_PROFILE in job.fault:
            self.model.report(f"{name} is CMYK without a profile: choose that of its print")
            self._ask_profile(self._wanted)
        elif job.fault is not None:
            self.model.report(job.fault, fault=True)
        elif job.result is not None:
            self._apply(job.result, name)
        elif job.cancelled:
            self.model.report(f"cancelled: {name}")

    def _apply(self, opened: Opened, name: str) -> None:
        model, wanted = self.model, self._wanted
        if opened.catalogue is not None:
            self.catalogue.take(opened.catalogue)
            return
        if opened.state is not None and wanted.side == "reference":
            model.report(f"{name} is a scene, which holds both pictures: use Open", fault=True)
            return
        model.change(self._after(opened))
        model.history.forget(within_memory)
        if opened.proof is not None:
            self.scene_path = None  # its scene is the program's own file
            self.proofs.opened(opened.proof)
        elif opened.state is not None:
            self.scene_path = opened.path
        if opened.pack is not None:
            self.note_pack(opened.pack)
        report_opened(model, opened, name, wanted.side, wanted.finish)

    @staticmethod
    def _read_display(wanted: Wanted, report: ProgressReport) -> Opened:
        report(0.5, "reading the display")
        return opened_display(os.path.abspath(wanted.path), wanted.display)

    def _prepare(self, opened: Opened) -> None:
        """Make what the pictures of an opened file need; in the job's thread."""
        model = self.model
        before = model.state
        after = opened.applied(before, self._wanted.side, self._wanted.finish)
        prepare(after, model.picture_size, model.pixel_pitch_m)
        self._prepared = before, after

    def _after(self, opened: Opened) -> State:
        """The state with what was opened, as prepared unless something has changed meanwhile."""
        prepared, state = self._prepared, self.model.state
        if prepared is not None and prepared[0] is state:
            return prepared[1]
        return opened.applied(state, self._wanted.side, self._wanted.finish)
