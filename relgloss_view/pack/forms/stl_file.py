"""STL files, binary or text: triangles without texture coordinates."""

from __future__ import annotations

import re

import numpy as np

from relgloss_view.base.errors import InputError
from relgloss_view.pack.forms.loose import MOST_TRIANGLES, TOO_MANY, Loose

_ROW = np.dtype([("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("attribute", "<u2")])
_VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", re.IGNORECASE)


def parse_stl(data: bytes) -> Loose:
    """The triangles of an STL file; facets' normals are left out, as they follow from the points.

    Raises InputError.
    """
    if len(data) >= 84:
        count = int.from_bytes(data[80:84], "little")
        if 84 + count * _ROW.itemsize <= len(data) and not _is_text(data):
            if count > MOST_TRIANGLES:
                raise InputError(f"holds {TOO_MANY}")
            rows = np.frombuffer(data, _ROW, count, 84)
            return _loose(rows["points"].astype(float).reshape(-1, 3))
    if not _is_text(data):
        raise InputError("the file ends before its triangles do; export it again")
    if data.lower().count(b"vertex") > 3 * MOST_TRIANGLES:
        raise InputError(f"holds {TOO_MANY}")
    found = _VERTEX.findall(data)
    try:
        points = np.array([[float(x) for x in row] for row in found], dtype=float).reshape(-1, 3)
    except ValueError:
        raise InputError("a vertex does not hold 3 numbers; export it again") from None
    if len(points) % 3:
        raise InputError("the last facet is not complete; export it again")
    return _loose(points)


def _is_text(data: bytes) -> bool:
    return data[:5].lower() == b"solid" and b"facet" in data[:2000].lower()


def _loose(points: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> Loose:
    return Loose(points, np.arange(len(points), dtype=np.int64).reshape(-1, 3))
