"""ICC profiles of screens with look-up tables, made of a formula: for tests and damaged inputs.

The screen's channels do not add: a share of the sum of its channels is lost, as on OLED panels.
"""

from __future__ import annotations

import struct
from collections.abc import Callable

import numpy as np

D50 = np.array([0.9642, 1.0, 0.8249])
#: sRGB's colorants under D50 (IEC 61966-2-1, Bradford), red, green, blue as columns.
COLORANTS = np.array([[0.4361, 0.3851, 0.1431], [0.2225, 0.7169, 0.0606], [0.0139, 0.0971, 0.7141]])
BLACK = 0.002 * D50
LOST = 0.1  #: of the light where all three channels are full
_XYZ_ONE = 1.0 + 32767.0 / 32768.0

Colours = Callable[[np.ndarray], np.ndarray]


def shown(rgb: np.ndarray) -> np.ndarray:
    """XYZ (N, 3) under D50 of digital values (N, 3)."""
    light = rgb**2.2
    sums = light.sum(axis=1, keepdims=True)
    light = light * (1.0 - LOST * np.maximum(sums - 1.0, 0.0) / 2.0) / (1.0 - LOST)
    white = COLORANTS.sum(axis=1)
    return np.asarray(light @ COLORANTS.T * (1.0 - 0.002) * D50 / white + BLACK)


def lab_of(xyz: np.ndarray) -> np.ndarray:
    """CIELAB (N, 3) under D50 (CIE 15:2004)."""
    t = xyz / D50
    f = np.where(t > (6.0 / 29.0) ** 3, np.cbrt(t), t * 841.0 / 108.0 + 4.0 / 29.0)
    return np.stack(
        [116.0 * f[:, 1] - 16.0, 500.0 * (f[:, 0] - f[:, 1]), 200.0 * (f[:, 1] - f[:, 2])], axis=1
    )


def table_profile(
    kind: str = "mft2",
    *,
    lab: bool = True,
    points: int = 9,
    colours: Colours = shown,
    backward: Colours | None = None,
    tags: dict[bytes, bytes] | None = None,
    version: int | None = None,
) -> bytes:
    """A profile of `kind` 'mft1', 'mft2' or 'mAB ', whose nodes are evenly spaced over 0 to 1.

    backward: encoded device values (N, 3) of encoded values of the connection space (N, 3), for a
    table B2A0. version: of the format; None: 4 for mAB and 2 for the others.
    """
    axis = np.linspace(0.0, 1.0, points)
    nodes = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    xyz = colours(nodes)
    values = xyz / _XYZ_ONE
    if lab:
        values = (lab_of(xyz) + np.array([0.0, 128.0, 128.0])) / np.array([100.0, 255.0, 255.0])
        if kind == "mft2":
            values = values * 65280.0 / 65535.0
    made = {b"A2B0": _table(kind, points, values)}
    if backward is not None:
        made[b"B2A0"] = _table(kind.replace("mAB ", "mBA "), points, backward(nodes))
    made[b"wtpt"] = xyz_tag(D50)
    made.update(tags or {})
    return assembled(made, lab=lab, version=version or (4 if kind == "mAB " else 2))


def xyz_tag(xyz: np.ndarray) -> bytes:
    """A tag of one colour."""
    return b"XYZ " + bytes(4) + struct.pack(">3i", *np.round(65536.0 * xyz).astype(int))


def calibration_tags() -> tuple[bytes, bytes]:
    """The video card's curves as a table and as a formula, gammas 0.9, 1 and 1.1."""
    ramp = np.linspace(0.0, 1.0, 256)
    rows = np.round(65535.0 * np.stack([ramp**0.9, ramp, ramp**1.1])).astype(">u2")
    table = b"vcgt" + bytes(4) + struct.pack(">IHHH", 0, 3, 256, 2) + rows.tobytes()
    numbers = np.round(65536.0 * np.array([0.9, 0, 1, 1, 0, 1, 1.1, 0, 1])).astype(int)
    return table, b"vcgt" + bytes(4) + struct.pack(">I9i", 1, *numbers)


def assembled(tags: dict[bytes, bytes], *, lab: bool, version: int) -> bytes:
    """A display profile of tags."""
    table, body = b"", b""
    start = 132 + 12 * len(tags)
    for name, data in tags.items():
        table += struct.pack(">4sII", name, start + len(body), len(data))
        body += data + bytes(-len(data) % 4)
    head = bytearray(128)
    struct.pack_into(">I", head, 0, start + len(body))
    struct.pack_into(
        ">I4s4s4s", head, 8, version << 24, b"mntr", b"RGB ", b"Lab " if lab else b"XYZ "
    )
    struct.pack_into(">6H4s", head, 24, 2026, 1, 1, 0, 0, 0, b"acsp")
    struct.pack_into(">I3i", head, 64, 1, *np.round(65536.0 * D50).astype(int))
    return bytes(head) + struct.pack(">I", len(tags)) + table + body


def _table(kind: str, points: int, values: np.ndarray) -> bytes:
    values = np.clip(values, 0.0, 1.0)
    if kind == "mft1":
        ramp = bytes(range(256)) * 3
        nodes = np.round(255.0 * values).astype(np.uint8).tobytes()
        unit = struct.pack(">9i", 65536, 0, 0, 0, 65536, 0, 0, 0, 65536)
        return b"mft1" + bytes(4) + bytes((3, 3, points, 0)) + unit + ramp + nodes + ramp
    nodes = np.round(65535.0 * values).astype(">u2").tobytes()
    if kind == "mft2":
        unit = struct.pack(">9i", 65536, 0, 0, 0, 65536, 0, 0, 0, 65536)
        ramp = struct.pack(">2H", 0, 65535) * 3
        sizes = struct.pack(">HH", 2, 2)
        return b"mft2" + bytes(4) + bytes((3, 3, points, 0)) + unit + sizes + ramp + nodes + ramp
    curves = (b"curv" + bytes(8)) * 3  # that change nothing
    clut = 32 + 72
    table = bytes([points] * 3).ljust(16, b"\0") + bytes((2, 0, 0, 0)) + nodes
    places = struct.pack(">5I", 32, 0, 0, clut, 32 + 36)
    return kind.encode() + bytes(4) + bytes((3, 3, 0, 0)) + places + 2 * curves + table
