"""ICC profiles: device values to XYZ under D50, in floating point.

A colour engine of 8 bits a channel loses up to 0.7 dE on its way out. So the tables of a profile
are read and interpolated here: matrix and curves, gray curves, and the tables mft1, mft2 and mAB.

Source: ICC.1:2022, 6.3 (encodings), 9.2 (tags), 10.6 (curv), 10.10 to 10.12 (mft1, mft2, mAB),
10.18 (para), annex D (media-relative and absolute colorimetry).
"""

from __future__ import annotations

import dataclasses
import math
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array, Floats
from relgloss_view.base.icc.curves import (
    MOST_ENTRIES,
    Curve,
    curve_of,
    identity,
    sampled,
)
from relgloss_view.base.icc.header import parse_profile

D50 = np.array([0.9642, 1.0, 0.8249])  #: the white of the connection space (ICC.1:2022)
CHANNELS = {"GRAY": 1, "RGB": 3, "Lab": 3, "CMYK": 4}
MOST_BYTES = 64 << 20  #: of a profile
MOST_NODES = 4 << 20  #: of a table of colours
_XYZ_ONE = 1.0 + 32767.0 / 32768.0


@dataclass(frozen=True, eq=False)
class Grid:
    """A table of colours: nodes (g1, ..., gn, 3), evenly spaced over 0 to 1 in each channel."""

    nodes: Array

    @property
    def channels(self) -> int:
        """How many channels go in."""
        return self.nodes.ndim - 1


@dataclass(frozen=True, eq=False)
class Profile:
    """How the values of a device become XYZ relative to its white, in steps.

    space: a key of CHANNELS. output: whether it is of a print, so that its white is a paper.
    white: XYZ of the medium under D50, Y = 1 the perfect diffuser. curves: one a channel. grid:
    None where the curves' values are linear light. after: from what the curves or the grid give,
    (N, 3) or (N, 1), to XYZ. matrix: (3, 3), where `after` is it alone. tags: the data of each tag,
    none where it lies outside the file.
    """

    space: str
    description: str
    output: bool
    white: Array
    curves: tuple[Curve, ...]
    grid: Grid | None
    after: Callable[[Floats], Floats]
    matrix: Array | None = None
    tags: Mapping[bytes, bytes] = field(default_factory=dict, repr=False)

    @property
    def channels(self) -> int:
        """How many channels go in."""
        return CHANNELS[self.space]

    def scale(self, intent: str) -> Array:
        """Factors of XYZ for an intent; 'auto' is absolute for a print and relative else."""
        absolute = intent == "absolute" or (intent == "auto" and self.output)
        return self.white / D50 if absolute else np.ones(3)

    def xyz(
        self,
        device: Floats,
        intent: str = "auto",
        between: Callable[[Grid, Floats], Floats] | None = None,
    ) -> Floats:
        """XYZ under D50, (N, 3), of device values (N, channels), 0 to 1.

        between: how the nodes of a grid are interpolated; None: multilinear.
        """
        values = np.stack([c(device[:, k]) for k, c in enumerate(self.curves)], axis=1)
        if self.grid is not None:
            values = (between or interpolated)(self.grid, values)
        return self.after(values) * self.scale(intent)


def read_profile(data: bytes) -> Profile:
    """The profile of a file's bytes. Raises ValueError with the reason where it can't be used."""
    if len(data) > MOST_BYTES:
        raise ValueError(f"an ICC profile larger than {MOST_BYTES} bytes")
    head = parse_profile(data)
    if head.colour_space not in CHANNELS:
        raise ValueError(f"an ICC profile of {head.colour_space}, which is not read")
    kind = data[12:16]
    if kind in (b"link", b"nmcl", b"abst"):
        raise ValueError("an ICC profile that is not one of a device")
    pcs = data[20:24]
    if pcs not in (b"Lab ", b"XYZ "):
        raise ValueError("an ICC profile without CIELAB or XYZ")
    try:
        tags = tags_of(data)
        profile = _profile(
            tags, head.colour_space, head.description, kind == b"prtr", pcs == b"Lab "
        )
        return dataclasses.replace(profile, tags=tags)
    except (struct.error, IndexError) as error:
        raise ValueError(f"a damaged ICC profile ({error})") from None


def lab_space() -> Profile:
    """CIELAB as a device: channels L*/100, (a* + 128)/255, (b* + 128)/255."""
    same = (identity,) * 3
    return Profile("Lab", "CIELAB", False, D50, same, None, lambda v: xyz_from_lab(_lab_v4(v)))


