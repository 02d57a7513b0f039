"""Catalogues as files of the window: told apart, read, and looked at for changes.

No OpenGL, no window library: a thread does it. What reads Parquet is imported in that thread.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.catalogue.columns import TABLE_FILE
from relgloss_view.viewer.files.pack_edits import stamp_of
from relgloss_view.viewer.files.proof_writing import OtherPair
from relgloss_view.viewer.state.catalogues import OpenCatalogue
from relgloss_view.viewer.state.state import Side, State

if TYPE_CHECKING:
    from relgloss_view.catalogue.query.found import Found, Hit, Searched

TABLE_SUFFIXES = (".parquet",)
LARGEST_PX = 512  #: of a thumbnail's side; a larger one is made smaller


def catalogue_folder(path: str | os.PathLike[str]) -> str | None:
    """The folder of a catalogue that a path names, itself or by its table; None for others.

    A damaged catalogue is one too: its reader reports the fault.
    """
    from relgloss_view.catalogue.tree import is_catalogue

    path = Path(path)
    if path.name == TABLE_FILE:
        return str(path.absolute().parent)
    try:
        marked = is_catalogue(path)
    except (OSError, InputError):
        marked = False
    return str(path.absolute()) if marked else None


def opened_catalogue(path: str, progress: ProgressReport = no_progress) -> OpenCatalogue:
    """The catalogue of a folder or of its table. InputError, one line, where it can't be read."""
    from relgloss_view.catalogue.catalogue import Catalogue
    from relgloss_view.catalogue.query.search import Searcher

    folder = catalogue_folder(path) or path
    progress(0.0, "reading the catalogue")
    stamp = stamp_of(os.path.join(folder, TABLE_FILE))
    catalogue = Catalogue.open(Path(folder))
    progress(0.7, "sorting it for searches")
    return OpenCatalogue(folder, catalogue, Searcher(catalogue), stamp)


def decoded_thumbnails(catalogue: Searched, paths: Iterable[str]) -> dict[str, Bytes | None]:
    """The pictures of items by path, (H, W, 3); None for an item without a picture."""
    wanted = list(paths)
    pictures = catalogue.thumbnails(wanted)
    return {path: decoded(pictures.get(path)) for path in wanted}


def decoded(png: bytes | None) -> Bytes | None:
    """The pixels of a PNG (H, W, 3); None where there are none or they are damaged."""
    from relgloss_view.catalogue.thumbnail import opened_thumbnail

    image = opened_thumbnail(png)
    if image is None:
        return None
    image.thumbnail((LARGEST_PX, LARGEST_PX))  # a smaller one stays as it is
    return np.asarray(image)


def proof_of(opened: OpenCatalogue, found: Found, hit: Hit) -> OtherPair:
    """The pair that `relgloss catalogue search --proofs` writes for a hit."""
    from relgloss_view.catalogue.proofs import note_of, pair_of

    recipe = opened.catalogue.recipe.reference
    own = recipe if isinstance(recipe, str) else str(recipe.get("name") or "a material of its own")
    words = f"the catalogue's reference, {printable(own, 80)}"
    if found.reference is not None:
        words = f"the reference of your search, {printable(found.reference.words, 120)}"

    def make() -> State:
        pair = pair_of(hit, found, opened.catalogue)
        assert pair.reference is not None
        assert pair.reference_look is not None
        reference, test = Side(pair.reference, pair.reference_look), Side(pair.sample, pair.look)
        return State(reference, test, pair.setup, match=pair.match)

    note = note_of(hit, found) if found.query.text else ""
    sentence = f"The proof shows this sample beside {words}, with their ratio of gloss."
    return OtherPair(hit.name, sentence, note, make)
