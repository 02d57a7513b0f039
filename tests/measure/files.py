"""Writers of small files in each format, written from the formats' descriptions."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

GCMS = """\
# name: test paper
# quantity: radiance-factor
# gamma_s_deg: 15
# source: synthetic
alpha_deg,beta_deg,gamma_deg,400,500,600
-45,0,15,0.10,0.20,0.30
-45,45,15,1.10,1.20,1.30
-45,45,0,0.11,0.21,0.31
-60,10,30,0.12,0.22,0.32
"""

GENERIC = """\
# quantity: brdf
theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,R,G,B
0,0,30,90,0.1,0.2,0.3
45,180,45,0,0.4,0.5,0.6
"""

CODES = {"u1": 1, "u4": 5, "f2": 9, "f4": 10, "f8": 11}


def tensor_file(fields: dict[str, np.ndarray]) -> bytes:
    """A tensor_file: directory of the fields, then their data."""
    fields = {k: np.asarray(v) for k, v in fields.items()}
    directory = sum(2 + len(k) + 2 + 1 + 8 + 8 * v.ndim for k, v in fields.items())
    offset = 12 + 2 + 4 + directory
    head = b"tensor_file\x00" + b"\x01\x00" + struct.pack("<I", len(fields))
    body = b""
    for name, value in fields.items():
        head += struct.pack("<H", len(name)) + name.encode()
        head += struct.pack("<HBQ", value.ndim, CODES[value.dtype.str[1:]], offset + len(body))
        head += struct.pack(f"<{value.ndim}Q", *value.shape)
        body += value.tobytes()
    return head + body


def rgl_fields(size: int = 8, **changes: object) -> dict[str, np.ndarray]:
    """The fields of a material whose warp is the identity and whose table is 0.5."""
    one = np.ones
    fields: dict[str, object] = {
        "description": np.frombuffer(b"made up", np.uint8),
        "phi_i": np.zeros(1, np.float32),
        "theta_i": np.array([0.0, 0.8, np.pi / 2], np.float32),
        "sigma": one((2, 4), np.float32),
        "ndf": one((2, 4), np.float32),
        "vndf": one((1, 3, 16, 16), np.float32),
        "rgb": np.full((1, 3, 3, size, size), 0.5, np.float32),
        "jacobian": np.array([1], np.uint8),
    }
    fields.update(changes)
    return {k: np.asarray(v) for k, v in fields.items() if v is not None}


def merl_file(path: Path, bins: np.ndarray) -> Path:
    """A MERL .binary from bins (3, 90, 90, 180) as stored, before the scale factors."""
    with path.open("wb") as file:
        file.write(struct.pack("<3i", 90, 90, 180))
        file.write(np.ascontiguousarray(bins, "<f8").tobytes())
    return path
