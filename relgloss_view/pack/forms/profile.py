"""Surfaces of revolution about y, from a profile of lines, arcs and smooth curves.

A profile runs from the axis below to the axis above, with the inside on its left, so that its
normal (dy, -dr) shows outwards. Normals come from the curve itself and not from facets.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.pack.forms.patches import Patch, joined
from relgloss_view.pack.mesh import Mesh

#: Sides of the widest ring, a power of 2. The middle of a side lies 4e-5 of its diameter too deep:
#: a twentieth of a pixel where the form is 1300 pixels wide.
SIDES = 256
FEWEST_SIDES = 16
#: Of a curve between two of its points: so much that the middle of the chord lies DEEPEST too deep,
#: but not less or more than these.
LEAST_TURN, MOST_TURN = np.radians(1.0), np.radians(11.25)
DEEPEST = 8e-6  #: metres


@dataclass(frozen=True)
class Piece:
    """A smooth piece of a profile; at the ends of pieces there may be edges.

    points: (n, 2), radius and height, metres. normals: (n, 2), unit vectors. along: (n,), length of
    the curve from its beginning, metres. part: of the form.
    """

    part: str
    points: Array
    normals: Array
    along: Array


def line(part: str, start: tuple[float, float], end: tuple[float, float]) -> Piece:
    """A straight piece between two points (radius, height)."""
    points = np.array([start, end], dtype=float)
    step = points[1] - points[0]
    length = float(np.hypot(*step))
    normal = np.array([step[1], -step[0]]) / length
    return Piece(part, points, np.tile(normal, (2, 1)), np.array([0.0, length]))


def arc(
    part: str,
    centre: tuple[float, float],
    radius: float,
    start_deg: float,
    end_deg: float,
) -> Piece:
    """A piece of a circle; angles from the outward direction (+r) towards +y.

    An increasing angle bulges outwards, a decreasing one is hollow.
    """
    turn = np.radians(end_deg - start_deg)
    count = max(2, int(np.ceil(abs(turn) / _turn(np.array(radius)))) + 1)
    degrees = np.linspace(start_deg, end_deg, count)
    quarters = np.arange(-360.0, 361.0, 90.0)  # where the arc is lowest, highest, widest
    inside = (quarters > degrees.min() + 1e-9) & (quarters < degrees.max() - 1e-9)
    degrees = np.unique(np.concatenate([degrees, quarters[inside]]))
    degrees = degrees if turn > 0.0 else degrees[::-1]
    angle = np.radians(degrees)
    outwards = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    outwards[np.abs(outwards) < 1e-15] = 0.0
    points = np.asarray(centre) + radius * outwards
    along = radius * np.abs(angle - angle[0])
    return Piece(part, points, outwards if turn > 0 else -outwards, along)


def _turn(radius: Array) -> Array:
    """How far a curve of a radius may turn in one step, radians."""
    return np.asarray(np.clip(np.sqrt(8.0 * DEEPEST / radius), LEAST_TURN, MOST_TURN))


def curve(part: str, points: Array, tangents: Array, always: Sequence[int] = ()) -> Piece:
    """A piece of a smooth curve, from many points (n, 2) of it and its derivative there.

    As few of the points are kept as its turning allows, and those numbered in `always`.
    """
    length = np.hypot(*tangents.T)
    directions = tangents / length[:, None]
    step = np.diff(points, axis=0)
    chord = np.hypot(*step.T)
    cross = directions[:-1, 0] * directions[1:, 1] - directions[:-1, 1] * directions[1:, 0]
    turn = np.abs(np.arctan2(cross, np.sum(directions[:-1] * directions[1:], axis=1)))
    # An arc is longer than its chord by turn^2/24.
    along = np.concatenate([[0.0], np.cumsum(chord * (1.0 + turn**2 / 24.0))])
    with np.errstate(divide="ignore"):
        share = turn / _turn(chord / turn)
    turned = np.concatenate([[0.0], np.cumsum(share)]) + 4.0 * along / along[-1]
    kept = np.unique(np.searchsorted(turned, np.arange(np.ceil(turned[-1])), side="left"))
    kept = np.unique([*kept, *always, len(points) - 1])
    normals = np.stack([directions[:, 1], -directions[:, 0]], axis=-1)
    return Piece(part, points[kept], normals[kept], along[kept])


def bezier(
    part: str,
    start: tuple[float, float],
    start_handle: tuple[float, float],
    end_handle: tuple[float, float],
    end: tuple[float, float],
) -> Piece:
    """A cubic Bezier curve."""
    t = np.linspace(0.0, 1.0, 513)[:, None]
    p0, p1, p2, p3 = (np.array(p, dtype=float) for p in (start, start_handle, end_handle, end))
    u = 1.0 - t
    points = u**3 * p0 + 3.0 * u * u * t * p1 + 3.0 * u * t * t * p2 + t**3 * p3
    tangents = 3.0 * (u * u * (p1 - p0) + 2.0 * u * t * (p2 - p1) + t * t * (p3 - p2))
    points[0], points[-1] = p0, p3
    return curve(part, points, tangents)


def revolved(
    pieces: Sequence[Piece], printed: tuple[str, ...] = ("body",), notes: tuple[str, ...] = ()
) -> Mesh:
    """The surface that a profile makes when it turns about y.

    Label: x is the angle times the largest radius of the printed parts, so that artwork narrows
    where the form does; y is the length along the profile. The label's middle is at the middle of
    the printed length. The seam is at the back.

    >>> mesh = revolved([line("body", (0.03, -0.05), (0.03, 0.05))])
    >>> mesh.points_m.max(axis=0).tolist(), len(mesh.triangles)
    ([0.03, 0.05, 0.03], 512)
    """
    on_label = [piece for piece in pieces if piece.part in printed]
    radius = max(float(piece.points[:, 0].max()) for piece in on_label)
    widest = max(float(piece.points[:, 0].max()) for piece in pieces)
    pieces = _closed(pieces)
    begins = np.concatenate([[0.0], np.cumsum([piece.along[-1] for piece in pieces])])
    spans = [(begins[k], begins[k + 1]) for k, piece in enumerate(pieces) if piece.part in printed]
    low, high = spans[0][0], spans[-1][1]
    patches = [
        _turned(piece, begin - 0.5 * (low + high), radius, widest)
        for piece, begin in zip(pieces, begins, strict=False)
    ]
    size = (2.0 * np.pi * radius, float(high - low))
    return joined(patches, printed, size, around=True, notes=notes)


def _closed(pieces: Sequence[Piece]) -> list[Piece]:
    """The pieces with the end of each at the beginning of the next one, bit by bit."""
    closed: list[Piece] = []
    for piece in pieces:
        points = piece.points.copy()
        if closed:
            points[0] = closed[-1].points[-1]
        closed.append(dataclasses.replace(piece, points=points))
    return closed


def _turned(piece: Piece, begin: float, radius: float, widest: float) -> Patch:
    rings = [_ring(float(r), widest) for r in piece.points[:, 0]]
    if rings[0] == 0:
        rings[0] = -rings[1]
    if rings[-1] == 0:
        rings[-1] = -rings[-2]
    angles = [_angles(count) for count in rings]
    counts = [len(angle) for angle in angles]
    angle = np.concatenate(angles)
    row = np.repeat(np.arange(len(rings)), counts)
    sine, cosine = _sine(angle), _sine(angle + 0.25)
    r, y = piece.points[row].T
    out, up = piece.normals[row].T
    points = np.stack([r * sine, y, r * cosine], axis=-1)
    normals = np.stack([out * sine, up, out * cosine], axis=-1)
    label = np.stack([2.0 * np.pi * radius * angle, begin + piece.along[row]], axis=-1)
    first = np.concatenate([[0], np.cumsum(counts)])
    strips = [
        _strip(int(first[k]), rings[k], int(first[k + 1]), rings[k + 1])
        for k in range(len(rings) - 1)
    ]
    return Patch(piece.part, points, normals, label, np.concatenate(strips))


def _ring(radius: float, widest: float) -> int:
    """Sides of a ring: half as many at half the radius; 0 on the axis."""
    if radius <= 0.0:
        return 0
    halvings = int(np.floor(np.log2(widest / radius) + 1e-9))
    return max(FEWEST_SIDES, SIDES >> min(halvings, 20))


def _angles(sides: int) -> Array:
    """Angles of a ring's points as parts of a turn, from the back to the back.

    A pole (-sides) has a point for each side, at its middle, so that each triangle there has the
    label and the normal of its own direction.
    """
    if sides < 0:
        return (np.arange(-sides) + 0.5) / -sides - 0.5
    return np.arange(sides + 1) / sides - 0.5


def directions_of(sides: int) -> tuple[Array, Array]:
    """Sines and cosines of a ring's points, as many sides as `_angles` takes."""
    angle = _angles(sides)
    return _sine(angle), _sine(angle + 0.25)


