"""PLY files (Turk 1994), text or binary, with texture coordinates of points or of faces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from relgloss_view.base.arrays import AnyArray, Array, Ints
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.pack.forms.loose import MOST_TRIANGLES, TOO_MANY, Loose
from relgloss_view.pack.forms.polygons import triangulated

LONGEST_HEADER = 64 * 1024
MOST_CORNERS = 256  #: of one polygon
MOST_LISTED = 20 * MOST_TRIANGLES  #: numbers of a text's faces: corners, places on the label
MOST_BLANKS = 24_000_000  #: of a text, between its numbers
_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
    "float": "f4", "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2",
    "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8",
}  # fmt: skip
_FORMATS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_UV = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"))
#: Lists of each length, (lists, items), and the numbers of their rows.
_Lists = tuple[list[AnyArray], list[Ints]]
_DAMAGED = "the file ends before its points and faces do; export it again"


@dataclass
class _Element:
    name: str
    count: int
    #: (name, type) of a number; (name, type of items, type of the count) of a list
    properties: list[tuple[str, ...]] = field(default_factory=list)


def parse_ply(data: bytes) -> Loose:
    """The triangles of a PLY file; polygons are cut. Raises InputError."""
    order, elements, at = _header(data)
    for element in elements:
        if element.count > (1 if element.name == "face" else 3) * MOST_TRIANGLES:
            name = printable(element.name, 20)
            raise InputError(f"declares {float(element.count):.4g} times '{name}': {TOO_MANY}")
    numbers: dict[str, dict[str, Array]] = {}
    lists: dict[str, _Lists] = {}
    words: _Words | None = _Words(data[at:]) if order == "" else None
    for element in elements:
        if element.name == "face":
            if words is None:
                values, at = _binary_lists(data, at, element, order)
            else:
                values = _text_lists(words, element)
            lists.update(values)
        elif words is None:
            numbers[element.name], at = _binary(data, at, element, order)
        else:
            numbers[element.name] = _text(words, element)
    return _loose(numbers.get("vertex", {}), lists)


def _header(data: bytes) -> tuple[str, list[_Element], int]:
    end = data.find(b"end_header", 0, LONGEST_HEADER)
    if not data.startswith(b"ply") or end < 0:
        raise InputError("no header of a PLY file; export it again")
    newline = data.find(b"\n", end)
    begin = newline + 1 if newline >= 0 else len(data)
    order: str | None = None
    elements: list[_Element] = []
    for line in data[:end].decode("ascii", "replace").splitlines():
        words = line.split()
        if not words:
            continue
        try:
            if words[0] == "format":
                order = _FORMATS[words[1]]
            elif words[0] == "element":
                elements.append(_Element(words[1], int(words[2][:20])))
                if elements[-1].count < 0:
                    raise ValueError
            elif words[0] == "property" and words[1] == "list":
                elements[-1].properties.append((words[4], _TYPES[words[3]], _TYPES[words[2]]))
            elif words[0] == "property":
                elements[-1].properties.append((words[2], _TYPES[words[1]]))
        except (IndexError, KeyError, ValueError):
            raise InputError(f"header: '{printable(line, 60)}' is no line of PLY") from None
    if order is None:
        raise InputError("header: no format; export it again")
    return order, elements, begin


def _binary(data: bytes, at: int, element: _Element, order: str) -> tuple[dict[str, Array], int]:
    if any(len(p) == 3 for p in element.properties):
        raise InputError(
            f"a list in '{printable(element.name, 20)}' is not read; export points and faces alone"
        )
    names = [f"{k}" for k in range(len(element.properties))]
    row = np.dtype([(n, order + p[1]) for n, p in zip(names, element.properties, strict=True)])
    if at + element.count * row.itemsize > len(data):
        raise InputError(_DAMAGED)
    if not row.itemsize:
        return {}, at
    table = np.frombuffer(data, row, element.count, at)
    values = {p[0]: table[n].astype(float) for n, p in zip(names, element.properties, strict=True)}
    return values, at + element.count * row.itemsize


def _binary_lists(
    data: bytes, at: int, element: _Element, order: str
) -> tuple[dict[str, _Lists], int]:
    """Lists of each length of an element, with the numbers of their rows."""
    found = _same_lists(data, at, element, order)
    if found is not None:
        return found
    kept: dict[str, dict[int, tuple[list[Array], list[int]]]] = {}
    for k in range(element.count):
        for p in element.properties:
            count = 1
            if len(p) == 3:
                count_type = np.dtype(order + p[2])
                if at + count_type.itemsize > len(data):
                    raise InputError(_DAMAGED)
                count = int(np.frombuffer(data, count_type, 1, at)[0])
                at += count_type.itemsize
            kind = np.dtype(order + p[1])
            if not 0 <= count <= 2 * MOST_CORNERS or at + count * kind.itemsize > len(data):
                raise InputError(_DAMAGED)
            if len(p) == 3 and count:
                lists, rows = kept.setdefault(p[0], {}).setdefault(count, ([], []))
                lists.append(np.frombuffer(data, kind, count, at))
                rows.append(k)
            at += count * kind.itemsize
    return _arranged(kept), at


def _same_lists(
    data: bytes, at: int, element: _Element, order: str
) -> tuple[dict[str, _Lists], int] | None:
    """All lists at once where each has the length of the first; None otherwise."""
    if not element.count:
        return {}, at
    fields: list[tuple[str, str] | tuple[str, str, int]] = []
    counts: list[tuple[str, int]] = []
    place = at
    for k, p in enumerate(element.properties):
        if len(p) == 3:
            kind = np.dtype(order + p[2])
            if place + kind.itemsize > len(data):
                raise InputError(_DAMAGED)
            count = int(np.frombuffer(data, kind, 1, place)[0])
            if not 0 <= count <= 2 * MOST_CORNERS:
                raise InputError(_DAMAGED)
            fields += [(f"n{k}", order + p[2]), (f"v{k}", order + p[1], count)]
            counts.append((f"n{k}", count))
            place += kind.itemsize + count * np.dtype(p[1]).itemsize
        else:
            fields.append((f"v{k}", order + p[1]))
            place += np.dtype(p[1]).itemsize
    row = np.dtype(fields)
    if at + element.count * row.itemsize > len(data):
        return None
    table = np.frombuffer(data, row, element.count, at)
    if any((table[name] != count).any() for name, count in counts):
        return None
    rows = np.arange(element.count)
    values = {
        p[0]: ([table[f"v{k}"].reshape(element.count, -1)], [rows])
        for k, p in enumerate(element.properties)
        if len(p) == 3
    }
    return values, at + element.count * row.itemsize


def _arranged(
    kept: dict[str, dict[int, tuple[list[Array], list[int]]]],
) -> dict[str, _Lists]:
    return {
        name: (
            [np.array(lists) for lists, _ in by_count.values()],
            [np.array(rows) for _, rows in by_count.values()],
        )
        for name, by_count in kept.items()
    }


class _Words:
    """The numbers of a text, in their order."""

    def __init__(self, data: bytes) -> None:
        if sum(map(data.count, (b" ", b"\t", b"\n", b"\r", b"\v", b"\f"))) > MOST_BLANKS:
            raise InputError(f"has more than {MOST_BLANKS} numbers; save it as binary PLY or .glb")
        self._lines = data.split(b"\n") if data.count(b"\n") <= 8 * MOST_TRIANGLES else []
        self._next = 0

    def rows(self, count: int) -> Iterator[list[float]]:
        """The numbers of the next lines; InputError where there are fewer, or other words."""
        rows = self._lines[self._next : self._next + count]
        if len(rows) < count:
            raise InputError(_DAMAGED)
        self._next += count
        try:
            for row in rows:
                yield [float(word) for word in row.split()]
        except ValueError:
            raise InputError("a line does not hold numbers; export it again") from None


def _text(words: _Words, element: _Element) -> dict[str, Array]:
    if any(len(p) == 3 for p in element.properties):
        raise InputError(
            f"a list in '{printable(element.name, 20)}' is not read; export points and faces alone"
        )
    rows = list(words.rows(element.count))
    if any(len(row) != len(element.properties) for row in rows):
        raise InputError(
            f"a line of '{printable(element.name, 20)}' has too many or too few numbers"
        )
    table = np.array(rows, dtype=float).reshape(element.count, len(element.properties))
    return {p[0]: table[:, k] for k, p in enumerate(element.properties)}


def _text_lists(words: _Words, element: _Element) -> dict[str, _Lists]:
    kept: dict[str, dict[int, tuple[list[Array], list[int]]]] = {}
    total = 0
    for k, row in enumerate(words.rows(element.count)):
        at = 0
        total += len(row)
        if total > MOST_LISTED:
            raise InputError(f"holds {TOO_MANY}")
        for p in element.properties:
            count = 1
            if len(p) == 3:
                count, at = (int(row[at]) if at < len(row) else -1), at + 1
            if not 0 <= count <= 2 * MOST_CORNERS or at + count > len(row):
                raise InputError("a face has too few numbers; export it again")
            if len(p) == 3 and count:
                lists, rows = kept.setdefault(p[0], {}).setdefault(count, ([], []))
                lists.append(np.array(row[at : at + count]))
                rows.append(k)
            at += count
    return _arranged(kept)


def _loose(vertex: dict[str, Array], lists: dict[str, _Lists]) -> Loose:
    if not {"x", "y", "z"} <= set(vertex):
        raise InputError("points without x, y and z; export it again")
    points = np.stack([vertex[n] for n in ("x", "y", "z")], axis=-1)
    faces = lists.get("vertex_indices") or lists.get("vertex_index")
    if faces is None:
        return Loose(points, np.zeros((0, 3), dtype=np.int64))
    count = sum(len(polygons) * max(polygons.shape[1] - 2, 0) for polygons in faces[0])
    if count > MOST_TRIANGLES:  # a polygon of a few bytes has hundreds
        raise InputError(f"holds {TOO_MANY}")
    corners, rows, places = [], [], []
    for polygons, numbers in zip(*faces, strict=True):
        size = polygons.shape[1]
        if size < 3:
            continue
        with np.errstate(invalid="ignore"):
            named = polygons.astype(np.int64)
        known = np.clip(named, 0, max(len(points) - 1, 0))  # others are refused later
        cut = triangulated(points[known] if len(points) else np.zeros((*known.shape, 3)))
        corners.append(named[np.arange(len(named))[:, None, None], cut].reshape(-1, 3))
        rows.append(np.repeat(numbers, size - 2))
        places.append(cut.reshape(-1, 3))
    if not corners:
        return Loose(points, np.zeros((0, 3), dtype=np.int64))
    triangles = np.concatenate(corners)
    loose = Loose(points, triangles)
    for pair in _UV:
        if set(pair) <= set(vertex):
            loose.uv = np.stack([vertex[n] for n in pair], axis=-1)
            loose.uv_corners = triangles
    if {"nx", "ny", "nz"} <= set(vertex):
        loose.normals = np.stack([vertex[n] for n in ("nx", "ny", "nz")], axis=-1)
        loose.normal_corners = triangles
    if "texcoord" in lists:
        _set_wedges(loose, lists["texcoord"], np.concatenate(rows), np.concatenate(places))
    return loose


def _set_wedges(loose: Loose, texcoord: _Lists, rows: Ints, places: Ints) -> None:
    """Texture coordinates that faces hold, two for each of their corners."""
    count = int(rows.max()) + 1
    start = np.full(count, -1, dtype=np.int64)
    length = np.zeros(count, dtype=np.int64)
    flat, total = [], 0
    for values, numbers in zip(*texcoord, strict=True):
        pairs = values.shape[1] // 2
        if pairs * 2 != values.shape[1]:
            continue
        inside = numbers < count
        start[numbers[inside]] = total + pairs * np.flatnonzero(inside)
        length[numbers[inside]] = pairs
        flat.append(values.reshape(-1, 2).astype(float))
        total += pairs * len(values)
    if not flat:
        return
    usable = (start[rows] >= 0) & (places.max(axis=1) < length[rows])
    loose.uv = np.concatenate(flat)
    loose.uv_corners = np.where(usable[:, None], start[rows][:, None] + places, -1)
