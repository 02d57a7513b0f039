"""A State as a scene file: what `relgloss snapshot --scene` draws, and the reference beside it."""

from __future__ import annotations

import os
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.toml import build_part, entries
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.scene_file import SceneFile, read_scene_file
from relgloss_view.picture.scene.scene_writer import write_scene_file
from relgloss_view.viewer.state.state import Presentation, Side, State


def load_state(path: str | os.PathLike[str], stood_in: list[str] | None = None) -> State:
    """The state that a scene file holds; InputError names the file and the entry.

    A file without [reference] gets the initial state's, at the quality of the file's look. With a
    list `stood_in`, materials and lamps that are gone are replaced by those of the initial state,
    and the list gets a message of each.
    """
    content = read_scene_file(Path(path).absolute(), stood_in)
    try:
        presentation = build_part(Presentation, "presentation", dict(content.presentation))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    sample, look = content.reference, content.reference_look
    if sample is None or look is None:
        initial = State.initial().reference
        sample = initial.sample if sample is None else sample
        if look is None:
            look = initial.look.with_entries(quality=content.look.quality)
    setup = content.setup
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
    content = SceneFile(
        state.test.sample,
        state.test.look,
        state.setup,
        state.reference.sample,
        state.reference.look,
        entries(state.presentation),
        state.match,
        state.setup.shape if state.test.sample.pack is not None else None,
    )
    write_scene_file(path, content, forgiving=forgiving)
