"""glTF 2.0 files of others, .glb and .gltf: a material of theirs as a described one.

The factors are read, of textures the means; what our model has no words for is named. A file that
relgloss wrote gives back the material itself where nobody has edited its factors (own.py).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import decoding, named, printable, read_bytes
from relgloss_view.exchange.gltf_brdf import GLTF_LOBES, MODEL, GltfSurface, gltf_starting_points
from relgloss_view.exchange.gltf_material import EXTENSIONS, GltfMaterial
from relgloss_view.exchange.mirrors import drawable
from relgloss_view.exchange.own import EXTRAS, own_material
from relgloss_view.exchange.refit_lobes import refit_lobes
from relgloss_view.material.material import Material
from relgloss_view.pack.forms.gltf_document import (
    Document,
    list_of,
    source_of_glb,
    source_of_gltf,
)

EXPECTED = "a glTF 2.0 file (.glb or .gltf)"
MOST_BYTES = 100 * 1024 * 1024
MOST_MATERIALS = 10_000
LISTED = 20  #: names in a message


def read_gltf(path: Path, part: str | None) -> Material:
    """The material of a name, or the only one; a finish of a pack that relgloss wrote by its name.

    Raises InputError, one line that names the file; where several are there, it lists them.
    """
    data = read_bytes(path, MOST_BYTES, EXPECTED)
    with decoding(path, EXPECTED), np.errstate(all="ignore"):
        try:
            if data[:4] == b"glTF":
                source = source_of_glb(data)
            else:
                source = source_of_gltf(data, path.parent)
            return _File(Document(source), path).material(part)
        except InputError as error:
            if str(error).startswith(named(path)):
                raise
            raise InputError(f"{named(path)}: {error}") from error


class _File:
    def __init__(self, document: Document, path: Path) -> None:
        self.document, self.path = document, path
        entries = list_of(document.content, "materials")
        if len(entries) > MOST_MATERIALS:
            raise InputError(f"has more than {MOST_MATERIALS} materials")
        self.entries = [document.entry("materials", k) for k in range(len(entries))]
        self.names = [
            str(entry.get("name") or f"material {k}") for k, entry in enumerate(self.entries)
        ]
        own = _object(_object(document.content, "asset"), "extras")
        finishes = _object(own, EXTRAS).get("finishes", [])
        self.finishes = {
            str(one["name"]): one
            for one in (finishes if isinstance(finishes, list) else [])[:MOST_MATERIALS]
            if isinstance(one, dict) and "name" in one
        }

    def material(self, part: str | None) -> Material:
        """The one that is asked for."""
        if not self.entries:
            raise InputError("has no materials; the program that made it may leave them out")
        if part is None and len(self.entries) == 1:
            return self._read(0)
        if part is None:
            raise InputError(
                f"has {len(self._all())} materials; choose one with --part NAME: {self._list()}"
            )
        if part in self.finishes:
            return self._finish(self.finishes[part])
        matches = [k for k, name in enumerate(self.names) if name == part]
        if not matches:
            raise InputError(f"has no material {printable(part, 60)!r}; it has: {self._list()}")
        if len(matches) > 1:
            raise InputError(
                f"has {len(matches)} materials named {printable(part, 60)!r}; rename them in the "
                "program that made it"
            )
        return self._read(matches[0])

    def _all(self) -> list[str]:
        return list(dict.fromkeys([*self.names, *self.finishes]))

    def _list(self) -> str:
        names = self._all()
        shown = ", ".join(printable(name, 60) for name in names[:LISTED])
        return shown + (f" and {len(names) - LISTED} more" if len(names) > LISTED else "")

    def _finish(self, finish: dict[str, Any]) -> Material:
        """A finish of a pack, by the numbers that lie beside its pack's textures."""
        surface = _object(finish, "surface")
        own = own_material(finish.get("material"), finish.get("digest"), surface)
        if own is not None:
            return own
        return self._described(surface, str(finish["name"]))

    def _read(self, number: int) -> Material:
        entry = self.entries[number]
        own = _object(_object(entry, "extras"), EXTRAS)
        stated = {key: value for key, value in entry.items() if key not in ("name", "extras")}
        material = own_material(own.get("material"), own.get("digest"), stated)
        if material is not None:
            return material
        return self._described(entry, self.names[number], number)

    def _described(self, entry: dict[str, Any], name: str, number: int | None = None) -> Material:
        theirs = GltfMaterial(self.document, entry)
        stated = theirs.surface()
        surface, mirrors = drawable(
            theirs.seen_through(stated), GLTF_LOBES if stated.clearcoat > 0.0 else GLTF_LOBES[:1]
        )
        lines = [*theirs.lines, *mirrors]
        if number is not None and self._has_colours(number):
            lines.append("colours of the mesh's points (COLOR_0)")
        return refit_lobes(
            surface,
            name=printable(name, 60),
            source=f"described by a glTF file, {printable(self.path.name, 60)}",
            model=MODEL,
            parameters=_parameters(stated),
            not_carried=tuple(lines),
            **gltf_starting_points(surface),
        )

    def _has_colours(self, number: int) -> bool:
        for mesh in list_of(self.document.content, "meshes"):
            for primitive in list_of(mesh, "primitives"):
                one = _object({"it": primitive}, "it")
                if one.get("material") == number and "COLOR_0" in _object(one, "attributes"):
                    return True
        return False


def _object(holder: Any, key: str) -> dict[str, Any]:
    value = holder.get(key) if isinstance(holder, dict) else None
    return value if isinstance(value, dict) else {}


def _parameters(surface: GltfSurface) -> dict[str, Any]:
    """The factors by their names in glTF, with the means of textures in them."""
    entry = surface.as_json()
    parameters = dict(entry["pbrMetallicRoughness"])
    for name in EXTENSIONS:
        parameters.update(entry.get("extensions", {}).get(name, {}))
    return parameters
