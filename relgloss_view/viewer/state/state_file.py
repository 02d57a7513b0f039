"""A State as a scene file: what `relgloss snapshot --scene` draws, and the reference beside it."""

from __future__ import annotations

import dataclasses
import os
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.base.toml import build_part, entries
from relgloss_view.display.display import Display
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.scene_file import SceneFile, display_beside, read_scene_file
from relgloss_view.picture.scene.scene_writer import write_scene_file
from relgloss_view.viewer.state.state import SIDES, Presentation, Side, State

PLACES = {"reference": "reference", "test": "sample"}  #: of the sides in a scene file


def load_state(
    path: str | os.PathLike[str],
    stood_in: list[str] | None = None,
    *,
    progress: ProgressReport = no_progress,
    later: dict[str, str] | None = None,
) -> State:
    """The state that a scene file holds; InputError names the file and the entry.

    A file without [reference] gets the initial state's, at the quality of the file's look. With a
    list `stood_in`, materials and lamps that are gone are replaced by those of the initial state,
    and the list gets a message of each. progress: of reading packs. later: a dictionary that gets
    the names of packs by side, which are not read; the initial state's samples take their places.
    """
    found: dict[str, str] | None = None if later is None else {}
    content = read_scene_file(Path(path).absolute(), stood_in, progress=progress, later=found)
    if later is not None and found:
        later |= {side: found[place] for side, place in PLACES.items() if place in found}
    try:
        presentation = build_part(Presentation, "presentation", dict(content.presentation))
        presentation = _seen_beside(presentation, Path(path).absolute().parent, stood_in)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    setup = content.setup
    if declared := setup.display.seen_on:  # the state has it by side
        setup = setup.with_entries("display", seen_on="")
        if not any(presentation.seen_on(side) for side in SIDES):
            presentation = _seen_on(presentation, dict.fromkeys(SIDES, declared))
    sample, look = content.reference, content.reference_look
    if sample is None or look is None:
        initial = State.initial().reference
        sample = initial.sample if sample is None else sample
        if look is None:
            look = initial.look.with_entries(quality=content.look.quality)
    if content.sample.pack is not None:  # the setup's form is the reference's
        setup = setup.placed(shape=content.reference_shape or Shape())
    return State(
        Side(sample, look),
        Side(content.sample, content.look),
        setup,
        presentation,
        content.match,
    )


def save_state(path: str | os.PathLike[str], state: State, *, forgiving: bool = False) -> None:
    """Write a state as a scene file, whole or not at all; load_state gives it back exactly.

    InputError where the place can't be written, or a sample is in no file or its file is gone; when
    forgiving, such a sample is no fault, and load_state with `stood_in` replaces it.
    """
    folder, presentation = Path(path).absolute().parent, state.presentation
    seen_on = {side: presentation.seen_on(side) for side in SIDES}
    written = {side: _from(folder, file) for side, file in seen_on.items() if file}
    content = SceneFile(
        state.test.sample,
        state.test.look,
        state.setup.with_entries("display", seen_on=seen_on["test"]),  # as the file's picture is
        state.reference.sample,
        state.reference.look,
        entries(_seen_on(presentation, written)),
        state.match,
        state.setup.shape if state.test.sample.pack is not None else None,
    )
    write_scene_file(path, content, forgiving=forgiving)


def _seen_on(presentation: Presentation, files: dict[str, str]) -> Presentation:
    """The presentation with sides that are seen on other displays."""
    changed: dict[str, Any] = {f"{side}_seen_on": file for side, file in files.items()}
    return dataclasses.replace(presentation, **changed)


def _seen_beside(
    presentation: Presentation, folder: Path, stood_in: list[str] | None
) -> Presentation:
    """The presentation with its files in the scene's folder; InputError, or a message of each."""
    files = {side: presentation.seen_on(side) for side in SIDES}
    found = {
        side: display_beside(Display(seen_on=file), folder, stood_in).seen_on
        for side, file in files.items()
        if file
    }
    return _seen_on(presentation, found)


def _from(folder: Path, file: str) -> str:
    """A file's name as the scene file has it: relative where it lies under its folder."""
    path = Path(file).absolute()
    inside = path.relative_to(folder) if path.is_relative_to(folder) else path
    return str(path) if ".." in inside.parts else inside.as_posix()
