"""Files of the window's packs that another program edits: noticed, and read in the background.

What was set in the window stays: only what the file has changed is taken. A file that can't be
read, as one that is half written, leaves the last good one in the picture, with a message.
"""

from __future__ import annotations

import dataclasses
import os
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.reading import printable
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.pack_file import beside, files_of
from relgloss_view.viewer.files.background import Worker
from relgloss_view.viewer.state import packs
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import SIDES

POLL_S = 1.0  #: between looks at the files; a stamp that two looks agree on is that of a whole file
Stamp = tuple[int, int]  #: time of the last change in ns, and bytes


def stamp_of(path: str) -> Stamp | None:
    """The stamp of a file; None where there is none, as while a program replaces it."""
    try:
        state = os.stat(path)
    except (OSError, ValueError):
        return None
    return state.st_mtime_ns, state.st_size


class Poll:
    """Looks at files once in POLL_S in a thread, and wakes the window where one has changed."""

    def __init__(self, wake: Callable[[], None]) -> None:
        self._wake = wake
        self._files: tuple[str, ...] = ()
        self._last: dict[str, Stamp | None] = {}
        self._whole: dict[str, Stamp] = {}
        self._over = threading.Event()
        self._thread: threading.Thread | None = None

    def watch(self, files: tuple[str, ...]) -> None:
        """Look at these files from now on."""
        self._files = files
        if files and self._thread is None and not self._over.is_set():
            self._thread = threading.Thread(target=self._run, name="watch", daemon=True)
            self._thread.start()

    def whole(self, path: str) -> Stamp | None:
        """The stamp of a file as it was at two looks; None before that."""
        return self._whole.get(path)

    def look(self) -> bool:
        """Look at every file; returns whether one of them has another stamp, and keeps it."""
        changed = False
        for path in self._files:
            stamp = stamp_of(path)
            if stamp is not None and stamp == self._last.get(path, ()):
                changed = changed or self._whole.get(path) != stamp
                self._whole[path] = stamp
            self._last[path] = stamp
        return changed

    def close(self) -> None:
        """Stop looking."""
        self._over.set()

    def _run(self) -> None:
        while not self._over.wait(POLL_S):
            if self.look():
                self._wake()


@dataclass(frozen=True)
class _Reload:
    """A file to read again, and what it is read for."""

    path: str
    stamp: Stamp
    masks: tuple[str, ...]  #: of the finishes, on which depends whether a new artwork serves


class PackWatch:
    """Brings packs up to date with their files. Call `each_frame` in every frame."""

    def __init__(self, model: Model, wake: Callable[[], None]) -> None:
        self._model = model
        self.poll = Poll(wake)
        self._worker: Worker[_Reload, Pack] = Worker(wake)
        self._known: dict[str, Stamp] = {}  #: of files as they are in the packs
        self._tried: dict[str, _Reload] = {}  #: of files that could not be read
        self._as_read: dict[str, Pack] = {}  #: packs as their files held them, by file

    def note_read(self, pack: Pack) -> None:
        """Note a pack as its file holds it, before anything in it is set in the window."""
        if pack.file:
            self._as_read[pack.file] = pack
            self._known.pop(pack.file, None)

    def each_frame(self) -> None:
        """Take what was read again; begin to read what has changed, one file at a time."""
        state = self._model.state
        present = [pack for side in SIDES if (pack := packs.pack_of(state, side)) is not None]
        files = tuple(dict.fromkeys(file for pack in present for file in files_of(pack)))
        self.poll.watch(files)
        ended = self._worker.take()
        if ended is not None:
            self._take(ended.key, ended.value, ended.fault)
        if self._worker.busy:
            return
        for pack in present:
            for path in files_of(pack):
                if self._is_due(pack, path):
                    return

    def close(self) -> None:
        """Stop watching."""
        self.poll.close()

    def _is_due(self, pack: Pack, path: str) -> bool:
        """Begin to read a file again where it has changed since it was read."""
        whole = self.poll.whole(path)
        if whole is None:
            return False
        artwork = pack.artwork
        if artwork is not None and path == artwork.file and artwork.stamp != (0, 0):
            known = artwork.stamp
        else:
            known = self._known.setdefault(path, whole)
        masks = tuple(finish.mask for finish in pack.finishes)
        wanted = _Reload(path, whole, masks)
        if whole == known or self._tried.get(path) == wanted:
            return False
        before = self._as_read.get(path, pack)
        self._worker.start(wanted, lambda: read_again(pack, path, before))
        return True

    def _take(self, wanted: _Reload, pack: Pack | None, fault: str) -> None:
        model, name = self._model, printable(Path(wanted.path).name, 80)
        if pack is None:
            self._tried[wanted.path] = wanted
            model.report(f"{name} has changed, and the last good one stays: {fault}", fault=True)
            return
        self._tried.pop(wanted.path, None)
        self._known[wanted.path] = wanted.stamp
        before = self._as_read.get(wanted.path)
        change = _change(wanted.path, pack, before)
        model.history.amend_all(lambda state: packs.with_everywhere(state, change))
        if pack.file == wanted.path:
            self._as_read[wanted.path] = pack
        model.report(f"{name} has changed and was read again")


