"""Pouch: a pillow bag of one film, blown up between two crimped seals.

Each section across is an ellipse whose perimeter is the film's width, so that lengths across the
label are those on the surface and the filled bag is narrower than its seals. Depth follows a
power of the height, with a crease where the seals begin.
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.pack.forms.patches import Patch, grid_triangles, joined
from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.shape import Shape

FULLNESS = 2.4  #: exponent of the depth over the height; 2 is a parabola, more is fuller
SEAL, RIDGE, RIDGE_HEIGHT, FILM = 0.010, 0.00165, 0.0003, 0.0002  #: metres at usual size
BODY_ROWS, RIDGE_ROWS = 64, 10
DEPTH_NOTE = "The bag is made flatter, so that its film is wide enough."


def pouch(shape: Shape) -> Mesh:
    """A pillow bag, its back seam in the middle of the back.

    width_m: across the flat seals. depth_m: at its thickest. Parts: front, back, top seal, bottom
    seal, all printed, and the cut edges. Label: the film, with the front in its middle; half of the
    back is on either side. Its height is the mean length of the surface upwards.
    """
    width, height = shape.width_m, shape.height_m
    k = min(width / 0.140, height / 0.190)
    thin = FILM * k
    thick = min(0.5 * shape.depth_m, 0.6 * width / 2.0)
    notes = (DEPTH_NOTE,) if thick < 0.5 * shape.depth_m else ()
    thin = min(thin, 0.1 * thick)
    seal, ridge = SEAL * k, RIDGE_HEIGHT * k
    middle = 0.5 * height - seal

    v = np.linspace(-1.0, 1.0, BODY_ROWS + 1)
    b = thin + (thick - thin) * (1.0 - np.abs(v) ** FULLNESS)
    slope = -(thick - thin) * FULLNESS * np.abs(v) ** (FULLNESS - 1.0) * np.sign(v) / middle
    girth = 4.0 * _quarter(np.array([0.5 * width]), np.array([thin]))[0]
    a = _half_width(b, girth)
    step = 1e-4 * thin
    a_slope = (_half_width(b + step, girth) - _half_width(b - step, girth)) / (2.0 * step) * slope
    zero = np.zeros_like(v)
    body = _rows(middle * v, a, b, a_slope, slope, zero, zero)

    count = max(2, round(seal / (RIDGE * k)))
    u = np.linspace(0.0, 1.0, count * RIDGE_ROWS + 1)
    wave = ridge * np.sin(np.pi * count * u) ** 2
    wave[-1] = 0.0
    wave_slope = ridge * np.pi * count / seal * np.sin(2.0 * np.pi * count * u)
    flat, none = np.full_like(u, 0.5 * width), np.zeros_like(u)
    thins = np.full_like(u, thin)
    top = _rows(middle + seal * u, flat, thins, none, none, wave, wave_slope)
    below = -middle - seal + seal * u
    bottom = _rows(below, flat, thins, none, none, wave[::-1], -wave_slope[::-1])

    bottom[0][-1], top[0][0] = body[0][0], body[0][-1]  # bit by bit, so that no crack is left

    lengths = [_length_up(part) for part in (bottom, body, top)]
    total = sum(float(length[-1]) for length in lengths)
    starts = np.cumsum([-0.5 * total, lengths[0][-1], lengths[1][-1]])
    label_y = [start + length for start, length in zip(starts, lengths, strict=True)]
    patches = [
        *_sides(body, label_y[1], girth, ("back", "front", "back")),
        *_sides(top, label_y[2], girth, ("top seal",) * 3),
        *_sides(bottom, label_y[0], girth, ("bottom seal",) * 3),
        _cut(top, -1, label_y[2], girth),
        _cut(bottom, 0, label_y[0], girth),
    ]
    printed = ("front", "back", "top seal", "bottom seal")
    return joined(patches, printed, (float(girth), total), around=True, notes=notes)


def _shares() -> Array:
    """Places of columns along a quarter of a section, as shares of its length: denser at a fold."""
    return np.concatenate([np.linspace(0.0, 0.9, 19), 1.0 - 0.1 * 0.5 ** np.arange(1, 11), [1.0]])


def _quarter(a: Array, b: Array) -> Array:
    """Lengths of quarters of ellipses, by the arithmetic-geometric mean (Gauss)."""
    x, y = np.maximum(a, b), np.minimum(a, b)
    total, weight = x * x, 0.5
    total = total - weight * (x * x - y * y)
    for _ in range(12):
        x, y, c = 0.5 * (x + y), np.sqrt(x * y), 0.5 * (x - y)
        weight *= 2.0
        total = total - weight * c * c
    return np.asarray(0.5 * np.pi * total / x)


def _half_width(b: Array, girth: float) -> Array:
    """The other half axis of ellipses of one perimeter."""
    low, high = np.zeros_like(b), np.full_like(b, 0.25 * girth)
    for _ in range(60):
        middle = 0.5 * (low + high)
        long = 4.0 * _quarter(middle, b) > girth
        low, high = np.where(long, low, middle), np.where(long, middle, high)
    return 0.5 * (low + high)


def _quarter_angles(a: Array, b: Array) -> Array:
    """Angles (rows, columns) whose points lie at _shares of the quarter's length, from x = 0."""
    near = np.linspace(0.0, 1.0, 801)
    t = 0.5 * np.pi * (1.0 - (1.0 - near) ** 4)  # dense at the fold
    x, z = np.outer(a, np.sin(t)), np.outer(b, np.cos(t))
    length = np.cumsum(np.hypot(np.diff(x, axis=1), np.diff(z, axis=1)), axis=1)
    length = np.concatenate([np.zeros((len(a), 1)), length], axis=1)
    shares = _shares()
    return np.stack([np.interp(shares * row[-1], row, t) for row in length])


