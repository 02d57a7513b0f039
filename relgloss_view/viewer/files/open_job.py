"""Opening a file in the background: a scene, a proof, a display, a pack, artwork, a mesh, a
material, a catalogue, or a measurement, which is fitted first.

A thread does it and leaves the fit itself to a process (see fit_process.py). What is cancelled is
done with at once and leaves no file.
"""

from __future__ import annotations

import os
import threading
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from relgloss_view.base.decoration import fault_line
from relgloss_view.base.errors import FitCancelled, InputError, RelglossError
from relgloss_view.base.terminal import ProgressReport
from relgloss_view.measure.table import Measurement
from relgloss_view.pack.kinds import ARTWORK, PACK
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.file_kinds import MATERIAL, SCENE
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.viewer.files import catalogue_files, display_files, pack_files, proof_files
from relgloss_view.viewer.files.fit_process import FitProcess
from relgloss_view.viewer.files.own_materials import keep_material
from relgloss_view.viewer.state import matching, packs
from relgloss_view.viewer.state.catalogues import OpenCatalogue
from relgloss_view.viewer.state.places import data_folder
from relgloss_view.viewer.state.proofs import OpenProof
from relgloss_view.viewer.state.state import State
from relgloss_view.viewer.state.state_file import load_state


@dataclass(frozen=True)
class Opened:
    """The contents of a file: a state, or a sample, with its measurement where it was fitted.

    pack: of a pack file. artwork: a pack that was made around an artwork alone. shape: a mesh.
    """

    path: str
    state: State | None = None
    sample: Sample | None = None
    measurement: Measurement | None = None
    warning: str = ""  #: why a fitted sample could not be kept in a file
    pack: Pack | None = None
    artwork: Pack | None = None
    shape: Shape | None = None
    proof: OpenProof | None = None  #: whose newest message the state shows
    display: str = ""  #: the entry that an ICC profile or a display file is for
    catalogue: OpenCatalogue | None = None  #: of a catalogue, which changes no picture

    @property
    def is_of_a_pack(self) -> bool:
        """Whether it is a pack, or a part of one: an artwork or a mesh."""
        return not (self.pack is None and self.artwork is None and self.shape is None)

    def applied(self, state: State, side: str, finish: str = "") -> State:
        """The state with it: a scene takes the place of everything, a sample that of a side's.

        An artwork goes on the side's pack, or makes a pack of the present form; a mesh becomes the
        form; a sample becomes the material of a pack's `finish`, where one is named.
        """
        if self.state is not None:
            return self.state
        if self.catalogue is not None:
            return state
        if self.display:
            return display_files.with_display(state, self.display, self.path)
        present = packs.pack_of(state, side)
        if self.pack is not None:
            changed = matching.with_sample(state, side, Sample.of_pack(self.pack))
            return packs.first_lit(changed) if present is None and side == "test" else changed
        if self.shape is not None:
            return self._with_form(state, side, present, self.shape)
        if self.artwork is not None:
            return self._with_artwork(state, side, present, self.artwork)
        if present is not None and finish:
            assert self.sample is not None
            return matching.with_finish_sample(state, side, finish, self.sample)
        assert self.sample is not None
        return matching.with_sample(state, side, self.sample)

    @staticmethod
    def _with_form(state: State, side: str, present: Pack | None, shape: Shape) -> State:
        if present is None:
            return state.placed(shape=shape).lit_for_gloss()
        return packs.with_pack(state, side, packs.on_form(present, shape))

    @staticmethod
    def _with_artwork(state: State, side: str, present: Pack | None, made: Pack) -> State:
        if present is None:
            pack = packs.new_on_form(made, packs.form_of(state))
            state = matching.with_sample(state, side, Sample.of_pack(pack))
            return packs.first_lit(state) if side == "test" else state
        return packs.with_pack(state, side, packs.with_artwork(present, made))


def opened_display(path: str, entry: str = display_files.PROFILE) -> Opened:
    """A display for the scene, or for a side that is seen on it. Raises InputError."""
    display_files.check_display(path)
    return Opened(path, display=entry)


