"""OBJ files (Wavefront): v, vt, vn, f, o, g, usemtl. Materials and textures are not opened."""

from __future__ import annotations

import contextlib
import warnings
from collections import defaultdict

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.pack.forms.loose import MOST_TRIANGLES, TOO_MANY, Loose
from relgloss_view.pack.forms.polygons import triangulated

MOST_LINES = 2_500_000
MOST_VECTORS = 3 * MOST_TRIANGLES
MOST_CORNERS = 256  #: of one polygon
MOST_PARTS = 1000
LONGEST_FACE = 64 * MOST_CORNERS  #: bytes


def parse_obj(data: bytes) -> Loose:
    """The triangles of an OBJ file; polygons are cut. Raises InputError."""
    if max(data.count(b"\n"), data.count(b"\r")) > MOST_LINES:
        raise InputError(f"has more than {MOST_LINES} lines; save it as .glb")
    if data.count(b"\nf ") > MOST_TRIANGLES:
        raise InputError(f"holds {TOO_MANY}")
    text = data.removeprefix(b"\xef\xbb\xbf")  # the byte order mark of some editors
    text = text.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ").replace(b"\t", b" ")
    lines = [line.strip() for line in text.splitlines()]
    points = _vectors(lines, b"v ", 3, "v")
    uv = _vectors(lines, b"vt ", 2, "vt")
    normals = _vectors(lines, b"vn ", 3, "vn")
    return _faces(lines, points, uv, normals)


def _vectors(lines: list[bytes], key: bytes, count: int, name: str) -> Array:
    """The first `count` numbers of each line of one kind."""
    texts = [line[len(key) :] for line in lines if line.startswith(key)]
    if not texts:
        return np.zeros((0, count))
    if len(texts) > MOST_VECTORS:
        raise InputError(f"has more than {MOST_VECTORS} lines '{name}'; save it as .glb")
    width = len(texts[0].split())
    if width >= count and all(len(text.split()) == width for text in texts):
        with contextlib.suppress(ValueError, DeprecationWarning), warnings.catch_warnings():
            warnings.simplefilter("error")
            numbers = np.fromstring(b" ".join(texts), sep=" ")
            if len(numbers) == len(texts) * width:
                return np.asarray(numbers.reshape(-1, width)[:, :count], dtype=np.float64)
    rows = [text.split(b"#")[0].split()[:count] for text in texts]
    try:
        # A texture of one dimension has no v.
        full = [[*row, b"0"] if (name, len(row)) == ("vt", 1) else row for row in rows]
        return np.array([[float(x) for x in row] for row in full]).reshape(len(rows), count)
    except ValueError:
        raise InputError(
            f"a line '{name}' does not hold {count} numbers; export it again"
        ) from None


def _faces(lines: list[bytes], points: Array, uv: Array, normals: Array) -> Loose:
    counts = (len(points), len(uv), len(normals))
    part = 0
    names: dict[str, int] = {}
    name_object, name_material = "", ""
    groups: dict[tuple[int, str], list[bytes]] = defaultdict(list)
    parts_of: dict[tuple[int, str], list[int]] = defaultdict(list)
    before = _counts_before(lines) if any(b"-" in x for x in lines if x[:2] == b"f ") else None
    places: dict[tuple[int, str], list[int]] = defaultdict(list)
    changed = True
    total = 0
    for number, line in enumerate(lines):
        key = line[:2]
        if key == b"f ":
            if changed:
                label = name_material or name_object or "body"
                part = names.setdefault(label, len(names))
                if len(names) > MOST_PARTS:
                    raise InputError(f"has more than {MOST_PARTS} groups; join them")
                changed = False
            face = (line[2:].split(b"#")[0] + b" ").replace(b"/ ", b" ").replace(b"/ ", b" ")
            words = face.split() if len(face) < LONGEST_FACE else []
            if not 3 <= len(words) <= MOST_CORNERS:
                raise InputError(
                    f"line {number + 1}: a face of {len(words)} corners, expected 3 to "
                    f"{MOST_CORNERS}; triangulate it on export"
                )
            total += len(words) - 2
            kind = words[0]
            form = "p//n" if b"//" in kind else "p/t/n"[: 1 + 2 * min(kind.count(b"/"), 2)]
            group = (len(words), form)
            groups[group].append(face)
            parts_of[group].append(part)
            places[group].append(number)
        elif key in (b"o ", b"g "):
            name_object, changed = _name(line[2:]), True
        elif line.startswith(b"usemtl "):
            name_material, changed = _name(line[7:]), True
    if total > MOST_TRIANGLES:
        raise InputError(f"holds {TOO_MANY}")
    found = [
        _cut(polygons, corners, form, points, counts, parts_of[corners, form],
              None if before is None else before[places[corners, form]])
        for (corners, form), polygons in groups.items()
    ]  # fmt: skip
    if not found:
        return Loose(points, np.zeros((0, 3), dtype=np.int64))
    indices = np.concatenate([f[0] for f in found])  # (T, 3, 3): point, uv, normal
    return Loose(
        points,
        indices[..., 0],
        uv,
        indices[..., 1] if len(uv) else None,
        normals,
        indices[..., 2] if len(normals) else None,
        np.concatenate([f[1] for f in found]),
        tuple(names),
    )


def _name(raw: bytes) -> str:
    return printable(raw.decode("utf-8", "replace").strip(), 60) or "body"


def _counts_before(lines: list[bytes]) -> Ints:
    """How many v, vt and vn lie before each line: negative numbers of a face count from there."""
    kinds = np.array([[x[:2] == b"v ", x[:3] == b"vt ", x[:3] == b"vn "] for x in lines])
    return np.cumsum(kinds, axis=0).astype(np.int64)


def _cut(
    polygons: list[bytes],
    corners: int,
    form: str,
    points: Array,
    counts: tuple[int, int, int],
    parts: list[int],
    before: Ints | None,
) -> tuple[Ints, Ints]:
    """Triangles (T, 3, 3) of polygons of one kind, and their parts."""
    columns = {"p": [0], "p/t": [0, 1], "p//n": [0, 2], "p/t/n": [0, 1, 2]}[form]
    width = len(columns)
    count = len(polygons)
    joined = b" ".join(polygons)
    numbers = np.zeros(0, dtype=np.int64)
    if joined.count(b"/") == count * corners * form.count("/"):
        with contextlib.suppress(ValueError, DeprecationWarning), warnings.catch_warnings():
            warnings.simplefilter("error")
            numbers = np.fromstring(joined.replace(b"/", b" "), dtype=np.int64, sep=" ")
    if len(numbers) != count * corners * width:
        raise InputError("a face does not name its points by whole numbers; export it again")
    full = np.zeros((count, corners, 3), dtype=np.int64)
    full[..., columns] = numbers.reshape(count, corners, width)
    if (full[..., 0] == 0).any():
        raise InputError("a face names point 0, but points are counted from 1; export it again")
    base = np.array(counts) if before is None else before[:, None, :]
    full = np.where(full < 0, full + base, full - 1)  # 0 becomes -1: none
    if (full[..., 0] < 0).any():
        raise InputError("a face names a point before the first one; export it again")
    known = np.minimum(full[..., 0], max(len(points) - 1, 0))  # others are refused later
    places = triangulated(points[known] if len(points) else np.zeros((*known.shape, 3)))
    triangles = full[np.arange(count)[:, None, None], places].reshape(-1, 3, 3)
    return triangles, np.repeat(np.array(parts, dtype=np.int64), corners - 2)