def matrix_space(description: str, to_xyz: Floats, curve: Curve) -> Profile:
    """An RGB space of one curve and the matrix (3, 3) from its linear light to XYZ under D50."""
    return Profile(
        "RGB", description, False, D50, (curve,) * 3, None, lambda v: v @ to_xyz.T.astype(v.dtype)
    )


def xyz_from_lab(lab: Floats) -> Floats:
    """XYZ under D50 of CIELAB values (N, 3); CIE 15:2004, 8.2.1."""
    f = np.empty_like(lab)
    f[:, 1] = (lab[:, 0] + 16.0) / 116.0
    f[:, 0] = f[:, 1] + lab[:, 1] / 500.0
    f[:, 2] = f[:, 1] - lab[:, 2] / 200.0
    return np.where(f > 6.0 / 29.0, f * f * f, (f - 4.0 / 29.0) * (108.0 / 841.0)) * D50.astype(
        lab.dtype
    )


def interpolated(grid: Grid, values: Floats) -> Floats:
    """Values of a grid between its nodes, multilinear; values (N, n) are clipped to 0 to 1."""
    shape = grid.nodes.shape[:-1]
    index = np.zeros(len(values), np.int64)
    monomials = np.ones((len(values), 1), values.dtype)
    for k, count in enumerate(shape):
        place = np.clip(values[:, k], 0.0, 1.0) * (count - 1)
        cell = np.minimum(place.astype(np.int64), count - 2)
        index = index * (count - 1) + cell
        part = (place - cell)[:, None]
        monomials = np.concatenate([monomials, monomials * part], axis=1)
    table = cell_polynomials(grid, values.dtype)
    return np.asarray(np.matmul(monomials[:, None, :], table[index])[:, 0, :])


def cell_polynomials(grid: Grid, dtype: np.dtype[Any]) -> Floats:
    """Multilinear interpolation as polynomials: (cells, 2^n, 3) coefficients of the monomials.

    Monomial m is the product of the fractions of the channels whose bits are set in m, the first
    channel the lowest bit. One gather a colour then takes the place of 2^n.
    """
    cached = _TABLES.get(id(grid))
    if cached is not None and cached[0] is grid and cached[1].dtype == dtype:
        return cached[1]
    n = grid.channels
    parts = [grid.nodes]
    for k in range(n):
        low = (slice(None),) * k + (slice(None, -1),)
        high = (slice(None),) * k + (slice(1, None),)
        parts = [p[low] for p in parts] + [p[high] - p[low] for p in parts]
    table = np.stack(parts, axis=-2).reshape(-1, 2**n, 3).astype(dtype)
    if len(_TABLES) >= 4:
        _TABLES.clear()
    _TABLES[id(grid)] = (grid, table)
    return table


_TABLES: dict[int, tuple[Grid, Floats]] = {}


def _lab_v4(v: Floats) -> Floats:
    return v * np.array([100.0, 255.0, 255.0], v.dtype) - np.array([0.0, 128.0, 128.0], v.dtype)


def tags_of(data: bytes) -> dict[bytes, bytes]:
    """The data of each tag of a profile whose header was parsed; none where it lies outside."""
    count = struct.unpack_from(">I", data, 128)[0]
    tags: dict[bytes, bytes] = {}
    for tag, offset, length in struct.iter_unpack(">4sII", data[132 : 132 + 12 * count]):
        tags[tag] = data[offset : offset + length] if offset + length <= len(data) else b""
    return tags


def _profile(
    tags: dict[bytes, bytes], space: str, description: str, output: bool, lab: bool
) -> Profile:
    white = np.array(_xyz_tag(tags[b"wtpt"])) if b"wtpt" in tags else D50
    if not (np.isfinite(white).all() and white.min() >= 0.01 and white.max() <= 2.0):
        white = D50
    for name in (b"A2B1", b"A2B0"):
        if name in tags:
            curves, grid, after = _table(tags[name], CHANNELS[space], lab)
            return Profile(space, description, output, white, curves, grid, after)
    if space == "GRAY" and b"kTRC" in tags:
        gray = curve_of(tags[b"kTRC"])[0]

        def tone(v: Floats) -> Floats:
            if lab:
                return xyz_from_lab(np.concatenate([v * 100.0, 0.0 * v, 0.0 * v], axis=1))
            return v * D50.astype(v.dtype)

        return Profile(space, description, output, white, (gray,), None, tone)
    if space == "RGB" and all(t in tags for t in (b"rXYZ", b"gXYZ", b"bXYZ", b"rTRC")):
        to_xyz = np.array([_xyz_tag(tags[t]) for t in (b"rXYZ", b"gXYZ", b"bXYZ")]).T
        curves = tuple(curve_of(tags[t])[0] for t in (b"rTRC", b"gTRC", b"bTRC") if t in tags)
        if len(curves) == 3 and np.abs(to_xyz).max() < 4.0:
            return Profile(
                space,
                description,
                output,
                white,
                curves,
                None,
                lambda v: v @ to_xyz.T.astype(v.dtype),
                to_xyz,
            )
    raise ValueError("an ICC profile without a table or a matrix from the device to CIELAB or XYZ")


