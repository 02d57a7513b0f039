"""The tables of ICC profiles as steps: curves, nodes, curves, a matrix, curves.

Source: ICC.1:2022, 10.10 (mft2), 10.11 (mft1), 10.12 (mAB), 10.13 (mBA).
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass, field

import numpy as np

from relgloss_view.base.arrays import Array, Floats
from relgloss_view.base.icc.curves import MOST_ENTRIES, Curve, curve_of, identity, sampled

MOST_NODES = 4 << 20  #: of a table of colours
SAME = (identity,) * 3


@dataclass(frozen=True, eq=False)
class Grid:
    """A table of colours: nodes (g1, ..., gn, 3), evenly spaced over 0 to 1 in each channel."""

    nodes: Array

    @property
    def channels(self) -> int:
        """How many channels go in."""
        return self.nodes.ndim - 1


@dataclass(frozen=True, eq=False)
class Steps:
    """A table in the order in which its steps are taken.

    Forward (A2B): first, grid, middle, turn and shift, last. Backward (B2A): the same from the last
    to the first; but of tables mft turn_of_xyz, first, grid, last. turn: (3, 3), None where there
    is none. old_lab: whether CIELAB is encoded as before version 4. turn_of_xyz: (3, 3) of tables
    mft, which holds for XYZ that goes in, so backward alone.
    """

    first: tuple[Curve, ...]
    grid: Grid | None
    middle: tuple[Curve, ...] = SAME
    turn: Array | None = None
    shift: Array = field(default_factory=lambda: np.zeros(3))
    last: tuple[Curve, ...] = SAME
    old_lab: bool = False
    turn_of_xyz: Array | None = None


def table_steps(part: bytes, channels: int, *, backward: bool) -> Steps:
    """The steps of a table from `channels` to three. Raises ValueError where it is damaged."""
    kind = part[:4]
    if part[8:10] != bytes((channels, 3)):
        raise ValueError("a damaged ICC profile (a table of other channels)")
    if kind in (b"mft1", b"mft2"):
        return _old_table(part, channels, 1 if kind == b"mft1" else 2)
    if kind == (b"mBA " if backward else b"mAB "):
        return _new_table(part, channels)
    raise ValueError("an ICC profile with a table of an unknown kind")


def each(curves: tuple[Curve, ...], v: Floats) -> Floats:
    """Values (N, n) after one curve a channel."""
    if all(c is identity for c in curves):
        return v
    return np.stack([c(v[:, k]) for k, c in enumerate(curves)], axis=1)


def _grid(values: Array, shape: tuple[int, ...]) -> Grid:
    if not np.isfinite(values).all():
        raise ValueError("a damaged ICC profile (a table without numbers)")
    return Grid(values.reshape(*shape, 3))


def _check_nodes(shape: tuple[int, ...], data: int, size: int) -> int:
    nodes = math.prod(shape)
    if min(shape) < 2 or nodes > MOST_NODES or 3 * nodes * size > data:
        raise ValueError("a damaged ICC profile (a table is larger than its tag)")
    return nodes


def _old_table(part: bytes, channels: int, size: int) -> Steps:
    points = part[10]
    turn = np.array(struct.unpack_from(">9i", part, 12)).reshape(3, 3) / 65536.0
    if size == 2:
        into, out = struct.unpack_from(">HH", part, 48)
        at = 52
    else:
        into, out, at = 256, 256, 48
    if not (2 <= into <= 4096 and 2 <= out <= 4096):
        raise ValueError("a damaged ICC profile (a curve without entries)")
    kind, top = (">u2", 65535.0) if size == 2 else (">u1", 255.0)

    def numbers(count: int, at: int) -> Array:
        if at + count * size > len(part):
            raise ValueError("a damaged ICC profile (a table is larger than its tag)")
        return np.frombuffer(part, kind, count, at).astype(np.float64) / top

    first = numbers(channels * into, at).reshape(channels, into)
    at += channels * into * size
    shape = (points,) * channels
    nodes = _check_nodes(shape, len(part) - at, size)
    grid = _grid(numbers(3 * nodes, at), shape)
    last = numbers(3 * out, at + 3 * nodes * size).reshape(3, out)
    return Steps(
        tuple(sampled(row) for row in first),
        grid,
        last=tuple(sampled(row) for row in last),
        old_lab=size == 2,
        turn_of_xyz=turn,
    )


def _curves_at(part: bytes, offset: int, count: int) -> tuple[Curve, ...]:
    if offset == 0:
        return (identity,) * count
    made = []
    for _ in range(count):
        curve, size = curve_of(part[offset : offset + 12 + 2 * MOST_ENTRIES])
        made.append(curve)
        offset += (size + 3) // 4 * 4
    return tuple(made)


def _new_table(part: bytes, channels: int) -> Steps:
    b, matrix, m, clut, a = struct.unpack_from(">5I", part, 12)
    last, middle = _curves_at(part, b, 3), _curves_at(part, m, 3)
    turn, shift = None, np.zeros(3)
    if matrix:
        numbers = np.array(struct.unpack_from(">12i", part, matrix)) / 65536.0
        turn, shift = numbers[:9].reshape(3, 3), numbers[9:]
    grid: Grid | None = None
    first: tuple[Curve, ...] = (identity,) * channels
    if clut:
        shape = tuple(part[clut : clut + channels])
        size = part[clut + 16]
        if size not in (1, 2) or len(shape) != channels:
            raise ValueError("a damaged ICC profile (a table of an unknown depth)")
        nodes = _check_nodes(shape, len(part) - clut - 20, size)
        kind, top = (">u2", 65535.0) if size == 2 else (">u1", 255.0)
        grid = _grid(
            np.frombuffer(part, kind, 3 * nodes, clut + 20).astype(np.float64) / top, shape
        )
        first = _curves_at(part, a, channels)
    elif channels != 3:
        raise ValueError("a damaged ICC profile (its table is missing)")
    return Steps(first, grid, middle, turn, shift, last)
