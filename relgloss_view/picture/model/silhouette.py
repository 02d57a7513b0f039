"""Silhouettes: the share of each pixel that the object covers, and pictures with smooth edges.

The object's pixels keep their one sample, so that each number of a picture can be computed again.
Only what the display shows mixes the object and the surround. Twin: shaders/coverage.frag, which
edge.frag shows.
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.pack.shape import ANALYTIC, Shape
from relgloss_view.picture.model.sight import meet_view
from relgloss_view.picture.model.view import View

EDGE_RAYS = 64  #: of a pixel at the silhouette
ROWS = 64  #: of pixels, at a time
TILE_PX = 8  #: side of the tiles in which the GPU looks for the silhouette
TRIANGLE_STEPS = 4  #: of a tile's side, for forms made of triangles
#: Rows and columns to a pixel's neighbours: beside it before across its corners.
NEIGHBOURS = ((0, -1), (0, 1), (-1, 0), (1, 0), (-1, -1), (-1, 1), (1, -1), (1, 1))


def edge_place(k: Ints) -> tuple[Array, Array]:
    """Hammersley's points in a pixel (Hammersley 1960), as shaders/silhouette.glsl.

    >>> [v.tolist() for v in edge_place(np.array([0, 1]))]
    [[0.0078125, 0.0234375], [0.0078125, 0.5078125]]
    """
    turned = np.zeros(k.shape, dtype=np.int64)
    for n in range(6):
        turned |= ((k >> n) & 1) << (5 - n)
    return (k + 0.5) / EDGE_RAYS, (turned + 0.5) / EDGE_RAYS


def coverage(form: Shape, view: View) -> Array:
    """(H, W), the share of each pixel that the object covers, by EDGE_RAYS rays at the edge.

    A pixel whose corners, sides and middle all meet a convex object lies inside it. What lies
    between those nine places of a pixel and touches none of them is not seen: at most a sixteenth
    of a pixel, at a sharp corner. Of a form made of triangles, gaps between the places are not seen
    either: a gap or a spike narrower than half a pixel may be taken as covered or as absent.
    """
    width, height = view.size
    share = np.zeros((height, width))
    left, bottom, right, top = view.bounds

    def met(columns: Array, rows: Array) -> Mask:
        return meet_view(form, view, columns - 0.5, rows - 0.5).found

    for first in range(height - top, height - bottom, ROWS):
        last = min(first + ROWS, height - bottom)
        columns = np.arange(2 * left, 2 * right + 1) / 2.0
        rows = np.arange(2 * first, 2 * last + 1) / 2.0
        lattice = met(columns[None, :] + 0.0 * rows[:, None], rows[:, None] + 0.0 * columns)
        tried = sum(
            lattice[y : y + 2 * (last - first) : 2, x : x + 2 * (right - left) : 2].astype(np.int64)
            for y in range(3)
            for x in range(3)
        )
        share[first:last, left:right] = tried == 9
        at_edge = np.argwhere((tried > 0) & (tried < 9)) + np.array([first, left])
        x, y = edge_place(np.arange(EDGE_RAYS, dtype=np.int64))
        hits = met(at_edge[:, 1, None] + x, at_edge[:, 0, None] + y)
        share[at_edge[:, 0], at_edge[:, 1]] = np.mean(hits, axis=-1)
    return share


def edge_tiles(form: Shape, view: View) -> Array:
    """(N, 3), left, upper edge and side in pixels of the tiles that hold the silhouette.

    Tiles whose corners all meet a convex object lie inside it. One whose corners all miss it can
    hold a corner of it only beside a tile that is met. A form made of triangles is looked at by
    TRIANGLE_STEPS more places along each side of a tile: of a gap or a spike that is smaller than
    their distance, two pixels, the tile may be missed, and its pixels keep their one sample.
    """
    left, bottom, right, top = view.bounds
    first = view.size[1] - top
    across, down = -(-(right - left) // TILE_PX), -(-(top - bottom) // TILE_PX)
    if across <= 0 or down <= 0:
        return np.zeros((0, 3))
    steps = 1 if form.kind in ANALYTIC else TRIANGLE_STEPS
    columns = left + TILE_PX / steps * np.arange(steps * across + 1.0) - 0.5
    rows = first + TILE_PX / steps * np.arange(steps * down + 1.0) - 0.5
    met = meet_view(form, view, *np.broadcast_arrays(columns, rows[:, None])).found
    corners = np.stack(
        [
            met[y : y + steps * down : steps, x : x + steps * across : steps]
            for x in range(steps + 1)
            for y in range(steps + 1)
        ]
    )
    inside, mixed = np.all(corners, axis=0), np.any(corners, axis=0)
    if np.any(mixed):
        padded = np.pad(mixed, 1)
        beside = padded[2:, 1:-1] | padded[:-2, 1:-1] | padded[1:-1, 2:] | padded[1:-1, :-2]
        wanted = (mixed | beside) & ~inside
    else:  # the object is smaller than a tile, or lies between corners
        wanted = np.ones_like(mixed)
    y, x = np.nonzero(wanted)
    side = np.full(len(x), float(TILE_PX))
    return np.stack([left + TILE_PX * x, first + TILE_PX * y, side], axis=-1)


def edge_pixels(share: Array) -> Array:
    """(N, 3), column, row from the top and share of the pixels that the object covers in part.

    >>> edge_pixels(np.array([[0.0, 0.25, 1.0]])).tolist()
    [[1.0, 0.0, 0.25]]
    """
    rows, columns = np.nonzero((share > 0.0) & (share < 1.0))
    return np.stack([columns, rows, share[rows, columns]], axis=-1).astype(np.float64)


def smoothed(
    light: Array, on_object: Mask, edges: Array, background: float | Array
) -> tuple[Array, Mask]:
    """A picture with smooth silhouettes, and where it shows any of the object (H, W).

    light: (H, W, 3), linear display RGB with one sample a pixel. on_object: (H, W), whose sample
    meets the object. edges: of edge_pixels. background: linear light of the surround, or its RGB.

    A pixel whose sample misses the object takes the colour of the nearest one that shows it.
    """
    picture, shows = light.copy(), on_object.copy()
    column, row = edges[:, 0].astype(np.int64), edges[:, 1].astype(np.int64)
    source = np.stack([row, column], axis=-1)
    found = on_object[row, column]
    limit = np.array(on_object.shape) - 1
    for step in NEIGHBOURS:
        at = np.clip(np.stack([row, column], axis=-1) + step, 0, limit)
        take = ~found & on_object[at[:, 0], at[:, 1]]
        source[take] = at[take]
        found |= take
    share = np.where(found, edges[:, 2], 0.0)[:, None]
    colour = light[source[:, 0], source[:, 1]]
    picture[row, column] = share * colour + (1.0 - share) * background
    shows[row, column] = found
    return picture, shows