def _rows(
    y: Array, a: Array, b: Array, a_slope: Array, b_slope: Array, c: Array, c_slope: Array
) -> tuple[Array, Array]:
    """Points and normals (rows, columns, 3) of sections at heights y: half axes, shift along z.

    Columns run around from the middle of the back to itself. The normal is the gradient of
    (x/a)^2 + ((z - c)/b)^2 - 1.
    """
    quarter = _quarter_angles(a, b)
    half = np.concatenate([quarter, np.pi - quarter[:, -2::-1]], axis=1)  # front to back
    turn = np.concatenate([-half[:, :0:-1], half], axis=1)
    sine, cosine = np.sin(turn), np.cos(turn)
    columns = turn.shape[1]
    fold = (len(quarter[0]) - 1, columns - len(quarter[0]))
    for column, value in ((0, -1.0), (columns // 2, 1.0), (columns - 1, -1.0)):
        sine[:, column], cosine[:, column] = 0.0, value
    for column in fold:
        sine[:, column], cosine[:, column] = np.sign(column - columns // 2), 0.0
    x, z = a[:, None] * sine, b[:, None] * cosine
    points = np.stack([x, np.broadcast_to(y[:, None], x.shape), z + c[:, None]], axis=-1)
    up = -(sine**2) * (a_slope / a)[:, None] - cosine**2 * (b_slope / b)[:, None]
    up = up - cosine * (c_slope / b)[:, None]
    normals = np.stack([sine / a[:, None], up, cosine / b[:, None]], axis=-1)
    return points, normals / np.linalg.norm(normals, axis=-1, keepdims=True)


def _length_up(rows: tuple[Array, Array]) -> Array:
    """Mean length of the surface from the first row to each, over the columns by their widths."""
    points, _ = rows
    steps = np.linalg.norm(np.diff(points, axis=0), axis=-1)
    shares = _columns()
    weights = np.gradient(shares)
    return np.concatenate([[0.0], np.cumsum(steps @ weights / weights.sum())])


def _columns() -> Array:
    """Places of columns around, as parts of the girth, -0.5 to 0.5."""
    quarter = 0.25 * _shares()
    half = np.concatenate([quarter, 0.5 - quarter[-2::-1]])
    return np.concatenate([-half[:0:-1], half])


def _sides(
    rows: tuple[Array, Array], label_y: Array, girth: float, parts: tuple[str, str, str]
) -> list[Patch]:
    """The left half of the back, the front, the right half of the back."""
    points, normals = rows
    columns = points.shape[1]
    fold = (columns - 1) // 4
    label = np.stack(np.meshgrid(girth * _columns(), label_y), axis=-1)
    patches = []
    for part, low, high in zip(
        parts, (0, fold, columns - 1 - fold), (fold, columns - 1 - fold, columns - 1), strict=True
    ):
        of = np.s_[:, low : high + 1]
        shape = points[of].shape
        patches.append(
            Patch(
                part,
                points[of].reshape(-1, 3),
                normals[of].reshape(-1, 3),
                label[of].reshape(-1, 2),
                grid_triangles(shape[0], shape[1]),
            )
        )
    return patches


def _cut(rows: tuple[Array, Array], row: int, label_y: Array, girth: float) -> Patch:
    """The cut edge of a seal, between both sheets of the film."""
    points = rows[0][row]
    columns = len(points)
    fold = (columns - 1) // 4
    front = np.arange(fold, columns - fold)
    back = np.concatenate([np.arange(fold, -1, -1), np.arange(columns - 2, columns - fold - 2, -1)])
    strip = np.concatenate([points[front], points[back]])
    n = len(front)
    k = np.arange(n - 1)
    first = np.stack([k, k + 1, n + k + 1], axis=-1)
    second = np.stack([k, n + k + 1, n + k], axis=-1)
    triangles = np.concatenate([first[:-1], second[1:]])  # both sheets meet at the folds
    up = row != 0
    if not up:
        triangles = triangles[:, ::-1]
    normal = np.array([0.0, 1.0 if up else -1.0, 0.0])
    label = np.stack([np.tile(girth * _columns()[front], 2), np.full(2 * n, label_y[row])], -1)
    return Patch("cut edge", strip, np.tile(normal, (2 * n, 1)), label, triangles)
