"""Proofs in the window: the one that is open, whether it looks the same here, and new ones."""

from __future__ import annotations

from collections.abc import Callable

from relgloss_view.base.errors import RelglossError
from relgloss_view.viewer.files.proof_writing import CANCELLED, OtherPair, ProofWriting
from relgloss_view.viewer.files.same_picture import SamePicture, same_picture
from relgloss_view.viewer.panels.file_dialogs import FileDialogs
from relgloss_view.viewer.panels.save_proof import SaveProof
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.proofs import OpenProof

PANEL = "Proof"
WAITING_FRAMES = 3  #: in which the panel shows that it is about to compare


class ProofActions:
    """Keeps the open proof, compares its picture once, and writes new proofs and replies."""

    def __init__(self, model: Model, dialogs: FileDialogs, wake: Callable[[], None]) -> None:
        self.model = model
        self._wake = wake
        self.writing = ProofWriting(wake)
        self._dialog = SaveProof(model, self.writing, dialogs)
        self._compared: tuple[str, str, bool] | None = None  #: folder of the scene, words, same
        self._asked = 0  #: frames since the panel asked for the comparison

    def opened(self, opened: OpenProof) -> None:
        """Take a proof that was opened, whose newest message the model shows already."""
        self.model.proof, self.model.proof_message = opened, -1
        self.model.wanted_panel = PANEL

    def save_as_proof(self) -> None:
        """Show the window that writes the present pair as a new proof."""
        self._dialog.open()

    def save_pair(self, pair: OtherPair) -> None:
        """Show the window that writes another pair than the present one as a new proof."""
        self._dialog.open(pair=pair)

    def reply(self) -> None:
        """Show the window that answers the open proof."""
        if self.model.proof is not None:
            self._dialog.open(self.model.proof)

    def same_picture(self, opened: OpenProof) -> str | None:
        """Whether this window draws what the designer saw, in words; None until it has drawn it."""
        if self._compared is not None and self._compared[0] == opened.folder:
            return self._compared[1]
        self._asked += 1
        self._wake()
        return None

    # --- in every frame -----------------------------------------------------------------------

    def each_frame(self) -> None:
        """Compare the picture where the panel asks for it, and take the proof that was written."""
        at_rest = bool(self.model.frames) and not self.model.dragging
        if self.model.proof is not None and self._asked > WAITING_FRAMES and at_rest:
            self._asked = 0
            self._compare(self.model.proof)
        ended = self.writing.take()
        if ended is None:
            return
        request, written, fault = ended
        if written is None:
            stopped = fault == CANCELLED
            text = "cancelled: no proof was written" if stopped else fault
            self.model.report(text, fault=not stopped)
            self._dialog.failed("" if stopped else fault)
            return
        self.model.report(written.words)
        self._dialog.done()
        if request.is_reply and self.model.proof is request.answers:
            self.model.proof = written.opened(request)
            self.model.proof_message = -1

    def show(self) -> None:
        """Draw the window that writes a proof, if it is open."""
        self._dialog.show()

    def due_s(self) -> float | None:
        """Seconds until a frame is needed without an event: while a proof is being written."""
        return self._dialog.due_s()

    def close(self) -> None:
        """End what runs; the window is about to close."""
        self.writing.cancel()

    def _compare(self, opened: OpenProof) -> None:
        renderer = self.model.renderer
        if renderer is None:
            return
        try:
            found: SamePicture = same_picture(opened, renderer)
        except RelglossError as error:
            words, same = f"The designer's picture can't be drawn here: {error}.", False
        else:
            words, same = found.words, found.same
        self._compared = opened.folder, words, same
        if not same:
            self.model.report(words, fault=True)
