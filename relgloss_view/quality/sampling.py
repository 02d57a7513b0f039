"""Sampling: the few pixels that represent a picture, and the share that each represents.

They stand denser about the highlight, at the silhouette and on the object's first and last rows,
where methods fail first and which an even grid of so few would miss.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.material import brdf
from relgloss_view.picture.model.shape import Hit
from relgloss_view.picture.model.sight import sight
from relgloss_view.picture.model.view import View
from relgloss_view.picture.scene.scene import Scene

ROWS, COLUMNS = 16, 28  #: of the even grid
EDGE_ROWS = 128  #: that the object's first and last row are looked for in
EDGE = np.arange(-3, 4)  #: rows about those
NEAR = np.arange(-6, 7)  #: a finer step about the brightest place, over one step of the coarser


def meet(scene: Scene, view: View, columns: Array, rows: Array) -> tuple[Hit, Array]:
    """Where rays through pixels meet the object, and the directions to the eye."""
    hit, ray, _ = sight(scene.shape, view, columns, rows)
    return hit, -ray / np.linalg.norm(ray, axis=-1, keepdims=True)


def places(scene: Scene, view: View) -> tuple[Array, Array, Array]:
    """Columns, rows and areas of the pixels, (N,) each, those on the object only."""
    left, bottom, right, top = view.bounds
    height = view.size[1]
    first, last = height - top, height - bottom  # rows count from the top
    if right <= left or last <= first:
        return np.zeros(0), np.zeros(0), np.zeros(0)

    def off_mirror(columns: Array, rows: Array) -> Array:
        hit, o = meet(scene, view, columns, rows)
        i = scene.lamp.position_m - hit.point_m
        i = i / np.maximum(np.linalg.norm(i, axis=-1, keepdims=True), 1e-30)
        return np.where(hit.found, brdf.facing(hit.normal, i, o).delta2, np.inf)

    columns = np.linspace(left, right - 1, COLUMNS).round()

    def meet_object(rows: Array) -> Mask:
        found = np.isfinite(off_mirror(*np.broadcast_arrays(columns, rows[:, None])))
        return np.asarray(np.any(found, axis=1))

    ends = _ends(meet_object, first, last)
    if ends is None:
        return np.zeros(0), np.zeros(0), np.zeros(0)
    rows = np.unique(np.linspace(*ends, ROWS).round())
    rows = np.unique(np.clip(np.concatenate([rows, *(end + EDGE for end in ends)]), *ends))
    delta2 = off_mirror(*np.broadcast_arrays(columns[None, :], rows[:, None]))
    step = max((ends[1] - ends[0]) / ROWS, 1.0)
    best = rows[np.argmin(np.min(delta2, axis=1))]
    rows = np.unique(np.clip(np.append(rows, best + NEAR * step / 6.0), *ends).round())
    grid = np.broadcast_to(columns, (len(rows), len(columns)))
    step = max((right - left) / COLUMNS, 1.0)
    about = [grid, grid, grid]  # the highlight, and both ends of the object
    while True:
        step /= 6.0
        for k, (found, places) in enumerate(zip((_least, _first, _last), about, strict=True)):
            delta2 = off_mirror(*np.broadcast_arrays(places, rows[:, None]))
            at = np.take_along_axis(places, found(delta2)[:, None], axis=1)
            about[k] = np.clip(at + NEAR * max(step, 1.0), left, right - 1).round()
        grid = np.concatenate([grid, *about], axis=1)
        if step <= 1.0:
            break
    grid = np.sort(grid, axis=1)
    area = _spans(grid, left, right) * _spans(rows[None, :], ends[0], ends[1] + 1.0).T
    columns, rows = np.broadcast_arrays(grid, rows[:, None])
    hit, _ = meet(scene, view, columns, rows)
    seen = hit.found & (area > 0.0)
    return columns[seen], rows[seen], area[seen]


def _ends(
    meet_object: Callable[[Array], Mask], first: int, last: int
) -> tuple[float, float] | None:
    """The first and the last row that meets the object, by two looks; None where none does."""
    rows = np.unique(np.linspace(first, last - 1, min(last - first, EDGE_ROWS)).round())
    met = rows[meet_object(rows)]
    if len(met) == 0:
        return None
    gap = np.ceil(np.max(np.diff(rows), initial=1.0))
    near = np.arange(-gap, gap + 1.0)  # what the first look stepped over
    rows = np.unique(np.clip([met[0] + near, met[-1] + near], first, last - 1))
    met = rows[meet_object(rows)]
    return float(met[0]), float(met[-1])


def _least(delta2: Array) -> NDArray[np.intp]:
    return np.asarray(np.argmin(delta2, axis=1))


def _first(delta2: Array) -> NDArray[np.intp]:
    return np.asarray(np.argmax(np.isfinite(delta2), axis=1))


def _last(delta2: Array) -> NDArray[np.intp]:
    return np.asarray(delta2.shape[1] - 1 - np.argmax(np.isfinite(delta2)[:, ::-1], axis=1))


def _spans(places: Array, first: float, last: float) -> Array:
    """The length of a line that each of its sorted places represents; of equal places the last."""
    same = places[:, 1:] == places[:, :-1]
    middle = np.where(same, first, 0.5 * (places[:, 1:] + places[:, :-1]) + 0.5)
    ends = np.full((len(places), 1), first), np.full((len(places), 1), last)
    edges = np.concatenate([ends[0], np.maximum.accumulate(middle, axis=1), ends[1]], axis=1)
    return np.diff(edges, axis=1)