def read_again(pack: Pack, path: str, before: Pack) -> Pack:
    """A pack whose parts of one file are as the file has them now.

    Of its pack file the whole pack as the file has it; of others the pack with a new artwork or
    mask. before: the pack as its file held it. Raises InputError where the file can't be read, or
    what it holds does not serve the pack's finishes.
    """
    from relgloss_view.pack.finish_plates import how_read
    from relgloss_view.pack.layers import layers_of
    from relgloss_view.pack.mask_file import read_mask
    from relgloss_view.pack.masks import check_masks
    from relgloss_view.pack.pack_file import open_artwork, read_pack

    if path == pack.file:
        made = read_pack(path)
        layers_of(merged(before, made, pack))
        return made
    if pack.artwork is not None and path == pack.artwork.file:
        artwork = open_artwork(Path(path), how_read(pack), Path())
        made = dataclasses.replace(pack, artwork=artwork)
    elif path == pack.shape.file:  # whoever draws the form takes its mesh from the file
        made = pack
    else:
        names = [name for name in pack.masks if beside(pack, name) == path]
        masks = {**pack.masks, **dict.fromkeys(names, read_mask(path))}
        made = dataclasses.replace(pack, masks=masks)
    check_masks(made)
    layers_of(made)
    return made


def _change(path: str, made: Pack, before: Pack | None) -> Callable[[Pack], Pack]:
    """What brings any pack of the history up to date with a file that was read again."""

    def change(pack: Pack) -> Pack:
        if path == pack.file:
            return merged(before or pack, made, pack)
        if pack.artwork is not None and path == pack.artwork.file:
            return dataclasses.replace(pack, artwork=made.artwork)
        names = [name for name in pack.masks if beside(pack, name) == path]
        if not names:
            return pack
        return dataclasses.replace(pack, masks=_with(pack.masks, made.masks, names))

    return change


def _with(
    masks: Mapping[str, Bytes], others: Mapping[str, Bytes], names: list[str]
) -> dict[str, Bytes]:
    return {**masks, **{name: others[name] for name in names if name in others}}


def merged(before: Pack, file: Pack, window: Pack) -> Pack:
    """A pack with what its file has changed, and with what was set in the window.

    before: as the file held it. file: as it holds it now. window: as it is in the window, which
    wins where both have changed an entry.
    """
    parts = ("name", "shape", "placement", "colour", "measured")
    changed: dict[str, Any] = {name: _kept(before, file, window, name) for name in parts}
    if _source(window) != _source(before):
        changed |= {name: getattr(window, name) for name in ("artwork", "artwork_file")}
        changed["artwork_entries"] = window.artwork_entries
    of_before, of_window = ({one.name: one for one in p.finishes} for p in (before, window))
    finishes = [
        _merged_finish(of_before.get(one.name), one, of_window.get(one.name))
        for one in file.finishes
        if one.name in of_window or one.name not in of_before
    ]
    names = {one.name for one in file.finishes}
    finishes += [
        one for one in window.finishes if one.name not in of_before and one.name not in names
    ]
    masks = {**window.masks, **file.masks}
    return dataclasses.replace(
        file, **changed, finishes=tuple(finishes) or file.finishes, masks=masks
    )


def _merged_finish(before: Finish | None, file: Finish, window: Finish | None) -> Finish:
    if before is None or window is None:
        return file
    names = [field.name for field in dataclasses.fields(Finish)]
    return Finish(**{name: _kept(before, file, window, name) for name in names})


def _kept(before: object, file: object, window: object, name: str) -> Any:
    own = getattr(window, name)
    return own if own != getattr(before, name) else getattr(file, name)


def _source(pack: Pack) -> str:
    return "" if pack.artwork is None else pack.artwork.file


class MaskReader:
    """Reads mask pictures for finishes in a thread, one at a time."""

    def __init__(self, model: Model, wake: Callable[[], None]) -> None:
        self._model = model
        self._worker: Worker[tuple[str, str, str], Bytes] = Worker(wake)
        self._waiting: list[tuple[str, str, str]] = []

    def read(self, path: str, side: str, finish: str) -> None:
        """Read a picture, and make it the mask of a finish of a side's pack."""
        self._waiting.append((os.path.abspath(path), side, finish))

    def each_frame(self) -> None:
        """Take what was read, and begin the next."""
        ended = self._worker.take()
        if ended is not None:
            (path, side, finish), mask = ended.key, ended.value
            if mask is None:
                self._model.report(ended.fault, fault=True)
            else:
                self._model.attempt(lambda: self._put(path, side, finish, mask))
        if self._waiting and not self._worker.busy:
            from relgloss_view.pack.mask_file import read_mask

            key = self._waiting.pop(0)
            self._worker.start(key, lambda: read_mask(key[0]))

    @property
    def busy(self) -> bool:
        """Whether one is read or waits."""
        return bool(self._waiting) or self._worker.busy

    def _put(self, path: str, side: str, finish: str, mask: Bytes) -> None:
        pack = self._model.pack(side)
        if pack is None:
            return
        pack = dataclasses.replace(pack, masks={**pack.masks, path: mask})
        self._model.set_pack(side, pack.with_finish(finish, mask=path))
        name = printable(Path(path).name, 80)
        self._model.report(f"{name} shows where the finish {finish} lies")
