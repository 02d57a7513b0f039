"""Plates that become finishes, or inks again: their artwork is read anew in the background."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass

from relgloss_view.base.reading import printable
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.finish_plates import plates_of_finishes, with_right_plates
from relgloss_view.pack.pack import Pack
from relgloss_view.viewer.files.background import Worker
from relgloss_view.viewer.state import packs
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import SIDES


@dataclass(frozen=True)
class _Reading:
    """An artwork to read again, and the plates that print no colour in it then."""

    artwork: Artwork
    plates: frozenset[str]


class PlateColours:
    """Takes the colour of plates that finishes name out of the artwork, and puts it back.

    Call `each_frame` in every frame.
    """

    def __init__(self, model: Model, wake: Callable[[], None]) -> None:
        self._model = model
        self._worker: Worker[_Reading, Pack] = Worker(wake)
        self._tried: set[tuple[str, tuple[int, int], frozenset[str]]] = set()  #: in vain

    def each_frame(self) -> None:
        """Take what was read; begin to read what the present finishes need."""
        ended = self._worker.take()
        if ended is not None:
            self._take(ended.key, ended.value, ended.fault)
        if self._worker.busy:
            return
        for side in SIDES:
            pack = packs.pack_of(self._model.state, side)
            wanted = None if pack is None else _wanted(pack)
            if pack is not None and wanted is not None and _mark(wanted) not in self._tried:
                self._begin(wanted, pack)
                return

    def _begin(self, wanted: _Reading, pack: Pack) -> None:
        self._model.report(f"The artwork is read again, {_changed(wanted)}")
        self._worker.start(wanted, lambda: _read(pack))

    def _take(self, wanted: _Reading, made: Pack | None, fault: str) -> None:
        model = self._model
        if made is None or made.artwork is None or made.artwork.finish_plates != wanted.plates:
            self._tried.add(_mark(wanted))
            if fault:
                model.report(f"The artwork keeps its colours: {fault}", fault=True)
            return
        artwork = made.artwork

        def change(pack: Pack) -> Pack:
            # Steps of undo whose finishes name other plates keep the artwork that they have.
            if _wanted(pack) != wanted:
                return pack
            return dataclasses.replace(pack, artwork=artwork)

        model.history.amend_all(lambda state: packs.with_everywhere(state, change))
        model.report(f"The artwork is shown {_changed(wanted)}")


def _wanted(pack: Pack) -> _Reading | None:
    """What must be read for a pack's finishes; None where its artwork is right."""
    artwork = pack.artwork
    if artwork is None or not artwork.file:
        return None
    plates = plates_of_finishes(artwork, pack.finishes)
    return None if plates == artwork.finish_plates else _Reading(artwork, plates)


def _mark(wanted: _Reading) -> tuple[str, tuple[int, int], frozenset[str]]:
    return wanted.artwork.file, wanted.artwork.stamp, wanted.plates


def _changed(wanted: _Reading) -> str:
    """What the artwork that was asked for differs in, in words."""
    before = wanted.artwork.finish_plates
    texts = [
        f"{kind} of {printable(', '.join(sorted(names)), 80)}"
        for names, kind in (
            (wanted.plates - before, "without the colour"),
            (before - wanted.plates, "with the colour"),
        )
        if names
    ]
    return " and ".join(texts)


def _read(pack: Pack) -> Pack:
    from relgloss_view.pack.layers import layers_of

    made = with_right_plates(pack)
    layers_of(made)
    return made
