"""ICC profiles: device values to XYZ under D50, in floating point.

A colour engine of 8 bits a channel loses up to 0.7 dE on its way out. So the tables of a profile
are read and interpolated here: matrix and curves, gray curves, and the tables mft1, mft2 and mAB.

Source: ICC.1:2022, 6.3 (encodings), 9.2 (tags), 10.6 (curv), 10.10 to 10.12 (mft1, mft2, mAB),
10.18 (para), annex D (media-relative and absolute colorimetry).
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.icc_profile import parse_profile

D50 = np.array([0.9642, 1.0, 0.8249])  #: the white of the connection space
CHANNELS = {"GRAY": 1, "RGB": 3, "Lab": 3, "CMYK": 4}
MOST_BYTES = 64 << 20  #: of a profile
MOST_NODES = 4 << 20  #: of a table of colours
MOST_ENTRIES = 1 << 16  #: of a curve
_XYZ_ONE = 1.0 + 32767.0 / 32768.0

Curve = Callable[[Array], Array]


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
    (N, 3) or (N, 1), to XYZ.
    """

    space: str
    description: str
    output: bool
    white: Array
    curves: tuple[Curve, ...]
    grid: Grid | None
    after: Callable[[Array], Array]

    @property
    def channels(self) -> int:
        """How many channels go in."""
        return CHANNELS[self.space]

    def scale(self, intent: str) -> Array:
        """Factors of XYZ for an intent; 'auto' is absolute for a print and relative else."""
        absolute = intent == "absolute" or (intent == "auto" and self.output)
        return self.white / D50 if absolute else np.ones(3)

    def xyz(self, device: Array, intent: str = "auto") -> Array:
        """XYZ under D50, (N, 3), of device values (N, channels), 0 to 1."""
        values = np.stack([c(device[:, k]) for k, c in enumerate(self.curves)], axis=1)
        if self.grid is not None:
            values = interpolated(self.grid, values)
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
        return _profile(data, head.colour_space, head.description, kind == b"prtr", pcs == b"Lab ")
    except (struct.error, IndexError) as error:
        raise ValueError(f"a damaged ICC profile ({error})") from None


def lab_space() -> Profile:
    """CIELAB as a device: channels L*/100, (a* + 128)/255, (b* + 128)/255."""
    same = (_identity,) * 3
    return Profile("Lab", "CIELAB", False, D50, same, None, lambda v: xyz_from_lab(_lab_v4(v)))


def matrix_space(description: str, to_xyz: Array, curve: Curve) -> Profile:
    """An RGB space of one curve and the matrix (3, 3) from its linear light to XYZ under D50."""
    return Profile("RGB", description, False, D50, (curve,) * 3, None, lambda v: v @ to_xyz.T)


def xyz_from_lab(lab: Array) -> Array:
    """XYZ under D50 of CIELAB values (N, 3); CIE 15:2004, 8.2.1."""
    f = np.empty_like(lab)
    f[:, 1] = (lab[:, 0] + 16.0) / 116.0
    f[:, 0] = f[:, 1] + lab[:, 1] / 500.0
    f[:, 2] = f[:, 1] - lab[:, 2] / 200.0
    return np.where(f > 6.0 / 29.0, f * f * f, (f - 4.0 / 29.0) * (108.0 / 841.0)) * D50.astype(
        lab.dtype
    )


def interpolated(grid: Grid, values: Array) -> Array:
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
    return np.matmul(monomials[:, None, :], table[index])[:, 0, :]


def cell_polynomials(grid: Grid, dtype: np.dtype) -> Array:  # type: ignore[type-arg]
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


_TABLES: dict[int, tuple[Grid, Array]] = {}


def _identity(x: Array) -> Array:
    return x


def _lab_v4(v: Array) -> Array:
    return v * np.array([100.0, 255.0, 255.0], v.dtype) - np.array([0.0, 128.0, 128.0], v.dtype)


def _profile(data: bytes, space: str, description: str, output: bool, lab: bool) -> Profile:
    count = struct.unpack_from(">I", data, 128)[0]
    tags: dict[bytes, bytes] = {}
    for tag, offset, length in struct.iter_unpack(">4sII", data[132 : 132 + 12 * count]):
        tags[tag] = data[offset : offset + length] if offset + length <= len(data) else b""
    white = np.array(_xyz_tag(tags[b"wtpt"])) if b"wtpt" in tags else D50
    if not (np.isfinite(white).all() and 0.01 <= white.min() and white.max() <= 2.0):
        white = D50
    for name in (b"A2B1", b"A2B0"):
        if name in tags:
            curves, grid, after = _table(tags[name], CHANNELS[space], lab)
            return Profile(space, description, output, white, curves, grid, after)
    if space == "GRAY" and b"kTRC" in tags:
        gray = _curve(tags[b"kTRC"])[0]

        def tone(v: Array) -> Array:
            if lab:
                return xyz_from_lab(np.concatenate([v * 100.0, 0.0 * v, 0.0 * v], axis=1))
            return v * D50

        return Profile(space, description, output, white, (gray,), None, tone)
    if space == "RGB" and all(t in tags for t in (b"rXYZ", b"gXYZ", b"bXYZ", b"rTRC")):
        to_xyz = np.array([_xyz_tag(tags[t]) for t in (b"rXYZ", b"gXYZ", b"bXYZ")]).T
        curves = tuple(_curve(tags[t])[0] for t in (b"rTRC", b"gTRC", b"bTRC") if t in tags)
        if len(curves) == 3 and np.abs(to_xyz).max() < 4.0:
            return Profile(
                space, description, output, white, curves, None, lambda v: v @ to_xyz.T
            )
    raise ValueError("an ICC profile without a table or a matrix from the device to CIELAB or XYZ")


