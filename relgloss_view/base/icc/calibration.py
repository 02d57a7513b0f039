"""The curves that a display's profile asks the graphics card to apply: Apple's tag vcgt.

Source: the tag is no part of ICC.1; Apple, ColorSync reference (CMVideoCardGammaType), as Argyll
and littleCMS write it: a table of 8 or 16 bits, or gamma, minimum and maximum a channel.
"""

from __future__ import annotations

import struct

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.icc.header import HEADER_BYTES, MOST_TAGS, parse_profile

NODES = 256  #: of curves that a formula gives
MOST_ENTRIES = 1 << 16
HEADER, TABLE = 12, 18  #: bytes before a formula's numbers, and before a table's


def calibration_of(data: bytes) -> Array | None:
    """The curves (3, n) of a profile, from 0 to 1; None where it has none that can be read."""
    try:
        parse_profile(data)
        return _curves(_tag(data))
    except (ValueError, struct.error):
        return None


def _tag(data: bytes) -> bytes:
    (count,) = struct.unpack_from(">I", data, HEADER_BYTES)
    for k in range(min(count, MOST_TAGS)):
        name, start, length = struct.unpack_from(">4sII", data, HEADER_BYTES + 4 + 12 * k)
        if name == b"vcgt":
            return data[start : start + length]
    raise ValueError("no vcgt")


def _curves(tag: bytes) -> Array | None:
    kind, form = struct.unpack_from(">4s4xI", tag)
    if kind != b"vcgt":
        return None
    if form == 1:
        numbers = np.array(struct.unpack_from(">9i", tag, HEADER), dtype=np.float64) / 65536.0
        gamma, low, high = numbers.reshape(3, 3).T[..., None]
        return np.asarray(low + (high - low) * np.linspace(0.0, 1.0, NODES) ** gamma).clip(0.0, 1.0)
    channels, count, size = struct.unpack_from(">3H", tag, HEADER)
    if form != 0 or channels not in (1, 3) or size not in (1, 2) or not 2 <= count <= MOST_ENTRIES:
        return None
    if len(tag) < TABLE + channels * count * size:
        return None
    values = np.frombuffer(tag, ">u2" if size == 2 else "u1", channels * count, TABLE)
    curves = values.reshape(channels, count) / (65535.0 if size == 2 else 255.0)
    return np.repeat(curves, 3 // channels, axis=0)