def _xyz_tag(part: bytes) -> tuple[float, float, float]:
    x, y, z = struct.unpack_from(">iii", part, 8)
    return x / 65536.0, y / 65536.0, z / 65536.0


def _table(
    part: bytes, channels: int, lab: bool
) -> tuple[tuple[Curve, ...], Grid | None, Callable[[Floats], Floats]]:
    kind = part[:4]
    if part[8:10] != bytes((channels, 3)):
        raise ValueError("a damaged ICC profile (a table of other channels)")
    if kind in (b"mft1", b"mft2"):
        return _old_table(part, channels, lab, 1 if kind == b"mft1" else 2)
    if kind == b"mAB ":
        return _new_table(part, channels, lab)
    raise ValueError("an ICC profile with a table of an unknown kind")


def _grid(values: Array, shape: tuple[int, ...]) -> Grid:
    if not np.isfinite(values).all():
        raise ValueError("a damaged ICC profile (a table without numbers)")
    return Grid(values.reshape(*shape, 3))


def _check_nodes(shape: tuple[int, ...], data: int, size: int) -> int:
    nodes = math.prod(shape)
    if min(shape) < 2 or nodes > MOST_NODES or 3 * nodes * size > data:
        raise ValueError("a damaged ICC profile (a table is larger than its tag)")
    return nodes


def _old_table(
    part: bytes, channels: int, lab: bool, size: int
) -> tuple[tuple[Curve, ...], Grid, Callable[[Floats], Floats]]:
    points = part[10]
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
    outputs = tuple(sampled(row) for row in last)
    if lab:
        # Of 8 bits the encoding is that of version 4; of 16 bits 0xFF00 is L* = 100 (10.10).
        scale = 65535.0 / 65280.0 if size == 2 else 1.0

        def after(v: Floats) -> Floats:
            w = _each(outputs, v)
            return xyz_from_lab(_lab_of_mft(w, scale))

    else:

        def after(v: Floats) -> Floats:
            return _each(outputs, v) * v.dtype.type(_XYZ_ONE)

    return tuple(sampled(row) for row in first), grid, after


def _lab_of_mft(v: Floats, scale: float) -> Floats:
    if scale == 1.0:
        return _lab_v4(v)
    span = 65535.0 / 256.0
    return v * np.array([100.0 * scale, span, span], v.dtype) - np.array(
        [0.0, 128.0, 128.0], v.dtype
    )


def _each(curves: tuple[Curve, ...], v: Floats) -> Floats:
    if all(c is identity for c in curves):
        return v
    return np.stack([c(v[:, k]) for k, c in enumerate(curves)], axis=1)


def _curves_at(part: bytes, offset: int, count: int) -> tuple[Curve, ...]:
    if offset == 0:
        return (identity,) * count
    made = []
    for _ in range(count):
        curve, size = curve_of(part[offset : offset + 12 + 2 * MOST_ENTRIES])
        made.append(curve)
        offset += (size + 3) // 4 * 4
    return tuple(made)


def _new_table(
    part: bytes, channels: int, lab: bool
) -> tuple[tuple[Curve, ...], Grid | None, Callable[[Floats], Floats]]:
    b, matrix, m, clut, a = struct.unpack_from(">5I", part, 12)
    last, middle = _curves_at(part, b, 3), _curves_at(part, m, 3)
    turn, shift = np.eye(3), np.zeros(3)
    if matrix:
        numbers = np.array(struct.unpack_from(">12i", part, matrix)) / 65536.0
        turn, shift = numbers[:9].reshape(3, 3), numbers[9:]
    grid = None
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
    elif channels == 3:
        first = (identity,) * 3
    else:
        raise ValueError("a damaged ICC profile (its table is missing)")

    def after(v: Floats) -> Floats:
        w = _each(middle, v)
        if matrix:
            w = np.clip(w @ turn.T.astype(v.dtype) + shift.astype(v.dtype), 0.0, 1.0)
        w = _each(last, w)
        return xyz_from_lab(_lab_v4(w)) if lab else w * v.dtype.type(_XYZ_ONE)

    return first, grid, after
