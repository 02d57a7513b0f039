"""What the first picture of a state needs beside the device, made beforehand in a thread.

The triangles of a form, the layers of an artwork, tables of ambient light and the place of the
highlight are kept by those who make them. Made before a state is shown, they don't hold up the
window.
"""

from __future__ import annotations

import contextlib

import numpy as np

from relgloss_view.base.errors import RelglossError
from relgloss_view.material.albedo_table import ambient_reflection
from relgloss_view.pack.layers import layers_of
from relgloss_view.picture.model.highlight import best_mirror, each_lamp
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.viewer.drawing.arrangement import as_shown
from relgloss_view.viewer.state.state import SIDES, State


def prepare(state: State, size: Size, pixel_pitch_m: float | None) -> None:
    """Make what pictures of a state at a size need. What can't be made is reported when drawn."""
    shown = state
    with contextlib.suppress(RelglossError):
        shown = as_shown(state, size, pixel_pitch_m)
    for side in SIDES:
        with contextlib.suppress(RelglossError):
            _prepare_scene(shown.scene(side), size)


def _prepare_scene(scene: Scene, size: Size) -> None:
    materials = [scene.material]
    if scene.pack is not None:
        layers_of(scene.pack)
        materials = [finish.material for finish in scene.pack.finishes]
    if scene.lamp.ambient > 0.0:
        for material in materials:
            ambient_reflection(material, np.ones(1), np.ones(1))
    for by_itself in each_lamp(scene.setup):
        best_mirror(by_itself, size)
