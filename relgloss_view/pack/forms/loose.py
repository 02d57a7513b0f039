"""Loose: triangles as a mesh file holds them, and how they become a Mesh of a pack."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.base.errors import InputError
from relgloss_view.pack.mesh import Mesh

MOST_TRIANGLES = 500_000
CREASE_DEG = 40.0  #: edges that are sharper stay edges where a file has no normals
MOST_PAIRS = 20_000_000  #: of triangles at one point, when normals are computed
SMALLEST_M, LARGEST_M = 0.001, 10.0  #: of the longest side, as of every size of a form
SURELY_MM = 10.0  #: a pack of more metres than this is in millimetres
MOST_COORDINATE = 1e9
TOO_MANY = (
    f"more than {MOST_TRIANGLES} triangles; reduce them in the program that made it "
    "(Blender: Decimate)"
)


@dataclass
class Loose:
    """Triangles of a file. `corners`, `uv_corners` and `normal_corners` are (T, 3), -1 for none.

    points: (P, 3), in the file's unit. uv: (U, 2), v upwards. normals: (N, 3), of any length.
    part: (T,), numbers of `parts`. beside: further files that were read.
    """

    points: Array
    corners: Ints
    uv: Array = field(default_factory=lambda: np.zeros((0, 2)))
    uv_corners: Ints | None = None
    normals: Array = field(default_factory=lambda: np.zeros((0, 3)))
    normal_corners: Ints | None = None
    part: Ints | None = None
    parts: tuple[str, ...] = ("body",)
    notes: tuple[str, ...] = ()
    beside: tuple[str, ...] = ()


def packed(loose: Loose, metres_per_unit: float | None) -> Mesh:
    """The triangles as a Mesh: checked, in metres, centred, outside out, with normals and label.

    metres_per_unit: None takes metres, or millimetres where metres would make no pack. Raises
    InputError, without a file's name, where nothing can be drawn.
    """
    _check_numbers(loose)
    notes = list(loose.notes)
    centre = 0.5 * (
        loose.points[loose.corners].min((0, 1)) + loose.points[loose.corners].max((0, 1))
    )
    points = loose.points - centre
    scale = _scale(points[loose.corners], metres_per_unit, notes)
    points = points * scale
    kept = _kept_triangles(points, loose.corners, notes)
    corners = loose.corners[kept]
    part = np.zeros(len(corners), dtype=np.int64) if loose.part is None else loose.part[kept]
    uv_corners = None if loose.uv_corners is None else loose.uv_corners[kept]
    normal_corners = None if loose.normal_corners is None else loose.normal_corners[kept]

    normals = _file_normals(loose.normals, normal_corners)
    corners, uv_corners, normals = _wound(points, corners, uv_corners, normals, notes)
    computed = _smooth_normals(points, corners)
    if normals is None:
        normals = computed
    else:
        missing = ~(np.abs(normals).sum(axis=-1) > 0.0)
        normals = np.where(missing[..., None], computed, normals)
    uv, has_uv = _corner_uv(loose.uv, uv_corners, corners.shape)
    size = _label_size(points[corners], uv[..., :], has_uv)
    if size is None:
        notes.append(
            "The file has no usable texture coordinates, so no artwork can be placed on it."
        )
        size, label, printed = (0.1, 0.1), np.zeros((*corners.shape, 2)), False
    else:
        label, printed = (uv - 0.5) * np.array(size), True
        if not has_uv.all():
            notes.append("Some triangles have no texture coordinates; no artwork lies on them.")
            label = np.where(has_uv[:, None, None], label, -1e3)
    return _indexed(points, corners, normals, label, part, loose.parts, printed, size, notes)


def _check_numbers(loose: Loose) -> None:
    if not len(loose.corners):
        raise InputError("holds no triangles; export the surface of the pack as triangles")
    if len(loose.corners) > MOST_TRIANGLES:
        raise InputError(f"holds {TOO_MANY}")
    for corners, values, name in (
        (loose.corners, loose.points, "point"),
        (loose.uv_corners, loose.uv, "texture coordinate"),
        (loose.normal_corners, loose.normals, "normal"),
    ):
        if corners is None:
            continue
        least = 0 if name == "point" else -1
        wrong = (corners < least) | (corners >= len(values))
        if wrong.any():
            number = int(corners[wrong][0]) + 1
            raise InputError(f"a triangle names {name} {number} of {len(values)}; export it again")
    used = loose.points[loose.corners]
    if not (np.isfinite(used).all() and np.abs(used).max() <= MOST_COORDINATE):
        raise InputError("a coordinate is not a finite number of usual size; export it again")


def _scale(corners: Array, metres_per_unit: float | None, notes: list[str]) -> float:
    longest = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    scale = metres_per_unit
    if scale is None:
        scale = 1.0
        if longest > SURELY_MM:
            scale = 0.001
            notes.append(
                f"In metres the longest side would be {longest:.4g} m, so the file is read in "
                "millimetres; state its unit if it has another one."
            )
    size = longest * scale
    if not SMALLEST_M <= size <= LARGEST_M:
        raise InputError(
            f"its longest side is {size:.3g} m, expected {SMALLEST_M:g} to {LARGEST_M:g} m; "
            "state the unit of its coordinates"
        )
    return scale


def _kept_triangles(points: Array, corners: Ints, notes: list[str]) -> Mask:
    a, b, c = (points[corners[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    edges = [np.einsum("ij,ij->i", v, v) for v in (b - a, c - b, a - c)]
    kept = np.asarray(area > 1e-9 * np.maximum.reduce(edges))
    if not kept.any():
        raise InputError("none of its triangles has an area; export the surface of the pack")
    left_out = int(np.sum(~kept))
    if left_out:
        notes.append(f"{left_out} triangles without an area are left out.")
    return kept


def _file_normals(normals: Array, corners: Ints | None) -> Array | None:
    """Unit normals of corners (T, 3, 3); zero where the file has none that is usable."""
    if corners is None or not len(normals):
        return None
    with np.errstate(all="ignore"):
        length = np.linalg.norm(normals, axis=1)
        usable = np.isfinite(length) & (length > 1e-12)
        unit = np.where(usable[:, None], normals / np.where(usable, length, 1.0)[:, None], 0.0)
    return np.where((corners >= 0)[..., None], unit[np.maximum(corners, 0)], 0.0)


def _wound(
    points: Array, corners: Ints, uv: Ints | None, normals: Array | None, notes: list[str]
) -> tuple[Ints, Ints | None, Array | None]:
    """Counter-clockwise seen from outside: by the file's normals, and by a closed mesh's volume."""
    if normals is not None:
        agreement = np.einsum("tj,tkj->t", _facets(points, corners), normals)
        turned = agreement < 0.0
        if turned.any():
            if np.mean(turned) > 0.01:
                notes.append(
                    f"{np.mean(turned):.0%} of the triangles run clockwise about their normals; "
                    "the normals decide what is outside."
                )
            corners, uv, normals = _turned(turned, corners, uv, normals)
    if _closed(points, corners) and _volume(points, corners) < 0.0:
        notes.append("The mesh is inside out; it is turned.")
        everything = np.ones(len(corners), dtype=bool)
        corners, uv, normals = _turned(everything, corners, uv, normals)
        normals = None if normals is None else -normals
    return corners, uv, normals


def _turned(
    which: Mask, corners: Ints, uv: Ints | None, normals: Array | None
) -> tuple[Ints, Ints | None, Array | None]:
    def swapped(values: Ints) -> Ints:
        return np.where(which[:, None], values[:, [0, 2, 1]], values)

    return (
        swapped(corners),
        None if uv is None else swapped(uv),
        None if normals is None else np.where(which[:, None, None], normals[:, [0, 2, 1]], normals),
    )


def _facets(points: Array, corners: Ints) -> Array:
    a, b, c = (points[corners[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))


def _welded(points: Array, corners: Ints) -> Ints:
    """Corners by place: points of one place have one number."""
    order = np.lexsort(points.T)
    new = np.concatenate([[True], np.any(np.diff(points[order], axis=0) != 0.0, axis=1)])
    number = np.empty(len(points), dtype=np.int64)
    number[order] = np.cumsum(new) - 1
    return number[corners]


def _closed(points: Array, corners: Ints) -> bool:
    """Whether each edge is passed as often in one direction as in the other."""
    welded = _welded(points, corners)
    start, end = welded.ravel(), welded[:, [1, 2, 0]].ravel()
    count = len(points)
    forth, back = np.sort(start * count + end), np.sort(end * count + start)
    return bool(np.array_equal(forth, back))


def _volume(points: Array, corners: Ints) -> float:
    a, b, c = (points[corners[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def _smooth_normals(points: Array, corners: Ints) -> Array:
    """Normals of corners (T, 3, 3): the mean of the facets there, weighted by their angles.

    Thuermer and Wuethrich 1998, over the facets that turn less than CREASE_DEG from the corner's
    own. Where very many triangles meet, a corner keeps its facet's normal.
    """
    facets = _facets(points, corners)
    count = len(corners)
    sides = [points[corners[:, (k + 1) % 3]] - points[corners[:, k]] for k in range(3)]
    angles = np.stack(
        [
            np.arctan2(
                np.linalg.norm(np.cross(sides[k], -sides[k - 1]), axis=1),
                np.einsum("ij,ij->i", sides[k], -sides[k - 1]),
            )
            for k in range(3)
        ],
        axis=1,
    )
    welded = _welded(points, corners).ravel()
    order = np.argsort(welded, kind="stable")
    places, first, valence = np.unique(welded[order], return_index=True, return_counts=True)
    del places
    by_valence = np.argsort(valence, kind="stable")
    allowed = by_valence[np.cumsum(valence[by_valence] ** 2) <= MOST_PAIRS]
    normals = np.repeat(facets, 3, axis=0)
    least = np.cos(np.radians(CREASE_DEG))
    weights = angles.ravel()
    for size in np.unique(valence[allowed]):
        starts = first[allowed[valence[allowed] == size]]
        step = max(1, 2_000_000 // int(size) ** 2)
        for low in range(0, len(starts), step):
            group = order[starts[low : low + step, None] + np.arange(size)]  # (places, size)
            own = facets[group // 3]
            together = np.einsum("pij,pkj->pik", own, own) >= least
            total = np.einsum("pik,pk,pkj->pij", together, weights[group], own)
            normals[group] = total / np.linalg.norm(total, axis=-1, keepdims=True)
    return normals.reshape(count, 3, 3)


def _corner_uv(uv: Array, corners: Ints | None, shape: tuple[int, ...]) -> tuple[Array, Mask]:
    """Texture coordinates of corners, and which triangles have them."""
    if corners is None or not len(uv):
        return np.zeros((*shape, 2)), np.zeros(shape[0], dtype=bool)
    values = uv[np.maximum(corners, 0)]
    usable = np.isfinite(values).all(axis=-1) & (np.abs(values).max(axis=-1) < 1e6)
    has = np.all((corners >= 0) & usable, axis=1)
    return np.where(has[:, None, None], values, 0.0), has


def _label_size(points: Array, uv: Array, has_uv: Mask) -> tuple[float, float] | None:
    """Metres per unit of u and of v, weighted by area, so that areas on the label are right."""
    points, uv = points[has_uv], uv[has_uv]
    e1, e2 = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    d1, d2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    determinant = d1[:, 0] * d2[:, 1] - d1[:, 1] * d2[:, 0]
    area = 0.5 * np.linalg.norm(np.cross(e1, e2), axis=1)
    usable = np.abs(determinant) > 1e-12
    if not usable.any():
        return None
    e1, e2, d1, d2, area = e1[usable], e2[usable], d1[usable], d2[usable], area[usable]
    determinant = determinant[usable, None]
    across = (e1 * d2[:, 1:] - e2 * d1[:, 1:]) / determinant
    up = (e2 * d1[:, :1] - e1 * d2[:, :1]) / determinant
    width = np.average(np.linalg.norm(across, axis=1), weights=area)
    height = np.average(np.linalg.norm(up, axis=1), weights=area)
    share = np.sqrt(area.sum() / (width * height * 0.5 * np.abs(determinant).sum()))
    size = float(width * share), float(height * share)
    return size if min(size) > 1e-6 and max(size) < 1e3 else None


def _indexed(
    points: Array, corners: Ints, normals: Array, label: Array, part: Ints,
    parts: tuple[str, ...], printed: bool, size: tuple[float, float], notes: list[str],
) -> Mesh:  # fmt: skip
    """Corners that are equal in everything become one point."""
    flat = corners.ravel()
    columns = [
        normals.reshape(-1, 3).round(9) + 0.0, label.reshape(-1, 2), np.repeat(part, 3)[:, None],
        flat[:, None],
    ]  # fmt: skip
    table = np.ascontiguousarray(np.concatenate(columns, axis=1))
    rows = table.view(np.dtype((np.void, table.dtype.itemsize * table.shape[1]))).ravel()
    _, chosen, number = np.unique(rows, return_index=True, return_inverse=True)
    used, renumbered = np.unique(part, return_inverse=True)
    names = tuple(parts[k] for k in used)
    lengths = np.linalg.norm(normals.reshape(-1, 3)[chosen], axis=1, keepdims=True)
    return Mesh(
        points_m=points[flat[chosen]],
        normals=normals.reshape(-1, 3)[chosen] / lengths,
        label_m=label.reshape(-1, 2)[chosen],
        part=np.repeat(renumbered.ravel(), 3)[chosen],
        triangles=number.reshape(-1, 3).astype(np.int64),
        parts=names,
        printed=(printed,) * len(names),
        label_size_m=size,
        notes=tuple(notes),
    )
