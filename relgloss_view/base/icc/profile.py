"""ICC profiles: device values to XYZ under D50, in floating point.

A colour engine of 8 bits a channel loses up to 0.7 dE on its way out. So the tables of a profile
are read and interpolated here: matrix and curves, gray curves, and the tables mft1, mft2 and mAB.

Source: ICC.1:2022, 6.3 (encodings), 9.2 (tags), 10.6 (curv), 10.10 to 10.12 (mft1, mft2, mAB),
10.18 (para), annex D (media-relative and absolute colorimetry).
"""

from __future__ import annotations

import dataclasses
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array, Floats
from relgloss_view.base.icc.curves import Curve, curve_of, identity
from relgloss_view.base.icc.header import parse_profile
from relgloss_view.base.icc.tables import Grid, Steps, each, table_steps

D50 = np.array([0.9642, 1.0, 0.8249])  #: the white of the connection space (ICC.1:2022)
XYZ_ONE = 1.0 + 32767.0 / 32768.0  #: the largest value of XYZ in the connection space
CHANNELS = {"GRAY": 1, "RGB": 3, "Lab": 3, "CMYK": 4}
MOST_BYTES = 64 << 20  #: of a profile


@dataclass(frozen=True, eq=False)
class Profile:
    """How the values of a device become XYZ relative to its white, in steps.

    space: a key of CHANNELS. output: whether it is of a print, so that its white is a paper.
    white: XYZ of the medium under D50, Y = 1 the perfect diffuser. curves: one a channel. grid:
    None where the curves' values are linear light. after: from what the curves or the grid give,
    (N, 3) or (N, 1), to XYZ. matrix: (3, 3), where `after` is it alone. tags: the data of each tag,
    none where it lies outside the file. lab: whether the connection space is CIELAB.
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
    lab: bool = False

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
        return dataclasses.replace(profile, tags=tags, lab=pcs == b"Lab ")
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


def _after(steps: Steps, lab: bool) -> Callable[[Floats], Floats]:
    """From what the grid of a table gives to XYZ."""

    def after(v: Floats) -> Floats:
        w = each(steps.middle, v)
        if steps.turn is not None:
            shift = steps.shift.astype(v.dtype)
            w = np.clip(w @ steps.turn.T.astype(v.dtype) + shift, 0.0, 1.0)
        w = each(steps.last, w)
        if not lab:
            return w * v.dtype.type(XYZ_ONE)
        return xyz_from_lab(_lab_v2(w) if steps.old_lab else _lab_v4(w))

    return after


def _lab_v2(v: Floats) -> Floats:
    """CIELAB of 16 bits before version 4, and of tables mft2: 0xFF00 is L* = 100 (10.10)."""
    span = 65535.0 / 256.0
    return v * np.array([100.0 * 65535.0 / 65280.0, span, span], v.dtype) - np.array(
        [0.0, 128.0, 128.0], v.dtype
    )


def _lab_v4(v: Floats) -> Floats:
    return v * np.array([100.0, 255.0, 255.0], v.dtype) - np.array([0.0, 128.0, 128.0], v.dtype)


def tags_of(data: bytes) -> dict[bytes, bytes]:
    """The data of each tag of a profile whose header was parsed; none where it lies outside.

    Tags may share data. Raises ValueError where they overlap otherwise and claim more than there
    is, which would take a hundred times the file's memory.
    """
    count = struct.unpack_from(">I", data, 128)[0]
    places = list(struct.iter_unpack(">4sII", data[132 : 132 + 12 * count]))
    inside = {(o, length) for _, o, length in places if o + length <= len(data)}
    if sum(length for _, length in inside) > 2 * len(data):
        raise ValueError("a damaged ICC profile (its tags overlap)")
    parts = {(o, length): data[o : o + length] for o, length in inside}
    return {tag: parts.get((o, length), b"") for tag, o, length in places}


def _profile(
    tags: dict[bytes, bytes], space: str, description: str, output: bool, lab: bool
) -> Profile:
    white = np.array(_xyz_tag(tags[b"wtpt"])) if b"wtpt" in tags else D50
    if not (np.isfinite(white).all() and white.min() >= 0.01 and white.max() <= 2.0):
        white = D50
    for name in (b"A2B1", b"A2B0"):
        if name in tags:
            steps = table_steps(tags[name], CHANNELS[space], backward=False)
            return Profile(
                space, description, output, white, steps.first, steps.grid, _after(steps, lab)
            )
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
