"""The silhouette on the GPU: its tiles and pixels, as lists that vertex stages read."""

from __future__ import annotations

import moderngl
import numpy as np

from relgloss_view.base.arrays import AnyArray, Array
from relgloss_view.picture.model.silhouette import EDGE_RAYS
from relgloss_view.picture.model.view import Box

WIDE = 1024  #: of a list's texture, so that it fits every device
TILE_VERTICES = 6


class VertexList:
    """Rows of up to four numbers as a texture of WIDE columns; none for an empty list."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self.count = 0
        self.texture: moderngl.Texture | None = None

    def fill(self, rows: Array) -> None:
        """Hold other rows (N, up to 4)."""
        self.release()
        self.count = len(rows)
        if self.count == 0:
            return
        lines = -(-self.count // WIDE)
        listed = np.zeros((lines * WIDE, 4), dtype=np.float32)
        listed[: self.count, : rows.shape[1]] = rows
        self.texture = self.ctx.texture((WIDE, lines), 4, listed.tobytes(), dtype="f4")
        self.texture.filter = (moderngl.NEAREST, moderngl.NEAREST)

    def release(self) -> None:
        """Free the texture."""
        if self.texture is not None:
            self.texture.release()
        self.texture, self.count = None, 0


class Silhouette:
    """The lists of one picture: tiles that the silhouette passes through, and its pixels."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.tiles = VertexList(ctx)
        self.edges = VertexList(ctx)
        self.pixels: Array = np.zeros((0, 3))  #: as model.silhouette.edge_pixels

    def fill_tiles(self, tiles: Array, height: int) -> None:
        """Hold the tiles of model.silhouette.edge_tiles, and no pixels until they are found."""
        self.pixels = np.zeros((0, 3))
        self.edges.fill(self.pixels)
        self.tiles.fill(_from_bottom(tiles, height - tiles[:, 2]))

    def fill_edges(self, coverage: AnyArray, bounds: Box) -> None:
        """Hold the pixels of a coverage target, (H, W) of 8 bits, inside the object's bounds."""
        left, bottom, right, top = bounds
        height = len(coverage)
        first = height - top
        part = coverage[first : height - bottom, left:right]
        # Above 0 and below 255: a single comparison, since bytes wrap.
        rows, columns = np.nonzero(part - np.uint8(1) < np.uint8(254))
        share = np.round(part[rows, columns] * (EDGE_RAYS / 255.0)) / EDGE_RAYS
        shown = (share > 0.0) & (share < 1.0)
        rows, columns, share = rows[shown], columns[shown], share[shown]
        self.pixels = np.stack([columns + float(left), rows + float(first), share], axis=-1)
        self.edges.fill(_from_bottom(self.pixels, np.full(len(rows), height - 1.0)))

    def release(self) -> None:
        """Free the textures."""
        self.tiles.release()
        self.edges.release()


def _from_bottom(rows: Array, highest: Array) -> Array:
    """Places (N, 3) counted from the bottom, as OpenGL does."""
    return np.stack([rows[:, 0], highest - rows[:, 1], rows[:, 2]], axis=-1)
