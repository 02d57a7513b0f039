"""Small pictures of the dullest and the glossiest material that readings allow.

They are drawn at the setting of their side and with its factor, so that they compare with the large
picture of the likeliest one; again only where something of it has changed.
"""

from __future__ import annotations

import numpy as np

from relgloss_view.material.material import Material
from relgloss_view.picture.model.view import Size, View
from relgloss_view.viewer.drawing.pair_renderer import PairRenderer
from relgloss_view.viewer.plots.lightness import Lightness
from relgloss_view.viewer.state.model import GhostPicture
from relgloss_view.viewer.state.state import State

MOST_PIXELS = 30_000  #: of a small picture


class GhostPictures:
    """The last small pictures, by name."""

    def __init__(self) -> None:
        self._last: dict[str, tuple[object, GhostPicture]] = {}

    def of(
        self,
        renderer: PairRenderer,
        state: State,
        side: str,
        materials: dict[str, Material],
        full: Size,
        factor: float,
    ) -> dict[str, GhostPicture]:
        """The pictures of materials by name, in the proportions of the full one.

        state: as it is shown, with the eye of the full picture. Raises RelglossError.
        """
        size = small_size(full)
        kept = {}
        for name, material in materials.items():
            key = material, state.setup, state.side(side).look, size, factor
            last = self._last.get(name)
            if last is None or last[0] != key:
                last = key, _drawn(renderer, state, side, name, material, size, factor)
            kept[name] = last
        self._last = kept
        return {name: picture for name, (_, picture) in kept.items()}


def small_size(full: Size) -> Size:
    """A size of the same proportions with about MOST_PIXELS, or the full one."""
    scale = min(1.0, (MOST_PIXELS / (full[0] * full[1])) ** 0.5)
    return max(1, round(full[0] * scale)), max(1, round(full[1] * scale))


def _drawn(
    renderer: PairRenderer,
    state: State,
    side: str,
    name: str,
    material: Material,
    size: Size,
    factor: float,
) -> GhostPicture:
    frame = renderer.small(state, side, material, size, factor)
    digital = np.array(frame.display)
    lightness = Lightness.of(frame)
    left, bottom, right, top = View.of(frame.scene, size).bounds
    box = (left / size[0], bottom / size[1], right / size[0], top / size[1])
    return GhostPicture(renderer.uploads.texture(f"ghost {name}", digital), size, box, lightness)
