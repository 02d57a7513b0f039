"""Small pictures of an artwork's plates, black where a plate prints, for the list of plates."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Bytes
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.pack import Pack
from relgloss_view.viewer.drawing.texture_uploads import TextureUploads
from relgloss_view.viewer.state.packs import free_plates

LARGEST = 160  #: pixels along the longer side
MOST = 16  #: plates that have one


def small(plate: Bytes) -> Bytes:
    """A plate (H, W) as a picture (h, w, 3), means of areas.

    >>> small(np.full((320, 640), 255, np.uint8)).shape
    (80, 160, 3)
    """
    from PIL import Image

    height, width = plate.shape
    scale = min(1.0, LARGEST / max(height, width))
    size = max(1, round(width * scale)), max(1, round(height * scale))
    gray = Image.fromarray(np.ascontiguousarray(plate)).reduce(max(1, int(0.5 / scale)))
    pixels = 255 - np.asarray(gray.resize(size, Image.Resampling.BOX))
    return np.repeat(pixels[..., None], 3, axis=2)


class PlatePictures:
    """The pictures of the last artwork that was asked for, each made once."""

    def __init__(self) -> None:
        self._of: Artwork | None = None
        self._made: dict[str, Bytes] = {}

    def textures(self, pack: Pack | None, uploads: TextureUploads) -> dict[str, tuple[int, float]]:
        """Texture, and width over height, by the names of plates that have no finish."""
        artwork = None if pack is None else pack.artwork
        if artwork is not self._of:
            self._of, self._made = artwork, {}
        if pack is None or artwork is None:
            return {}
        found = {}
        for k, name in enumerate(free_plates(pack)[:MOST]):
            if name not in self._made:
                self._made[name] = small(artwork.plates[name])
            pixels = self._made[name]
            ratio = pixels.shape[1] / pixels.shape[0]
            found[name] = uploads.texture(f"plate {k}", pixels), ratio
        return found
