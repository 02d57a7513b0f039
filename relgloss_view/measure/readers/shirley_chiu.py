"""The square that tensor trees are cut in: its map to the disk of directions, and angles of trees.

A direction above the horizon is a point (x, y) of the unit disk, its projection; the disk is mapped
to the unit square with areas kept (Shirley, Chiu 1997, Journal of Graphics Tools 2/3), so that
cells of one size are patches of one projected solid angle.

An isotropic tree of three coordinates holds incidence as 1/2 - sin(theta_i) / 2, and the square of
the outgoing direction, turned so that the mirror direction lies at azimuth 0. A tree of four holds
the square of where the incoming light goes, minus its direction of arrival's projection, and that
of the outgoing direction (Ward, Mistrick, Lee, McNeil, Jonsson 2011; Radiance's bsdf_t.c).
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array

QUARTER = 0.25 * np.pi


def to_square(x: Array, y: Array) -> tuple[Array, Array]:
    """Points of the unit disk to the unit square.

    >>> [float(v) for v in to_square(np.array(1.0), np.array(0.0))]
    [1.0, 0.5]
    """
    r = np.hypot(x, y)
    phi = np.arctan2(y, x)
    phi = np.where(phi < -QUARTER, phi + 2.0 * np.pi, phi)
    quarter = np.clip(((phi + QUARTER) / (2.0 * QUARTER)).astype(np.intp), 0, 3)
    across = r * (phi - 2.0 * QUARTER * quarter) / QUARTER
    a = np.choose(quarter, [r, -across, -r, across])
    b = np.choose(quarter, [across, r, -across, -r])
    return 0.5 * (a + 1.0), 0.5 * (b + 1.0)


def to_disk(u: Array, v: Array) -> tuple[Array, Array]:
    """Points of the unit square to the unit disk; the inverse of `to_square`.

    >>> [round(float(v), 6) for v in to_disk(np.array(0.5), np.array(0.75))]
    [0.0, 0.5]
    """
    a, b = 2.0 * np.asarray(u) - 1.0, 2.0 * np.asarray(v) - 1.0
    wide = np.abs(a) > np.abs(b)
    r = np.where(wide, a, b)
    other = np.where(wide, b, a)
    share = other / np.where(r == 0.0, 1.0, r)
    phi = np.where(wide, QUARTER * share, 2.0 * QUARTER - QUARTER * share)
    return r * np.cos(phi), r * np.sin(phi)


def upward(x: Array, y: Array) -> Array:
    """Unit vectors (..., 3) above the horizon of points in the disk."""
    return np.stack([x, y, np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))], axis=-1)


def coordinates(i: Array, o: Array, rank: int) -> Array:
    """Tree coordinates (M, rank), 0 to below 1, of unit vectors to the lamp and to the eye (M, 3).

    rank: 3 or 4.
    """
    if rank == 4:
        squares = (*to_square(-i[:, 0], -i[:, 1]), *to_square(o[:, 0], o[:, 1]))
        places = np.stack(squares, axis=-1)
    else:
        sine = np.hypot(i[:, 0], i[:, 1])
        lit = sine > 0.0
        cos = np.where(lit, -i[:, 0] / np.where(lit, sine, 1.0), 1.0)
        sin = np.where(lit, -i[:, 1] / np.where(lit, sine, 1.0), 0.0)
        x, y = o[:, 0] * cos + o[:, 1] * sin, o[:, 1] * cos - o[:, 0] * sin
        # Incidence along the normal belongs to the half of the tree that is used.
        places = np.stack([0.5 - 1e-7 - 0.5 * sine, *to_square(x, y)], axis=-1)
    return np.clip(places, 0.0, 1.0 - 1e-9)


def directions(places: Array) -> tuple[Array, Array]:
    """Unit vectors to the lamp and to the eye, (M, 3) each, of tree coordinates (M, 3 or 4).

    Of a tree of three, the lamp has azimuth 180 degrees.
    """
    if places.shape[1] == 4:
        x, y = to_disk(places[:, 0], places[:, 1])
        return upward(-x, -y), upward(*to_disk(places[:, 2], places[:, 3]))
    sine = np.clip(1.0 - 2.0 * places[:, 0], 0.0, 1.0)
    return upward(-sine, np.zeros_like(sine)), upward(*to_disk(places[:, 1], places[:, 2]))
