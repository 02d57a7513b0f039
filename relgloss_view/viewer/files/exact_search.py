"""A search whose nearest pictures are drawn anew, in a process of its own.

It is the search that `relgloss catalogue search` makes, so both give one order. Fifty pictures take
a second of a processor, and need an OpenGL context: the window's own draws meanwhile.
"""

from __future__ import annotations

import dataclasses
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import ProgressReport
from relgloss_view.catalogue.columns import TABLE_FILE
from relgloss_view.viewer.files.answering import Answering, answered
from relgloss_view.viewer.files.pack_edits import stamp_of
from relgloss_view.viewer.state.catalogues import OpenCatalogue

if TYPE_CHECKING:
    from relgloss_view.catalogue.query.found import Found


@dataclass(frozen=True)
class Exact:
    """What the process gives: places of the hits among the rows, in order, and their numbers."""

    rows: tuple[int, ...]
    numbers: tuple[dict[str, float], ...]
    notes: tuple[str, ...]


class ExactSearch(Answering):
    """Searches one catalogue. Begins at once; InputError where no process can be made."""

    def __init__(self, opened: OpenCatalogue, query: str) -> None:
        self._opened = opened
        name = printable(opened.folder, 200)
        super().__init__(
            __name__, opened.folder, repr(opened.stamp), query,
            fault=f"{name}: no process can be made that draws its pictures",
        )  # fmt: skip

    def run(self, preliminary: Found, progress: ProgressReport) -> Found:
        """Wait for the result, in the place of that of thumbnails. Raises InputError."""
        from relgloss_view.catalogue.query.found import Hit

        ended = (
            f"{printable(self._opened.folder, 200)}: drawing its pictures ended before it was "
            "done; there may not be enough memory: close other programs"
        )
        exact: Exact = self.outcome(progress, ended)
        rows = self._opened.catalogue.rows
        hits = tuple(
            Hit(rows[k], rank, numbers)
            for rank, (k, numbers) in enumerate(zip(exact.rows, exact.numbers, strict=True), 1)
        )
        return dataclasses.replace(
            preliminary, hits=hits, total=len(hits), notes=exact.notes, is_exact=True
        )


def answer(folder: str, stamp: str, query: str) -> None:
    """What the process does: read the catalogue and search it."""
    name = printable(folder, 200)

    def work(progress: ProgressReport) -> Exact:
        from relgloss_view.catalogue.catalogue import Catalogue
        from relgloss_view.catalogue.query.search import search
        from relgloss_view.quality.backends import open_renderer

        catalogue = Catalogue.open(Path(folder))
        # Only now, because a build may replace the table while it is read.
        if repr(stamp_of(os.path.join(folder, TABLE_FILE))) != stamp:
            raise InputError(f"{name}: was built again; Reload it")
        with open_renderer("auto") as renderer:
            found = search(catalogue, query, renderer=renderer, progress=progress)
        places = {str(row["path"]): k for k, row in enumerate(catalogue.rows)}
        return Exact(
            tuple(places[hit.path] for hit in found.hits),
            tuple(dict(hit.numbers) for hit in found.hits),
            found.notes,
        )

    answered(work, name, f"{name}: not enough memory to draw its pictures; close other programs")
