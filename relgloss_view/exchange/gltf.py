"""glTF 2.0 files of packs and materials, for web shops and Blender: one .glb, nothing beside it.

Metres, y up, standing on y = 0, the front towards +z. A material for each part, with the factors of
gltf_refit.py; where finishes differ from place to place, their factors are textures.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.reading import printable
from relgloss_view.base.writing import whole_file
from relgloss_view.exchange.formats import MOST_PX, Exported, ExportOptions
from relgloss_view.exchange.gltf_brdf import COAT, SPECULAR, GltfSurface
from relgloss_view.exchange.gltf_container import ARRAY, ELEMENTS, Builder
from relgloss_view.exchange.gltf_forms import triangles_of
from relgloss_view.exchange.gltf_maps import Maps, image_file, maps_of, texture_size
from relgloss_view.exchange.gltf_refit import refit_gltf
from relgloss_view.exchange.loss import LAMP
from relgloss_view.exchange.own import EXTRAS, own_numbers
from relgloss_view.exchange.refit import Refit, said_once
from relgloss_view.material.material import Material
from relgloss_view.pack.check import placement_notes
from relgloss_view.pack.label import Label, label_of
from relgloss_view.pack.layers import layers_of
from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.plain_finish import plain_finishes
from relgloss_view.pack.shape import Shape

PACK_LINES = (
    "the colours of the artwork are its sRGB values, as colour management has them (D50 to D65 by "
    "Bradford's transform); those of a stock or a foil are under D65",
    "lamps, surface grain (sigma_N) and the factors k of the finishes are not carried",
)
MATERIAL_LINES = ("colours are under D65", "surface grain (sigma_N) is not carried")


def write(what: Material | Pack, path: Path, options: ExportOptions) -> Exported:
    """Write a .glb of a pack, or of a material on a form. See formats.Writer."""
    data, exported = glb(what, shape=options.shape, most_px=options.most_px, bare=options.bare)
    with whole_file(path) as temporary:
        temporary.write_bytes(data)
    return exported


def glb(
    what: Material | Pack, *, shape: Shape | None = None, most_px: int = MOST_PX, bare: bool = False
) -> tuple[bytes, Exported]:
    """The bytes of a .glb, and what they carry and lose.

    shape: the form of a material; None for the paper's cylinder. most_px: longest side of a
    texture. bare: without `extras`, which hold our own numbers. Raises InputError where a mask or
    a mesh file can't be read, or memory is short.
    """
    if isinstance(what, Pack):
        return _pack(what, most_px, bare)
    return _material(what, shape or Shape(), bare)


def _material(material: Material, shape: Shape, bare: bool) -> tuple[bytes, Exported]:
    refit = refit_gltf(material)
    builder = Builder()
    entry = _surface(refit).as_json()
    own: dict[str, Any] = {"loss": refit.loss.as_json(), "lines": list(refit.lines)}
    own |= own_numbers(material, entry)
    builder.uses(entry.get("extensions", {}))
    extras = {} if bare else {"extras": {EXTRAS: own}}
    number = builder.add("materials", {"name": material.name, **entry, **extras})
    mesh = triangles_of(shape)
    _put_mesh(builder, mesh, shape.kind, [number] * len(mesh.parts), [True] * len(mesh.parts))
    lines = (*refit.lines, *MATERIAL_LINES, _size_line(mesh))
    of_file = {EXTRAS: {"lines": list(lines), "losses": {material.name: own["loss"]}}}
    data = builder.file_bytes({} if bare else of_file)
    return data, Exported(lines, {material.name: refit.loss})


def _size_line(mesh: Mesh) -> str:
    """What a program that opens the file should show: a wrong unit is seen at once."""
    width, height, depth = (2000.0 * half for half in mesh.half_extent_m.tolist())
    return (
        f"size {width:.0f} x {height:.0f} x {depth:.0f} mm (wide, high, deep); glTF counts in "
        "metres, y is up, the front faces +z"
    )


@dataclass
class _Pictures:
    """Textures that are in the file, by their bytes: parts share them."""

    builder: Builder
    around: bool
    numbers: dict[bytes, int] = field(default_factory=dict)

    def add(self, picture: Bytes, name: str, *, may_be_jpeg: bool = False) -> dict[str, int]:
        """What a material names a picture by."""
        file = image_file(picture, may_be_jpeg=may_be_jpeg)
        if file not in self.numbers:
            self.numbers[file] = self.builder.texture(file, name, around=self.around)
        return {"index": self.numbers[file]}


def _pack(pack: Pack, most_px: int, bare: bool) -> tuple[bytes, Exported]:
    label, layers = label_of(pack.shape), layers_of(pack)
    refits = [refit_gltf(plain.material, keeps_body=True) for plain in plain_finishes(pack, LAMP)]
    surfaces = [_surface(refit) for refit in refits]
    size = texture_size(pack, label, most_px)
    builder = Builder()
    pictures = _Pictures(builder, label.around)
    lying = set[int]()
    made: dict[tuple[int, int], tuple[Maps, dict[str, Any]]] = {}
    textured, numbers = [], []
    for part, name in enumerate(label.parts):
        key = layers.part_finish[part], layers.part_diffuse[part]
        if key not in made:
            maps = maps_of(pack, label, part, surfaces, size if min(key) < 0 else (1, 1))
            made[key] = maps, _entry(pictures, maps)
            lying.update(maps.finishes)
        maps, entry = made[key]
        named = {"finishes": [pack.finishes[k].name for k in maps.finishes]}
        builder.uses(entry.get("extensions", {}))
        of_part = {} if bare else {"extras": {EXTRAS: named}}
        numbers.append(builder.add("materials", {"name": name, **entry, **of_part}))
        textured.append(_has_textures(maps))
    mesh = triangles_of(pack.shape)
    _put_mesh(builder, mesh, pack.name, numbers, textured)
    outside = max(maps.outside for maps, _ in made.values())
    lines = said_once(
        (printable(pack.finishes[k].name, 60), refits[k].lines[:2] + refits[k].notes)
        for k in sorted(lying)
    )
    lines += [text.rstrip(".") for text in placement_notes(pack)]
    lines += [*PACK_LINES, _size_line(mesh)]
    if outside > 0.0:
        lines.append(f"{100.0 * outside:.1f} % of the label is outside sRGB and is cut to it")
    losses = {pack.finishes[k].name: refits[k].loss for k in sorted(lying)}
    extras = {
        "lines": lines,
        "losses": {name: loss.as_json() for name, loss in losses.items()},
        "finishes": [_finish(pack, k, surfaces[k], refits[k]) for k in sorted(lying)],
    }
    return builder.file_bytes({} if bare else {EXTRAS: extras}), Exported(tuple(lines), losses)


def _finish(pack: Pack, number: int, surface: GltfSurface, refit: Refit) -> dict[str, Any]:
    """A finish by its own numbers."""
    finish = pack.finishes[number]
    entry = surface.as_json()
    return {
        "name": finish.name,
        "kind": finish.kind,
        "surface": entry,
        "loss": refit.loss.as_json(),
        **own_numbers(finish.material, entry),
    }


def _surface(refit: Refit) -> GltfSurface:
    assert isinstance(refit.surface, GltfSurface)
    return refit.surface


def _has_textures(maps: Maps) -> bool:
    return maps.colour is not None or bool(maps.values) or maps.tint is not None


def _entry(pictures: _Pictures, maps: Maps) -> dict[str, Any]:
    """A material of factors and textures. Factors that a texture multiplies are stated."""
    entry = maps.surface.as_json()
    core, values = entry["pbrMetallicRoughness"], maps.values
    if maps.colour is not None:
        core["baseColorTexture"] = pictures.add(maps.colour, "print", may_be_jpeg=True)
    if "roughness" in values or "metallic" in values:
        picture = _channels(values, (None, "roughness", "metallic"))
        core["metallicRoughnessTexture"] = pictures.add(picture, "metallic and roughness")
    extensions = entry.setdefault("extensions", {})
    if "specular" in values or maps.tint is not None:
        tint = maps.tint
        if tint is None:
            tint = np.full((*values["specular"].shape, 3), 255, dtype=np.uint8)
        weight = values.get("specular", np.full(tint.shape[:2], 255, dtype=np.uint8))
        named = pictures.add(np.concatenate([tint, weight[..., None]], axis=-1), "specular")
        specular = extensions.setdefault(SPECULAR, {})
        if "specular" in values:
            specular["specularTexture"] = named
        if maps.tint is not None:
            specular["specularColorTexture"] = named
    if "clearcoat" in values or (maps.surface.clearcoat > 0.0 and "clearcoat_roughness" in values):
        named = pictures.add(
            _channels(values, ("clearcoat", "clearcoat_roughness", None)), "clear coat"
        )
        coat = extensions[COAT]
        if "clearcoat" in values:
            coat["clearcoatTexture"] = named
        if "clearcoat_roughness" in values:
            coat["clearcoatRoughnessTexture"] = named
    if not extensions:
        del entry["extensions"]
    return entry


def _channels(values: dict[str, Bytes], names: tuple[str | None, ...]) -> Bytes:
    """A picture of factors as channels; 255 where a channel has none."""
    shape = next(values[name].shape for name in names if name in values)
    full = np.full(shape, 255, dtype=np.uint8)
    return np.stack([values.get(name or "", full) for name in names], axis=-1)


def _put_mesh(
    builder: Builder, mesh: Mesh, name: str, materials: list[int], textured: list[bool]
) -> None:
    """One mesh on one node, a primitive for each part. v of glTF runs downwards."""
    label = Label(mesh.parts, mesh.printed, mesh.label_size_m, mesh.around)
    uv = mesh.label_m / np.array(label.size_m) * (1.0, -1.0) + 0.5
    part = mesh.part[mesh.triangles[:, 0]]
    primitives = []
    for number in range(len(mesh.parts)):
        triangles = mesh.triangles[part == number]
        if not len(triangles):
            continue
        used, corners = np.unique(triangles, return_inverse=True)
        corners = corners.reshape(triangles.shape)
        normals = mesh.normals[used]
        normals = normals / np.linalg.norm(normals, axis=-1, keepdims=True)
        attributes = {
            "POSITION": builder.accessor(mesh.points_m[used], ARRAY, bounds=True),
            "NORMAL": builder.accessor(normals, ARRAY),
        }
        if textured[number] and mesh.printed[number]:
            attributes["TEXCOORD_0"] = builder.accessor(np.clip(uv[used], -16.0, 16.0), ARRAY)
        primitives.append(
            {
                "attributes": attributes,
                "indices": builder.accessor(corners.ravel(), ELEMENTS),
                "material": materials[number],
            }
        )
    number = builder.add("meshes", {"name": name, "primitives": primitives})
    lowest = -float(np.float32(mesh.points_m[:, 1].min()))
    builder.add("nodes", {"name": name, "mesh": number, "translation": [0.0, lowest, 0.0]})
