"""glTF 2.0 files (Khronos 2021), .glb and .gltf: triangles of all nodes of the scene.

Buffers lie in the file itself or in files beside it; nothing outside its folder is opened.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from relgloss_view.base.arrays import AnyArray, Array, Ints
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.pack.forms.gltf_document import (
    Document,
    Source,
    list_of,
    source_of_glb,
    source_of_gltf,
)
from relgloss_view.pack.forms.loose import MOST_TRIANGLES, TOO_MANY, Loose

MOST_NODES = 20_000
MOST_PRIMITIVES = 20_000
_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COUNTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
#: Extensions without which the triangles can't be read.
_UNREADABLE = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing")

#: Extensions that are read, or concern neither the form nor where artwork lies.
_KNOWN = (
    "KHR_mesh_quantization",
    "KHR_lights_punctual",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    *_UNREADABLE,
)
_OF_NO_MATTER = ("KHR_materials_", "EXT_materials_", "KHR_texture_basisu", "EXT_texture_")
_IGNORED = {
    "KHR_texture_transform": (
        "artwork lies by the texture coordinates as they are, unmoved and of their own scale"
    ),
    "KHR_node_visibility": "what it hides is drawn too",
    "EXT_lights_image_based": "the light comes from the scene",
}
MOST_NOTES = 20


def parse_glb(data: bytes) -> Loose:
    """The triangles of a .glb file. Raises InputError."""
    return _loose(source_of_glb(data))


def parse_gltf(data: bytes, folder: Path) -> Loose:
    """The triangles of a .gltf file, whose buffers lie in `folder`. Raises InputError."""
    return _loose(source_of_gltf(data, folder))


def _loose(source: Source) -> Loose:
    for name in _UNREADABLE:
        if name in list_of(source.content, "extensionsRequired") or (
            name == "EXT_mesh_gpu_instancing" and name in list_of(source.content, "extensionsUsed")
        ):
            raise InputError(f"uses {name}; export it without compression and instances")
    return _Document(source).loose()


def _ignored(content: dict[str, Any]) -> list[str]:
    """A note for each extension that might change what is drawn, and is not read."""
    notes: list[str] = []
    for name in list_of(content, "extensionsUsed"):
        shown = printable(name, 60)
        if shown in _KNOWN or shown.startswith(_OF_NO_MATTER) or len(notes) >= MOST_NOTES:
            continue
        why = _IGNORED.get(shown, "the form may look different in other programs")
        notes.append(f"The file uses {shown}, which is ignored: {why}.")
    return notes


@dataclass
class _Gathered:
    """What the nodes have so far."""

    points: list[Array] = field(default_factory=list)
    corners: list[Ints] = field(default_factory=list)
    uv: list[Array] = field(default_factory=list)
    has_uv: list[bool] = field(default_factory=list)
    normals: list[Array] = field(default_factory=list)
    part: list[int] = field(default_factory=list)
    count: int = 0
    triangles: int = 0


class _Document(Document):
    def __init__(self, source: Source) -> None:
        super().__init__(source)
        self._primitives = 0
        self._notes = dict.fromkeys(_ignored(self.content))
        self._names: dict[str, int] = {}

    def loose(self) -> Loose:
        """All triangles of the scene, in its axes."""
        gathered = _Gathered()
        for number, matrix in self._nodes():
            node = self.entry("nodes", number)
            if "mesh" in node:
                self._mesh(node, matrix, gathered)
        if not gathered.corners:
            return Loose(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
        corners = np.concatenate(gathered.corners)
        counts = [len(c) for c in gathered.corners]
        has = np.repeat(gathered.has_uv, counts)
        return Loose(
            np.concatenate(gathered.points),
            corners,
            np.concatenate(gathered.uv),
            np.where(has[:, None], corners, -1),
            np.concatenate(gathered.normals),
            corners,
            np.repeat(np.array(gathered.part, dtype=np.int64), counts),
            tuple(self._names),
            tuple(self._notes),
            tuple(self.files),
        )

    # The tree of nodes

    def _nodes(self) -> list[tuple[int, Array]]:
        """Nodes of the scene with their matrices (4, 4); each node once, as glTF has trees."""
        nodes = list_of(self.content, "nodes")
        if len(nodes) > MOST_NODES:
            raise InputError(f"has more than {MOST_NODES} nodes; join its objects")
        scenes = list_of(self.content, "scenes")
        if scenes:
            chosen = self.entry("scenes", self.content.get("scene", 0))
            roots = list_of(chosen, "nodes")
        else:
            children = {c for n in nodes for c in list_of(n, "children") if isinstance(c, int)}
            roots = [k for k in range(len(nodes)) if k not in children]
        waiting = [(root, np.eye(4)) for root in roots]
        seen: set[int] = set()
        found = []
        while waiting:
            number, parent = waiting.pop()
            node = self.entry("nodes", number)
            if number in seen:
                raise InputError(
                    f"node {number} is in the scene twice, or within itself; export it again"
                )
            seen.add(number)
            matrix = parent @ self._matrix(node)
            found.append((number, matrix))
            waiting += [(child, matrix) for child in list_of(node, "children")]
        return found

    def _matrix(self, node: dict[str, Any]) -> Array:
        if "matrix" in node:
            return self.numbers(node, "matrix", 16).reshape(4, 4).T
        matrix = np.eye(4)
        if "rotation" in node:
            x, y, z, w = self.numbers(node, "rotation", 4)
            norm = x * x + y * y + z * z + w * w
            if norm <= 0.0:
                raise InputError("a node's rotation is no quaternion; export it again")
            s = 2.0 / norm
            matrix[:3, :3] = [
                [1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
                [s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)],
                [s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)],
            ]
        if "scale" in node:
            matrix[:3, :3] *= self.numbers(node, "scale", 3)
        if "translation" in node:
            matrix[:3, 3] = self.numbers(node, "translation", 3)
        return matrix

    # Meshes

    def _mesh(self, node: dict[str, Any], matrix: Array, gathered: _Gathered) -> None:
        mesh = self.entry("meshes", node["mesh"])
        if "skin" in node:
            self._notes["A skeleton of the file is ignored; the mesh has its own pose."] = None
        object_name = mesh.get("name") or node.get("name") or "body"
        for primitive in list_of(mesh, "primitives"):
            self._primitives += 1
            if self._primitives > MOST_PRIMITIVES:
                raise InputError(f"has more than {MOST_PRIMITIVES} parts; join them")
            if isinstance(primitive, dict):
                self._primitive(primitive, str(object_name), matrix, gathered)

    def _primitive(
        self, primitive: dict[str, Any], name: str, matrix: Array, gathered: _Gathered
    ) -> None:
        attributes = primitive.get("attributes")
        if not isinstance(attributes, dict) or "POSITION" not in attributes:
            raise InputError("a mesh has no positions; export it again")
        mode = primitive.get("mode", 4)
        if mode not in (4, 5, 6):
            self._notes["Points and lines of the file are left out."] = None
            return
        points = self._accessor(attributes["POSITION"], 3)
        if "indices" in primitive:
            indices = self._accessor(primitive["indices"], 1)[:, 0].astype(np.int64)
        else:
            indices = np.arange(len(points), dtype=np.int64)
        corners = _triangles(indices, mode)
        gathered.triangles += len(corners)
        if gathered.triangles > MOST_TRIANGLES or gathered.count > 3 * MOST_TRIANGLES:
            raise InputError(f"holds {TOO_MANY}")
        if len(corners) and corners.max() >= len(points):
            raise InputError(
                f"a triangle names point {corners.max() + 1} of {len(points)}; export it again"
            )
        linear = matrix[:3, :3]
        mirrored = np.linalg.det(linear) < 0.0
        if mirrored:
            corners = corners[:, [0, 2, 1]]
        uv, normals = None, None
        if "TEXCOORD_0" in attributes:
            uv = self._accessor(attributes["TEXCOORD_0"], 2) * [1.0, -1.0] + [0.0, 1.0]
        if "NORMAL" in attributes:
            # Cofactors: the inverse transposed but for its size, and for the sign of a mirror.
            cofactors = np.stack([np.cross(linear[k - 2], linear[k - 1]) for k in range(3)])
            normals = self._accessor(attributes["NORMAL"], 3) @ cofactors.T
            normals = -normals if mirrored else normals
        for values, what in ((uv, "TEXCOORD_0"), (normals, "NORMAL")):
            if values is not None and len(values) != len(points):
                raise InputError(f"{what}: as many entries as positions expected; export it again")
        gathered.points.append(points @ linear.T + matrix[:3, 3])
        gathered.corners.append(corners + gathered.count)
        gathered.uv.append(np.zeros((len(points), 2)) if uv is None else uv)
        gathered.has_uv.append(uv is not None)
        gathered.normals.append(np.zeros((len(points), 3)) if normals is None else normals)
        label = self._material(primitive) or name
        part = self._names.setdefault(printable(label, 60), len(self._names))
        gathered.part.append(part)
        gathered.count += len(points)

    def _material(self, primitive: dict[str, Any]) -> str:
        if "material" not in primitive:
            return ""
        return str(self.entry("materials", primitive["material"]).get("name") or "")

    # Numbers

    def _accessor(self, number: Any, components: int) -> Array:
        """The numbers of an accessor, (count, components)."""
        entry = self.entry("accessors", number)
        kind, count = entry.get("componentType"), entry.get("count")
        if kind not in _COMPONENTS or _COUNTS.get(str(entry.get("type"))) != components:
            raise InputError(f"accessors[{number}]: not of the expected type; export it again")
        if not isinstance(count, int) or isinstance(count, bool) or count < 0:
            raise InputError(f"accessors[{number}]: no count; export it again")
        if count > 3 * MOST_TRIANGLES:
            raise InputError(f"accessors[{number}]: {TOO_MANY}")
        item = np.dtype(_COMPONENTS[kind])
        if "bufferView" in entry:
            values = self._view(entry, item, count, components)
        else:
            values = np.zeros((count, components), dtype=item)
        if isinstance(entry.get("sparse"), dict):
            values = self._sparse(entry["sparse"], values, item)
        numbers = values.astype(float)
        if entry.get("normalized") and item.kind in "iu":
            numbers = np.maximum(numbers / np.iinfo(item).max, -1.0)
        return numbers

    def _sparse(self, sparse: dict[str, Any], values: AnyArray, item: np.dtype[Any]) -> AnyArray:
        where, what, count = sparse.get("indices"), sparse.get("values"), sparse.get("count")
        whole = isinstance(count, int) and 0 <= count <= len(values)
        if not whole or not isinstance(where, dict) or not isinstance(what, dict):
            raise InputError("a sparse accessor is not complete; export it again")
        kind = _COMPONENTS.get(where.get("componentType", 0), "")
        if not kind:
            raise InputError("a sparse accessor has no indices; export it again")
        rows = self._view(where, np.dtype(kind), int(count or 0), 1)[:, 0].astype(np.int64)
        if len(rows) and not 0 <= rows.min() <= rows.max() < len(values):
            raise InputError("a sparse accessor names an entry that there is not")
        values = values.copy()
        values[rows] = self._view(what, item, int(count or 0), values.shape[1])
        return values

    def _view(
        self, holder: dict[str, Any], item: np.dtype[Any], count: int, components: int
    ) -> AnyArray:
        view = self.entry("bufferViews", holder.get("bufferView"))
        data = self.buffer(view.get("buffer"))
        sizes = [holder.get("byteOffset", 0), view.get("byteOffset", 0), view.get("byteLength")]
        stride = view.get("byteStride", item.itemsize * components)
        for value in (*sizes, stride):
            if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 1 << 40:
                raise InputError("bufferViews: a length is no whole number; export it again")
        begin, end = sizes[1], sizes[1] + sizes[2]
        width = item.itemsize * components
        last = begin + sizes[0] + (count - 1) * stride + width if count else begin
        if end > len(data) or last > end or (stride < width and count > 1):
            raise InputError("a buffer is shorter than its numbers; export it again")
        if not count:
            return np.zeros((0, components), dtype=item)
        # Each row `stride` bytes on: a view, so that no byte is copied that is not a number.
        return np.ndarray(
            (count, components), item, data, begin + sizes[0], (stride, item.itemsize)
        )


def _triangles(indices: Ints, mode: int) -> Ints:
    """Corners (T, 3) of a list, a strip or a fan of triangles."""
    if mode == 4:
        return indices[: len(indices) // 3 * 3].reshape(-1, 3)
    if len(indices) < 3:
        return np.zeros((0, 3), dtype=np.int64)
    k = np.arange(len(indices) - 2)
    if mode == 6:
        return np.stack([np.full_like(k, indices[0]), indices[k + 1], indices[k + 2]], axis=-1)
    odd = k % 2 == 1
    return np.stack(
        [indices[k], indices[np.where(odd, k + 2, k + 1)], indices[np.where(odd, k + 1, k + 2)]],
        axis=-1,
    )
