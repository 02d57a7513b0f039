"""The share of each pixel at a mesh's silhouette that the mesh covers.

As of other shapes: a pixel whose corners, sides and middle differ has EDGE_RAYS places. Here the
rasteriser finds them: the mesh at every half pixel first, and then the triangles beside the pixels
that differ, once for each place. Twin: relgloss_view/picture/model/silhouette.py.
"""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np

from relgloss_view.base.arrays import AnyArray, Ints
from relgloss_view.pack.mesh import Mesh
from relgloss_view.picture.gpu.programs import Programs
from relgloss_view.picture.gpu.targets import COVERAGE, MASK, Targets
from relgloss_view.picture.gpu.triangles import (
    Triangles,
    array_of,
    hides_backs,
    listed,
    projection,
)
from relgloss_view.picture.model.silhouette import EDGE_RAYS
from relgloss_view.picture.model.view import Box, View

TILE_PX = 2048  #: side of the parts in which the silhouette is looked for
BLOCK = 2  #: side in pixels of what beside_edges looks at
#: By which bounds are larger: corners are drawn up to 1/512 beside their place.
BESIDE_PX = 1.0 / 64.0
MARK = 1  #: as EDGE_MARK of mesh_edge.frag, of 255


class Part:
    """Some triangles of a mesh, once for each place of a pixel."""

    def __init__(self, ctx: moderngl.Context, mesh: Mesh, numbers: Ints) -> None:
        self._buffer = ctx.buffer(listed(mesh.points_m, mesh.triangles[numbers]).tobytes())
        self._array: moderngl.VertexArray | None = None

    def array(self, ctx: moderngl.Context, program: moderngl.Program) -> moderngl.VertexArray:
        """See programs.Geometry."""
        self._array = array_of(ctx, program, self._buffer)
        return self._array

    def release(self) -> None:
        """Free it."""
        if self._array is not None:
            self._array.release()
        self._buffer.release()


def draw_coverage(
    programs: Programs, targets: Targets, masks: Targets, triangles: Triangles, view: View
) -> None:
    """Draw the coverage target of a view; masks: targets that hold parts of it at half pixels."""
    framebuffer: Any = targets.framebuffer(COVERAGE, depth=True)
    left, bottom, right, top = view.bounds
    width, height = (min(side, TILE_PX) for side in view.size)
    for low in range(bottom, top, height):
        for first in range(left, right, width):
            box = first, low, min(first + width, right), min(low + height, top)
            _draw_mask(programs, masks, triangles, view, (first, low, first + width, low + height))
            framebuffer.scissor = _scissor(box)
            uniforms = {"mask_image": masks.texture(*MASK), "from": box[:2]}
            programs.draw("mesh_edge.frag", {}, uniforms, framebuffer, depth="1")
    numbers = beside_edges(triangles.mesh, view, targets.read(*COVERAGE)[::-1, :, 0] == MARK)
    if len(numbers) == 0:
        return
    part = Part(programs.ctx, triangles.mesh, numbers)
    framebuffer.scissor = _scissor(view.bounds)
    uniforms = projection(triangles.mesh, view, (0, 0, *view.size))
    try:
        programs.draw(
            "mesh_places.frag",
            {},
            uniforms,
            framebuffer,
            geometry=part,
            depth=">",
            adds=True,
            instances=EDGE_RAYS,
        )
    finally:
        part.release()


def _draw_mask(
    programs: Programs, masks: Targets, triangles: Triangles, view: View, box: Box
) -> None:
    """The mesh at the corners, sides and middles of a box of pixels."""
    size = 2 * (box[2] - box[0]) + 1, 2 * (box[3] - box[1]) + 1
    if masks.size != size:
        masks.release()
        masks.size = size
    target: Any = masks.framebuffer(MASK)
    target.scissor = None
    target.use()
    target.clear()
    wider = (box[0] - 0.25, box[1] - 0.25, box[2] + 0.25, box[3] + 0.25)
    uniforms = projection(triangles.mesh, view, wider, 2)
    culls = hides_backs(triangles.mesh, view)
    programs.draw("mesh.frag", {}, uniforms, target, geometry=triangles, culls=culls)


def _scissor(box: Box) -> Box:
    return box[0], box[1], box[2] - box[0], box[3] - box[1]


def beside_edges(mesh: Mesh, view: View, marked: AnyArray) -> Ints:
    """Numbers of the triangles whose bounds in the picture come near a marked pixel.

    marked: (H, W), rows from the bottom. They are looked for in blocks of pixels, which keeps the
    sums of a large picture small. Of a closed mesh those seen from behind are left out: the others
    cover the same places.
    """
    height, width = (-(-side // BLOCK) for side in marked.shape)
    rows = np.logical_or.reduceat(marked, np.arange(0, marked.shape[0], BLOCK), axis=0)
    blocks = np.logical_or.reduceat(rows, np.arange(0, marked.shape[1], BLOCK), axis=1)
    sums = np.zeros((height + 1, width + 1), dtype=np.int64)
    np.cumsum(np.cumsum(blocks, axis=0), axis=1, out=sums[1:, 1:])
    from_eye = mesh.points_m - view.eye_m
    depth = from_eye @ view.forward
    before = np.maximum(depth, 1e-9)[:, None]
    tangents = from_eye @ np.stack([view.right, view.up], axis=-1) / before - np.array(view.shift)
    places = tangents / view.pixel_step + 0.5 * np.array(view.size)
    corners = places[mesh.triangles]
    behind = np.any(depth[mesh.triangles] <= 1e-9, axis=1)  # its bounds are not known
    limit = np.array([width, height])
    low = np.clip(np.floor((corners.min(axis=1) - BESIDE_PX) / BLOCK), 0, limit).astype(np.int64)
    high = np.clip(np.ceil((corners.max(axis=1) + BESIDE_PX) / BLOCK), 0, limit).astype(np.int64)
    low[behind], high[behind] = 0, limit
    (x0, y0), (x1, y1) = low.T, high.T
    held = sums[y1, x1] - sums[y0, x1] - sums[y1, x0] + sums[y0, x0]
    near = held > 0
    if hides_backs(mesh, view):
        near &= behind | ~_turned_away(corners)
    return np.nonzero(near)[0]


def _turned_away(corners: AnyArray) -> AnyArray:
    """Whether triangles (T, 3, 2) run clockwise, (T,), with corners off by up to BESIDE_PX."""
    sides = np.roll(corners, -1, axis=1) - corners
    twice = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    around = np.sum(np.abs(sides), axis=(1, 2))
    return np.asarray(twice < -(around * BESIDE_PX + 4.0 * BESIDE_PX**2))