def _sine(turns: Array) -> Array:
    """sin of parts of a turn, exactly periodic and symmetric, so that seams close bit by bit."""
    t = turns - np.round(turns)
    folded = np.where(np.abs(t) > 0.25, np.copysign(0.5, t) - t, t)
    return np.where(np.abs(folded) == 0.25, np.sign(folded), np.sin(2.0 * np.pi * folded))


def _strip(first: int, sides: int, second: int, upper_sides: int) -> Ints:
    """Triangles between two rings; where one has fewer sides, each of its sides serves several."""
    if upper_sides < 0:
        k = np.arange(sides)
        return np.stack([first + k, first + k + 1, second + k], axis=-1)
    if sides < 0:
        k = np.arange(upper_sides)
        return np.stack([first + k, second + k + 1, second + k], axis=-1)
    fine, coarse = max(sides, upper_sides), min(sides, upper_sides)
    share = fine // coarse
    k = np.arange(fine)
    # Each side of the finer ring has its third point at the nearer end of the coarser ring's side.
    near = (k + share // 2) // share if share > 1 else k
    j = np.arange(coarse)
    middle = j * share + (share + 1) // 2 if share > 1 else j + 1
    if sides == fine:
        of_fine = np.stack([first + k, first + k + 1, second + near], axis=-1)
        of_coarse = np.stack([first + middle, second + j + 1, second + j], axis=-1)
    else:
        of_fine = np.stack([second + k + 1, second + k, first + near], axis=-1)
        of_coarse = np.stack([first + j, first + j + 1, second + middle], axis=-1)
    return np.concatenate([of_fine, of_coarse])