def _xyz_tag(part: bytes) -> tuple[float, float, float]:
    x, y, z = struct.unpack_from(">iii", part, 8)
    return x / 65536.0, y / 65536.0, z / 65536.0


def _curve(part: bytes) -> tuple[Curve, int]:
    """A curve and how many bytes it takes."""
    kind = part[:4]
    if kind == b"curv":
        (count,) = struct.unpack_from(">I", part, 8)
        if count > MOST_ENTRIES or 12 + 2 * count > len(part):
            raise ValueError("a damaged ICC profile (a curve is longer than its tag)")
        if count == 0:
            return _identity, 12
        values = np.frombuffer(part, ">u2", count, 12).astype(np.float64)
        if count == 1:
            return _power(values[0] / 256.0), 14
        return _sampled(values / 65535.0), 12 + 2 * count
    if kind == b"para":
        (form,) = struct.unpack_from(">H", part, 8)
        if form > 4:
            raise ValueError("a damaged ICC profile (a curve of an unknown form)")
        n = (1, 3, 4, 5, 7)[form]
        p = [v / 65536.0 for v in struct.unpack_from(f">{n}i", part, 12)]
        return _parametric(form, p), 12 + 4 * n
    raise ValueError("a damaged ICC profile (a curve that is none)")


def _power(gamma: float) -> Curve:
    return lambda x: np.maximum(x, 0.0) ** gamma


def _sampled(values: Array) -> Curve:
    if np.allclose(values, np.linspace(0.0, 1.0, len(values)), rtol=0.0, atol=1e-6):
        return _identity
    places = np.linspace(0.0, 1.0, len(values))
    return lambda x: np.interp(x, places, values).astype(x.dtype)


def _parametric(form: int, p: list[float]) -> Curve:
    g, a, b, c, d, e, f = (*p, *(0.0,) * (7 - len(p)))
    if form == 0:
        return _power(g)
    if form == 1:
        split, slope, low, high = (-b / a if a else 0.0), 0.0, 0.0, 0.0
    elif form == 2:
        split, slope, low, high = (-b / a if a else 0.0), 0.0, c, c
    elif form == 3:
        split, slope, low, high = d, c, 0.0, 0.0
    else:
        split, slope, low, high = d, c, f, e

    def curve(x: Array) -> Array:
        upper = np.maximum(a * x + b, 0.0) ** g + high
        return np.clip(np.where(x >= split, upper, slope * x + low), 0.0, 1.0).astype(x.dtype)

    if not all(math.isfinite(v) for v in p) or g <= 0.0:
        raise ValueError("a damaged ICC profile (a curve without numbers)")
    return curve


def _table(
    part: bytes, channels: int, lab: bool
) -> tuple[tuple[Curve, ...], Grid | None, Callable[[Array], Array]]:
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
) -> tuple[tuple[Curve, ...], Grid, Callable[[Array], Array]]:
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
    outputs = tuple(_sampled(row) for row in last)
    if lab:
        # Of 8 bits the encoding is that of version 4; of 16 bits 0xFF00 is L* = 100 (10.10).
        scale = 65535.0 / 65280.0 if size == 2 else 1.0

        def after(v: Array) -> Array:
            w = _each(outputs, v)
            return xyz_from_lab(_lab_of_mft(w, scale))

    else:

        def after(v: Array) -> Array:
            return _each(outputs, v) * v.dtype.type(_XYZ_ONE)

    return tuple(_sampled(row) for row in first), grid, after


def _lab_of_mft(v: Array, scale: float) -> Array:
    if scale == 1.0:
        return _lab_v4(v)
    span = 65535.0 / 256.0
    return v * np.array([100.0 * scale, span, span], v.dtype) - np.array(
        [0.0, 128.0, 128.0], v.dtype
    )


def _each(curves: tuple[Curve, ...], v: Array) -> Array:
    if all(c is _identity for c in curves):
        return v
    return np.stack([c(v[:, k]) for k, c in enumerate(curves)], axis=1)


def _curves_at(part: bytes, offset: int, count: int) -> tuple[Curve, ...]:
    if offset == 0:
        return (_identity,) * count
    made = []
    for _ in range(count):
        curve, size = _curve(part[offset : offset + 12 + 2 * MOST_ENTRIES])
        made.append(curve)
        offset += (size + 3) // 4 * 4
    return tuple(made)


def _new_table(
    part: bytes, channels: int, lab: bool
) -> tuple[tuple[Curve, ...], Grid | None, Callable[[Array], Array]]:
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
        first = (_identity,) * 3
    else:
        raise ValueError("a damaged ICC profile (its table is missing)")

    def after(v: Array) -> Array:
        w = _each(middle, v)
        if matrix:
            w = np.clip(w @ turn.T.astype(v.dtype) + shift.astype(v.dtype), 0.0, 1.0)
        w = _each(last, w)
        return xyz_from_lab(_lab_v4(w)) if lab else w * v.dtype.type(_XYZ_ONE)

    return first, grid, after