class OpenJob:
    """Opens one file in a thread of its own, which begins at once.

    read: how, where the kind of the file does not decide. prepare: called in the thread with what
    was opened, so that showing that takes no time. `wake` is called from that thread at each
    progress and at the end, and must not raise; the first call may come before the constructor
    returns. Until the job is `done`, result and fault are None; then one of them is set, unless it
    was cancelled. profile: an ICC file of an artwork's printing condition.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        wake: Callable[[], None],
        prepare: Callable[[Opened], None] | None = None,
        read: Callable[[ProgressReport], Opened] | None = None,
        profile: str = "",
    ) -> None:
        self.path = str(Path(path).absolute())
        self._prepare, self._read, self._profile = prepare, read, profile
        self.progress: tuple[float, str] = (0.0, "reading")  #: share done, and what is being done
        self.result: Opened | None = None
        self.fault: str | None = None  #: one line
        self._wake = wake
        self._fit: FitProcess | None = None
        self._done = threading.Event()
        self._cancelled = threading.Event()
        self._ending = threading.Lock()  # a job ends once: finished, failed or cancelled
        self._thread = threading.Thread(target=self._run, name="open", daemon=True)
        self._thread.start()

    @property
    def done(self) -> bool:
        """Whether the job has ended: finished, failed or cancelled."""
        return self._done.is_set()

    @property
    def cancelled(self) -> bool:
        """Whether the job was cancelled before it ended."""
        return self._cancelled.is_set()

    def cancel(self) -> None:
        """End the job now, with neither result nor fault. Nothing happens to one that is done."""
        with self._ending:
            if self.done:
                return
            self._cancelled.set()
            self._done.set()
            if self._fit is not None:
                self._fit.stop()
        self._wake()

    def wait(self, limit_s: float) -> bool:
        """Wait for the end of the job's thread; returns whether it came."""
        self._thread.join(limit_s)
        return not self._thread.is_alive()

    def close(self, limit_s: float = 1.0) -> None:
        """Cancel, and give the thread a moment to clean up. It never keeps the program alive."""
        self.cancel()
        self.wait(limit_s)

    def _run(self) -> None:
        result, fault = None, None
        try:
            result = self._open() if self._read is None else self._read(self._report)
            is_shown = result.catalogue is None
            if self._prepare is not None and is_shown and not self.cancelled:
                self._report(1.0, "preparing")
                self._prepare(result)
        except FitCancelled:
            return
        except RelglossError as error:
            fault = str(error)
        except MemoryError:
            fault = f"{self.path}: not enough memory; {self._smaller} or close other programs"
        except Exception as error:
            # The window must not wait for ever for a job that has met a mistake of the program.
            traceback.print_exc()
            fault = f"{self.path}: the program failed on this file ({type(error).__name__})"
        with self._ending:
            if self.cancelled:
                self._drop(result)
                return
            self.result, self.fault = result, fault
            self._done.set()
        self._wake()

    @property
    def _smaller(self) -> str:
        is_table = self._fit is not None
        return "thin out the table" if is_table else "give it fewer pixels or triangles"

    def _open(self) -> Opened:
        if catalogue_files.catalogue_folder(self.path) is not None:
            catalogue = catalogue_files.opened_catalogue(self.path, self._report)
            return Opened(self.path, catalogue=catalogue)
        if proof_files.is_proof_file(self.path):
            opened = proof_files.opened_proof(self.path, self._report)
            return Opened(self.path, state=opened.newest, proof=opened)
        if display_files.is_display_file(self.path):
            return opened_display(self.path)
        kind = pack_files.file_kind(self.path)
        if kind == PACK:
            return Opened(self.path, pack=pack_files.opened_pack(self.path, self._report))
        if kind == ARTWORK:
            made = pack_files.opened_artwork(self.path, self._report, self._profile)
            return Opened(self.path, artwork=made)
        if kind == pack_files.MESH:
            return Opened(self.path, shape=pack_files.opened_mesh(self.path, self._report))
        if kind == SCENE:
            return Opened(self.path, state=load_state(self.path))
        if kind == MATERIAL:
            return Opened(self.path, sample=Sample.from_file(self.path))
        return self._fitted()

    def _fitted(self) -> Opened:
        """Fit, and keep the material in a file, so that scenes and commands can name it."""
        with self._ending:
            if self.cancelled:
                raise FitCancelled("the fit was cancelled")
            self._fit = FitProcess(self.path)
        material, measurement = self._fit.run(self._report)
        self._report(1.0, "saving")
        try:
            file = keep_material(material, data_folder() / "materials")
        except Exception as error:
            # The fit is worth showing all the same.
            sample = Sample(material, table=self.path)
            reason = str(error) if isinstance(error, InputError) else fault_line(error)
            warning = f"the fitted material is not kept: {reason}"
            return Opened(self.path, sample=sample, measurement=measurement, warning=warning)
        # Read again, it is equal to what a session or a scene gives back.
        sample = Sample.from_file(str(file), self.path)
        return Opened(self.path, sample=sample, measurement=measurement)

    def _report(self, fraction: float, text: str) -> None:
        if self.cancelled:
            raise FitCancelled("opening was cancelled")
        self.progress = (fraction, text)
        self._wake()

    def _drop(self, result: Opened | None) -> None:
        """Remove the material that was saved while the job was being cancelled."""
        if result is None or result.measurement is None or result.sample is None:
            return
        if result.sample.file is not None:
            Path(result.sample.file).unlink(missing_ok=True)
