"""Scenes that open anywhere: what is in no file of the user's own is saved beside the scene."""

from __future__ import annotations

import contextlib
import dataclasses
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.material.spectra import is_lamp_name
from relgloss_view.pack.built_in import FINISHES
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.pack_file import files_of
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.viewer.files.own_materials import keep_beside
from relgloss_view.viewer.state import packs
from relgloss_view.viewer.state.places import data_folder
from relgloss_view.viewer.state.state import SIDES, State
from relgloss_view.viewer.state.state_file import save_state


@dataclass(frozen=True)
class SavedScene:
    """The files of a scene that was saved.

    beside: those that it needs and that lie beside it now. elsewhere: the user's own files in other
    folders, which it names by their full paths, so that another computer needs them there too.
    """

    path: Path
    beside: tuple[Path, ...]
    elsewhere: tuple[Path, ...]

    @property
    def words(self) -> str:
        """A message for the status line."""
        names = " and ".join(file.name for file in (self.path, *self.beside))
        text = f"saved {names} to {self.path.parent}"
        if self.elsewhere:
            others = ", ".join(str(file) for file in self.elsewhere)
            text += f"; to open it on another computer, copy these too: {others}"
        return text


def save_scene(path: str | os.PathLike[str], state: State) -> SavedScene:
    """Save a state as a scene file, and beside it the samples that no other computer has.

    Those are samples in no file (made by the slider of a gloss reading), and samples whose file is
    in the program's own folder (fitted in the window) or gone. Their files are never written over
    others. InputError where something can't be written; then no new file is left.
    """
    scene = Path(path).absolute()
    written: list[Path] = []
    beside: list[Path] = []
    portable = state
    try:

        def kept(sample: Sample) -> str:
            """The file of a sample beside the scene."""
            file, new = keep_beside(sample.own_material, scene)
            written.extend([file] if new else [])
            beside.extend([] if file in beside else [file])
            return str(file)

        for side in SIDES:
            sample = state.side(side).sample
            if sample.pack is not None:
                portable = packs.with_pack(portable, side, _with_files(sample.pack, kept))
            elif not _is_portable(sample):
                sample = dataclasses.replace(sample, file=kept(sample))
                portable = portable.with_sample(side, sample)
        save_state(scene, portable)
    except BaseException:
        for file in written:
            with contextlib.suppress(OSError):
                file.unlink()
        raise
    return SavedScene(scene, tuple(beside), _elsewhere(portable, scene.parent))


def _with_files(pack: Pack, kept: Callable[[Sample], str]) -> Pack:
    """A pack whose finishes all have a material that another computer can have."""
    for one in pack.finishes:
        if one.source not in FINISHES and not _is_portable(packs.sample_of(one)):
            pack = pack.with_finish(one.name, source=kept(packs.sample_of(one)))
    return pack


def _is_portable(sample: Sample) -> bool:
    """Whether a sample is built in, or in a file of the user's own."""
    if sample.name is not None:
        return True
    return sample.file is not None and os.path.isfile(sample.file) and not _is_private(sample.file)


def _is_private(file: str) -> bool:
    """Whether a file is in the folder of the program's own data."""
    try:
        folder = data_folder()
    except InputError:  # there is no home folder, so nothing is in it
        return False
    return Path(file).resolve().is_relative_to(folder.resolve())


def _elsewhere(state: State, folder: Path) -> tuple[Path, ...]:
    """The files that a state needs and that are not under a folder, each once."""
    files = [state.side(side).sample.file for side in SIDES]
    for side in SIDES:
        pack = packs.pack_of(state, side)
        if pack is not None:
            files += [*files_of(pack), pack.shape.file or None]
            files += [packs.sample_of(one).file for one in pack.finishes]
    lamp = state.setup.lamp.illuminant
    files += [] if is_lamp_name(lamp) else [lamp]
    files += [state.setup.shape.file] if state.setup.shape.file else []
    paths = [Path(file).absolute() for file in files if file is not None]
    return tuple(dict.fromkeys(path for path in paths if not path.is_relative_to(folder)))
