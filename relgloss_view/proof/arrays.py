"""Arrays in a proof: JSON that a browser unpacks without a library of its own."""

from __future__ import annotations

import base64
import math
import zlib
from typing import Any

import numpy as np

from relgloss_view.base.arrays import AnyArray

#: The kinds of numbers that a proof holds, by their names in JavaScript's typed arrays.
KINDS = {
    "uint8": "Uint8",
    "uint16": "Uint16",
    "uint32": "Uint32",
    "int32": "Int32",
    "float32": "Float32",
    "float64": "Float64",
}


def packed(values: AnyArray) -> dict[str, Any]:
    """An array as JSON: its kind, its shape, and base64 of zlib of its bytes.

    The bytes are little-endian and sorted by their place in a number, which deflates better: the
    first bytes of all numbers, then the second ones. js/arrays.js `unpacked` is the way back.

    >>> packed(np.zeros((2, 3), dtype=np.float32))["shape"]
    [2, 3]
    """
    kind = values.dtype.name
    little = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
    sorted_bytes = little.reshape(-1).view(np.uint8).reshape(-1, values.dtype.itemsize).T
    data = base64.b64encode(zlib.compress(sorted_bytes.tobytes(), 9)).decode("ascii")
    return {"dtype": KINDS[kind], "shape": list(values.shape), "data": data}


def unpacked(content: dict[str, Any]) -> AnyArray:
    """The way back, as the page goes it.

    >>> unpacked(packed(np.arange(3.0))).tolist()
    [0.0, 1.0, 2.0]
    """
    kind = np.dtype(next(k for k, name in KINDS.items() if name == content["dtype"]))
    size = math.prod(content["shape"]) * kind.itemsize
    # No more is inflated than the shape holds.
    data = zlib.decompressobj().decompress(base64.b64decode(content["data"]), size + 1)
    shuffled = np.frombuffer(data, dtype=np.uint8).reshape(kind.itemsize, -1)
    numbers = np.ascontiguousarray(shuffled.T).view(kind.newbyteorder("<"))
    return numbers.reshape(content["shape"]).astype(kind)
