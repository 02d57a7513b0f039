"""Tints that show where finishes of a pack lie, as a picture with alpha to lay over the pack's."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from relgloss_view.base.arrays import Bytes
from relgloss_view.picture.model.sight import sight
from relgloss_view.picture.model.surface import surface_of
from relgloss_view.picture.model.view import Size, View
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.viewer.drawing.texture_uploads import TextureUploads
from relgloss_view.viewer.files.background import Worker
from relgloss_view.viewer.state.state import SIDES, State

#: One for each finish of a pack, sRGB: told apart by hue and by lightness (Okabe, Ito 2008).
TINTS = (
    (0.60, 0.60, 0.60),
    (0.90, 0.62, 0.00),
    (0.34, 0.71, 0.91),
    (0.00, 0.62, 0.45),
    (0.94, 0.89, 0.26),
    (0.00, 0.45, 0.70),
    (0.84, 0.37, 0.00),
    (0.80, 0.47, 0.65),
)
ALPHA = 0.65
LARGEST = 320  #: pixels along the longer side of a tint, which is laid over the picture smoothly

Key = tuple[Scene, Size, frozenset[str]]


def tinted(scene: Scene, size: Size, names: frozenset[str]) -> Bytes:
    """Tints of the finishes of these names, (h, w, 4) uint8, alpha not premultiplied.

    It covers the whole picture of a size in pixels with at most LARGEST pixels along a side.
    """
    pack = scene.pack
    assert pack is not None
    scale = min(1.0, LARGEST / max(size))
    width, height = (max(1, round(side * scale)) for side in size)
    # Places of the full picture, so that the tint lies where the picture has the finish.
    columns, rows = np.meshgrid(
        (np.arange(width) + 0.5) * size[0] / width - 0.5,
        (np.arange(height) + 0.5) * size[1] / height - 0.5,
    )
    view = View.of(scene, size)
    seen = sight(scene.shape, view, columns, rows)
    hit = seen.hit
    pixels = np.zeros((height, width, 4))
    if hit.found.any():
        surface = surface_of(pack, view, seen)
        for k, finish in enumerate(pack.finishes):
            if finish.name in names:
                share = np.where(hit.found, surface.specular_shares[..., k], 0.0)[..., None]
                colour = np.array(TINTS[k % len(TINTS)])
                pixels[..., :3] += share * colour
                pixels[..., 3:] += share
    total = np.maximum(pixels[..., 3:], 1e-6)
    pixels[..., :3] /= total
    pixels[..., 3] *= ALPHA
    return np.asarray(np.rint(255.0 * np.clip(pixels, 0.0, 1.0)), dtype=np.uint8)


class MaskTints:
    """The tints of both sides, made in a thread while nothing moves."""

    def __init__(self, wake: Callable[[], None]) -> None:
        self._worker: Worker[tuple[str, Key], Bytes] = Worker(wake)
        self._made: dict[str, tuple[Key, Bytes | None]] = {}

    def textures(
        self,
        state: State,
        size: Size,
        names: frozenset[str],
        uploads: TextureUploads,
        *,
        at_rest: bool,
    ) -> dict[str, int]:
        """Names of textures that hold the tints of finishes, by the side whose picture they are of.

        state: with the eye of the pictures on the screen, whose size is in pixels.
        """
        textures: dict[str, int] = {}
        for side in SIDES if names else ():
            pixels = self.of(side, state.scene(side), size, names, at_rest=at_rest)
            if pixels is not None:
                textures[side] = uploads.texture(f"tint {side}", pixels)
        return textures

    def of(
        self, side: str, scene: Scene, size: Size, names: frozenset[str], *, at_rest: bool
    ) -> Bytes | None:
        """The tint of a side's picture; None until it is made. Call it in every frame."""
        ended = self._worker.take()
        if ended is not None:
            self._made[ended.key[0]] = ended.key[1], ended.value
        pack = scene.pack
        if pack is None:
            return None
        shown = frozenset(one.name for one in pack.finishes) & names
        if not shown:
            return None
        key = _unlooked(scene), size, shown
        made = self._made.get(side)
        if made is not None and made[0] == key:
            return made[1]
        if at_rest and not self._worker.busy:
            self._worker.start((side, key), lambda: tinted(scene, size, shown))
        return None


def _unlooked(scene: Scene) -> Scene:
    """The scene without the looks of its finishes, on which their places do not depend."""
    pack = scene.pack
    assert pack is not None
    for one in pack.finishes:
        pack = pack.with_finish(one.name, sigma_n_deg=None, k=1.0)
    return Scene(scene.material, scene.setup, pack=pack)
