"""A .glb file as it is built: one binary part, its views, and the JSON that names them.

The layout is that of glTF 2.0 (Khronos 2021), section 4: little-endian chunks padded to four bytes.
"""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np

from relgloss_view.base.arrays import AnyArray
from relgloss_view.base.version import PROGRAM

ARRAY, ELEMENTS = 34962, 34963  #: what a view holds: attributes of points, or numbers of them
FLOAT, SHORT, INTEGER = 5126, 5123, 5125
REPEAT, CLAMP = 10497, 33071
LINEAR, LINEAR_MIPMAP = 9729, 9987
_KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3"}
#: The largest number of points that two bytes can name; the last one restarts strips.
MOST_SHORT = 65535


class Builder:
    """Collects what a .glb holds. The same calls give the same bytes."""

    def __init__(self) -> None:
        self._binary = bytearray()
        self._json: dict[str, list[Any]] = {}
        self._samplers: dict[tuple[int, int], int] = {}
        self._extensions: set[str] = set()

    def add(self, kind: str, entry: dict[str, Any]) -> int:
        """The number of a new entry of a list such as 'materials'."""
        entries = self._json.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1

    def accessor(self, values: AnyArray, target: int, *, bounds: bool = False) -> int:
        """The number of an accessor of values (N,) or (N, C), which become float32 or indices.

        bounds: whether its least and largest values are stated, as of positions.
        """
        if target == ELEMENTS:
            wide = len(values) > 0 and int(values.max()) >= MOST_SHORT
            kind, item = (INTEGER, "<u4") if wide else (SHORT, "<u2")
        else:
            kind, item = FLOAT, "<f4"
        numbers = np.ascontiguousarray(values, dtype=item)
        components = 1 if numbers.ndim == 1 else numbers.shape[1]
        entry: dict[str, Any] = {
            "bufferView": self._view(numbers.tobytes(), target),
            "componentType": kind,
            "count": len(numbers),
            "type": _KINDS[components],
        }
        if bounds:
            entry["min"] = [float(v) for v in numbers.min(axis=0)]
            entry["max"] = [float(v) for v in numbers.max(axis=0)]
        return self.add("accessors", entry)

    def texture(self, image: bytes, name: str, *, around: bool) -> int:
        """The number of a texture of a PNG or JPEG file; around: its left edge meets its right."""
        kind = "image/png" if image.startswith(b"\x89PNG") else "image/jpeg"
        number = self.add(
            "images", {"name": name, "mimeType": kind, "bufferView": self._view(image, None)}
        )
        wrap = (REPEAT if around else CLAMP, CLAMP)
        if wrap not in self._samplers:
            self._samplers[wrap] = self.add(
                "samplers",
                {
                    "magFilter": LINEAR,
                    "minFilter": LINEAR_MIPMAP,
                    "wrapS": wrap[0],
                    "wrapT": wrap[1],
                },
            )
        return self.add("textures", {"sampler": self._samplers[wrap], "source": number})

    def uses(self, names: Any) -> None:
        """Extensions that a material has."""
        self._extensions.update(names)

    def file_bytes(self, extras: dict[str, Any]) -> bytes:
        """The whole file; its only scene holds all nodes. extras: of the asset, if any."""
        content: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": PROGRAM}
            | ({"extras": extras} if extras else {}),
            "scene": 0,
            "scenes": [{"nodes": list(range(len(self._json.get("nodes", []))))}],
        }
        if self._extensions:
            content["extensionsUsed"] = sorted(self._extensions)
        content |= self._json
        content["buffers"] = [{"byteLength": len(self._binary)}]
        text = json.dumps(content, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
        head = _padded(text.encode("utf-8"), b" ")
        binary = _padded(bytes(self._binary), b"\0")
        size = 12 + 8 + len(head) + 8 + len(binary)
        return b"".join(
            [
                struct.pack("<4sII", b"glTF", 2, size),
                struct.pack("<I4s", len(head), b"JSON"),
                head,
                struct.pack("<I4s", len(binary), b"BIN\0"),
                binary,
            ]
        )

    def _view(self, data: bytes, target: int | None) -> int:
        self._binary += b"\0" * (-len(self._binary) % 4)
        entry: dict[str, Any] = {
            "buffer": 0,
            "byteOffset": len(self._binary),
            "byteLength": len(data),
        }
        if target is not None:
            entry["target"] = target
        self._binary += data
        return self.add("bufferViews", entry)


def _padded(data: bytes, filler: bytes) -> bytes:
    return data + filler * (-len(data) % 4)
