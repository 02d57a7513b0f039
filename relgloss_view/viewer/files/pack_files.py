"""Files of packs that the window opens: pack files, artwork, meshes; by content where it says so.

No OpenGL, no window library: a thread of OpenJob does it.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from relgloss_view.base.reading import read_beginning
from relgloss_view.pack.kinds import ARTWORK, kind_of_pack
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.shape import Shape

MESH = "mesh"
HEAD_BYTES = 16
EXPECTED = "a pack file, an artwork or a mesh"
ARTWORK_SUFFIXES = (".pdf", ".ai", ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".psd")
MESH_SUFFIXES = (".glb", ".gltf", ".obj", ".ply")
_MESH_HEADS = (b"glTF", b"ply\n", b"ply\r")


def pack_kind(path: str | os.PathLike[str]) -> str | None:
    """PACK, ARTWORK or MESH; None for a file of another kind. InputError where it can't be read."""
    kind = kind_of_pack(path)
    if kind is not None:
        return kind
    suffix = Path(path).suffix.lower()
    head = read_beginning(path, HEAD_BYTES, EXPECTED)
    if head.startswith(_MESH_HEADS) or suffix in MESH_SUFFIXES:
        return MESH
    return ARTWORK if suffix in ARTWORK_SUFFIXES else None  # its reader reports what is wrong


def opened_pack(path: str, progress: Callable[[float, str], None]) -> Pack:
    """The pack of a pack file; InputError where it can't be read."""
    from relgloss_view.pack.pack_file import read_pack

    return read_pack(path, progress)


def opened_artwork(path: str, progress: Callable[[float, str], None]) -> Pack:
    """An artwork on a can, with a finish for each plate that names one; InputError."""
    from relgloss_view.pack.quick import quick_pack

    return quick_pack(path, progress=progress)


def opened_mesh(path: str, progress: Callable[[float, str], None]) -> Shape:
    """The form of a mesh file, which is read once and kept; InputError."""
    from relgloss_view.pack.forms import mesh_of

    progress(0.1, "reading the mesh")
    shape = Shape("mesh", file=str(Path(path).absolute()))
    mesh_of(shape)
    return shape


def mesh_notes(shape: Shape) -> tuple[str, ...]:
    """What a user should know of a form's mesh; none of an analytic form."""
    from relgloss_view.pack.forms import mesh_of

    mesh = mesh_of(shape)
    return () if mesh is None else mesh.notes
