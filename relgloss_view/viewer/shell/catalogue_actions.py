"""The catalogue that is open in the window: its searches, its pictures, what becomes a sample.

Reading, searching and decoding are done in threads. A frame takes what has ended.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from imgui_bundle import imgui

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.errors import RelglossError
from relgloss_view.base.reading import printable
from relgloss_view.catalogue.columns import TABLE_FILE
from relgloss_view.catalogue.query.fault import QueryError
from relgloss_view.viewer.drawing.thumbnails import Thumbnails
from relgloss_view.viewer.files.background import Worker
from relgloss_view.viewer.files.catalogue_files import decoded_thumbnails, proof_of
from relgloss_view.viewer.files.exact_search import ExactSearch
from relgloss_view.viewer.files.pack_edits import Poll
from relgloss_view.viewer.files.proof_writing import OtherPair
from relgloss_view.viewer.state.catalogues import (
    TILE_EM,
    Asked,
    OpenCatalogue,
    fault_of,
    is_done,
    nearest_query,
    opened_words,
    searched,
    title_of,
)
from relgloss_view.viewer.state.model import Model

if TYPE_CHECKING:
    from relgloss_view.catalogue.query.found import Found, Hit

PANEL = "Catalogue"
TICK_S = 0.05  #: between frames while something is under way
LONGEST_COPY = 2000  #: characters of a fault on the clipboard
AT_ONCE = 24  #: pictures that are decoded in one piece of work

_Pictures = dict[str, Bytes | None]


class CatalogueActions:
    """Keeps the open catalogue.

    open_path: opens a file in the background, for a side. save_pair: asks how to write a proof.
    """

    def __init__(
        self,
        model: Model,
        open_path: Callable[..., None],
        save_pair: Callable[[OtherPair], None],
        wake: Callable[[], None],
    ) -> None:
        self.model = model
        self.coming = ""  #: path of a catalogue that is being opened
        self.opened: OpenCatalogue | None = None
        self.asked = Asked()
        self.found: Found | None = None  #: the last good result
        self.fault: QueryError | None = None  #: of what is typed now
        self.progress = ""  #: of a search that takes a while, in words
        self.held = False  #: whether a menu or a drag is on the tiles, which then keep their order
        self.to_top = False  #: whether the tiles that show next begin with the first
        self.selected = ""  #: path of the item that was chosen last
        self.dragged: Hit | None = None
        self.tile_em = TILE_EM
        self.changed = False  #: whether the catalogue was built again since it was read
        self.remembered = ""  #: folder of the last session's catalogue, until it is asked for
        self.thumbnails = Thumbnails()
        self._open_path, self._save_pair, self._wake = open_path, save_pair, wake
        self._search: Worker[tuple[OpenCatalogue, Asked], Found | QueryError] = Worker(wake)
        self._refine: Worker[tuple[OpenCatalogue, Asked], Found] = Worker(wake)
        self._drawing: ExactSearch | None = None
        self._refined: Found | None = None  #: an exact result, until nothing holds the tiles
        self._decode: Worker[tuple[OpenCatalogue, tuple[str, ...]], _Pictures] = Worker(wake)
        self._poll = Poll(wake)
        self._answered: Asked | None = None  #: the last query that has an answer

    # --- the actions --------------------------------------------------------------------------

    def open(self, path: str) -> None:
        """Open a catalogue in the background, or the present one again."""
        self.remembered, self.coming = "", os.path.abspath(path)
        self._open_path(path)

    def note_opened(self, path: str) -> None:
        """A file was opened, or could not be."""
        if path == self.coming:
            self.coming = ""

    def take(self, opened: OpenCatalogue) -> None:
        """Show a catalogue that was read. Of the same folder, the query stays."""
        same = self.opened is not None and self.opened.folder == opened.folder
        self.opened, self.changed, self.remembered = opened, False, ""
        if not same:
            self.asked, self.selected = Asked(), ""
        self.found, self.fault, self._answered, self.dragged = None, None, None, None
        self._stop_drawing()
        self.thumbnails.release()
        self.model.wanted_panel = PANEL
        self.model.report(opened_words(opened))

    def remember(self, folder: str) -> None:
        """Note the folder of the last session's catalogue; the panel opens it when it shows."""
        if self.opened is None:
            self.remembered = folder

    def reload(self) -> None:
        """Read the open catalogue again."""
        if self.opened is not None:
            self.open(self.opened.folder)

    @property
    def folder(self) -> str:
        """Folder of the open catalogue, or of the last session's; empty without one."""
        return self.remembered if self.opened is None else self.opened.folder

    def ask(self, text: str | None = None, sort: str | None = None) -> None:
        """Search for something else; a fault is shown at once, and the last result stays."""
        before = self.asked
        self.asked = Asked(
            before.text if text is None else text, before.sort if sort is None else sort
        )
        self.fault = None
        if self.asked != before:
            if self.refining:
                self._answered = None  # whoever comes back to it wants the exact order
            self._stop_drawing()
        try:
            _ = self.asked.query
        except QueryError as error:
            self.fault = error

    def ask_nearest(self, hit: Hit) -> None:
        """Search for what looks most like an item, nearest first."""
        self.ask(nearest_query(hit.row), "as found")

    def set(self, side: str, hit: Hit) -> None:
        """Make an item's material the sample of a side, matched; of a pack, its active finish's."""
        if self.opened is None:
            return
        if not is_done(hit.row):
            fault = fault_of(hit.row, 200)
            self.model.report(f"{title_of(hit.row)}: {fault}", fault=True)
            return
        file = self.material_file(hit)
        if file is None:
            return
        finish = self.model.active_finish(side)
        self.selected = hit.path
        self._open_path(str(file), side, "" if finish is None else finish.name)

    def material_file(self, hit: Hit) -> Path | None:
        """The material file of an item; None, with a line that says why, where it is not there."""
        if self.opened is None:
            return None
        try:
            file = self.opened.material_file(hit.path)
        except RelglossError as error:
            self.model.report(str(error), fault=True)
            return None
        if not file.is_file():
            place = printable(str(file), 200)
            fault = f"{place}: the material file is gone; build the catalogue again"
            self.model.report(fault, fault=True)
            return None
        return file

    def write_proof(self, hit: Hit) -> None:
        """Show the window that writes a proof of an item, beside the reference of the search."""
        if self.opened is not None and self.found is not None and self.material_file(hit):
            self._save_pair(proof_of(self.opened, self.found, hit))

    def copy(self, hit: Hit, words: Callable[[Path], str]) -> None:
        """Put something about an item's material file on the clipboard, and report it."""
        file = self.material_file(hit)
        if file is not None:
            imgui.set_clipboard_text(words(file))
            self.model.report(f"copied: {words(file)}")

    def drop(self, side: str) -> None:
        """Let go of the dragged item over the picture of a side."""
        hit, self.dragged = self.dragged, None
        if hit is not None:
            self.set(side, hit)

    def copy_fault(self, hit: Hit) -> None:
        """Put a failed item's file and its fault on the clipboard."""
        imgui.set_clipboard_text(f"{hit.path}: {fault_of(hit.row, LONGEST_COPY)}")
        self.model.report(f"copied: the fault of {title_of(hit.row)}")

    @property
    def searching(self) -> bool:
        """Whether the shown result is not yet that of the query."""
        return self.opened is not None and self.fault is None and self._answered != self.asked

    @property
    def refining(self) -> bool:
        """Whether the order is that of thumbnails, while the nearest pictures are drawn anew."""
        return self._drawing is not None or self._refined is not None

    # --- in every frame -----------------------------------------------------------------------

    def shown(self) -> None:
        """The panel is being drawn: the catalogue of the last session is wanted now."""
        if self.opened is None and self.remembered:
            self.open(self.remembered)

    def each_frame(self) -> None:
        """Take what has ended, and begin what the panel has asked for."""
        self._take_found()
        self._take_refined()
        self._take_pictures()
        opened = self.opened
        if opened is None:
            return
        if self.searching and not self._search.busy:
            asked, self.progress = self.asked, ""
            self._search.start((opened, asked), lambda: searched(opened, asked, self._report))
        if not self._decode.busy and (wanted := self.thumbnails.take_wanted()):
            some = tuple(dict.fromkeys(wanted))[:AT_ONCE]
            self._decode.start((opened, some), lambda: decoded_thumbnails(opened.catalogue, some))
        self._look_for_changes(opened)

    def upload(self, ctx: Any) -> None:
        """Put pictures that have come on the device; the window's thread does it."""
        self.thumbnails.upload(ctx)

    def due_s(self) -> float | None:
        """Seconds until a frame is needed without an event; None for no need of one."""
        busy = self.thumbnails.waiting or self._search.busy or self._decode.busy or self.refining
        return TICK_S if self.opened is not None and busy else None

    def _report(self, share: float, text: str) -> None:
        """How far the search is, from its thread."""
        self.progress = f"{text} {100.0 * share:.0f} %"

    def close(self) -> None:
        """Free what is on the device and stop looking; the window is about to close."""
        self._poll.close()
        self._stop_drawing()
        self.thumbnails.release()

    def _take_found(self) -> None:
        ended = self._search.take()
        if ended is None or ended.key[0] is not self.opened:
            return
        asked = ended.key[1]
        self._answered = asked
        if isinstance(ended.value, QueryError):
            if asked == self.asked:
                self.fault = ended.value
        elif ended.value is None:
            self.model.report(ended.fault, fault=True)
        else:
            self.found, self.to_top = ended.value, True
            if not ended.value.is_exact and asked == self.asked:
                self._draw_anew(ended.key[0], asked, ended.value)

    def _draw_anew(self, opened: OpenCatalogue, asked: Asked, preliminary: Found) -> None:
        """Begin the search whose nearest pictures are drawn anew."""
        self._stop_drawing()
        self.progress = ""
        try:
            self._drawing = drawing = ExactSearch(opened, asked.query)
        except RelglossError as error:
            self.model.report(str(error), fault=True)
            return

        def report(share: float, _: str) -> None:
            self.progress = f"{100.0 * share:.0f} %"

        self._refine = Worker(self._wake)  # what was stopped may still be ending
        self._refine.start((opened, asked), lambda: drawing.run(preliminary, report))

    def _stop_drawing(self) -> None:
        if self._drawing is not None:
            self._drawing.stop()
        self._drawing = self._refined = None

    def _take_refined(self) -> None:
        """Show the exact order, once no menu and no drag is on the tiles, which would move."""
        ended = self._refine.take()
        if ended is not None and self._drawing is not None:
            self._drawing, self._refined = None, ended.value
            if ended.value is None:
                self.model.report(ended.fault, fault=True)
        held, self.held = self.held, False
        if self._refined is not None and not held:
            self.found, self._refined = self._refined, None

    def _take_pictures(self) -> None:
        ended = self._decode.take()
        if ended is None or ended.key[0] is not self.opened:
            return
        pictures = ended.value
        if pictures is None:
            self.model.report_once(ended.fault, fault=True)
            pictures = dict.fromkeys(ended.key[1])
        self.thumbnails.give(pictures)

    def _look_for_changes(self, opened: OpenCatalogue) -> None:
        table = os.path.join(opened.folder, TABLE_FILE)
        self._poll.watch((table,))
        whole = self._poll.whole(table)
        if whole is not None and whole != opened.stamp and not self.changed:
            self.changed = True
            self.model.report(f"the catalogue {opened.name} was built again: Reload shows it")
