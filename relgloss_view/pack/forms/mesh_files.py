"""Mesh files of a pack: .glb, .gltf, .obj, .ply and .stl, read within bounds.

A file gives points, triangles, texture coordinates, normals and names of parts. Its materials and
pictures are never opened: finishes and artwork come from the pack.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import check_regular, decoding, named, read_bytes
from relgloss_view.pack.forms.gltf_file import parse_glb, parse_gltf
from relgloss_view.pack.forms.loose import Loose, packed
from relgloss_view.pack.forms.obj_file import parse_obj
from relgloss_view.pack.forms.ply_file import parse_ply
from relgloss_view.pack.forms.stl_file import parse_stl
from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.shape import UNITS

EXPECTED = "a mesh (.glb, .gltf, .obj, .ply or .stl)"
MOST_BYTES = 100 * 1024 * 1024
KEPT = 4  #: files in memory

_PARSERS: dict[str, Callable[[bytes], Loose]] = {
    ".obj": parse_obj,
    ".ply": parse_ply,
    ".stl": parse_stl,
    ".glb": parse_glb,
}
MESH_SUFFIXES = (*_PARSERS, ".gltf")


def read_mesh(file: str | os.PathLike[str], unit: str = "auto") -> Mesh:
    """The mesh of a file, centred, in metres; the same object until the file changes, or one of
    a .gltf's buffers.

    unit: of its coordinates, one of UNITS. 'auto' takes metres, as glTF prescribes; a file whose
    longest side would be above 10 m is taken as millimetres, which its notes state.
    Label: texture coordinates (u, v), about the middle of the unit square, times the metres that a
    unit of u and of v spans on the surface, weighted by area. Parts: the file's materials, or
    objects where it has none; all are printed where the file has texture coordinates.
    Raises InputError, one line that names the file.
    """
    if not os.fspath(file):
        raise InputError("shape.file: expected the name of " + EXPECTED)
    check_regular(file, EXPECTED)
    key = os.path.abspath(file), unit
    with _LOCK:  # the window reads in a thread, too
        held = _HELD.pop(key, None)
        if held is None or any(_stamp(name) != stamp for name, stamp in held[0].items()):
            before = _stamp(key[0])
            mesh, beside = _read(*key)
            held = {key[0]: before, **{name: _stamp(name) for name in beside}}, mesh
        _HELD[key] = held  # the last used one is the last
        while len(_HELD) > KEPT:
            del _HELD[next(iter(_HELD))]
        return held[1]


#: Meshes by file and unit, each with the stamps of all files that it was read from.
_HELD: dict[tuple[str, str], tuple[dict[str, object], Mesh]] = {}
_LOCK = threading.Lock()


def _stamp(file: str) -> object:
    """What changes where a file is edited; None where it is gone."""
    try:
        state = os.stat(file)
    except OSError:
        return None
    return state.st_mtime_ns, state.st_size


def _read(file: str, unit: str) -> tuple[Mesh, tuple[str, ...]]:
    """The mesh of a file, and the files beside it that it names."""
    suffix = Path(file).suffix.lower()
    if suffix not in MESH_SUFFIXES:
        raise InputError(f"{named(file)}: expected {EXPECTED}")
    data = read_bytes(file, MOST_BYTES, EXPECTED)
    # Numbers that are none are found by the checks, and need no warning.
    with decoding(file, EXPECTED), np.errstate(all="ignore"):
        try:
            if suffix == ".gltf":
                loose = parse_gltf(data, Path(file).parent)
            else:
                loose = _PARSERS[suffix](data)
            return packed(loose, None if unit == "auto" else UNITS[unit]), loose.beside
        except InputError as error:
            if str(error).startswith(named(file)):
                raise
            raise InputError(f"{named(file)}: {error}") from error
