"""Bottles from a list of radii and heights: a smooth outline through every point.

Between the points runs a piecewise cubic of the length along them (Fritsch and Carlson 1980, with
the slopes of Fritsch and Butland 1984): it never swings beyond the points, so a straight wall
stays straight.
"""

from __future__ import annotations

import itertools

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.base.errors import InputError
from relgloss_view.pack.forms.profile import Piece, curve, line, revolved
from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.shape import Shape

CORNER_DEG = 60.0  #: where the points turn by more, the outline has an edge
UPRIGHT_DEG = 30.0  #: from upright, of walls that a label fits on
SAMPLES = 64  #: between two points


def outlined(shape: Shape) -> Mesh:
    """The form of shape.profile_mm.

    Parts: body, the largest stretch of walls no more than UPRIGHT_DEG from upright, which is
    printed; base below it; shoulder above it; neck, from the next upright wall on. Open ends are
    closed by flat discs. Raises InputError where the outline crosses itself.
    """
    points = 1e-3 * np.array(shape.profile_mm, dtype=float)
    runs = _runs(points)
    _check_simple(np.concatenate([run[:: SAMPLES // 8] for run, _ in runs]))
    pieces: list[Piece] = []
    if points[0, 0] > 0.0:
        pieces.append(line("base", (0.0, points[0, 1]), (points[0, 0], points[0, 1])))
    parts = _parts(runs)
    for (run, tangents), names in zip(runs, parts, strict=True):
        starts = np.flatnonzero(np.concatenate([[True], names[1:] != names[:-1]]))
        for low, high in zip(starts, [*starts[1:], len(names)], strict=True):
            of = np.s_[low : high + 1]
            given = range(-low % SAMPLES, high + 1 - low, SAMPLES)
            pieces.append(curve(str(names[low]), run[of], tangents[of], given))
    if points[-1, 0] > 0.0:
        last = pieces[-1].part
        end = (float(points[-1, 0]), float(points[-1, 1]))
        pieces.append(line("lid" if last == "body" else last, end, (0.0, end[1])))
    return revolved(pieces, ("body",))


def smooth_through(points: Array) -> tuple[Array, Array]:
    """Points of the curve through `points` (n, 2), and its derivative there; n at least 2."""
    chords = np.hypot(*np.diff(points, axis=0).T)
    secants = np.diff(points, axis=0) / chords[:, None]
    slopes = np.stack([_slopes(secants[:, k], chords) for k in range(2)], axis=-1)
    t = np.linspace(0.0, 1.0, SAMPLES + 1)[None, :, None]
    h = chords[:, None, None]
    a, b = points[:-1, None], points[1:, None]
    m, n = h * slopes[:-1, None], h * slopes[1:, None]
    # The cubic of Hermite.
    at = (
        a * (1 + 2 * t) * (1 - t) ** 2
        + m * t * (1 - t) ** 2
        + b * t * t * (3 - 2 * t)
        + n * t * t * (t - 1)
    )
    tangent = ((b - a) * 6 * t * (1 - t) + m * (1 - t) * (1 - 3 * t) + n * t * (3 * t - 2)) / h
    joined = [at[:, :-1].reshape(-1, 2), points[-1:]]
    tangents = [tangent[:, :-1].reshape(-1, 2), tangent[-1:, -1]]
    return np.concatenate(joined), np.concatenate(tangents)


def _slopes(secants: Array, chords: Array) -> Array:
    """Derivatives at the points: harmonic means of the neighbouring secants, 0 at extremes."""
    if len(secants) == 1:
        return np.repeat(secants, 2)
    left, right = secants[:-1], secants[1:]
    wr, wl = 2.0 * chords[:-1] + chords[1:], chords[:-1] + 2.0 * chords[1:]
    same = left * right > 0.0
    safe_left, safe_right = np.where(same, left, 1.0), np.where(same, right, 1.0)
    inner = np.where(same, (wl + wr) / (wl / safe_left + wr / safe_right), 0.0)
    return np.concatenate(
        [
            [_end_slope(secants[0], secants[1], chords[0], chords[1])],
            inner,
            [_end_slope(secants[-1], secants[-2], chords[-1], chords[-2])],
        ]
    )


def _end_slope(first: float, second: float, h: float, k: float) -> float:
    """The slope of the parabola through three points, held so that it does not overshoot."""
    slope = ((2.0 * h + k) * first - h * second) / (h + k)
    if slope * first <= 0.0:
        return 0.0
    if first * second <= 0.0 and abs(slope) > 3.0 * abs(first):
        return 3.0 * first
    return slope


def _runs(points: Array) -> list[tuple[Array, Array]]:
    """Smooth runs between corners: points and tangents."""
    steps = np.diff(points, axis=0)
    direction = np.degrees(np.arctan2(steps[:, 1], steps[:, 0]))
    turn = np.abs((np.diff(direction) + 180.0) % 360.0 - 180.0)
    corners = np.flatnonzero(turn > CORNER_DEG) + 1
    ends = [0, *corners.tolist(), len(points) - 1]
    return [smooth_through(points[low : high + 1]) for low, high in itertools.pairwise(ends)]


def _parts(runs: list[tuple[Array, Array]]) -> list[np.ndarray[tuple[int], np.dtype[np.str_]]]:
    """The part of each interval between two points of each run."""
    r = np.concatenate([0.5 * (run[1:, 0] + run[:-1, 0]) for run, _ in runs])
    steps = np.concatenate([np.diff(run, axis=0) for run, _ in runs])
    length = np.hypot(*steps.T)
    upright = steps[:, 1] >= np.cos(np.radians(UPRIGHT_DEG)) * length
    begins, ends = _stretches(upright)
    names = np.full(len(r), "shoulder", dtype="<U8")
    if len(begins):
        areas = [float(np.sum((r * length)[b:e])) for b, e in zip(begins, ends, strict=True)]
        body = int(np.argmax(areas))
        names[: begins[body]] = "base"
        names[begins[body] : ends[body]] = "body"
        if body + 1 < len(begins):
            names[begins[body + 1] :] = "neck"
    else:
        names[:] = "body"  # a dish: there is no wall, so that all of it may be printed
    counts = np.cumsum([len(run) - 1 for run, _ in runs])[:-1]
    return list(np.split(names, counts))


def _stretches(upright: Mask) -> tuple[Ints, Ints]:
    edges = np.diff(np.concatenate([[0], upright.astype(np.int64), [0]]))
    return np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)


def _check_simple(points: Array) -> None:
    """InputError where two parts of the outline cross: it would have no inside."""
    a, b = points[:-1], points[1:]
    d = b - a

    def side(of: Array, along: Array, point: Array) -> Array:
        rel = point[None] - of[:, None]
        return np.asarray(along[:, None, 0] * rel[..., 1] - along[:, None, 1] * rel[..., 0])

    crosses = (side(a, d, a) * side(a, d, b) < 0.0) & ((side(a, d, a) * side(a, d, b)).T < 0.0)
    if crosses.any():
        first = points[int(np.argwhere(crosses)[0, 0])] * 1e3
        raise InputError(
            f"shape.profile_mm: the outline crosses itself near ({first[0]:.4g}, {first[1]:.4g}); "
            "give its points from the base upwards"
        )
